//! The neighbourhood of an instant: the bodies concerned, their exact states and the touches between them.

use super::EventDriven;
use super::axis_trajectory::StateDd;
use super::body_state::{NONE, Slot};
use super::double_double::DoubleDouble;
use super::exact::{ACCELERATION_ROUNDING, DEEPEST_ROUNDING, Resolution, VELOCITY_ROUNDING};
use super::impact_history::ImpactHistory;
use super::instant::Instant;
use super::neighbour_buffer::NeighbourBuffer;
use super::pair_event::Sample;
use super::reference::{Magnitudes, ScaledState};
use super::swept_aabb::SweptAabb;
use crate::physics::{Axis, Side, larger};
use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

/// An index into [`Patch::bodies`].
pub type Local = u32;

/// The state of a body of a patch along one axis.
#[derive(Clone, Copy, Debug)]
pub struct LocalAxis {
    pub state: StateDd,
    pub size: DoubleDouble,
    /// The magnitudes of the numbers from which the state was computed.
    pub magnitudes: Magnitudes,
    /// True if velocity or acceleration changed in this instant; set by [`Patch::mark_changed`].
    pub has_changed: bool,
    /// True once a changed body was placed on the faces that it touches.
    pub is_placed: bool,
    /// True if the contacts of the body along the axis must be examined.
    pub is_dirty: bool,
    /// True if its component was solved in this examination.
    pub is_solved: bool,
}

impl LocalAxis {
    #[inline]
    fn of(scaled: &ScaledState, size: DoubleDouble) -> LocalAxis {
        let &ScaledState { state, magnitudes } = scaled;
        LocalAxis { state, size, magnitudes, has_changed: false, is_placed: false, is_dirty: false, is_solved: false }
    }
}

/// A body of a patch.
#[derive(Clone, Debug)]
pub struct LocalBody {
    pub slot: Slot,
    pub infinite: bool,
    /// The instant of its state: the same for all bodies connected by touching.
    pub at: Instant,
    pub axes: [LocalAxis; 2],
    /// True once all bodies that touch it are in the patch; never for an infinite mass.
    explored: bool,
    /// True if its contacts changed in this instant.
    pub contacts_changed: bool,
    /// Its touches with others, as far as explored.
    pub touches: Vec<u32>,
    /// Its parent in the forest of bodies of finite mass connected by touching.
    parent: Local,
    /// The number of bodies in its tree, if it is a root.
    tree_size: u32,
    /// Its index in the component that is being solved, or [`NONE`].
    pub member: u32,
}

impl LocalBody {
    /// Memory for a body.
    #[cold]
    fn vacant() -> LocalBody {
        let scaled = ScaledState::default();
        LocalBody {
            slot: NONE,
            infinite: false,
            at: Instant::START,
            axes: [LocalAxis::of(&scaled, DoubleDouble::ZERO); 2],
            explored: false,
            contacts_changed: false,
            touches: Vec::new(),
            parent: NONE,
            tree_size: 1,
            member: NONE,
        }
    }

    /// Replaces the body by one without touches, but leaves its states to be set.
    #[inline(always)]
    fn begin(&mut self, local: Local, slot: Slot, infinite: bool, at: Instant) {
        (self.slot, self.infinite, self.at) = (slot, infinite, at);
        (self.explored, self.contacts_changed) = (false, false);
        self.touches.clear();
        (self.parent, self.tree_size, self.member) = (local, 1, NONE);
    }
}

/// The kind of a touch of two boxes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TouchKind {
    /// Their gap along the axis is 0, and they overlap on the other.
    Face(Axis),
    /// Both gaps are 0.
    Corner,
}

/// The motions by which a corner counts as entered along an axis.
#[derive(Clone, Copy, Debug)]
pub enum CornerMotion {
    /// The bodies approach along it.
    Moving,
    /// The bodies approach along it, or accelerate towards each other from rest.
    MovingOrFromRest,
}

