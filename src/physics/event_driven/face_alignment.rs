//! Makes faces of a spawned body coincide with faces that lie within the rounding of the coordinates.
//!
//! Positions and sizes that were computed in doubles leave the faces of boxes that are meant to touch a few units in
//! the last place apart. From the start of a body on, they are the same double-double number.
//!
//! The rounding of a face is that of the numbers from which it was computed, not of others of its body: a floor 10⁶ m
//! thick does not attract a box 10⁻⁶ m wide from a distance. Decimals were not computed ([`decimal`]), so faces that
//! follow from decimals alone lie where the scene states them.

use super::EventDriven;
use super::axis_trajectory::StateDd;
use super::body_state::{BodyState, Slot};
use super::decimal::decimal;
use super::double_double::DoubleDouble;
use crate::physics::{Axis, Side, larger};
use std::collections::BTreeMap;

/// Faces that differ by at most this fraction of the largest number involved coincide: two units in the last place, the
/// rounding of a few sums in doubles.
const COINCIDENCE: f64 = 2.0 * f64::EPSILON;

/// The rounding of a sum of decimals in double-double arithmetic, as a fraction of the largest number involved: each of
/// a few operations rounds by 2⁻¹⁰⁴.
const DECIMAL_ROUNDING: f64 = 1.0 / (1_u128 << 100) as f64;

/// A face of a body that takes part in an alignment.
#[derive(Clone, Copy)]
struct Face {
    at: DoubleDouble,
    /// The magnitude of the numbers that it is computed from.
    scale: f64,
    /// True if these numbers are decimals.
    is_decimal: bool,
    slot: Slot,
    side: Side,
}

impl Face {
    /// True if `next`, the face that follows along the axis, differs by rounding alone.
    fn coincides_with(&self, next: &Face) -> bool {
        let are_decimal = self.is_decimal && next.is_decimal;
        let rounding = if are_decimal { DECIMAL_ROUNDING } else { COINCIDENCE };
        (next.at - self.at).high <= larger(self.scale, next.scale) * rounding
    }
}

impl EventDriven {
    /// Aligns the faces of spawned bodies with each other and with those of the older bodies that they touch.
    ///
    /// The faces of bodies connected by touching that follow each other within rounding along an axis move to one of
    /// them: to that of the earliest body that was there before; otherwise to the given position of the earliest body
    /// whose low face it is; otherwise to the earliest high face. So positions stay as they are given, unless two that
    /// differ coincide, and sizes take up the rounding.
    ///
    /// `touching` are the spawned bodies of finite mass that may touch others.
    pub(super) fn align_spawned(&mut self, spawned: &[Slot], touching: &[Slot]) {
        let mut pairs = Vec::new();
        for (index, slot) in spawned.iter().enumerate() {
            if self.bodies[*slot].infinite || touching.binary_search(slot).is_ok() {
                pairs.extend(self.older_neighbours(*slot).into_iter().map(|other| (index, other)));
            }
        }
        for slots in groups(spawned, &pairs) {
            Axis::BOTH.into_iter().for_each(|axis| self.align(&slots, spawned, axis));
        }
    }

    /// The older bodies that touch a body within rounding, in creation order.
    fn older_neighbours(&self, slot: Slot) -> Vec<Slot> {
        let own = Axis::BOTH.map(|axis| self.faces(slot, axis));
        let [low, high] = Side::BOTH.map(|side| Axis::BOTH.map(|axis| own[axis][side].at.high));
        let reach = own.map(|faces| faces[Side::High].scale * (2.0 * COINCIDENCE));
        let mut found = Vec::new();
        let [from, to] = [[low[0] - reach[0], low[1] - reach[1]], [high[0] + reach[0], high[1] + reach[1]]];
        self.cell_lists.visit_region(from, to, |other| {
            let BodyState { trajectory, size, .. } = &self.bodies[other];
            let [position, magnitude] =
                [trajectory.at(self.timeline.now())[0], trajectory.magnitude_at(self.timeline.now())];
            let is_near = other < slot
                && Axis::BOTH.into_iter().all(|axis| {
                    let margin = reach[axis] + (magnitude[axis] + size[axis]) * (2.0 * COINCIDENCE);
                    position[axis] - margin <= to[axis] && position[axis] + size[axis] + margin >= from[axis]
                });
            if is_near {
                found.push(other);
            }
        });
        found.sort_unstable();
        found.dedup();
        found
    }

