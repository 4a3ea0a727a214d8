//! A collision: who is hit, what the blow does to them, and where they are put.

use super::EventDriven;
use super::block::Side;
use super::double_double::{Double, DoubleDouble};
use super::fine_state::{FineState, both_after};
use super::impact::{Blow, LONGEST_HURRY, capture_speed, is_no_way};
use super::instant::LONGEST_ROUNDING;
use super::meeting::tolerance;
use super::mover::{AXES, Slot};
use super::side_by_side::SideBySide;
use crate::physics::{Collision, Observer, Rect, StepError, Vector, World};

/// The two that collide along an axis, the one behind first, at the instant of the blow.
struct Encounter {
    axis: usize,
    slots: [Slot; 2],
    states: [FineState; 2],
    /// Seconds since the references of their motions.
    ages: [f64; 2],
    /// m/s.
    approach: f64,
}

/// What a blow is like.
#[derive(Clone, Copy, Debug)]
struct Character {
    /// The e of the blow.
    restitution: f64,
    /// Who touches the two and moves no faster against them, m/s, goes on with them; none if
    /// this blow ends nothing.
    ending: Option<f64>,
}

/// A blow foretold too early waits no longer than this, s: others may come before.
const LONGEST_WAIT: f64 = 1e-10;

impl Encounter {
    /// One of its sides: 0 for the body behind.
    fn side(&self, place: usize) -> Side {
        let velocity = self.states[place].velocity;
        Side { slot: self.slots[place], axis: self.axis, ahead: place == 1, velocity }
    }
}

impl EventDriven {
    /// Two bodies whose faces meet along an axis.
    ///
    /// Bodies in contact meet a blow as one (Moreau's law of impact, the relative velocity at
    /// resting contacts being 0): what rests against an infinite mass takes it like that
    /// mass, what is free takes it together with all that it pushes. Bodies that merely
    /// touch are not in contact; they hand the blow on from pair to pair, as in a cradle.
    pub(super) fn collide<O: Observer>(
        &mut self,
        world: &World,
        pair: [Slot; 2],
        axis: usize,
        observer: &mut O,
    ) -> Result<(), StepError> {
        let encounter = self.exact_encounter(pair, axis);
        let restitution = self.blow(world, pair, &encounter, observer)?;
        if restitution == 0.0 {
            self.join(encounter.slots, axis);
        }
        self.settle();
        Ok(())
    }

    /// Two bodies whose corners meet: a blow along each axis on which they approach.
    ///
    /// If that leaves them at rest against each other they press on corner to corner, in
    /// contact along both axes: neither way round is the nearer one.
    pub(super) fn collide_corners<O: Observer>(
        &mut self,
        world: &World,
        pair: [Slot; 2],
        observer: &mut O,
    ) -> Result<(), StepError> {
        for axis in AXES {
            let encounter = self.encounter(pair, axis);
            if encounter.approach > 0.0 {
                self.blow(world, pair, &encounter, observer)?;
            }
        }
        let encounters = AXES.map(|axis| self.encounter(pair, axis));
        if encounters.iter().all(|encounter| encounter.approach == 0.0) {
            encounters.iter().for_each(|encounter| self.join(encounter.slots, encounter.axis));
        } else {
            encounters.iter().for_each(|encounter| self.renew(encounter));
        }
        self.settle();
        Ok(())
    }

