//! Decompresses the part of the engine with which the page starts: DEFLATE (RFC 1951), of which `inline.mjs` has
//! written each 13 bits, some 14, as two of 94 characters. `src/page/build` makes a WebAssembly module of this file
//! alone.
//!
//! The module is the part of the page that cannot be compressed. It has 3.7 kB; with the crate miniz_oxide 0.8.9 and the
//! same options of the compiler it has 11.4 kB. A decompressor in JavaScript takes ten times as long, because it has not
//! been compiled when the page opens, and `DecompressionStream` waits for its turn among the tasks that lay out the
//! page. Browsers run the module without optimisations, so loops are short.
#![no_std]

use core::slice;

/// The number of bits of the longest code.
const LONGEST: usize = 15;

/// The number of bits of the longest code that is found in one look.
const SHORT: usize = 10;

/// The codes of symbols. A symbol of length 0 has none.
struct Codes {
    /// For each sequence of [`SHORT`] bits: 16 times the symbol that it begins with, plus the length of its code; 0 if
    /// that is longer.
    short: [u16; 1 << SHORT],
    /// The number of codes of each length.
    counts: [u16; LONGEST + 1],
    /// The symbols in the order of their codes.
    symbols: [u16; 320],
}

impl Codes {
    const EMPTY: Codes = Codes { short: [0; 1 << SHORT], counts: [0; LONGEST + 1], symbols: [0; 320] };

    /// Makes the canonical codes with these lengths.
    fn assign(&mut self, lengths: &[u8]) {
        *self = Codes::EMPTY;
        let (mut code, mut at) = (0_u32, 0);
        for length in 1..=LONGEST {
            for (symbol, _) in lengths.iter().enumerate().filter(|(_, of)| usize::from(**of) == length) {
                self.symbols[at] = symbol as u16;
                self.counts[length] += 1;
                at += 1;
                if length <= SHORT {
                    let first = (code.reverse_bits() >> (32 - LONGEST)) as usize;
                    let entry = (symbol * 16 + length) as u16;
                    self.short.iter_mut().skip(first).step_by(1 << length).for_each(|place| *place = entry);
                }
                code += 1 << (LONGEST - length);
            }
        }
    }

    /// The symbol that `bits` begin with, and the length of its code.
    fn find(&self, bits: u64) -> (usize, u32) {
        let entry = self.short[bits as usize % self.short.len()];
        if entry != 0 {
            return (usize::from(entry / 16), u32::from(entry % 16));
        }
        // The difference from the first code of each length, in which the bits are in the opposite order.
        let (mut difference, mut index) = (0, 0);
        for length in 1..=LONGEST {
            difference += (bits >> (length - 1) & 1) as i32;
            let count = i32::from(self.counts[length]);
            if difference < count {
                return (self.symbols[(index + difference) as usize].into(), length as u32);
            }
            (difference, index) = ((difference - count) * 2, index + count);
        }
        (0, LONGEST as u32)
    }
}

struct Input<'a> {
    bytes: &'a [u8],
    at: usize,
    /// The next `count` bits.
    bits: u64,
    count: u32,
}

impl Input<'_> {
    /// Makes at least 56 bits ready.
    fn fill(&mut self) {
        let word = self.bytes[self.at..self.at + 8].first_chunk().map_or(0, |word| u64::from_le_bytes(*word));
        self.bits |= word << self.count;
        self.at += (63 - self.count as usize) / 8;
        self.count |= 56;
    }

    /// Takes `count` bits that are ready, as a number; the first one is the lowest.
    fn take(&mut self, count: u32) -> usize {
        let number = self.bits & ((1 << count) - 1);
        self.bits >>= count;
        self.count -= count;
        number as usize
    }

    fn symbol(&mut self, codes: &Codes) -> usize {
        let (symbol, length) = codes.find(self.bits);
        self.take(length);
        symbol
    }

    /// Reads the codes of a block: of literals and lengths, and of distances.
    fn read_codes(&mut self, [symbols, distances]: [&mut Codes; 2]) {
        const ORDER: [u8; 19] = [16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15];
        let (literals, all) = (257 + self.take(5), 1 + self.take(5));
        let (all, count) = (literals + all, 4 + self.take(4));
        let mut lengths = [0; 320];
        for symbol in &ORDER[..count] {
            self.fill();
            lengths[usize::from(*symbol)] = self.take(3) as u8;
        }
        symbols.assign(&lengths[..ORDER.len()]);
        let mut at = 0;
        while at < all {
            self.fill();
            let (length, times) = match self.symbol(symbols) {
                16 => (lengths[at - 1], 3 + self.take(2)),
                17 => (0, 3 + self.take(3)),
                18 => (0, 11 + self.take(7)),
                length => (length as u8, 1),
            };
            lengths[at..at + times].fill(length);
            at += times;
        }
        symbols.assign(&lengths[..literals]);
        distances.assign(&lengths[literals..all]);
    }
}

