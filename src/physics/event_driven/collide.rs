//! Resolves impacts: finds the colliding clusters, applies the impact law and makes the faces coincide.

use super::EventDriven;
use super::body_state::Slot;
use super::contact_cluster::StruckBody;
use super::double_double::{DoubleDouble, Lanes};
use super::f64x2::F64x2;
use super::impact::{COLLAPSE_LIMIT, Impact, collapse_speed, is_negligible};
use super::instant::MAX_TIME_ROUNDING;
use super::pair_event::tolerance;
use super::state_dd::{StateDd, advance_both};
use crate::physics::{Axis, Collision, Observer, Rect, Side, StepError, Vector, World};

/// Two bodies that collide along an axis, at the instant of the impact; the body on the low side first.
struct ImpactPair {
    axis: Axis,
    slots: [Slot; 2],
    states: [StateDd; 2],
    /// Times since the reference instants of their trajectories, s.
    ages: [f64; 2],
    /// Speed of approach, m/s; negative if they separate.
    approach: f64,
}

/// The restitution of an impact, and whether it ends an inelastic collapse.
#[derive(Clone, Copy, Debug)]
struct ImpactKind {
    /// The coefficient of restitution of the impact.
    restitution: f64,
    /// If the impact ends an inelastic collapse, the largest relative speed at which touching bodies
    /// join the two, m/s.
    collapse_speed: Option<f64>,
}

/// The longest delay of an impact that was predicted too early, s. During a longer delay, another event may occur.
const MAX_CORRECTION: f64 = 1e-10;

impl ImpactPair {
    /// The two bodies, each with the direction in which the impact pushes it.
    fn struck(&self) -> [StruckBody; 2] {
        Side::BOTH.map(|side| {
            let (slot, velocity) = (self.slots[side], self.states[side].velocity);
            StruckBody { slot, axis: self.axis, side, velocity }
        })
    }
}

impl EventDriven {
    /// Resolves the impact of two bodies whose faces touch along an axis.
    ///
    /// Bodies in contact take the impact as one (Moreau's impact law with a relative velocity of 0 at
    /// resting contacts): a body supported by an infinite mass responds like that mass, a free
    /// body together with all bodies that it pushes. Bodies that merely touch are not in contact;
    /// they pass the impact on from pair to pair, as in Newton's cradle.
    pub(super) fn collide_faces<O: Observer>(
        &mut self,
        world: &World,
        pair: [Slot; 2],
        axis: Axis,
        observer: &mut O,
    ) -> Result<(), StepError> {
        let colliding = self.impact_pair_at_contact(pair, axis);
        let restitution = self.apply_impact(world, pair, &colliding, observer)?;
        if restitution == 0.0 {
            self.add_contact(colliding.slots, axis);
        }
        self.solve_contacts();
        Ok(())
    }

    /// Resolves the impact of two bodies whose corners touch: one impact along each axis on which
    /// they approach.
    ///
    /// If they are at rest against each other afterwards, they press corner to corner and are in
    /// contact along both axes, because neither axis is preferred.
    pub(super) fn collide_corners<O: Observer>(
        &mut self,
        world: &World,
        pair: [Slot; 2],
        observer: &mut O,
    ) -> Result<(), StepError> {
        for axis in Axis::BOTH {
            let colliding = self.impact_pair(pair, axis);
            if colliding.approach > 0.0 {
                self.apply_impact(world, pair, &colliding, observer)?;
            }
        }
        let pairs = Axis::BOTH.map(|axis| self.impact_pair(pair, axis));
        if pairs.iter().all(|colliding| colliding.approach == 0.0) {
            pairs.iter().for_each(|colliding| self.add_contact(colliding.slots, colliding.axis));
        } else {
            pairs.iter().for_each(|colliding| self.rebase(colliding));
        }
        self.solve_contacts();
        Ok(())
    }

