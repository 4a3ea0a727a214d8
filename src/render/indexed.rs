/// Pixels as places in a palette of at most 256 colours.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Indexed {
    /// The colours, in the order in which the pixels first have them.
    pub palette: Vec<[u8; 4]>,
    /// The place in the palette of each pixel.
    pub pixels: Vec<u8>,
}

impl Indexed {
    /// The pixels with a palette of their own, if 256 colours are enough.
    pub fn exact(pixels: &[[u8; 4]]) -> Option<Indexed> {
        let mut colors = ColorTable::new();
        let mut places = Vec::with_capacity(pixels.len());
        for run in pixels.chunk_by(|a, b| a == b) {
            let place = colors.place(run[0])?;
            places.resize(places.len() + run.len(), place);
        }
        Some(Indexed { palette: colors.colors, pixels: places })
    }
}

/// Colours and their places, found by a multiplicative hash of fixed seed.
struct ColorTable {
    colors: Vec<[u8; 4]>,
    /// One more than the place of a colour; 0 is free.
    slots: Vec<u16>,
}

const SLOTS: usize = 1024;

impl ColorTable {
    fn new() -> ColorTable {
        ColorTable { colors: Vec::with_capacity(256), slots: vec![0; SLOTS] }
    }

    /// The place of a colour, which is new if need be; none when 256 others have one.
    fn place(&mut self, color: [u8; 4]) -> Option<u8> {
        let mut slot = u32::from_le_bytes(color).wrapping_mul(0x9e37_79b1) as usize >> 22;
        loop {
            match self.slots[slot] {
                0 => break,
                known if self.colors[usize::from(known) - 1] == color => return Some((known - 1) as u8),
                _ => slot = (slot + 1) % SLOTS,
            }
        }
        if self.colors.len() == 256 {
            return None;
        }
        self.colors.push(color);
        self.slots[slot] = self.colors.len() as u16;
        Some((self.colors.len() - 1) as u8)
    }
}
