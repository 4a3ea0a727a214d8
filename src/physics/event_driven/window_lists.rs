//! The broad phase of many bodies in undisturbed motion: for each body, a list of those that it can touch within a
//! window of some steps.
//!
//! At the start of a window each body gets a *home*: the rectangle that it sweeps until the end of the window, its
//! *path*, enlarged by a skin. Two bodies whose homes are disjoint cannot touch within the window as long as neither
//! leaves its home. So a list names the bodies whose homes overlap one's own, and within the window no grid is needed.
//! (Verlet, "Computer experiments on classical fluids", 1967, with a rectangle in place of a radius.)
//!
//! A body whose new path would leave its home becomes a *stray*: it gets another home, and is added to the lists of the
//! bodies whose homes that overlaps.
//!
//! The lists only select candidates for predictions. The length of a window and the skin influence no result.

use super::EventDriven;
use super::bodies::Bodies;
use super::body_state::{NONE, Slot};
use super::cell_lists::CellLists;
use super::event_queue::EventQueue;
use super::home_grid::{Band, HomeGrid};
use super::instant::{Clock, Instant};
use super::neighbour_buffer::NeighbourBuffer;
use super::pair_event::Sample;
use super::predict::PredictedEvent;
use super::swept_aabb::SweptAabb;
use super::threads::Threads;
use crate::physics::{larger, smaller};

/// The numbers on which speed depends, but no result.
#[derive(Clone, Copy, Debug)]
struct Tuning {
    /// With fewer bodies there is no window, since a step costs little with cell lists.
    min_bodies: usize,
    /// Steps without inputs after which a window may begin.
    calm_steps: u64,
    /// The displacement of a body in a window at the root mean squares of the speeds and accelerations, as a fraction
    /// of the greatest usual size.
    displacement: f64,
    /// The skin as a fraction of that displacement.
    skin: f64,
    /// The number of bodies in the parts of a new window that are worked on independently.
    bodies_per_part: usize,
    /// With fewer bodies, one thread is faster than several, whose processors would exchange the records.
    min_shared: usize,
}

impl Default for Tuning {
    fn default() -> Tuning {
        Tuning {
            min_bodies: 16,
            calm_steps: 16,
            displacement: 0.6,
            skin: 0.6,
            bodies_per_part: 4096,
            min_shared: 1 << 15,
        }
    }
}

/// The least skin as a fraction of the greatest usual size.
const MIN_SKIN: f64 = 1.0 / 32.0;

/// The greatest number of bodies from which the speeds and accelerations of all are estimated. An estimate suffices,
/// since it only determines the length of the window.
const SAMPLED_BODIES: usize = 256;

/// The rounding of homes and of the gaps between them, as a fraction of the coordinates.
const ROUNDING: f64 = 1.0 / (1_u64 << 20) as f64;

/// The shortest window, in steps: one of a single step does not pay.
const MIN_WINDOW: f64 = 2.0;

/// The longest window, in steps.
const MAX_WINDOW: f64 = 64.0;

/// The factor by which the cells are enlarged if too many homes are larger than they.
const WIDENING: f64 = 1.5;

/// With more strays than one for this number of bodies, the window ends at once.
const MIN_BODIES_PER_STRAY: usize = 4;

/// Steps after which a window may begin where one did not pay.
const RETRY_STEPS: u64 = 256;

