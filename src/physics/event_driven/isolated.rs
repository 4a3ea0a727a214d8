//! The impact of two bodies of which those that give way touch nothing else: most impacts of a gas, and most
//! bounces on something that rests. It computes the same numbers as `simultaneous`.

use super::EventDriven;
use super::axis_trajectory::StateDd;
use super::body_state::Slot;
use super::exact::VELOCITY_ROUNDING;
use super::impact::Impact;
use super::least_change::MASS_UNIT;
use crate::physics::{Axis, Collision, Observer, Rect, Side, Vector, World};

impl EventDriven {
    /// Carries out the impact of two bodies whose faces meet now, unless other bodies, contacts or limits are
    /// involved; returns whether it did. `side` is that of the first on which the second lies.
    pub(super) fn collide_isolated<O: Observer>(
        &mut self,
        world: &World,
        pair: [Slot; 2],
        axis: Axis,
        side: Side,
        observer: &mut O,
    ) -> bool {
        let restitution = {
            let [first, second] = pair.map(|slot| self.bodies.params(slot).material);
            world.restitution.between(first, second)
        };
        let order = if side == Side::High { [0, 1] } else { [1, 0] };
        let is_infinite = [0, 1].map(|body| {
            let pushed = if order[0] == body { Side::Low } else { Side::High };
            self.bodies[pair[body]].infinite || self.contacts.is_supported(pair[body], axis, pushed)
        });
        let has_contacts = |body: usize| !is_infinite[body] && !self.contacts.of(pair[body]).is_empty();
        if restitution == 0.0 || is_infinite == [true; 2] || has_contacts(0) || has_contacts(1) {
            return false;
        }
        let scaled = self.bodies.scaled_states_at(pair, axis, self.now);
        let [low, high] = order.map(|body| scaled[body]);
        let approach = (low.state.velocity - high.state.velocity).high;
        if approach <= (low.speed + high.speed) * VELOCITY_ROUNDING {
            return false;
        }
        let acceleration = (low.state.acceleration - high.state.acceleration).high;
        let coordinates = scaled.map(|body| body.state.position.high);
        let sizes = pair.map(|slot| self.bodies[slot].size[axis]);
        let resolution = self.bodies.resolution();
        if acceleration > 0.0 && resolution.hides_bounce(restitution * approach, acceleration, coordinates, sizes) {
            return false;
        }
        if (!is_infinite[0] && !self.touches_nothing_else(pair[0], pair[1]))
            || (!is_infinite[1] && !self.touches_nothing_else(pair[1], pair[0]))
        {
            return false;
        }
        let mass = order.map(|body| match is_infinite[body] {
            true => f64::INFINITY.into(),
            false => (self.bodies.params(pair[body]).mass * MASS_UNIT).into(),
        });
        let impact = Impact { velocity: [low.state.velocity, high.state.velocity], mass, restitution };
        let after =
            self.bodies.rounding().velocities(&impact, impact.velocities_with(|| self.latest_shares.of(&impact)));
        let before = self.rects_and_velocities(pair);
        let mut speed = 0.0;
        for body in [0, 1].into_iter().filter(|body| !is_infinite[*body]) {
            speed = if scaled[body].speed > speed { scaled[body].speed } else { speed };
        }
        for velocity in after {
            speed = if velocity.high.abs() > speed { velocity.high.abs() } else { speed };
        }
        // Boxes below the resolution of their coordinates have no certain sides.
        let is_extended = resolution.of_gap(sizes, low.length + high.length) < 0.25 * (sizes[0] + sizes[1]);
        let is_receding = (after[1] - after[0]).high > speed * VELOCITY_ROUNDING && acceleration <= 0.0 && is_extended;
        self.receding = is_receding.then_some(pair);
        let anchor = if is_infinite[1] { 1 } else { 0 };
        let anchor_position = scaled[anchor].state.position;
        for body in [0, 1].into_iter().filter(|body| !is_infinite[*body]) {
            let place = usize::from(order[1] == body);
            let position = match (body == anchor, place) {
                (true, _) => anchor_position,
                (false, 1) => anchor_position + self.bodies.size(pair[anchor], axis),
                (false, _) => anchor_position - self.bodies.size(pair[body], axis),
            };
            let velocity = after[place].or_zero(speed * VELOCITY_ROUNDING);
            self.set_trajectory(pair[body], axis, StateDd { position, velocity, ..scaled[body].state }, self.now);
        }
        let sign = if side == Side::High { -1.0 } else { 1.0 };
        observer.collision(&Collision {
            step: self.step,
            time: self.step_start.seconds_until(self.now).clamp(0.0, self.clock.period),
            instant: self.now.high,
            axis,
            bodies: pair.map(|slot| self.bodies.params(slot).id),
            rects: before.map(|(rect, _)| rect),
            normal: Vector::along(axis, sign),
            penetration: Vector::ZERO,
            shares: [0.0; 2],
            impulse: impact.impulse() / MASS_UNIT,
            restitution,
            normal_velocity: [-approach, (after[1] - after[0]).high],
            before: before.map(|(_, velocity)| velocity),
            after: self.rects_and_velocities(pair).map(|(_, velocity)| velocity),
        });
        true
    }

    /// True if a body certainly touches none but `partner`.
    fn touches_nothing_else(&mut self, slot: Slot, partner: Slot) -> bool {
        let mut neighbours = std::mem::take(&mut self.neighbour_buffer);
        self.find_touching(slot, self.now, &mut neighbours);
        let is_free = neighbours
            .slots()
            .iter()
            .all(|other| *other == partner || !self.bodies.may_touch([slot, *other], self.now));
        self.neighbour_buffer = neighbours;
        is_free
    }

    /// Rectangles and velocities (m/s) of two bodies at the present instant; inlined, so that nothing is computed for an
    /// observer that ignores it.
    #[inline(always)]
    fn rects_and_velocities(&self, pair: [Slot; 2]) -> [(Rect, Vector); 2] {
        let of = |slot: Slot| {
            let [[x, y], [vx, vy]] = self.bodies[slot].trajectory.at(self.now);
            let [width, height] = self.bodies[slot].size;
            (Rect::new(Vector::new(x, y), width, height), Vector::new(vx, vy))
        };
        // `map` would not be inlined.
        [of(pair[0]), of(pair[1])]
    }
}