/// The place of a touch in the order of impacts: faces before corners, then the lowest pair in creation order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ImpactOrder {
    is_corner: bool,
    slots: [Slot; 2],
}

/// Two boxes that touch; the first is the earlier one in creation order.
#[derive(Clone, Copy, Debug)]
pub struct Touch {
    pub bodies: [Local; 2],
    pub kind: TouchKind,
    /// For each axis, the side of the first on which the second lies.
    pub side: [Side; 2],
    /// For each axis, true if the corner was found to block along it in this instant.
    pub blocks: [bool; 2],
    /// True if a block of the corner was released since contacts were last updated.
    pub was_released: bool,
    /// True if the bodies approach each other, so that an impact is due.
    approaches: bool,
    /// True if it is in [`Patch::queue`].
    is_queued: bool,
}

impl Touch {
    /// The other of the two bodies.
    pub fn other(&self, body: Local) -> Local {
        if self.bodies[0] == body { self.bodies[1] } else { self.bodies[0] }
    }

    /// The side of `body` on which the other lies.
    pub fn side_of(&self, body: Local, axis: Axis) -> Side {
        if self.bodies[0] == body { self.side[axis] } else { self.side[axis].opposite() }
    }

    /// The two bodies, the one on the low side first.
    pub fn ordered(&self, axis: Axis) -> [Local; 2] {
        match self.side[axis] {
            Side::High => self.bodies,
            Side::Low => [self.bodies[1], self.bodies[0]],
        }
    }

    /// True if it is a face or a blocking corner along the axis.
    pub fn acts_along(&self, axis: Axis) -> bool {
        self.kind == TouchKind::Face(axis) || self.blocks[axis]
    }

    /// See [`Patch::approach_speed`].
    fn approach_speed(&self, bodies: &[LocalBody], axis: Axis) -> DoubleDouble {
        let [low, high] = self.ordered(axis).map(|body| &bodies[body as usize].axes[axis]);
        let rounding = (low.magnitudes.velocity + high.magnitudes.velocity) * VELOCITY_ROUNDING;
        (low.state.velocity - high.state.velocity).or_zero(rounding)
    }

    /// See [`Patch::approach_speed_sign`].
    #[inline]
    fn approach_speed_sign(&self, bodies: &[LocalBody], axis: Axis) -> Ordering {
        let [low, high] = self.ordered(axis).map(|body| &bodies[body as usize].axes[axis]);
        if low.state.velocity == high.state.velocity {
            return Ordering::Equal;
        }
        let difference = low.state.velocity.high - high.state.velocity.high;
        let exact = || self.approach_speed(bodies, axis).high.partial_cmp(&0.0).unwrap_or(Ordering::Equal);
        if difference.abs() > (low.magnitudes.velocity + high.magnitudes.velocity) * CLEAR_SIGN {
            let sign = if difference > 0.0 { Ordering::Greater } else { Ordering::Less };
            debug_assert!(sign == exact() || difference.is_infinite(), "doubles suffice");
            return sign;
        }
        exact()
    }

    /// Determines whether the bodies approach each other; returns true if the touch must be queued for that.
    #[inline(always)]
    fn refresh(&mut self, bodies: &[LocalBody]) -> bool {
        let approaches_along = |axis: Axis| self.approach_speed_sign(bodies, axis) == Ordering::Greater;
        let approaches = match self.kind {
            TouchKind::Face(axis) => approaches_along(axis),
            TouchKind::Corner => Axis::BOTH.into_iter().all(approaches_along),
        };
        let must_queue = approaches && !self.is_queued;
        self.approaches = approaches;
        self.is_queued |= must_queue;
        must_queue
    }

    /// The place of the touch in the order of impacts.
    #[inline]
    fn order(&self, bodies: &[LocalBody]) -> ImpactOrder {
        let slots = self.bodies.map(|body| bodies[body as usize].slot);
        ImpactOrder { is_corner: self.kind == TouchKind::Corner, slots }
    }
}

