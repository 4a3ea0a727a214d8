use std::ops::Range;

use super::node::{Entry, Node, Reading, Value, shortened};
use crate::scene::{Fault, refusal::Refusal};

/// A key of the format and what it accepts, in words.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    pub name: &'static str,
    pub accepts: &'static str,
}

/// A table all of whose keys are known.
pub struct Table<'a> {
    /// What messages put before its keys; empty for the document itself.
    pub name: &'static str,
    pub span: Range<usize>,
    entries: &'a [Entry],
}

/// The value of one key of a table.
pub struct Field<'a> {
    table: &'static str,
    key: &'a str,
    accepts: &'static str,
    pub node: &'a Node,
}

impl<'a> Table<'a> {
    /// The table `name`, which may have `keys`.
    pub fn open(name: &'static str, node: &'a Node, keys: &[Key]) -> Result<Table<'a>, Refusal> {
        let table = Table::of_any_keys(name, node)?;
        if let Some(stranger) = table.entries.iter().find(|entry| keys.iter().all(|key| key.name != entry.key)) {
            return Err(unknown_key(name, stranger, keys));
        }
        match keys.iter().find_map(|key| repeated(name, *key, table.entries)) {
            Some(refusal) => Err(refusal),
            None => Ok(table),
        }
    }

    /// The table `name`, whose keys the scene's author chooses.
    pub fn of_any_keys(name: &'static str, node: &'a Node) -> Result<Table<'a>, Refusal> {
        let Value::Table(entries) = &node.value else {
            let fault = Fault::BadValue { key: name.into(), found: node.in_words(), accepts: "a table of keys" };
            return Err(Refusal::new(fault, node.span.clone()));
        };
        Ok(Table { name, span: node.span.clone(), entries })
    }

    /// What stands in it, in the order of the text.
    pub fn entries(&self) -> &'a [Entry] {
        self.entries
    }

    /// The value of `key`, if it is there.
    pub fn get(&self, key: Key) -> Option<Field<'a>> {
        let entry = self.entries.iter().find(|entry| entry.key == key.name)?;
        Some(self.field(entry, key.accepts))
    }

    /// The value of an entry of the table.
    pub fn field(&self, entry: &'a Entry, accepts: &'static str) -> Field<'a> {
        Field { table: self.name, key: &entry.key, accepts, node: &entry.node }
    }

    /// The value of `key`, which has to be there.
    pub fn require(&self, key: Key) -> Result<Field<'a>, Refusal> {
        self.get(key).ok_or_else(|| self.missing(key))
    }

    /// The refusal of the table for want of `key`.
    pub fn missing(&self, key: Key) -> Refusal {
        let fault = Fault::MissingKey { key: full_name(self.name, key.name), accepts: key.accepts };
        Refusal::new(fault, self.span.clone())
    }

    /// What `read` makes of the value of `key`, if it is there.
    pub fn optional<T>(&self, key: Key, read: impl FnOnce(&'a Node) -> Reading<'a, T>) -> Result<Option<T>, Refusal> {
        self.get(key).map(|field| field.read(read)).transpose()
    }

    /// What `read` makes of the value of `key`, which has to be there.
    pub fn required<T>(&self, key: Key, read: impl FnOnce(&'a Node) -> Reading<'a, T>) -> Result<T, Refusal> {
        self.require(key)?.read(read)
    }
}

impl<'a> Field<'a> {
    /// What `read` makes of the value; a refusal underlines the part it could not read.
    pub fn read<T>(&self, read: impl FnOnce(&'a Node) -> Reading<'a, T>) -> Result<T, Refusal> {
        read(self.node).map_err(|part| self.refuse(part))
    }

    /// The refusal of a part of the value, or of all of it.
    pub fn refuse(&self, part: &Node) -> Refusal {
        let fault = Fault::BadValue {
            key: shortened(&full_name(self.table, self.key)),
            found: part.in_words(),
            accepts: self.accepts,
        };
        Refusal::new(fault, part.span.clone())
    }
}

/// A key as messages write it.
fn full_name(table: &str, key: &str) -> String {
    if table.is_empty() { key.into() } else { format!("{table}.{key}") }
}

/// The refusal of a key that is none of `keys`.
pub fn unknown_key(table: &str, stranger: &Entry, keys: &[Key]) -> Refusal {
    let fault = Fault::UnknownKey {
        key: shortened(&full_name(table, &stranger.key)),
        nearest: nearest(&stranger.key, keys),
        accepts: keys.iter().map(|key| key.name).collect(),
    };
    Refusal::new(fault, stranger.span.clone())
}

/// The refusal of a key that is there twice, which JSON lets pass.
fn repeated(table: &str, key: Key, entries: &[Entry]) -> Option<Refusal> {
    let mut places = entries.iter().filter(|entry| entry.key == key.name).map(|entry| entry.span.clone());
    let (first, second) = (places.next()?, places.next()?);
    Some(Refusal::new(Fault::DuplicateKey { key: full_name(table, key.name) }, second).after(first))
}

/// The key that was probably meant: at most two slips away, and not a different word altogether.
fn nearest(written: &str, keys: &[Key]) -> Option<&'static str> {
    if written.len() > 32 {
        return None; // the distance is quadratic in the length
    }
    let slips = |key: &Key| strsim::osa_distance(&written.to_lowercase(), key.name);
    let nearest = keys.iter().min_by_key(|key| slips(key))?;
    (slips(nearest) <= 2 && slips(nearest) < nearest.name.len()).then_some(nearest.name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn suggests_only_what_is_near() {
        let keys = ["at", "size", "mass", "velocity"].map(|name| Key { name, accepts: "" });
        assert_eq!(nearest("veloctiy", &keys), Some("velocity"));
        assert_eq!(nearest("Mass", &keys), Some("mass"));
        assert_eq!(nearest("siz", &keys), Some("size"));
        assert_eq!(nearest("zz", &keys), None, "two slips make any word of two letters");
        assert_eq!(nearest("position", &keys), None);
    }
}
