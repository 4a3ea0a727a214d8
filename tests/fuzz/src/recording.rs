//! Fuzz target: the reader of recordings.
#![no_main]

mod memory;
#[path = "../targets/recording.rs"]
mod target;
mod without_checksums;

use libfuzzer_sys::{fuzz_mutator, fuzz_target, fuzzer_mutate};

fuzz_target!(|file: &[u8]| memory::with_limit(|| target::read(file)));

fuzz_mutator!(|file: &mut [u8], size: usize, max_size: usize, seed: u32| {
    // Most mutations only break a checksum. Without checksums they reach more code.
    let stripped = if seed.is_multiple_of(4) { without_checksums::without_checksums(&file[..size]) } else { None };
    match stripped.filter(|stripped| stripped.len() <= max_size) {
        Some(stripped) => {
            file[..stripped.len()].copy_from_slice(&stripped);
            fuzzer_mutate(file, stripped.len(), max_size)
        }
        None => fuzzer_mutate(file, size, max_size),
    }
});
