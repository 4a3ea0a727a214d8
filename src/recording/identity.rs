use std::{fmt, str::FromStr};

use xxhash_rust::xxh3::Xxh3;

use super::{Header, metadata};

/// A digest chained over versions, settings, scene, events and the digest of every state.
///
/// Two runs have the same identity exactly when the same went in and the same came out,
/// however thinned they were recorded. It prints as 32 hexadecimal digits.
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

/// The identity of a run as it grows.
///
/// XXH3 (128 bits) over parts, each a letter, its length (u64, little-endian) and its
/// bytes, so that no two different runs have the same bytes.
#[derive(Clone)]
pub struct IdentityChain(Xxh3);

impl IdentityChain {
    /// Starts with what a run is asked to be.
    pub fn new(header: &Header) -> IdentityChain {
        let mut chain = IdentityChain(Xxh3::new());
        for (key, value) in metadata::of_settings(header) {
            chain.part(b'K', key.as_bytes());
            chain.part(b'V', value.as_bytes());
        }
        chain.part(b'T', header.scene.text.as_bytes());
        chain
    }

    /// Adds one event as it is encoded in the file.
    pub fn event(&mut self, message: &[u8]) {
        self.part(b'E', message);
    }

    /// Adds one state.
    pub fn state(&mut self, step: u64, digest: u64) {
        let mut bytes = [0; 16];
        bytes[..8].copy_from_slice(&step.to_le_bytes());
        bytes[8..].copy_from_slice(&digest.to_le_bytes());
        self.part(b'S', &bytes);
    }

    /// The identity of the run so far.
    pub fn identity(&self) -> Identity {
        Identity(self.0.digest128())
    }

    fn part(&mut self, letter: u8, bytes: &[u8]) {
        let mut head = [letter; 9];
        head[1..].copy_from_slice(&(bytes.len() as u64).to_le_bytes());
        self.0.update(&head);
        self.0.update(bytes);
    }
}
