use super::axes::Range;
use super::timeline::Timeline;
use crate::physics::{Axis, Body, BodyId, Collision, Observer, Rect, Side, Vector, World, larger, smaller};
use crate::picture::Appearance;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The pressure of a gas on the sides of walls and pistons during one run: impulse per time and length, N/m. Memory is
/// bounded by [`MAX_BODIES`], whatever the number of states and collisions.
#[derive(Clone, Debug, PartialEq)]
pub struct PressureRun {
    /// Title, shown if there are several runs.
    pub title: String,
    /// Spawns, deletes and gaps.
    pub timeline: Timeline,
    /// Width and height of the world, m.
    world: Vector,
    /// The time shown, s.
    pub(super) time: Range,
    /// The bodies on which the pressure is shown, which also bound the volume.
    walls: BTreeMap<BodyId, Arc<Appearance>>,
    pub(super) sides: Vec<WallSide>,
    /// ∫ length dt of the sides of each wall, by the axis of their normal, m·s.
    lengths: BTreeMap<BodyId, [Slices; 2]>,
    /// The time with a known volume, s, ∫ V dt in it, m²·s, and ∫ Σ m·v² dt along each axis, J·s.
    known: Slices,
    volume: Slices,
    kinetic: [Slices; 2],
    /// The least and the greatest volume, m².
    pub(super) volumes: Option<Range>,
    last: Option<Sample>,
}

/// A side of a wall that bodies have hit.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct WallSide {
    /// The name of the wall. Walls of the same name, one after the other, are the same.
    pub(super) name: String,
    pub(super) axis: Axis,
    pub(super) side: Side,
    /// The impulses, N·s.
    impulse: Slices,
    pub(super) count: u64,
    /// True if the wall ever moves.
    pub(super) is_moving: bool,
}

/// A quantity in slices of equal duration, which are joined to the intervals of a diagram.
type Slices = Vec<f64>;

/// The number of slices of a run. It is divisible by many numbers of intervals.
const SLICES: usize = 2520;

/// The largest number of bodies on which the pressure is shown, which bounds memory.
pub const MAX_BODIES: usize = 64;

/// The largest number of sides that a diagram shows.
pub const MAX_SIDES: usize = 12;

/// The properties of a state that the pressure depends on.
#[derive(Clone, Debug, PartialEq)]
struct Sample {
    time: f64,
    /// m².
    volume: Option<f64>,
    /// Σ m·v² along each axis, J.
    kinetic: [f64; 2],
    /// The lengths of the sides of each wall, by the axis of their normal, m.
    lengths: Vec<(BodyId, [f64; 2])>,
}

impl PressureRun {
    /// Creates a run without states in a world of `world` metres, for the pressure on `walls` in a time range, s.
    pub fn new(title: String, world: Vector, time: Range, walls: BTreeMap<BodyId, Arc<Appearance>>) -> PressureRun {
        let slices = || vec![0.0; SLICES];
        PressureRun {
            title,
            timeline: Timeline::default(),
            world,
            time,
            walls,
            sides: Vec::new(),
            lengths: BTreeMap::new(),
            known: slices(),
            volume: slices(),
            kinetic: [slices(), slices()],
            volumes: None,
            last: None,
        }
    }

