//! Resting contact: which contacts begin and end, and the accelerations under them.
//!
//! The constraints along an axis are the pairs that touch on a face without approaching, the contacts that
//! last, and corners that would be entered otherwise. Under the accelerations of least change
//! (`contact_group`) a constraint is a contact if it is tight and was a contact before, or if its component
//! is carried, that is, if some acceleration differs from free fall.
//!
//! Where no body of a component carries a force of its own, a body rests if constraints lead from it to an infinite
//! mass in the direction of gravity, and falls freely otherwise. The contact graph stores this, so the component need
//! not be visited.

use super::EventDriven;
use super::body_state::{Load, NONE, Slot};
use super::double_double::DoubleDouble;
use super::exact::ACCELERATION_ROUNDING;
use super::patch::{CornerMotion, Local, LocalBody, Patch, Touch, TouchKind};
use crate::physics::{Axis, Side, larger};
use std::cmp::Ordering;

impl EventDriven {
    /// Begins and ends contacts and solves the accelerations, from the positions and velocities of the instant.
    pub(super) fn update_contacts(&mut self, patch: &mut Patch) {
        if patch.has_corners() {
            self.forget_blocks(patch);
        }
        loop {
            for axis in Axis::BOTH {
                while !patch.dirty[axis].is_empty() {
                    self.update_contacts_along(patch, axis);
                }
            }
            if !patch.has_corners() {
                break;
            }
            let has_turned = self.end_turned_contacts(patch);
            let has_blocked = self.block_entered_corners(patch);
            if !has_turned && !has_blocked && !self.release_corners_not_entered(patch) {
                break;
            }
        }
    }

    /// Ends the contacts of corners that were blocked from rest in this instant, and those of corners that block along
    /// both axes: which corners are entered is decided anew.
    fn forget_blocks(&mut self, patch: &mut Patch) {
        for index in 0..patch.touches.len() {
            let touch = patch.touches[index];
            if touch.kind == TouchKind::Corner {
                let contacts = Axis::BOTH.map(|axis| self.is_contact(patch, &touch, axis));
                if touch.blocks != [false; 2] || contacts == [true; 2] {
                    for axis in Axis::BOTH.into_iter().filter(|axis| contacts[*axis]) {
                        self.remove_contact(patch, touch.bodies, axis);
                    }
                }
            }
            let touch = &mut patch.touches[index];
            (touch.blocks, touch.was_released) = ([false; 2], false);
        }
    }

    /// Updates the contacts and accelerations along an axis of the dirty bodies and of all that depend on them.
    fn update_contacts_along(&mut self, patch: &mut Patch, axis: Axis) {
        let mut examined = std::mem::take(&mut self.examined);
        let falling_side = self.falling_side(axis);
        while let Some(body) = patch.dirty[axis].pop() {
            patch.axis_mut(body, axis).is_dirty = false;
            self.explore(patch, body);
            self.end_lost_contacts(patch, body, axis);
            if let Some(side) = falling_side
                && self.load_of(patch, body, axis) == Load::GravityOnly
            {
                self.add_contacts_with_immovable(patch, body, axis, side);
            }
            examined.push(body);
        }
        examined.sort_unstable();
        examined.dedup();
        let mut solved = Vec::new();
        for body in &examined {
            match self.load_of(patch, *body, axis) {
                Load::GravityOnly => self.accelerate_by_gravity(patch, *body, axis, falling_side),
                Load::OwnForces if patch.axis(*body, axis).is_solved => {}
                Load::OwnForces => self.solve_component(patch, *body, axis, &mut solved),
            }
        }
        solved.into_iter().for_each(|body| patch.axis_mut(body, axis).is_solved = false);
        for body in &examined {
            self.end_separating_contacts(patch, *body, axis);
        }
        examined.clear();
        self.examined = examined;
    }

    /// True if a touch constrains the accelerations along an axis.
    fn is_constraint(&self, patch: &Patch, touch: &Touch, axis: Axis) -> bool {
        (touch.acts_along(axis) || self.is_contact(patch, touch, axis))
            && patch.approach_speed_sign(touch, axis) == Ordering::Equal
    }

