use xxhash_rust::xxh3::xxh3_64;

use crate::physics::BodyId;

/// The digest of one state: of all bodies alive, in creation order.
///
/// It is the 64-bit XXH3 of one row of 36 bytes a body: id (u32), x, y (m), vx, vy (m/s,
/// the bits of each f64), all little-endian. Bits count, so −0.0 differs from 0.0; but every
/// NaN counts the same, as processors do not agree on its bits.
#[derive(Clone, Debug, Default)]
pub struct StateDigest {
    rows: Vec<u8>,
}

impl StateDigest {
    /// Starts over, keeping the memory.
    pub fn clear(&mut self) {
        self.rows.clear();
    }

    /// Adds the next body in creation order.
    pub fn body(&mut self, id: BodyId, numbers: [f64; 4]) {
        let [x, y, vx, vy] = numbers.map(canonical_bits);
        let mut row = [0; 36];
        row[0..4].copy_from_slice(&id.to_le_bytes());
        row[4..12].copy_from_slice(&x.to_le_bytes());
        row[12..20].copy_from_slice(&y.to_le_bytes());
        row[20..28].copy_from_slice(&vx.to_le_bytes());
        row[28..36].copy_from_slice(&vy.to_le_bytes());
        self.rows.extend_from_slice(&row);
    }

    /// The digest of the bodies added since the last [`StateDigest::clear`].
    pub fn value(&self) -> u64 {
        xxh3_64(&self.rows)
    }
}

fn canonical_bits(number: f64) -> u64 {
    const NAN: u64 = 0x7ff8_0000_0000_0000;
    if number.is_nan() { NAN } else { number.to_bits() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x86 makes a negative NaN of 0 ÷ 0, ARM a positive one.
    #[test]
    fn every_nan_is_the_same() {
        let digest = |bits: u64| {
            let mut digest = StateDigest::default();
            digest.body(0, [f64::from_bits(bits), 0.0, 0.0, 0.0]);
            digest.value()
        };
        assert_eq!(digest(0x7ff8_0000_0000_0000), digest(0xfff8_0000_0000_0001));
        assert_ne!(digest(0x7ff8_0000_0000_0000), digest(0x7ff0_0000_0000_0000));
    }

    #[test]
    fn every_bit_of_every_row_counts() {
        let digest = |rows: &[(BodyId, [f64; 4])]| {
            let mut digest = StateDigest::default();
            rows.iter().for_each(|(id, numbers)| digest.body(*id, *numbers));
            digest.value()
        };
        let base = digest(&[(4, [0.0, 1.0, 2.0, 3.0])]);
        assert_ne!(base, digest(&[(4, [-0.0, 1.0, 2.0, 3.0])]));
        assert_ne!(base, digest(&[(5, [0.0, 1.0, 2.0, 3.0])]));
        assert_ne!(base, digest(&[(4, [0.0, 1.0, 2.0, f64::from_bits(3.0_f64.to_bits() ^ 1)])]));
        assert_eq!(base, digest(&[(4, [0.0, 1.0, 2.0, 3.0])]));
    }
}
