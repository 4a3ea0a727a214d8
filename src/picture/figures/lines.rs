use super::axes::{Axes, AxisTitles, Range, Scale};
use super::panels::Layout;
use super::timeline::{Timeline, draw_timeline, timeline_legend};
use super::{EnergySample, MAX_IN_LEGEND, SystemSums, TimeCurve, counted_bodies};
use crate::physics::{Axis, BodyId, Rect, Vector, World, larger, smaller};
use crate::picture::impacts::{Impact, Impacts};
use crate::picture::layers::dashes::DashPattern;
use crate::picture::layers::footer::{Entry, LINE_WIDTH, Legend, quoted};
use crate::picture::number::Unit;
use crate::picture::raster::color::{CURVE_COLORS, SPEED_COLORS};
use crate::picture::text::Line;
use crate::picture::{
    Appearance, Color, ColorBy, DisplayList, DrawingMetrics, Ink, Palette, Quantity, RenderError, Style, color,
};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A quantity of the bodies of one run over time. Memory is bounded by the width of the page and the number of bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct LineRun {
    /// The name of the run in the legend.
    pub title: String,
    /// Spawns, deletes and gaps.
    pub timeline: Timeline,
    quantity: Quantity,
    /// Height of the world, m.
    world_height: f64,
    /// Width of the columns of curves, s.
    column: f64,
    subject: LineSubject,
    lines: BTreeMap<Option<BodyId>, LineOfBody>,
    /// The motion of each body, or of all together, in the last state.
    last: BTreeMap<Option<BodyId>, Motion>,
    /// Energy and momentum of all bodies together since the last state.
    sums: SystemSums,
}

/// The bodies whose quantity is shown.
#[derive(Clone, Debug, PartialEq)]
pub enum LineSubject {
    /// Each of these bodies has a line of its own.
    Bodies(BTreeMap<BodyId, Arc<Appearance>>),
    /// All bodies of finite mass together have one line: their energy, or the norm of their momentum.
    System,
}

/// A motion at one instant: position and velocity of a body, m and m/s, or only the momentum of all bodies, kg·m/s.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Motion {
    time: f64,
    position: Vector,
    velocity: Vector,
}

/// Rounding errors relative to the size of the numbers that are compared.
const ROUNDING: f64 = 1e-9;

impl Motion {
    /// The motion at the turning point of a quantity between this instant and a later one, if it is free: with this
    /// constant acceleration, and without any impulse. States between which a body bounced or rested are not joined by
    /// such a motion.
    fn turning_point(&self, later: &Motion, acceleration: Vector, quantity: Quantity) -> Option<Motion> {
        let duration = later.time - self.time;
        let is_free = later.velocity.sub(self.velocity).sub(acceleration.mult(duration)).norm()
            <= ROUNDING * (self.velocity.norm() + later.velocity.norm());
        let mean = self.velocity.add(later.velocity).mult(0.5);
        let way = later.position.sub(self.position);
        let is_joined = way.sub(mean.mult(duration)).norm()
            <= ROUNDING * (self.position.norm() + later.position.norm() + mean.norm() * duration);
        let along = |axis: Axis| -self.velocity[axis] / acceleration[axis];
        let after = match quantity {
            Quantity::X => along(Axis::X),
            Quantity::Y | Quantity::Height => along(Axis::Y),
            Quantity::Speed | Quantity::Momentum => -self.velocity.dot(acceleration) / acceleration.dot(acceleration),
            Quantity::Vx | Quantity::Vy | Quantity::Energy => return None,
        };
        (is_free && is_joined && after > 0.0 && after < duration).then(|| Motion {
            time: self.time + after,
            position: self.position.add(self.velocity.mult(after)).add(acceleration.mult(after * after / 2.0)),
            velocity: self.velocity.add(acceleration.mult(after)),
        })
    }
}

/// The curve of one body, or of all together.
#[derive(Clone, Debug, PartialEq)]
struct LineOfBody {
    curve: TimeCurve,
    /// The least potential energy, J.
    least_potential: f64,
    /// True if energies are shown and the potential energy is not always 0.
    has_potential: bool,
}

