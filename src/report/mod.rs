//! Error against cost: the errors of each solver on hard scenes, beside the time they cost.
//!
//! A [`Case`] is a scene with the rates at which it is run. Its [`Expectation`], the correct result,
//! comes from [`oracle`], which shares no code with the solvers. [`Errors`] of a run are
//! deterministic; [`Cost`] is measured. Both together form a [`Row`] of the report.

mod case;
pub mod cases;
mod clock;
mod cost;
mod diagram;
mod errors;
mod expectation;
mod memory;
mod notes;
pub mod oracle;
mod row;
mod table;

pub use case::{Case, Formula, Oracle, Position, RunSpec, SOLVERS};
pub use clock::CLOCK;
pub use cost::Cost;
pub use diagram::{growth, work_precision};
pub use errors::Errors;
pub use expectation::Expectation;
pub use row::{Row, skip_reason};
pub use table::{HEADING, csv, table};
