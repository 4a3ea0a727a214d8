use std::{fmt, str::FromStr};

use xxhash_rust::xxh3::{Xxh3, xxh3_64};

use crate::physics::BodyId;

use super::{Header, metadata};

/// The digest of one state: of all living bodies, in creation order.
///
/// The digest is the 64-bit XXH3 of one row of 36 bytes per body: id (u32), x, y (m), vx, vy (m/s,
/// the bits of each f64), all little-endian. So −0.0 and 0.0 give different digests; but all NaNs give
/// the same one, because their bits differ between processors.
#[derive(Clone, Debug, Default)]
pub struct StateDigest {
    rows: Vec<u8>,
}

impl StateDigest {
    /// Removes all bodies and keeps the allocated memory.
    pub fn clear(&mut self) {
        self.rows.clear();
    }

    /// Adds the next body in creation order: x, y (m), vx, vy (m/s).
    pub fn add(&mut self, id: BodyId, state: [f64; 4]) {
        let [x, y, vx, vy] = state.map(canonical_bits);
        let mut row = [0; 36];
        row[0..4].copy_from_slice(&id.to_le_bytes());
        row[4..12].copy_from_slice(&x.to_le_bytes());
        row[12..20].copy_from_slice(&y.to_le_bytes());
        row[20..28].copy_from_slice(&vx.to_le_bytes());
        row[28..36].copy_from_slice(&vy.to_le_bytes());
        self.rows.extend_from_slice(&row);
    }

    /// Returns the digest of the bodies added since the last [`StateDigest::clear`].
    pub fn value(&self) -> u64 {
        xxh3_64(&self.rows)
    }
}

fn canonical_bits(number: f64) -> u64 {
    const NAN: u64 = 0x7ff8_0000_0000_0000;
    if number.is_nan() { NAN } else { number.to_bits() }
}

/// A digest over versions, settings, scene, events and the digests of all states.
///
/// Two runs have the same identity if and only if their inputs and states are the same (apart from hash
/// collisions), however their recordings are thinned out. It is printed as 32 hexadecimal digits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity(pub u128);

impl fmt::Display for Identity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:032x}", self.0)
    }
}

impl FromStr for Identity {
    type Err = std::num::ParseIntError;

    fn from_str(text: &str) -> Result<Identity, Self::Err> {
        u128::from_str_radix(text, 16).map(Identity)
    }
}

/// Computes the identity of a run incrementally.
///
/// The identity is the 128-bit XXH3 of a sequence of parts. Each part is a tag letter, the length
/// (u64, little-endian) and the bytes, so that different runs always give different input.
#[derive(Clone)]
pub struct IdentityChain(Xxh3);

impl IdentityChain {
    /// Starts a chain with the settings and the scene text of a run.
    pub fn new(header: &Header) -> IdentityChain {
        let mut chain = IdentityChain(Xxh3::new());
        for (key, value) in metadata::settings_map(header) {
            chain.add_part(b'K', key.as_bytes());
            chain.add_part(b'V', value.as_bytes());
        }
        if let Some(scene) = &header.scene {
            chain.add_part(b'T', scene.text.as_bytes());
        }
        chain
    }

    /// Adds an event, encoded as in the file.
    pub fn event(&mut self, message: &[u8]) {
        self.add_part(b'E', message);
    }

    /// Adds the digest of a state.
    pub fn state(&mut self, step: u64, digest: u64) {
        let mut bytes = [0; 16];
        bytes[..8].copy_from_slice(&step.to_le_bytes());
        bytes[8..].copy_from_slice(&digest.to_le_bytes());
        self.add_part(b'S', &bytes);
    }

    /// Returns the identity of the run so far.
    pub fn identity(&self) -> Identity {
        Identity(self.0.digest128())
    }

    fn add_part(&mut self, tag: u8, bytes: &[u8]) {
        let mut prefix = [tag; 9];
        prefix[1..].copy_from_slice(&(bytes.len() as u64).to_le_bytes());
        self.0.update(&prefix);
        self.0.update(bytes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On x86, 0 ÷ 0 is a negative NaN; on ARM it is a positive one.
    #[test]
    fn all_nans_have_the_same_digest() {
        let digest = |bits: u64| {
            let mut digest = StateDigest::default();
            digest.add(0, [f64::from_bits(bits), 0.0, 0.0, 0.0]);
            digest.value()
        };
        assert_eq!(digest(0x7ff8_0000_0000_0000), digest(0xfff8_0000_0000_0001));
        assert_ne!(digest(0x7ff8_0000_0000_0000), digest(0x7ff0_0000_0000_0000));
    }

    #[test]
    fn every_bit_of_every_row_changes_the_digest() {
        let digest = |rows: &[(BodyId, [f64; 4])]| {
            let mut digest = StateDigest::default();
            rows.iter().for_each(|(id, state)| digest.add(*id, *state));
            digest.value()
        };
        let base = digest(&[(4, [0.0, 1.0, 2.0, 3.0])]);
        assert_ne!(base, digest(&[(4, [-0.0, 1.0, 2.0, 3.0])]));
        assert_ne!(base, digest(&[(5, [0.0, 1.0, 2.0, 3.0])]));
        assert_ne!(base, digest(&[(4, [0.0, 1.0, 2.0, f64::from_bits(3.0_f64.to_bits() ^ 1)])]));
        assert_eq!(base, digest(&[(4, [0.0, 1.0, 2.0, 3.0])]));
    }
}
