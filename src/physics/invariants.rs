//! Energy, momentum and the deepest overlap of a world. Energy and momentum exclude bodies of infinite mass.

use super::{Axis, Body, Vector, World, larger, smaller};

/// The kinetic energy, Σ ½·m·v², J.
pub fn kinetic_energy(world: &World) -> f64 {
    finite(world).fold(0.0, |sum, body| sum + 0.5 * body.mass * body.velocity.dot(body.velocity))
}

/// The potential energy of gravity and the constant forces, −Σ (m·g + F)·x at the centres, J. Exactly 0 if neither
/// gravity nor a force acts on any body.
pub fn potential_energy(world: &World) -> f64 {
    let gravity = world.gravity.unwrap_or(Vector::ZERO);
    let force = |body: &Body| gravity.mult(body.mass).add(body.constant_force);
    // Adding to 0 instead of summing from −0, and skipping bodies without force, keeps the sum from being −0.
    let subject = finite(world).filter(|body| force(body) != Vector::ZERO);
    subject.fold(0.0, |sum, body| sum - force(body).dot(body.rect.center()))
}

/// The momentum, Σ m·v, kg·m/s.
pub fn momentum(world: &World) -> Vector {
    finite(world).fold(Vector::ZERO, |sum, body| sum.add(body.velocity.mult(body.mass)))
}

/// The deepest overlap of any two boxes, m: the shorter side of their intersection. 0 if none overlap.
///
/// Pairs of infinite masses are excluded. The boxes are sorted along x (sweep and prune), so that only
/// pairs that overlap on x are compared.
pub fn worst_overlap(world: &World) -> f64 {
    let mut sorted: Vec<&Body> = world.bodies.iter().collect();
    sorted.sort_by(|a, b| a.rect.origin.x.total_cmp(&b.rect.origin.x));
    let mut worst = 0.0;
    for (index, a) in sorted.iter().enumerate() {
        let right = a.rect.far_corner().x;
        for b in sorted[index + 1..].iter().take_while(|b| b.rect.origin.x < right) {
            if !(a.is_infinite() && b.is_infinite()) {
                let [x, y] = Axis::BOTH.map(|axis| a.rect.overlap_along(axis, &b.rect));
                worst = larger(smaller(x, y), worst);
            }
        }
    }
    worst
}

fn finite(world: &World) -> impl Iterator<Item = &Body> {
    world.bodies.iter().filter(|body| !body.is_infinite())
}
