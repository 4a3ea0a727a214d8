//! The impacts of one instant: of all approaching pairs the lowest in creation order, again and again; corners only
//! when no faces approach.
//!
//! An infinite sequence (inelastic collapse) is replaced by its limit. It is recognised
//! - by decay: the next approach is slower than [`DECAYED`] of the greatest of the burst, or than [`UNDECIDED`] times the
//!   rounding of the speeds. The speeds are sums of numbers of that magnitude, of which double-double arithmetic keeps
//!   2⁻¹⁰⁴, so slower motion is rounding. Without the second condition, a burst that is slow in a fast frame of reference
//!   would end without a limit when its approaches become 0 by rounding;
//! - by a cycle (`impact_history`): three periods hit the same pairs and scale their relative velocities by the
//!   same factor below 1. Impacts are linear, so all further periods are copies.

use super::EventDriven;
use super::body_state::Slot;
use super::double_double::DoubleDouble;
use super::exact::{Resolution, VELOCITY_ROUNDING};
use super::impact::Impact;
use super::impact_history::Cycle;
use super::least_change::MASS_UNIT;
use super::patch::{Entry, Local, Patch, Touch, TouchKind};
use crate::physics::{Axis, Collision, Observer, Rect, Side, StepError, Vector, World, larger};
use std::cmp::Ordering;

/// Approaches below this fraction of the greatest of a burst are rounding.
const DECAYED: f64 = 1.0 / (1_u128 << 80) as f64;

/// Approaches below this multiple of the rounding of velocities are rounding, too.
const UNDECIDED: f64 = 256.0;

/// The impacts between two searches for chains that infinite masses squeeze.
const SQUEEZE_INTERVAL: u64 = 64;

/// One side of an impact: the body and all that it pushes.
#[derive(Clone, Debug, Default)]
pub struct Cluster {
    /// The body, and the others in creation order. Empty if the impact moves none.
    members: Vec<Local>,
    /// In units of [`MASS_UNIT`]; infinite if the cluster cannot move.
    mass: DoubleDouble,
}

/// Bodies that take on one velocity, and the touches that become contacts.
#[derive(Clone, Debug, Default)]
struct Collapse {
    /// Bodies of finite mass.
    members: Vec<Local>,
    touches: Vec<u32>,
    /// The velocity of an infinite mass among them.
    anchor: Option<DoubleDouble>,
}

impl EventDriven {
    /// Carries out the impacts of the instant.
    pub(super) fn carry_out_impacts<O: Observer>(
        &mut self,
        patch: &mut Patch,
        world: &World,
        observer: &mut O,
    ) -> Result<(), StepError> {
        let mut count = 0_u64;
        while let Some(index) = patch.first_approaching() {
            if count.is_multiple_of(SQUEEZE_INTERVAL) {
                self.check_squeezed(patch, world)?;
            }
            count += 1;
            let touch = patch.touches[index as usize];
            let axes = match touch.kind {
                TouchKind::Face(Axis::X) => [true, false],
                TouchKind::Face(Axis::Y) => [false, true],
                TouchKind::Corner => patch.blocked_axes(&touch, Entry::Moving),
            };
            self.count_event(world, touch.bodies.map(|body| patch.bodies[body as usize].slot))?;
            for axis in Axis::BOTH.into_iter().filter(|axis| axes[*axis]) {
                self.collide(patch, index, axis, world, observer)?;
            }
        }
        Ok(())
    }

    /// Carries out one impact, or the limit of the infinite sequence that it belongs to.
    fn collide<O: Observer>(
        &mut self,
        patch: &mut Patch,
        index: u32,
        axis: Axis,
        world: &World,
        observer: &mut O,
    ) -> Result<(), StepError> {
        let touch = patch.touches[index as usize];
        let approach = patch.approach(&touch, axis).high;
        let root = patch.root_of_touch(&touch) as usize;
        let greatest = &mut patch.bursts[root].greatest;
        *greatest = larger(*greatest, approach);
        let decayed = *greatest * DECAYED;
        let [first, second] = touch.bodies.map(|body| patch.axis(body, axis).speed);
        let threshold = larger(decayed, (first + second) * VELOCITY_ROUNDING * UNDECIDED);
        if approach <= threshold && self.take_decayed_limit(patch, index, axis, threshold, world) {
            return Ok(());
        }
        let restitution = self.restitution(patch, &touch, world);
        self.apply_impact(patch, &touch, axis, restitution, world, observer)?;
        if restitution == 0.0 && !self.is_contact(patch, &touch, axis) {
            self.add_contact(patch, &touch, axis);
        }
        self.follow_cycle(patch, index, axis, world)
    }

