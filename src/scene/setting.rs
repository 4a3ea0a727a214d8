use super::SceneError;
use std::{fmt, path::Path, str::FromStr};
use toml_edit::{DocumentMut, Item, Key, Table, TableLike, Value};

/// One value of a scene, set anew: `KEY=VALUE`, such as `restitution.default=0.5`.
///
/// Keys are those of the file, joined by dots. Of `[[spawn]]` and its like the second key is a name
/// or a number: `spawn.c.mass` is the mass of the body `c`, `scatter.1.seed` the seed of the first
/// `[[scatter]]`. The value is written as in the file; a word needs no quotes.
#[derive(Clone, Debug)]
pub struct Setting {
    keys: Vec<String>,
    value: Value,
    /// As it was typed.
    text: String,
}

impl FromStr for Setting {
    type Err = String;

    fn from_str(text: &str) -> Result<Setting, String> {
        let parts = text.match_indices('=').find_map(|(place, _)| {
            let keys = Key::parse(&text[..place]).ok()?;
            Some((keys, text[place + 1..].trim()))
        });
        let Some((keys, value)) = parts else {
            return Err("expected KEY=VALUE, such as restitution.default=0.5 or spawn.c.mass=2".into());
        };
        let keys = keys.iter().map(|key| key.get().to_owned()).collect();
        let value = value.parse().unwrap_or_else(|_| Value::from(value));
        Ok(Setting { keys, value, text: text.into() })
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str(&self.text)
    }
}

/// The text of a scene with some of its values set anew.
///
/// # Errors
/// [`SceneError::Setting`] if the text has no place for one.
pub fn set(path: &Path, text: &str, settings: &[Setting]) -> Result<String, SceneError> {
    // What is no TOML is refused, better than here, by who reads the scene.
    let Ok(mut document) = text.parse::<DocumentMut>() else { return Ok(text.to_owned()) };
    for setting in settings {
        put(document.as_table_mut(), &setting.keys, &setting.value).map_err(|reason| SceneError::Setting {
            path: path.into(),
            setting: setting.text.clone(),
            reason,
        })?;
    }
    Ok(document.to_string())
}

fn put(table: &mut dyn TableLike, keys: &[String], value: &Value) -> Result<(), String> {
    let (key, rest) = keys.split_first().expect("a key");
    if rest.is_empty() {
        let mut value = value.clone();
        if let Some(old) = table.get(key).and_then(Item::as_value) {
            *value.decor_mut() = old.decor().clone();
        }
        table.insert(key, Item::Value(value));
        return Ok(());
    }
    let item = table.entry(key).or_insert_with(|| Item::Table(Table::new()));
    if let Some(inner) = item.as_table_like_mut() {
        return put(inner, rest, value);
    }
    let (name, rest) = rest.split_first().expect("another key");
    if rest.is_empty() {
        return Err(format!("of [[{key}]] {name:?} is all; say which of its keys"));
    }
    let mut tables: Vec<&mut dyn TableLike> = match item {
        Item::ArrayOfTables(tables) => tables.iter_mut().map(|table| table as &mut dyn TableLike).collect(),
        Item::Value(Value::Array(values)) => {
            let inline = values.iter_mut().filter_map(Value::as_inline_table_mut);
            inline.map(|table| table as &mut dyn TableLike).collect()
        }
        Item::None | Item::Value(_) | Item::Table(_) => return Err(format!("{key} is a single value")),
    };
    let names: Vec<Option<String>> = tables.iter().map(|table| name_of(*table)).collect();
    let numbered = || name.parse::<usize>().ok().filter(|number| (1..=names.len()).contains(number));
    let named = names.iter().position(|known| known.as_deref() == Some(name));
    match named.or_else(|| Some(numbered()? - 1)) {
        Some(place) => put(tables[place], rest, value),
        None => Err(format!("there is no [[{key}]] called {name:?}, only {}", told(&names))),
    }
}

fn name_of(table: &dyn TableLike) -> Option<String> {
    table.get("name").and_then(Item::as_str).map(str::to_owned)
}

/// The first few as they may be called.
fn told(names: &[Option<String>]) -> String {
    const FEW: usize = 8;
    let called = names.iter().zip(1..).map(|(name, number)| name.clone().unwrap_or_else(|| number.to_string()));
    let few: Vec<String> = called.take(FEW).collect();
    if names.len() > FEW { few.join(", ") + ", …" } else { few.join(", ") }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = "[world]\nsize = [16.0, 9.0] # m\n[[spawn]]\nname = \"c\"\nmass = 1.0 # light\n\
                         [[spawn]]\nmass = 3.0\n";

    fn with(settings: &[&str]) -> Result<String, String> {
        let settings: Vec<Setting> = settings.iter().map(|setting| setting.parse().unwrap()).collect();
        set(Path::new("scene.toml"), SCENE, &settings).map_err(|error| error.to_string())
    }

    #[test]
    fn values_change_in_their_places() {
        let changed = with(&["spawn.c.mass=2", "spawn.2.mass = inf", "world.size=[8.0, 8.0]"]).unwrap();
        let expected =
            SCENE.replace("1.0 # light", "2 # light").replace("3.0", "inf").replace("[16.0, 9.0]", "[8.0, 8.0]");
        assert_eq!(changed, expected);
    }

    #[test]
    fn what_is_not_there_is_added() {
        let changed =
            with(&["restitution.default=0.5", "restitution.\"steel/wood\"=0.25", "run.solver=handout"]).unwrap();
        assert!(changed.contains("[restitution]\ndefault = 0.5\n\"steel/wood\" = 0.25\n"), "{changed}");
        assert!(changed.contains("[run]\nsolver = \"handout\"\n"), "{changed}");
    }

    #[test]
    fn who_is_not_there_is_named() {
        let error = with(&["spawn.b.mass=2"]).unwrap_err();
        assert!(error.contains("there is no [[spawn]] called \"b\", only c, 2"), "{error}");
        assert!(with(&["spawn.c=2"]).is_err() && with(&["world.size.x=2"]).is_err());
        assert!("mass".parse::<Setting>().is_err() && "=2".parse::<Setting>().is_err());
    }
}
