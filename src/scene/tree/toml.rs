use ::toml::de::{DeInteger, DeTable, DeValue};

use super::{Entry, Node, Value};
use crate::scene::{Diagnostic, DiagnosticKind};

/// Parses a TOML document as a table.
pub fn parse_toml(text: &str) -> Result<Node, Diagnostic> {
    let document = DeTable::parse(text).map_err(|error| {
        let kind = DiagnosticKind::Syntax { language: "TOML", message: error.message().into() };
        Diagnostic::new(kind, error.span().unwrap_or(0..0))
    })?;
    Ok(Node { span: 0..0, value: table(document.into_inner()) })
}

fn table(table: DeTable) -> Value {
    let mut entries: Vec<Entry> = table
        .into_iter()
        .map(|(key, node)| Entry { span: key.span(), key: key.into_inner().into_owned(), node: from_toml(node) })
        .collect();
    // The parser sorts by name; entries keep the order of the file.
    entries.sort_by_key(|entry| entry.span.start);
    Value::Table(entries)
}

fn from_toml(value: ::toml::Spanned<DeValue>) -> Node {
    let span = value.span();
    let value = match value.into_inner() {
        DeValue::String(text) => Value::Text(text.into_owned()),
        DeValue::Integer(integer) => from_integer(&integer),
        DeValue::Float(float) => Value::from_decimal(float.as_str()),
        DeValue::Boolean(boolean) => Value::Boolean(boolean),
        DeValue::Datetime(_) => Value::Unsupported("a date"),
        DeValue::Array(values) => Value::List(values.into_iter().map(from_toml).collect()),
        DeValue::Table(entries) => table(entries),
    };
    Node { span, value }
}

fn from_integer(integer: &DeInteger) -> Value {
    match i128::from_str_radix(integer.as_str(), integer.radix()) {
        Ok(integer) => Value::Integer(integer),
        Err(_) => Value::OutOfRange(integer.to_string()),
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
}
