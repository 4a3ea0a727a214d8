//! Closed groups: a few bodies in a row that touch no others for a while, as in Galperin's billiard. Their impacts are
//! carried out one after another without the event queue.
//!
//! A group influences no result: the numbers are the same as elsewhere, and where it is not certain by a margin which
//! event is next, or that two bodies recede, the group is left and its bodies predict again.
//!
//! Nearly all operations between two impacts wait for the one before: time of the impact, position, gap, quotient, time
//! of the next impact. So numbers that are not needed are not computed: the position of the body that is placed at the
//! other, differences known from the prediction, and double-double bounds where a sum of doubles decides already. That
//! makes Galperin's billiard 1.4 times as fast as with the general functions (`cargo bench --bench event_driven`, rows
//! `Galperin N`).

use super::EventDriven;
use super::axis_trajectory::StateDd;
use super::body_state::{MASS_SCALE, Slot};
use super::double_double::DoubleDouble;
use super::exact::VELOCITY_ROUNDING;
use super::instant::{Instant, VICINITY};
use super::isolated::ImpactPair;
use super::pair_event::CLEAR;
use super::predict::ordered_pair;
use super::reference::Reference;
use crate::physics::{Axis, Observer, Side, World, larger, smaller};

/// The number of events from one search for a group to the next: more than one, so that unsuccessful searches cost
/// little, and few, so that a group is found soon.
pub const SEARCH_INTERVAL: u64 = 4;

/// The fraction of a computed time for which bodies certainly stay apart, or overlap: less than 1 by more than the
/// rounding of that time.
const RELIABLE: f64 = 1.0 - 1.0 / (1_u64 << 30) as f64;

/// Bodies in a row along an axis, no two neighbours of infinite mass. They overlap along the other axis, all have
/// constant velocities, and those of finite mass have no contacts.
struct ClosedGroup {
    axis: Axis,
    /// In the order of their coordinates.
    members: Vec<Member>,
    /// The gap between each member and the next.
    gaps: Vec<Gap>,
    /// The seconds since step 0 up to which they overlap along the other axis and touch no other body.
    until: f64,
}

struct Member {
    slot: Slot,
    reference: Reference,
    /// True if it has collided since it predicted.
    has_collided: bool,
}

struct Gap {
    impact_pair: ImpactPair,
    /// The shares of the bodies in the change of relative velocity; not numbers if one of them is immovable.
    shares: [DoubleDouble; 2],
    /// The speed at which the two bodies approach, m/s.
    approach_speed: DoubleDouble,
    /// The velocities after the impact, m/s.
    after: [DoubleDouble; 2],
    /// The instant at which it closes.
    closes: Instant,
}

/// The position of two bodies relative to each other along an axis, and the seconds from now for which it certainly
/// lasts.
enum Overlap {
    Overlapping(f64),
    Apart(f64),
    Unclear,
}

impl EventDriven {
    /// After the impact of two isolated bodies along an axis, carries out the next impacts up to the instant `last` of
    /// the closed group to which they belong, if they do.
    #[inline]
    pub(super) fn continue_in_closed_group<O: Observer>(
        &mut self,
        world: &World,
        axis: Axis,
        last: Instant,
        observer: &mut O,
    ) {
        #[cfg(test)]
        let search_interval = self.search_interval;
        #[cfg(not(test))]
        let search_interval = SEARCH_INTERVAL;
        let are_few = !self.window_lists.is_active() && self.cell_lists.uses_all_pairs();
        if !are_few || !self.event_limit.events().is_multiple_of(search_interval) {
            return;
        }
        let Some(mut group) = self.find_closed_group(world, axis, last) else { return };
        if group.next_gap(last.high).is_none() {
            return;
        }
        self.enter(&mut group);
        while let Some(index) = group.next_gap(last.high)
            && self.collide_in_group(&mut group, index, observer)
        {}
        self.leave(&group);
    }

