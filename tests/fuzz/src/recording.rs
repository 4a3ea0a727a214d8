//! Fuzz target: the reader of recordings.
#![no_main]

mod memory;
mod structure;
#[path = "../targets/recording.rs"]
mod target;

use libfuzzer_sys::{fuzz_mutator, fuzz_target, fuzzer_mutate};
use structure::{Compression, Part, Structure, Summary};

fuzz_target!(|file: &[u8]| memory::with_limit(|| target::read(file)));

// Mutations of bytes only break a length or a checksum. Most mutations therefore alter records, after which lengths,
// checksums and index are made right again, so that the alteration reaches the code behind them.
fuzz_mutator!(|file: &mut [u8], size: usize, max_size: usize, seed: u32| {
    let mut dice = Dice(seed);
    let altered = if dice.roll(8) == 0 { None } else { with_altered_records(&file[..size], &mut dice) };
    match altered.filter(|altered| altered.len() <= max_size) {
        Some(altered) => {
            file[..altered.len()].copy_from_slice(&altered);
            altered.len()
        }
        None => fuzzer_mutate(file, size, max_size),
    }
});

/// Returns a file with one to three altered records, or `None` if there are no records.
fn with_altered_records(file: &[u8], dice: &mut Dice) -> Option<Vec<u8>> {
    let mut structure = Structure::parse(file)?;
    for _ in 0..=dice.roll(3) {
        match dice.roll(3) {
            0 => alter_order(&mut structure, dice),
            _ => alter_fields(&mut structure, dice),
        }
    }
    if dice.roll(8) != 0 {
        structure.agree();
    }
    let summary = if dice.roll(4) == 0 { Summary::Missing } else { Summary::Written };
    let compression = [Compression::None, Compression::None, Compression::Zstd, Compression::Lz4][dice.roll(4)];
    Some(structure.write(summary, compression))
}

/// Alters the fields of a record.
fn alter_fields(structure: &mut Structure, dice: &mut Dice) {
    const SPACE: usize = 64;
    let mut records = structure.records_mut();
    if records.is_empty() {
        return;
    }
    let index = dice.roll(records.len());
    let fields = &mut records[index].fields;
    let words = fields.len() / 4;
    match dice.roll(2) {
        // Numbers in messages are aligned to 4 bytes from the end of the header of the message, or to 2.
        0 if words > 1 => {
            let numbers = [0, 1, u64::MAX, f64::NAN.to_bits(), f64::INFINITY.to_bits(), f64::MAX.to_bits(), 1 << 63];
            let offset = 4 * dice.roll(words - 1) + 2 * dice.roll(2);
            if let Some(place) = fields.get_mut(offset..offset + 8) {
                let number = u64::from_le_bytes(place.try_into().expect("eight bytes"));
                let number = match dice.roll(4) {
                    0 => number.wrapping_add(1),
                    1 => number.wrapping_sub(1),
                    _ => numbers[dice.roll(numbers.len())],
                };
                place.copy_from_slice(&number.to_le_bytes());
            }
        }
        _ => {
            let size = fields.len();
            fields.resize(size + SPACE, 0);
            let size = fuzzer_mutate(fields, size, size + SPACE);
            fields.truncate(size);
        }
    }
}

/// Removes, repeats or moves a part or a record of a chunk, or divides a chunk or dissolves it into its records.
fn alter_order(structure: &mut Structure, dice: &mut Dice) {
    let parts = &mut structure.parts;
    if parts.is_empty() {
        return;
    }
    let index = dice.roll(parts.len());
    match (&mut parts[index], dice.roll(6)) {
        (Part::Chunk(records), 0) => {
            let records = std::mem::take(records);
            parts.splice(index..=index, records.into_iter().map(Part::Record));
        }
        (Part::Chunk(records), 1) => {
            let second = records.split_off(dice.roll(records.len() + 1));
            parts.insert(index + 1, Part::Chunk(second));
        }
        (Part::Chunk(records), 2) if !records.is_empty() => {
            let record = records.remove(dice.roll(records.len()));
            records.insert(dice.roll(records.len() + 1), record);
        }
        (Part::Chunk(records), 3) if !records.is_empty() => {
            let record = records[dice.roll(records.len())].clone();
            records.insert(dice.roll(records.len() + 1), record);
        }
        (Part::Chunk(records), 4) if !records.is_empty() => _ = records.remove(dice.roll(records.len())),
        (Part::Record(record), 0) => {
            let record = record.clone();
            parts.insert(dice.roll(parts.len() + 1), Part::Record(record));
        }
        (Part::Record(_), 1) => _ = parts.remove(index),
        (Part::Record(_) | Part::Chunk(_), _) => {
            let part = parts.remove(index);
            parts.insert(dice.roll(parts.len() + 1), part);
        }
    }
}

/// A sequence of numbers that is determined by its seed.
struct Dice(u32);

impl Dice {
    /// Returns a number below `sides`.
    fn roll(&mut self, sides: usize) -> usize {
        // A step of an LCG, whose upper bits are used.
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) as usize % sides
    }
}