    /// Carries a blow out and says with which e.
    fn blow<O: Observer>(
        &mut self,
        world: &World,
        pair: [Slot; 2],
        encounter: &Encounter,
        observer: &mut O,
    ) -> Result<f64, StepError> {
        let Character { restitution, ending } = self.character(world, encounter);
        let sides = AXES.map(|place| encounter.side(place));
        let mut blocks = std::mem::take(&mut self.blocks);
        if let Some(slow) = ending {
            let [behind, ahead] = &mut blocks;
            self.carried(world, sides[0], slow, |slot| slot == sides[1].slot, behind);
            self.carried(world, sides[1], slow, |slot| slot == sides[0].slot || behind.has(slot), ahead);
        }
        let both_stand = blocks.iter().all(|block| block.mass == f64::INFINITY);
        // A row packed between two that stand: endlessly many blows to and fro leave it at rest.
        let is_packed = ending == Some(f64::INFINITY) && both_stand && blocks[0].velocity == blocks[1].velocity;
        if ending.is_none() || (both_stand && !is_packed) {
            AXES.into_iter().for_each(|place| self.pushed(sides[place], &mut blocks[place]));
        }
        let mass = [blocks[0].mass, blocks[1].mass];
        if encounter.approach > 0.0 && mass == [f64::INFINITY; 2] && !is_packed {
            self.blocks = blocks;
            return Err(self.crushed(world, encounter.slots, encounter.axis));
        }
        let blow = Blow { velocity: [blocks[0].velocity, blocks[1].velocity], mass, restitution };
        let after = blow.velocities_after();
        let impulse = if is_packed { self.momentum_lost(&blocks[0], encounter.axis) } else { blow.impulse() };
        let before = self.state(pair);
        let position = self.put_together(encounter, mass[1] == f64::INFINITY);
        AXES.into_iter().for_each(|place| self.push(&blocks[place], sides[place], position[place], after[place]));
        self.blocks = blocks;
        if encounter.approach > 0.0 {
            let upwards = if encounter.slots == pair { -1.0 } else { 1.0 };
            let normal = if encounter.axis == 0 { Vector::new(upwards, 0.0) } else { Vector::new(0.0, upwards) };
            observer.collision(&self.report(pair, normal, impulse, before));
        }
        Ok(restitution)
    }

    /// The two at the present instant.
    fn encounter(&self, pair: [Slot; 2], axis: usize) -> Encounter {
        let ([first, second], ages) = self.both_fine(pair, axis);
        let middle = |slot: Slot, state: &FineState| state.position.high + self.movers[slot as usize].size[axis] / 2.0;
        let (slots, states, ages) = if middle(pair[0], &first) <= middle(pair[1], &second) {
            (pair, [first, second], ages)
        } else {
            ([pair[1], pair[0]], [second, first], [ages[1], ages[0]])
        };
        Encounter { axis, slots, states, ages, approach: (states[0].velocity - states[1].velocity).high }
    }

    /// The two at the instant of the blow, which is found to 32 digits on the way.
    fn exact_encounter(&mut self, pair: [Slot; 2], axis: usize) -> Encounter {
        let foretold = self.encounter(pair, axis);
        let delay = self.delay(&foretold);
        if delay == 0.0 {
            return foretold;
        }
        self.nudge(delay);
        let states = both_after(foretold.states, SideBySide::all(delay).into());
        Encounter { states, approach: (states[0].velocity - states[1].velocity).high, ..foretold }
    }

    /// How much later than foretold the faces meet, s: what rounding hid from prediction.
    ///
    /// From the gap g at the foretold instant, to 32 digits, t = 2·g/(c + √(c² + 2·b·g)); g is
    /// so small that sixteen digits of t are enough. No motion is followed back beyond its
    /// reference instant.
    fn delay(&self, encounter: &Encounter) -> f64 {
        let Encounter { axis, slots, states: [first, second], ages, approach: speed } = *encounter;
        let size = self.movers[slots[0] as usize].size[axis];
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
        if (-LONGEST_ROUNDING..=LONGEST_WAIT).contains(&delay) { delay } else { 0.0 }
    }

    /// Takes the present instant as the reference of two that only graze: the past is over.
    fn renew(&mut self, encounter: &Encounter) {
        for side in AXES {
            let slot = encounter.slots[side];
            if !self.movers[slot as usize].infinite {
                self.redirect(slot, encounter.axis, encounter.states[side]);
            }
        }
    }