    /// Carries out the impact at a gap. Returns false if the group must be left, before the impact where it is not
    /// clear that the two bodies recede after it and touch no third.
    #[inline(always)]
    fn collide_in_group<O: Observer>(&mut self, group: &mut ClosedGroup, index: usize, observer: &mut O) -> bool {
        let Gap { impact_pair, approach_speed, after, closes: at, .. } = group.gaps[index];
        let references = [&group.members[index].reference, &group.members[index + 1].reference];
        let impact = impact_pair.impact(references.map(|reference| reference.state.velocity));
        let speed = impact_pair.greatest_speed(impact.velocity.map(|velocity| velocity.high.abs()), &after);
        // The low parts are below the rounding of the high ones.
        let are_receding = after[1].high - after[0].high > speed * CLEAR;
        let sizes = references.map(|reference| reference.size);
        let are_extended = self.coarsest_resolution(references, at) < 0.25 * (sizes[0].high + sizes[1].high);
        // The event that exceeds the limit is carried out, or reported, outside of the group.
        if !(are_receding && are_extended && group.is_isolated(index) && self.event_limit.count_allowed_event()) {
            return false;
        }
        self.timeline.advance_to_later(at);
        let impulse = impact.impulse_with(approach_speed) / MASS_SCALE;
        observer.collision_of(impulse, || {
            let positions = references.map(|reference| reference.drifted_position_at(at));
            self.record(&impact_pair, positions, &impact, after, impulse)
        });
        let anchor = references[impact_pair.anchor].drifted_position_at(at);
        let positions = impact_pair.positions_in_contact(anchor, &sizes);
        for side in Side::BOTH {
            if !impact_pair.is_immovable[side] {
                let member = &mut group.members[index + side as usize];
                let velocity = after[side].or_zero(speed * VELOCITY_ROUNDING);
                let state = StateDd { position: positions[side], velocity, acceleration: DoubleDouble::ZERO };
                (member.reference.state, member.reference.since) = (state, at);
                member.has_collided = true;
            }
        }
        #[cfg(test)]
        {
            self.impacts_in_groups += 1;
        }
        self.receding = Some(impact_pair.slots());
        self.update_gaps(group, index)
    }

    /// The closed group of the two bodies that have just collided along an axis, if they belong to one and recede.
    fn find_closed_group(&self, world: &World, axis: Axis, last: Instant) -> Option<ClosedGroup> {
        let receding = self.receding?;
        if !self.bodies.are_free() || self.bodies.rounding().is_random() {
            return None;
        }
        let seconds = self.timeline.now().seconds_until(last);
        let mut slots = self.overlapping(receding, axis.other(), seconds)?;
        let seconds = self.seconds_of_closure(&slots, axis.other(), seconds)?;
        let position = |slot: &Slot| self.bodies[*slot].trajectory.at(self.timeline.now())[0][axis];
        slots.sort_unstable_by(|a, b| position(a).total_cmp(&position(b)).then(a.cmp(b)));
        let mut gaps = Vec::with_capacity(slots.len() - 1);
        for pair in slots.windows(2) {
            let side = if pair[0] < pair[1] { Side::High } else { Side::Low };
            let impact_pair = self.impact_pair(world, ordered_pair(pair[0], pair[1]), axis, side)?;
            let shares = impact_pair.impact([DoubleDouble::ZERO; 2]).shares();
            let [approach_speed, after @ ..] = [DoubleDouble::ZERO; 3];
            gaps.push(Gap { impact_pair, shares, approach_speed, after, closes: Instant::NEVER });
        }
        let members = slots.into_iter().map(|slot| {
            let reference = self.bodies.reference(slot, axis);
            let has_collided = receding.contains(&slot) && !self.bodies[slot].infinite;
            Member { slot, reference, has_collided }
        });
        let mut group =
            ClosedGroup { axis, members: members.collect(), gaps, until: self.timeline.now().after(seconds).high };
        // Not even −0, so that all bits of the trajectories stay.
        let is_zero = |number: DoubleDouble| number.high.to_bits() == 0 && number.low.to_bits() == 0;
        // If an instant consists of several groups of bodies, some references are later than the clock by rounding.
        let has_begun = |member: &Member| !self.timeline.now().is_before(self.bodies[member.slot].since);
        if !group.members.iter().all(|member| is_zero(member.reference.state.acceleration) && has_begun(member)) {
            return None;
        }
        let hit = group.gaps.iter().position(|gap| gap.impact_pair.slots() == receding)?;
        for index in (0..group.gaps.len()).filter(|index| *index != hit) {
            let from = self.bodies.common_reference(group.gaps[index].impact_pair.slots());
            if !self.predict_gap(&mut group, index, from) {
                return None;
            }
        }
        Some(group)
    }

