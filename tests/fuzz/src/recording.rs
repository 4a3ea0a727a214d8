//! Throws files at the reader of recordings.
#![no_main]

mod memory;
#[path = "../targets/recording.rs"]
mod target;
mod unsealed;

use libfuzzer_sys::{fuzz_mutator, fuzz_target, fuzzer_mutate};

fuzz_target!(|file: &[u8]| memory::bounded(|| target::read(file)));

fuzz_mutator!(|file: &mut [u8], size: usize, max_size: usize, seed: u32| {
    // Most files only fail their checksums: without them mutations get further.
    let unsealed = if seed.is_multiple_of(4) { unsealed::unsealed(&file[..size]) } else { None };
    match unsealed.filter(|unsealed| unsealed.len() <= max_size) {
        Some(unsealed) => {
            file[..unsealed.len()].copy_from_slice(&unsealed);
            fuzzer_mutate(file, unsealed.len(), max_size)
        }
        None => fuzzer_mutate(file, size, max_size),
    }
});