    /// The e of this blow: the materials', or 0 where it ends a Zeno sequence.
    fn character(&mut self, world: &World, encounter: &Encounter) -> Character {
        let [first, second] = encounter.slots.map(|slot| &self.traits[slot as usize]);
        let restitution = world.restitution.between(first.material, second.material);
        if encounter.approach <= 0.0 {
            return Character { restitution: 0.0, ending: None };
        }
        if restitution == 1.0 {
            return Character { restitution, ending: None };
        }
        let accelerations = [first, second].map(|traits| traits.free_fall[encounter.axis].high.abs());
        let acceleration = if accelerations[0] > accelerations[1] { accelerations[0] } else { accelerations[1] };
        let velocities = encounter.states.map(|state| state.velocity.high.abs());
        let coordinates = self.coordinates(encounter);
        let slow = capture_speed(acceleration, coordinates, velocities[0] + velocities[1]);
        let hurries = encounter.slots.map(|slot| self.hurries(slot, encounter.axis, coordinates));
        if hurries == [true; 2] {
            return Character { restitution: 0.0, ending: Some(f64::INFINITY) };
        }
        if encounter.approach < slow {
            return Character { restitution: 0.0, ending: Some(slow) };
        }
        Character { restitution, ending: None }
    }

    /// Counts the impacts of a body that follow each other without any way between them, and
    /// says whether that is to end. An infinite mass goes no way either.
    fn hurries(&mut self, slot: Slot, axis: usize, coordinates: f64) -> bool {
        let mover = &mut self.movers[slot as usize];
        if mover.infinite {
            return true;
        }
        let motion = mover.motion.along(axis);
        let t = self.clock.seconds(motion.since, self.now);
        let way = t * (motion.velocity.abs() + 0.5 * motion.acceleration.abs() * t);
        let hurry = &mut mover.hurry[axis];
        *hurry = if is_no_way(way, coordinates) { hurry.saturating_add(1) } else { 0 };
        *hurry > LONGEST_HURRY
    }

    /// How large the coordinates are whose rounding decides whether the two touch, m.
    fn coordinates(&self, encounter: &Encounter) -> f64 {
        let [first, second] = encounter.slots.map(|slot| self.movers[slot as usize].size[encounter.axis]);
        let [behind, ahead] = encounter.states.map(|state| state.position.high.abs());
        behind + ahead + (first + second)
    }

    /// Where the two are put so that their faces coincide: on the one behind, or before the
    /// one ahead if that `stands`.
    ///
    /// Bodies that begin to rest where they were set down stay there to the bit.
    fn put_together(&self, encounter: &Encounter, stands: bool) -> [DoubleDouble; 2] {
        let [first, second] = encounter.states.map(|state| state.position);
        let size = self.movers[encounter.slots[0] as usize].size[encounter.axis].into();
        let gap = (second - first - size).high;
        if encounter.approach <= 0.0 && gap.abs() <= tolerance(self.coordinates(encounter)) {
            [first, second]
        } else if stands {
            [second - size, second]
        } else {
            [first, first + size]
        }
    }

    #[inline]
    fn state(&self, pair: [Slot; 2]) -> [(Rect, Vector); 2] {
        let state = |slot: Slot| {
            let mover = &self.movers[slot as usize];
            let [[x, y], [vx, vy]] = mover.motion.at(&self.clock, self.now);
            (Rect::new(Vector::new(x, y), mover.size[0], mover.size[1]), Vector::new(vx, vy))
        };
        [state(pair[0]), state(pair[1])]
    }

    /// What an observer is told; inlined, so that nothing is computed for one who does not listen.
    #[inline(always)]
    fn report(&self, pair: [Slot; 2], normal: Vector, impulse: f64, before: [(Rect, Vector); 2]) -> Collision {
        Collision {
            step: self.now.step as u64,
            time: self.now.offset.clamp(0.0, self.clock.period),
            bodies: pair.map(|slot| self.traits[slot as usize].id),
            rects: before.map(|(rect, _)| rect),
            normal,
            penetration: Vector::ZERO,
            shares: [0.0; 2],
            impulse,
            before: before.map(|(_, velocity)| velocity),
            after: self.state(pair).map(|(_, velocity)| velocity),
        }
    }
}

/// The greatest position at which a box of that size does not reach beyond `face`.
pub fn just_before(face: f64, size: f64) -> f64 {
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
    fn a_box_put_before_a_face_does_not_reach_beyond_it() {
        for (face, size) in [(10.0, 0.1), (0.3, 0.1), (1e6, 1e-3), (-0.7, 0.3), (5.0, 1e9)] {
            let position = just_before(face, size);
            assert!(position + size <= face);
            assert!(position.next_up() + size >= face);
        }
    }
}
