//! Throws texts at the reader of scenes.
#![no_main]

mod memory;
#[path = "../targets/scene.rs"]
mod target;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| memory::bounded(|| target::read(text)));