    /// Two bodies that overlap along an axis, and all others that overlap the first of them along it; `None` if that is
    /// not clear for one of them. `horizon` is that of [`overlap`](Self::overlap).
    fn overlapping(&self, pair: [Slot; 2], axis: Axis, horizon: f64) -> Option<Vec<Slot>> {
        let mut slots = pair.to_vec();
        for slot in self.cell_lists.few().iter().copied().filter(|slot| !pair.contains(slot)) {
            match self.overlap([pair[0], slot], axis, horizon) {
                Overlap::Overlapping(_) => slots.push(slot),
                Overlap::Apart(_) => {}
                Overlap::Unclear => return None,
            }
        }
        Some(slots)
    }

    /// The seconds from now, at most `horizon`, in which some bodies certainly keep overlapping along an axis, and
    /// apart from all others; `None` if they do not.
    fn seconds_of_closure(&self, members: &[Slot], axis: Axis, horizon: f64) -> Option<f64> {
        let mut least = f64::INFINITY;
        for (index, member) in members.iter().enumerate() {
            for other in self.cell_lists.few() {
                let place = members.iter().position(|slot| slot == other);
                let is_known = place.is_some_and(|place| place <= index);
                if is_known || (self.bodies[*member].infinite && self.bodies[*other].infinite) {
                    continue;
                }
                let seconds = match (self.overlap([*member, *other], axis, horizon), place) {
                    (Overlap::Overlapping(seconds), Some(_)) | (Overlap::Apart(seconds), None) => seconds,
                    _ => return None,
                };
                least = smaller(seconds, least);
            }
        }
        Some(least)
    }

    /// The position of two bodies relative to each other along an axis. Its seconds hold up to `horizon`, beyond which
    /// the rounding can be greater.
    fn overlap(&self, pair: [Slot; 2], axis: Axis, horizon: f64) -> Overlap {
        let [first, second] = pair.map(|slot| &self.bodies[slot]);
        let [[from, from_velocity], [to, to_velocity]] =
            [first, second].map(|body| body.trajectory.at(self.timeline.now()));
        if first.trajectory.acceleration[axis] != 0.0 || second.trajectory.acceleration[axis] != 0.0 {
            return Overlap::Unclear;
        }
        let (offset, velocity) = (to[axis] - from[axis], to_velocity[axis] - from_velocity[axis]);
        let [ahead, behind] = [offset - first.size[axis], -offset - second.size[axis]];
        let speeds = from_velocity[axis].abs() + to_velocity[axis].abs();
        let magnitudes = [first, second].map(|body| body.trajectory.magnitude_at(self.timeline.now())[axis]);
        let scale = magnitudes[0] + magnitudes[1] + (first.size[axis] + second.size[axis]);
        let rounding = (scale + speeds * horizon) * CLEAR;
        // The seconds until a distance is used up at a speed.
        let lasting = |distance: f64, speed: f64| match speed > 0.0 {
            true => (distance - rounding) / speed * RELIABLE,
            false => f64::INFINITY,
        };
        if ahead > rounding {
            Overlap::Apart(lasting(ahead, -velocity))
        } else if behind > rounding {
            Overlap::Apart(lasting(behind, velocity))
        } else if ahead < -rounding && behind < -rounding {
            let (ahead, behind) = (lasting(-ahead, velocity), lasting(-behind, -velocity));
            Overlap::Overlapping(smaller(ahead, behind))
        } else {
            Overlap::Unclear
        }
    }

    /// Removes the events of the members from the queue. The group ends before the next event of other bodies.
    fn enter(&mut self, group: &mut ClosedGroup) {
        for member in &group.members {
            if !self.bodies[member.slot].is_static() {
                self.event_queue.set(member.slot, None);
            }
        }
        group.until = smaller(group.until, self.event_queue.next_time().high);
    }

