use std::{fmt, str::FromStr};

use xxhash_rust::xxh3::Xxh3;

use super::{Header, metadata};

/// A digest over versions, settings, scene, events and the digests of all states.
///
/// Two runs have the same identity if and only if their inputs and states are the same, whatever
/// the thinning of their recordings. It is printed as 32 hexadecimal digits.
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
        chain.add_part(b'T', header.scene.text.as_bytes());
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
