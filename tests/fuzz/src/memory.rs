//! A limit on memory: an input that needs more is reported as a crash.

use std::alloc::System;

use cap::Cap;

#[global_allocator]
static ALLOCATOR: Cap<System> = Cap::new(System, usize::MAX);

/// The largest amount of memory for one input, bytes.
const MAX_BYTES: usize = 100 << 20;

/// Calls `work` with limited memory. Exceeding the limit aborts the process.
pub fn with_limit(work: impl FnOnce()) {
    ALLOCATOR.set_limit(ALLOCATOR.allocated() + MAX_BYTES).expect("the limit exceeds the memory in use");
    work();
    ALLOCATOR.set_limit(usize::MAX).expect("the limit exceeds the memory in use");
}
