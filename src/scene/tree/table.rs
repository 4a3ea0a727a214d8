use super::{Entry, Node, ReadResult, Value, shortened};
use crate::scene::{
    Diagnostic, DiagnosticKind,
    diagnostic::{ErrorReported, Reporter},
};
use std::ops::Range;

/// A key of the format and a description of the values it accepts.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    pub name: &'static str,
    pub accepts: &'static str,
}

/// A table and the keys that it may have.
pub struct Table<'a> {
    /// Its name in messages, before its keys; empty for the document itself.
    pub name: &'static str,
    pub span: Range<usize>,
    entries: &'a [Entry],
    unknown: Vec<UnknownKey>,
    reporter: &'a Reporter,
}

/// An unknown key of a table, which was reported.
struct UnknownKey {
    /// The key that it was probably meant to be.
    nearest: Option<&'static str>,
    is_list: bool,
    reported: ErrorReported,
}

/// The value of one key of a table.
pub struct Field<'a> {
    table: &'static str,
    key: &'a str,
    accepts: &'static str,
    pub node: &'a Node,
    reporter: &'a Reporter,
}

impl<'a> Table<'a> {
    /// The table `name`, which may have the given keys; reports all other keys and repeated ones.
    pub fn open(
        name: &'static str,
        node: &'a Node,
        keys: &[Key],
        reporter: &'a Reporter,
    ) -> Result<Table<'a>, ErrorReported> {
        let mut table = Table::with_any_keys(name, node, reporter)?;
        for entry in table.entries.iter().filter(|entry| keys.iter().all(|key| key.name != entry.key)) {
            table.unknown.push(UnknownKey {
                nearest: nearest(&entry.key, keys),
                is_list: matches!(entry.node.value, Value::List(_)),
                reported: reporter.report(unknown_key(name, entry, keys)),
            });
        }
        for key in keys {
            table.report_repeated(*key);
        }
        Ok(table)
    }

    /// The table `name`, whose keys the author of the scene chooses.
    pub fn with_any_keys(
        name: &'static str,
        node: &'a Node,
        reporter: &'a Reporter,
    ) -> Result<Table<'a>, ErrorReported> {
        let Value::Table(entries) = &node.value else {
            let kind =
                DiagnosticKind::InvalidValue { key: name.into(), found: node.describe(), accepts: "a table of keys" };
            return Err(reporter.report(Diagnostic::new(kind, node.span.clone())));
        };
        Ok(Table { name, span: node.span.clone(), entries, unknown: Vec::new(), reporter })
    }

    /// Its entries in the order of the text.
    pub fn entries(&self) -> &'a [Entry] {
        self.entries
    }

    /// The reporter of its errors.
    pub fn reporter(&self) -> &'a Reporter {
        self.reporter
    }

    /// The value of `key`, if given. An unknown key that is probably a misspelling of `key` is an error.
    pub fn get(&self, key: Key) -> Result<Option<Field<'a>>, ErrorReported> {
        match (self.entry(key), self.misspelling(|unknown| unknown.nearest == Some(key.name))) {
            (Some(entry), _) => Ok(Some(self.field(entry, key.accepts))),
            (None, Some(reported)) => Err(reported),
            (None, None) => Ok(None),
        }
    }

    /// The value of `key`, which is required.
    ///
    /// It is not reported as missing if an unknown key may be a misspelling of it.
    pub fn require(&self, key: Key) -> Result<Field<'a>, ErrorReported> {
        match self.get(key)? {
            Some(field) => Ok(field),
            None => Err(self.report_missing(key)),
        }
    }

    /// Reports that the table lacks `key`, unless an unknown key may be a misspelling of it.
    pub fn report_missing(&self, key: Key) -> ErrorReported {
        let misspelling = |unknown: &UnknownKey| unknown.nearest.is_none_or(|nearest| nearest == key.name);
        self.misspelling(misspelling).unwrap_or_else(|| {
            let kind = DiagnosticKind::MissingKey { key: full_name(self.name, key.name), accepts: key.accepts };
            self.reporter.report(Diagnostic::new(kind, self.span.clone()))
        })
    }

    /// The error of the first unknown key, if there is one.
    pub fn first_unknown(&self) -> Option<ErrorReported> {
        self.misspelling(|_| true)
    }

    /// The error of an unknown list of tables whose key may be a misspelling of `key`. `key` itself may be given, too.
    pub fn misspelled_lists(&self, key: Key) -> Option<ErrorReported> {
        self.misspelling(|unknown| match unknown.nearest {
            Some(nearest) => nearest == key.name,
            None => unknown.is_list,
        })
    }

    /// The value of an entry of the table.
    pub fn field(&self, entry: &'a Entry, accepts: &'static str) -> Field<'a> {
        Field { table: self.name, key: &entry.key, accepts, node: &entry.node, reporter: self.reporter }
    }

    /// Reads the value of `key`, if given.
    pub fn optional<T>(
        &self,
        key: Key,
        read: impl FnOnce(&'a Node) -> ReadResult<'a, T>,
    ) -> Result<Option<T>, ErrorReported> {
        self.get(key)?.map(|field| field.read(read)).transpose()
    }

    /// Reads the value of `key`, which is required.
    pub fn required<T>(&self, key: Key, read: impl FnOnce(&'a Node) -> ReadResult<'a, T>) -> Result<T, ErrorReported> {
        self.require(key)?.read(read)
    }

    /// The location of the value of `key`, if given.
    pub fn span_of(&self, key: Key) -> Option<Range<usize>> {
        self.entry(key).map(|entry| entry.node.span.clone())
    }

    fn entry(&self, key: Key) -> Option<&'a Entry> {
        self.entries.iter().find(|entry| entry.key == key.name)
    }

    fn misspelling(&self, is_misspelling: impl Fn(&UnknownKey) -> bool) -> Option<ErrorReported> {
        self.unknown.iter().find(|unknown| is_misspelling(unknown)).map(|unknown| unknown.reported)
    }

    /// Reports a key that is given twice, which is valid JSON.
    fn report_repeated(&self, key: Key) {
        let mut spans = self.entries.iter().filter(|entry| entry.key == key.name).map(|entry| entry.span.clone());
        if let (Some(first), Some(second)) = (spans.next(), spans.next()) {
            let kind = DiagnosticKind::DuplicateKey { key: full_name(self.name, key.name) };
            self.reporter.report(Diagnostic::new(kind, second).conflicting_with(first));
        }
    }
}

