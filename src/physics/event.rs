use super::{BodyId, Rect, Vector};

/// One change of the world from outside. There is no other way in.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// A body comes into being.
    Spawn(Spawn),
    /// The body of that number goes.
    Delete(BodyId),
}

/// All constants of a new body, and its first position and velocity.
#[derive(Clone, Debug, PartialEq)]
pub struct Spawn {
    /// Unique among the bodies alive.
    pub name: String,
    /// First position and lifelong size, m; both extents positive.
    pub rect: Rect,
    /// kg, positive; infinity for what is never pushed.
    pub mass: f64,
    /// First velocity, m/s.
    pub velocity: Vector,
    /// Constant force, N.
    pub force: Vector,
    /// Name of its material; empty for none.
    pub material: String,
}