    /// True if two touching bodies are in contact along an axis.
    pub(super) fn is_contact(&self, patch: &Patch, touch: &Touch, axis: Axis) -> bool {
        self.contacts.axes_between(touch.bodies.map(|body| patch.bodies[body as usize].slot))[axis]
    }

    /// Ends the contacts of a body that no longer touch or have another velocity.
    fn end_lost_contacts(&mut self, patch: &mut Patch, body: Local, axis: Axis) {
        self.keep_contacts(patch, body, axis, |patch, other| {
            patch.touch_between(body, other).is_some_and(|touch| {
                let touch = &patch.touches[touch as usize];
                let lasts_across = match touch.kind {
                    TouchKind::Face(face) => face == axis,
                    TouchKind::Corner => patch.approach_speed(touch, axis.other()).high >= 0.0,
                };
                lasts_across && patch.approach_speed_sign(touch, axis) == Ordering::Equal
            })
        });
    }

    /// Keeps the contacts of a body along an axis with the bodies for which `lasts` is true, and ends the others.
    pub(super) fn keep_contacts(
        &mut self,
        patch: &mut Patch,
        body: Local,
        axis: Axis,
        lasts: impl Fn(&Patch, Local) -> bool,
    ) {
        let mut from = 0;
        while let Some((place, other)) = self.next_ended_contact(patch, body, axis, from, &lasts) {
            self.remove_contact(patch, [body, other], axis);
            from = place;
        }
    }

    /// The first contact of a body along an axis, from a place in its list on, for which `lasts` is false: its place and
    /// the other body.
    #[inline(always)]
    fn next_ended_contact(
        &self,
        patch: &mut Patch,
        body: Local,
        axis: Axis,
        from: usize,
        lasts: &impl Fn(&Patch, Local) -> bool,
    ) -> Option<(usize, Local)> {
        let LocalBody { slot, at, .. } = patch.bodies[body as usize];
        let contacts = self.contacts.of(slot).iter().enumerate().skip(from);
        for (place, contact) in contacts.filter(|(_, contact)| contact.axis == axis) {
            let other = self.local_of(patch, contact.other, at);
            if !lasts(patch, other) {
                return Some((place, other));
            }
        }
        None
    }

    /// The load of a component, as far as it is known.
    #[inline(always)]
    fn load_of(&self, patch: &Patch, body: Local, axis: Axis) -> Load {
        if self.bodies.carry_forces(axis) { self.load_with_forces(patch, body, axis) } else { Load::GravityOnly }
    }

    /// The load of a component, as far as it is known, if forces act along the axis. Not inlined, because
    /// most scenes have no forces: a heap of 10³ boxes needs 0.8 % fewer instructions.
    #[inline(never)]
    fn load_with_forces(&self, patch: &Patch, body: Local, axis: Axis) -> Load {
        let is_forced = |body: Local| {
            let slot = patch.bodies[body as usize].slot;
            self.bodies[slot].load[axis] == Load::OwnForces || self.bodies.params(slot).has_force[axis]
        };
        let reaches_forced = patch.bodies[body as usize].touches.iter().any(|touch| {
            let touch = &patch.touches[*touch as usize];
            is_forced(touch.other(body)) && self.is_constraint(patch, touch, axis)
        });
        if is_forced(body) || reaches_forced { Load::OwnForces } else { Load::GravityOnly }
    }

    /// The direction of gravity along an axis.
    fn falling_side(&self, axis: Axis) -> Option<Side> {
        match self.bodies.gravity(axis).high {
            0.0 => None,
            gravity if gravity > 0.0 => Some(Side::High),
            _ => Some(Side::Low),
        }
    }

    /// True if a body cannot fall towards a side.
    fn is_immovable(&self, patch: &Patch, body: Local, axis: Axis, side: Side) -> bool {
        self.contacts.is_immovable(patch.bodies[body as usize].slot, axis, side)
    }