    /// Adds a state; times must not decrease. Between two states, all changes uniformly.
    pub fn push(&mut self, time: f64, world: &World) {
        let volume = self.gas_area(world);
        let is_wall = |body: &&Body| self.walls.contains_key(&body.id);
        let gas = || world.bodies.iter().filter(|body| !body.is_infinite() && !is_wall(body));
        let kinetic = Axis::BOTH
            .map(|axis| gas().fold(0.0, |sum, body| sum + body.mass * body.velocity[axis] * body.velocity[axis]));
        let enclosure = self.enclosure(world);
        let visible = enclosure.unwrap_or(Rect::new(Vector::ZERO, self.world.x, self.world.y));
        let length = |body: &Body, axis: Axis| {
            let (within, [from, to]) = (body.rect.overlap_along(axis.other(), &visible), body.rect.along(axis.other()));
            if within > 0.0 { within } else { to - from }
        };
        let walls = world.bodies.iter().filter(is_wall);
        let lengths = walls.map(|body| (body.id, Axis::BOTH.map(|axis| length(body, axis)))).collect();
        let moving = world.bodies.iter().filter(|body| is_wall(body) && body.velocity != Vector::ZERO);
        for name in moving.filter_map(|body| Some(&self.walls.get(&body.id)?.name)) {
            self.sides.iter_mut().filter(|side| side.name == *name).for_each(|side| side.is_moving = true);
        }
        let sample = Sample { time, volume, kinetic, lengths };
        if let Some(last) = self.last.take() {
            self.add_interval(&last, &sample);
        }
        self.last = Some(sample);
    }

    /// Interrupts the run: nothing is known of the time before the next state.
    pub fn interrupt(&mut self) {
        self.last = None;
    }

    /// The rectangle that contains the gas: the smallest one each of whose sides lies on a wall along its whole length,
    /// up to gaps at its ends through which no body of the gas fits. A body inside of it, which the gas can pass, is no
    /// bound, wherever the gas is. `None` if there is no gas, or a side has no such wall.
    fn enclosure(&self, world: &World) -> Option<Rect> {
        let is_bound = |body: &&Body| body.is_infinite() || self.walls.contains_key(&body.id);
        let gas = || world.bodies.iter().filter(|body| !is_bound(body)).map(|body| body.rect);
        let centers = gas().map(|rect| Rect::new(rect.center(), 0.0, 0.0)).reduce(|all, at| all.union(&at))?;
        let smallest = Axis::BOTH.map(|axis| {
            let sizes = gas().map(|rect| rect.along(axis)).map(|[from, to]| to - from);
            sizes.fold(f64::INFINITY, smaller)
        });
        // First the walls along the gas bound it. Those that do not extend along the rectangle that they bound are then
        // left out, which enlarges it.
        let mut enclosure = centers;
        loop {
            let bounds = Axis::BOTH.map(|axis| {
                let ([low, high], [from, to]) = (centers.along(axis), enclosure.along(axis.other()));
                let spans = |body: &&Body| {
                    let [start, end] = body.rect.along(axis.other());
                    larger(start - from, to - end) < smallest[axis.other()]
                };
                let walls = || world.bodies.iter().filter(is_bound).filter(spans).map(|body| body.rect.along(axis));
                let before = walls().map(|wall| wall[1]).filter(|end| *end <= low).reduce(larger);
                let after = walls().map(|wall| wall[0]).filter(|start| *start >= high).reduce(smaller);
                before.zip(after)
            });
            let [(left, right), (top, bottom)] = [bounds[0]?, bounds[1]?];
            let next = Rect::new(Vector::new(left, top), right - left, bottom - top);
            if next == enclosure {
                return Some(enclosure);
            }
            enclosure = next;
        }
    }

    /// The area that the gas can take, m²: that of the enclosure without the walls inside it.
    fn gas_area(&self, world: &World) -> Option<f64> {
        let enclosure = self.enclosure(world)?;
        let inside = |body: &Body| {
            let common = body.rect.intersection(&enclosure).filter(|_| body.is_infinite());
            common.map_or(0.0, |common| common.width() * common.height())
        };
        let area = world.bodies.iter().fold(enclosure.width() * enclosure.height(), |area, body| area - inside(body));
        Some(area).filter(|area| *area > 0.0)
    }