    /// The faces of a body along an axis, the low one first.
    ///
    /// A position that is no decimal may have been computed from the high face, as a difference with the size.
    fn faces(&self, slot: Slot, axis: Axis) -> [Face; 2] {
        let position = self.state_dd(slot, axis).position;
        let size = self.bodies.size(slot, axis);
        let far = position + size;
        let [starts_at_decimal, has_decimal_size] =
            [position, size].map(|number| decimal(number.high).is_some_and(|decimal| decimal == number));
        let scale = larger(larger(position.high.abs(), far.high.abs()), size.high);
        let low_scale = if starts_at_decimal { position.high.abs() } else { scale };
        let is_decimal = starts_at_decimal && has_decimal_size;
        [
            Face { at: position, scale: low_scale, is_decimal: starts_at_decimal, slot, side: Side::Low },
            Face { at: far, scale, is_decimal, slot, side: Side::High },
        ]
    }

    /// Makes the faces of connected bodies, given in creation order, coincide along an axis.
    fn align(&mut self, slots: &[Slot], spawned: &[Slot], axis: Axis) {
        let mut faces: Vec<Face> = Vec::with_capacity(2 * slots.len());
        for slot in slots {
            faces.extend(self.faces(*slot, axis));
        }
        faces.sort_unstable_by(|a, b| {
            let [x, y] = [a, b].map(|face| face.at);
            x.high.total_cmp(&y.high).then(x.low.total_cmp(&y.low)).then((a.slot, a.side).cmp(&(b.slot, b.side)))
        });
        let mut aligned = vec![[None; 2]; slots.len()];
        for group in faces.chunk_by(Face::coincides_with).filter(|group| group.len() > 1) {
            let rank = |face: &&Face| {
                let is_spawned = spawned.binary_search(&face.slot).is_ok();
                (is_spawned, is_spawned && face.side == Side::High, face.slot, face.side)
            };
            let Some(anchor) = group.iter().min_by_key(rank) else { continue };
            for face in group {
                let index = slots.partition_point(|slot| *slot < face.slot);
                aligned[index][face.side] = Some(anchor.at);
            }
        }
        for (slot, aligned) in slots.iter().zip(aligned) {
            if spawned.binary_search(slot).is_ok() {
                self.set_faces(*slot, axis, aligned);
            }
        }
    }

    /// Moves the faces of a body to where they are aligned. It keeps its position if only the high face is aligned, and
    /// its size if only the low one is, or if it is too thin for both.
    fn set_faces(&mut self, slot: Slot, axis: Axis, aligned: [Option<DoubleDouble>; 2]) {
        let size = self.bodies.size(slot, axis);
        let position = self.state_dd(slot, axis).position;
        let (position, size) = match aligned {
            [Some(low), Some(high)] if low.is_less(high) => (low, high - low),
            [Some(low), _] => (low, size),
            [None, Some(high)] if position.is_less(high) => (position, high - position),
            [None, Some(high)] => (high - size, size),
            [None, None] => return,
        };
        self.bodies.adjust_size(slot, axis, size);
        let state = self.state_dd(slot, axis);
        if state.position != position {
            self.set_trajectory(slot, axis, StateDd { position, ..state }, self.timeline.now());
        }
    }
}

/// The bodies connected by touching, each group in creation order, given pairs of the index of a spawned body and an
/// older body that it touches.
fn groups(spawned: &[Slot], pairs: &[(usize, Slot)]) -> impl Iterator<Item = Vec<Slot>> {
    let mut parents: Vec<usize> = (0..spawned.len()).collect();
    let root = |parents: &mut Vec<usize>, mut index: usize| {
        while parents[index] != index {
            parents[index] = parents[parents[index]];
            index = parents[index];
        }
        index
    };
    for (index, other) in pairs {
        if let Ok(other) = spawned.binary_search(other) {
            let [a, b] = [*index, other].map(|index| root(&mut parents, index));
            parents[if a > b { a } else { b }] = if a < b { a } else { b };
        }
    }
    let mut groups: BTreeMap<usize, Vec<Slot>> = BTreeMap::new();
    for (index, other) in pairs {
        groups.entry(root(&mut parents, *index)).or_default().extend([spawned[*index], *other]);
    }
    groups.into_values().map(|mut slots| {
        slots.sort_unstable();
        slots.dedup();
        slots
    })
}
