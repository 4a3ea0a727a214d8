//! An instant: all that happens at one time among bodies that touch.
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
        for slot in concerned {
            let body = self.load(patch, *slot);
            self.explore(patch, body);
            Axis::BOTH.into_iter().for_each(|axis| patch.mark_dirty(body, axis));
        }
        self.settle(patch);
        loop {
            self.carry_out_impacts(patch, world, observer)?;
            self.settle(patch);
            if !self.capture_bounces(patch) {
                return Ok(());
            }
        }
    }

    /// Makes the instant the reference of the bodies that it changed.
    fn write_back(&mut self, patch: &mut Patch) {
        for axis in Axis::BOTH {
            align_faces(patch, axis, |patch, touch| self.is_contact(patch, &patch.touches[touch as usize], axis));
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

/// Places the changed bodies exactly on the faces that they touch, so that rounding errors do not accumulate;
/// bodies in contact get the same velocity.
///
/// Unchanged bodies and, where there is none, the first changed one keep their positions.
fn align_faces(patch: &mut Patch, axis: Axis, is_contact: impl Fn(&Patch, u32) -> bool) {
    let changed: Vec<Local> =
        (0..patch.bodies.len() as Local).filter(|body| patch.axis(*body, axis).has_changed).collect();
    if changed.is_empty() {
        return;
    }
    let mut is_placed: Vec<bool> = patch.bodies.iter().map(|body| !body.axes[axis].has_changed).collect();
    let mut queue: Vec<Local> = Vec::new();
    for body in &changed {
        let touches = patch.bodies[*body as usize].touches.clone();
        let anchor = touches.into_iter().find(|touch| {
            let touch = &patch.touches[*touch as usize];
            touch.kind == TouchKind::Face(axis) && !patch.axis(touch.other(*body), axis).has_changed
        });
        if let Some(touch) = anchor {
            let other = patch.touches[touch as usize].other(*body);
            place_on(patch, *body, other, touch, axis, is_contact(patch, touch));
            is_placed[*body as usize] = true;
            queue.push(*body);
        }
    }
    let mut next = 0;
    for body in changed {
        loop {
            while let Some(by) = queue.get(next).copied() {
                next += 1;
                for touch in patch.bodies[by as usize].touches.clone() {
                    let other = patch.touches[touch as usize].other(by);
                    if patch.touches[touch as usize].kind == TouchKind::Face(axis) && !is_placed[other as usize] {
                        place_on(patch, other, by, touch, axis, is_contact(patch, touch));
                        is_placed[other as usize] = true;
                        queue.push(other);
                    }
                }
            }
            if is_placed[body as usize] {
                break;
            }
            is_placed[body as usize] = true;
            queue.push(body);
        }
    }
}

/// Places a body on a face of another that it touches.
fn place_on(patch: &mut Patch, body: Local, by: Local, touch: u32, axis: Axis, is_contact: bool) {
    let anchor = *patch.axis(by, axis);
    let side = patch.touches[touch as usize].side_of(by, axis);
    let state = patch.axis_mut(body, axis);
    state.state.position = match side {
        Side::High => anchor.state.position + anchor.size,
        Side::Low => anchor.state.position - state.size,
    };
    if is_contact {
        state.state.velocity = anchor.state.velocity;
    }
}