impl LineRun {
    /// Creates a run without values, for curves with columns of `column` seconds in a world of `world_height` metres.
    pub fn new(title: String, quantity: Quantity, subject: LineSubject, world_height: f64, column: f64) -> LineRun {
        let (timeline, lines, last) = (Timeline::default(), BTreeMap::new(), BTreeMap::new());
        let sums = SystemSums::default();
        LineRun { title, timeline, quantity, world_height, column, subject, lines, last, sums }
    }

    /// Adds the values of a state; times must not decrease. Where a quantity turns between two states of a free motion,
    /// its extreme is a point of the line.
    pub fn push(&mut self, time: f64, world: &World) {
        let subject = std::mem::replace(&mut self.subject, LineSubject::System);
        match &subject {
            LineSubject::System => self.push_system(time, world),
            LineSubject::Bodies(bodies) => {
                for (body, appearance) in world.bodies.iter().filter_map(|body| Some((body, bodies.get(&body.id)?))) {
                    self.push_body(time, appearance, &body.rect, body.velocity);
                }
            }
        }
        self.subject = subject;
    }

    /// Adds the values before and after collisions between two states.
    pub fn push_impacts(&mut self, impacts: &Impacts) {
        let Impacts { time, .. } = *impacts;
        if self.subject == LineSubject::System {
            for EnergySample { kinetic, potential, momentum, .. } in self.sums.collide(impacts).into_iter().flatten() {
                match self.quantity {
                    Quantity::Momentum => self.add(None, time, momentum.norm(), 0.0),
                    _ => self.add(None, time, kinetic + potential, potential),
                }
            }
            // The momentum turns within a pixel, if at all.
            self.last.clear();
            return;
        }
        for (id, Impact { appearance, rect, before, after, .. }) in &impacts.bodies {
            if self.appearance(Some(*id)).is_some() {
                [before, after].into_iter().for_each(|velocity| self.push_body(time, appearance, rect, *velocity));
            }
        }
    }

    fn push_system(&mut self, time: f64, world: &World) {
        let sample = EnergySample::of(world, time);
        self.sums.set(world, sample);
        if self.quantity == Quantity::Momentum {
            let motion = Motion { time, position: Vector::ZERO, velocity: sample.momentum };
            let last = self.last.insert(None, motion);
            let turn = last.and_then(|last| momentum_turn(&last, &motion, total_force(world)));
            turn.into_iter().chain([motion]).for_each(|at| self.add(None, at.time, at.velocity.norm(), 0.0));
        } else {
            self.add(None, time, sample.total(), sample.potential);
        }
    }

    fn push_body(&mut self, time: f64, appearance: &Appearance, rect: &Rect, velocity: Vector) {
        let Appearance { id, mass, force, .. } = *appearance;
        let potential = -force.dot(rect.center());
        let motion = Motion { time, position: rect.origin, velocity };
        let last = self.last.insert(Some(id), motion);
        let turn = last.and_then(|last| last.turning_point(&motion, force.mult(1.0 / mass), self.quantity));
        for at in turn.into_iter().chain([motion]) {
            self.add(Some(id), at.time, self.value(mass, rect.height(), &at, potential), potential);
        }
    }

    fn add(&mut self, key: Option<BodyId>, time: f64, value: f64, potential: f64) {
        let column = self.column;
        let new = || LineOfBody { curve: TimeCurve::new(column), least_potential: potential, has_potential: false };
        let line = self.lines.entry(key).or_insert_with(new);
        line.least_potential = smaller(line.least_potential, potential);
        line.has_potential |= self.quantity == Quantity::Energy && potential != 0.0;
        line.curve.push(time, value);
    }

    /// The value of the quantity for a motion of a body of a mass, kg, a height, m, and a potential energy, J.
    fn value(&self, mass: f64, height: f64, Motion { position, velocity, .. }: &Motion, potential: f64) -> f64 {
        match self.quantity {
            Quantity::X => position.x,
            Quantity::Y => position.y,
            Quantity::Vx => velocity.x,
            Quantity::Vy => velocity.y,
            Quantity::Speed => velocity.norm(),
            Quantity::Height => self.world_height - (position.y + height),
            Quantity::Energy => 0.5 * mass * velocity.dot(*velocity) + potential,
            Quantity::Momentum => mass * velocity.norm(),
        }
    }

    /// Returns true if a value exceeds the range of numbers.
    pub fn has_overflow(&self) -> bool {
        self.lines.values().any(|line| line.curve.has_overflow())
    }