    /// Adds the time between two states.
    fn add_interval(&mut self, from: &Sample, to: &Sample) {
        let span = [from.time, to.time];
        if to.time <= from.time {
            return;
        }
        for (id, first) in &from.lengths {
            let last = to.lengths.iter().find(|(other, _)| other == id).map_or(first, |(_, lengths)| lengths);
            let lengths = self.lengths.entry(*id).or_insert_with(|| [vec![0.0; SLICES], vec![0.0; SLICES]]);
            for axis in Axis::BOTH {
                distribute(&mut lengths[axis], self.time, span, (first[axis] + last[axis]) / 2.0);
            }
        }
        let Some((first, last)) = from.volume.zip(to.volume) else { return };
        let volumes = self.volumes.unwrap_or(Range { from: first, to: first });
        self.volumes = Some(volumes.including(first).including(last));
        distribute(&mut self.known, self.time, span, 1.0);
        distribute(&mut self.volume, self.time, span, (first + last) / 2.0);
        for axis in Axis::BOTH {
            distribute(&mut self.kinetic[axis], self.time, span, (from.kinetic[axis] + to.kinetic[axis]) / 2.0);
        }
    }

    /// The number of sides that were hit.
    pub fn side_count(&self) -> usize {
        self.sides.len()
    }

    /// Returns true if the volume is known and changes.
    pub(super) fn has_changing_volume(&self) -> bool {
        self.volumes.is_some_and(|volumes| volumes.to - volumes.from > 1e-6 * volumes.to)
    }

    /// The total impulse on the sides of a wall, N·s.
    pub fn impulse(&self, name: &str) -> f64 {
        self.sides.iter().filter(|side| side.name == name).flat_map(|side| &side.impulse).sum()
    }

    /// The mean pressure on all sides that are perpendicular to an axis, N/m; `None` if none was hit.
    pub fn mean_pressure(&self, axis: Axis) -> Option<f64> {
        let sides = || self.sides.iter().filter(|side| side.axis == axis);
        let impulse: f64 = sides().flat_map(|side| &side.impulse).sum();
        let length: f64 = sides().flat_map(|side| self.length(side, 0..SLICES)).sum();
        (length > 0.0).then(|| impulse / length)
    }

    /// The mean of Σ m·v² along an axis divided by that of the volume, N/m: the pressure of an ideal gas, p·V =
    /// N·m·⟨v²⟩/2 in two dimensions. `None` if the volume is not known.
    pub fn ideal_pressure(&self, axis: Axis) -> Option<f64> {
        let [kinetic, volume] = [&self.kinetic[axis], &self.volume].map(|slices| slices.iter().sum::<f64>());
        (volume > 0.0).then(|| kinetic / volume)
    }

    /// ∫ length dt of a side in each of some slices, m·s.
    fn length<'a>(&'a self, side: &'a WallSide, slices: std::ops::Range<usize>) -> impl Iterator<Item = f64> + 'a {
        let walls = self.walls.iter().filter(move |(_, wall)| wall.name == side.name);
        let of_wall =
            move |(id, _): (&BodyId, &Arc<Appearance>)| self.lengths.get(id).map(|lengths| &lengths[side.axis]);
        walls.filter_map(of_wall).flat_map(move |lengths| lengths[slices.clone()].iter().copied())
    }

    /// The pressure on a side in each of `count` intervals, N/m; `None` where there is no wall.
    pub(super) fn pressures(&self, side: &WallSide, count: usize) -> Vec<Option<f64>> {
        let interval = |number: usize| {
            let slices = slices_of(number, count);
            let length: f64 = self.length(side, slices.clone()).sum();
            (length > 0.0).then(|| side.impulse[slices].iter().sum::<f64>() / length)
        };
        (0..count).map(interval).collect()
    }

    /// The pressure of an ideal gas of the same kinetic energy along an axis, N/m, and the mean volume, m², in each of
    /// `count` intervals; `None` where the volume is not known.
    pub(super) fn ideal(&self, axis: Axis, count: usize) -> Vec<Option<[f64; 2]>> {
        let sum = |slices: &Slices, number: usize| slices[slices_of(number, count)].iter().sum::<f64>();
        let interval = |number: usize| {
            let (known, volume) = (sum(&self.known, number), sum(&self.volume, number));
            (known > 0.0).then(|| [sum(&self.kinetic[axis], number) / volume, volume / known])
        };
        (0..count).map(interval).collect()
    }

