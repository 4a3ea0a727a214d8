//! Error against cost: the errors of each solver on hard scenes, beside the time they cost.
//!
//! A [`Case`] is a scene with the rates at which it is run. Its [`Expectation`], the correct result,
//! comes from [`oracle`], which shares no code with the solvers. [`Errors`] of a run are
//! deterministic; [`Cost`] is measured. Both together form a [`Row`] of the report, which is printed
//! as a [`table`](table()) or drawn as diagrams.

mod case;
pub mod cases;
mod cost;
#[cfg(feature = "draw")]
mod diagram;
mod errors;
pub mod oracle;
mod table;

pub use case::{Case, RunSpec};
pub use cost::Cost;
#[cfg(feature = "draw")]
pub use diagram::{growth, work_precision};
pub use errors::{Errors, Growth};
pub use oracle::{Expectation, Oracle};
pub use table::{CSV_HEADER, Row, csv, table};

/// The time that a report may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Budget {
    /// A few minutes: cases and runs that take longer are left out.
    Minutes,
    /// Hours: only runs that would take days are left out.
    Hours,
}

impl Budget {
    /// The greatest number of pair tests in a run of the handout solver.
    const fn max_pair_tests(self) -> u64 {
        match self {
            Budget::Minutes => 1_000_000_000,
            Budget::Hours => 1_000_000_000_000,
        }
    }
}