/// The neighbour lists of a window.
///
/// Invariants: a body does not leave its path before `valid_until` unless its trajectory changes, and its path lies in
/// its home. Two bodies whose homes overlap are in each other's lists; only static bodies, which predict nothing, have
/// none. Two listed bodies whose paths overlap were predicted, up to `valid_until`, since the later of their latest
/// changes, unless the first of them has an event before that of the pair.
#[derive(Clone, Debug, Default)]
pub struct WindowLists {
    tuning: Tuning,
    /// The step at whose start the window ends; `None` if cell lists are in use.
    end: Option<u64>,
    /// The first step at which a window may begin.
    earliest: u64,
    /// The instant up to which paths are valid: somewhat after the end.
    valid_until: Instant,
    /// The greatest side of a body that is not an outlier, m.
    size: f64,
    /// The skin, m.
    skin: f64,
    /// The bodies that can move, in creation order.
    pub moving: Vec<Slot>,
    statics: Vec<Slot>,
    /// By slot.
    residents: Vec<Resident>,
    /// By slot.
    paths: Vec<SweptAabb>,
    /// The lists of the bodies in the grid, one after another.
    members: Vec<Slot>,
    /// Further entries of lists, each with the one before it in the same list.
    extras: Vec<(Slot, u32)>,
    /// Buffer for the events of the pairs whose paths overlap.
    pub events: Vec<Vec<PredictedEvent>>,
    grid: HomeGrid,
    /// Buffer for the pairs in the parts of the grid.
    bands: Vec<Band>,
    /// Buffer for the ends of the lists in `members`.
    ends: Vec<u32>,
    /// The moving bodies whose homes are larger than a cell.
    large: Vec<Slot>,
    /// Buffer for the bodies whose homes overlap one.
    found: NeighbourBuffer,
}

/// The record of a body in a window that only the body itself reads: half a cache line.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
struct Resident {
    home: SweptAabb,
    /// Its list as a range of [`WindowLists::members`].
    list: [u32; 2],
    /// The index in [`WindowLists::extras`] of the latest further entry of its list, or [`NONE`].
    latest_extra: u32,
}

impl Resident {
    /// A body with a home and no list.
    fn at(home: SweptAabb) -> Resident {
        Resident { home, list: [0; 2], latest_extra: NONE }
    }
}

impl WindowLists {
    /// True within a window.
    #[inline]
    pub fn is_active(&self) -> bool {
        self.end.is_some()
    }

    /// The instant up to which predictions are necessary.
    #[inline]
    pub fn valid_until(&self) -> Instant {
        self.valid_until
    }

    /// True if the window ends at the start of a step.
    pub fn is_over(&self, step: u64) -> bool {
        self.end.is_some_and(|end| end <= step)
    }

    /// True if a window may begin at the start of a step.
    pub fn may_begin(&self, step: u64) -> bool {
        self.end.is_none() && self.earliest <= step
    }

    /// Ends the window, frees the memory, and lets none begin before a step.
    pub fn end(&mut self, earliest: u64) {
        *self = WindowLists { tuning: self.tuning, earliest, ..WindowLists::default() };
    }

    /// Calls `visit` for each body in the list of one.
    #[inline]
    pub fn visit(&self, slot: Slot, mut visit: impl FnMut(Slot)) {
        self.members_of(slot).iter().for_each(|other| visit(*other));
        self.visit_extras(slot, visit);
    }

    /// The bodies in the list of one since the start of the window.
    #[inline]
    fn members_of(&self, slot: Slot) -> &[Slot] {
        let [start, end] = self.residents[slot as usize].list;
        &self.members[start as usize..end as usize]
    }

    /// Calls `visit` for each further entry of the list of a body. Inlined, since most lists have none.
    #[inline(always)]
    fn visit_extras(&self, slot: Slot, mut visit: impl FnMut(Slot)) {
        let mut next = self.residents[slot as usize].latest_extra;
        while next != NONE {
            let (other, previous) = self.extras[next as usize];
            visit(other);
            next = previous;
        }
    }

    /// Fills `buffer` with the bodies in the list of one whose paths overlap a rectangle.
    ///
    /// Always inlined, as is its caller `find_touching`: a gas of 10³ boxes needs 1.6 % fewer instructions.
    #[inline(always)]
    pub fn find_neighbours(&self, slot: Slot, rectangle: &SweptAabb, buffer: &mut NeighbourBuffer) {
        buffer.clear();
        let is_near = |other: Slot| !rectangle.is_disjoint_from(&self.paths[other as usize]);
        buffer.extend_by(self.members_of(slot), is_near);
        self.visit_extras(slot, |other| buffer.push_if(other, is_near(other)));
    }

