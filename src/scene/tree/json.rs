use std::fmt;

use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use serde_json::value::RawValue;

use super::node::{Entry, Node, Value};
use crate::scene::{Fault, refusal::Refusal};

/// Deeper than any event goes, and shallow enough that no line exhausts the stack.
const DEEPEST: u32 = 8;

/// The one value in `text`.
///
/// In a format without infinity, a `mass` of `"inf"` is read as the infinity it means.
pub fn parse_json(text: &str) -> Result<Node, Refusal> {
    let raw: &RawValue = serde_json::from_str(text).map_err(|error| syntax(text, 0, &error))?;
    from_json(text, raw, DEEPEST)
}

fn from_json(text: &str, raw: &RawValue, depth: u32) -> Result<Node, Refusal> {
    let written = raw.get();
    let start = start_of(written, text);
    let span = start..start + written.len();
    if depth == 0 {
        let fault = Fault::Syntax { language: "JSON", message: "nested too deeply".into() };
        return Err(Refusal::new(fault, span));
    }
    let value = match written.as_bytes().first() {
        Some(b'{') => table(text, written, depth)?,
        Some(b'[') => list(text, written, depth)?,
        Some(b'"') => Value::Text(part(text, written)?),
        Some(b't' | b'f') => Value::Boolean(part(text, written)?),
        Some(b'n') | None => Value::Other("null"),
        Some(_) => Value::from_decimal(written),
    };
    Ok(Node { span, value })
}

fn table(text: &str, written: &str, depth: u32) -> Result<Value, Refusal> {
    let Members(members) = part(text, written)?;
    let entries = members.into_iter().map(|(key, value)| entry(text, key.get(), value, depth));
    entries.collect::<Result<_, _>>().map(Value::Table)
}

fn entry(text: &str, key: &str, value: &RawValue, depth: u32) -> Result<Entry, Refusal> {
    let start = start_of(key, text);
    let span = start..start + key.len();
    let key: String = part(text, key)?;
    let mut node = from_json(text, value, depth - 1)?;
    if key == "mass" && node.value == Value::Text("inf".into()) {
        node.value = Value::Number(f64::INFINITY);
    }
    Ok(Entry { key, span, node })
}

fn list(text: &str, written: &str, depth: u32) -> Result<Value, Refusal> {
    let values: Vec<&RawValue> = part(text, written)?;
    values.into_iter().map(|value| from_json(text, value, depth - 1)).collect::<Result<_, _>>().map(Value::List)
}

/// What serde makes of `written`, which is a part of `text`.
fn part<'a, T: Deserialize<'a>>(text: &str, written: &'a str) -> Result<T, Refusal> {
    serde_json::from_str(written).map_err(|error| syntax(text, start_of(written, text), &error))
}

/// Where in `text` its part `written` begins: a raw value is borrowed, not copied.
fn start_of(written: &str, text: &str) -> usize {
    written.as_ptr().addr() - text.as_ptr().addr()
}

fn syntax(text: &str, start: usize, error: &serde_json::Error) -> Refusal {
    let message = error.to_string();
    let message = message.split(" at line ").next().unwrap_or_default().into();
    let mut place = text.len().min(start + error.column().saturating_sub(1));
    while !text.is_char_boundary(place) {
        place -= 1;
    }
    Refusal::new(Fault::Syntax { language: "JSON", message }, place..place)
}

/// The members of an object in order, repeated keys included.
struct Members<'a>(Vec<(&'a RawValue, &'a RawValue)>);

impl<'de> Deserialize<'de> for Members<'de> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Members<'de>, D::Error> {
        struct InOrder;

        impl<'de> Visitor<'de> for InOrder {
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

        deserializer.deserialize_map(InOrder)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_know_their_place() {
        let text = r#" {"spawn": {"na\u006de": "b", "at": [2.5, -1e3], "mass": "inf"}} "#;
        let Value::Table(outer) = parse_json(text).unwrap().value else { panic!("an object") };
        let Value::Table(inner) = &outer[0].node.value else { panic!("an object") };
        let places: Vec<&str> = inner.iter().map(|entry| &text[entry.node.span.clone()]).collect();
        assert_eq!(places, [r#""b""#, "[2.5, -1e3]", r#""inf""#]);
        assert_eq!(inner[0].key, "name", "escapes in keys are read");
        assert_eq!(inner[1].node.vector().map(|at| (at.x, at.y)), Ok((2.5, -1000.0)));
        assert_eq!(inner[2].node.value, Value::Number(f64::INFINITY));
    }

    #[test]
    fn hostile_depth_is_an_error() {
        let text = "[".repeat(100_000) + &"]".repeat(100_000);
        assert!(matches!(*parse_json(&text).unwrap_err().fault, Fault::Syntax { .. }));
    }
}