    /// Predicts the next events of the members. Those that have collided are only marked as changed and predict at the
    /// end of the instant.
    fn leave(&mut self, group: &ClosedGroup) {
        for member in group.members.iter().filter(|member| member.has_collided) {
            let Reference { state, since, .. } = member.reference;
            self.bodies.set_trajectory(member.slot, group.axis, state, since);
            self.invalidate(member.slot);
        }
        for member in group.members.iter().filter(|member| !member.has_collided) {
            if !self.bodies[member.slot].is_static() {
                self.predict(member.slot);
            }
        }
    }

    /// Updates the gap that has just closed and those on the other sides of the two bodies, unless these keep their
    /// trajectories; returns false if it is not certain when one closes.
    #[inline(always)]
    fn update_gaps(&self, group: &mut ClosedGroup, index: usize) -> bool {
        let [keeps_low, keeps_high] = group.gaps[index].impact_pair.is_immovable;
        group.gaps[index].closes = Instant::NEVER;
        for (neighbour, is_kept) in [(index.wrapping_sub(1), keeps_low), (index + 1, keeps_high)] {
            if neighbour < group.gaps.len() && !is_kept && !self.predict_gap(group, neighbour, self.timeline.now()) {
                return false;
            }
        }
        true
    }

    /// Predicts the impact at a gap, given an instant from which the trajectories of both bodies hold. Returns false if
    /// the gap may be closed or closes at once.
    ///
    /// The numbers are those of `ExactAxis::contact`, which can negate a difference where this swaps its operands: at
    /// most the sign of a low part of 0 differs, on which no sum or quotient depends.
    #[inline(always)]
    fn predict_gap(&self, group: &mut ClosedGroup, index: usize, from: Instant) -> bool {
        let [low, high] = [&group.members[index].reference, &group.members[index + 1].reference];
        let size = high.drifted_position_at(from) - low.drifted_position_at(from) - low.size;
        let is_apart = size.high > self.coarsest_resolution([low, high], from);
        let velocities = [low.state.velocity, high.state.velocity];
        let speeds = velocities[0].high.abs() + velocities[1].high.abs();
        let gap = &mut group.gaps[index];
        gap.approach_speed = velocities[0] - velocities[1];
        // Before the quotient, so that the processor computes them while it waits for the size of the gap. That makes
        // Galperin's billiard 1.1 times as fast.
        gap.after = gap.impact_pair.impact(velocities).velocities_with(gap.approach_speed, || gap.shares);
        gap.closes = if gap.approach_speed.high > speeds * VELOCITY_ROUNDING {
            from.after_exactly(size / gap.approach_speed)
        } else {
            Instant::NEVER
        };
        is_apart && self.timeline.now().is_before(gap.closes)
    }

    /// An upper bound of the resolution of the gap between two members at an instant, m.
    #[inline(always)]
    fn coarsest_resolution(&self, [low, high]: [&Reference; 2], at: Instant) -> f64 {
        let sizes = [low.size.high, high.size.high];
        let starts = low.state.position.high.abs() + high.state.position.high.abs();
        let speeds = low.state.velocity.high.abs() + high.state.velocity.high.abs();
        // The seconds since the references are less than those since step 0.
        let magnitude = starts + (sizes[0] + sizes[1]) + speeds * at.high;
        self.bodies.resolution().of_gap(sizes, 2.0 * magnitude)
    }
}

impl ClosedGroup {
    /// The gap that closes first, if it does so before `last` (s) and certainly before all other events.
    #[inline]
    fn next_gap(&self, last: f64) -> Option<usize> {
        let (mut at, mut second) = (f64::INFINITY, self.until);
        for gap in &self.gaps {
            let closes = gap.closes.high;
            second = smaller(larger(closes, at), second);
            at = smaller(closes, at);
        }
        let is_certain = at < last && at * VICINITY < second;
        if is_certain { self.gaps.iter().position(|gap| gap.closes.high == at) } else { None }
    }