    /// Adds contacts with the immovable bodies below and, if the body is immovable itself, with those above.
    fn add_contacts_with_immovable(&mut self, patch: &mut Patch, body: Local, axis: Axis, side: Side) {
        for index in 0..patch.bodies[body as usize].touches.len() {
            let touch = &patch.touches[patch.bodies[body as usize].touches[index] as usize];
            let below = if touch.side_of(body, axis) == side { touch.other(body) } else { body };
            if touch.acts_along(axis)
                && self.is_immovable(patch, below, axis, side)
                && patch.approach_speed_sign(touch, axis) == Ordering::Equal
                && !self.is_contact(patch, touch, axis)
            {
                let touch = *touch;
                self.add_contact(patch, &touch, axis);
            }
        }
    }

    fn accelerate_by_gravity(&mut self, patch: &mut Patch, body: Local, axis: Axis, falling_side: Option<Side>) {
        let is_supported = falling_side.is_some_and(|side| self.is_immovable(patch, body, axis, side));
        let slot = patch.bodies[body as usize].slot;
        let acceleration =
            if is_supported { DoubleDouble::ZERO } else { self.bodies.params(slot).free_acceleration[axis] };
        self.bodies.set_load(slot, axis, Load::GravityOnly);
        set_acceleration(patch, body, axis, acceleration);
    }

    /// Solves the accelerations of a whole component, begins and ends its contacts, and adds its bodies to `solved`.
    fn solve_component(&mut self, patch: &mut Patch, start: Local, axis: Axis, solved: &mut Vec<Local>) {
        let (members, constraints) = self.constrained_component(patch, start, axis);
        let accelerations = self.solve_accelerations(patch, &members, &constraints, axis);
        let is_forced = |body: &Local| self.bodies.params(patch.bodies[*body as usize].slot).has_force[axis];
        let load = if members.iter().any(is_forced) { Load::OwnForces } else { Load::GravityOnly };
        for (body, acceleration) in members.iter().zip(accelerations) {
            self.bodies.set_load(patch.bodies[*body as usize].slot, axis, load);
            set_acceleration(patch, *body, axis, acceleration);
        }
        self.keep_tight_contacts(patch, members.len(), &constraints, axis);
        for body in &members {
            patch.bodies[*body as usize].member = NONE;
            patch.axis_mut(*body, axis).is_solved = true;
        }
        solved.extend(members);
    }

    /// The bodies of finite mass connected to one by constraints along an axis, marked with their indices, and these
    /// constraints.
    fn constrained_component(&mut self, patch: &mut Patch, start: Local, axis: Axis) -> (Vec<Local>, Vec<u32>) {
        let (mut members, mut constraints) = (vec![start], Vec::new());
        patch.bodies[start as usize].member = 0;
        let mut next = 0;
        while let Some(body) = members.get(next).copied() {
            next += 1;
            self.explore(patch, body);
            for index in 0..patch.bodies[body as usize].touches.len() {
                let index = patch.bodies[body as usize].touches[index];
                let touch = &patch.touches[index as usize];
                if !self.is_constraint(patch, touch, axis) {
                    continue;
                }
                let other = touch.other(body);
                let is_known = patch.bodies[other as usize].member != NONE;
                if patch.bodies[other as usize].infinite || touch.bodies[0] == body || !is_known {
                    constraints.push(index);
                }
                if !is_known && !patch.bodies[other as usize].infinite {
                    patch.bodies[other as usize].member = 0;
                    members.push(other);
                }
            }
        }
        members.sort_unstable_by_key(|body| patch.bodies[*body as usize].slot);
        for (index, body) in members.iter().enumerate() {
            patch.bodies[*body as usize].member = index as u32;
        }
        constraints.sort_unstable_by_key(|touch| {
            patch.touches[*touch as usize].bodies.map(|body| patch.bodies[body as usize].slot)
        });
        constraints.dedup();
        (members, constraints)
    }

