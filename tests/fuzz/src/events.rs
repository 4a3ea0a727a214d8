//! Fuzz target: the parser of live events.
#![no_main]

mod memory;
#[path = "../targets/events.rs"]
mod target;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|lines: &[u8]| memory::with_limit(|| target::read(lines)));
