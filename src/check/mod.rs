//! Snapshot regression tests of recordings and pictures.
//!
//! [`Files`] searches folders for [`Cases`], [`check_cases`] replays or redraws each of them, and a [`Page`] shows the
//! differences. Comparison is exact. Of a recording, every bit of every state is compared; of a PNG, GIF or animated
//! PNG, every pixel, every frame duration and the provenance, but not the compression; of an SVG or PDF, every byte
//! except the version of the program that drew it. An [`Acceptance`] decides which files may be replaced.

mod acceptance;
mod case;
mod check_result;
mod files;
mod mismatch;
mod page;
mod recording;
mod recording_index;
mod reference_image;
mod scene_mismatch;

pub use acceptance::{Acceptance, Decision, carries_provenance};
pub use case::{
    Case, Cases, Manifest, ManifestLine, Override, Problem, Recipe, RecordCommand, RecordingRecipe, ReferenceImage,
    ReferenceRecording,
};
pub use check_result::{Basis, CheckResult, FileKind, Outcome, Replacement, Severity};
pub use files::{Files, normalize, pending_path};
pub use mismatch::{Mismatch, ShownPicture, mismatch};
pub use page::Page;
pub use recording::make_recording;
pub use recording_index::RecordingIndex;
pub use scene_mismatch::{RunDifference, SceneLine, SceneMismatch, ValueChange};

use crate::picture::ordered_parallel_map;
use std::any::Any;
use std::num::NonZero;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Calls `check`, such as [`check_case`], for every case on `threads` threads, and passes the results to `on_result` in
/// the order of the cases.
///
/// A panic in a case is the result of that case.
///
/// # Errors
/// The first error of `on_result`.
pub fn check_cases<E: Send>(
    cases: &[Case],
    check: impl Fn(&Case) -> CheckResult + Sync,
    threads: NonZero<usize>,
    on_result: impl FnMut(CheckResult) -> Result<(), E>,
) -> Result<(), E> {
    let check = |case: &Case| {
        catch_unwind(AssertUnwindSafe(|| check(case)))
            .unwrap_or_else(|panic| CheckResult::new(case.path().into(), Outcome::Failed(describe_panic(&*panic))))
    };
    ordered_parallel_map(cases.iter().map(Ok), threads, || check, on_result)
}

/// Checks one case. `index` finds the recordings of pictures.
pub fn check_case(case: &Case, index: &RecordingIndex) -> CheckResult {
    match case {
        Case::Recording(reference) => recording::check_recording(reference),
        Case::Picture(reference) => reference_image::check_image(reference, index),
        Case::Problem(Problem { path, line, reason, is_missing }) => {
            let outcome = if *is_missing { Outcome::Missing } else { Outcome::Failed };
            CheckResult { line: line.clone(), ..CheckResult::new(path.clone(), outcome(reason.clone())) }
        }
    }
}

/// The message of a panic.
fn describe_panic(panic: &(dyn Any + Send)) -> String {
    let message = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
    let message = message.unwrap_or("without a message");
    format!("rebond panicked: {message}; this is a bug in rebond, please report it with this file")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_in_a_case_is_the_result_of_that_case_and_the_others_are_checked() {
        let problem = |name: &str| Problem { path: name.into(), line: None, reason: "it".into(), is_missing: true };
        let cases = ["a", "b", "c", "d"].map(|name| Case::Problem(problem(name)));
        let check = |case: &Case| match case.path().to_str() {
            Some("b") => panic!("a bug at b"),
            Some("c") => std::panic::panic_any(3_u8),
            _ => check_case(case, &RecordingIndex::default()),
        };
        for threads in [1, 3] {
            let mut lines = Vec::new();
            let add = |result: CheckResult| {
                lines.push(format!("{}: {}", result.path.display(), result.outcome));
                Ok::<(), ()>(())
            };
            check_cases(&cases, check, NonZero::new(threads).unwrap(), add).unwrap();
            let bug = "this is a bug in rebond, please report it with this file";
            let expected = [
                "a: missing: it".to_owned(),
                format!("b: failed: rebond panicked: a bug at b; {bug}"),
                format!("c: failed: rebond panicked: without a message; {bug}"),
                "d: missing: it".to_owned(),
            ];
            assert_eq!(lines, expected);
        }
    }
}
