//! Isolated impacts: neither of the two bodies that can be moved touches a third. Most impacts of a gas and most
//! bounces on a resting body are isolated. The numbers are the same as those of `simultaneous`.

use super::EventDriven;
use super::axis_trajectory::StateDd;
use super::body_state::Slot;
use super::double_double::DoubleDouble;
use super::exact::VELOCITY_ROUNDING;
use super::impact::Impact;
use super::impact_record::ImpactRecord;
use super::least_change::MASS_SCALE;
use super::neighbour_buffer::NeighbourBuffer;
use super::pair_event::Sample;
use super::reference::{Reference, ScaledState};
use crate::physics::{Axis, Collision, Observer, Rect, Side, Vector, World, larger};

/// Two bodies whose faces collide: the data that stay the same from impact to impact. A body that gives way has no
/// contacts.
///
/// All pairs have the body on the low side first.
#[derive(Clone, Copy, Debug)]
pub struct ImpactPair {
    bodies: [Slot; 2],
    axis: Axis,
    /// The side of the earlier body, in creation order, on which the later one lies.
    pub side: Side,
    /// True for a body that the impact cannot move.
    pub is_immovable: [bool; 2],
    /// The side of the body that keeps its position.
    pub anchor: Side,
    restitution: DoubleDouble,
    /// Masses, kg, times [`MASS_SCALE`]; infinite for a body that does not give way.
    mass: [DoubleDouble; 2],
}

impl ImpactPair {
    /// The bodies in creation order.
    #[inline]
    pub fn slots(&self) -> [Slot; 2] {
        self.in_creation_order(self.bodies)
    }

    #[inline]
    fn in_creation_order<T>(&self, [low, high]: [T; 2]) -> [T; 2] {
        if self.side == Side::High { [low, high] } else { [high, low] }
    }

    /// The impact at velocities before it, m/s.
    #[inline(always)]
    pub fn impact(&self, velocity: [DoubleDouble; 2]) -> Impact {
        Impact { velocity, mass: self.mass, restitution: self.restitution }
    }

    /// The greatest of the speeds of the bodies that the impact can move, before and after it.
    #[inline(always)]
    pub fn greatest_speed(&self, before: [f64; 2], after: &[DoubleDouble; 2]) -> f64 {
        let own_speed = |place: usize| if self.is_immovable[place] { 0.0 } else { before[place] };
        let speeds = [own_speed(0), own_speed(1), after[0].high.abs(), after[1].high.abs()];
        speeds.iter().fold(0.0, |greatest, speed| larger(*speed, greatest))
    }

    /// The positions in contact, given that of the anchor and the sizes.
    #[inline(always)]
    pub fn positions_in_contact(&self, anchor: DoubleDouble, sizes: &[DoubleDouble; 2]) -> [DoubleDouble; 2] {
        match self.anchor {
            Side::Low => [anchor, anchor + sizes[0]],
            Side::High => [anchor - sizes[0], anchor],
        }
    }
}

impl EventDriven {
    /// Carries out the impact of two bodies whose faces touch now, unless other bodies, contacts or limits are
    /// involved; returns true if it did. `side` is that of the first on which the second lies.
    pub(super) fn collide_isolated<O: Observer>(
        &mut self,
        world: &World,
        pair: [Slot; 2],
        axis: Axis,
        side: Side,
        observer: &mut O,
    ) -> bool {
        let Some(impact_pair) = self.impact_pair(world, pair, axis, side) else { return false };
        let [low, high] = impact_pair.bodies;
        // A supported body can lose its support or hit an infinite mass in this very instant; infinite masses hold no
        // such events in the queue.
        let is_firm = |place: usize| {
            let slot = impact_pair.bodies[place];
            !impact_pair.is_immovable[place] || self.bodies[slot].infinite || self.bodies.is_at_rest(slot)
        };
        if !is_firm(0) || !is_firm(1) {
            return false;
        }
        let references = [self.bodies.reference(low, axis), self.bodies.reference(high, axis)];
        let states = Reference::scaled_states_at(&references, self.timeline.now(), self.bodies.rounding());
        let Some(impact) = self.impact_of(&impact_pair, &states) else { return false };
        let gives_way = impact_pair.is_immovable.map(|is_immovable| !is_immovable);
        let mut neighbours = std::mem::take(&mut self.neighbour_buffer);
        let is_isolated = (!gives_way[0] || self.touches_none_but(low, Some(high), &mut neighbours))
            && (!gives_way[1] || self.touches_none_but(high, Some(low), &mut neighbours));
        self.neighbour_buffer = neighbours;
        if !is_isolated {
            return false;
        }
        self.carry_out(&impact_pair, &states, &impact, observer);
        for (slot, _) in [low, high].into_iter().zip(gives_way).filter(|(_, gives_way)| *gives_way) {
            self.invalidate(slot);
        }
        true
    }

