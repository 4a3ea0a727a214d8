//! Isolated impacts: neither of the two bodies that can be moved touches a third. Most impacts of a gas and most
//! bounces on a resting body are isolated. The numbers are the same as those of `simultaneous`.

use super::EventDriven;
use super::axis_trajectory::StateDd;
use super::body_state::{MASS_SCALE, Slot};
use super::double_double::DoubleDouble;
use super::exact::VELOCITY_ROUNDING;
use super::impact::Impact;
use super::impact_record::ImpactRecord;
use super::neighbour_buffer::NeighbourBuffer;
use super::pair_event::Sample;
use super::reference::{Reference, ScaledState};
use crate::physics::{Axis, Collision, Observer, Rect, Side, Vector, World, larger};

/// Two bodies whose faces collide: the data that stay the same from impact to impact. A body that gives way has no
/// contacts.
///
/// All pairs are indexed by [`Side`]: the body on the low side is the first.
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
        let own_speed = |side: Side| if self.is_immovable[side] { 0.0 } else { before[side] };
        let speeds = [own_speed(Side::Low), own_speed(Side::High), after[0].high.abs(), after[1].high.abs()];
        speeds.iter().fold(0.0, |greatest, speed| larger(*speed, greatest))
    }

    /// The positions in contact, given that of the anchor and the sizes.
    #[inline(always)]
    pub fn positions_in_contact(&self, anchor: DoubleDouble, sizes: &[DoubleDouble; 2]) -> [DoubleDouble; 2] {
        match self.anchor {
            Side::Low => [anchor, anchor + sizes[Side::Low]],
            Side::High => [anchor - sizes[Side::Low], anchor],
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
        // A supported body can lose its support or hit an infinite mass in this very instant; infinite masses hold no
        // such events in the queue.
        let is_firm = |side: Side| {
            let slot = impact_pair.bodies[side];
            !impact_pair.is_immovable[side] || self.bodies[slot].infinite || self.bodies.is_at_rest(slot)
        };
        if !Side::BOTH.into_iter().all(is_firm) {
            return false;
        }
        let references = impact_pair.bodies.map(|slot| self.bodies.reference(slot, axis));
        let states = Reference::scaled_states_at(&references, self.timeline.now(), self.bodies.rounding());
        let Some(impact) = self.impact_of(&impact_pair, &states) else { return false };
        let mut neighbours = std::mem::take(&mut self.neighbour_buffer);
        let is_isolated = Side::BOTH.into_iter().all(|side| {
            let [slot, partner] = [impact_pair.bodies[side], impact_pair.bodies[side.opposite()]];
            impact_pair.is_immovable[side] || self.touches_none_but(slot, Some(partner), &mut neighbours)
        });
        self.neighbour_buffer = neighbours;
        if !is_isolated {
            return false;
        }
        self.carry_out(&impact_pair, &states, &impact, observer);
        if impact_pair.is_immovable == [false; 2] {
            // Both are listed below, and a list without duplicates need not be sorted.
            debug_assert!(self.changed.iter().all(|slot| pair.contains(slot)));
            self.changed.clear();
        }
        for side in Side::BOTH {
            if !impact_pair.is_immovable[side] {
                self.invalidate(impact_pair.bodies[side]);
            }
        }
        true
    }

    /// The data of two bodies whose faces collide; `None` if one that gives way has contacts, if neither gives way, or
    /// if the impact is plastic. `side` is that of the first on which the second lies.
    #[inline(always)]
    pub(super) fn impact_pair(&self, world: &World, pair: [Slot; 2], axis: Axis, side: Side) -> Option<ImpactPair> {
        let bodies = if side == Side::High { pair } else { [pair[1], pair[0]] };
        let [low, high] = bodies.map(|slot| self.bodies.params(slot).material);
        let restitution = self.restitutions[world.restitution.index(low, high)];
        let is_immovable = Side::BOTH
            .map(|side| self.bodies[bodies[side]].infinite || self.contacts.is_supported(bodies[side], axis, side));
        let has_contacts = |side: Side| !is_immovable[side] && !self.contacts.of(bodies[side]).is_empty();
        if restitution.high == 0.0 || is_immovable == [true; 2] || Side::BOTH.into_iter().any(has_contacts) {
            return None;
        }
        let mass = Side::BOTH
            .map(|side| if is_immovable[side] { f64::INFINITY.into() } else { self.bodies.params(bodies[side]).mass });
        // The body that does not give way, or else the earlier one.
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
        if approach_speed <= (low.magnitudes.velocity + high.magnitudes.velocity) * VELOCITY_ROUNDING {
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
        let sizes = bodies.map(|slot| self.bodies.size(slot, axis));
        let acceleration = low.state.acceleration_relative_to(&high.state).high;
        let magnitudes = [low.magnitudes, high.magnitudes];
        let magnitude = magnitudes[0].position + magnitudes[1].position;
        let resolution = self.bodies.resolution().of_gap([sizes[0].high, sizes[1].high], magnitude);
        let speed = impact_pair.greatest_speed(magnitudes.map(|magnitudes| magnitudes.velocity), &after);
        // Boxes below the resolution of their coordinates have no certain sides.
        let is_extended = resolution < 0.25 * (sizes[0].high + sizes[1].high);
        let is_receding = (after[1] - after[0]).high > speed * VELOCITY_ROUNDING && acceleration <= 0.0 && is_extended;
        self.receding = is_receding.then_some(pair);
        let positions = impact_pair.positions_in_contact(states[impact_pair.anchor].state.position, &sizes);
        for side in Side::BOTH {
            if !is_immovable[side] {
                let velocity = after[side].or_zero(speed * VELOCITY_ROUNDING);
                let changed = StateDd { position: positions[side], velocity, ..states[side].state };
                self.bodies.set_trajectory(bodies[side], axis, changed, self.timeline.now());
            }
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
        let rects = Side::BOTH.map(|side| {
            let [width, height] = self.bodies[bodies[side]].size;
            Rect::new(vector(positions[side].high, across[side].position.high), width, height)
        });
        let velocities = |along: [DoubleDouble; 2]| {
            let velocity = |side: Side| vector(along[side].high, across[side].velocity.high);
            impact_pair.in_creation_order(Side::BOTH.map(velocity))
        };
        self.collision(ImpactRecord {
            slots: impact_pair.slots(),
            axis,
            side,
            at: self.timeline.now(),
            rects: impact_pair.in_creation_order(rects),
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
