//! An instant: all events of one time among bodies that touch.
//!
//! 1. Resting (`resting`): contacts that have slid off end, those that slid on or are pressed begin.
//! 2. Impacts (`burst`), until no pair approaches.
//! 3. Resting again, with the velocities after. Bounces below the resolution of coordinates are joined, and 2 and
//!    3 repeated.
//!
//! Only what depends on the bodies concerned is visited (`patch`): a body joins when its velocity, acceleration or
//! contacts may change, and brings all that it touches.

use super::EventDriven;
use super::body_state::Slot;
use super::exact::VELOCITY_ROUNDING;
use super::patch::{Local, Patch, TouchKind};
use crate::physics::{Axis, Observer, Side, StepError, World};

impl EventDriven {
    /// Processes the present instant for the bodies concerned, and predicts their next events.
    pub(super) fn process_instant<O: Observer>(
        &mut self,
        world: &World,
        concerned: &[Slot],
        observer: &mut O,
    ) -> Result<(), StepError> {
        let mut patch = std::mem::take(&mut self.patch);
        patch.clear();
        let result = self.process_patch(&mut patch, world, concerned, observer);
        if result.is_ok() {
            self.write_back(&mut patch);
            self.predict_changed();
        }
        self.patch = patch;
        result
    }

    fn process_patch<O: Observer>(
        &mut self,
        patch: &mut Patch,
        world: &World,
        concerned: &[Slot],
        observer: &mut O,
    ) -> Result<(), StepError> {
        self.load_concerned(patch, concerned);
        self.settle(patch);
        loop {
            self.carry_out_impacts(patch, world, observer)?;
            self.settle(patch);
            if !self.capture_bounce(patch) {
                return Ok(());
            }
        }
    }

    /// Adds the bodies concerned to the patch, and in turn each body that begins or ceases to touch one of them now:
    /// of several such events of a body, the queue holds only one.
    fn load_concerned(&mut self, patch: &mut Patch, concerned: &[Slot]) {
        let mut waiting: Vec<Local> = concerned.iter().map(|slot| self.load(patch, *slot)).collect();
        while let Some(body) = waiting.pop() {
            Axis::BOTH.into_iter().for_each(|axis| patch.mark_dirty(body, axis));
            self.explore(patch, body);
            for index in &patch.bodies[body as usize].touches {
                let touch = &patch.touches[*index as usize];
                let other = touch.other(body);
                if !patch.bodies[other as usize].infinite
                    && !patch.axis(other, Axis::X).is_dirty
                    && patch.is_changing(touch)
                {
                    waiting.push(other);
                }
            }
        }
    }

    /// Makes the instant the reference of the bodies that it changed.
    fn write_back(&mut self, patch: &mut Patch) {
        for axis in Axis::BOTH {
            align_faces(patch, axis);
            for body in 0..patch.bodies.len() as Local {
                let state = patch.axis_mut(body, axis);
                if !state.has_changed {
                    continue;
                }
                state.state.velocity = state.state.velocity.or_zero(state.speed * VELOCITY_ROUNDING);
                let state = state.state;
                self.set_trajectory(patch.bodies[body as usize].slot, axis, state);
            }
        }
        for body in patch.bodies.iter().filter(|body| body.contacts_changed) {
            self.invalidate(body.slot);
        }
    }
}

/// Places the changed bodies exactly on the faces that they touch, so that rounding errors do not accumulate; those
/// that do not move relative to each other get the same velocity.
///
/// Unchanged bodies and, where there is none, the earliest changed one keep their positions.
fn align_faces(patch: &mut Patch, axis: Axis) {
    let mut changed: Vec<Local> =
        (0..patch.bodies.len() as Local).filter(|body| patch.axis(*body, axis).has_changed).collect();
    changed.sort_unstable_by_key(|body| patch.bodies[*body as usize].slot);
    let mut is_placed: Vec<bool> = patch.bodies.iter().map(|body| !body.axes[axis].has_changed).collect();
    let mut queue: Vec<Local> = Vec::new();
    for body in &changed {
        let anchor = faces_of(patch, *body, axis).find(|(other, _)| !patch.axis(*other, axis).has_changed);
        if let Some((other, touch)) = anchor {
            place_on(patch, *body, other, touch, axis);
            is_placed[*body as usize] = true;
            queue.push(*body);
        }
    }
    let mut next = 0;
    for body in changed {
        loop {
            while let Some(by) = queue.get(next).copied() {
                next += 1;
                for (other, touch) in faces_of(patch, by, axis) {
                    if !std::mem::replace(&mut is_placed[other as usize], true) {
                        place_on(patch, other, by, touch, axis);
                        queue.push(other);
                    }
                }
            }
            if std::mem::replace(&mut is_placed[body as usize], true) {
                break;
            }
            queue.push(body);
        }
    }
}

/// The bodies that touch one on a face along an axis, in creation order, with their touches.
fn faces_of(patch: &Patch, body: Local, axis: Axis) -> impl Iterator<Item = (Local, u32)> + use<> {
    let touches = patch.bodies[body as usize].touches.iter().copied();
    let faces = touches.filter(|touch| patch.touches[*touch as usize].kind == TouchKind::Face(axis));
    let mut found: Vec<(Local, u32)> = faces.map(|touch| (patch.touches[touch as usize].other(body), touch)).collect();
    found.sort_unstable_by_key(|(other, _)| patch.bodies[*other as usize].slot);
    found.into_iter()
}

/// Places a body on a face of another that it touches.
fn place_on(patch: &mut Patch, body: Local, by: Local, touch: u32, axis: Axis) {
    let anchor = *patch.axis(by, axis);
    let touch = patch.touches[touch as usize];
    let is_at_rest = patch.approach(&touch, axis).high == 0.0;
    let state = patch.axis_mut(body, axis);
    state.state.position = match touch.side_of(by, axis) {
        Side::High => anchor.state.position + anchor.size,
        Side::Low => anchor.state.position - state.size,
    };
    if is_at_rest {
        state.state.velocity = anchor.state.velocity;
    }
}
