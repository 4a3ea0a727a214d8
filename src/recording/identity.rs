use std::fmt;

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