    /// Reads the entries of a body, but not its list; returns a number that depends on them.
    #[inline]
    pub fn read_ahead(&self, slot: Slot) -> f64 {
        self.residents[slot as usize].home.longer_side()
    }

    /// The path of a body until the end of the window.
    #[inline]
    pub fn path(&self, slot: Slot) -> &SweptAabb {
        &self.paths[slot as usize]
    }

    /// The pairs of bodies whose paths overlapped at the start of the window, in lists; the first of a pair is to
    /// predict it.
    pub fn close_pairs(&self) -> impl ExactSizeIterator<Item = &[[Slot; 2]]> {
        self.bands.iter().map(Band::close_pairs)
    }

    /// The list of a body, sorted by slot.
    #[cfg(any(test, debug_assertions))]
    pub fn neighbours_of(&self, slot: Slot) -> Vec<Slot> {
        let mut all = Vec::new();
        self.visit(slot, |other| all.push(other));
        all.sort_unstable();
        all
    }

    /// Marks the path of a body as unknown after a change of its trajectory.
    #[inline]
    pub fn invalidate(&mut self, slot: Slot) {
        self.paths[slot as usize] = SweptAabb::EVERYWHERE;
    }

    /// Sets the path of a body from a sample on, and gives the body another home if it would leave its own. Returns the
    /// path.
    #[inline]
    pub fn set_path(&mut self, slot: Slot, sample: &Sample, step: u64) -> SweptAabb {
        let path = SweptAabb::new(sample, sample.at.seconds_until(self.valid_until));
        self.paths[slot as usize] = path;
        if !self.residents[slot as usize].home.contains(&path) {
            self.add_stray(slot, step);
        }
        path
    }

    /// Begins a window at an instant, the start of `step`; returns false if none pays.
    fn begin(&mut self, bodies: &Bodies, clock: &Clock, step: u64, now: Instant, threads: Threads) -> bool {
        let [speed, acceleration] = self.root_mean_squares(bodies, now);
        let distance = self.tuning.displacement * self.size;
        // The root of distance = speed·t + ½·acceleration·t².
        let seconds = 2.0 * distance / (speed + (speed * speed + 2.0 * acceleration * distance).sqrt());
        let mut steps = smaller(seconds / clock.period, MAX_WINDOW);
        let mut widening = 1.0;
        // False for NaN: then no window begins.
        while steps >= MIN_WINDOW {
            let end = step + steps as u64;
            let seconds = (end - step) as f64 * clock.period;
            let displacement = seconds * (speed + 0.5 * acceleration * seconds);
            self.skin = larger(displacement * self.tuning.skin, self.size * MIN_SKIN);
            self.end = Some(end);
            // Events at the end may be a little later than it.
            self.valid_until = clock.start_of(end).end_of_vicinity().after(clock.period / 16.0);
            self.set_homes(bodies, now, threads);
            // In a gas, almost no body is more than twice as fast along an axis.
            let side = widening * (self.size + 2.0 * (self.skin + displacement));
            if self.sort_homes(side, threads) {
                self.make_lists(threads);
                self.list_outside_grid();
                return true;
            }
            // In a heap, some bodies still fall when most are at rest. They fit into larger cells, or have smaller
            // homes in a shorter window.
            (widening, steps) = if widening < WIDENING { (WIDENING, steps) } else { (widening, steps / 2.0) };
        }
        false
    }

    /// Sorts the homes into cells of a side, m; returns false if lists do not pay with these cells.
    fn sort_homes(&mut self, side: f64, threads: Threads) -> bool {
        self.large.clear();
        let residents = &self.residents;
        self.grid.sort(side, &self.moving, |slot| &residents[slot as usize].home, &mut self.large, threads)
            && self.large.len() <= self.max_large()
    }

