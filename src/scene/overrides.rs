use super::{Diagnostic, DiagnosticKind, Excerpt, SceneError, diagnostic::Reporter, inputs};
use std::{fmt, iter, ops::Range, path::Path, str::FromStr};
use toml_edit::{DocumentMut, Formatted, Item, Key, Table, TableLike, Value};

/// A new value for one key of a scene: `KEY=VALUE`, such as `restitution.default=0.5`.
///
/// `KEY` is the path of the key in the file, joined by dots: `world.gravity`, `restitution.steel/wood`. A part that
/// contains a dot or an equals sign is written in quotation marks. The second part of the path of a repeated table such
/// as `[[spawn]]` is a name or a number: `spawn.c.mass` is the mass of the body `c`, and `scatter.1.seed` the seed of
/// the first `[[scatter]]`. `VALUE` is written as in the file; a word needs no quotes.
#[derive(Clone, Debug)]
pub struct Override {
    keys: Vec<String>,
    value: Value,
    /// The override as typed; of several values with this one alone.
    text: String,
}

impl FromStr for Override {
    type Err = String;

    fn from_str(text: &str) -> Result<Override, String> {
        let (keys, value) = split(text)?;
        Override::new(&keys, value, text)
    }
}

impl Override {
    fn new(keys: &[String], value: &str, text: &str) -> Result<Override, String> {
        match value {
            "" => Err(format!("the value after {}= is missing", joined(keys))),
            value => Ok(Override { keys: keys.to_vec(), value: parse_value(keys, value), text: text.into() }),
        }
    }

    /// Returns the path of the key, with quotation marks only where they are needed.
    pub fn key(&self) -> String {
        joined(&self.keys)
    }

    /// Returns key and value as a recording stores them: together they parse to the same override.
    pub fn stored(&self) -> [String; 2] {
        [self.key(), self.value.to_string().trim().to_owned()]
    }

    /// Returns the value. Numbers are floats, except those of keys that take integers; infinite ones are text, as in
    /// tables.
    pub fn json(&self) -> serde_json::Value {
        let takes_integers = self.keys.last().is_some_and(|key| INTEGER_KEYS.contains(&key.as_str()));
        json(&self.value, if takes_integers { NumberType::Integer } else { NumberType::Float })
    }
}

impl fmt::Display for Override {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        let value = self.value.as_str().map_or_else(|| self.stored()[1].clone(), str::to_owned);
        write!(formatter, "{}={value}", self.key())
    }
}

/// One key of a scene with the values that it takes in turn: `KEY=VALUE`, or `KEY=[V1 | V2 | V3]` for three runs.
#[derive(Clone, Debug)]
pub struct Sweep(Vec<Override>);

impl FromStr for Sweep {
    type Err = String;

    fn from_str(text: &str) -> Result<Sweep, String> {
        let (keys, value) = split(text)?;
        let Some(values) = several_values(value) else { return Ok(Sweep(vec![Override::new(&keys, value, text)?])) };
        let key = &text[..text.len() - value.len()];
        if values.iter().any(|value| value.is_empty()) {
            return Err(format!("a value of {} is missing beside |", joined(&keys)));
        }
        let overrides = values.into_iter().map(|value| Override::new(&keys, value, &format!("{key}{value}")));
        Ok(Sweep(overrides.collect::<Result<_, String>>()?))
    }
}

impl Sweep {
    /// Returns the value if there is only one.
    pub fn single(mut self) -> Option<Override> {
        self.0.pop().filter(|_| self.0.is_empty())
    }

    /// Returns all combinations of one value of each sweep, in the order of their values; the last key changes fastest.
    ///
    /// # Errors
    /// A message if a key is set twice, or if there are more than [`MAX_RUNS`] combinations.
    pub fn combinations(sweeps: &[Sweep]) -> Result<Vec<Vec<Override>>, String> {
        for (index, sweep) in sweeps.iter().enumerate() {
            let key = sweep.0[0].key();
            if sweeps[..index].iter().any(|earlier| earlier.0[0].key() == key) {
                return Err(format!("{key} is set twice; several values are written --set '{key}=[A | B]'"));
            }
        }
        let count = sweeps.iter().try_fold(1_usize, |count, sweep| count.checked_mul(sweep.0.len()));
        let Some(1..=MAX_RUNS) = count else {
            return Err(format!("the values of --set have more than {MAX_RUNS} combinations; set fewer at once"));
        };
        let extend = |runs: Vec<Vec<Override>>, sweep: &Sweep| -> Vec<Vec<Override>> {
            let with = |run: &Vec<Override>, value: &Override| run.iter().chain([value]).cloned().collect();
            runs.iter().flat_map(|run| sweep.0.iter().map(move |value| with(run, value))).collect()
        };
        Ok(sweeps.iter().fold(vec![Vec::new()], extend))
    }
}

