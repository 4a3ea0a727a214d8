//! The solver of the handout, as printed: the reference for teaching.
//!
//! In each step it tests all n·(n − 1) ordered pairs, so each pair twice, and it keeps no state between
//! steps. It follows the handout in the order of every operation, so that an implementation in any
//! language with IEEE 754 doubles gives the same bits. Its limitations (fast boxes tunnel through thin
//! ones, stacks sink, energy drifts) are the handout's and are kept. Repairs are made only where the
//! printed formulas divide by zero, pull boxes together or displace an infinite mass:
//!
//! - **R1** The unit normal is that of the chosen face, not n⃗/|n⃗|, which is 0/0 when
//!   boxes just touch.
//! - **R2** A pair that already separates gets no impulse, which would pull it together.
//! - **R3** Two infinite masses never collide, at rest or not.
//! - **R4** An infinite mass is never displaced.

use super::{Axis, Body, Collision, Observer, Rect, StepError, Vector, World};

/// Advances the world by `dt` seconds from state `step` to the next.
///
/// # Errors
/// [`StepError::NotFinite`] if a position or velocity overflows; the world then holds a partial step
/// and must not be stepped again.
pub fn step<O: Observer>(world: &mut World, step: u64, dt: f64, observer: &mut O) -> Result<(), StepError> {
    for c in 0..world.bodies.len() {
        for b in 0..world.bodies.len() {
            if b != c {
                collide(world, step, dt, [c, b], observer);
            }
        }
        let body = &mut world.bodies[c];
        accumulate_forces(body, world.gravity);
        integrate(body, dt);
        check_finite(body, step)?;
    }
    // A later body may have displaced an earlier one again.
    world.bodies.iter().try_for_each(|body| check_finite(body, step))
}

fn check_finite(body: &Body, step: u64) -> Result<(), StepError> {
    if body.velocity.is_finite() && body.rect.origin.is_finite() {
        Ok(())
    } else {
        Err(StepError::NotFinite { step, body: body.name.clone() })
    }
}

/// Adds the forces on a body to its accumulator: the constant force first, then its weight.
fn accumulate_forces(body: &mut Body, gravity: Option<Vector>) {
    body.force = body.force.add(body.constant_force);
    if let (Some(gravity), false) = (gravity, body.is_infinite()) {
        body.force = body.force.add(gravity.mult(body.mass));
    }
}

/// Semi-implicit Euler integration: a = Σf/m, then v += a·dt, then x += v·dt with the new v.
fn integrate(body: &mut Body, dt: f64) {
    let acceleration = body.force.mult(body.inverse_mass);
    body.force = Vector::ZERO;
    body.velocity = body.velocity.add(acceleration.mult(dt));
    body.rect.move_by(body.velocity.mult(dt));
}

/// Resolves the collision of bodies c and b, if there is one.
fn collide<O: Observer>(world: &mut World, step: u64, dt: f64, [c, b]: [usize; 2], observer: &mut O) {
    let Ok([c, b]) = world.bodies.get_disjoint_mut([c, b]) else { return };
    if c.is_infinite() && b.is_infinite() {
        return; // R3
    }
    let s = c.rect.minkowski_difference(&b.rect);
    if !s.has_origin() {
        return;
    }
    let (penetration, normal) = minimum_translation(&s);
    let shares = penetration_shares(c, b);
    let rects = [c.rect, b.rect];
    c.rect.move_by(penetration.mult(shares[0]));
    b.rect.move_by(penetration.mult(-shares[1]));

    let before = [c.velocity, b.velocity];
    let approach = before[0].sub(before[1]).dot(normal);
    let mut impulse = 0.0;
    let e = world.restitution.between(c.material, b.material);
    if approach < 0.0 {
        impulse = -(1.0 + e) * approach / (c.inverse_mass + b.inverse_mass);
        c.velocity = c.velocity.add(normal.mult(impulse * c.inverse_mass));
        b.velocity = b.velocity.sub(normal.mult(impulse * b.inverse_mass));
    } // else R2
    let after = [c.velocity, b.velocity];
    let bodies = [c.id, b.id];
    let axis = if normal.x != 0.0 { Axis::X } else { Axis::Y };
    let normal_velocity = [approach, after[0].sub(after[1]).dot(normal)];
    observer.collision(&Collision {
        step,
        time: 0.0,
        instant: step as f64 * dt,
        axis,
        bodies,
        rects,
        normal,
        penetration,
        shares,
        impulse,
        restitution: e,
        normal_velocity,
        before,
        after,
    });
}

/// The minimum translation vector: the shortest of the four vectors from the origin to a face of the Minkowski
/// difference s, and the unit normal of that face.
///
/// Ties are resolved in the order left, right, top, bottom.
pub fn minimum_translation(s: &Rect) -> (Vector, Vector) {
    let faces = faces(s);
    let mut shortest = 0;
    for candidate in 1..faces.len() {
        if faces[candidate].0.norm() < faces[shortest].0.norm() {
            shortest = candidate;
        }
    }
    faces[shortest]
}

/// The vectors from the origin to the four faces of s (figure 2 of the handout), with the unit normals of the
/// faces (R1).
pub fn faces(s: &Rect) -> [(Vector, Vector); 4] {
    let far = s.far_corner();
    [
        (Vector::new(s.origin.x, 0.0), Vector::new(-1.0, 0.0)),
        (Vector::new(far.x, 0.0), Vector::new(1.0, 0.0)),
        (Vector::new(0.0, s.origin.y), Vector::new(0.0, -1.0)),
        (Vector::new(0.0, far.y), Vector::new(0.0, 1.0)),
    ]
}

/// The shares Nc and Nb of the penetration by which c and b are displaced.
fn penetration_shares(c: &Body, b: &Body) -> [f64; 2] {
    if c.is_infinite() {
        return [0.0, 1.0]; // R4
    }
    if b.is_infinite() {
        return [1.0, 0.0]; // R4
    }
    let [speed_c, speed_b] = [c.velocity.norm(), b.velocity.norm()];
    if speed_c == 0.0 && speed_b == 0.0 {
        return if b.mass > c.mass { [1.0, 0.0] } else { [0.0, 1.0] };
    }
    let sum = speed_c + speed_b;
    [speed_c / sum, speed_b / sum]
}

#[cfg(test)]
#[path = "handout_tests.rs"]
mod tests;