    /// The accelerations of least change of the members of a component.
    fn solve_accelerations(
        &mut self,
        patch: &Patch,
        members: &[Local],
        constraints: &[u32],
        axis: Axis,
    ) -> Vec<DoubleDouble> {
        let mut group = std::mem::take(&mut self.contact_group);
        group.clear(self.bodies.gravity(axis));
        for body in members {
            let LocalBody { slot, member, .. } = patch.bodies[*body as usize];
            let params = &self.bodies.params(slot);
            let index = group.add(params.free_acceleration[axis], params.mass, self.bodies.force(slot, axis));
            debug_assert_eq!(index, member as usize);
        }
        let index = |body: Local| patch.bodies[body as usize].member as usize;
        for touch in constraints {
            let [low, high] = patch.touches[*touch as usize].ordered(axis);
            match [low, high].map(|body| patch.bodies[body as usize].infinite) {
                [true, _] => group.support(index(high), Side::Low),
                [_, true] => group.support(index(low), Side::High),
                _ => group.connect([index(low), index(high)]),
            }
        }
        let accelerations = group.accelerations();
        self.contact_group = group;
        accelerations
    }

    /// Of the constraints of a solved component of `count` bodies, makes those contacts that are tight and were
    /// contacts before or are carried; ends all other contacts.
    fn keep_tight_contacts(&mut self, patch: &mut Patch, count: usize, constraints: &[u32], axis: Axis) {
        let is_tight =
            |patch: &Patch, touch: u32| patch.approach_acceleration(&patch.touches[touch as usize], axis).high == 0.0;
        let member = |patch: &Patch, body: Local| patch.bodies[body as usize].member as usize;
        let mut carried = vec![false; count];
        let mut links: Vec<[Local; 2]> = Vec::new();
        let mut stack = Vec::new();
        for touch in constraints.iter().filter(|touch| is_tight(patch, **touch)) {
            let bodies = patch.touches[*touch as usize].bodies;
            let is_finite = bodies.map(|body| !patch.bodies[body as usize].infinite);
            if is_finite == [true; 2] {
                links.extend([bodies, [bodies[1], bodies[0]]]);
            }
            for body in bodies.into_iter().filter(|body| !patch.bodies[*body as usize].infinite) {
                if !carried[member(patch, body)] && self.differs_from_free_fall(patch, body, axis) {
                    carried[member(patch, body)] = true;
                    stack.push(body);
                }
            }
        }
        links.sort_unstable();
        while let Some(body) = stack.pop() {
            let from = links.partition_point(|link| link[0] < body);
            for link in links[from..].iter().take_while(|link| link[0] == body) {
                if !std::mem::replace(&mut carried[member(patch, link[1])], true) {
                    stack.push(link[1]);
                }
            }
        }
        for index in constraints {
            let touch = patch.touches[*index as usize];
            let was_contact = self.is_contact(patch, &touch, axis);
            let is_contact =
                is_tight(patch, *index) && (was_contact || carried[member(patch, patch.finite_of(touch.bodies))]);
            if is_contact && !was_contact {
                self.add_contact(patch, &touch, axis);
            } else if was_contact && !is_contact {
                self.remove_contact(patch, touch.bodies, axis);
            }
        }
    }

    fn differs_from_free_fall(&self, patch: &Patch, body: Local, axis: Axis) -> bool {
        let state = patch.axis(body, axis);
        let free = self.bodies.params(patch.bodies[body as usize].slot).free_acceleration[axis];
        let rounding = state.magnitudes.acceleration * ACCELERATION_ROUNDING;
        (state.state.acceleration - free).high.abs() > rounding
    }

    /// Ends the contacts of a body along an axis whose accelerations separate it.
    fn end_separating_contacts(&mut self, patch: &mut Patch, body: Local, axis: Axis) {
        self.keep_contacts(patch, body, axis, |patch, other| {
            let [own, others] = [body, other].map(|body| patch.axis(body, axis).state.acceleration);
            let separates = |touch: u32| patch.approach_acceleration(&patch.touches[touch as usize], axis).high != 0.0;
            own == others || !patch.touch_between(body, other).is_some_and(separates)
        });
    }

    /// Ends the contacts at corners that do not begin to overlap.
    fn end_turned_contacts(&mut self, patch: &mut Patch) -> bool {
        let mut has_ended = false;
        for index in 0..patch.touches.len() {
            let touch = patch.touches[index];
            for axis in Axis::BOTH {
                let across = axis.other();
                if touch.kind == TouchKind::Corner
                    && !touch.blocks[axis]
                    && self.is_contact(patch, &touch, axis)
                    && patch.approach_speed(&touch, across).high == 0.0
                    && patch.approach_acceleration(&touch, across).high <= 0.0
                {
                    self.remove_contact(patch, touch.bodies, axis);
                    has_ended = true;
                }
            }
        }
        has_ended
    }

