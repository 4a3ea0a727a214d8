use super::{Diagnostic, DiagnosticKind, Excerpt, SceneError, diagnostic::Reporter, inputs};
use std::{fmt, ops::Range, path::Path, str::FromStr};
use toml_edit::{DocumentMut, Item, Key, Table, TableLike, Value};

/// A new value for one key of a scene: `KEY=VALUE`, such as `restitution.default=0.5`.
///
/// `KEY` is the path of the key in the file, joined by dots. The second part of the path of a repeated
/// table such as `[[spawn]]` is a name or a number: `spawn.c.mass` is the mass of the body `c`, and
/// `scatter.1.seed` the seed of the first `[[scatter]]`. `VALUE` is written as in the file; a word needs
/// no quotes.
#[derive(Clone, Debug)]
pub struct Override {
    keys: Vec<String>,
    value: Value,
    /// The override as typed.
    text: String,
}

impl FromStr for Override {
    type Err = String;

    fn from_str(text: &str) -> Result<Override, String> {
        let parts = text.match_indices('=').find_map(|(index, _)| {
            let keys = Key::parse(&text[..index]).ok()?;
            Some((keys, text[index + 1..].trim()))
        });
        let Some((keys, value)) = parts else {
            return Err("expected KEY=VALUE, such as restitution.default=0.5 or spawn.c.mass=2".into());
        };
        let keys = keys.iter().map(|key| key.get().to_owned()).collect();
        let value = value.parse().unwrap_or_else(|_| Value::from(value));
        Ok(Override { keys, value, text: text.into() })
    }
}

impl fmt::Display for Override {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str(&self.text)
    }
}

/// Applies overrides to the text of a scene. A text that is not TOML is returned unchanged: parsing it as a
/// scene reports the error.
///
/// # Errors
/// [`SceneError::Override`] with all overrides that cannot be applied.
pub fn apply(path: &Path, text: &str, overrides: &[Override]) -> Result<String, SceneError> {
    let Ok(mut document) = text.parse::<DocumentMut>() else { return Ok(text.to_owned()) };
    let reporter = Reporter::default();
    let mut lines = String::new();
    for Override { keys, value, text } in overrides {
        lines += "--set ";
        let target = Target { keys, text, start: lines.len(), reporter: &reporter };
        target.set(document.as_table_mut(), 0, value);
        lines += &text.replace(|letter: char| letter.is_ascii_control(), "?");
        lines.push('\n');
    }
    let excerpt = || Excerpt { name: "command line".into(), line: 1, text: lines };
    reporter
        .finish(Ok(document.to_string()), excerpt)
        .map_err(|diagnostics| SceneError::Override { path: path.into(), diagnostics })
}

/// The key that an override sets.
struct Target<'a> {
    keys: &'a [String],
    /// The override as typed.
    text: &'a str,
    /// The offset of the override in the text of all overrides.
    start: usize,
    reporter: &'a Reporter,
}

impl Target<'_> {
    /// Sets the value in `table`, whose path is the first `depth` keys.
    fn set(&self, table: &mut dyn TableLike, depth: usize, value: &Value) {
        let key = &self.keys[depth];
        if depth + 1 == self.keys.len() {
            return set_value(table, key, value);
        }
        let is_repeated = depth == 0 && inputs::KEYS.iter().any(|repeated| repeated.name == key);
        if is_repeated && !table.contains_key(key) {
            return self.report_no_such_table(depth, Vec::new());
        }
        let item = table.entry(key).or_insert_with(|| Item::Table(Table::new()));
        if let Some(inner) = item.as_table_like_mut() {
            return self.set(inner, depth + 1, value);
        }
        match repeated_tables(item) {
            Some(tables) => self.set_in_one(tables, depth + 1, value),
            None => self.report(DiagnosticKind::NotATable { key: self.path(depth) }, depth),
        }
    }

    /// Sets the value in the table that the key at `depth` names or numbers.
    fn set_in_one(&self, mut tables: Vec<&mut dyn TableLike>, depth: usize, value: &Value) {
        let name = &self.keys[depth];
        if depth + 1 == self.keys.len() {
            return self.report(DiagnosticKind::NotAValue { key: self.path(depth) }, depth);
        }
        let names: Vec<Option<String>> = tables.iter().map(|table| name_of(*table)).collect();
        let named = names.iter().position(|known| known.as_deref() == Some(name));
        let number = name.parse::<usize>().ok().filter(|number| (1..=names.len()).contains(number));
        match named.or(number.map(|number| number - 1)) {
            Some(index) => self.set(tables[index], depth + 1, value),
            None => self.report_no_such_table(depth - 1, first_known(&names)),
        }
    }

    fn report_no_such_table(&self, depth: usize, known: Vec<String>) {
        let (table, name) = (self.keys[depth].clone(), self.keys[depth + 1].clone());
        self.report(DiagnosticKind::NoSuchTable { table, name, known }, depth + 1);
    }

    /// Reports an error at the key at `depth`.
    fn report(&self, kind: DiagnosticKind, depth: usize) {
        let Range { start, end } = self.span(depth);
        self.reporter.report(Diagnostic::new(kind, self.start + start..self.start + end));
    }

    /// The location of the key at `depth` in the override; all of it if the key is written with escapes.
    fn span(&self, depth: usize) -> Range<usize> {
        let mut end = 0;
        let mut span = 0..self.text.len();
        for key in &self.keys[..=depth] {
            let Some(offset) = self.text[end..].find(key.as_str()) else { return 0..self.text.len() };
            span = end + offset..end + offset + key.len();
            end = span.end;
        }
        span
    }

    fn path(&self, depth: usize) -> String {
        self.keys[..=depth].join(".")
    }
}

