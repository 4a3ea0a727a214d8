//! Throws lines at what reads events while a run goes on.
#![no_main]

mod memory;
#[path = "../targets/events.rs"]
mod target;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|lines: &[u8]| memory::bounded(|| target::read(lines)));