    fn restitution(&self, patch: &Patch, touch: &Touch, world: &World) -> f64 {
        let [first, second] = touch.bodies.map(|body| self.bodies.params(patch.bodies[body as usize].slot).material);
        world.restitution.between(first, second)
    }

    /// Applies the impact law to the clusters on both sides of a touch.
    fn apply_impact<O: Observer>(
        &mut self,
        patch: &mut Patch,
        touch: &Touch,
        axis: Axis,
        restitution: f64,
        world: &World,
        observer: &mut O,
    ) -> Result<(), StepError> {
        let pair = touch.ordered(axis);
        let mut clusters = std::mem::take(&mut self.clusters);
        for side in Side::BOTH {
            self.collect_cluster(patch, pair[side], axis, side, &mut clusters[side as usize]);
        }
        let mass = [clusters[0].mass, clusters[1].mass];
        if mass.iter().all(|mass| mass.high == f64::INFINITY) {
            self.clusters = clusters;
            return Err(self.crushed_error(world, pair.map(|body| patch.bodies[body as usize].slot), axis));
        }
        let velocity = pair.map(|body| patch.axis(body, axis).state.velocity);
        let impact = Impact { velocity, mass, restitution };
        let after = self.bodies.rounding().velocities(&impact, impact.velocities_after());
        let before = touch.bodies.map(|body| local_velocity(patch, body));
        self.set_velocities(patch, &clusters, axis, after);
        self.clusters = clusters;
        let impulse = impact.impulse() / MASS_UNIT;
        observer.collision(&self.collision_record(patch, touch, axis, [velocity, after], impulse, restitution, before));
        Ok(())
    }

    /// Collects the body and all bodies that it pushes, directly or through others. If one of them is supported on
    /// that side, the cluster is empty and its mass infinite.
    fn collect_cluster(&self, patch: &mut Patch, struck: Local, axis: Axis, side: Side, cluster: &mut Cluster) {
        cluster.members.clear();
        cluster.mass = f64::INFINITY.into();
        let slot_of = |patch: &Patch, body: Local| patch.bodies[body as usize].slot;
        if self.contacts.is_immovable(slot_of(patch, struck), axis, side) {
            return;
        }
        cluster.members.push(struck);
        let mut next = 0;
        while let Some(body) = cluster.members.get(next).copied() {
            next += 1;
            for contact in self.contacts.of(slot_of(patch, body)) {
                if contact.axis == axis && contact.side == side && !self.bodies[contact.other].infinite {
                    let other = self.load(patch, contact.other, patch.bodies[body as usize].at);
                    if !cluster.members.contains(&other) {
                        cluster.members.push(other);
                    }
                }
            }
        }
        if cluster.members.len() > 1 {
            cluster.members[1..].sort_unstable_by_key(|body| slot_of(patch, *body));
        }
        cluster.mass = self.total_mass(patch, &cluster.members);
    }

    /// The total mass of bodies in units of [`MASS_UNIT`], summed in creation order. Those after the first must be in this
    /// order.
    fn total_mass(&self, patch: &Patch, members: &[Local]) -> DoubleDouble {
        let slot_of = |body: &Local| patch.bodies[*body as usize].slot;
        let mass = |body: &Local| DoubleDouble::from(self.bodies.params(slot_of(body)).mass * MASS_UNIT);
        let Some((first, others)) = members.split_first() else { return DoubleDouble::ZERO };
        let (earlier, later) = others.split_at(others.partition_point(|body| slot_of(body) < slot_of(first)));
        let in_order = earlier.iter().chain([first]).chain(later).map(mass);
        in_order.reduce(|sum, mass| sum + mass).unwrap_or(DoubleDouble::ZERO)
    }

