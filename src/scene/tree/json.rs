use std::fmt;

use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use serde_json::value::RawValue;

use super::{Entry, Node, Value};
use crate::scene::{Diagnostic, DiagnosticKind};

/// The largest nesting depth: enough for any event, and too little to exhaust the stack.
const MAX_DEPTH: u32 = 8;

/// Parses the single JSON value in `text`.
///
/// JSON has no infinity, so a `mass` of `"inf"` is read as infinity.
pub fn parse_json(text: &str) -> Result<Node, Diagnostic> {
    let raw: &RawValue = serde_json::from_str(text).map_err(|error| syntax(text, 0, &error))?;
    from_json(text, raw, MAX_DEPTH)
}

fn from_json(text: &str, raw: &RawValue, depth: u32) -> Result<Node, Diagnostic> {
    let written = raw.get();
    let start = start_of(written, text);
    let span = start..start + written.len();
    if depth == 0 {
        let kind = DiagnosticKind::Syntax { language: "JSON", message: "nested too deeply".into() };
        return Err(Diagnostic::new(kind, span));
    }
    let value = match written.as_bytes().first() {
        Some(b'{') => table(text, written, depth)?,
        Some(b'[') => list(text, written, depth)?,
        Some(b'"') => Value::Text(deserialize_part(text, written)?),
        Some(b't' | b'f') => Value::Boolean(deserialize_part(text, written)?),
        Some(b'n') | None => Value::Unsupported("null"),
        Some(_) => Value::from_decimal(written),
    };
    Ok(Node { span, value })
}

fn table(text: &str, written: &str, depth: u32) -> Result<Value, Diagnostic> {
    let Members(members) = deserialize_part(text, written)?;
    let entries = members.into_iter().map(|(key, value)| entry(text, key.get(), value, depth));
    entries.collect::<Result<_, _>>().map(Value::Table)
}

fn entry(text: &str, key: &str, value: &RawValue, depth: u32) -> Result<Entry, Diagnostic> {
    let start = start_of(key, text);
    let span = start..start + key.len();
    let key: String = deserialize_part(text, key)?;
    let mut node = from_json(text, value, depth - 1)?;
    if key == "mass" && node.value == Value::Text("inf".into()) {
        node.value = Value::Number(f64::INFINITY);
    }
    Ok(Entry { key, span, node })
}

fn list(text: &str, written: &str, depth: u32) -> Result<Value, Diagnostic> {
    let values: Vec<&RawValue> = deserialize_part(text, written)?;
    values.into_iter().map(|value| from_json(text, value, depth - 1)).collect::<Result<_, _>>().map(Value::List)
}

/// Deserializes `written`, which is a part of `text`.
fn deserialize_part<'a, T: Deserialize<'a>>(text: &str, written: &'a str) -> Result<T, Diagnostic> {
    serde_json::from_str(written).map_err(|error| syntax(text, start_of(written, text), &error))
}

/// The offset in `text` of its part `written`: a raw value is borrowed, not copied.
fn start_of(written: &str, text: &str) -> usize {
    written.as_ptr().addr() - text.as_ptr().addr()
}

fn syntax(text: &str, start: usize, error: &serde_json::Error) -> Diagnostic {
    let message = error.to_string();
    let message = message.split(" at line ").next().unwrap_or_default().into();
    let mut offset = text.len().min(start + error.column().saturating_sub(1));
    while !text.is_char_boundary(offset) {
        offset -= 1;
    }
    Diagnostic::new(DiagnosticKind::Syntax { language: "JSON", message }, offset..offset)
}

/// The members of an object in order, including repeated keys.
struct Members<'a>(Vec<(&'a RawValue, &'a RawValue)>);

impl<'de> Deserialize<'de> for Members<'de> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Members<'de>, D::Error> {
        struct MembersVisitor;

        impl<'de> Visitor<'de> for MembersVisitor {
            type Value = Members<'de>;

            fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
                formatter.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Members<'de>, A::Error> {
                let mut members = Vec::new();
                while let Some(member) = map.next_entry()? {
                    members.push(member);
                }
                Ok(Members(members))
            }
        }

        deserializer.deserialize_map(MembersVisitor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_have_their_locations() {
        let text = r#" {"spawn": {"na\u006de": "b", "at": [2.5, -1e3], "mass": "inf"}} "#;
        let Value::Table(outer) = parse_json(text).unwrap().value else { panic!("an object") };
        let Value::Table(inner) = &outer[0].node.value else { panic!("an object") };
        let texts: Vec<&str> = inner.iter().map(|entry| &text[entry.node.span.clone()]).collect();
        assert_eq!(texts, [r#""b""#, "[2.5, -1e3]", r#""inf""#]);
        assert_eq!(inner[0].key, "name", "escapes in keys are decoded");
        assert_eq!(inner[1].node.vector().map(|at| (at.x, at.y)), Ok((2.5, -1000.0)));
        assert_eq!(inner[2].node.value, Value::Number(f64::INFINITY));
    }

    #[test]
    fn excessive_nesting_is_an_error() {
        let text = "[".repeat(100_000) + &"]".repeat(100_000);
        assert!(matches!(parse_json(&text).unwrap_err().kind, DiagnosticKind::Syntax { .. }));
    }
}