    /// True if the two bodies at a gap certainly touch no other member that they could push when it closes, and no two
    /// members that are not neighbours touch then.
    #[inline]
    fn is_isolated(&self, index: usize) -> bool {
        let Gap { impact_pair, closes: at, .. } = &self.gaps[index];
        let members = &self.members[..];
        let is_clear_below =
            index == 0 || impact_pair.is_immovable[0] || are_apart([&members[index - 1], &members[index]], *at);
        let is_clear_above = index + 2 == members.len()
            || impact_pair.is_immovable[1]
            || are_apart([&members[index + 1], &members[index + 2]], *at);
        is_clear_below && is_clear_above && members.windows(3).all(|row| are_apart([&row[0], &row[2]], *at))
    }
}

/// True if two members, that on the low side first, are certainly apart along the axis at an instant.
#[inline(always)]
fn are_apart(pair: [&Member; 2], at: Instant) -> bool {
    let [low, high] = pair.map(|member| &member.reference);
    let position = |reference: &Reference| {
        reference.state.position.high + reference.state.velocity.high * (at.high - reference.since.high)
    };
    let positions = [position(low), position(high)];
    let gap = positions[1] - positions[0] - low.size.high;
    let speeds = low.state.velocity.high.abs() + high.state.velocity.high.abs();
    let scale = positions[0].abs() + positions[1].abs() + low.size.high + high.size.high;
    // This includes the path within the vicinity of the instant.
    gap > (scale + speeds * at.high) * CLEAR
}

#[cfg(test)]
mod tests {
    use crate::physics::event_driven::pseudo_random::PseudoRandom;
    use crate::physics::{Collision, Engine, EngineConfig, Event, Rect, Restitution, SolverKind, Spawn, Vector};

    /// Bodies in a row with walls, some that come from the side, and events between the steps.
    struct Scene {
        config: EngineConfig,
        steps: u64,
        events: Vec<(u64, Event)>,
    }

    impl Scene {
        fn random(random: &mut PseudoRandom) -> Scene {
            let rate = random.pick(&[0.25, 1.0, 1.0, 8.0]);
            let restitution = random.pick(&[1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.99, 0.9, 0.5]);
            let gravity = random.pick(&[None, None, None, None, None, None, None, Some(Vector::new(0.0, 1.0))]);
            let config = EngineConfig::new(SolverKind::EventDriven, rate)
                .with_restitution(Restitution::new(restitution, &[]))
                .with_gravity(gravity)
                .with_events_per_step(random.pick(&[20, 200, 1000, 1000, 1000]));
            let steps = 6;
            let mut scene = Scene { config, steps, events: Vec::new() };
            let is_vertical = random.next() < 0.3;
            scene.add_row(random, is_vertical);
            for _ in 0..random.pick(&[0, 0, 0, 1, 2]) {
                let (along, across) = (random.between(-2.0, 12.0), random.pick(&[-6.0, -3.0, 4.0]));
                let towards = if across < 0.0 { random.between(0.0, 0.6) } else { -random.between(0.0, 0.6) };
                let mass = random.pick(&[1.0, 1e3, f64::INFINITY]);
                let step = random.pick(&[0, 0, 2]);
                let speeds = [random.pick(&[0.0, 0.3, -0.3]), towards];
                scene.spawn(step, is_vertical, [along, across], [1.0, 1.0], mass, speeds);
            }
            for _ in 0..random.pick(&[0, 0, 1]) {
                scene.events.push((random.pick(&[1, 3]), Event::Delete((random.next() * 4.0) as u32)));
            }
            scene
        }

        fn add_row(&mut self, random: &mut PseudoRandom, is_vertical: bool) {
            let across = random.pick(&[0.0, 0.0, 0.0, 0.01, -0.05]);
            let mut along = 0.0;
            let count = random.pick(&[2, 2, 2, 3, 3, 4]);
            let walls = [random.next() < 0.9, random.next() < 0.7];
            let mut row = Vec::new();
            if walls[0] {
                row.push(([-1.0, -1.0], [1.0, 4.0], f64::INFINITY, random.pick(&[0.0, 0.0, 0.0, 0.01])));
            }
            for index in 0..count {
                let size = random.pick(&[1.0, 1.0, 0.1, 1e-3, 1.0 / 3.0]);
                along += random.pick(&[0.0, 0.5, 0.1, 1.0]) + random.next();
                let mass = random.pick(&[1.0, 1.0, 3.0, 100.0, 1e4, 1e8, 1e16]);
                let speed = if index == 0 {
                    0.0
                } else {
                    random.pick(&[-1.0, -0.25, 0.0, 1.0, 3.0]) * random.between(0.5, 1.0)
                };
                row.push(([along, random.next() - 0.5], [size, 1.0 + random.next()], mass, speed));
                along += size;
            }
            if walls[1] {
                row.push(([along + random.next(), -1.0], [1.0, 4.0], f64::INFINITY, 0.0));
            }
            if random.next() < 0.3 {
                row.reverse();
            }
            for (at, size, mass, speed) in row {
                let across = if mass == f64::INFINITY { 0.0 } else { across * random.pick(&[1.0, 1.0, 0.0, -1.0]) };
                self.spawn(0, is_vertical, at, size, mass, [speed, across]);
            }
        }