/// The impacts of an instant among bodies connected by touching.
#[derive(Clone, Debug, Default)]
pub struct Burst {
    /// The greatest approach speed so far, m/s.
    pub greatest: f64,
    /// For each axis, the sequence of impacts.
    pub histories: [ImpactHistory; 2],
}

impl Burst {
    /// Removes all impacts, but keeps the memory for the next instant.
    #[inline]
    fn clear(&mut self) {
        self.greatest = 0.0;
        self.histories.iter_mut().for_each(ImpactHistory::clear);
    }
}

/// Up to this number of bodies, a patch keeps its memory for the next instant.
const KEPT_BODIES: usize = 1024;

/// The bodies concerned by an instant and what they touch; grows as the instant is processed.
#[derive(Clone, Debug, Default)]
pub struct Patch {
    /// The first `count` are those in the patch. Further entries are kept for their memory, and to write new bodies in
    /// place: a heap of 10³ boxes needs 0.8 % fewer instructions.
    pub bodies: Vec<LocalBody>,
    /// The number of bodies in the patch.
    count: u32,
    pub touches: Vec<Touch>,
    /// By slot, the local index or [`NONE`].
    index: Vec<u32>,
    /// Moving infinite masses at other instants than those in `index`.
    moving_walls: Vec<Local>,
    /// The touches whose bodies approach each other, and some that did earlier in the instant, each once.
    queue: BinaryHeap<Reverse<(ImpactOrder, u32)>>,
    /// True if two of the bodies touch at a corner.
    has_corners: bool,
    /// For each axis, the bodies whose contacts must be examined.
    pub dirty: [Vec<Local>; 2],
    /// For each axis, the bodies whose velocity or acceleration changed in this instant.
    pub changed: [Vec<Local>; 2],
    /// The impacts so far, by local index; only the entries of roots count.
    pub bursts: Vec<Burst>,
    /// Buffer for the bodies that wait to be explored.
    pub waiting: Vec<Local>,
}

impl Patch {
    /// Removes everything.
    pub fn clear(&mut self) {
        for body in &self.bodies[..self.count as usize] {
            self.index[body.slot as usize] = NONE;
        }
        self.count = 0;
        self.touches.clear();
        self.moving_walls.clear();
        self.queue.clear();
        self.has_corners = false;
        self.dirty.iter_mut().for_each(Vec::clear);
        self.changed.iter_mut().for_each(Vec::clear);
        if self.bodies.capacity() > KEPT_BODIES {
            *self = Patch { index: std::mem::take(&mut self.index), ..Patch::default() };
        }
    }

    /// The local index of a body, if it is in the patch. A moving infinite mass can be in it at several instants.
    #[inline]
    pub fn find(&self, slot: Slot, at: Instant) -> Option<Local> {
        let first = self.index.get(slot as usize).copied().filter(|index| *index != NONE)?;
        if self.bodies[first as usize].infinite { self.find_wall(first, slot, at) } else { Some(first) }
    }

    /// The local index of an infinite mass, of which one is `first`. Not inlined, since most bodies move: a heap of 10³
    /// boxes needs 0.4 % fewer instructions.
    #[inline(never)]
    fn find_wall(&self, first: Local, slot: Slot, at: Instant) -> Option<Local> {
        let body = &self.bodies[first as usize];
        if body.at == at || body.axes.iter().all(|axis| axis.state.is_at_rest()) {
            return Some(first);
        }
        let is_wanted = |local: &Local| {
            let body = &self.bodies[*local as usize];
            body.slot == slot && body.at == at
        };
        self.moving_walls.iter().copied().find(is_wanted)
    }

