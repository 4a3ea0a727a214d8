use super::{BodyId, Rect, Vector};

/// One collision as it was resolved: what an [`Observer`] sees and figures draw.
#[derive(Clone, Debug, PartialEq)]
pub struct Collision {
    /// The step it happened in: between state `step` and state `step + 1`.
    pub step: u64,
    /// Seconds since the start of that step; 0 where a solver only looks once a step.
    pub time: f64,
    /// The handout's c and b.
    pub bodies: [BodyId; 2],
    /// Where the two were before they were displaced, m.
    pub rects: [Rect; 2],
    /// Unit normal n̂ of the face that was hit, pointing the way c is pushed.
    pub normal: Vector,
    /// The penetration vector n⃗, m; null for solvers that let nothing penetrate.
    pub penetration: Vector,
    /// The shares Nc and Nb of the penetration by which the two were displaced.
    pub shares: [f64; 2],
    /// The impulse j on c along the normal (and −j on b), N·s; 0 if the two separated already.
    pub impulse: f64,
    /// Velocities before, m/s.
    pub before: [Vector; 2],
    /// Velocities after, m/s.
    pub after: [Vector; 2],
}

/// Whoever wants to know of collisions while the engine steps.
///
/// Observing changes no bit of the simulation: an observer gets values, never the world.
pub trait Observer {
    /// Called once for each collision, in the order in which they are resolved.
    fn collision(&mut self, collision: &Collision);
}

/// Counts the collisions that gave an impulse.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CollisionCount(pub u64);

impl Observer for CollisionCount {
    fn collision(&mut self, collision: &Collision) {
        self.0 += u64::from(collision.impulse != 0.0);
    }
}

impl Observer for Vec<Collision> {
    fn collision(&mut self, collision: &Collision) {
        self.push(collision.clone());
    }
}
