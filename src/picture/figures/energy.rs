use super::axes::{Axes, AxisTitles, Range, Scale};
use super::panels::Panels;
use crate::physics::{Rect, Vector, World, invariants};
use crate::picture::layers::footer::{Entry, Legend};
use crate::picture::number::format_significant;
use crate::picture::text::Line;
use crate::picture::{Color, DisplayList, DrawingMetrics, Ink, Shape, Style, color};

/// Energy and momentum of a state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnergySample {
    /// Simulated time, s.
    pub time: f64,
    /// Kinetic energy of the bodies of finite mass, J.
    pub kinetic: f64,
    /// Their potential energy, −Σ (m·g + F)·x at the centres, J. Figures show it relative to its minimum.
    pub potential: f64,
    /// Their momentum, kg·m/s.
    pub momentum: Vector,
}

impl EnergySample {
    /// Energy and momentum of the bodies of finite mass in a world.
    pub fn of(world: &World, time: f64) -> EnergySample {
        EnergySample {
            time,
            kinetic: invariants::kinetic_energy(world),
            potential: invariants::potential_energy(world),
            momentum: invariants::momentum(world),
        }
    }

    /// The sum of kinetic and potential energy, J.
    pub fn total(&self) -> f64 {
        self.kinetic + self.potential
    }
}

/// Energy and momentum of one run over time.
#[derive(Clone, Debug, PartialEq)]
pub struct EnergyRun {
    /// Title, shown if there are several runs.
    pub title: String,
    /// Samples in the order of time.
    pub samples: Vec<EnergySample>,
}

/// A curve of a diagram.
struct Series {
    name: &'static str,
    color: Color,
    values: Vec<[f64; 2]>,
}

/// Draws energy and momentum over time, labelled with the drift of the total energy. Several runs have the same scales.
pub fn energy(runs: &[EnergyRun], style: &Style) -> DisplayList {
    let all: Vec<Vec<EnergySample>> = runs.iter().map(|run| relative_to_minimum(&run.samples)).collect();
    let has_potential = all.iter().flatten().any(|sample| sample.potential != 0.0);
    let metrics = DrawingMetrics::new(style.look.theme, style.look.size);
    let energies: Vec<Vec<Series>> = all.iter().map(|samples| energies(samples, has_potential, &metrics)).collect();
    let Some(time) = Range::of(all.iter().flatten().map(|sample| sample.time)) else {
        return Panels::new(style, &Legend::default()).finish();
    };
    let momenta: Vec<Vec<Series>> = all.iter().map(|samples| momenta(samples)).collect();
    let mut panels = Panels::new(style, &legend(&energies, &momenta));
    let titles: Vec<&str> = runs.iter().map(|run| run.title.as_str()).collect();
    let panel_areas = panels.titled_cells(&titles, runs.len());
    for (at, panel) in panel_areas.iter().enumerate() {
        let upper = (panel.height() * 0.6).round();
        let above = Rect::new(panel.origin, panel.width(), upper);
        let below = Rect::new(panel.origin.add(Vector::new(0.0, upper)), panel.width(), panel.height() - upper);
        let [e, p] = [&energies, &momenta].map(|series| range(series));
        diagram(&energies[at], &above, [time, e], "E / \"J\"", Some(drift(&all[at])), &mut panels);
        diagram(&momenta[at], &below, [time, p], "p / \"(kg·m/s)\"", None, &mut panels);
    }
    panels.finish()
}

/// The range of all values and zero, with a margin.
fn range(series: &[Vec<Series>]) -> Range {
    let all = series.iter().flatten().flat_map(|series| series.values.iter().map(|value| value[1]));
    Range::of(all).unwrap_or(Range { from: 0.0, to: 1.0 }).including(0.0).widened(0.08)
}

/// Shifts potential energy so that its minimum is 0. Its zero is arbitrary; relative to the minimum, the total is the
/// energy available in the run, so that a relative drift is meaningful.
fn relative_to_minimum(samples: &[EnergySample]) -> Vec<EnergySample> {
    let minimum = Range::of(samples.iter().map(|sample| sample.potential)).map_or(0.0, |range| range.from);
    let is_constant = samples.iter().all(|sample| sample.potential == minimum);
    let shifted = |sample: &EnergySample| if is_constant { 0.0 } else { sample.potential - minimum };
    samples.iter().map(|sample| EnergySample { potential: shifted(sample), ..*sample }).collect()
}

fn values(samples: &[EnergySample], value: impl Fn(&EnergySample) -> f64) -> Vec<[f64; 2]> {
    samples.iter().map(|sample| [sample.time, value(sample)]).collect()
}

/// The energy curves; only the kinetic energy if there is no potential energy.
fn energies(samples: &[EnergySample], has_potential: bool, metrics: &DrawingMetrics) -> Vec<Series> {
    let kinetic = Series { name: "kinetic", color: color::BODY_COLORS[5], values: values(samples, |s| s.kinetic) };
    if !has_potential {
        return vec![kinetic];
    }
    let potential =
        Series { name: "potential", color: color::BODY_COLORS[0], values: values(samples, |s| s.potential) };
    let total = Series { name: "total", color: metrics.palette.muted, values: values(samples, EnergySample::total) };
    // The total is drawn first and wider, so that it stays visible where it equals another curve.
    vec![total, kinetic, potential]
}

fn momenta(samples: &[EnergySample]) -> Vec<Series> {
    vec![
        Series { name: "p_x", color: color::BODY_COLORS[6], values: values(samples, |s| s.momentum.x) },
        Series { name: "p_y", color: color::BODY_COLORS[2], values: values(samples, |s| s.momentum.y) },
    ]
}

/// The change of the total energy from first to last sample as a label, relative if the first is not 0.
fn drift(samples: &[EnergySample]) -> String {
    let (Some(first), Some(last)) = (samples.first(), samples.last()) else { return String::new() };
    let (change, size) = (last.total() - first.total(), first.total().abs());
    match size {
        0.0 => format!("ΔE = {} \"J\"", format_significant(change, 3)),
        size => format!("ΔE/E = {}", format_significant(change / size, 3)),
    }
}

fn diagram(
    series: &[Series],
    panel: &Rect,
    [time, range]: [Range; 2],
    title: &str,
    note: Option<String>,
    panels: &mut Panels,
) {
    let axes = Axes::within(panel, Scale::Linear(time), Scale::Linear(range), 0.0, &panels.metrics);
    axes.draw(&AxisTitles { x: "t / \"s\"", y: title }, &panels.metrics, &mut panels.shapes);
    for series in series {
        let ink = Ink::from(series.color);
        let width = if series.name == "total" { 3.0 } else { 1.25 };
        panels.shapes.push(axes.curve(series.values.iter().copied(), width * panels.metrics.line_width, ink));
    }
    if let Some(note) = note {
        let line = Line::math(&note, 0.9 * panels.metrics.font_size);
        let baseline = (axes.plot_area.origin.y - 0.5 * panels.metrics.font_size).round();
        let at = Vector::new((axes.plot_area.far_corner().x - line.width).round(), baseline);
        panels.shapes.push(Shape::Text { line, at, ink: panels.metrics.palette.ink.into() });
    }
}

/// The common legend of all diagrams.
fn legend(energies: &[Vec<Series>], momenta: &[Vec<Series>]) -> Legend {
    let series = energies.first().into_iter().chain(momenta.first()).flatten();
    let entry = |series: &Series| Entry { name: series.name.to_owned(), ..Entry::new(series.color, "") };
    Legend { entries: series.map(entry).collect() }
}