    /// Interrupts all lines: the next values are not joined to the last ones.
    pub fn interrupt(&mut self) {
        self.lines.values_mut().for_each(|line| line.curve.interrupt());
        self.last.clear();
    }

    /// The appearance of the body of a line; `None` for all bodies together.
    fn appearance(&self, key: Option<BodyId>) -> Option<&Appearance> {
        match &self.subject {
            LineSubject::Bodies(bodies) => bodies.get(&key?).map(|appearance| &**appearance),
            LineSubject::System => None,
        }
    }
}

/// The least momentum between two states, kg·m/s, if only this force, N, acts between them. All bodies together have no
/// position, so that of a free motion takes its place.
fn momentum_turn(last: &Motion, now: &Motion, force: Vector) -> Option<Motion> {
    let way = now.velocity.add(last.velocity).mult(0.5 * (now.time - last.time));
    last.turning_point(&Motion { position: way, ..*now }, force, Quantity::Momentum)
}

/// The sum of the weights and constant forces of all bodies of finite mass, N.
fn total_force(world: &World) -> Vector {
    let gravity = world.gravity.unwrap_or(Vector::ZERO);
    let finite = world.bodies.iter().filter(|body| !body.is_infinite());
    finite.fold(Vector::ZERO, |sum, body| sum.add(gravity.mult(body.mass)).add(body.constant_force))
}

/// Draws a quantity over `time` (s) in one diagram: a line for each body of a single run, in the colours of the bodies,
/// or the lines of several runs, each run in a colour of its own.
///
/// # Errors
/// If the page is too small.
pub fn lines(runs: &[LineRun], time: Range, quantity: Quantity, style: &Style) -> Result<DisplayList, RenderError> {
    let drawn = drawn_lines(runs, style);
    let x = Scale::linear(time, Unit::SECOND);
    let y = Scale::linear(value_range(&drawn, quantity), unit(quantity));
    let (x_title, y_title) = (x.title("t"), y.title(symbol(quantity)));
    let timeline = joined_timeline(runs);
    let fits = |cell: &Rect, metrics: &DrawingMetrics| {
        let area = Axes::within(cell, x, y, 0.0, metrics).plot_area;
        let title = Line::math(&y_title, metrics.text(0.9)).width;
        area.width() >= larger(6.0 * metrics.font_size, title) && area.height() >= 4.0 * metrics.font_size
    };
    let titles: &[&str] = if runs.is_empty() { &[] } else { &[""] };
    let layout = Layout {
        legend: &|metrics| {
            let mut legend = legend(runs, &drawn, style);
            legend.entries.extend(timeline_legend(std::iter::once(&timeline), style.look.language, metrics));
            legend
        },
        ..Layout::new(style, titles, &fits)
    };
    let (mut panels, cells) = layout.lay_out()?;
    for cell in &cells {
        panels.clip(cell, |panels| {
            let axes = Axes::within(cell, x, y, 0.0, &panels.metrics);
            axes.draw(&AxisTitles { x: &x_title, y: &y_title }, &panels.metrics, &mut panels.shapes);
            draw_timeline(&timeline, &axes, panels);
            let (width, opacity) = if drawn.len() > MAX_IN_LEGEND { (0.5, 160) } else { (LINE_WIDTH, 255) };
            for line in &drawn {
                let ink = Ink { color: line.color, opacity };
                for part in &line.parts {
                    let points = part.iter().map(|[time, value]| [*time, value - line.zero]);
                    panels.shapes.push(axes.dashed_curve(points, line.dashes, width * panels.metrics.line_width, ink));
                }
            }
        });
    }
    Ok(panels.finish())
}

/// A line with its colour.
struct DrawnLine<'a> {
    run: usize,
    appearance: Option<&'a Appearance>,
    color: Color,
    dashes: DashPattern,
    parts: Vec<Vec<[f64; 2]>>,
    /// Subtracted from the values.
    zero: f64,
}