    /// Applies an impact and returns its coefficient of restitution.
    fn apply_impact<O: Observer>(
        &mut self,
        world: &World,
        pair: [Slot; 2],
        colliding: &ImpactPair,
        observer: &mut O,
    ) -> Result<f64, StepError> {
        let ImpactKind { restitution, collapse_speed } = self.classify_impact(world, colliding);
        let struck = colliding.struck();
        let mut clusters = std::mem::take(&mut self.clusters);
        if let Some(max_speed) = collapse_speed {
            let [low, high] = &mut clusters;
            self.collapse_cluster(world, struck[0], max_speed, |slot| slot == struck[1].slot, low);
            let is_low = |slot| slot == struck[0].slot || low.contains(slot);
            self.collapse_cluster(world, struck[1], max_speed, is_low, high);
        }
        let both_supported = clusters.iter().all(|cluster| cluster.mass == f64::INFINITY);
        // Bodies wedged between two supports: infinitely many impacts bring them to rest.
        let is_wedged =
            collapse_speed == Some(f64::INFINITY) && both_supported && clusters[0].velocity == clusters[1].velocity;
        if collapse_speed.is_none() || (both_supported && !is_wedged) {
            struck.into_iter().zip(&mut clusters).for_each(|(struck, cluster)| self.impact_cluster(struck, cluster));
        }
        let mass = [clusters[0].mass, clusters[1].mass];
        if colliding.approach > 0.0 && mass == [f64::INFINITY; 2] && !is_wedged {
            self.clusters = clusters;
            return Err(self.crushed_error(world, colliding.slots, colliding.axis));
        }
        let impact = Impact { velocity: [clusters[0].velocity, clusters[1].velocity], mass, restitution };
        let after = impact.velocities_after();
        let impulse = if is_wedged { self.momentum_lost(&clusters[0], colliding.axis) } else { impact.impulse() };
        let before = self.rects_and_velocities(pair);
        let position = self.contact_positions(colliding, mass[1] == f64::INFINITY);
        for body in [0, 1] {
            self.apply_to_cluster(&clusters[body], struck[body], position[body], after[body]);
        }
        self.clusters = clusters;
        if colliding.approach > 0.0 {
            let sign = if colliding.slots == pair { -1.0 } else { 1.0 };
            let normal = Vector::along(colliding.axis, sign);
            observer.collision(&self.collision_record(pair, normal, impulse, before));
        }
        Ok(restitution)
    }

    /// The states of two bodies at the present instant, sorted by position along the axis.
    fn impact_pair(&self, pair: [Slot; 2], axis: Axis) -> ImpactPair {
        let ([first, second], ages) = self.both_states_dd(pair, axis);
        let middle = |slot: Slot, state: &StateDd| state.position.high + self.states[slot as usize].size[axis] / 2.0;
        let (slots, states, ages) = if middle(pair[0], &first) <= middle(pair[1], &second) {
            (pair, [first, second], ages)
        } else {
            ([pair[1], pair[0]], [second, first], [ages[1], ages[0]])
        };
        ImpactPair { axis, slots, states, ages, approach: (states[0].velocity - states[1].velocity).high }
    }

    /// The states of two bodies at the time of impact, which is first refined to double-double precision.
    fn impact_pair_at_contact(&mut self, pair: [Slot; 2], axis: Axis) -> ImpactPair {
        let predicted = self.impact_pair(pair, axis);
        let correction = self.time_correction(&predicted);
        if correction == 0.0 {
            return predicted;
        }
        self.shift_now(correction);
        let states = advance_both(predicted.states, F64x2::splat(correction).into());
        ImpactPair { states, approach: (states[0].velocity - states[1].velocity).high, ..predicted }
    }

    /// The delay of the contact of the faces relative to the prediction, s: the rounding error of the prediction.
    ///
    /// From the gap g at the predicted instant, in double-double precision, t = 2·g/(c + √(c² + 2·b·g));
    /// g is so small that a double suffices for t. No trajectory is extended before its
    /// reference instant.
    fn time_correction(&self, colliding: &ImpactPair) -> f64 {
        let ImpactPair { axis, slots, states: [first, second], ages, approach: speed } = *colliding;
        let size = self.states[slots[0] as usize].size[axis];
        let gap = (second.position - first.position - size.into()).high;
        let acceleration = (first.acceleration - second.acceleration).high;
        let square = speed * speed + 2.0 * acceleration * gap;
        if gap == 0.0 || speed <= 0.0 || square < 0.0 {
            return 0.0;
        }
        let mut delay = 2.0 * gap / (speed + square.sqrt());
        if delay < 0.0 {
            delay = ages.into_iter().fold(delay, |delay, age| if -age > delay { -age } else { delay });
        }
        if (-MAX_TIME_ROUNDING..=MAX_CORRECTION).contains(&delay) { delay } else { 0.0 }
    }

    /// Makes the present instant the reference instant of two bodies that only graze each other, so that
    /// their next prediction starts here.
    fn rebase(&mut self, colliding: &ImpactPair) {
        for (slot, state) in colliding.slots.into_iter().zip(colliding.states) {
            if !self.states[slot as usize].infinite {
                self.set_trajectory(slot, colliding.axis, state);
            }
        }
    }