fn set_value(table: &mut dyn TableLike, key: &str, value: &Value) {
    let mut value = value.clone();
    if let Some(old) = table.get(key).and_then(Item::as_value) {
        *value.decor_mut() = old.decor().clone();
    }
    table.insert(key, Item::Value(value));
}

/// The tables of `[[key]]` or `key = [{ … }]`.
fn repeated_tables(item: &mut Item) -> Option<Vec<&mut dyn TableLike>> {
    match item {
        Item::ArrayOfTables(tables) => Some(tables.iter_mut().map(|table| table as &mut dyn TableLike).collect()),
        Item::Value(Value::Array(values)) => values
            .iter_mut()
            .map(|value| value.as_inline_table_mut().map(|table| table as &mut dyn TableLike))
            .collect(),
        Item::None | Item::Value(_) | Item::Table(_) => None,
    }
}

fn name_of(table: &dyn TableLike) -> Option<String> {
    table.get("name").and_then(Item::as_str).map(str::to_owned)
}

/// The names of the first few tables, or their numbers if they have no name.
fn first_known(names: &[Option<String>]) -> Vec<String> {
    const MAX_LISTED: usize = 8;
    let known = names.iter().zip(1..).map(|(name, number)| name.clone().unwrap_or_else(|| number.to_string()));
    let mut known: Vec<String> = known.take(MAX_LISTED).collect();
    if names.len() > MAX_LISTED {
        known.push("…".into());
    }
    known
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = "[world]\nsize = [16.0, 9.0] # m\n[[spawn]]\nname = \"c\"\nmass = 1.0 # light\n\
                         [[spawn]]\nmass = 3.0\n";

    fn with(overrides: &[&str]) -> Result<String, SceneError> {
        let overrides: Vec<Override> = overrides.iter().map(|text| text.parse().unwrap()).collect();
        apply(Path::new("scene.toml"), SCENE, &overrides)
    }

    #[test]
    fn values_are_replaced_and_the_rest_of_the_text_is_kept() {
        let changed = with(&["spawn.c.mass=2", "spawn.2.mass = inf", "world.size=[8.0, 8.0]"]).unwrap();
        let expected =
            SCENE.replace("1.0 # light", "2 # light").replace("3.0", "inf").replace("[16.0, 9.0]", "[8.0, 8.0]");
        assert_eq!(changed, expected);
    }

    #[test]
    fn missing_keys_and_tables_are_added() {
        let changed =
            with(&["restitution.default=0.5", "restitution.\"steel/wood\"=0.25", "run.solver=handout"]).unwrap();
        assert!(changed.contains("[restitution]\ndefault = 0.5\n\"steel/wood\" = 0.25\n"), "{changed}");
        assert!(changed.contains("[run]\nsolver = \"handout\"\n"), "{changed}");
    }

    #[test]
    fn all_overrides_that_cannot_be_applied_are_reported() {
        let error =
            with(&["spawn.b.mass=2", "run.rate=50", "spawn.c=2", "world.size.x=2", "click.1.step=2"]).unwrap_err();
        let diagnostics = error.diagnostics().unwrap();
        let text = &diagnostics.excerpt().unwrap().text;
        let found: Vec<(String, &str)> =
            diagnostics.listed().map(|error| (error.to_string(), &text[error.span.clone()])).collect();
        let expected = [
            ("there is no [[spawn]] \"b\"", "b"),
            ("`spawn.c` is a table, not a value", "c"),
            ("`world.size` is a value and has no keys", "size"),
            ("there is no [[click]] \"1\"", "1"),
        ];
        assert_eq!(found, expected.map(|(message, text)| (message.to_owned(), text)));
        assert_eq!(diagnostics.listed().next().unwrap().kind.help(), "use a name or a number: c, 2");
    }

    #[test]
    fn an_override_needs_a_key_and_a_value() {
        assert!("mass".parse::<Override>().is_err() && "=2".parse::<Override>().is_err());
    }
}