/// The lines of all runs in drawing order.
fn drawn_lines<'a>(runs: &'a [LineRun], style: &Style) -> Vec<DrawnLine<'a>> {
    let palette = Palette::of(style.look.theme);
    let zeros = zeros(runs);
    let line = |(at, run): (usize, &'a LineRun)| {
        let zeros = &zeros;
        run.lines.iter().map(move |(key, line)| {
            let appearance = run.appearance(*key);
            let color = match (runs.len(), appearance) {
                (1, Some(appearance)) if style.look.color_by == ColorBy::Material => {
                    color::color_by_material(&appearance.material, style)
                }
                (1, Some(appearance)) => color::color_by_body(appearance),
                (count, _) => run_color(at, count, style),
            };
            let (color, dashes) = (palette.line(color), DashPattern::SOLID);
            let zero = zeros.get(name(appearance)).copied().filter(|_| line.has_potential).unwrap_or(0.0);
            DrawnLine { run: at, appearance, color, dashes, parts: line.curve.parts(), zero }
        })
    };
    let mut lines: Vec<DrawnLine> = runs.iter().enumerate().flat_map(line).collect();
    let has_names = runs.len() == 1 && style.look.color_by != ColorBy::Material && lines.len() <= MAX_IN_LEGEND;
    if has_names {
        distinguish(&mut lines);
    }
    lines
}

/// The least potential energy, J, of each body in all runs in which it has any, or of all bodies together, from which
/// their energies are counted. So the lines of runs that begin alike begin at the same height.
fn zeros(runs: &[LineRun]) -> BTreeMap<&str, f64> {
    let mut zeros: BTreeMap<&str, f64> = BTreeMap::new();
    for run in runs {
        for (key, line) in run.lines.iter().filter(|(_, line)| line.has_potential) {
            let zero = zeros.entry(name(run.appearance(*key))).or_insert(line.least_potential);
            *zero = smaller(*zero, line.least_potential);
        }
    }
    zeros
}

/// The name of the body of a line; empty for all bodies together.
fn name(appearance: Option<&Appearance>) -> &str {
    appearance.map_or("", |appearance| &appearance.name)
}

/// Gives lines of one colour different dashes.
fn distinguish(lines: &mut [DrawnLine]) {
    for at in 1..lines.len() {
        let (earlier, line) = lines.split_at_mut(at);
        let number = earlier.iter().filter(|other| other.color == line[0].color).count();
        line[0].dashes = DashPattern::of_number(number);
    }
}

/// The colour of a run: one of a few that differ, or one of a scale from the first to the last run if there are many,
/// which are usually values of a parameter.
pub fn run_color(at: usize, count: usize, style: &Style) -> Color {
    if count <= CURVE_COLORS.len() {
        return CURVE_COLORS[at];
    }
    // The part of the scale that contrasts with the page.
    let scale = match style.look.theme {
        crate::picture::Theme::Light => &SPEED_COLORS[..13],
        crate::picture::Theme::Dark => &SPEED_COLORS[4..],
    };
    let place = at as f64 / (count - 1) as f64 * (scale.len() - 1) as f64;
    let (near, part) = (place.floor() as usize, place - place.floor());
    scale[near].mix(scale[(near + 1).min(scale.len() - 1)], (100.0 * part) as u8)
}

/// The range of all values with a margin, and zero for quantities that are never negative. y points downwards, as in
/// the world.
fn value_range(lines: &[DrawnLine], quantity: Quantity) -> Range {
    let values = lines.iter().flat_map(|line| line.parts.iter().flatten().map(|point| point[1] - line.zero));
    let zero = match quantity {
        Quantity::X | Quantity::Y | Quantity::Vx | Quantity::Vy => None,
        Quantity::Speed | Quantity::Height | Quantity::Energy | Quantity::Momentum => Some(0.0),
    };
    let range = Range::of(values.chain(zero)).unwrap_or(Range { from: 0.0, to: 1.0 }).widened(0.06);
    match quantity {
        Quantity::Y => Range { from: range.to, to: range.from },
        _ => range,
    }
}

fn unit(quantity: Quantity) -> Unit {
    match quantity {
        Quantity::X | Quantity::Y | Quantity::Height => Unit::METRE,
        Quantity::Vx | Quantity::Vy | Quantity::Speed => Unit::METRE_PER_SECOND,
        Quantity::Energy => Unit::JOULE,
        Quantity::Momentum => Unit::MOMENTUM,
    }
}

fn symbol(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::X => "x",
        Quantity::Y => "y",
        Quantity::Vx => "v_x",
        Quantity::Vy => "v_y",
        Quantity::Speed => "v",
        Quantity::Height => "h",
        Quantity::Energy => "E",
        Quantity::Momentum => "p",
    }
}