    /// Gives the clusters on both sides of an impact their velocities and ends their contacts with bodies of
    /// other velocities.
    fn set_velocities(&mut self, patch: &mut Patch, clusters: &[Cluster; 2], axis: Axis, after: [DoubleDouble; 2]) {
        let members = clusters.iter().flat_map(|cluster| &cluster.members);
        let mut speed = 0.0;
        for body in members {
            let magnitude = patch.axis(*body, axis).speed;
            speed = larger(magnitude, speed);
        }
        for velocity in after {
            speed = larger(velocity.high.abs(), speed);
        }
        for side in Side::BOTH {
            for body in &clusters[side as usize].members {
                let state = patch.axis_mut(*body, axis);
                state.state.velocity = after[side];
                state.speed = speed;
                state.has_changed = true;
            }
        }
        for cluster in clusters {
            self.velocities_changed(patch, &cluster.members, axis);
        }
    }

    /// Explores the bodies whose velocities changed, and ends their contacts with bodies of other velocities.
    fn velocities_changed(&mut self, patch: &mut Patch, members: &[Local], axis: Axis) {
        for body in members {
            self.explore(patch, *body);
            patch.mark_dirty(*body, axis);
            self.end_contacts_of_other_velocity(patch, *body, axis);
            for index in 0..patch.bodies[*body as usize].touches.len() {
                let touch = patch.bodies[*body as usize].touches[index];
                // Across the axis, only corners depend on the velocities along it.
                match patch.touches[touch as usize].kind {
                    TouchKind::Face(face) if face != axis => continue,
                    TouchKind::Face(_) => {}
                    TouchKind::Corner => patch.mark_dirty(*body, axis.other()),
                }
                patch.refresh(touch);
            }
        }
    }

    fn end_contacts_of_other_velocity(&mut self, patch: &mut Patch, body: Local, axis: Axis) {
        self.keep_contacts(patch, body, axis, |patch, other| {
            let [own, others] = [body, other].map(|body| patch.axis(body, axis));
            let rounding = (own.speed + others.speed) * VELOCITY_ROUNDING;
            let [velocity, others] = [own.state.velocity, others.state.velocity];
            velocity == others || (velocity - others).high.abs() <= rounding
        });
    }

    /// Replaces an approach that has decayed by its limit: the bodies connected with it by faces whose relative
    /// speed is as small move on as one. Returns false if none of these pairs loses energy.
    fn take_decayed_limit(&mut self, patch: &mut Patch, index: u32, axis: Axis, threshold: f64, world: &World) -> bool {
        let touch = patch.touches[index as usize];
        let mut collapse = Collapse { touches: vec![index], ..Collapse::default() };
        touch.bodies.into_iter().for_each(|body| self.join_collapse(patch, body, axis, &mut collapse));
        let mut next = 0;
        while let Some(body) = collapse.members.get(next).copied() {
            next += 1;
            self.explore(patch, body);
            for place in 0..patch.bodies[body as usize].touches.len() {
                let index = patch.bodies[body as usize].touches[place];
                let touch = patch.touches[index as usize];
                let is_slow = patch.approach(&touch, axis).high.abs() <= threshold;
                if touch.kind == TouchKind::Face(axis) && is_slow {
                    collapse.touches.push(index);
                    self.join_collapse(patch, touch.other(body), axis, &mut collapse);
                }
            }
        }
        collapse.touches.sort_unstable();
        collapse.touches.dedup();
        let is_lossy = |touch: &u32| self.restitution(patch, &patch.touches[*touch as usize], world) < 1.0;
        if !collapse.touches.iter().any(is_lossy) {
            return false;
        }
        self.unify(patch, &collapse, axis);
        true
    }

    /// Adds a body to a collapse. An infinite mass, or a body that rests on one, only gives its velocity.
    fn join_collapse(&self, patch: &Patch, body: Local, axis: Axis, collapse: &mut Collapse) {
        let slot = patch.bodies[body as usize].slot;
        if Side::BOTH.into_iter().any(|side| self.contacts.is_immovable(slot, axis, side)) {
            collapse.anchor = collapse.anchor.or(Some(patch.axis(body, axis).state.velocity));
        } else if !collapse.members.contains(&body) {
            collapse.members.push(body);
        }
    }