    /// Constrains the corners that would be entered from rest along the gentler axis.
    fn block_entered_corners(&mut self, patch: &mut Patch) -> bool {
        let mut blocked = Vec::new();
        for (index, touch) in patch.touches.iter().enumerate() {
            if touch.kind != TouchKind::Corner || touch.blocks != [false; 2] {
                continue;
            }
            if Axis::BOTH.into_iter().any(|axis| self.is_contact(patch, touch, axis)) {
                continue;
            }
            let axes = patch.blocked_axes(touch, CornerMotion::MovingOrFromRest);
            for axis in Axis::BOTH {
                if axes[axis] && patch.approach_speed(touch, axis).high == 0.0 {
                    blocked.push((index, axis));
                }
            }
        }
        for (index, axis) in &blocked {
            patch.touches[*index].blocks[*axis] = true;
            patch.touches[*index].bodies.into_iter().for_each(|body| patch.mark_dirty(body, *axis));
        }
        !blocked.is_empty()
    }

    /// Releases the blocked corners that are not entered any more, because others block too: the boxes would part along
    /// one axis, or would not begin to overlap. A corner is released once, so that this ends; it can be blocked again.
    fn release_corners_not_entered(&mut self, patch: &mut Patch) -> bool {
        let mut has_released = false;
        for index in 0..patch.touches.len() {
            let touch = patch.touches[index];
            let is_not_entered = |axis: Axis| {
                let acceleration = patch.approach_acceleration(&touch, axis).high;
                let stays = if touch.blocks[axis] { acceleration == 0.0 } else { acceleration > 0.0 };
                patch.approach_speed(&touch, axis).high == 0.0 && !stays
            };
            if touch.blocks == [false; 2] || touch.was_released || !Axis::BOTH.into_iter().any(is_not_entered) {
                continue;
            }
            for axis in Axis::BOTH {
                if self.is_contact(patch, &touch, axis) {
                    self.remove_contact(patch, touch.bodies, axis);
                }
                touch.bodies.into_iter().for_each(|body| patch.mark_dirty(body, axis));
            }
            let touch = &mut patch.touches[index];
            (touch.blocks, touch.was_released) = ([false; 2], true);
            has_released = true;
        }
        has_released
    }

    /// Begins the contact of two touching bodies.
    pub(super) fn add_contact(&mut self, patch: &mut Patch, touch: &Touch, axis: Axis) {
        let pair = touch.ordered(axis);
        let changed = self.contacts.add(pair.map(|body| patch.bodies[body as usize].slot), axis);
        self.contact_changed(patch, pair, axis, &changed);
    }

    /// Ends the contact of two bodies along an axis.
    pub(super) fn remove_contact(&mut self, patch: &mut Patch, pair: [Local; 2], axis: Axis) {
        let changed = self.contacts.remove(pair.map(|body| patch.bodies[body as usize].slot), axis);
        self.contact_changed(patch, pair, axis, &changed);
    }

    /// Marks the bodies of a contact, and those whose support changed with it.
    fn contact_changed(&mut self, patch: &mut Patch, pair: [Local; 2], axis: Axis, supports: &[Slot]) {
        for body in pair {
            patch.bodies[body as usize].contacts_changed = true;
            patch.mark_dirty(body, axis);
        }
        let at = patch.bodies[patch.finite_of(pair) as usize].at;
        for slot in supports {
            let body = self.local_of(patch, *slot, at);
            patch.mark_dirty(body, axis);
        }
    }
}

/// Changes the acceleration of a body from the present instant on.
fn set_acceleration(patch: &mut Patch, body: Local, axis: Axis, acceleration: DoubleDouble) {
    let state = patch.axis_mut(body, axis);
    if state.state.acceleration != acceleration {
        state.state.acceleration = acceleration;
        state.magnitudes.acceleration = larger(acceleration.high.abs(), state.magnitudes.acceleration);
        patch.mark_changed(body, axis);
    }
}
