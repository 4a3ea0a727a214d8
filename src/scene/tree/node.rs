use std::ops::{Range, RangeInclusive};

use crate::physics::Vector;

/// A value and the bytes of the text it stands at (of a TOML table: its header).
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    pub span: Range<usize>,
    pub value: Value,
}

/// What TOML and JSON can say.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Text(String),
    Boolean(bool),
    Integer(i128),
    /// Infinite or NaN only if the text says so.
    Number(f64),
    /// A number no f64 comes near, as written.
    Beyond(String),
    /// What no key accepts, in words: a date, null.
    Other(&'static str),
    List(Vec<Node>),
    Table(Vec<Entry>),
}

/// A key, where it stands, and its value.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    pub key: String,
    pub span: Range<usize>,
    pub node: Node,
}

/// A value, or the part of a node because of which it is not one.
pub type Reading<'a, T> = Result<T, &'a Node>;

/// The longest name of a body, of a material, and the longest title, bytes.
const LONGEST_TEXT: usize = 256;

/// How many values of a list a message repeats.
const LISTED: usize = 4;

impl Value {
    /// The number written in decimal, as TOML and JSON have it.
    pub fn from_decimal(written: &str) -> Value {
        // Only what is written -0 has a sign a whole number loses.
        if let (Ok(integer), false) = (written.parse(), written == "-0") {
            return Value::Integer(integer);
        }
        match written.parse::<f64>() {
            Ok(number) if number.is_finite() || written.ends_with("inf") || number.is_nan() => Value::Number(number),
            Ok(_) | Err(_) => Value::Beyond(written.into()),
        }
    }
}

impl Node {
    /// A finite number; whole numbers are numbers too.
    pub fn number(&self) -> Reading<'_, f64> {
        match self.value {
            Value::Integer(integer) => Ok(integer as f64),
            Value::Number(number) if number.is_finite() => Ok(number),
            Value::Number(_) | Value::Beyond(_) | Value::Other(_) => Err(self),
            Value::Text(_) | Value::Boolean(_) | Value::List(_) | Value::Table(_) => Err(self),
        }
    }

    /// A finite number for which `accepts` holds.
    pub fn number_where(&self, accepts: impl Fn(f64) -> bool) -> Reading<'_, f64> {
        self.number().and_then(|number| if accepts(number) { Ok(number) } else { Err(self) })
    }

    /// A finite number above 0.
    pub fn positive(&self) -> Reading<'_, f64> {
        self.number_where(|number| number > 0.0)
    }

    /// A mass, kg: positive, with a finite reciprocal, or infinite.
    pub fn mass(&self) -> Reading<'_, f64> {
        if self.value == Value::Number(f64::INFINITY) {
            return Ok(f64::INFINITY);
        }
        self.number_where(|mass| mass > 0.0 && (1.0 / mass).is_finite())
    }

    /// A whole number from 0.
    pub fn count(&self) -> Reading<'_, u64> {
        let Value::Integer(integer) = self.value else { return Err(self) };
        u64::try_from(integer).map_err(|_| self)
    }

    /// A whole number in that range.
    pub fn count_in(&self, range: RangeInclusive<u64>) -> Reading<'_, u64> {
        self.count().and_then(|count| if range.contains(&count) { Ok(count) } else { Err(self) })
    }

    /// true or false.
    pub fn boolean(&self) -> Reading<'_, bool> {
        let Value::Boolean(boolean) = self.value else { return Err(self) };
        Ok(boolean)
    }

    /// A text that is not empty, not endless, and fit for one line of a terminal.
    pub fn text(&self) -> Reading<'_, &str> {
        let Value::Text(text) = &self.value else { return Err(self) };
        let fits = !text.is_empty() && text.len() <= LONGEST_TEXT && !text.contains(char::is_control);
        if fits { Ok(text) } else { Err(self) }
    }

    /// The nodes of a list of any length.
    pub fn nodes(&self) -> Reading<'_, &[Node]> {
        let Value::List(nodes) = &self.value else { return Err(self) };
        Ok(nodes)
    }

    /// A list of N values, each read alike.
    pub fn each<const N: usize, T: Copy + Default>(
        &self,
        read: impl Fn(&Node) -> Reading<'_, T>,
    ) -> Reading<'_, [T; N]> {
        let nodes: &[Node; N] = self.nodes()?.try_into().map_err(|_| self)?;
        let mut values = [T::default(); N];
        for (value, node) in values.iter_mut().zip(nodes) {
            *value = read(node)?;
        }
        Ok(values)
    }

    /// Two finite numbers.
    pub fn vector(&self) -> Reading<'_, Vector> {
        self.each(Node::number).map(|[x, y]| Vector::new(x, y))
    }

    /// Two positive extents.
    pub fn size(&self) -> Reading<'_, [f64; 2]> {
        self.each(Node::positive)
    }

    /// The value in a few words, for messages.
    pub fn in_words(&self) -> String {
        match &self.value {
            Value::Text(text) => format!("{:?}", shortened(text)),
            Value::Boolean(boolean) => boolean.to_string(),
            Value::Integer(integer) => integer.to_string(),
            Value::Number(number) if number.is_nan() => "nan".into(),
            Value::Number(number) => format!("{number:?}"),
            Value::Beyond(written) => shortened(written),
            Value::Other(words) => (*words).into(),
            Value::List(nodes) => {
                let values: Vec<String> = nodes.iter().take(LISTED).map(Node::in_words).collect();
                let more = if nodes.len() > LISTED { ", …" } else { "" };
                shortened(&format!("[{}{more}]", values.join(", ")))
            }
            Value::Table(_) => "a table".into(),
        }
    }
}

/// At most the first 40 characters of `text`, so that no file makes a message endless.
pub fn shortened(text: &str) -> String {
    match text.char_indices().nth(40) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.into(),
    }
}