    fn insert(&mut self, slot: Slot, infinite: bool, at: Instant) -> Local {
        if self.index.len() <= slot as usize {
            self.index.resize(slot as usize + 1, NONE);
        }
        let local = self.count;
        self.count += 1;
        match self.index[slot as usize] {
            NONE => self.index[slot as usize] = local,
            _ => self.moving_walls.push(local),
        }
        if self.bodies.len() == local as usize {
            self.bodies.push(LocalBody::vacant());
            self.bursts.push(Burst::default());
        }
        self.bodies[local as usize].begin(local, slot, infinite, at);
        self.bursts[local as usize].clear();
        local
    }

    /// The bodies in the patch.
    pub fn present(&self) -> &[LocalBody] {
        &self.bodies[..self.count as usize]
    }

    /// The state of a body along an axis.
    pub fn axis(&self, body: Local, axis: Axis) -> &LocalAxis {
        &self.bodies[body as usize].axes[axis]
    }

    /// The state of a body along an axis, to be changed.
    pub fn axis_mut(&mut self, body: Local, axis: Axis) -> &mut LocalAxis {
        &mut self.bodies[body as usize].axes[axis]
    }

    /// The speed at which two touching bodies approach along an axis, m/s; 0 if below rounding.
    pub fn approach_speed(&self, touch: &Touch, axis: Axis) -> DoubleDouble {
        touch.approach_speed(&self.bodies, axis)
    }

    /// The sign of the [approach speed](Self::approach_speed): greater than 0 if two touching bodies approach along an
    /// axis.
    #[inline]
    pub fn approach_speed_sign(&self, touch: &Touch, axis: Axis) -> Ordering {
        touch.approach_speed_sign(&self.bodies, axis)
    }

    /// The acceleration at which two touching bodies approach along an axis, m/s²; 0 if below rounding.
    pub fn approach_acceleration(&self, touch: &Touch, axis: Axis) -> DoubleDouble {
        let [low, high] = touch.ordered(axis).map(|body| self.axis(body, axis));
        if low.state.acceleration == high.state.acceleration {
            return DoubleDouble::ZERO;
        }
        let rounding = (low.magnitudes.acceleration + high.magnitudes.acceleration) * ACCELERATION_ROUNDING;
        (low.state.acceleration - high.state.acceleration).or_zero(rounding)
    }

    /// True if two bodies begin or cease to touch: along an axis whose gap is 0 they move relative to each other.
    pub fn is_changing(&self, touch: &Touch) -> bool {
        let moves = |axis: Axis| {
            self.approach_speed_sign(touch, axis) != Ordering::Equal
                || self.approach_acceleration(touch, axis).high != 0.0
        };
        match touch.kind {
            TouchKind::Face(axis) => moves(axis),
            TouchKind::Corner => Axis::BOTH.into_iter().any(moves),
        }
    }

    /// The axes along which a corner blocks: the gentler one, both if they are equal, none if it is not entered.
    pub fn blocked_axes(&self, touch: &Touch, motion: CornerMotion) -> [bool; 2] {
        let motions = Axis::BOTH.map(|axis| {
            let acceleration = match motion {
                CornerMotion::Moving => DoubleDouble::ZERO,
                CornerMotion::MovingOrFromRest => self.approach_acceleration(touch, axis),
            };
            [self.approach_speed(touch, axis), acceleration]
        });
        let enters = |[speed, acceleration]: [DoubleDouble; 2]| {
            speed.high > 0.0 || (speed.high == 0.0 && acceleration.high > 0.0)
        };
        if !motions.into_iter().all(enters) {
            return [false; 2];
        }
        let order = usize::from(motions.iter().all(|motion| motion[0].high == 0.0));
        let [x, y] = motions.map(|motion| motion[order]);
        let mut rounding = (x.high + y.high) * EQUAL_APPROACH;
        if order == 0 {
            let magnitude = |body: Local, axis: Axis| self.axis(body, axis).magnitudes.velocity;
            let magnitudes = touch.bodies.map(|body| magnitude(body, Axis::X) + magnitude(body, Axis::Y));
            rounding += (magnitudes[0] + magnitudes[1]) * VELOCITY_ROUNDING;
        }
        let difference = (x - y).high;
        if difference.abs() <= rounding { [true; 2] } else { [difference < 0.0, difference > 0.0] }
    }

