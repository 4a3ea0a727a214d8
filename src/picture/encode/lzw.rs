//! The LZW compression of GIF.
//!
//! Long runs of one colour, frequent in drawings, take the time of a single lookup rather than one per pixel. For
//! 1280×720 pixels this takes 0.77 ms where weezl 0.2.1, of which the gif crate uses an earlier version, takes 8.4 ms (a
//! drawing of 50 boxes), 2.8 instead of 14 ms (2000 boxes) and 20 instead of 28 ms (noise); the sizes are the same to a
//! byte. `lzw_compress` and `lzw_compress_weezl` of `cargo bench --bench kernels` measure both with short runs: 3.0 and
//! 6.0 ms. The GIF column of `cargo bench --bench drawing` measures a part of the whole.

/// Compresses palette indices. The first byte is the minimum code size. The dictionary is cleared when it is full.
pub fn compress(pixels: &[u8]) -> Vec<u8> {
    let largest = pixels.iter().copied().max().unwrap_or(0);
    let code_size = (u32::from(largest) + 1).max(4).next_power_of_two().trailing_zeros() as u8;
    let mut encoder = Encoder::new(code_size, pixels.len() / 16);
    let mut rest = pixels;
    while let Some(&symbol) = rest.first() {
        let run = rest.iter().position(|&other| other != symbol).unwrap_or(rest.len());
        encoder.add_run(symbol, run);
        rest = &rest[run..];
    }
    encoder.finish()
}

/// Codes of GIF have at most 12 bits.
const MAX_CODES: u16 = 4096;

/// Slots of the hash table: twice as many as codes, so that probing is short.
const SLOTS: usize = 8192;

struct Encoder {
    output: Output,
    code_size: u8,
    /// The code of the input that is not yet written.
    pending: Option<u16>,
    /// The length of that input if it is a run of one symbol, else 0.
    pending_run: usize,
    next_code: u16,
    /// The dictionary as a hash table from a prefix code and its next symbol to a code. Keys are stored
    /// plus 1, because 0 marks a free slot.
    slots: Vec<(u32, u16)>,
    /// For each symbol the codes of its runs of length 1, 2, 3…, as far as they have one.
    runs: Vec<Vec<u16>>,
}

impl Encoder {
    fn new(code_size: u8, expected: usize) -> Encoder {
        let mut encoder = Encoder {
            output: Output { bytes: Vec::with_capacity(expected), bits: 0, count: 0, width: 0 },
            code_size,
            pending: None,
            pending_run: 0,
            next_code: 0,
            slots: vec![(0, 0); SLOTS],
            runs: vec![Vec::new(); 1 << code_size],
        };
        encoder.output.bytes.push(code_size);
        encoder.output.width = code_size + 1;
        encoder.clear();
        encoder
    }

    /// Writes a clear code and resets the dictionary to the codes of single symbols.
    fn clear(&mut self) {
        let clear = 1 << self.code_size;
        self.output.write(clear);
        self.output.width = self.code_size + 1;
        self.next_code = clear + 2;
        self.slots.fill((0, 0));
        for (symbol, codes) in (0..).zip(&mut self.runs) {
            codes.clear();
            codes.push(symbol);
        }
    }

    /// Encodes a run of `length` times `symbol`.
    fn add_run(&mut self, symbol: u8, length: usize) {
        let mut remaining = length;
        while remaining > 0 {
            let codes = &self.runs[usize::from(symbol)];
            if self.pending_is_run_of(symbol) && self.pending_run < codes.len() {
                let longer = codes.len().min(self.pending_run + remaining);
                remaining -= longer - self.pending_run;
                self.pending = Some(codes[longer - 1]);
                self.pending_run = longer;
            } else {
                self.add(symbol);
                remaining -= 1;
            }
        }
    }

    fn pending_is_run_of(&self, symbol: u8) -> bool {
        let runs = &self.runs[usize::from(symbol)];
        self.pending_run > 0 && self.pending == runs.get(self.pending_run - 1).copied()
    }

