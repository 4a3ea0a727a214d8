//! What takes a blow together, and how it goes on.

use super::EventDriven;
use super::double_double::DoubleDouble;
use super::fine_state::FineState;
use super::impact::is_no_way;
use super::meeting::State;
use super::mover::Slot;
use super::reach::Reach;
use crate::physics::World;

/// Bodies that take a blow as one.
#[derive(Clone, Debug, Default)]
pub struct Block {
    /// The body hit first, then the others; empty if the blow moves nothing.
    members: Vec<Member>,
    /// kg; infinite if it cannot give way.
    pub mass: f64,
    /// How fast it is before the blow, m/s.
    pub velocity: DoubleDouble,
}

/// One body of a block.
#[derive(Clone, Copy, Debug)]
struct Member {
    slot: Slot,
    /// On whose face it lies, and whether ahead of it; none for the body hit, and for those
    /// that stay where they are.
    on: Option<(Slot, bool)>,
}

/// A side of an encounter: whom the blow hits, along which axis, and whether it pushes towards
/// greater coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Side {
    /// The body hit.
    pub slot: Slot,
    /// The axis of the blow.
    pub axis: usize,
    /// Whether it is the side ahead.
    pub ahead: bool,
    /// Its velocity before, m/s.
    pub velocity: DoubleDouble,
}

impl EventDriven {
    /// What a blow meets on this side: the body and all that it pushes; of infinite mass if
    /// that rests, directly or through others, against an infinite mass.
    pub(super) fn pushed(&self, side: Side, block: &mut Block) {
        block.members.clear();
        block.velocity = side.velocity;
        block.mass = f64::INFINITY;
        if self.movers[side.slot as usize].is_immovable(side.axis, side.ahead) {
            return;
        }
        block.members.push(Member { slot: side.slot, on: None });
        let mut next = 0;
        while let Some(Member { slot: by, .. }) = block.members.get(next).copied() {
            next += 1;
            for contact in self.contacts.of(by) {
                let slot = contact.other;
                let along = contact.axis == side.axis && contact.ahead == side.ahead;
                if along && !self.movers[slot as usize].infinite && !block.has(slot) {
                    block.members.push(Member { slot, on: Some((by, side.ahead)) });
                }
            }
        }
        block.mass = self.mass_of(block);
    }

    /// All that is joined to a body by contacts along the axis, in either direction, and all
    /// that touches it without approaching or leaving faster than `slow`, m/s: these end a
    /// sequence of endlessly many blows together. Of infinite mass if one among them stands.
    ///
    /// Who is `taken` belongs to the other side.
    pub(super) fn carried(
        &mut self,
        world: &World,
        side: Side,
        slow: f64,
        taken: impl Fn(Slot) -> bool,
        block: &mut Block,
    ) {
        block.members.clear();
        block.members.push(Member { slot: side.slot, on: None });
        let mut standing = None;
        let mut next = 0;
        while let Some(Member { slot: by, .. }) = block.members.get(next).copied() {
            next += 1;
            if self.stands(by, side.axis) {
                standing = standing.or(Some(self.fine_velocity(by, side.axis)));
                continue;
            }
            let in_contact = self.contacts.of(by).iter().filter(|contact| contact.axis == side.axis);
            let in_contact = in_contact.map(|contact| (contact.other, contact.ahead));
            for (slot, ahead) in in_contact.chain(self.clinging(world, by, side.axis, slow)) {
                if !block.has(slot) && !taken(slot) {
                    block.members.push(Member { slot, on: Some((by, ahead)) });
                }
            }
        }
        match standing {
            Some(velocity) => self.stay(block, side, velocity),
            None => self.hold_together(block, side),
        }
    }

    /// A block among which somebody stands goes on as fast as that, everyone in their place.
    fn stay(&self, block: &mut Block, side: Side, velocity: DoubleDouble) {
        block.members.retain(|member| !self.stands(member.slot, side.axis));
        block.members.iter_mut().for_each(|member| member.on = None);
        block.mass = f64::INFINITY;
        block.velocity = velocity;
    }

    /// A free block keeps its momentum, and those who only touched are in contact afterwards.
    fn hold_together(&mut self, block: &mut Block, side: Side) {
        block.mass = self.mass_of(block);
        block.velocity = self.common_velocity(block, side);
        for member in &block.members {
            if let Some((other, ahead)) = member.on
                && self.contacts.between(member.slot, other).is_none()
            {
                self.join(if ahead { [other, member.slot] } else { [member.slot, other] }, side.axis);
            }
        }
    }

    /// Whether a body is of infinite mass or rests, directly or through others, against one.
    fn stands(&self, slot: Slot, axis: usize) -> bool {
        let mover = &self.movers[slot as usize];
        mover.infinite || mover.held[axis] != [false; 2]
    }