    /// Gives the members of a collapse one velocity, that of its infinite mass or of its total momentum, and makes
    /// its touches contacts.
    fn unify(&mut self, patch: &mut Patch, collapse: &Collapse, axis: Axis) {
        let velocity = collapse.anchor.unwrap_or_else(|| self.common_velocity(patch, &collapse.members, axis));
        self.set_common_velocity(patch, &collapse.members, axis, velocity);
        for index in &collapse.touches {
            let touch = patch.touches[*index as usize];
            if !self.is_contact(patch, &touch, axis) {
                self.add_contact(patch, &touch, axis);
            }
        }
    }

    fn set_common_velocity(&mut self, patch: &mut Patch, members: &[Local], axis: Axis, velocity: DoubleDouble) {
        for body in members {
            let state = patch.axis_mut(*body, axis);
            state.state.velocity = velocity;
            state.speed = larger(velocity.high.abs(), state.speed);
            state.has_changed = true;
        }
        self.velocities_changed(patch, members, axis);
    }

    /// Total momentum divided by total mass, m/s; computed as the velocity of the first member plus the mean
    /// difference from it, in creation order.
    fn common_velocity(&self, patch: &Patch, members: &[Local], axis: Axis) -> DoubleDouble {
        let mut members = members.to_vec();
        members.sort_unstable_by_key(|body| patch.bodies[*body as usize].slot);
        let first = patch.axis(members[0], axis).state.velocity;
        let mut excess = DoubleDouble::ZERO;
        for body in &members {
            let difference = patch.axis(*body, axis).state.velocity - first;
            let mass = self.bodies.params(patch.bodies[*body as usize].slot).mass * MASS_UNIT;
            excess = excess + difference * DoubleDouble::from(mass);
        }
        first + excess / self.total_mass(patch, &members)
    }

    /// Records an impact in the history of its component; takes the limit of a cycle that decays, and fails on
    /// one that does not.
    fn follow_cycle(&mut self, patch: &mut Patch, index: u32, axis: Axis, world: &World) -> Result<(), StepError> {
        let root = patch.root_of_touch(&patch.touches[index as usize]) as usize;
        let greatest = patch.bursts[root].greatest;
        let mut history = std::mem::take(&mut patch.bursts[root].histories[axis as usize]);
        let approach = |touch: u32| patch.approach(&patch.touches[touch as usize], axis);
        let rounding = |touch: u32| {
            let [first, second] = patch.touches[touch as usize].bodies.map(|body| patch.axis(body, axis).speed);
            (first + second) * VELOCITY_ROUNDING
        };
        let cycle = history.push(index, greatest, approach, rounding);
        patch.bursts[root].histories[axis as usize] = history;
        match cycle {
            None => Ok(()),
            Some((Cycle::Decays, touches)) => {
                self.take_cycle_limit(patch, touches, axis);
                Ok(())
            }
            Some((Cycle::Persists, _)) => {
                // Infinite masses that approach each other make up for the losses. One of them can act through contacts.
                let mut body = 0;
                while body < patch.bodies.len() {
                    self.explore(patch, body as Local);
                    body += 1;
                }
                self.check_squeezed(patch, world)?;
                let pair = patch.touches[index as usize].bodies.map(|body| patch.bodies[body as usize].slot);
                Err(self.endless_error(world, pair))
            }
        }
    }

    /// Takes the limit of a decaying cycle, unless a body outside that touches the bodies of the cycle would be
    /// approached in the limit.
    fn take_cycle_limit(&mut self, patch: &mut Patch, touches: Vec<u32>, axis: Axis) {
        let mut collapse = Collapse { touches, ..Collapse::default() };
        for index in collapse.touches.clone() {
            for body in patch.touches[index as usize].bodies {
                self.join_collapse(patch, body, axis, &mut collapse);
            }
        }
        if !is_connected(patch, &collapse) {
            return;
        }
        let velocity = collapse.anchor.unwrap_or_else(|| self.common_velocity(patch, &collapse.members, axis));
        if self.reaches_outsider(patch, &collapse, axis, velocity) {
            return;
        }
        self.unify(patch, &collapse, axis);
        let root = patch.root(collapse.members[0]) as usize;
        patch.bursts[root].histories[axis as usize].restart();
    }

