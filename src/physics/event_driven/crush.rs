//! When something gives way that cannot: the errors in which a step may end.

use super::EventDriven;
use super::mover::{AXES, Slot};
use super::reach::Reach;
use crate::physics::{StepError, World};

impl EventDriven {
    /// The error of a body pressed between what cannot give way.
    pub(super) fn crushed(&self, world: &World, [first, second]: [Slot; 2], axis: usize) -> StepError {
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

    /// The error of a step in which more happened than is allowed: endlessly much happens to a
    /// body before it is crushed, if it bounces without loss.
    pub(super) fn too_many(&self, world: &World, step: u64, pair: [Slot; 2]) -> StepError {
        let finite = pair.into_iter().find(|slot| !self.movers[*slot as usize].infinite);
        if let Some(slot) = finite
            && let Some(between) = AXES.into_iter().find_map(|axis| self.squeezing(slot, axis))
        {
            let between = between.map(|slot| self.name(world, slot));
            return StepError::Crushed { step, body: self.name(world, slot), between };
        }
        let bodies = pair.map(|slot| self.name(world, slot)).to_vec();
        StepError::TooManyEvents { step, limit: self.limit, bodies }
    }

    /// The two infinite masses that leave a body no room along an axis before the step is over.
    fn squeezing(&self, slot: Slot, axis: usize) -> Option<[Slot; 2]> {
        let [behind, ahead] = [false, true].map(|ahead| self.wall_beside(slot, axis, ahead));
        let (behind, ahead) = (behind?, ahead?);
        let [first, second] = [behind, ahead].map(|slot| self.fine(slot, axis));
        let size = self.movers[behind as usize].size[axis] + self.movers[slot as usize].size[axis];
        let room = (second.position - first.position).high - size;
        let speed = (first.velocity - second.velocity).high;
        (speed > 0.0 && room <= speed * self.clock.period).then_some([behind, ahead])
    }

    /// The nearest infinite mass beside a body.
    fn wall_beside(&self, slot: Slot, axis: usize, ahead: bool) -> Option<Slot> {
        let own = self.fine(slot, axis).position.high;
        let mut near = self.neighbours.all_near(slot, &self.movers[slot as usize], &Reach::ANYWHERE);
        near.retain(|other| {
            let there = self.fine(*other, axis).position.high;
            let beside = self.movers[*other as usize].infinite && self.overlap_on(1 - axis, slot, *other);
            beside && if ahead { there > own } else { there < own }
        });
        let face = |other: &Slot| {
            let mover = &self.movers[*other as usize];
            let near = self.fine(*other, axis).position.high;
            if ahead { near } else { -(near + mover.size[axis]) }
        };
        near.into_iter().min_by(|a, b| face(a).total_cmp(&face(b)))
    }
}