    /// The root mean squares of the speeds (m/s) and accelerations (m/s²) of the bodies that can move, estimated
    /// from some of them.
    fn root_mean_squares(&self, bodies: &Bodies, now: Instant) -> [f64; 2] {
        let [mut count, mut speeds, mut accelerations] = [0.0; 3];
        for slot in self.moving.iter().step_by(self.moving.len() / SAMPLED_BODIES + 1) {
            let trajectory = &bodies[*slot].trajectory;
            let ([_, [vx, vy]], [ax, ay]) = (trajectory.at(now), trajectory.acceleration);
            count += 1.0;
            speeds += vx * vx + vy * vy;
            accelerations += ax * ax + ay * ay;
        }
        [speeds, accelerations].map(|sum| (sum / count).sqrt())
    }

    /// Sets the paths until the end of the window, and the homes.
    fn set_homes(&mut self, bodies: &Bodies, now: Instant, threads: Threads) {
        self.residents.resize(bodies.len(), Resident::at(SweptAabb::EVERYWHERE));
        self.paths.resize(bodies.len(), SweptAabb::EVERYWHERE);
        let (seconds, skin) = (now.seconds_until(self.valid_until), self.skin as f32);
        let (mut moving, per_part) = (self.moving.as_slice(), self.tuning.bodies_per_part);
        let parts = self.residents.chunks_mut(per_part).zip(self.paths.chunks_mut(per_part)).enumerate();
        let parts = parts.map(|(index, records)| {
            let first = index * per_part;
            let (own, later) = moving.split_at(moving.partition_point(|slot| (*slot as usize) < first + per_part));
            moving = later;
            (first, own, records)
        });
        threads.share(parts, |(first, moving, (residents, paths))| {
            for slot in moving {
                let path = SweptAabb::new(&Sample::new(&bodies[*slot], now), seconds);
                paths[*slot as usize - first] = path;
                residents[*slot as usize - first] = Resident::at(path.enlarged(skin));
            }
        });
        for slot in &self.statics {
            let home = SweptAabb::new(&Sample::new(&bodies[*slot], now), 0.0);
            (self.residents[*slot as usize], self.paths[*slot as usize]) = (Resident::at(home), home);
        }
    }

    /// Makes the lists of the bodies in the grid, and finds the pairs whose paths overlap.
    fn make_lists(&mut self, threads: Threads) {
        self.extras.clear();
        let WindowLists { grid, bands, ends, members, residents, .. } = self;
        // A home is its path enlarged by the skin, and rounded.
        let distance = 2.0 * f64::from(self.skin as f32) - grid.extent() * ROUNDING;
        grid.divide(self.tuning.bodies_per_part, bands);
        grid.make_lists(distance as f32, bands, ends, members, threads, |slot, list| {
            residents[slot as usize].list = list;
        });
    }

    /// Adds the static bodies and those with large homes to the lists.
    fn list_outside_grid(&mut self) {
        let last_band = self.bands.len() - 1;
        let mut overlapping = std::mem::take(&mut self.found);
        for index in 0..self.statics.len() + self.large.len() {
            let (slot, later) = match index.checked_sub(self.statics.len()) {
                None => (self.statics[index], 0),
                Some(place) => (self.large[place], place + 1),
            };
            self.find_overlapping(slot, &mut overlapping);
            self.large[later..].iter().for_each(|other| overlapping.push_if(*other, self.overlaps(slot, *other)));
            for other in overlapping.slots() {
                self.add_extra(*other, slot);
                if later > 0 {
                    self.add_extra(slot, *other);
                }
                if !self.paths[slot as usize].is_disjoint_from(&self.paths[*other as usize]) {
                    self.bands[last_band].add_close_pair([*other, slot]);
                }
            }
        }
        self.found = overlapping;
    }

    /// Fills a buffer with the bodies in the grid, except the body itself, whose homes overlap that of a body, or did
    /// before they strayed.
    fn find_overlapping(&self, slot: Slot, buffer: &mut NeighbourBuffer) {
        buffer.clear();
        self.grid.visit_near(&self.residents[slot as usize].home, |other, overlaps| {
            buffer.push_if(other, overlaps & (other != slot));
        });
    }

