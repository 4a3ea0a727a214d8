//! A collision: who is hit, what the blow does to them, and where they are put.

use super::EventDriven;
use super::contact::Pushed;
use super::impact::{Blow, LONGEST_HURRY, capture_speed, is_no_way};
use super::meeting::tolerance;
use super::mover::{AXES, Slot};
use crate::physics::{Collision, Observer, Rect, StepError, Vector, World};

/// The two that collide along an axis, the one behind first, at the instant of the blow.
struct Encounter {
    slots: [Slot; 2],
    /// Whether a push away from the other cannot move it: it rests, directly or through
    /// others, against an infinite mass.
    immovable: [bool; 2],
    position: [f64; 2],
    velocity: [f64; 2],
    approach: f64,
}

impl EventDriven {
    /// Two bodies whose faces (or, if not `face`, corners) meet along an axis.
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
        face: bool,
        observer: &mut O,
    ) -> Result<(), StepError> {
        let encounter = self.encounter(pair, axis);
        if encounter.approach <= 0.0 && !face {
            self.renew(&encounter, axis);
            return Ok(());
        }
        if encounter.approach > 0.0 && encounter.immovable == [true; 2] {
            return Err(self.crushed(world, encounter.slots, axis));
        }
        let mut blocks = std::mem::take(&mut self.blocks);
        let mass = AXES.map(|side| self.block(&encounter, axis, side, &mut blocks[side]));
        let restitution = self.restitution(world, &encounter, axis);
        let blow = Blow { velocity: encounter.velocity, mass, restitution };
        let after = blow.velocities_after();
        let before = self.state(pair);
        let mut touched = Vec::new();
        let position = self.put_together(&encounter, axis);
        for side in AXES {
            self.push(&blocks[side], axis, side == 1, [position[side], after[side]], &mut touched);
        }
        self.blocks = blocks;
        if face && restitution == 0.0 {
            self.contacts.join(&self.movers, encounter.slots, axis);
            touched.extend(encounter.slots);
        }
        self.settle(axis, touched);
        if encounter.approach > 0.0 {
            let upwards = if encounter.slots == pair { -1.0 } else { 1.0 };
            let normal = if axis == 0 { Vector::new(upwards, 0.0) } else { Vector::new(0.0, upwards) };
            observer.collision(&self.report(pair, normal, blow.impulse(), before));
        }
        Ok(())
    }

    fn encounter(&self, pair: [Slot; 2], axis: usize) -> Encounter {
        let middle = |slot: Slot| {
            let mover = &self.movers[slot as usize];
            mover.motion[axis].at(&self.clock, self.now).0 + mover.size[axis] / 2.0
        };
        let slots = if middle(pair[0]) <= middle(pair[1]) { pair } else { [pair[1], pair[0]] };
        let states = slots.map(|slot| self.movers[slot as usize].motion[axis].at(&self.clock, self.now));
        let velocity = states.map(|(_, velocity)| velocity);
        Encounter {
            slots,
            immovable: AXES.map(|side| self.movers[slots[side] as usize].is_immovable(axis, side == 1)),
            position: states.map(|(position, _)| position),
            velocity,
            approach: velocity[0] - velocity[1],
        }
    }

    /// Takes the present instant as the reference of two that only graze: the past is over.
    fn renew(&mut self, encounter: &Encounter, axis: usize) {
        for side in AXES {
            let slot = encounter.slots[side];
            if !self.movers[slot as usize].infinite {
                let acceleration = self.movers[slot as usize].motion[axis].acceleration;
                self.redirect(slot, axis, [encounter.position[side], encounter.velocity[side], acceleration]);
            }
        }
    }

    /// Collects what takes the blow together with one of the two, and says its mass, kg.
    fn block(&self, encounter: &Encounter, axis: usize, side: usize, block: &mut Vec<Pushed>) -> f64 {
        block.clear();
        if encounter.immovable[side] {
            return f64::INFINITY;
        }
        self.contacts.pushed(&self.movers, encounter.slots[side], axis, side == 1, block);
        let mass = |pushed: &Pushed| self.traits[pushed.slot as usize].mass;
        match block.as_slice() {
            [single] => mass(single),
            several => {
                let mut in_creation_order: Vec<&Pushed> = several.iter().collect();
                in_creation_order.sort_unstable_by_key(|pushed| pushed.slot);
                in_creation_order.into_iter().map(mass).sum()
            }
        }
    }

    /// The e of this impact: the materials', or 0 where a Zeno sequence is to end.
    fn restitution(&mut self, world: &World, encounter: &Encounter, axis: usize) -> f64 {
        let [first, second] = encounter.slots.map(|slot| &self.traits[slot as usize]);
        let e = world.restitution.between(first.material, second.material);
        if encounter.approach <= 0.0 {
            return 0.0;
        }
        if e == 1.0 {
            return 1.0;
        }
        let accelerations = first.free_fall.iter().chain(&second.free_fall);
        let acceleration = accelerations.fold(0.0, |most, a| if a.abs() > most { a.abs() } else { most });
        let velocities = encounter.velocity[0].abs() + encounter.velocity[1].abs();
        let coordinates = self.coordinates(encounter, axis);
        let hurries = encounter.slots.map(|slot| self.hurry(slot, axis, coordinates) > LONGEST_HURRY);
        let slow = encounter.approach < capture_speed(acceleration, coordinates, velocities);
        if slow || hurries != [false; 2] { 0.0 } else { e }
    }

    /// Counts the impacts of a body that follow each other without any way between them.
    fn hurry(&mut self, slot: Slot, axis: usize, coordinates: f64) -> u8 {
        let mover = &mut self.movers[slot as usize];
        if mover.infinite {
            return 0;
        }
        let motion = &mover.motion[axis];
        let t = self.clock.seconds(motion.since, self.now);
        let way = t * (motion.velocity.abs() + 0.5 * motion.acceleration.abs() * t);
        let hurry = &mut mover.hurry[axis];
        *hurry = if is_no_way(way, coordinates) { hurry.saturating_add(1) } else { 0 };
        *hurry
    }

    /// How large the coordinates are whose rounding decides whether the two touch, m.
    fn coordinates(&self, encounter: &Encounter, axis: usize) -> f64 {
        let [first, second] = encounter.slots.map(|slot| self.movers[slot as usize].size[axis]);
        encounter.position[0].abs() + encounter.position[1].abs() + (first + second)
    }

    /// Where the two are put so that their faces coincide as nearly as can be written down.
    ///
    /// Bodies that begin to rest where they were set down stay there to the bit.
    fn put_together(&self, encounter: &Encounter, axis: usize) -> [f64; 2] {
        let [first, second] = encounter.position;
        let size = self.movers[encounter.slots[0] as usize].size[axis];
        let gap = second - (first + size);
        if encounter.approach <= 0.0 && gap.abs() <= tolerance(self.coordinates(encounter, axis)) {
            [first, second]
        } else if encounter.immovable[1] {
            [just_before(second, size), second]
        } else {
            [first, first + size]
        }
    }

    /// Gives a block its new velocity and parts it from what does not go with it.
    fn push(&mut self, block: &[Pushed], axis: usize, ahead: bool, state: [f64; 2], touched: &mut Vec<Slot>) {
        let [start, velocity] = state;
        for pushed in block {
            let mover = &self.movers[pushed.slot as usize];
            let by = &self.movers[pushed.by as usize];
            let position = if pushed.slot == pushed.by {
                start
            } else if ahead {
                by.motion[axis].position + by.size[axis]
            } else {
                just_before(by.motion[axis].position, mover.size[axis])
            };
            self.redirect(pushed.slot, axis, [position, velocity, mover.motion[axis].acceleration]);
        }
        for pushed in block {
            let mut next = 0;
            while let Some(contact) = self.contacts.of(pushed.slot).get(next).copied() {
                let (_, others) = self.movers[contact.other as usize].motion[axis].at(&self.clock, self.now);
                if contact.axis != axis || others == velocity {
                    next += 1;
                    continue;
                }
                self.contacts.part(pushed.slot, contact.other);
                self.mark(contact.other);
                touched.extend([pushed.slot, contact.other]);
            }
        }
    }

    fn state(&self, pair: [Slot; 2]) -> [(Rect, Vector); 2] {
        pair.map(|slot| {
            let mover = &self.movers[slot as usize];
            let [(x, vx), (y, vy)] = AXES.map(|axis| mover.motion[axis].at(&self.clock, self.now));
            (Rect::new(Vector::new(x, y), mover.size[0], mover.size[1]), Vector::new(vx, vy))
        })
    }

    fn report(&self, pair: [Slot; 2], normal: Vector, impulse: f64, before: [(Rect, Vector); 2]) -> Collision {
        Collision {
            step: self.now.step as u64,
            time: self.now.offset,
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

    /// The error of a body pressed between what cannot give way.
    fn crushed(&self, world: &World, [first, second]: [Slot; 2], axis: usize) -> StepError {
        let body = if self.movers[first as usize].infinite { second } else { first };
        let between =
            [self.name(world, self.backing(first, axis, false)), self.name(world, self.backing(second, axis, true))];
        StepError::Crushed { step: self.now.step as u64, body: self.name(world, body), between }
    }

    /// The infinite mass that holds an immovable body.
    fn backing(&self, mut slot: Slot, axis: usize, ahead: bool) -> Slot {
        while !self.movers[slot as usize].infinite {
            let behind = self.contacts.of(slot).iter().find(|contact| {
                contact.axis == axis
                    && contact.ahead == ahead
                    && self.movers[contact.other as usize].is_immovable(axis, ahead)
            });
            let Some(contact) = behind else { break };
            slot = contact.other;
        }
        slot
    }

    /// The error of a step in which more happened than is allowed.
    pub(super) fn too_many(&self, world: &World, step: u64, pair: [Slot; 2]) -> StepError {
        let bodies = pair.map(|slot| self.name(world, slot)).to_vec();
        StepError::TooManyEvents { step, limit: self.limit, bodies }
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