/// Spawns, deletes and gaps of all runs.
fn joined_timeline(runs: &[LineRun]) -> Timeline {
    let mut joined = Timeline::default();
    for Timeline { changes, gaps } in runs.iter().map(|run| &run.timeline) {
        joined.changes.extend(changes);
        joined.gaps.extend(gaps.iter().filter(|gap| !joined.gaps.contains(gap)).cloned().collect::<Vec<_>>());
    }
    joined.changes.sort_by(f64::total_cmp);
    joined.changes.dedup();
    joined
}

/// The names of bodies, of materials or of runs. Too many bodies for a legend are counted.
fn legend(runs: &[LineRun], lines: &[DrawnLine], style: &Style) -> Legend {
    if let [_] = runs {
        let bodies = lines.iter().filter_map(|line| Some((line.appearance?, line)));
        let count = bodies.clone().count();
        let are_dashed = lines.iter().any(|line| line.dashes != DashPattern::SOLID);
        let entry = |(body, line): (&Appearance, &DrawnLine)| Entry {
            line: are_dashed.then_some(line.dashes),
            ..Entry::new(line.color, &body.name)
        };
        return match (style.look.color_by, count) {
            (ColorBy::Material, _) => Legend::of_colors(style),
            (_, ..=MAX_IN_LEGEND) => Legend { entries: bodies.map(entry).collect() },
            (_, count) => Legend { entries: vec![counted_bodies(count, style)] },
        };
    }
    let entry = |(at, run): (usize, &LineRun)| {
        let color =
            lines.iter().find(|line| line.run == at).map_or(Palette::of(style.look.theme).muted, |line| line.color);
        // Never cut: runs of a study often differ in the last characters.
        Entry { name: quoted(&run.title), ..Entry::new(color, "") }
    };
    Legend { entries: runs.iter().enumerate().map(entry).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::Spawn;
    use crate::recording::BodyInfo;

    const G: f64 = 9.81;

    /// The points of a quantity of a body with weight, from states of time, upper left corner and velocity.
    fn points(quantity: Quantity, states: &[(f64, [f64; 2], [f64; 2])]) -> Vec<[f64; 2]> {
        let gravity = Some(Vector::new(0.0, G));
        let spawn = |[x, y]: [f64; 2], [vx, vy]: [f64; 2]| {
            Spawn::new("a", Rect::new(Vector::new(x, y), 1.0, 1.0), 2.0).with_velocity(Vector::new(vx, vy))
        };
        let appearance = Arc::new(Appearance::new(&BodyInfo::new(0, spawn([0.0; 2], [0.0; 2])), gravity));
        let subject = LineSubject::Bodies([(0, appearance)].into());
        let mut run = LineRun::new(String::new(), quantity, subject, 10.0, 0.0);
        for (time, at, velocity) in states {
            let config = crate::physics::EngineConfig::new(crate::physics::SolverKind::EventDriven, 10.0);
            let mut engine = crate::physics::Engine::new(config.with_gravity(gravity));
            engine.apply(&crate::physics::Event::Spawn(spawn(*at, *velocity)));
            run.push(*time, engine.world());
        }
        run.lines.values().flat_map(|line| line.curve.parts()).flatten().collect()
    }

    #[test]
    fn a_throw_has_its_turning_point_between_two_states() {
        let state = |time: f64| {
            let (x, y) = (1.0 + 3.0 * time, 5.0 - 4.0 * time + G * time * time / 2.0);
            (time, [x, y], [3.0, -4.0 + G * time])
        };
        let states = [state(0.0), state(0.3), state(0.6)];
        let least = |points: &[[f64; 2]]| points.iter().map(|point| point[1]).fold(f64::INFINITY, smaller);
        let most = |points: &[[f64; 2]]| points.iter().map(|point| point[1]).fold(0.0, larger);
        let (speeds, heights) = (points(Quantity::Speed, &states), points(Quantity::Height, &states));
        assert!((least(&speeds) - 3.0).abs() < 1e-12 && speeds.len() == 4, "{speeds:?}");
        assert!((most(&heights) - (4.0 + 16.0 / (2.0 * G))).abs() < 1e-12, "{heights:?}");
        assert!((least(&points(Quantity::Momentum, &states)) - 6.0).abs() < 1e-12);
        assert!((least(&points(Quantity::Y, &states)) - (5.0 - 16.0 / (2.0 * G))).abs() < 1e-12);
        assert_eq!(points(Quantity::X, &states).len(), 2, "x does not turn, and its line is straight");
    }

    /// Two falls from the same height, to different depths, beside a body without weight.
    #[test]
    fn runs_that_begin_alike_have_the_same_energy_at_first() {
        let run = |depth: f64, gravity: Option<Vector>| {
            let spawn = Spawn::new("a", Rect::new(Vector::new(0.0, 1.0), 1.0, 1.0), 2.0);
            let appearance = Arc::new(Appearance::new(&BodyInfo::new(0, spawn.clone()), gravity));
            let subject = LineSubject::Bodies([(0, appearance.clone())].into());
            let mut run = LineRun::new(String::new(), Quantity::Energy, subject, 10.0, 0.0);
            let below = Rect::new(Vector::new(0.0, 1.0 + depth), 1.0, 1.0);
            run.push_body(0.0, &appearance, &spawn.rect, Vector::ZERO);
            run.push_body(1.0, &appearance, &below, Vector::ZERO);
            run
        };
        let weight = Some(Vector::new(0.0, 10.0));
        let runs = [run(2.0, weight), run(5.0, weight), run(5.0, None)];
        let lines = drawn_lines(&runs, &Style::default());
        let energies = lines.iter().map(|line| line.parts[0].iter().map(|point| point[1] - line.zero).collect());
        assert_eq!(energies.collect::<Vec<Vec<f64>>>(), [[100.0, 60.0], [100.0, 0.0], [0.0, 0.0]]);
    }

    /// The lines of a single run of `count` bodies at rest, and their legend.
    fn lines_and_legend(count: u32) -> (Vec<(Color, DashPattern)>, Legend) {
        let spawn = |id: u32| Spawn::new(id.to_string(), Rect::new(Vector::new(f64::from(id), 0.0), 0.5, 0.5), 1.0);
        let appearances = (0..count).map(|id| (id, Arc::new(Appearance::new(&BodyInfo::new(id, spawn(id)), None))));
        let subject = LineSubject::Bodies(appearances.collect());
        let mut run = LineRun::new(String::new(), Quantity::X, subject, 10.0, 0.0);
        let config = crate::physics::EngineConfig::new(crate::physics::SolverKind::EventDriven, 10.0);
        let mut engine = crate::physics::Engine::new(config);
        (0..count).for_each(|id| engine.apply(&crate::physics::Event::Spawn(spawn(id))));
        run.push(0.0, engine.world());
        let (runs, style) = ([run], Style::default());
        let lines = drawn_lines(&runs, &style);
        (lines.iter().map(|line| (line.color, line.dashes)).collect(), legend(&runs, &lines, &style))
    }

    #[test]
    fn lines_of_one_colour_have_different_dashes_in_the_diagram_and_in_its_legend() {
        for count in 1..=MAX_IN_LEGEND as u32 {
            let (lines, legend) = lines_and_legend(count);
            let repeated = (1..lines.len()).filter(|&at| lines[..at].contains(&lines[at])).count();
            assert_eq!((lines.len() as u32, repeated), (count, 0), "{lines:?}");
            let marks = legend.entries.iter().map(|entry| (entry.colors[0], entry.line.unwrap_or(DashPattern::SOLID)));
            assert!(marks.eq(lines.iter().copied()), "{legend:?}");
            assert!(legend.entries.iter().all(|entry| entry.line.is_some() == (count > 7)), "{legend:?}");
        }
        let (many, legend) = lines_and_legend(40);
        assert!(many.iter().all(|line| line.1 == DashPattern::SOLID) && legend.entries.len() == 1);
    }

    #[test]
    fn a_bounce_between_two_states_has_no_turning_point() {
        // Symmetric in time: the body is at the same place with the opposite velocity, and was never at rest.
        let states = [(0.0, [0.0, 0.0], [0.0, 2.0]), (0.1, [0.0, 0.0], [0.0, -2.0])];
        for quantity in [Quantity::Speed, Quantity::Y, Quantity::Height] {
            assert_eq!(points(quantity, &states).len(), 2, "{quantity:?}");
        }
        let at_rest = [(0.0, [0.0, 0.0], [0.0, 0.0]), (0.1, [0.0, 0.0], [0.0, 0.0])];
        assert_eq!(points(Quantity::Speed, &at_rest).len(), 2);
    }
}
