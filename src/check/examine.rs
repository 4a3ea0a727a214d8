use super::{Case, Finding, recording, reference};
use crate::render::in_order;
use std::num::NonZero;

/// Examines every case on `threads` threads and hands the findings to `told` in the order of the
/// cases, whatever finished first.
///
/// # Errors
/// The first error of `told`.
pub fn examine<E: Send>(
    cases: &[Case],
    threads: NonZero<usize>,
    told: impl FnMut(Finding) -> Result<(), E>,
) -> Result<(), E> {
    in_order(cases.iter().map(Ok), threads, || one, told)
}

fn one(case: &Case) -> Finding {
    match case {
        Case::Recording { path, scene } => recording::examine(path, scene.as_deref()),
        Case::Picture(reference) => reference::examine(reference),
    }
}