    /// The data of two bodies whose faces collide; `None` if one that gives way has contacts, if neither gives way, or
    /// if the impact is plastic. `side` is that of the first on which the second lies.
    #[inline(always)]
    pub(super) fn impact_pair(&self, world: &World, pair: [Slot; 2], axis: Axis, side: Side) -> Option<ImpactPair> {
        let bodies = if side == Side::High { pair } else { [pair[1], pair[0]] };
        let [low, high] = bodies.map(|slot| self.bodies.params(slot));
        let restitution = self.restitutions[world.restitution.index(low.material, high.material)];
        let is_immovable = [(0, Side::Low), (1, Side::High)].map(|(place, pushed)| {
            self.bodies[bodies[place]].infinite || self.contacts.is_supported(bodies[place], axis, pushed)
        });
        let has_contacts = |place: usize| !is_immovable[place] && !self.contacts.of(bodies[place]).is_empty();
        if restitution.high == 0.0 || is_immovable == [true; 2] || has_contacts(0) || has_contacts(1) {
            return None;
        }
        let mass = [(low, is_immovable[0]), (high, is_immovable[1])].map(|(params, is_immovable)| match is_immovable {
            true => f64::INFINITY.into(),
            false => params.mass,
        });
        // The earlier body, or that which does not give way.
        let anchor = match (is_immovable, side) {
            ([true, _], _) => Side::Low,
            ([_, true], _) => Side::High,
            (_, Side::High) => Side::Low,
            (_, Side::Low) => Side::High,
        };
        Some(ImpactPair { bodies, axis, side, is_immovable, anchor, restitution, mass })
    }

    /// The impact of a pair, given the states now; `None` if the bodies do not approach, or the bounce is hidden by the
    /// resolution of positions.
    #[inline(always)]
    fn impact_of(&self, impact_pair: &ImpactPair, states: &[ScaledState; 2]) -> Option<Impact> {
        let &ImpactPair { bodies, axis, restitution, .. } = impact_pair;
        let [low, high] = states;
        let approach_speed = (low.state.velocity - high.state.velocity).high;
        if approach_speed <= (low.speed + high.speed) * VELOCITY_ROUNDING {
            return None;
        }
        let acceleration = low.state.acceleration_relative_to(&high.state).high;
        if acceleration > 0.0 {
            let coordinates = [low.state.position.high, high.state.position.high];
            let sizes = bodies.map(|slot| self.bodies[slot].size[axis]);
            if self.bodies.resolution().hides_bounce(
                restitution.high * approach_speed,
                acceleration,
                coordinates,
                sizes,
            ) {
                return None;
            }
        }
        Some(impact_pair.impact([low.state.velocity, high.state.velocity]))
    }