    /// True if the homes of two bodies overlap.
    #[inline]
    fn overlaps(&self, slot: Slot, other: Slot) -> bool {
        !self.residents[slot as usize].home.is_disjoint_from(&self.residents[other as usize].home)
    }

    /// Adds a body to the list of a moving one.
    fn add_extra(&mut self, slot: Slot, other: Slot) {
        let latest = &mut self.residents[slot as usize].latest_extra;
        self.extras.push((other, *latest));
        *latest = self.extras.len() as u32 - 1;
    }

    /// Returns true if the list of a body names another.
    fn is_listed(&self, slot: Slot, other: Slot) -> bool {
        let mut is_listed = false;
        self.visit(slot, |listed| is_listed |= listed == other);
        is_listed
    }

    /// Gives a body that would leave its home another one, which contains its path, and enters it in the lists.
    #[cold]
    #[inline(never)]
    fn add_stray(&mut self, slot: Slot, step: u64) {
        let home = self.paths[slot as usize].enlarged(self.skin as f32);
        self.residents[slot as usize].home = home;
        let mut overlapping = std::mem::take(&mut self.found);
        self.find_overlapping(slot, &mut overlapping);
        for other in self.statics.iter().chain(&self.large) {
            overlapping.push_if(*other, (*other != slot) & self.overlaps(slot, *other));
        }
        for other in overlapping.slots() {
            if !self.is_listed(slot, *other) {
                self.add_extra(slot, *other);
                if self.statics.binary_search(other).is_err() {
                    self.add_extra(*other, slot);
                }
            }
        }
        self.found = overlapping;
        if !self.grid.add_stray(slot, &home) {
            self.large.push(slot);
        }
        if self.grid.strays() > self.moving.len() / MIN_BODIES_PER_STRAY || self.large.len() > self.max_large() {
            self.end = Some(step + 1);
        }
    }

    /// The greatest number of large homes with which a window pays: each of them is compared with all others.
    fn max_large(&self) -> usize {
        16 + self.moving.len() / 32
    }
}

impl EventDriven {
    /// Begins a window at the start of a step if the last one is over, or if one may begin and pays.
    pub(super) fn begin_window(&mut self, step: u64) {
        if self.window_lists.is_over(step) {
            if self.window_lists.begin(
                &self.bodies,
                self.timeline.clock(),
                step,
                self.timeline.now(),
                self.threads_of_window(),
            ) {
                self.predict_close_pairs();
            } else {
                self.leave_window(RETRY_STEPS);
            }
            self.predict_changed();
        } else if self.window_lists.may_begin(step) && self.bodies.len() >= self.window_lists.tuning.min_bodies {
            let (statics, moving) = self.bodies.alive().partition(|slot| self.bodies[*slot].is_static());
            let size = self.bodies.largest_usual_size();
            let tuning = self.window_lists.tuning;
            let mut lists = WindowLists { tuning, size, moving, statics, ..WindowLists::default() };
            if !lists.begin(&self.bodies, self.timeline.clock(), step, self.timeline.now(), self.threads_of_window()) {
                self.window_lists.end(step + RETRY_STEPS);
                return;
            }
            self.changed.extend(&lists.moving);
            self.window_lists = lists;
            self.cell_lists = CellLists::new(1.0);
            self.event_queue = EventQueue::new(*self.timeline.clock(), step, self.bodies.len());
            self.predict_changed();
        }
    }

    /// The threads that work on the start of a window.
    pub(super) fn threads_of_window(&self) -> Threads {
        if self.bodies.len() < self.window_lists.tuning.min_shared { Threads::ONE } else { self.threads }
    }

    /// Returns to cell lists, for a number of steps at least. All bodies must predict again.
    pub(super) fn leave_window(&mut self, steps: u64) {
        self.rebuild_indices();
        self.window_lists.end(self.timeline.step() + steps);
        let is_inserted = |slot: &Slot| self.pending_spawns.binary_search(slot).is_err();
        self.changed.extend(self.bodies.alive().filter(is_inserted));
    }