/// Formats the sweep as it was typed.
impl fmt::Display for Sweep {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        match &self.0[..] {
            [value] => formatter.write_str(&value.text),
            values => {
                let key = values[0].key();
                let values: Vec<String> = values.iter().map(|value| value.stored()[1].clone()).collect();
                write!(formatter, "{key}=[{}]", values.join(" | "))
            }
        }
    }
}

/// The largest number of runs of one command.
pub const MAX_RUNS: usize = 10_000;

/// Keys whose values are text, also if they look like numbers.
const TEXT_KEYS: [&str; 6] = ["title", "name", "material", "wall_material", "color", "image"];

/// Keys whose values are integers.
const INTEGER_KEYS: [&str; 5] = ["steps", "step", "seed", "count", "events_per_step"];

/// Splits `KEY=VALUE` at the first equals sign outside of quotation marks, and the key at its dots.
fn split(text: &str) -> Result<(Vec<String>, &str), String> {
    let expected = || "expected KEY=VALUE, such as restitution.default=0.5 or spawn.c.mass=2".to_owned();
    let mut keys = Vec::new();
    let mut rest = text;
    loop {
        let end = part_end(rest).ok_or_else(expected)?;
        let part = rest[..end].trim();
        let key = match part.chars().next() {
            None => return Err(expected()),
            Some('"' | '\'') => part.parse::<Key>().map_err(|_| expected())?.get().to_owned(),
            Some(_) => part.to_owned(),
        };
        keys.push(key);
        let separator = &rest[end..];
        rest = &separator[1..];
        if separator.starts_with('=') {
            return Ok((keys, rest.trim()));
        }
    }
}

/// The offset of the first dot or equals sign outside of quotation marks.
fn part_end(text: &str) -> Option<usize> {
    let mut quote = None;
    text.char_indices().find_map(|(index, letter)| {
        match (quote, letter) {
            (None, '.' | '=') => return Some(index),
            (None, '"' | '\'') => quote = Some(letter),
            (Some(open), letter) if open == letter => quote = None,
            (None | Some(_), _) => {}
        }
        None
    })
}

/// Parses a value of TOML. Words need no quotation marks, and numbers may begin or end with a point.
fn parse_value(keys: &[String], text: &str) -> Value {
    let is_text = keys.last().is_some_and(|key| TEXT_KEYS.contains(&key.as_str()));
    match text.parse::<Value>() {
        Ok(value) if value.is_str() || !is_text => value,
        Ok(_) => Value::from(text),
        Err(_) => match text.parse::<f64>() {
            Ok(number) if number.is_finite() && !is_text => Value::Float(Formatted::new(number)),
            Ok(_) | Err(_) => Value::from(text),
        },
    }
}

/// Splits `[V1 | V2]` at its bars, outside of quotation marks and inner brackets. `None` if there are none.
fn several_values(text: &str) -> Option<Vec<&str>> {
    let inner = text.strip_prefix('[')?.strip_suffix(']')?;
    let (mut depth, mut quote, mut start) = (0_i32, None, 0);
    let mut values = Vec::new();
    for (index, letter) in inner.char_indices() {
        match (quote, letter) {
            (Some(open), letter) if open == letter => quote = None,
            (Some(_), _) => {}
            (None, '"' | '\'') => quote = Some(letter),
            (None, '[' | '{') => depth += 1,
            (None, ']' | '}') => depth -= 1,
            (None, '|') if depth == 0 => {
                values.push(inner[start..index].trim());
                start = index + 1;
            }
            (None, _) => {}
        }
    }
    (!values.is_empty()).then(|| values.into_iter().chain(iter::once(inner[start..].trim())).collect())
}

/// Joins the parts of a key by dots.
fn joined(keys: &[String]) -> String {
    let needs_quotes = |key: &str| {
        key.trim() != key || key.is_empty() || key.contains(['.', '=', '"', '\'']) || key.contains(char::is_control)
    };
    let part = |key: &String| if needs_quotes(key) { Value::from(key).to_string() } else { key.clone() };
    keys.iter().map(part).collect::<Vec<String>>().join(".")
}