    /// True if a body that touches a member from outside would be approached at the common velocity.
    fn reaches_outsider(&self, patch: &Patch, collapse: &Collapse, axis: Axis, velocity: DoubleDouble) -> bool {
        collapse.members.iter().any(|body| {
            patch.bodies[*body as usize].touches.iter().any(|index| {
                let touch = &patch.touches[*index as usize];
                let other = touch.other(*body);
                if touch.kind != TouchKind::Face(axis)
                    || collapse.members.contains(&other)
                    || collapse.touches.contains(index)
                {
                    return false;
                }
                let outside = patch.axis(other, axis);
                let rounding = (outside.speed + patch.axis(*body, axis).speed) * VELOCITY_ROUNDING;
                let difference = match touch.side_of(*body, axis) {
                    Side::High => velocity - outside.state.velocity,
                    Side::Low => outside.state.velocity - velocity,
                };
                difference.high > rounding
            })
        })
    }

    /// Joins the lowest pair in creation order that separates but would be back before it has moved by the
    /// resolution of its coordinates; returns the pair if there is one.
    pub(super) fn capture_bounce(&mut self, patch: &mut Patch) -> Option<[Slot; 2]> {
        let slots = |touch: &Touch| touch.bodies.map(|body| patch.bodies[body as usize].slot);
        let resolution = self.bodies.resolution();
        let returning =
            patch.touches.iter().filter_map(|touch| Some((touch, returning_axis(patch, touch, resolution)?)));
        let (touch, axis) = returning.min_by_key(|(touch, _)| slots(touch))?;
        let (touch, pair) = (*touch, slots(touch));
        self.capture(patch, &touch, axis);
        Some(pair)
    }

    /// Joins two bodies, each with what it pushes, as a plastic impact does.
    fn capture(&mut self, patch: &mut Patch, touch: &Touch, axis: Axis) {
        let pair = touch.ordered(axis);
        let mut clusters = std::mem::take(&mut self.clusters);
        for side in Side::BOTH {
            self.collect_cluster(patch, pair[side], axis, side, &mut clusters[side as usize]);
        }
        let mass = [clusters[0].mass, clusters[1].mass];
        if mass.iter().any(|mass| mass.high < f64::INFINITY) {
            let velocity = pair.map(|body| patch.axis(body, axis).state.velocity);
            let impact = Impact { velocity, mass, restitution: 0.0 };
            let after = self.bodies.rounding().velocities(&impact, impact.velocities_after());
            self.set_velocities(patch, &clusters, axis, after);
            // A corner blocks along the axes that the accelerations from rest select.
            if touch.kind == TouchKind::Face(axis) && !self.is_contact(patch, touch, axis) {
                self.add_contact(patch, touch, axis);
            }
        }
        self.clusters = clusters;
    }

    /// Fails if a chain of touching faces lies between infinite masses that approach each other.
    fn check_squeezed(&self, patch: &Patch, world: &World) -> Result<(), StepError> {
        for axis in Axis::BOTH {
            for touch in patch.touches.iter().filter(|touch| touch.kind == TouchKind::Face(axis)) {
                let [wall, body] = touch.ordered(axis);
                if patch.bodies[wall as usize].infinite
                    && let Some(opposite) = squeezing_wall(patch, wall, body, axis)
                {
                    let slots = [body, wall, opposite].map(|body| patch.bodies[body as usize].slot);
                    let [body, between @ ..] = slots.map(|slot| self.name_of(world, slot));
                    return Err(StepError::Crushed { step: self.step, body, between });
                }
            }
        }
        Ok(())
    }

