use rebond::internals::scene::{Action, Blueprint, live};
use std::fmt::Write;

/// An event of a session and the step of the state that it changes.
#[derive(Clone, Debug, PartialEq)]
pub struct EventLine {
    /// The step.
    pub step: u64,
    /// The event.
    pub action: Action,
}

impl EventLine {
    /// Parses a line as `rebond record --events` does; a step in it counts only if `step` is `None`.
    ///
    /// # Errors
    /// The message of the parser, or of a line without any step.
    pub fn parse(text: &str, step: Option<u64>) -> Result<EventLine, String> {
        let event = live::parse_line(1, text).map_err(|error| match error.diagnostics() {
            Some(diagnostics) => diagnostics.to_string(),
            None => error.to_string(),
        })?;
        let step = step.or(event.step).ok_or("the event has no step")?;
        Ok(EventLine { step, action: event.action })
    }

    /// The body that the event spawns.
    pub fn blueprint(&self) -> Option<&Blueprint> {
        match &self.action {
            Action::Spawn(request) | Action::Wall(request) => Some(&request.blueprint),
            Action::Click { spawn, .. } => spawn.as_ref(),
            Action::Delete { .. } => None,
        }
    }

    /// The body that the event spawns.
    pub fn blueprint_mut(&mut self) -> Option<&mut Blueprint> {
        match &mut self.action {
            Action::Spawn(request) | Action::Wall(request) => Some(&mut request.blueprint),
            Action::Click { spawn, .. } => spawn.as_mut(),
            Action::Delete { .. } => None,
        }
    }

    /// The line of JSON that `rebond record --events` reads.
    pub fn json(&self) -> String {
        let (kind, keys) = self.keys(Syntax::Json);
        format!("{{\"{kind}\": {{{}}}}}", keys.join(", "))
    }

    /// The table for the end of a scene file.
    pub fn toml(&self) -> String {
        let (kind, keys) = self.keys(Syntax::Toml);
        format!("\n[[{kind}]]\n{}\n", keys.join("\n"))
    }

    fn keys(&self, syntax: Syntax) -> (&'static str, Vec<String>) {
        let mut keys = vec![syntax.key("step", &self.step.to_string())];
        let kind = match &self.action {
            Action::Spawn(request) | Action::Wall(request) => {
                keys.push(syntax.key("at", &pair([request.origin.x, request.origin.y])));
                keys.extend(syntax.blueprint(&request.blueprint));
                "spawn"
            }
            Action::Delete { name } => {
                keys.push(syntax.key("name", &syntax.text(name)));
                "delete"
            }
            Action::Click { at, spawn } => {
                keys.push(syntax.key("at", &pair([at.x, at.y])));
                let spawn = spawn.as_ref().map(|body| format!("{{ {} }}", syntax.blueprint(body).join(", ")));
                keys.extend(spawn.map(|spawn| syntax.key("spawn", &spawn)));
                "click"
            }
        };
        (kind, keys)
    }
}

/// The notation of an event.
#[derive(Clone, Copy)]
enum Syntax {
    Json,
    Toml,
}

impl Syntax {
    fn key(self, key: &str, value: &str) -> String {
        match self {
            Syntax::Json => format!("\"{key}\": {value}"),
            Syntax::Toml => format!("{key} = {value}"),
        }
    }

    fn text(self, text: &str) -> String {
        match self {
            Syntax::Json => serde_json::Value::from(text).to_string(),
            Syntax::Toml => toml_edit::Value::from(text).to_string(),
        }
    }

    fn blueprint(self, body: &Blueprint) -> Vec<String> {
        let Blueprint { name, size, mass, velocity, force, material, paint } = body;
        let mass = match (self, mass.is_finite()) {
            (_, true) => format!("{mass:?}"),
            (Syntax::Json, false) => "\"inf\"".into(),
            (Syntax::Toml, false) => "inf".into(),
        };
        let mut keys = vec![self.key("size", &pair(*size)), self.key("mass", &mass)];
        let vectors = [("velocity", velocity), ("force", force)];
        let vectors = vectors.into_iter().map(|(key, vector)| (key, [vector.x, vector.y]));
        keys.extend(
            vectors.filter(|(_, vector)| *vector != [0.0; 2]).map(|(key, vector)| self.key(key, &pair(vector))),
        );
        let texts = [
            ("name", name.as_deref()),
            ("material", Some(material.as_str())),
            ("color", paint.color_text()),
            ("image", paint.image()),
        ];
        let texts = texts.into_iter().filter_map(|(key, text)| Some((key, text.filter(|text| !text.is_empty())?)));
        keys.extend(texts.map(|(key, text)| self.key(key, &self.text(text))));
        keys
    }
}

/// Two numbers as the shortest decimals that read back to the same bits.
fn pair([x, y]: [f64; 2]) -> String {
    let mut text = String::new();
    let _ = write!(text, "[{x:?}, {y:?}]");
    text
}