    /// Prepares the broad phase for an input before `step`: windows are for undisturbed motion.
    pub(super) fn disturb_window(&mut self, step: u64) {
        let calm_steps = self.window_lists.tuning.calm_steps;
        if self.window_lists.is_active() {
            self.begin_at(step);
            self.leave_window(calm_steps);
        } else {
            self.window_lists.end(step + calm_steps);
        }
    }

    /// Checks the invariants of the lists.
    ///
    /// # Panics
    /// If a body is not at home, or a pair with overlapping homes is not in its lists.
    #[cfg(any(test, debug_assertions))]
    pub(super) fn assert_lists(&self) {
        let lists = &self.window_lists;
        for slot in lists.moving.iter().chain(&lists.statics) {
            let body = SweptAabb::new(&Sample::new(&self.bodies[*slot], self.timeline.now()), 0.0);
            let home = lists.residents[*slot as usize].home;
            assert!(home.contains(&lists.paths[*slot as usize]), "the path of {slot} leaves its home");
            assert!(
                home.enlarged(1e-3 * lists.skin as f32).contains(&body),
                "{slot} is not at home: {home:?}, {body:?}"
            );
            for other in lists.moving.iter().filter(|other| *other != slot && lists.overlaps(*slot, **other)) {
                assert!(lists.neighbours_of(*other).contains(slot), "{other} does not list {slot}");
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::event_driven::pseudo_random::PseudoRandom;
    use crate::physics::{Body, Engine, EngineConfig, Event, Rect, Restitution, SolverKind, Spawn, Vector};
    use std::num::NonZero;

    fn spawn(at: [f64; 2], size: [f64; 2], mass: f64, velocity: [f64; 2]) -> Spawn {
        let rect = Rect::new(Vector::new(at[0], at[1]), size[0], size[1]);
        let velocity = Vector::new(velocity[0], velocity[1]);
        Spawn { name: String::new(), rect, mass, velocity, force: Vector::ZERO, material: String::new() }
    }

    /// A room for a hundred boxes.
    struct Room {
        /// The upper-left corner, m.
        origin: [f64; 2],
        /// The side, m; the boxes have sides of up to a 24th of it.
        side: f64,
        /// The greater, the more sizes, masses, speeds and forces of the boxes differ.
        variety: f64,
    }

    impl Room {
        fn random(random: &mut PseudoRandom) -> Room {
            let side = random.pick(&[24.0, 24.0, 0.024, 24e6]);
            let distance = side * random.pick(&[0.0, -0.5, 3000.0]);
            Room { origin: [distance, -0.5 * distance], side, variety: random.pick(&[0.0, 0.7, 0.7]) }
        }

        /// A box in the room, with its corner at fractions of the side.
        fn member(&self, random: &mut PseudoRandom, place: [f64; 2]) -> Spawn {
            let unit = self.side / 24.0;
            let at = [0, 1].map(|axis| self.origin[axis] + place[axis] * self.side);
            let size = [0, 1].map(|_| unit * (1.0 - self.variety * random.next()));
            let fast = if random.next() < 0.02 * self.variety { 40.0 } else { 1.0 };
            let is_platform = random.next() < 0.03 * self.variety;
            let mass = if is_platform { f64::INFINITY } else { 1.0 + 9.0 * self.variety * random.next() };
            let speed = unit * if is_platform { random.pick(&[0.0, 0.0, 0.3]) } else { 4.0 * fast };
            let velocity = [0, 1].map(|_| speed * random.between(-1.0, 1.0));
            let has_force = self.variety > 0.0 && random.next() < 0.1;
            let force = if has_force { Vector::new(unit * random.between(-5.0, 5.0), 0.0) } else { Vector::ZERO };
            Spawn { force, ..spawn(at, size, mass, velocity) }
        }

        /// An engine with walls and a hundred boxes in the room.
        fn crowd(&self, random: &mut PseudoRandom) -> Engine {
            let (side, unit) = (self.side, self.side / 24.0);
            let gravity = random.pick(&[None, Some(Vector::new(0.0, 9.81 * unit))]);
            let restitution = Restitution::new(random.pick(&[1.0, 0.4]), &[]);
            let config = EngineConfig::new(SolverKind::EventDriven, random.pick(&[60.0, 60.0, 10.0, 997.0]));
            let mut engine = Engine::new(config.with_gravity(gravity).with_restitution(restitution));
            let [left, top] = self.origin;
            for (at, size) in [
                ([left - unit, top - unit], [side + 2.0 * unit, unit]),
                ([left - unit, top + side], [side + 2.0 * unit, unit]),
                ([left - unit, top], [unit, side]),
                ([left + side, top], [unit, side]),
            ] {
                engine.apply(&Event::Spawn(spawn(at, size, f64::INFINITY, [0.0; 2])));
            }
            for index in 0..100 {
                let field = [index % 10, index / 10].map(|place| f64::from(place) / 10.0);
                let place = field.map(|low| low + random.between(0.0, 0.1 - 1.0 / 24.0));
                engine.apply(&Event::Spawn(self.member(random, place)));
            }
            engine
        }
    }

    fn bits(engine: &Engine) -> Vec<[u64; 4]> {
        let numbers = |body: &Body| [body.rect.origin.x, body.rect.origin.y, body.velocity.x, body.velocity.y];
        engine.world().bodies.iter().map(|body| numbers(body).map(f64::to_bits)).collect()
    }

    #[test]
    fn windows_change_no_bit() {
        let never = Tuning { min_bodies: usize::MAX, ..Tuning::default() };
        let usual = Tuning { calm_steps: 2, ..Tuning::default() };
        let long = Tuning { displacement: 3.0, ..usual };
        let without_skin = Tuning { skin: 0.0, ..usual };
        let in_parts = Tuning { bodies_per_part: 7, min_shared: 0, ..usual };
        let tunings = [never, usual, long, without_skin, in_parts];
        let mut windows = [0; 5];
        for seed in 0..if cfg!(debug_assertions) { 3 } else { 60 } {
            let mut random = PseudoRandom(seed);
            let room = Room::random(&mut random);
            let crowd = room.crowd(&mut random);
            let mut engines = tunings.map(|tuning| {
                let mut engine = crowd.clone();
                let solver = engine.event_driven_mut();
                solver.window_lists.tuning = tuning;
                solver.threads = Threads::new(NonZero::new(if tuning.bodies_per_part < 100 { 3 } else { 1 }));
                engine
            });
            for step in 0..120 {
                if random.next() < 0.04 {
                    let ids: Vec<_> = engines[0].world().bodies.iter().map(|body| body.id).collect();
                    let id = ids[4 + (random.next() * (ids.len() - 4) as f64) as usize];
                    engines.iter_mut().for_each(|engine| engine.apply(&Event::Delete(id)));
                }
                if random.next() < 0.04 {
                    let place = [0, 1].map(|_| random.between(0.0, 23.0 / 24.0));
                    let spawn = room.member(&mut random, place);
                    engines.iter_mut().for_each(|engine| engine.apply(&Event::Spawn(spawn.clone())));
                }
                let errors = engines.each_mut().map(|engine| engine.step(&mut Vec::new()).err());
                assert!(errors.iter().all(|error| *error == errors[0]), "seed {seed}, step {step}: {errors:?}");
                if errors[0].is_some() {
                    break; // A platform crushed a box.
                }
                for (engine, windows) in engines.iter_mut().zip(&mut windows) {
                    let solver = engine.event_driven_mut();
                    *windows += u32::from(solver.window_lists.is_active());
                    solver.assert_lists();
                }
                let [expected, others @ ..] = engines.each_ref().map(bits);
                for (other, tuning) in others.iter().zip(&tunings[1..]) {
                    assert!(*other == expected, "seed {seed}, step {step}: {tuning:?}");
                }
            }
        }
        assert!(windows[0] == 0 && windows[1..].iter().all(|steps| *steps > 100), "steps in windows: {windows:?}");
    }
}
