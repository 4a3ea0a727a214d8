//! A bound on memory: an input that needs more is a finding.

use std::alloc::System;

use cap::Cap;

#[global_allocator]
static ALLOCATOR: Cap<System> = Cap::new(System, usize::MAX);

/// What reading one input may take at most, bytes.
const MOST: usize = 100 << 20;

/// Does the work with so little memory that asking for more ends the process.
pub fn bounded(work: impl FnOnce()) {
    ALLOCATOR.set_limit(ALLOCATOR.allocated() + MOST).expect("more than is in use");
    work();
    ALLOCATOR.set_limit(usize::MAX).expect("more than is in use");
}
