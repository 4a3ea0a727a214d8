//! The hard cases, family by family.

mod bounces;
mod contacts;
mod crowds;
mod draft;
mod growth;
mod impacts;

use super::Case;

/// The hard cases in the order of the report; `full` adds those that take long.
pub fn all(full: bool) -> Vec<Case> {
    [bounces::cases(full), impacts::cases(full), contacts::cases(full), crowds::cases(full)]
        .into_iter()
        .flatten()
        .collect()
}

pub use growth::{FAMILIES as GROWTH, cases as growth};