    /// The touch of two bodies, if it is explored.
    pub fn touch_between(&self, body: Local, other: Local) -> Option<u32> {
        let touches_of = |body: Local| &self.bodies[body as usize].touches;
        // A floor has many.
        let (own, others) = (touches_of(body), touches_of(other));
        let (body, other, touches) = if own.len() <= others.len() { (body, other, own) } else { (other, body, others) };
        touches.iter().copied().find(|touch| self.touches[*touch as usize].other(body) == other)
    }

    /// The root of a body of finite mass in the forest of bodies connected by touching.
    pub fn root(&self, mut body: Local) -> Local {
        while self.bodies[body as usize].parent != body {
            body = self.bodies[body as usize].parent;
        }
        body
    }

    /// The root of the tree to which the bodies of a touch belong.
    pub fn root_of_touch(&self, touch: &Touch) -> Local {
        self.root(self.finite_of(touch.bodies))
    }

    /// The first of two bodies that has a finite mass.
    pub fn finite_of(&self, [first, second]: [Local; 2]) -> Local {
        if self.bodies[first as usize].infinite { second } else { first }
    }

    /// Joins the trees of two bodies of finite mass, the smaller below the larger, so that the paths to the roots stay
    /// short.
    fn join(&mut self, first: Local, second: Local) {
        let [first, second] = [self.root(first), self.root(second)];
        if first == second {
            return;
        }
        let [first_size, second_size] = [first, second].map(|root| self.bodies[root as usize].tree_size);
        let [root, child] = if first_size < second_size { [second, first] } else { [first, second] };
        let greatest = larger(self.bursts[root as usize].greatest, self.bursts[child as usize].greatest);
        self.bursts[root as usize].clear();
        self.bursts[root as usize].greatest = greatest;
        self.bodies[child as usize].parent = root;
        self.bodies[root as usize].tree_size = first_size + second_size;
    }

    /// Marks a body whose contacts along an axis must be examined.
    pub fn mark_dirty(&mut self, body: Local, axis: Axis) {
        let is_infinite = self.bodies[body as usize].infinite;
        let state = self.axis_mut(body, axis);
        if !is_infinite && !state.is_dirty {
            state.is_dirty = true;
            self.dirty[axis].push(body);
        }
    }

    /// Records that the velocity or acceleration of a body along an axis changed.
    #[inline]
    pub fn mark_changed(&mut self, body: Local, axis: Axis) {
        let state = self.axis_mut(body, axis);
        if !state.has_changed {
            state.has_changed = true;
            self.changed[axis].push(body);
        }
    }

    /// The first of the approaching touches.
    pub fn first_approaching(&mut self) -> Option<u32> {
        while let Some(Reverse((_, index))) = self.queue.peek().copied() {
            let touch = &mut self.touches[index as usize];
            if touch.approaches {
                return Some(index);
            }
            touch.is_queued = false;
            self.queue.pop();
        }
        None
    }

    /// Queues the touches of a body whose velocity along an axis changed, if they approach.
    pub fn refresh_along(&mut self, body: Local, axis: Axis) {
        let Patch { bodies, touches, queue, .. } = self;
        for index in &bodies[body as usize].touches {
            let touch = &mut touches[*index as usize];
            // Across the axis, only corners depend on the velocities along it.
            if touch.kind != TouchKind::Face(axis.other()) && touch.refresh(bodies) {
                queue.push(Reverse((touch.order(bodies), *index)));
            }
        }
    }

    /// True if a body touches another at a corner.
    pub fn touches_corner(&self, body: Local) -> bool {
        let mut touches = self.bodies[body as usize].touches.iter();
        self.has_corners && touches.any(|touch| self.touches[*touch as usize].kind == TouchKind::Corner)
    }