    /// Carries out the impact of a pair, given the states now; the predictions that involve the bodies remain to be
    /// invalidated.
    #[inline(always)]
    fn carry_out<O: Observer>(
        &mut self,
        impact_pair: &ImpactPair,
        states: &[ScaledState; 2],
        impact: &Impact,
        observer: &mut O,
    ) {
        let &ImpactPair { bodies, axis, is_immovable, .. } = impact_pair;
        let pair = impact_pair.slots();
        let [low, high] = states;
        let after = impact.velocities_with(impact.approach_speed(), || self.latest_shares.of(impact));
        let after = self.bodies.rounding().velocities(impact, after);
        let sizes = [self.bodies.size(bodies[0], axis), self.bodies.size(bodies[1], axis)];
        let acceleration = low.state.acceleration_relative_to(&high.state).high;
        let resolution = self.bodies.resolution().of_gap([sizes[0].high, sizes[1].high], low.length + high.length);
        let speed = impact_pair.greatest_speed([low.speed, high.speed], &after);
        // Boxes below the resolution of their coordinates have no certain sides.
        let is_extended = resolution < 0.25 * (sizes[0].high + sizes[1].high);
        let is_receding = (after[1] - after[0]).high > speed * VELOCITY_ROUNDING && acceleration <= 0.0 && is_extended;
        self.receding = is_receding.then_some(pair);
        let [low, high] = [low.state, high.state];
        let anchor = [low.position, high.position][impact_pair.anchor];
        let positions = impact_pair.positions_in_contact(anchor, &sizes);
        let velocities = after.map(|velocity| velocity.or_zero(speed * VELOCITY_ROUNDING));
        if !is_immovable[0] {
            let changed = StateDd { position: positions[0], velocity: velocities[0], ..low };
            self.bodies.set_trajectory(bodies[0], axis, changed, self.timeline.now());
        }
        if !is_immovable[1] {
            let changed = StateDd { position: positions[1], velocity: velocities[1], ..high };
            self.bodies.set_trajectory(bodies[1], axis, changed, self.timeline.now());
        }
        let impulse = impact.impulse() / MASS_SCALE;
        let before = states.map(|state| state.state.position);
        observer.collision_of(impulse, || self.record(impact_pair, before, impact, after, impulse));
    }

    /// The collision for the observer, given the positions at the impact, the velocities after it (m/s) and the impulse
    /// (N·s).
    pub(super) fn record(
        &self,
        impact_pair: &ImpactPair,
        positions: [DoubleDouble; 2],
        impact: &Impact,
        after: [DoubleDouble; 2],
        impulse: f64,
    ) -> Collision {
        let &ImpactPair { bodies, axis, side, restitution, .. } = impact_pair;
        let across = bodies.map(|slot| self.state_dd(slot, axis.other()));
        let vector = |along: f64, across: f64| match axis {
            Axis::X => Vector::new(along, across),
            Axis::Y => Vector::new(across, along),
        };
        let rect = |place: usize| {
            let [width, height] = self.bodies[bodies[place]].size;
            Rect::new(vector(positions[place].high, across[place].position.high), width, height)
        };
        let velocities = |along: [DoubleDouble; 2]| {
            let velocity = |place: usize| vector(along[place].high, across[place].velocity.high);
            impact_pair.in_creation_order([velocity(0), velocity(1)])
        };
        self.collision(ImpactRecord {
            slots: impact_pair.slots(),
            axis,
            side,
            at: self.timeline.now(),
            rects: impact_pair.in_creation_order([rect(0), rect(1)]),
            velocities: [velocities(impact.velocity), velocities(after)],
            along: [impact.velocity, after],
            impulse,
            restitution: restitution.high,
        })
    }

    /// True if a body certainly touches no other now, or only `partner`.
    pub(super) fn touches_none_but(&self, slot: Slot, partner: Option<Slot>, buffer: &mut NeighbourBuffer) -> bool {
        let sample = Sample::new(&self.bodies[slot], self.timeline.now());
        self.find_touching(slot, &sample, buffer);
        let mut others = buffer.slots().iter();
        others.all(|other| Some(*other) == partner || !sample.may_touch(&self.bodies[*other]))
    }
}