        fn spawn(&mut self, step: u64, is_vertical: bool, at: [f64; 2], size: [f64; 2], mass: f64, velocity: [f64; 2]) {
            let vector = |[along, across]: [f64; 2]| match is_vertical {
                true => Vector::new(across, along),
                false => Vector::new(along, across),
            };
            let size = vector(size);
            let rect = Rect::new(vector(at), size.x, size.y);
            self.events
                .push((step, Event::Spawn(Spawn::new(String::new(), rect, mass).with_velocity(vector(velocity)))));
        }

        /// All collisions, states, snapshots and errors of a run in which groups are looked for after every so many
        /// events, and the number of impacts in groups.
        fn run(&self, search_interval: u64) -> (Vec<String>, u64) {
            let mut engine = Engine::new(self.config.clone());
            engine.assert_invariants();
            engine.event_driven_mut().search_interval = search_interval;
            let mut record = Vec::new();
            for step in 0..self.steps {
                self.events.iter().filter(|(at, _)| *at == step).for_each(|(_, event)| engine.apply(event));
                let mut collisions: Vec<Collision> = Vec::new();
                let between = engine.world_after(0.4 / self.config.rate, &mut collisions);
                let result = engine.step(&mut collisions);
                record.extend(collisions.iter().map(|collision| format!("{collision:?}")));
                record.push(format!("{between:?} {result:?} {:?}", engine.snapshot()));
            }
            (record, engine.event_driven_mut().impacts_in_groups)
        }
    }

    #[test]
    fn groups_influence_no_result() {
        let (mut in_groups, mut scenes_with_groups) = (0, 0);
        let scenes = if cfg!(debug_assertions) { 150 } else { 1000 };
        for seed in 0..scenes {
            let scene = Scene::random(&mut PseudoRandom(seed * 7919));
            let (expected, none) = scene.run(u64::MAX);
            assert_eq!(none, 0);
            for interval in [1, super::SEARCH_INTERVAL] {
                let (record, impacts) = scene.run(interval);
                for (one, other) in expected.iter().zip(&record) {
                    assert_eq!(one, other, "seed {seed}, interval {interval}");
                }
                assert_eq!(record.len(), expected.len(), "seed {seed}");
                if interval == 1 {
                    in_groups += impacts;
                    scenes_with_groups += u32::from(impacts > 0);
                }
            }
        }
        assert!(scenes_with_groups > scenes / 5 && in_groups > 20 * u64::from(scenes));
    }

    #[test]
    fn galperins_billiard_is_one_group() {
        let mut engine = Engine::new(EngineConfig::new(SolverKind::EventDriven, 1.0));
        for (at, size, mass, velocity) in [(0.0, 1.0, f64::INFINITY, 0.0), (4.0, 1.0, 1.0, 0.0), (8.0, 2.0, 1e8, -1.0)]
        {
            let rect = Rect::new(Vector::new(at, 10.0 - size), size, size);
            let spawn = Spawn::new(String::new(), rect, mass).with_velocity(Vector::new(velocity, 0.0));
            engine.apply(&Event::Spawn(spawn));
        }
        let mut collisions: Vec<Collision> = Vec::new();
        for _ in 0..20 {
            engine.step(&mut collisions).unwrap();
        }
        assert_eq!(collisions.len(), 31_415);
        assert!(engine.event_driven_mut().impacts_in_groups > 31_300);
    }
}
