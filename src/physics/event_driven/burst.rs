//! The impacts of one instant: of all approaching pairs the lowest in creation order, again and again; corners only
//! when no faces approach. An infinite sequence is replaced by its limit (`collapse`).

use super::EventDriven;
use super::body_state::{MASS_SCALE, Slot};
use super::collapse::decay_threshold;
use super::double_double::DoubleDouble;
use super::event_limit::LimitExceeded;
use super::exact::{Resolution, VELOCITY_ROUNDING};
use super::impact::Impact;
use super::impact_record::ImpactRecord;
use super::patch::{CornerMotion, Local, Patch, Touch, TouchKind};
use crate::physics::{Axis, Observer, Rect, Side, StepError, Vector, World, larger};
use std::cmp::Ordering;

/// The impacts between two searches for chains that infinite masses squeeze.
const SQUEEZE_INTERVAL: u64 = 64;

/// One side of an impact: the body and all that it pushes.
#[derive(Clone, Debug, Default)]
pub struct Cluster {
    /// The body, and the others in creation order. Empty if the impact moves none.
    pub members: Vec<Local>,
    /// The total mass, kg, times [`MASS_SCALE`]; infinite if the cluster cannot move.
    pub mass: DoubleDouble,
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
        self.event_limit.begin_burst();
        while let Some(index) = patch.first_approaching() {
            if count.is_multiple_of(SQUEEZE_INTERVAL) {
                self.check_squeezed(patch, world)?;
            }
            count += 1;
            let touch = patch.touches[index as usize];
            let axes = match touch.kind {
                TouchKind::Face(Axis::X) => [true, false],
                TouchKind::Face(Axis::Y) => [false, true],
                TouchKind::Corner => patch.blocked_axes(&touch, CornerMotion::Moving),
            };
            let restitution = self.restitution(patch, &touch, world);
            self.event_limit.count_impact(restitution.high).map_err(|LimitExceeded| {
                self.too_many_events(world, touch.bodies.map(|body| patch.bodies[body as usize].slot))
            })?;
            for axis in Axis::BOTH.into_iter().filter(|axis| axes[*axis]) {
                self.collide(patch, index, axis, restitution, world, observer)?;
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
        restitution: DoubleDouble,
        world: &World,
        observer: &mut O,
    ) -> Result<(), StepError> {
        let touch = patch.touches[index as usize];
        let approach_speed = patch.approach_speed(&touch, axis).high;
        let root = patch.root_of_touch(&touch) as usize;
        let greatest = larger(patch.bursts[root].greatest, approach_speed);
        patch.bursts[root].greatest = greatest;
        let threshold = decay_threshold(patch, &touch, axis, greatest);
        if approach_speed <= threshold && self.take_decayed_limit(patch, index, axis, threshold, world) {
            return Ok(());
        }
        self.apply_impact(patch, &touch, axis, restitution, world, observer)?;
        if restitution.high == 0.0 && !self.is_contact(patch, &touch, axis) {
            self.add_contact(patch, &touch, axis);
        }
        self.follow_cycle(patch, index, approach_speed, axis, world)
    }

    pub(super) fn restitution(&self, patch: &Patch, touch: &Touch, world: &World) -> DoubleDouble {
        let [first, second] = touch.bodies.map(|body| self.bodies.params(patch.bodies[body as usize].slot).material);
        self.restitutions[world.restitution.index(first, second)]
    }

    /// Applies the impact law to the clusters on both sides of a touch.
    fn apply_impact<O: Observer>(
        &mut self,
        patch: &mut Patch,
        touch: &Touch,
        axis: Axis,
        restitution: DoubleDouble,
        world: &World,
        observer: &mut O,
    ) -> Result<(), StepError> {
        let mut clusters = std::mem::take(&mut self.clusters);
        let impact = self.impact_of_clusters(patch, touch, axis, restitution, &mut clusters);
        if !impact.moves_a_body() {
            self.clusters = clusters;
            let pair = touch.ordered(axis);
            return Err(self.crushed_error(world, pair.map(|body| patch.bodies[body as usize].slot), axis));
        }
        let after = self.bodies.rounding().velocities(&impact, impact.velocities_after());
        let velocities_now = |patch: &Patch| touch.bodies.map(|body| local_velocity(patch, body));
        let before = velocities_now(patch);
        self.set_velocities(patch, &clusters, axis, after);
        self.clusters = clusters;
        let impulse = impact.impulse() / MASS_SCALE;
        observer.collision_of(impulse, || {
            self.collision(ImpactRecord {
                slots: touch.bodies.map(|body| patch.bodies[body as usize].slot),
                axis,
                side: touch.side[axis],
                at: patch.bodies[patch.finite_of(touch.bodies) as usize].at,
                rects: touch.bodies.map(|body| local_rect(patch, body)),
                velocities: [before, velocities_now(patch)],
                along: [impact.velocity, after],
                impulse,
                restitution: restitution.high,
            })
        });
        Ok(())
    }

    /// The impact of the two bodies of a touch, each with what it pushes, which replaces `clusters`.
    pub(super) fn impact_of_clusters(
        &self,
        patch: &mut Patch,
        touch: &Touch,
        axis: Axis,
        restitution: DoubleDouble,
        clusters: &mut [Cluster; 2],
    ) -> Impact {
        let pair = touch.ordered(axis);
        for side in Side::BOTH {
            self.collect_cluster(patch, pair[side], axis, side, &mut clusters[side]);
        }
        let velocity = pair.map(|body| patch.axis(body, axis).state.velocity);
        Impact { velocity, mass: [clusters[0].mass, clusters[1].mass], restitution }
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
                    let other = self.local_of(patch, contact.other, patch.bodies[body as usize].at);
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

    /// The total mass of bodies, kg, times [`MASS_SCALE`], summed in creation order. Those after the first must be in
    /// this order.
    pub(super) fn total_mass(&self, patch: &Patch, members: &[Local]) -> DoubleDouble {
        let slot_of = |body: &Local| patch.bodies[*body as usize].slot;
        let mass = |body: &Local| self.bodies.params(slot_of(body)).mass;
        let Some((first, others)) = members.split_first() else { return DoubleDouble::ZERO };
        let (earlier, later) = others.split_at(others.partition_point(|body| slot_of(body) < slot_of(first)));
        let in_order = earlier.iter().chain([first]).chain(later).map(mass);
        in_order.reduce(|sum, mass| sum + mass).unwrap_or(DoubleDouble::ZERO)
    }

    /// Gives the clusters on both sides of an impact their velocities and ends their contacts with bodies of
    /// other velocities.
    fn set_velocities(&mut self, patch: &mut Patch, clusters: &[Cluster; 2], axis: Axis, after: [DoubleDouble; 2]) {
        let mut magnitude = 0.0;
        for body in clusters.iter().flat_map(|cluster| &cluster.members) {
            magnitude = larger(patch.axis(*body, axis).magnitudes.velocity, magnitude);
        }
        for velocity in after {
            magnitude = larger(velocity.high.abs(), magnitude);
        }
        for side in Side::BOTH {
            for body in &clusters[side].members {
                let state = patch.axis_mut(*body, axis);
                state.state.velocity = after[side];
                state.magnitudes.velocity = magnitude;
                patch.mark_changed(*body, axis);
            }
        }
        for cluster in clusters {
            self.velocities_changed(patch, &cluster.members, axis);
        }
    }

    /// Explores the bodies whose velocities changed, and ends their contacts with bodies of other velocities.
    pub(super) fn velocities_changed(&mut self, patch: &mut Patch, members: &[Local], axis: Axis) {
        for body in members {
            self.explore(patch, *body);
            patch.mark_dirty(*body, axis);
            self.end_contacts_of_other_velocity(patch, *body, axis);
            if patch.touches_corner(*body) {
                patch.mark_dirty(*body, axis.other());
            }
            patch.refresh_along(*body, axis);
        }
    }

    fn end_contacts_of_other_velocity(&mut self, patch: &mut Patch, body: Local, axis: Axis) {
        self.keep_contacts(patch, body, axis, |patch, other| {
            let [own, others] = [body, other].map(|body| patch.axis(body, axis));
            let rounding = (own.magnitudes.velocity + others.magnitudes.velocity) * VELOCITY_ROUNDING;
            let [velocity, others] = [own.state.velocity, others.state.velocity];
            velocity == others || (velocity - others).high.abs() <= rounding
        });
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
        let mut clusters = std::mem::take(&mut self.clusters);
        let impact = self.impact_of_clusters(patch, touch, axis, DoubleDouble::ZERO, &mut clusters);
        if impact.moves_a_body() {
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
    pub(super) fn check_squeezed(&self, patch: &Patch, world: &World) -> Result<(), StepError> {
        for axis in Axis::BOTH {
            for touch in patch.touches.iter().filter(|touch| touch.kind == TouchKind::Face(axis)) {
                let [wall, body] = touch.ordered(axis);
                if patch.bodies[wall as usize].infinite
                    && let Some(opposite) = squeezing_wall(patch, wall, body, axis)
                {
                    let slots = [body, wall, opposite].map(|body| patch.bodies[body as usize].slot);
                    let [body, between @ ..] = slots.map(|slot| self.name_of(world, slot));
                    return Err(StepError::Crushed { step: self.timeline.step(), body, between });
                }
            }
        }
        Ok(())
    }
}

/// The first axis along which two boxes part so slowly that they collide again before they have moved by the resolution
/// of their positions. At a corner they must also come to overlap on the other axis, from rest or after such a bounce.
fn returning_axis(patch: &Patch, touch: &Touch, resolution: Resolution) -> Option<Axis> {
    let acceleration = |axis: Axis| patch.approach_acceleration(touch, axis).high;
    let is_hidden = |axis: Axis| {
        let (speed, acceleration) = (-patch.approach_speed(touch, axis).high, acceleration(axis));
        let coordinates = touch.bodies.map(|body| patch.axis(body, axis).state.position.high);
        let sizes = touch.bodies.map(|body| patch.axis(body, axis).size.high);
        acceleration > 0.0 && resolution.hides_bounce(speed, acceleration, coordinates, sizes)
    };
    let returns = |axis: Axis| patch.approach_speed_sign(touch, axis) == Ordering::Less && is_hidden(axis);
    let enters = |axis: Axis| match patch.approach_speed_sign(touch, axis) {
        Ordering::Greater => true,
        Ordering::Equal => acceleration(axis) > 0.0,
        Ordering::Less => is_hidden(axis),
    };
    Axis::BOTH.into_iter().find(|axis| match touch.kind {
        TouchKind::Face(face) => face == *axis && returns(face),
        TouchKind::Corner => returns(*axis) && enters(axis.other()),
    })
}

fn local_rect(patch: &Patch, body: Local) -> Rect {
    let [x, y] = Axis::BOTH.map(|axis| patch.axis(body, axis).state.position.high);
    let [width, height] = Axis::BOTH.map(|axis| patch.axis(body, axis).size.high);
    Rect::new(Vector::new(x, y), width, height)
}

fn local_velocity(patch: &Patch, body: Local) -> Vector {
    let [x, y] = Axis::BOTH.map(|axis| patch.axis(body, axis).state.velocity.high);
    Vector::new(x, y)
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
            let rounding = (low.magnitudes.velocity + high.magnitudes.velocity) * VELOCITY_ROUNDING;
            if (low.state.velocity - high.state.velocity).high > rounding {
                return Some(other);
            }
        }
    }
    None
}
