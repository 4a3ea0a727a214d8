//! Speed against error.

mod case;
pub mod cases;
mod clock;
mod cost;
mod errors;
mod expectation;
mod memory;
mod remark;
mod row;
mod table;
pub mod truth;

pub use case::{Case, SOLVERS, Trial, Truth};
pub use clock::CLOCK;
pub use cost::Cost;
pub use errors::Errors;
pub use expectation::Expectation;
pub use row::{Row, left_out};
pub use table::{HEADING, csv, table};
