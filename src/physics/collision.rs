use super::{Axis, BodyId, Rect, Vector};

/// A resolved collision, as an [`Observer`] receives it and figures draw it.
#[non_exhaustive]
#[doc(alias("impact", "contact"))]
#[derive(Clone, Debug, PartialEq)]
pub struct Collision {
    /// The step in which it happened: between state `step` and state `step + 1`.
    pub step: u64,
    /// The time since the start of that step, s; 0 with the handout solver, which detects collisions once per step.
    pub time: f64,
    /// The seconds since step 0, independent of the rate; that of the step with the handout solver.
    pub instant: f64,
    /// The axis of the normal.
    pub axis: Axis,
    /// The two bodies, in creation order with the event-driven solver: c and b in the handout.
    pub bodies: [BodyId; 2],
    /// Their rectangles before they were displaced, m.
    pub rects: [Rect; 2],
    /// The unit normal n̂ of the face that was hit, in the direction in which c is pushed.
    pub normal: Vector,
    /// The penetration vector n⃗, m; null with the event-driven solver, in which no box penetrates another.
    pub penetration: Vector,
    /// The shares Nc and Nb of the penetration by which the two were displaced; 0 with the event-driven solver.
    pub shares: [f64; 2],
    /// The impulse j on c along the normal (and −j on b), N·s; 0 if the two were already separating.
    pub impulse: f64,
    /// The coefficient of restitution e.
    pub restitution: f64,
    /// The normal component of the velocity of the first relative to the second before and after the impulse,
    /// m/s; negative if they approach.
    pub normal_velocity: [f64; 2],
    /// The velocities before the impulse, m/s.
    pub before: [Vector; 2],
    /// The velocities after the impulse, m/s.
    pub after: [Vector; 2],
}

/// Receives the collisions while the engine steps.
///
/// An observer cannot influence the simulation: it receives values, not the world.
pub trait Observer {
    /// Receives each collision once, in the order of resolution.
    fn collision(&mut self, collision: &Collision);

    /// Receives the impulse (N·s) of a collision, and a function that computes the collision. Observers that need only
    /// the impulse override this method.
    fn collision_of(&mut self, _impulse: f64, collision: impl FnOnce() -> Collision)
    where
        Self: Sized,
    {
        self.collision(&collision());
    }
}

/// Counts the collisions with an impulse.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CollisionCount(pub u64);

impl Observer for CollisionCount {
    fn collision(&mut self, collision: &Collision) {
        self.0 += u64::from(collision.impulse != 0.0);
    }

    #[inline]
    fn collision_of(&mut self, impulse: f64, _collision: impl FnOnce() -> Collision) {
        self.0 += u64::from(impulse != 0.0);
    }
}

impl<O: Observer> Observer for Option<O> {
    fn collision(&mut self, collision: &Collision) {
        if let Some(observer) = self {
            observer.collision(collision);
        }
    }
}

impl<A: Observer, B: Observer> Observer for (A, B) {
    fn collision(&mut self, collision: &Collision) {
        self.0.collision(collision);
        self.1.collision(collision);
    }
}

impl Observer for Vec<Collision> {
    fn collision(&mut self, collision: &Collision) {
        self.push(collision.clone());
    }
}
