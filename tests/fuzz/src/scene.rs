//! Fuzz target: the parser of scenes.
#![no_main]

mod memory;
#[path = "../targets/scene.rs"]
mod target;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| memory::with_limit(|| target::read(text)));
