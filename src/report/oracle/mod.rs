//! Correct results of scenes, computed by code that shares nothing with the solvers.
//!
//! `closed_form` holds formulas; [`PreciseSimulator`] is for scenes without one: it predicts the impacts
//! of every pair of boxes with 77 decimals ([`Fixed256`]). It is slow and simple, so that its
//! correctness can be seen from the code.

pub mod closed_form;
mod fixed256;
mod precise_simulator;

pub use fixed256::Fixed256;
pub use precise_simulator::{PreciseSimulator, Unsuitable};
