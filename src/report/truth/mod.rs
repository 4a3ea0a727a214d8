//! What is true of a scene, found in a way that shares nothing with the solvers.
//!
//! `closed_form` holds the formulas of mechanics; [`Reference`] is for scenes that have none: it
//! looks at every pair of boxes, and every meeting is a root to 77 decimals ([`Number`]). It is
//! slow and plain, so that one can see that it is right.

pub mod closed_form;
mod number;
mod reference;

pub use number::Number;
pub use reference::{Reference, Unsuitable};
