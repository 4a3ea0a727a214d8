//! A common tree of TOML and JSON documents in which every value has its location in the text.
//!
//! Scenes and live events have the same keys, so one reader serves both.

mod json;
mod node;
mod table;
mod toml;

pub use self::toml::parse_toml;
pub use json::parse_json;
pub use node::{Entry, Node, Value};
pub use table::{Field, Key, Table, unknown_key};