    /// Encodes one symbol.
    fn add(&mut self, symbol: u8) {
        let Some(prefix) = self.pending else {
            return self.begin(symbol);
        };
        let key = (u32::from(prefix) << 8 | u32::from(symbol)) + 1;
        let slot = self.slot(key);
        if self.slots[slot].0 == key {
            self.pending = Some(self.slots[slot].1);
            self.pending_run = 0;
            return;
        }
        self.output.write(prefix);
        self.add_code(slot, key, symbol);
        self.begin(symbol);
    }

    fn begin(&mut self, symbol: u8) {
        self.pending = Some(u16::from(symbol));
        self.pending_run = 1;
    }

    /// Adds a code for the input just written followed by `symbol`.
    fn add_code(&mut self, slot: usize, key: u32, symbol: u8) {
        if self.next_code == MAX_CODES {
            return self.clear();
        }
        self.slots[slot] = (key, self.next_code);
        if self.pending_is_run_of(symbol) {
            self.runs[usize::from(symbol)].push(self.next_code);
        }
        // The decoder adds each code one code later, so the width grows one code later too.
        if self.next_code == 1 << self.output.width {
            self.output.width += 1;
        }
        self.next_code += 1;
    }

    /// The slot of a key, or the free slot where it belongs.
    fn slot(&self, key: u32) -> usize {
        let mut slot = (key.wrapping_mul(0x9e37_79b1) >> 19) as usize;
        while self.slots[slot].0 != 0 && self.slots[slot].0 != key {
            slot = (slot + 1) % SLOTS;
        }
        slot
    }

    fn finish(mut self) -> Vec<u8> {
        if let Some(code) = self.pending {
            self.output.write(code);
            // The decoder has added a last code by now.
            if self.next_code == 1 << self.output.width && self.output.width < 12 {
                self.output.width += 1;
            }
        }
        self.output.write((1 << self.code_size) + 1);
        self.output.finish()
    }
}

/// A bit stream of codes of increasing width, least significant bit first.
struct Output {
    bytes: Vec<u8>,
    bits: u64,
    count: u32,
    width: u8,
}

impl Output {
    fn write(&mut self, code: u16) {
        self.bits |= u64::from(code) << self.count;
        self.count += u32::from(self.width);
        while self.count >= 8 {
            self.bytes.push(self.bits as u8);
            self.bits >>= 8;
            self.count -= 8;
        }
    }

    fn finish(mut self) -> Vec<u8> {
        if self.count > 0 {
            self.bytes.push(self.bits as u8);
        }
        self.bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Decodes the compressed pixels, as one row of a GIF file, with the gif crate.
    fn read_back(pixels: &[u8]) -> Vec<u8> {
        let mut file = Vec::new();
        let mut encoder = gif::Encoder::new(&mut file, pixels.len() as u16, 1, &[0; 768]).unwrap();
        let frame = gif::Frame {
            width: pixels.len() as u16,
            height: 1,
            buffer: compress(pixels).into(),
            ..gif::Frame::default()
        };
        encoder.write_lzw_pre_encoded_frame(&frame).unwrap();
        drop(encoder);
        let mut options = gif::DecodeOptions::new();
        options.check_lzw_end_code(true);
        let mut decoder = options.read_info(file.as_slice()).unwrap();
        decoder.read_next_frame().unwrap().unwrap().buffer.to_vec()
    }

    proptest! {
        #[test]
        fn runs_round_trip(runs in prop::collection::vec((0..9_u8, 1..400_usize), 1..120)) {
            let pixels: Vec<u8> = runs.iter().flat_map(|&(symbol, length)| vec![symbol; length]).collect();
            prop_assert_eq!(read_back(&pixels), pixels);
        }

        #[test]
        fn noise_that_fills_the_dictionary_round_trips(pixels in prop::collection::vec(any::<u8>(), 1..12_000)) {
            prop_assert_eq!(read_back(&pixels), pixels);
        }
    }

    #[test]
    fn runs_of_every_length_round_trip() {
        for length in 1..3000 {
            let pixels = vec![1; length];
            assert_eq!(read_back(&pixels), pixels, "{length} pixels");
        }
    }

    #[test]
    fn a_long_run_takes_few_bytes() {
        assert!(compress(&vec![7; 1_000_000]).len() < 2_500);
    }
}
