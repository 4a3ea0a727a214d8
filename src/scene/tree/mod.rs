//! A common tree of TOML and JSON documents in which every value has its location in the text.
//!
//! Scenes and live events have the same keys, so one reader serves both.

mod parse;
mod table;

pub use parse::{parse_json, parse_toml};
pub use table::{Field, Key, Table, unknown_key};

use crate::physics::Vector;
use std::ops::{Range, RangeInclusive};

/// A value and its range of bytes in the text (for a TOML table: its header).
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    pub span: Range<usize>,
    pub value: Value,
}

/// A value of TOML or JSON.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Text(String),
    Boolean(bool),
    Integer(i128),
    /// Infinite or NaN only if written so.
    Number(f64),
    /// A number beyond the range of its type, as written.
    OutOfRange(String),
    /// A value that no key accepts, described: a date, null.
    Unsupported(&'static str),
    List(Vec<Node>),
    Table(Vec<Entry>),
}

/// A key, its location, and its value.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    pub key: String,
    pub span: Range<usize>,
    pub node: Node,
}

/// A value, or the part of the node that is not accepted.
pub type ReadResult<'a, T> = Result<T, &'a Node>;

/// The largest length of a name, of a material and of a title, bytes.
const MAX_TEXT_BYTES: usize = 256;

/// The number of values of a list that a message repeats.
const MAX_DESCRIBED: usize = 4;

impl Value {
    /// Parses a decimal number of TOML or JSON.
    pub fn from_decimal(written: &str) -> Value {
        // Keep `-0` a float: as an integer it would lose its sign.
        if let (Ok(integer), false) = (written.parse(), written == "-0") {
            return Value::Integer(integer);
        }
        match written.parse::<f64>() {
            Ok(number) if number.is_finite() || written.ends_with("inf") || number.is_nan() => Value::Number(number),
            Ok(_) | Err(_) => Value::OutOfRange(written.into()),
        }
    }
}

impl Node {
    /// A finite number; may be written as a whole number.
    pub fn number(&self) -> ReadResult<'_, f64> {
        match self.value {
            Value::Integer(integer) => Ok(integer as f64),
            Value::Number(number) if number.is_finite() => Ok(number),
            Value::Number(_) | Value::OutOfRange(_) | Value::Unsupported(_) => Err(self),
            Value::Text(_) | Value::Boolean(_) | Value::List(_) | Value::Table(_) => Err(self),
        }
    }

    /// A finite number that satisfies `accepts`.
    pub fn number_where(&self, accepts: impl Fn(f64) -> bool) -> ReadResult<'_, f64> {
        self.number().and_then(|number| if accepts(number) { Ok(number) } else { Err(self) })
    }

    /// A finite number above 0.
    pub fn positive(&self) -> ReadResult<'_, f64> {
        self.number_where(|number| number > 0.0)
    }

    /// A mass, kg: positive, with a finite reciprocal, or infinite.
    pub fn mass(&self) -> ReadResult<'_, f64> {
        if self.value == Value::Number(f64::INFINITY) {
            return Ok(f64::INFINITY);
        }
        self.number_where(|mass| mass > 0.0 && (1.0 / mass).is_finite())
    }

    /// A whole number, 0 or more.
    pub fn count(&self) -> ReadResult<'_, u64> {
        let Value::Integer(integer) = self.value else { return Err(self) };
        u64::try_from(integer).map_err(|_| self)
    }

    /// A whole number in that range.
    pub fn count_in(&self, range: RangeInclusive<u64>) -> ReadResult<'_, u64> {
        self.count().and_then(|count| if range.contains(&count) { Ok(count) } else { Err(self) })
    }

    /// A boolean.
    pub fn boolean(&self) -> ReadResult<'_, bool> {
        let Value::Boolean(boolean) = self.value else { return Err(self) };
        Ok(boolean)
    }

    /// A text of 1 to 256 bytes without control characters.
    pub fn text(&self) -> ReadResult<'_, &str> {
        let Value::Text(text) = &self.value else { return Err(self) };
        let fits = !text.is_empty() && text.len() <= MAX_TEXT_BYTES && !text.contains(char::is_control);
        if fits { Ok(text) } else { Err(self) }
    }

    /// The nodes of a list of any length.
    pub fn nodes(&self) -> ReadResult<'_, &[Node]> {
        let Value::List(nodes) = &self.value else { return Err(self) };
        Ok(nodes)
    }

    /// A list of N values, each read by `read`.
    pub fn each<const N: usize, T: Copy + Default>(
        &self,
        read: impl Fn(&Node) -> ReadResult<'_, T>,
    ) -> ReadResult<'_, [T; N]> {
        let nodes: &[Node; N] = self.nodes()?.try_into().map_err(|_| self)?;
        let mut values = [T::default(); N];
        for (value, node) in values.iter_mut().zip(nodes) {
            *value = read(node)?;
        }
        Ok(values)
    }

    /// Two finite numbers.
    pub fn vector(&self) -> ReadResult<'_, Vector> {
        self.each(Node::number).map(|[x, y]| Vector::new(x, y))
    }

    /// Two positive extents.
    pub fn size(&self) -> ReadResult<'_, [f64; 2]> {
        self.each(Node::positive)
    }

    /// Describes the value in a few words, for messages.
    pub fn describe(&self) -> String {
        match &self.value {
            Value::Text(text) => format!("{:?}", shortened(text)),
            Value::Boolean(boolean) => boolean.to_string(),
            Value::Integer(integer) => integer.to_string(),
            Value::Number(number) if number.is_nan() => "nan".into(),
            Value::Number(number) => format!("{number:?}"),
            Value::OutOfRange(written) => shortened(written),
            Value::Unsupported(words) => (*words).into(),
            Value::List(nodes) => {
                let values: Vec<String> = nodes.iter().take(MAX_DESCRIBED).map(Node::describe).collect();
                let more = if nodes.len() > MAX_DESCRIBED { ", …" } else { "" };
                shortened(&format!("[{}{more}]", values.join(", ")))
            }
            Value::Table(_) => "a table".into(),
        }
    }
}

/// Returns at most the first 40 characters of `text`, so that messages have a bounded length.
pub fn shortened(text: &str) -> String {
    match text.char_indices().nth(40) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.into(),
    }
}
