use crate::physics::BodyId;

/// The state of one step as recorded: columns of equal length, ids ascending.
///
/// Bodies of infinite mass that never left the state they were spawned in are left out; a
/// step thinned away by [`Header::every`](super::Header::every) has its digest only.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedState {
    /// Number of the state; the first is 0.
    pub step: u64,
    /// Over all bodies, those left out included; see [`digest`](super::digest).
    pub digest: u64,
    /// Which bodies.
    pub id: Vec<BodyId>,
    /// Upper-left corners, m.
    pub x: Vec<f64>,
    /// Upper-left corners, m, down.
    pub y: Vec<f64>,
    /// Velocities, m/s.
    pub vx: Vec<f64>,
    /// Velocities, m/s, down.
    pub vy: Vec<f64>,
}
