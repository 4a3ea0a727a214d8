//! The parsers of both languages, which give one tree.

use super::{Entry, Node, Value};
use crate::scene::{Diagnostic, DiagnosticKind};
use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use serde_json::value::RawValue;
use std::fmt;
use toml::de::{DeInteger, DeTable, DeValue};

/// Parses a TOML document as a table.
pub fn parse_toml(text: &str) -> Result<Node, Diagnostic> {
    let document = DeTable::parse(text).map_err(|error| {
        let kind = DiagnosticKind::Syntax { language: "TOML", message: error.message().into() };
        Diagnostic::new(kind, error.span().unwrap_or(0..0))
    })?;
    Ok(Node { span: 0..0, value: toml_table(document.into_inner()) })
}

fn toml_table(table: DeTable) -> Value {
    let mut entries: Vec<Entry> = table
        .into_iter()
        .map(|(key, node)| Entry { span: key.span(), key: key.into_inner().into_owned(), node: from_toml(node) })
        .collect();
    // The parser sorts by name; entries keep the order of the file.
    entries.sort_by_key(|entry| entry.span.start);
    Value::Table(entries)
}

fn from_toml(value: toml::Spanned<DeValue>) -> Node {
    let span = value.span();
    let value = match value.into_inner() {
        DeValue::String(text) => Value::Text(text.into_owned()),
        DeValue::Integer(integer) => from_integer(&integer),
        DeValue::Float(float) => Value::from_decimal(float.as_str()),
        DeValue::Boolean(boolean) => Value::Boolean(boolean),
        DeValue::Datetime(_) => Value::Unsupported("a date"),
        DeValue::Array(values) => Value::List(values.into_iter().map(from_toml).collect()),
        DeValue::Table(entries) => toml_table(entries),
    };
    Node { span, value }
}

fn from_integer(integer: &DeInteger) -> Value {
    match i128::from_str_radix(integer.as_str(), integer.radix()) {
        Ok(integer) => Value::Integer(integer),
        Err(_) => Value::OutOfRange(integer.to_string()),
    }
}

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
        Some(b'{') => json_table(text, written, depth)?,
        Some(b'[') => json_list(text, written, depth)?,
        Some(b'"') => Value::Text(deserialize_part(text, written)?),
        Some(b't' | b'f') => Value::Boolean(deserialize_part(text, written)?),
        Some(b'n') | None => Value::Unsupported("null"),
        Some(_) => Value::from_decimal(written),
    };
    Ok(Node { span, value })
}

fn json_table(text: &str, written: &str, depth: u32) -> Result<Value, Diagnostic> {
    let Members(members) = deserialize_part(text, written)?;
    let entries = members.into_iter().map(|(key, value)| json_entry(text, key.get(), value, depth));
    entries.collect::<Result<_, _>>().map(Value::Table)
}

fn json_entry(text: &str, key: &str, value: &RawValue, depth: u32) -> Result<Entry, Diagnostic> {
    let start = start_of(key, text);
    let span = start..start + key.len();
    let key: String = deserialize_part(text, key)?;
    let mut node = from_json(text, value, depth - 1)?;
    if key == "mass" && node.value == Value::Text("inf".into()) {
        node.value = Value::Number(f64::INFINITY);
    }
    Ok(Entry { key, span, node })
}

fn json_list(text: &str, written: &str, depth: u32) -> Result<Value, Diagnostic> {
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

    fn values(text: &str) -> Vec<(String, Value)> {
        match parse_toml(text).unwrap().value {
            Value::Table(entries) => entries.into_iter().map(|entry| (entry.key, entry.node.value)).collect(),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn numbers_keep_their_sign_and_magnitude() {
        let text = "a = -0.0\nb = 0x1f\nc = 1e999\nd = -inf\ne = +7\nf = 0.1";
        let [a, b, c, d, e, f] = values(text).try_into().unwrap();
        assert!(matches!(a.1, Value::Number(zero) if zero == 0.0 && zero.is_sign_negative()));
        assert_eq!([b.1, e.1], [Value::Integer(31), Value::Integer(7)]);
        assert_eq!(c.1, Value::OutOfRange("1e999".into()), "a number beyond f64 is not infinite");
        assert_eq!([d.1, f.1], [Value::Number(f64::NEG_INFINITY), Value::Number(0.1)]);
    }

    #[test]
    fn keys_are_in_the_order_of_the_file_and_values_have_their_locations() {
        let text = "z = 1\n[b]\n[[a]]\nat = [1, 20]\n";
        let Value::Table(entries) = parse_toml(text).unwrap().value else { panic!("a document is a table") };
        let keys: Vec<&str> = entries.iter().map(|entry| entry.key.as_str()).collect();
        assert_eq!(keys, ["z", "b", "a"]);
        let Value::List(tables) = &entries[2].node.value else { panic!("[[a]] is a list") };
        assert_eq!(&text[tables[0].span.clone()], "[[a]]");
        let Value::Table(inner) = &tables[0].value else { panic!("of tables") };
        assert_eq!(&text[inner[0].node.nodes().unwrap()[1].span.clone()], "20");
    }

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
