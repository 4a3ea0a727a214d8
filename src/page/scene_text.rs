use crate::EventLine;
use rebond::{Diagnostic, Scene, SceneError, parse_scene};
use toml_edit::{ArrayOfTables, DocumentMut, Item, Table, TableLike, Value};

macro_rules! bundled {
    ($($name:literal)+) => {
        /// Names and texts of the scenes that the page contains.
        pub const BUNDLED: &[(&str, &str)] =
            &[$(($name, include_str!(concat!("../../recordings/", $name, ".toml")))),+];
    };
}

bundled! {
    "first-scene" "click-session" "figure-1" "masses" "materials" "head-on" "cradle" "cradle-apart" "chain"
    "bounce-exact" "bounce-handout" "bullet-exact" "bullet-handout" "constant-force" "touching-boxes"
    "overlapping-boxes" "pile" "sinking-stack" "stack-foot-removed" "spawn-and-delete" "tile-seams" "projectiles"
    "zeno-bounce" "piston" "mixing" "brownian-motion" "compression" "elastic-gas" "falling-heap"
}

/// The text of a scene that the page changes.
pub struct SceneText {
    document: DocumentMut,
}

impl SceneText {
    /// The text of a valid scene.
    ///
    /// # Errors
    /// The message of a text that is not TOML.
    pub fn new(text: &str) -> Result<SceneText, String> {
        Ok(SceneText { document: text.parse().map_err(|error: toml_edit::TomlError| error.to_string())? })
    }

    /// Sets a key of a table, such as `world.gravity`, to a value in TOML.
    ///
    /// # Errors
    /// If the value is not TOML or the table is something else.
    pub fn set(&mut self, path: &str, value: &str) -> Result<(), String> {
        let value: Value = value.parse().map_err(|error: toml_edit::TomlError| error.to_string())?;
        let (table, key) = path.split_once('.').ok_or_else(|| format!("{path} names no key of a table"))?;
        self.table(table)?.insert(key, Item::Value(value));
        Ok(())
    }

    /// Sets the number of steps.
    ///
    /// # Errors
    /// If `run` is not a table.
    pub fn set_steps(&mut self, steps: u64) -> Result<(), String> {
        let run = self.table("run")?;
        run.remove("duration");
        run.insert("steps", Item::Value(Value::from(i64::try_from(steps).map_err(|error| error.to_string())?)));
        Ok(())
    }

    /// Sets the rate to `to` Hz. Events and the end of the run keep their times in seconds.
    ///
    /// # Errors
    /// If `run` is not a table.
    pub fn set_rate(&mut self, scene: &Scene, to: f64) -> Result<(), String> {
        let from = scene.run.rate;
        for kind in ["spawn", "scatter", "delete", "click"] {
            match self.document.get_mut(kind) {
                Some(Item::ArrayOfTables(tables)) => {
                    tables.iter_mut().for_each(|table| retime(table, from, to));
                }
                Some(Item::Value(Value::Array(tables))) => {
                    let tables = tables.iter_mut().filter_map(Value::as_inline_table_mut);
                    tables.for_each(|table| retime(table, from, to));
                }
                _ => {}
            }
        }
        self.set("run.rate", &format!("{to:?}"))?;
        self.set_steps(retimed(scene.run.steps, from, to))
    }

    /// The text.
    pub fn text(&self) -> String {
        self.document.to_string()
    }

    fn table(&mut self, name: &str) -> Result<&mut dyn TableLike, String> {
        let item = self.document.entry(name).or_insert_with(|| Item::Table(Table::new()));
        item.as_table_like_mut().ok_or_else(|| format!("{name} is not a table"))
    }
}

fn retime(table: &mut dyn TableLike, from: f64, to: f64) {
    if let Some(step) = table.get("step").and_then(Item::as_integer) {
        let step = retimed(step.unsigned_abs(), from, to);
        table.insert("step", Item::Value(Value::from(i64::try_from(step).unwrap_or(i64::MAX))));
    }
}

/// The step at `to` Hz that is nearest to the time of `step` at `from` Hz.
pub fn retimed(step: u64, from: f64, to: f64) -> u64 {
    (step as f64 / from * to).round() as u64
}

/// The text of `scene` with `lines` as tables and `steps` steps: the session in one file.
///
/// # Errors
/// The message of the parser, if a table cannot be appended to this text.
pub fn with_events(scene: &Scene, lines: &[EventLine], steps: u64) -> Result<String, String> {
    let mut text = SceneText::new(&with_steps(scene, steps)?)?;
    // An array of inline tables cannot be continued by [[tables]] at the end of the file.
    for kind in ["spawn", "scatter", "delete", "click"] {
        if let Some(Item::Value(Value::Array(array))) = text.document.get(kind) {
            let tables = array.iter().filter_map(Value::as_inline_table).map(|table| table.clone().into_table());
            let tables: ArrayOfTables = tables.collect();
            text.document.insert(kind, Item::ArrayOfTables(tables));
        }
    }
    let mut text = text.text();
    if !text.ends_with('\n') {
        text.push('\n');
    }
    lines.iter().for_each(|line| text += &line.toml());
    parse_scene(&scene.source.path, &text).map_err(|error| error.to_string())?;
    Ok(text)
}

/// The text of `scene` with `steps` steps; unchanged if it has as many.
///
/// # Errors
/// If `run` is not a table.
pub fn with_steps(scene: &Scene, steps: u64) -> Result<String, String> {
    if steps == scene.run.steps {
        return Ok(scene.source.text.clone());
    }
    let mut text = SceneText::new(&scene.source.text)?;
    text.set_steps(steps)?;
    Ok(text.text())
}

/// The scene with another value of a key such as `world.gravity`. Events keep their times if it is the rate.
///
/// # Errors
/// The messages of a value that the scene does not accept.
pub fn with_value(scene: &Scene, path: &str, value: &str) -> Result<Scene, String> {
    let mut text = SceneText::new(&scene.source.text)?;
    match path {
        "run.rate" => {
            let rate: f64 = value.parse().map_err(|_| format!("{value} is not a rate"))?;
            text.set_rate(scene, rate)?;
        }
        _ => text.set(path, value)?,
    }
    parse_scene(&scene.source.path, &text.text()).map_err(|error| all_messages(&error))
}

/// All messages of an error in the text of a scene, each with its line and a description of the accepted values.
pub fn all_messages(error: &SceneError) -> String {
    let Some(diagnostics) = error.diagnostics() else { return error.to_string() };
    let text = diagnostics.excerpt().map_or("", |excerpt| &excerpt.text);
    let line = |byte: usize| text.bytes().take(byte).filter(|byte| *byte == b'\n').count() + 1;
    let message = |diagnostic: &Diagnostic| {
        let help = diagnostic.kind.help();
        let help = if help.is_empty() { help } else { format!(" ({help})") };
        format!("line {}: {diagnostic}{help}", line(diagnostic.span.start))
    };
    diagnostics.listed().map(message).collect::<Vec<String>>().join("\n")
}