/// The type of the numbers that a key takes.
#[derive(Clone, Copy)]
enum NumberType {
    Integer,
    Float,
}

fn json(value: &Value, numbers: NumberType) -> serde_json::Value {
    match (value, numbers) {
        (Value::Integer(number), NumberType::Integer) => (*number.value()).into(),
        (Value::Integer(number), NumberType::Float) => (*number.value() as f64).into(),
        (Value::Float(number), _) if number.value().is_finite() => (*number.value()).into(),
        (Value::Float(number), _) => number.value().to_string().to_lowercase().into(),
        (Value::Boolean(value), _) => (*value.value()).into(),
        (Value::String(text), _) => text.value().as_str().into(),
        (Value::Array(values), _) => values.iter().map(|value| json(value, numbers)).collect(),
        (Value::Datetime(_) | Value::InlineTable(_), _) => value.to_string().trim().into(),
    }
}

/// The keys and values of overrides that a recording stores.
pub fn settings(overrides: &[[String; 2]]) -> Vec<(String, serde_json::Value)> {
    let setting = |[key, value]: &[String; 2]| match format!("{key}={value}").parse::<Override>() {
        Ok(set) => (set.key(), set.json()),
        Err(_) => (key.clone(), value.as_str().into()),
    };
    overrides.iter().map(setting).collect()
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
    let mut places: Vec<Vec<String>> = Vec::new();
    for Override { keys, value, text } in overrides {
        lines += "--set ";
        let target = Target { keys, text, start: lines.len(), reporter: &reporter };
        match target.find(document.as_table_mut(), 0, Vec::new()) {
            Some(found) if places.contains(&found.path) => {
                target.report(DiagnosticKind::DuplicateKey { key: joined(keys) }, keys.len() - 1);
            }
            Some(found) => {
                set_value(found.table, &found.key, value);
                places.push(found.path);
            }
            None => {}
        }
        lines += &text.replace(|letter: char| letter.is_ascii_control(), "?");
        lines.push('\n');
    }
    let excerpt = || Excerpt { name: "command line".into(), line: 1, text: lines };
    reporter
        .finish(Ok(document.to_string()), excerpt)
        .map_err(|diagnostics| SceneError::Override { path: path.into(), diagnostics })
}

/// Returns true if a text has the values that were set with overrides, given by key and value.
pub fn are_applied(text: &str, overrides: &[[String; 2]]) -> bool {
    let overrides: Result<Vec<Override>, String> =
        overrides.iter().map(|[key, value]| format!("{key}={value}").parse()).collect();
    overrides.is_ok_and(|overrides| apply(Path::new(""), text, &overrides).is_ok_and(|applied| applied == text))
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

/// The place of a value in a scene.
struct Place<'t> {
    /// The table that has the value, or is to have it.
    table: &'t mut dyn TableLike,
    key: String,
    /// The path from the root, which is the same for all ways to type it: a repeated table has its number, from 1.
    path: Vec<String>,
}

