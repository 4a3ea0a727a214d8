//! What the laws of mechanics keep, measured on a world. Infinite masses are left out.

use super::{Body, Vector, World};

/// Sum of ½·m·v², J.
pub fn kinetic_energy(world: &World) -> f64 {
    finite(world).map(|body| 0.5 * body.mass * body.velocity.dot(body.velocity)).sum()
}

/// Sum of −(m·g + f)·x at the centres, J: what gravity and constant forces can still give.
pub fn potential_energy(world: &World) -> f64 {
    let gravity = world.gravity.unwrap_or(Vector::ZERO);
    finite(world).map(|body| -gravity.mult(body.mass).add(body.constant_force).dot(body.rect.center())).sum()
}

/// Sum of m·v, kg·m/s.
pub fn momentum(world: &World) -> Vector {
    finite(world).fold(Vector::ZERO, |sum, body| sum.add(body.velocity.mult(body.mass)))
}

/// The deepest overlap of any two boxes, m: the shorter side of their common rectangle.
///
/// Zero if none overlap. Pairs of infinite masses are left out. Boxes are swept from left to
/// right, so that only those above each other are compared.
pub fn worst_overlap(world: &World) -> f64 {
    let mut swept: Vec<&Body> = world.bodies.iter().collect();
    swept.sort_by(|a, b| a.rect.origin.x.total_cmp(&b.rect.origin.x));
    let mut worst = 0.0;
    for (place, a) in swept.iter().enumerate() {
        let far = a.rect.far_corner().x;
        for b in swept[place + 1..].iter().take_while(|b| b.rect.origin.x < far) {
            let overlap = if a.is_infinite() && b.is_infinite() { 0.0 } else { overlap(a, b) };
            if overlap > worst {
                worst = overlap;
            }
        }
    }
    worst
}

fn overlap(a: &Body, b: &Body) -> f64 {
    let [a_far, b_far] = [a.rect.far_corner(), b.rect.far_corner()];
    let common = |a: f64, b: f64, a_far: f64, b_far: f64| {
        (if a_far < b_far { a_far } else { b_far }) - (if a > b { a } else { b })
    };
    let x = common(a.rect.origin.x, b.rect.origin.x, a_far.x, b_far.x);
    let y = common(a.rect.origin.y, b.rect.origin.y, a_far.y, b_far.y);
    if x < y { x } else { y }
}

fn finite(world: &World) -> impl Iterator<Item = &Body> {
    world.bodies.iter().filter(|body| !body.is_infinite())
}