impl<'a> Field<'a> {
    /// Reads the value; an error underlines the part that is not accepted.
    pub fn read<T>(&self, read: impl FnOnce(&'a Node) -> ReadResult<'a, T>) -> Result<T, ErrorReported> {
        read(self.node).map_err(|part| self.refuse(part))
    }

    /// The same field with a narrower description of the values that it accepts.
    pub fn accepting(&self, accepts: &'static str) -> Field<'a> {
        Field { accepts, ..*self }
    }

    /// Reports that a part of the value, or all of it, is not accepted.
    pub fn refuse(&self, part: &Node) -> ErrorReported {
        let kind = DiagnosticKind::InvalidValue {
            key: shortened(&full_name(self.table, self.key)),
            found: part.describe(),
            accepts: self.accepts,
        };
        self.report(Diagnostic::new(kind, part.span.clone()))
    }

    /// Reports an error of the value.
    pub fn report(&self, diagnostic: Diagnostic) -> ErrorReported {
        self.reporter.report(diagnostic)
    }
}

/// A key as messages show it.
fn full_name(table: &str, key: &str) -> String {
    if table.is_empty() { key.into() } else { format!("{table}.{key}") }
}

/// The error of a key that is not one of `keys`.
pub fn unknown_key(table: &str, entry: &Entry, keys: &[Key]) -> Diagnostic {
    let kind = DiagnosticKind::UnknownKey {
        key: shortened(&full_name(table, &entry.key)),
        nearest: nearest(&entry.key, keys),
        accepts: keys.iter().map(|key| key.name).collect(),
    };
    Diagnostic::new(kind, entry.span.clone())
}

/// The key that was probably meant: at most two edits away, and fewer edits than it has letters.
fn nearest(written: &str, keys: &[Key]) -> Option<&'static str> {
    if written.len() > 32 {
        return None; // The distance takes time quadratic in the length.
    }
    let edits = |key: &Key| strsim::osa_distance(&written.to_lowercase(), key.name);
    let nearest = keys.iter().min_by_key(|key| edits(key))?;
    (edits(nearest) <= 2 && edits(nearest) < nearest.name.len()).then_some(nearest.name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_similar_keys_are_suggested() {
        let keys = ["at", "size", "mass", "velocity"].map(|name| Key { name, accepts: "" });
        assert_eq!(nearest("veloctiy", &keys), Some("velocity"));
        assert_eq!(nearest("Mass", &keys), Some("mass"));
        assert_eq!(nearest("siz", &keys), Some("size"));
        assert_eq!(nearest("zz", &keys), None, "two edits turn any word of two letters into any other");
        assert_eq!(nearest("position", &keys), None);
    }
}