impl Target<'_> {
    /// Finds the place below `table`, whose path is the first `depth` keys. Tables that do not exist are added on the
    /// way. A place that cannot be is reported.
    fn find<'t>(&self, table: &'t mut dyn TableLike, depth: usize, mut path: Vec<String>) -> Option<Place<'t>> {
        let key = &self.keys[depth];
        if depth + 1 == self.keys.len() {
            let reversed = key.split_once('/').map(|(a, b)| format!("{b}/{a}")).filter(|pair| table.contains_key(pair));
            let key = if self.keys[0] == "restitution" { reversed.as_ref().unwrap_or(key) } else { key };
            path.push(key.clone());
            return Some(Place { table, key: key.clone(), path });
        }
        let is_repeated = depth == 0 && inputs::KEYS.iter().any(|repeated| repeated.name == key);
        if is_repeated && !table.contains_key(key) {
            self.report_no_such_table(depth, Vec::new());
            return None;
        }
        path.push(key.clone());
        let item = table.entry(key).or_insert_with(|| Item::Table(Table::new()));
        if item.is_table_like() {
            return self.find(item.as_table_like_mut()?, depth + 1, path);
        }
        match repeated_tables(item) {
            Some(tables) => self.find_in_one(tables, depth + 1, path),
            None => {
                self.report(DiagnosticKind::NotATable { key: self.path(depth) }, depth);
                None
            }
        }
    }

    /// Finds the place in the table that the key at `depth` names or numbers.
    fn find_in_one<'t>(
        &self,
        tables: Vec<&'t mut dyn TableLike>,
        depth: usize,
        mut path: Vec<String>,
    ) -> Option<Place<'t>> {
        let name = &self.keys[depth];
        let names: Vec<Option<String>> = tables.iter().map(|table| name_of(*table)).collect();
        let named = names.iter().zip(1..).filter(|(known, _)| known.as_ref() == Some(name));
        let named: Vec<usize> = named.map(|(_, number)| number).collect();
        let number = match &named[..] {
            // One number is typed in one way, without a sign or zeros before it.
            [] => (1..=names.len()).find(|number| number.to_string() == *name),
            [number] => Some(*number),
            numbers => {
                self.report_ambiguous_name(depth, numbers);
                return None;
            }
        };
        match number {
            Some(_) if depth + 1 == self.keys.len() => {
                self.report(DiagnosticKind::NotAValue { key: self.path(depth) }, depth);
                None
            }
            Some(number) => {
                path.push(number.to_string());
                self.find(tables.into_iter().nth(number - 1)?, depth + 1, path)
            }
            None => {
                self.report_no_such_table(depth - 1, first_known(&names));
                None
            }
        }
    }

    /// Reports that several tables have the name at `depth`, with the first few of their `numbers`.
    fn report_ambiguous_name(&self, depth: usize, numbers: &[usize]) {
        let with = |number: &usize| {
            let mut keys = self.keys.to_vec();
            keys[depth] = number.to_string();
            joined(&keys)
        };
        let mut choices: Vec<String> = numbers.iter().take(MAX_LISTED).map(with).collect();
        if numbers.len() > MAX_LISTED {
            choices.push("…".into());
        }
        let (table, name) = (self.keys[depth - 1].clone(), self.keys[depth].clone());
        self.report(DiagnosticKind::AmbiguousName { table, name, count: numbers.len(), choices }, depth);
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

/// The largest number of tables that an error lists.
const MAX_LISTED: usize = 8;

/// The names of the first few tables, or their numbers if they have no name.
fn first_known(names: &[Option<String>]) -> Vec<String> {
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
    fn the_number_of_a_table_has_neither_a_sign_nor_zeros_before_it() {
        for key in ["+1", "01", "002", "0", "-1", "3"] {
            assert!(with(&[&format!("spawn.{key}.mass=2")]).is_err(), "{key}");
        }
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
    fn a_name_of_several_tables_is_ambiguous_and_each_has_a_number() {
        let scene = "[[spawn]]\nname = \"c\"\nmass = 1.0\n[[spawn]]\nname = \"b\"\nmass = 2.0\n\
                     [[spawn]]\nname = \"c\"\nmass = 3.0\n";
        let set = |text: &str| apply(Path::new("scene.toml"), scene, &[text.parse().unwrap()]);
        let error = set("spawn.c.mass=9").unwrap_err();
        let first = error.diagnostics().unwrap().listed().next().unwrap().clone();
        assert_eq!(first.to_string(), "2 [[spawn]] have the name \"c\"");
        assert_eq!(first.kind.help(), "choose one by its position: spawn.1.mass, spawn.3.mass");
        assert_eq!(set("spawn.3.mass=9").unwrap(), scene.replace("3.0", "9"));
        assert_eq!(set("spawn.b.mass=9").unwrap(), scene.replace("2.0", "9"));
    }

    #[test]
    fn a_value_is_set_once_however_its_key_is_typed() {
        let scene = "[restitution]\n\"steel/wood\" = 0.5\n[[spawn]]\nmass = 1.0\n[[spawn]]\nname = \"b\"\nmass = 2.0\n";
        for keys in [
            ["spawn.b.mass", "spawn.2.mass"],
            ["spawn.2.mass", "spawn.\"b\".mass"],
            ["restitution.steel/wood", "restitution.wood/steel"],
            ["run.steps", "run.steps"],
        ] {
            let overrides = keys.map(|key| format!("{key}=1").parse().unwrap());
            let error = apply(Path::new("scene.toml"), scene, &overrides).unwrap_err();
            let twice = error.diagnostics().unwrap().listed().next().unwrap().clone();
            assert!(twice.to_string().ends_with("` is given twice"), "{keys:?}: {twice}");
        }
        let both = ["spawn.1.mass=3", "spawn.b.mass=4"].map(|text| text.parse().unwrap());
        assert!(apply(Path::new("scene.toml"), scene, &both).is_ok());
    }

    #[test]
    fn keys_are_typed_as_they_are_in_the_file_without_its_quotation_marks() {
        let scene = "[restitution]\n\"steel/wood\" = 0.5\n[[spawn]]\nname = \"a b.c\"\nmass = 1.0\n";
        let set = |key: &str| {
            let overrides: Override = format!("{key}=0.25").parse().unwrap();
            apply(Path::new("scene.toml"), scene, &[overrides]).map_err(|error| error.to_string())
        };
        let expected = Ok(scene.replace("0.5", "0.25"));
        for key in [
            "restitution.steel/wood",
            "restitution.wood/steel",
            "restitution.\"steel/wood\"",
            " restitution . steel/wood ",
        ] {
            assert_eq!(set(key), expected, "{key}");
        }
        assert_eq!(set("spawn.\"a b.c\".mass"), Ok(scene.replace("1.0", "0.25")));
        assert!(set("restitution.steel/steel").unwrap().contains("\"steel/steel\" = 0.25\n"));
    }

    #[test]
    fn values_are_numbers_words_or_text() {
        let stored = |text: &str| text.parse::<Override>().unwrap().stored()[1].clone();
        assert_eq!(stored("restitution.default=.5"), "0.5");
        assert_eq!(stored("title=2026"), "\"2026\"");
        assert_eq!(stored("title=e = 0.5"), "\"e = 0.5\"");
        assert_eq!(stored("spawn.c.color=#3366cc"), "\"#3366cc\"");
        assert_eq!(stored("spawn.c.name=\"c\""), "\"c\"");
        assert_eq!(stored("spawn.c.mass=inf"), "inf");
        let json = |text: &str| text.parse::<Override>().unwrap().json().to_string();
        assert_eq!(json("spawn.c.mass=2"), "2.0");
        assert_eq!(json("spawn.c.mass=inf"), "\"inf\"");
        assert_eq!(json("run.steps=2"), "2");
        assert_eq!(json("world.size=[8, 8.5]"), "[8.0,8.5]");
        assert_eq!(json("run.solver=handout"), "\"handout\"");
    }

    #[test]
    fn a_stored_override_parses_to_itself() {
        for text in
            ["spawn.\"a.b\".mass=2", "title=x = \"y\"", "spawn.#3.velocity=[1, -0.0]", "spawn.\" \".name=' '", "a='\"'"]
        {
            let [key, value] = text.parse::<Override>().unwrap().stored();
            let again: Override = format!("{key}={value}").parse().unwrap();
            assert_eq!(again.stored(), [key, value], "{text}");
        }
    }

    #[test]
    fn several_values_are_run_in_all_combinations() {
        let sweeps = ["a.e=[0.3 | 0.5]", "size=[[1, 2] | [3, 4]]", "title=x | [y]"].map(|text| text.parse().unwrap());
        let runs = Sweep::combinations(&sweeps).unwrap();
        let runs: Vec<String> = runs.iter().map(|run| run.iter().map(|set| format!("{set}; ")).collect()).collect();
        let expected = [
            "a.e=0.3; size=[1, 2]; title=x | [y]; ",
            "a.e=0.3; size=[3, 4]; title=x | [y]; ",
            "a.e=0.5; size=[1, 2]; title=x | [y]; ",
            "a.e=0.5; size=[3, 4]; title=x | [y]; ",
        ];
        assert_eq!(runs, expected);
        let twice = ["a.e=1", "a.\"e\"=2"].map(|text| text.parse().unwrap());
        assert!(Sweep::combinations(&twice).unwrap_err().contains("a.e is set twice"));
        let many = format!("a={:?}", vec![1; 200]).replace(", ", "|");
        let many = ["b", "c", "d"].map(|key| many.replacen('a', key, 1).parse().unwrap());
        assert!(Sweep::combinations(&many).unwrap_err().contains("more than 10000"));
    }

    #[test]
    fn an_override_needs_a_key_and_a_value() {
        for text in ["mass", "=2", "a..b=2", "a.=2", "a.\"b=2", "a=", "a=[1 | ]"] {
            assert!(text.parse::<Sweep>().is_err(), "{text}");
        }
    }
}