/// Writes the bytes of the characters in `text` to its beginning.
fn unpack(text: &mut [u8]) {
    let digit = |character: u8| if character == b'~' { 28 } else { u32::from(character) - 32 };
    let (mut bits, mut count, mut to) = (0, 0, 0);
    for from in (0..text.len() & !1).step_by(2) {
        let number = digit(text[from]) * 94 + digit(text[from + 1]);
        bits |= number << count;
        count += if number & 8191 < 644 { 14 } else { 13 };
        while count >= 8 {
            text[to] = bits as u8;
            to += 1;
            bits >>= 8;
            count -= 8;
        }
    }
}

/// Copies `length` bytes from `distance` bytes before `at`. Bytes after them are not kept.
fn repeat(output: &mut [u8], at: usize, length: usize, distance: usize) {
    let (mut from, mut to) = (at - distance, at);
    if distance < 8 || at + length + 8 > output.len() {
        (at..at + length).for_each(|to| output[to] = output[to - distance]);
        return;
    }
    while to < at + length {
        output.copy_within(from..from + 8, to);
        (from, to) = (from + 8, to + 8);
    }
}

/// Decompresses the `length` characters at `from` to the `size` bytes at `to`, and uses their place. Traps if there are
/// more.
///
/// # Safety
/// Both ranges must be in the memory, and must not overlap.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn inflate(from: *mut u8, length: usize, to: *mut u8, size: usize) {
    // SAFETY: the caller promises it.
    let (text, output) = unsafe { (slice::from_raw_parts_mut(from, length), slice::from_raw_parts_mut(to, size)) };
    unpack(text);
    let mut input = Input { bytes: text, at: 0, bits: 0, count: 0 };
    let [mut symbols, mut distances] = [Codes::EMPTY; 2];
    let mut at = 0;
    let mut is_last = false;
    while !is_last {
        input.fill();
        is_last = input.take(1) == 1;
        match input.take(2) {
            0 => {
                input.take(input.count % 8);
                input.fill();
                let length = input.take(32) % (1 << 16);
                for to in &mut output[at..at + length] {
                    input.fill();
                    *to = input.take(8) as u8;
                }
                at += length;
                continue;
            }
            1 => {
                let length = |symbol| [8, 9, 7, 8][[144, 256, 280].iter().filter(|end| symbol >= **end).count()];
                symbols.assign(&core::array::from_fn::<u8, 288, _>(length));
                distances.assign(&[5; 32]);
            }
            _ => input.read_codes([&mut symbols, &mut distances]),
        }
        loop {
            // A length and a distance have at most 48 bits.
            input.fill();
            let length = match input.symbol(&symbols) {
                literal @ 0..256 => {
                    output[at] = literal as u8;
                    at += 1;
                    continue;
                }
                256 => break,
                symbol @ 257..265 => symbol - 254,
                285 => 258,
                symbol => {
                    let extra = (symbol - 261) as u32 / 4;
                    3 + ((4 + (symbol - 257) % 4) << extra) + input.take(extra)
                }
            };
            let distance = match input.symbol(&distances) {
                symbol @ 0..2 => 1 + symbol,
                symbol => {
                    let extra = symbol as u32 / 2 - 1;
                    1 + ((2 + symbol % 2) << extra) + input.take(extra)
                }
            };
            repeat(output, at, length, distance);
            at += length;
        }
    }
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    core::arch::wasm32::unreachable()
}
