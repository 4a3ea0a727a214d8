//! Snapshot regression tests of recordings and pictures.
//!
//! [`Files`] searches folders for [`Case`]s, [`check_cases`] replays or redraws each of them, and a [`Page`] shows the
//! differences. Comparison is exact. Of a recording, every bit of every state is compared; of a PNG, GIF or animated
//! PNG, every pixel, every frame duration and the provenance, but not the compression; of an SVG or PDF, every byte
//! except the version of the program that drew it.

mod case;
mod check_result;
mod mismatch;
mod page;
mod recording;
mod reference_image;

pub use case::{Case, CheckError, Files, Recipe, ReferenceImage, normalize};
pub use check_result::{CheckResult, Outcome, Replacement, Severity};
pub use mismatch::{Mismatch, mismatch};
pub use page::Page;
pub use recording::{SceneMismatch, TemporaryRecording};

use crate::picture::ordered_parallel_map;
use std::num::NonZero;

/// Checks every case on `threads` threads and passes the results to `on_result` in the order of the cases.
///
/// # Errors
/// The first error of `on_result`.
pub fn check_cases<E: Send>(
    cases: &[Case],
    threads: NonZero<usize>,
    on_result: impl FnMut(CheckResult) -> Result<(), E>,
) -> Result<(), E> {
    ordered_parallel_map(cases.iter().map(Ok), threads, || check_case, on_result)
}

fn check_case(case: &Case) -> CheckResult {
    match case {
        Case::Recording { path, scene } => recording::check_recording(path, scene.as_deref()),
        Case::Picture(reference) => reference_image::check_image(reference),
    }
}
