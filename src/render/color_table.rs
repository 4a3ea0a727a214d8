/// A set of colours with their indices in insertion order: a hash table with a fixed multiplicative hash,
/// so that results are deterministic.
pub struct ColorTable {
    pub colors: Vec<[u8; 4]>,
    /// Slots of the hash table: the index of a colour plus 1, or 0 if free. At least twice as many as
    /// colours.
    slots: Vec<u32>,
}

impl ColorTable {
    pub fn new() -> ColorTable {
        ColorTable { colors: Vec::with_capacity(256), slots: vec![0; 1024] }
    }

    /// Returns the index of a colour, which is inserted if it is new.
    pub fn index_of(&mut self, color: [u8; 4]) -> usize {
        let slot = self.slot(color);
        if self.slots[slot] != 0 {
            return self.slots[slot] as usize - 1;
        }
        self.colors.push(color);
        self.slots[slot] = self.colors.len() as u32;
        if 2 * self.colors.len() > self.slots.len() {
            self.grow();
        }
        self.colors.len() - 1
    }

    /// The slot of a colour, or the free slot where it belongs.
    fn slot(&self, color: [u8; 4]) -> usize {
        let last = self.slots.len() - 1;
        let hash = u32::from_le_bytes(color).wrapping_mul(0x9e37_79b1);
        let mut slot = (hash >> 8) as usize & last;
        while self.slots[slot] != 0 && self.colors[self.slots[slot] as usize - 1] != color {
            slot = (slot + 1) & last;
        }
        slot
    }

    fn grow(&mut self) {
        self.slots = vec![0; 2 * self.slots.len()];
        for index in 0..self.colors.len() {
            let slot = self.slot(self.colors[index]);
            self.slots[slot] = index as u32 + 1;
        }
    }
}