    /// The total mass, summed in creation order, kg.
    fn mass_of(&self, block: &Block) -> f64 {
        let mass = |member: &Member| self.traits[member.slot as usize].mass;
        match block.members.as_slice() {
            [single] => mass(single),
            several => {
                let mut in_creation_order: Vec<&Member> = several.iter().collect();
                in_creation_order.sort_unstable_by_key(|member| member.slot);
                in_creation_order.into_iter().map(mass).sum()
            }
        }
    }

    /// Total momentum by total mass, m/s: the velocity hit plus what the others differ from it.
    fn common_velocity(&self, block: &Block, side: Side) -> DoubleDouble {
        let mut excess = DoubleDouble::ZERO;
        for member in &block.members {
            let difference = self.fine_velocity(member.slot, side.axis) - side.velocity;
            excess = excess + difference * DoubleDouble::from(self.traits[member.slot as usize].mass);
        }
        side.velocity + excess / block.mass.into()
    }

    /// What is lost of the momentum of the members when they go on as fast as the block, N·s.
    pub(super) fn momentum_lost(&self, block: &Block, axis: usize) -> f64 {
        let lost = |member: &Member| {
            let excess = self.fine_velocity(member.slot, axis) - block.velocity;
            excess.high * self.traits[member.slot as usize].mass
        };
        block.members.iter().map(lost).sum()
    }

    /// Who touches a body along an axis, no faster than `slow` against it and not in contact,
    /// and whether ahead of it.
    fn clinging(&self, world: &World, slot: Slot, axis: usize, slow: f64) -> Vec<(Slot, bool)> {
        let mover = &self.movers[slot as usize];
        let reach = Reach::new(&State::new(&self.clock, mover, self.now), 0.0);
        let mut near = self.neighbours.all_near(slot, mover, &reach);
        near.retain(|other| {
            let [own, others] = [slot, *other].map(|slot| self.traits[slot as usize].material);
            let known = *other == slot || self.contacts.between(slot, *other).is_some();
            !known && world.restitution.between(own, others) < 1.0
        });
        near.into_iter().filter_map(|other| Some((other, self.clings(slot, other, axis, slow)?))).collect()
    }

    /// Whether another body touches one without way or speed between them, and if so, whether
    /// it is ahead.
    fn clings(&self, slot: Slot, other: Slot, axis: usize, slow: f64) -> Option<bool> {
        let [own, others] = [slot, other].map(|slot| self.fine(slot, axis));
        let [own_size, others_size] = [slot, other].map(|slot| self.movers[slot as usize].size[axis]);
        let coordinates = own.position.high.abs() + others.position.high.abs() + (own_size + others_size);
        let step = (others.position - own.position).high;
        let [ahead, behind] = [step - own_size, -step - others_size];
        let gap = if ahead > behind { ahead } else { behind };
        let together = is_no_way(gap.abs(), coordinates) && (others.velocity - own.velocity).high.abs() <= slow;
        (together && self.overlap_on(1 - axis, slot, other)).then_some(ahead > behind)
    }

    /// Whether two boxes overlap on an axis by more than rounding.
    pub(super) fn overlap_on(&self, axis: usize, slot: Slot, other: Slot) -> bool {
        let [own, others] = [slot, other].map(|slot| self.fine(slot, axis).position);
        let [own_size, others_size] = [slot, other].map(|slot| self.movers[slot as usize].size[axis]);
        let step = (others - own).high;
        let coordinates = own.high.abs() + others.high.abs() + (own_size + others_size);
        let overlap = if step > 0.0 { own_size - step } else { others_size + step };
        !is_no_way(overlap, coordinates)
    }

    /// Gives a block its new velocity and parts it from what does not go with it.
    ///
    /// The body hit starts at `start`, and the others are put on each other's faces.
    pub(super) fn push(&mut self, block: &Block, side: Side, start: DoubleDouble, velocity: DoubleDouble) {
        for (place, member) in block.members.iter().enumerate() {
            let acceleration = self.acceleration(member.slot, side.axis);
            let size = |slot: Slot| self.movers[slot as usize].size[side.axis].into();
            let position = match member.on {
                None if place == 0 => start,
                None => self.fine(member.slot, side.axis).position,
                Some((other, true)) => self.fine(other, side.axis).position + size(other),
                Some((other, false)) => self.fine(other, side.axis).position - size(member.slot),
            };
            self.redirect(member.slot, side.axis, FineState { position, velocity, acceleration });
        }
        for member in &block.members {
            let mut next = 0;
            while let Some(contact) = self.contacts.of(member.slot).get(next).copied() {
                if contact.axis != side.axis || self.fine_velocity(contact.other, side.axis).high == velocity.high {
                    next += 1;
                } else {
                    self.unjoin(member.slot, contact.other);
                }
            }
        }
    }
}

impl Block {
    /// Whether a body is one of its members.
    pub fn has(&self, slot: Slot) -> bool {
        self.members.iter().any(|member| member.slot == slot)
    }
}
