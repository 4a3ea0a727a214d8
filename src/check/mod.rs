//! Snapshot regression tests of recordings and pictures.
//!
//! [`find`] searches folders for [`Case`]s, [`check_cases`] replays or redraws each of them, and a [`Page`] shows the
//! differences. Comparison is exact. Of a recording, every bit of every state is compared; of a PNG, GIF or animated
//! PNG, every pixel, every frame duration and the provenance, but not the compression; of an SVG or PDF, every byte
//! except the version of the program that drew it.

mod case;
mod check_cases;
mod check_result;
mod find;
mod mismatch;
mod page;
mod recording;
mod reference_image;
mod scene_mismatch;

pub use case::{Case, Recipe, ReferenceImage};
pub use check_cases::check_cases;
pub use check_result::{CheckResult, Outcome, Replacement, Severity};
pub use find::{CheckError, MANIFEST_EXTENSION, find, normalize};
pub use mismatch::{Mismatch, mismatch};
pub use page::Page;
pub use scene_mismatch::SceneMismatch;
