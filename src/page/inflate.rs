//! Decompresses the part of the engine with which the page starts: DEFLATE (RFC 1951), of which `inline.mjs` has written
//! each 13 bits as two of 91 characters. A WebAssembly module is made of this file alone. A decompressor in JavaScript
//! takes ten times as long, because it has not been compiled when the page opens, and `DecompressionStream` waits for its
//! turn among the tasks that lay out the page.
#![no_std]

use core::slice;

/// The number of bits of the longest code.
const LONGEST: u32 = 15;

/// For each sequence of [`LONGEST`] bits: 16 times the symbol that it begins with, plus the length of its code.
type Codes = [u16; 1 << LONGEST];

struct Input<'a> {
    /// Two characters for each 13 bits.
    pairs: slice::ChunksExact<'a, u8>,
    /// The next `count` bits.
    bits: u64,
    count: u32,
    /// The number of bits that were taken.
    taken: u32,
}

impl Input<'_> {
    /// Takes the next `count` bits, at most 32, as a number; the first one is the lowest. Bits after the end are 0.
    fn take(&mut self, count: u32) -> usize {
        while self.count < 32 {
            let digit = |character: u8| if character == b'~' { 25 } else { u64::from(character - b'#') };
            let number = self.pairs.next().map_or(0, |pair| digit(pair[0]) * 91 + digit(pair[1]));
            self.bits |= number << self.count;
            self.count += 13;
        }
        let number = self.bits & ((1 << count) - 1);
        self.bits >>= count;
        self.count -= count;
        self.taken += count;
        number as usize
    }

    fn symbol(&mut self, codes: &Codes) -> usize {
        self.take(0);
        let code = codes[self.bits as usize % codes.len()];
        self.take(u32::from(code % 16));
        usize::from(code / 16)
    }

    /// Reads the codes of a block: of literals and lengths, and of distances.
    fn read_codes(&mut self, [symbols, distances]: [&mut Codes; 2]) {
        const ORDER: [u8; 19] = [16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15];
        let (literals, all) = (257 + self.take(5), 1 + self.take(5));
        let (all, count) = (literals + all, 4 + self.take(4));
        let mut lengths = [0; 320];
        ORDER.iter().take(count).for_each(|symbol| lengths[usize::from(*symbol)] = self.take(3) as u8);
        assign(&lengths[..ORDER.len()], symbols);
        let mut at = 0;
        while at < all {
            let (length, times) = match self.symbol(symbols) {
                16 => (lengths[at - 1], 3 + self.take(2)),
                17 => (0, 3 + self.take(3)),
                18 => (0, 11 + self.take(7)),
                length => (length as u8, 1),
            };
            lengths[at..at + times].fill(length);
            at += times;
        }
        assign(&lengths[..literals], symbols);
        assign(&lengths[literals..all], distances);
    }
}

/// Fills in the canonical codes with these lengths; a symbol of length 0 has none.
fn assign(lengths: &[u8], codes: &mut Codes) {
    let mut code = 0_u32;
    for length in 1..=LONGEST {
        for (symbol, _) in lengths.iter().enumerate().filter(|(_, of)| u32::from(**of) == length) {
            let first = (code.reverse_bits() >> (32 - LONGEST)) as usize;
            let entry = (symbol * 16) as u16 + length as u16;
            codes.iter_mut().skip(first).step_by(1 << length).for_each(|place| *place = entry);
            code += 1 << (LONGEST - length);
        }
    }
}

/// Decompresses the `length` characters at `from` to the `size` bytes at `to`. Traps if there are more.
///
/// # Safety
/// Both ranges must be in the memory, and must not overlap.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn inflate(from: *const u8, length: usize, to: *mut u8, size: usize) {
    // SAFETY: the caller promises it.
    let (text, output) = unsafe { (slice::from_raw_parts(from, length), slice::from_raw_parts_mut(to, size)) };
    let mut input = Input { pairs: text.chunks_exact(2), bits: 0, count: 0, taken: 0 };
    let [mut symbols, mut distances]: [Codes; 2] = [[0; 1 << LONGEST]; 2];
    let mut at = 0;
    let mut is_last = false;
    while !is_last {
        is_last = input.take(1) == 1;
        match input.take(2) {
            0 => {
                input.take(input.taken.wrapping_neg() % 8);
                let length = input.take(32) % (1 << 16);
                output[at..at + length].fill_with(|| input.take(8) as u8);
                at += length;
                continue;
            }
            1 => {
                let length = |symbol| [8, 9, 7, 8][[144, 256, 280].iter().filter(|end| symbol >= **end).count()];
                assign(&core::array::from_fn::<u8, 288, _>(length), &mut symbols);
                assign(&[5; 32], &mut distances);
            }
            _ => input.read_codes([&mut symbols, &mut distances]),
        }
        loop {
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
            (at..at + length).for_each(|to| output[to] = output[to - distance]);
            at += length;
        }
    }
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    core::arch::wasm32::unreachable()
}
