use super::{Case, CheckResult, recording, reference_image};
use crate::render::ordered_parallel_map;
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
