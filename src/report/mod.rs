//! Speed against error: what each solver gets wrong on hard scenes, and what that costs.
//!
//! A [`Case`] is a scene at several rates and what it should come to, its [`Expectation`], which
//! comes from [`truth`] and never from the code that is judged. [`Errors`] are of one run and are
//! the same each time; [`Cost`] is measured. Together they are a [`Row`].

mod case;
pub mod cases;
mod clock;
mod cost;
mod diagram;
mod errors;
mod expectation;
mod memory;
mod remark;
mod row;
mod table;
pub mod truth;

pub use case::{Case, Formula, Place, SOLVERS, Trial, Truth};
pub use clock::CLOCK;
pub use cost::Cost;
pub use diagram::{growth, work_precision};
pub use errors::Errors;
pub use expectation::Expectation;
pub use row::{Row, left_out};
pub use table::{HEADING, csv, table};
