//! The hard cases, by family.

mod bounces;
mod case_spec;
mod contacts;
mod growth;
mod impacts;
mod many_bodies;

use super::Case;

/// Returns the hard cases in the order of the report; `full` adds those that take long.
pub fn all(full: bool) -> Vec<Case> {
    [bounces::cases(full), impacts::cases(full), contacts::cases(full), many_bodies::cases(full)]
        .into_iter()
        .flatten()
        .collect()
}

pub use growth::{FAMILIES as GROWTH, cases as growth};