    /// The place of a touch in the order of impacts.
    #[inline]
    pub fn order_of(&self, index: u32) -> ImpactOrder {
        self.touches[index as usize].order(&self.bodies)
    }

    /// True if two of the bodies touch at a corner.
    #[inline]
    pub fn has_corners(&self) -> bool {
        self.has_corners
    }
}

/// A difference of the high parts of two velocities above this fraction of their magnitudes has the sign of the exact
/// one: the low parts are less than 2⁻⁵³ of them.
const CLEAR_SIGN: f64 = 1.0 / (1_u64 << 48) as f64;

/// Approaches along two axes that differ by less than this fraction are equal: 128 times the rounding of velocities.
const EQUAL_APPROACH: f64 = 1.0 / (1_u128 << 85) as f64;

impl EventDriven {
    /// The local index of a body, which is added to the patch with its state at an instant if necessary.
    #[inline]
    pub(super) fn local_of(&self, patch: &mut Patch, slot: Slot, at: Instant) -> Local {
        patch.find(slot, at).unwrap_or_else(|| self.add_local(patch, slot, at))
    }

    /// The local index of a body that is not in the patch, which is added to it.
    fn add_local(&self, patch: &mut Patch, slot: Slot, at: Instant) -> Local {
        let local = patch.insert(slot, self.bodies[slot].infinite, at);
        for axis in Axis::BOTH {
            self.set_local_axis(patch.axis_mut(local, axis), slot, axis, at);
        }
        local
    }

    /// Sets the state of a body along an axis at an instant. Not inlined: the states along both axes need more
    /// registers than there are, so that a heap of 10³ boxes needs 0.7 % more instructions.
    #[inline(never)]
    fn set_local_axis(&self, state: &mut LocalAxis, slot: Slot, axis: Axis, at: Instant) {
        let reference = self.bodies.reference(slot, axis);
        *state = LocalAxis::of(&reference.scaled_state_at(at, self.bodies.rounding()), reference.size);
    }

    /// Adds all bodies that touch a body of finite mass to the patch. Inlined, since most bodies are explored already.
    #[inline(always)]
    pub(super) fn explore(&mut self, patch: &mut Patch, body: Local) {
        if !patch.bodies[body as usize].infinite && !patch.bodies[body as usize].explored {
            self.find_touches(patch, body);
        }
    }

    /// Adds all bodies that touch a body to the patch, and their touches.
    #[inline(never)]
    fn find_touches(&mut self, patch: &mut Patch, body: Local) {
        patch.bodies[body as usize].explored = true;
        let mut neighbours = std::mem::take(&mut self.neighbour_buffer);
        let LocalBody { slot, at, .. } = patch.bodies[body as usize];
        let sample = Sample::new(&self.bodies[slot], at);
        self.find_touching(slot, &sample, &mut neighbours);
        for other in neighbours.slots() {
            self.examine_neighbour(patch, body, &sample, *other);
        }
        self.neighbour_buffer = neighbours;
    }

    /// Finds all bodies that may touch one at the instant of a sample, and possibly others. Always inlined, see
    /// [`WindowLists::find_neighbours`](super::window_lists::WindowLists::find_neighbours).
    #[inline(always)]
    pub(super) fn find_touching(&self, slot: Slot, sample: &Sample, neighbours: &mut NeighbourBuffer) {
        let is_in_window = self.window_lists.is_active();
        if !is_in_window && self.cell_lists.uses_all_pairs() {
            return self.cell_lists.find_others(slot, neighbours);
        }
        let reach = SweptAabb::new(sample, 0.0);
        if is_in_window {
            self.window_lists.find_neighbours(slot, &reach, neighbours);
        } else {
            self.cell_lists.find_neighbours(slot, sample.body, &reach, neighbours);
        }
    }

