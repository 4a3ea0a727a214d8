use super::FigureOptions;
use super::axes::{Axes, Range, Titles};
use super::panels::Panels;
use crate::physics::{Rect, Vector};
use crate::render::layers::legend::{Entry, Legend};
use crate::render::number::significant;
use crate::render::text::Line;
use crate::render::{Color, DisplayList, Ink, Look, Shape, palette};

/// What of a state is, or should be, conserved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnergySample {
    /// s.
    pub time: f64,
    /// Kinetic energy of the finite masses, J.
    pub kinetic: f64,
    /// Their potential energy, J; figures count it from its least value.
    pub potential: f64,
    /// Their momentum, kg·m/s.
    pub momentum: Vector,
}

impl EnergySample {
    fn total(&self) -> f64 {
        self.kinetic + self.potential
    }
}

/// Energy and momentum of one run.
#[derive(Clone, Debug, PartialEq)]
pub struct EnergyRun {
    /// What is written above it, if there are several.
    pub title: String,
    /// In the order of time.
    pub samples: Vec<EnergySample>,
}

/// One line of a diagram.
struct Series {
    name: &'static str,
    color: Color,
    values: Vec<[f64; 2]>,
}

/// Energy and momentum over time, with the drift of the whole written on it. Several runs have
/// the same scales.
pub fn energy(runs: &[EnergyRun], options: &FigureOptions) -> DisplayList {
    let all: Vec<Vec<EnergySample>> = runs.iter().map(|run| from_least(&run.samples)).collect();
    let has_potential = all.iter().flatten().any(|sample| sample.potential != 0.0);
    let look = Look::new(options.style.theme, options.size);
    let energies: Vec<Vec<Series>> = all.iter().map(|samples| energies(samples, has_potential, &look)).collect();
    let Some(time) = Range::of(all.iter().flatten().map(|sample| sample.time)) else {
        return Panels::new(options, &Legend::default()).finish();
    };
    let momenta: Vec<Vec<Series>> = all.iter().map(|samples| momenta(samples)).collect();
    let mut panels = Panels::new(options, &legend(&energies, &momenta));
    let titles: Vec<&str> = runs.iter().map(|run| run.title.as_str()).collect();
    let rooms = panels.titled(&titles, runs.len());
    for (at, room) in rooms.iter().enumerate() {
        let upper = (room.height() * 0.6).round();
        let above = Rect::new(room.origin, room.width(), upper);
        let below = Rect::new(room.origin.add(Vector::new(0.0, upper)), room.width(), room.height() - upper);
        let [e, p] = [&energies, &momenta].map(|series| range(series));
        diagram(&energies[at], &above, [time, e], "E / \"J\"", Some(drift(&all[at])), &mut panels);
        diagram(&momenta[at], &below, [time, p], "p / \"(kg·m/s)\"", None, &mut panels);
    }
    panels.finish()
}

/// All values, and zero.
fn range(series: &[Vec<Series>]) -> Range {
    let all = series.iter().flatten().flat_map(|series| series.values.iter().map(|value| value[1]));
    Range::of(all).unwrap_or(Range { from: 0.0, to: 1.0 }).with(0.0).widened(0.08)
}

/// Potential energy has no zero of its own: counted from its least value, the whole is what
/// the run had to give, and a drift in parts of it means something.
fn from_least(samples: &[EnergySample]) -> Vec<EnergySample> {
    let least = Range::of(samples.iter().map(|sample| sample.potential)).map_or(0.0, |range| range.from);
    let constant = samples.iter().all(|sample| sample.potential == least);
    let zero = |sample: &EnergySample| if constant { 0.0 } else { sample.potential - least };
    samples.iter().map(|sample| EnergySample { potential: zero(sample), ..*sample }).collect()
}

fn values(samples: &[EnergySample], value: impl Fn(&EnergySample) -> f64) -> Vec<[f64; 2]> {
    samples.iter().map(|sample| [sample.time, value(sample)]).collect()
}

/// The potential energy only where there is one.
fn energies(samples: &[EnergySample], has_potential: bool, look: &Look) -> Vec<Series> {
    let kinetic = Series { name: "kinetic", color: palette::BODIES[5], values: values(samples, |s| s.kinetic) };
    if !has_potential {
        return vec![kinetic];
    }
    let potential = Series { name: "potential", color: palette::BODIES[0], values: values(samples, |s| s.potential) };
    let total = Series { name: "total", color: look.palette.muted, values: values(samples, EnergySample::total) };
    // The total lies beneath, and wider, so that it is seen where it is one of the two.
    vec![total, kinetic, potential]
}

fn momenta(samples: &[EnergySample]) -> Vec<Series> {
    vec![
        Series { name: "p_x", color: palette::BODIES[6], values: values(samples, |s| s.momentum.x) },
        Series { name: "p_y", color: palette::BODIES[2], values: values(samples, |s| s.momentum.y) },
    ]
}

/// How far the last total energy is from the first.
fn drift(samples: &[EnergySample]) -> String {
    let (Some(first), Some(last)) = (samples.first(), samples.last()) else { return String::new() };
    let (change, size) = (last.total() - first.total(), first.total().abs());
    match size {
        0.0 => format!("ΔE = {} \"J\"", significant(change, 3)),
        size => format!("ΔE/E = {}", significant(change / size, 3)),
    }
}

fn diagram(
    series: &[Series],
    room: &Rect,
    [time, range]: [Range; 2],
    title: &str,
    note: Option<String>,
    panels: &mut Panels,
) {
    let axes = Axes::within(room, time, range, 0.0, &panels.look);
    axes.draw(&Titles { x: "t / \"s\"", y: title }, &panels.look, &mut panels.shapes);
    for series in series {
        let ink = Ink::from(series.color);
        let width = if series.name == "total" { 3.0 } else { 1.25 };
        panels.shapes.push(axes.curve(series.values.iter().copied(), width * panels.look.line, ink));
    }
    if let Some(note) = note {
        let line = Line::math(&note, 0.9 * panels.look.text);
        let baseline = (axes.frame.origin.y - 0.5 * panels.look.text).round();
        let at = Vector::new((axes.frame.far_corner().x - line.width).round(), baseline);
        panels.shapes.push(Shape::Text { line, at, ink: panels.look.palette.ink.into() });
    }
}

/// One legend for all diagrams.
fn legend(energies: &[Vec<Series>], momenta: &[Vec<Series>]) -> Legend {
    let series = energies.first().into_iter().chain(momenta.first()).flatten();
    let entry = |series: &Series| Entry { name: series.name.to_owned(), ..Entry::new(series.color, "") };
    Legend { entries: series.map(entry).collect() }
}
