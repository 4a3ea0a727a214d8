//! TOML and JSON as one tree whose every value knows where in the text it stands.
//!
//! Both formats have the same keys, so what reads them reads this.

mod json;
mod node;
mod table;
mod toml;

pub use self::toml::parse_toml;
pub use json::parse_json;
pub use node::{Entry, Node, Value};
pub use table::{Field, Key, Table, unknown_key};
