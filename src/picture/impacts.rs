//! The colliding bodies at one instant.

use super::Appearance;
use crate::physics::{BodyId, Collision, Rect, Vector};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The collisions at one instant.
#[derive(Clone, Debug, Default)]
pub struct Impacts {
    /// Seconds since step 0.
    pub time: f64,
    /// The bodies that collide.
    pub bodies: BTreeMap<BodyId, Impact>,
}

/// The collisions of one body at one instant.
#[derive(Clone, Debug)]
pub struct Impact {
    /// The body.
    pub appearance: Arc<Appearance>,
    /// Its rectangle, m.
    pub rect: Rect,
    /// Its velocity before all collisions of the instant, m/s.
    pub before: Vector,
    /// Its velocity after them, m/s.
    pub after: Vector,
    /// The sum of their impulses, N·s.
    impulse: Vector,
}

impl Impacts {
    /// Adds a collision of bodies with these appearances; others are ignored.
    pub fn add(&mut self, collision: &Collision, appearances: &BTreeMap<BodyId, Arc<Appearance>>) {
        for (at, sign) in [1.0, -1.0].into_iter().enumerate() {
            let id = collision.bodies[at];
            let Some(appearance) = appearances.get(&id) else { continue };
            let impact = self.bodies.entry(id).or_insert_with(|| Impact {
                appearance: appearance.clone(),
                rect: collision.rects[at],
                before: collision.before[at],
                after: collision.after[at],
                impulse: Vector::ZERO,
            });
            impact.after = collision.after[at];
            impact.impulse = impact.impulse.add(collision.normal.mult(sign * collision.impulse));
        }
    }

    /// Returns true if the impulses explain the velocities: no body pushes others that do not collide.
    pub fn are_complete(&self) -> bool {
        self.bodies.values().all(|Impact { appearance, before, after, impulse, .. }| {
            let mass = appearance.mass;
            let rounding = 1e-9 * impulse.norm() + 1e-12 * mass * (before.norm() + after.norm());
            mass == f64::INFINITY || after.sub(*before).mult(mass).sub(*impulse).norm() <= rounding
        })
    }
}
