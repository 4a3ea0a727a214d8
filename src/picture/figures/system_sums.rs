//! Energy and momentum of all bodies at the collisions between two states.

use super::EnergySample;
use crate::physics::{Body, BodyId, Vector, World};
use crate::picture::impacts::{Impact, Impacts};

/// Energy and momentum of the bodies of finite mass in a state, continued through the collisions after it. A collision
/// costs as much as its bodies, not as all bodies: those that do not collide keep the values of the state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SystemSums {
    /// `None` after a collision that changed the velocities of unknown bodies.
    total: Option<EnergySample>,
    /// The share of each body of finite mass, in the order of the ids.
    bodies: Vec<(BodyId, Share)>,
}

/// The share of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Share {
    kinetic: f64,
    potential: f64,
    momentum: Vector,
}

impl Share {
    fn of(mass: f64, force: Vector, center: Vector, velocity: Vector) -> Share {
        let (kinetic, potential) = (0.5 * mass * velocity.dot(velocity), -force.dot(center));
        Share { kinetic, potential, momentum: velocity.mult(mass) }
    }
}

impl SystemSums {
    /// Begins with the state of a world, whose sums are known.
    pub fn set(&mut self, world: &World, total: EnergySample) {
        let gravity = world.gravity.unwrap_or(Vector::ZERO);
        let share = |body: &Body| {
            let force = gravity.mult(body.mass).add(body.constant_force);
            (body.id, Share::of(body.mass, force, body.rect.center(), body.velocity))
        };
        self.bodies.clear();
        self.bodies.extend(world.bodies.iter().filter(|body| !body.is_infinite()).map(share));
        self.total = Some(total);
    }

    /// The sums before and after collisions, if these are known.
    pub fn collide(&mut self, impacts: &Impacts) -> Option<[EnergySample; 2]> {
        if !impacts.are_complete() {
            self.total = None;
        }
        let mut total = EnergySample { time: impacts.time, ..self.total? };
        let samples = [|impact: &Impact| impact.before, |impact: &Impact| impact.after].map(|velocity| {
            for (id, impact) in &impacts.bodies {
                let Ok(at) = self.bodies.binary_search_by_key(id, |(id, _)| *id) else { continue };
                let Impact { appearance, rect, .. } = impact;
                let new = Share::of(appearance.mass, appearance.force, rect.center(), velocity(impact));
                let old = std::mem::replace(&mut self.bodies[at].1, new);
                total.kinetic += new.kinetic - old.kinetic;
                total.potential += new.potential - old.potential;
                total.momentum = total.momentum.add(new.momentum.sub(old.momentum));
            }
            total
        });
        self.total = Some(total);
        Some(samples)
    }
}