    /// The spans of each of `count` intervals in which a side exists and is recorded, s.
    pub(super) fn spans_of(&self, side: &WallSide, count: usize) -> Vec<Vec<[f64; 2]>> {
        let is_known = |slice: usize| self.length(side, slice..slice + 1).any(|length| length > 0.0);
        (0..count).map(|number| self.spans(slices_of(number, count), is_known)).collect()
    }

    /// The spans of each of `count` intervals in which the volume is known, s.
    pub(super) fn ideal_spans(&self, count: usize) -> Vec<Vec<[f64; 2]>> {
        let is_known = |slice: usize| self.known[slice] > 0.0;
        (0..count).map(|number| self.spans(slices_of(number, count), is_known)).collect()
    }

    /// The spans of some slices that `is_known` accepts, without the gaps of the recording, s.
    fn spans(&self, slices: std::ops::Range<usize>, is_known: impl Fn(usize) -> bool) -> Vec<[f64; 2]> {
        let time = |slice: usize| self.time.from + (self.time.to - self.time.from) * slice as f64 / SLICES as f64;
        let mut spans: Vec<[f64; 2]> = Vec::new();
        for slice in slices.filter(|slice| is_known(*slice)) {
            let [from, to] = [slice, slice + 1].map(time);
            match spans.last_mut().filter(|last| last[1] == from) {
                Some(last) => last[1] = to,
                None => spans.push([from, to]),
            }
        }
        for [start, end] in self.timeline.gaps.iter().map(|gap| gap.times) {
            let around = |[from, to]: [f64; 2]| [[from, smaller(to, start)], [larger(from, end), to]];
            spans = spans.into_iter().flat_map(around).filter(|[from, to]| from < to).collect();
        }
        spans
    }
}

impl Observer for PressureRun {
    fn collision(&mut self, collision: &Collision) {
        if collision.impulse == 0.0 || collision.instant < self.time.from || collision.instant > self.time.to {
            return;
        }
        for (at, id) in collision.bodies.iter().enumerate() {
            let Some(wall) = self.walls.get(id) else { continue };
            // The normal points away from the side of the first body that was hit, and towards that of the second one.
            let is_low = (collision.normal[collision.axis] > 0.0) == (at == 0);
            let (axis, side) = (collision.axis, if is_low { Side::Low } else { Side::High });
            let is_same = |hit: &WallSide| hit.name == wall.name && hit.axis == axis && hit.side == side;
            let place = self.sides.iter().position(is_same).unwrap_or_else(|| {
                let impulse = if self.sides.len() < MAX_SIDES { vec![0.0; SLICES] } else { Vec::new() };
                let name = wall.name.clone();
                self.sides.push(WallSide { name, axis, side, impulse, count: 0, is_moving: false });
                self.sides.len() - 1
            });
            let hit = &mut self.sides[place];
            hit.is_moving |= collision.before[at] != Vector::ZERO;
            hit.count += 1;
            let slice = slice_at(self.time, collision.instant).floor() as usize;
            if let Some(impulse) = hit.impulse.get_mut(slice.min(SLICES - 1)) {
                *impulse += collision.impulse.abs();
            }
        }
    }
}

/// The position of a time in a range, in slices.
fn slice_at(range: Range, time: f64) -> f64 {
    (time - range.from) / (range.to - range.from) * SLICES as f64
}

/// The slices of one of `count` intervals.
fn slices_of(number: usize, count: usize) -> std::ops::Range<usize> {
    number * SLICES / count..(number + 1) * SLICES / count
}