    /// Adds a neighbour to the patch if it touches the body.
    fn examine_neighbour(&self, patch: &mut Patch, body: Local, sample: &Sample, other: Slot) {
        let at = sample.at;
        let known = patch.find(other, at);
        if let Some(known) = known
            && (patch.bodies[known as usize].explored || patch.touch_between(body, known).is_some())
        {
            return;
        }
        if !sample.may_touch(&self.bodies[other]) {
            return;
        }
        let other = known.unwrap_or_else(|| self.add_local(patch, other, at));
        let [first, second] = if patch.bodies[body as usize].slot < patch.bodies[other as usize].slot {
            [body, other]
        } else {
            [other, body]
        };
        let Some((kind, side)) = touch_kind(patch, first, second, self.bodies.resolution()) else { return };
        let index = patch.touches.len() as u32;
        let mut touch = Touch {
            bodies: [first, second],
            kind,
            side,
            blocks: [false; 2],
            was_released: false,
            approaches: false,
            is_queued: false,
        };
        if touch.refresh(&patch.bodies) {
            patch.queue.push(Reverse((touch.order(&patch.bodies), index)));
        }
        patch.touches.push(touch);
        patch.has_corners |= kind == TouchKind::Corner;
        patch.bodies[first as usize].touches.push(index);
        patch.bodies[second as usize].touches.push(index);
        if !patch.bodies[first as usize].infinite && !patch.bodies[second as usize].infinite {
            patch.join(first, second);
        }
    }
}

/// The kind of the touch of two bodies, and for each axis the side of the first on which the second lies; `None` if
/// they do not touch.
fn touch_kind(patch: &Patch, first: Local, second: Local, resolution: Resolution) -> Option<(TouchKind, [Side; 2])> {
    let gaps = Axis::BOTH.map(|axis| {
        let [a, b] = [first, second].map(|body| patch.axis(body, axis));
        let offset = b.state.position - a.state.position;
        let [ahead, behind] = [offset - a.size, -offset - b.size];
        let (gap, side) = if behind.is_less(ahead) { (ahead, Side::High) } else { (behind, Side::Low) };
        let magnitude = a.magnitudes.position + b.magnitudes.position;
        (gap.or_zero(resolution.of_gap([a.size.high, b.size.high], magnitude)), side, magnitude)
    });
    let side = [gaps[0].1, gaps[1].1];
    let signs = [gaps[0].0.high, gaps[1].0.high];
    if signs[0] > 0.0 || signs[1] > 0.0 {
        return None;
    }
    let kind = match (signs[0] == 0.0, signs[1] == 0.0) {
        (true, true) => TouchKind::Corner,
        (true, false) => TouchKind::Face(Axis::X),
        (false, true) => TouchKind::Face(Axis::Y),
        (false, false) => {
            let axis = if signs[0] >= signs[1] { Axis::X } else { Axis::Y };
            if signs[axis] < -gaps[axis].2 * DEEPEST_ROUNDING {
                return None;
            }
            TouchKind::Face(axis)
        }
    };
    Some((kind, side))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn patch_of(count: u32) -> Patch {
        let mut patch = Patch::default();
        (0..count).for_each(|slot| _ = patch.insert(slot, false, Instant::START));
        patch
    }

    #[test]
    fn paths_to_roots_are_short_in_whichever_order_bodies_are_joined() {
        let orders: [fn(u32) -> u32; 3] = [|step| step, |step| 998 - step, |step| step * 7 % 999];
        for order in orders {
            let mut patch = patch_of(1000);
            for step in 0..999 {
                let body = order(step);
                patch.join(body, body + 1);
            }
            for mut body in 0..1000 {
                let mut length = 0;
                while patch.bodies[body as usize].parent != body {
                    body = patch.bodies[body as usize].parent;
                    length += 1;
                }
                assert!(length <= 10, "the path has {length} links");
            }
        }
    }
}