    /// The collision for the observer; inlined, so that nothing is computed for an observer that ignores it.
    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "all that a collision consists of")]
    fn collision_record(
        &self,
        patch: &Patch,
        touch: &Touch,
        axis: Axis,
        [velocity, after]: [[DoubleDouble; 2]; 2],
        impulse: f64,
        restitution: f64,
        before: [Vector; 2],
    ) -> Collision {
        let sign = if touch.side[axis] == Side::High { -1.0 } else { 1.0 };
        let slots = touch.bodies.map(|body| patch.bodies[body as usize].slot);
        let rect = |body: Local| {
            let [x, y] = Axis::BOTH.map(|axis| patch.axis(body, axis).state.position.high);
            let [width, height] = Axis::BOTH.map(|axis| patch.axis(body, axis).size.high);
            Rect::new(Vector::new(x, y), width, height)
        };
        let at = patch.bodies[patch.finite_of(touch.bodies) as usize].at;
        let offset = self.step_start.seconds_until(at);
        Collision {
            step: self.step,
            time: offset.clamp(0.0, self.clock.period),
            instant: at.high,
            axis,
            bodies: slots.map(|slot| self.bodies.params(slot).id),
            rects: touch.bodies.map(rect),
            normal: Vector::along(axis, sign),
            penetration: Vector::ZERO,
            shares: [0.0; 2],
            impulse,
            restitution,
            normal_velocity: [(velocity[1] - velocity[0]).high, (after[1] - after[0]).high],
            before,
            after: touch.bodies.map(|body| local_velocity(patch, body)),
        }
    }
}

/// The first axis along which two boxes part so slowly that they collide again before they have moved by the resolution of
/// their positions. At a corner they must also come to overlap on the other axis, from rest or after such a bounce.
fn returning_axis(patch: &Patch, touch: &Touch, resolution: Resolution) -> Option<Axis> {
    let acceleration = |axis: Axis| patch.approach_acceleration(touch, axis).high;
    let is_hidden = |axis: Axis| {
        let (speed, acceleration) = (-patch.approach(touch, axis).high, acceleration(axis));
        let coordinates = touch.bodies.map(|body| patch.axis(body, axis).state.position.high);
        let sizes = touch.bodies.map(|body| patch.axis(body, axis).size.high);
        acceleration > 0.0 && resolution.hides_bounce(speed, acceleration, coordinates, sizes)
    };
    let returns = |axis: Axis| patch.approach_sign(touch, axis) == Ordering::Less && is_hidden(axis);
    let enters = |axis: Axis| match patch.approach_sign(touch, axis) {
        Ordering::Greater => true,
        Ordering::Equal => acceleration(axis) > 0.0,
        Ordering::Less => is_hidden(axis),
    };
    Axis::BOTH.into_iter().find(|axis| match touch.kind {
        TouchKind::Face(face) => face == *axis && returns(face),
        TouchKind::Corner => returns(*axis) && enters(axis.other()),
    })
}

fn local_velocity(patch: &Patch, body: Local) -> Vector {
    let [x, y] = Axis::BOTH.map(|axis| patch.axis(body, axis).state.velocity.high);
    Vector::new(x, y)
}

/// True if the touches of a collapse connect all of its members.
fn is_connected(patch: &Patch, collapse: &Collapse) -> bool {
    let mut reached = vec![collapse.members.first().copied()];
    let mut known: Vec<Local> = collapse.members.first().copied().into_iter().collect();
    while let Some(body) = reached.pop().flatten() {
        for index in &collapse.touches {
            let touch = &patch.touches[*index as usize];
            if touch.bodies.contains(&body) {
                let other = touch.other(body);
                if collapse.members.contains(&other) && !known.contains(&other) {
                    known.push(other);
                    reached.push(Some(other));
                }
            }
        }
    }
    !known.is_empty() && known.len() == collapse.members.len()
}

/// The infinite mass on the high side that approaches `wall` through a chain of touching faces from `body` on.
fn squeezing_wall(patch: &Patch, wall: Local, body: Local, axis: Axis) -> Option<Local> {
    let mut reached = vec![body];
    let mut next = 0;
    while let Some(body) = reached.get(next).copied() {
        next += 1;
        for index in &patch.bodies[body as usize].touches {
            let touch = &patch.touches[*index as usize];
            if touch.kind != TouchKind::Face(axis) || touch.side_of(body, axis) == Side::Low {
                continue;
            }
            let other = touch.other(body);
            if !patch.bodies[other as usize].infinite {
                if !reached.contains(&other) {
                    reached.push(other);
                }
                continue;
            }
            let [low, high] = [wall, other].map(|body| patch.axis(body, axis));
            let rounding = (low.speed + high.speed) * VELOCITY_ROUNDING;
            if (low.state.velocity - high.state.velocity).high > rounding {
                return Some(other);
            }
        }
    }
    None
}
