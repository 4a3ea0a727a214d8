//! Snapshot regression testing: recordings that must replay and pictures that must come out again.
//!
//! [`find`] looks through folders for [`Case`]s, [`examine`] makes a [`Finding`] of each, and
//! a [`Page`] shows what differs. Comparison is exact: every bit of every state; of a PNG, GIF or
//! animated PNG every pixel, every instant and what it says of itself, but not how it is compressed;
//! of an SVG or PDF every byte, but for the version of the program that drew it.

mod case;
mod drift;
mod examine;
mod find;
mod finding;
mod mismatch;
mod page;
mod recording;
mod reference;

pub use case::{Case, Drawing, Reference};
pub use drift::Drift;
pub use examine::examine;
pub use find::{CheckError, MANIFEST_EXTENSION, find, plain};
pub use finding::{Finding, Fresh, Grade, Outcome};
pub use mismatch::{Mismatch, mismatch};
pub use page::Page;