/// Adds the integral of a constant over a time span, s, to the slices of a time range.
fn distribute(slices: &mut Slices, range: Range, span: [f64; 2], value: f64) {
    let [from, to] = span.map(|time| slice_at(range, time).clamp(0.0, SLICES as f64));
    let duration = (range.to - range.from) / SLICES as f64;
    let (first, last) = (from.floor() as usize, (to.ceil() as usize).min(SLICES));
    for (number, slice) in slices.iter_mut().enumerate().take(last).skip(first) {
        let part = smaller(to, number as f64 + 1.0) - larger(from, number as f64);
        *slice += value * part * duration;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::{Engine, EngineConfig, Event, SolverKind, Spawn};
    use crate::picture::trace::{GapReason, TraceGap};
    use crate::recording::BodyInfo;

    /// A closed box of 4 m × 3 m with walls of these names and bodies of this mass at positions with velocities.
    fn run(mass: f64, bodies: &[([f64; 2], [f64; 2])], steps: u64) -> (PressureRun, Vec<Collision>) {
        let mut engine = Engine::new(EngineConfig::new(SolverKind::EventDriven, 10.0));
        let mut walls = BTreeMap::new();
        for (id, (name, [x, y, width, height])) in [
            ("left", [-1.0, -1.0, 1.0, 5.0]),
            ("right", [4.0, -1.0, 1.0, 5.0]),
            ("top", [-1.0, -1.0, 6.0, 1.0]),
            ("bottom", [-1.0, 3.0, 6.0, 1.0]),
        ]
        .into_iter()
        .enumerate()
        {
            let spawn = Spawn::new(name, Rect::new(Vector::new(x, y), width, height), f64::INFINITY);
            walls.insert(id as BodyId, Arc::new(Appearance::new(&BodyInfo::new(id as BodyId, spawn.clone()), None)));
            engine.apply(&Event::Spawn(spawn));
        }
        for (number, ([x, y], [vx, vy])) in bodies.iter().enumerate() {
            let rect = Rect::new(Vector::new(*x, *y), SIZE, SIZE);
            let spawn = Spawn::new(format!("#{number}"), rect, mass).with_velocity(Vector::new(*vx, *vy));
            engine.apply(&Event::Spawn(spawn));
        }
        let time = Range { from: 0.0, to: steps as f64 / 10.0 };
        let mut run = PressureRun::new(String::new(), Vector::new(4.0, 3.0), time, walls);
        let mut collisions = Vec::new();
        for step in 0..=steps {
            run.push(step as f64 / 10.0, engine.world());
            if step < steps {
                let mut new: Vec<Collision> = Vec::new();
                engine.step(&mut new).unwrap();
                new.iter().for_each(|collision| run.collision(collision));
                collisions.extend(new);
            }
        }
        (run, collisions)
    }

    const SIZE: f64 = 1e-3;

    #[test]
    fn bodies_without_collisions_among_each_other_have_the_pressure_of_an_ideal_gas() {
        // Each body has a row or a column of its own, and returns to its place after whole periods.
        let rows =
            (0..20).map(|at| ([0.5 + 0.1 * f64::from(at), 0.1 * f64::from(at) + 0.05], [f64::from(at % 5 + 1), 0.0]));
        let bodies: Vec<_> = rows.collect();
        let (run, _) = run(2.0, &bodies, 4800);
        let (measured, ideal) = (run.mean_pressure(Axis::X).unwrap(), run.ideal_pressure(Axis::X).unwrap());
        // The closed form: Σ m·v²/V, with the way that a body of finite size has between the walls.
        let squares: f64 = bodies.iter().map(|(_, [vx, _])| 2.0 * vx * vx).sum();
        assert!((ideal - squares / 12.0).abs() < 1e-9 * ideal, "{ideal}");
        assert!((measured - squares / (3.0 * (4.0 - SIZE))).abs() < 2e-3 * measured, "{measured} {ideal}");
        assert_eq!(run.mean_pressure(Axis::Y), None);
    }

    #[test]
    fn the_impulse_on_a_wall_is_the_sum_of_its_collisions() {
        let bodies: Vec<_> = (0..30_i32)
            .map(|at| {
                let place = [0.1 + 0.6 * f64::from(at % 6), 0.1 + 0.55 * f64::from(at / 6)];
                (place, [f64::from(at * 7 % 11) - 5.0, f64::from(at * 5 % 13) - 6.0])
            })
            .collect();
        let (run, collisions) = run(0.5, &bodies, 300);
        for (id, name) in [(0, "left"), (1, "right"), (2, "top"), (3, "bottom")] {
            let of_wall = collisions.iter().filter(|collision| collision.bodies.contains(&id));
            let sum: f64 = of_wall.map(|collision| collision.impulse.abs()).sum();
            assert!(sum > 10.0 && (run.impulse(name) - sum).abs() < 1e-9 * sum, "{name}: {sum}");
        }
        // The virial theorem holds for the mean, up to the finite time.
        let [x, y] = Axis::BOTH.map(|axis| run.mean_pressure(axis).unwrap() / run.ideal_pressure(axis).unwrap());
        assert!((x - 1.0).abs() < 0.05 && (y - 1.0).abs() < 0.05, "{x} {y}");
    }

    #[test]
    fn integrals_over_time_are_independent_of_the_slices() {
        let mut slices = vec![0.0; SLICES];
        let range = Range { from: 1.0, to: 8.0 };
        for at in 0..997 {
            let [from, to] = [at, at + 1].map(|at| 1.0 + 7.0 * f64::from(at) / 997.0);
            distribute(&mut slices, range, [from, to], 3.0);
        }
        assert!((slices.iter().sum::<f64>() - 21.0).abs() < 1e-9);
        assert!(slices.iter().all(|slice| (slice - 21.0 / SLICES as f64).abs() < 1e-9));
        let all: Vec<usize> = (0..60).flat_map(|number| slices_of(number, 60)).collect();
        assert_eq!(all, (0..SLICES).collect::<Vec<usize>>());
    }

    #[test]
    fn intervals_end_at_gaps_and_where_a_wall_ends() {
        let body = ([1.0, 1.0], [2.0, 0.0]);
        let (mut run, _) = run(1.0, &[body], 70);
        let gap = |from: u64, to: u64| {
            let times = [from, to].map(|step| step as f64 / 10.0);
            TraceGap { steps: from + 1..=to - 1, times, reason: GapReason::Lost }
        };
        run.timeline.gaps = vec![gap(3, 12), gap(30, 31)];
        let side = run.sides[0].clone();
        let spans = run.spans_of(&side, 7);
        assert_eq!(spans[..2], [vec![[0.0, 0.3]], vec![[1.2, 2.0]]]);
        assert_eq!((&spans[2], &spans[3]), (&vec![[2.0, 3.0]], &vec![[3.1, 4.0]]));
        assert_eq!(run.ideal_spans(7), spans);
        // The wall is deleted at 5 s.
        run.lengths.values_mut().flatten().for_each(|lengths| lengths[SLICES * 5 / 7 + 90..].fill(0.0));
        let spans = run.spans_of(&side, 7);
        assert_eq!((&spans[5], spans[6].len()), (&vec![[5.0, 5.25]], 0));
    }

    #[test]
    fn a_block_inside_of_the_room_is_no_bound_and_a_piston_with_a_narrow_gap_is_one() {
        let wall = |name: &str, [x, y, width, height]: [f64; 4]| {
            Spawn::new(name, Rect::new(Vector::new(x, y), width, height), f64::INFINITY)
        };
        let area = |inside: Spawn, gas: [f64; 2]| {
            let spawns = [
                wall("left", [-1.0, 0.0, 1.0, 3.0]),
                wall("right", [4.0, 0.0, 1.0, 3.0]),
                wall("top", [0.0, -1.0, 4.0, 1.0]),
                wall("bottom", [0.0, 3.0, 4.0, 1.0]),
                inside,
                Spawn::new("a", Rect::new(Vector::new(gas[0], gas[1]), 0.1, 0.1), 1.0),
            ];
            let mut engine = Engine::new(EngineConfig::new(SolverKind::EventDriven, 10.0));
            spawns.into_iter().for_each(|spawn| engine.apply(&Event::Spawn(spawn)));
            let time = Range { from: 0.0, to: 1.0 };
            PressureRun::new(String::new(), Vector::new(4.0, 3.0), time, BTreeMap::new()).gas_area(engine.world())
        };
        // The gas is beside the block, above it and below it: it can go around it.
        for gas in [[0.5, 1.4], [3.5, 1.4], [2.4, 0.2], [2.4, 2.7]] {
            assert_eq!(area(wall("block", [2.0, 1.0, 1.0, 1.0]), gas), Some(11.0), "{gas:?}");
        }
        // A divider leaves no gap that is as wide as the body.
        for (top, height) in [(0.0, 3.0), (0.0625, 2.875)] {
            let divider = || wall("divider", [2.0, top, 1.0, height]);
            assert_eq!([area(divider(), [0.5, 1.4]), area(divider(), [3.5, 1.4])], [Some(6.0), Some(3.0)]);
        }
        assert_eq!(area(wall("divider", [2.0, 0.125, 1.0, 2.875]), [0.5, 1.4]), Some(12.0 - 2.875));
    }

    #[test]
    fn a_piston_changes_the_volume_and_the_face_of_the_walls_beside_it() {
        let body = |name: &str, [x, y, width, height]: [f64; 4], mass: f64| {
            Spawn::new(name, Rect::new(Vector::new(x, y), width, height), mass)
        };
        let mut engine = Engine::new(EngineConfig::new(SolverKind::EventDriven, 10.0));
        let spawns = [
            body("piston", [-2.0, 0.0, 2.0, 3.0], f64::INFINITY).with_velocity(Vector::new(0.5, 0.0)),
            body("right", [4.0, 0.0, 1.0, 3.0], f64::INFINITY),
            body("top", [-3.0, -1.0, 9.0, 1.0], f64::INFINITY),
            body("bottom", [-3.0, 3.0, 9.0, 1.0], f64::INFINITY),
            body("a", [2.0, 1.0, 0.1, 0.1], 1.0).with_velocity(Vector::new(3.0, 2.0)),
        ];
        let mut walls = BTreeMap::new();
        for (id, spawn) in spawns.into_iter().enumerate() {
            if spawn.mass == f64::INFINITY {
                walls
                    .insert(id as BodyId, Arc::new(Appearance::new(&BodyInfo::new(id as BodyId, spawn.clone()), None)));
            }
            engine.apply(&Event::Spawn(spawn));
        }
        let mut run = PressureRun::new(String::new(), Vector::new(4.0, 3.0), Range { from: 0.0, to: 4.0 }, walls);
        for step in 0..=40 {
            run.push(f64::from(step) / 10.0, engine.world());
            engine.step(&mut run).unwrap();
        }
        // The piston has gone 2 m of 4 m: the volume falls from 12 to 6 m², and the face of the top from 4 to 2 m.
        let volumes = run.volumes.unwrap();
        assert!((volumes.from - 6.0).abs() < 1e-9 && (volumes.to - 12.0).abs() < 1e-9 && run.has_changing_volume());
        let lengths: f64 = run.lengths[&2][Axis::Y].iter().sum();
        assert!((lengths - 3.0 * 4.0).abs() < 1e-9, "{lengths}");
        assert!(run.sides.iter().any(|side| side.name == "piston" && side.is_moving && side.side == Side::High));
        assert!(run.sides.iter().all(|side| side.name == "piston" || !side.is_moving));
    }
}
