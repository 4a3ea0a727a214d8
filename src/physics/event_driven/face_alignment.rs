//! Makes the faces of a spawned body coincide with those that they meet within the rounding of coordinates.
//!
//! Positions and sizes are given in decimals, so the faces of boxes that are meant to touch can be a few units in
//! the last place apart. From the start of a body on, they are the same double-double number.

use super::EventDriven;
use super::body_state::Slot;
use super::double_double::DoubleDouble;
use super::state_dd::StateDd;
use crate::physics::Axis;

/// Faces that differ by at most this many units in the last place of the largest number involved coincide.
const COINCIDING_ULPS: f64 = 2.0;

/// The faces of a body along an axis, the low one first, and the magnitude of the numbers they are computed from.
#[derive(Clone, Copy)]
struct Faces {
    at: [DoubleDouble; 2],
    scale: f64,
}

impl EventDriven {
    /// Aligns the faces of spawned bodies, in creation order, with those of older bodies.
    pub(super) fn align_spawned(&mut self, spawned: &[Slot]) {
        for slot in spawned {
            let older = self.older_neighbours(*slot);
            Axis::BOTH.into_iter().for_each(|axis| self.align(*slot, &older, axis));
        }
    }

    /// The older bodies that touch a body within rounding, in creation order.
    fn older_neighbours(&self, slot: Slot) -> Vec<Slot> {
        let own = Axis::BOTH.map(|axis| self.faces(slot, axis));
        let [low, high] = [0, 1].map(|side| own.map(|faces| faces.at[side].high));
        let reach = own.map(|faces| faces.scale * (4.0 * f64::EPSILON));
        let mut found = Vec::new();
        let [from, to] = [[low[0] - reach[0], low[1] - reach[1]], [high[0] + reach[0], high[1] + reach[1]]];
        self.cell_lists.visit_region(from, to, |other| {
            let is_near = other < slot
                && Axis::BOTH.into_iter().all(|axis| {
                    let position = self.states[other as usize].trajectory.at(self.now)[0][axis as usize];
                    let size = self.states[other as usize].size[axis as usize];
                    let margin = reach[axis as usize] + (position.abs() + size) * (4.0 * f64::EPSILON);
                    position - margin <= to[axis as usize] && position + size + margin >= from[axis as usize]
                });
            if is_near {
                found.push(other);
            }
        });
        found.sort_unstable();
        found.dedup();
        found
    }

    fn faces(&self, slot: Slot, axis: Axis) -> Faces {
        let position = self.state_dd(slot, axis).position;
        let size = self.size(slot, axis);
        let far = position + size;
        let mut scale = size.high;
        for number in [position.high.abs(), far.high.abs()] {
            scale = if number > scale { number } else { scale };
        }
        Faces { at: [position, far], scale }
    }

    /// Moves each face of a body along an axis by less than the rounding of coordinates onto the first face of
    /// others that it meets.
    fn align(&mut self, slot: Slot, others: &[Slot], axis: Axis) {
        let own = self.faces(slot, axis);
        let mut aligned = [None; 2];
        for other in others {
            let others = self.faces(*other, axis);
            let scale = if own.scale > others.scale { own.scale } else { others.scale };
            let reach = scale * (COINCIDING_ULPS * f64::EPSILON);
            for side in [0, 1] {
                let meets = |at: &DoubleDouble| (*at - own.at[side]).high.abs() <= reach;
                aligned[side] = aligned[side].or_else(|| others.at.into_iter().find(meets));
            }
        }
        let size = self.size(slot, axis);
        let (position, size) = match aligned {
            [None, None] => return,
            [Some(low), None] => (low, size),
            [None, Some(high)] => (high - size, size),
            [Some(low), Some(high)] if low.is_less(high) => (low, high - low),
            [Some(low), Some(_)] => (low, size),
        };
        let size_low = (size - self.states[slot as usize].size[axis].into()).high;
        self.low_parts[slot as usize].0[axis].size = size_low;
        let state = self.state_dd(slot, axis);
        if state.position != position {
            self.set_trajectory(slot, axis, StateDd { position, ..state });
        }
    }
}