    /// The restitution of the impact: that of the materials, or 0 if the bodies do not approach or if the impact
    /// ends an inelastic collapse. Updates the collapse counts of both bodies.
    fn classify_impact(&mut self, world: &World, colliding: &ImpactPair) -> ImpactKind {
        let [first, second] = colliding.slots.map(|slot| &self.params[slot as usize]);
        let restitution = world.restitution.between(first.material, second.material);
        if colliding.approach <= 0.0 {
            return ImpactKind { restitution: 0.0, collapse_speed: None };
        }
        if restitution == 1.0 {
            return ImpactKind { restitution, collapse_speed: None };
        }
        let accelerations = [first, second].map(|params| params.free_acceleration[colliding.axis].high.abs());
        let acceleration = if accelerations[0] > accelerations[1] { accelerations[0] } else { accelerations[1] };
        let velocities = colliding.states.map(|state| state.velocity.high.abs());
        let scale = self.coordinate_scale(colliding);
        let max_speed = collapse_speed(acceleration, scale, velocities[0] + velocities[1]);
        let are_collapsing = colliding.slots.map(|slot| self.count_collapse(slot, colliding.axis, scale));
        if are_collapsing == [true; 2] {
            return ImpactKind { restitution: 0.0, collapse_speed: Some(f64::INFINITY) };
        }
        if colliding.approach < max_speed {
            return ImpactKind { restitution: 0.0, collapse_speed: Some(max_speed) };
        }
        ImpactKind { restitution, collapse_speed: None }
    }

    /// Counts the consecutive impacts of a body without displacement between them; returns true if they
    /// exceed [`COLLAPSE_LIMIT`], and always for an infinite mass.
    fn count_collapse(&mut self, slot: Slot, axis: Axis, coordinate_scale: f64) -> bool {
        let body = &mut self.states[slot as usize];
        if body.infinite {
            return true;
        }
        let trajectory = body.trajectory.along(axis);
        let t = self.clock.seconds_between(trajectory.since, self.now);
        let displacement = t * (trajectory.velocity.abs() + 0.5 * trajectory.acceleration.abs() * t);
        let collapse_count = &mut body.collapse_count[axis];
        *collapse_count =
            if is_negligible(displacement, coordinate_scale) { collapse_count.saturating_add(1) } else { 0 };
        *collapse_count > COLLAPSE_LIMIT
    }

    /// The sum of the coordinates and sizes whose rounding errors add up in the gap of the two, m.
    fn coordinate_scale(&self, colliding: &ImpactPair) -> f64 {
        let [first, second] = colliding.slots.map(|slot| self.states[slot as usize].size[colliding.axis]);
        let [low, high] = colliding.states.map(|state| state.position.high.abs());
        low + high + (first + second)
    }

    /// The positions at which the faces of the two coincide: the body on the high side is moved, or the
    /// one on the low side if `high_is_immovable`.
    ///
    /// Bodies that do not approach and touch already keep their positions to the bit.
    fn contact_positions(&self, colliding: &ImpactPair, high_is_immovable: bool) -> [DoubleDouble; 2] {
        let [first, second] = colliding.states.map(|state| state.position);
        let size = self.states[colliding.slots[0] as usize].size[colliding.axis].into();
        let gap = (second - first - size).high;
        if colliding.approach <= 0.0 && gap.abs() <= tolerance(self.coordinate_scale(colliding)) {
            [first, second]
        } else if high_is_immovable {
            [second - size, second]
        } else {
            [first, first + size]
        }
    }

    /// Rectangles and velocities (m/s) of two bodies at the present instant.
    #[inline]
    fn rects_and_velocities(&self, pair: [Slot; 2]) -> [(Rect, Vector); 2] {
        let state = |slot: Slot| {
            let body = &self.states[slot as usize];
            let [[x, y], [vx, vy]] = body.trajectory.at(&self.clock, self.now);
            (Rect::new(Vector::new(x, y), body.size[0], body.size[1]), Vector::new(vx, vy))
        };
        [state(pair[0]), state(pair[1])]
    }

    /// The collision for the observer; inlined, so that nothing is computed for an observer that ignores it.
    #[inline(always)]
    fn collision_record(
        &self,
        pair: [Slot; 2],
        normal: Vector,
        impulse: f64,
        before: [(Rect, Vector); 2],
    ) -> Collision {
        Collision {
            step: self.now.step as u64,
            time: self.now.offset.clamp(0.0, self.clock.period),
            bodies: pair.map(|slot| self.params[slot as usize].id),
            rects: before.map(|(rect, _)| rect),
            normal,
            penetration: Vector::ZERO,
            shares: [0.0; 2],
            impulse,
            before: before.map(|(_, velocity)| velocity),
            after: self.rects_and_velocities(pair).map(|(_, velocity)| velocity),
        }
    }
}

/// The largest position at which a box of size `size` does not extend beyond `face`, m.
pub fn largest_position_before(face: f64, size: f64) -> f64 {
    let mut position = face - size;
    if position + size > face {
        position = position.next_down();
    }
    position
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_placed_before_a_face_does_not_extend_beyond_it() {
        for (face, size) in [(10.0, 0.1), (0.3, 0.1), (1e6, 1e-3), (-0.7, 0.3), (5.0, 1e9)] {
            let position = largest_position_before(face, size);
            assert!(position + size <= face);
            assert!(position.next_up() + size >= face);
        }
    }
}
