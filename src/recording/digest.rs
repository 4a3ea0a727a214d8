use xxhash_rust::xxh3::xxh3_64;

use crate::physics::BodyId;

/// The digest of one state: of all bodies alive, in creation order.
///
/// It is the 64-bit XXH3 of one row of 36 bytes a body: id (u32), x, y (m), vx, vy (m/s,
/// the bits of each f64), all little-endian. Bits count, so −0.0 differs from 0.0.
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
    pub fn body(&mut self, id: BodyId, [x, y, vx, vy]: [f64; 4]) {
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

#[cfg(test)]
mod tests {
    use super::*;

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
