use super::TimeCurve;
use super::axes::{Axes, AxisTitles, Range, Scale};
use super::panels::{Layout, Panels};
use super::timeline::{Timeline, draw_timeline, timeline_legend};
use crate::physics::{Rect, Vector, World, larger, smaller};
use crate::picture::layers::footer::{Entry, Legend};
use crate::picture::number::{Unit, format_significant};
use crate::picture::text::Line;
use crate::picture::{Color, DisplayList, DrawingMetrics, Ink, Language, RenderError, Style, color};

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
            kinetic: world.kinetic_energy(),
            potential: world.potential_energy(),
            momentum: world.momentum(),
        }
    }

    /// The sum of kinetic and potential energy, J.
    pub fn total(&self) -> f64 {
        self.kinetic + self.potential
    }
}

/// Energy and momentum of one run over time. Memory is bounded by the width of the page.
#[derive(Clone, Debug, PartialEq)]
pub struct EnergyRun {
    /// Title, shown if there are several runs.
    pub title: String,
    /// Spawns, deletes and gaps.
    pub timeline: Timeline,
    /// Kinetic, potential and total energy, J.
    energies: [TimeCurve; 3],
    /// The components of the momentum, kg·m/s.
    momenta: [TimeCurve; 2],
    has_potential: bool,
    /// The least potential energy, J.
    least_potential: f64,
    /// The time of the first sample, s.
    start: Option<f64>,
    since_change: Option<Account>,
}

/// The energy since the last spawn or delete.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Account {
    first: EnergySample,
    last: EnergySample,
}

impl EnergyRun {
    /// Creates a run without samples, for curves with columns of `column` seconds. `has_potential` is false if neither
    /// gravity nor a force acts, so there is no potential energy to show.
    pub fn new(title: String, column: f64, has_potential: bool) -> EnergyRun {
        let curve = || TimeCurve::new(column);
        EnergyRun {
            title,
            timeline: Timeline::default(),
            energies: [curve(), curve(), curve()],
            momenta: [curve(), curve()],
            has_potential,
            least_potential: f64::INFINITY,
            start: None,
            since_change: None,
        }
    }

    /// Adds a sample; times must not decrease.
    pub fn push(&mut self, sample: &EnergySample) {
        let values = [sample.kinetic, sample.potential, sample.total()];
        self.energies.iter_mut().zip(values).for_each(|(curve, value)| curve.push(sample.time, value));
        let values = [sample.momentum.x, sample.momentum.y];
        self.momenta.iter_mut().zip(values).for_each(|(curve, value)| curve.push(sample.time, value));
        self.least_potential = smaller(sample.potential, self.least_potential);
        self.start = self.start.or(Some(sample.time));
        self.since_change = Some(match self.since_change {
            Some(Account { first, .. }) => Account { first, last: *sample },
            None => Account { first: *sample, last: *sample },
        });
    }

    /// Returns true if an energy or a momentum exceeds the range of numbers.
    pub fn has_overflow(&self) -> bool {
        self.energies.iter().chain(&self.momenta).any(TimeCurve::has_overflow)
    }

    /// Interrupts all curves: the next sample is not joined to the last one.
    pub fn interrupt(&mut self) {
        self.energies.iter_mut().chain(&mut self.momenta).for_each(TimeCurve::interrupt);
    }

    /// Measures the drift of the energy from the next sample on, because bodies were or may have been spawned or
    /// deleted.
    pub fn restart_account(&mut self) {
        self.since_change = None;
    }

    /// The energy curves, J; only the kinetic energy if there is no potential energy, which is counted from `zero`.
    fn energy_series(&self, zero: f64, language: Language, metrics: &DrawingMetrics) -> Vec<Series> {
        let [kinetic, potential, total] = &self.energies;
        let series =
            |name, color, curve: &TimeCurve, zero| Series { name, color, parts: curve.parts(), zero, width: 1.25 };
        let kinetic = series(language.of("kinetic", "cinétique"), color::BODY_COLORS[5], kinetic, 0.0);
        if !self.has_potential {
            return vec![kinetic];
        }
        let potential = series(language.of("potential", "potentielle"), color::BODY_COLORS[0], potential, zero);
        // The total is drawn first and wider, so that it stays visible where it equals another curve.
        vec![
            Series { width: 3.0, ..series(language.of("total", "totale"), metrics.palette.muted, total, zero) },
            kinetic,
            potential,
        ]
    }

    fn momentum_series(&self) -> Vec<Series> {
        let series =
            |name, color, curve: &TimeCurve| Series { name, color, parts: curve.parts(), zero: 0.0, width: 1.25 };
        let [x, y] = &self.momenta;
        vec![series("p_x", color::BODY_COLORS[6], x), series("p_y", color::BODY_COLORS[2], y)]
    }

    /// The change of the total energy since the last spawn or delete as a label, relative to the energy that the curve
    /// has there if that is not 0. Potential energy is counted from `zero`. Nothing is known to change in a single
    /// sample.
    fn drift(&self, zero: f64, language: Language) -> String {
        let Some(Account { first, last }) = self.since_change.filter(|account| account.first.time < account.last.time)
        else {
            return String::new();
        };
        let zero = if self.has_potential { zero } else { 0.0 };
        let (change, size) = (last.total() - first.total(), (first.total() - zero).abs());
        let drift = match size {
            0.0 => format!("ΔE = {}", language.decimal(Unit::JOULE.format(change, 3))),
            size => format!("ΔE/E = {}", language.decimal(format_significant(change / size, 3))),
        };
        if self.start == Some(first.time) {
            drift
        } else {
            let time = language.decimal(Unit::SECOND.format(first.time, 4));
            format!("{drift} \" {} \" t = {time}", language.of("since", "depuis"))
        }
    }
}

/// A curve of a diagram, in parts without gaps.
struct Series {
    name: &'static str,
    color: Color,
    parts: Vec<Vec<[f64; 2]>>,
    /// Subtracted from the values.
    zero: f64,
    /// Its width, in line widths.
    width: f64,
}

impl Series {
    fn values(&self) -> impl Iterator<Item = f64> {
        self.parts.iter().flatten().map(|point| point[1] - self.zero)
    }
}

/// The least potential energy of all runs that have any, J. Potential energy is counted from it, because its zero is
/// arbitrary; so the total is the energy available in a run, and runs that begin alike begin at the same height.
fn least_potential(runs: &[EnergyRun]) -> f64 {
    runs.iter().filter(|run| run.has_potential).map(|run| run.least_potential).fold(f64::INFINITY, smaller)
}

/// Draws energy and momentum over `time` (s), labelled with the drift of the total energy. Several runs have the same
/// scales and the same zero of the energy.
///
/// # Errors
/// If the page is too small.
pub fn energy(runs: &[EnergyRun], time: Range, style: &Style) -> Result<DisplayList, RenderError> {
    let language = style.look.language;
    let metrics = DrawingMetrics::new(style.look.theme, style.look.language, style.look.size);
    let zero = least_potential(runs);
    let energies: Vec<Vec<Series>> = runs.iter().map(|run| run.energy_series(zero, language, &metrics)).collect();
    let momenta: Vec<Vec<Series>> = runs.iter().map(EnergyRun::momentum_series).collect();
    let time = Scale::linear(time, Unit::SECOND);
    let [e, p] =
        [(&energies, Unit::JOULE), (&momenta, Unit::MOMENTUM)].map(|(series, unit)| Scale::linear(range(series), unit));
    let notes: Vec<String> = runs.iter().map(|run| run.drift(zero, language)).collect();
    let fits = |cell: &Rect, metrics: &DrawingMetrics| {
        let [above, below] = split(cell).map(|panel| Axes::within(&panel, time, e, 0.0, metrics).plot_area);
        let title = Line::math(&e.title("E"), metrics.text(0.9)).width + metrics.font_size;
        let note = notes.iter().map(|note| Line::math(note, metrics.text(NOTE[2])).width).fold(0.0, larger);
        let momentum = Line::math(&p.title("p"), metrics.text(0.9)).width;
        above.width() >= larger(larger(6.0 * metrics.font_size, title + note), momentum)
            && below.height() >= 2.2 * metrics.font_size
    };
    let titles: Vec<&str> = runs.iter().map(|run| run.title.as_str()).collect();
    let layout = Layout {
        legend: &|metrics| legend(&energies, &momenta, runs, language, metrics),
        ..Layout::new(style, &titles, &fits)
    };
    let (mut panels, cells) = layout.lay_out()?;
    for (at, cell) in cells.iter().enumerate() {
        panels.clip(cell, |panels| {
            let [above, below] = split(cell);
            let [e, p] =
                [(above, e), (below, p)].map(|(panel, scale)| Axes::within(&panel, time, scale, 0.0, &panels.metrics));
            // The frames are aligned, so that an instant is at the same place in both.
            let left = larger(e.plot_area.origin.x, p.plot_area.origin.x);
            let timeline = &runs[at].timeline;
            let [e, p] = [e.with_left(left), p.with_left(left)];
            draw_diagram(&energies[at], ("E", &e), timeline, Some(&notes[at]), panels);
            draw_diagram(&momenta[at], ("p", &p), timeline, None, panels);
        });
    }
    Ok(panels.finish())
}

/// The areas of the diagrams of energy and momentum.
fn split(cell: &Rect) -> [Rect; 2] {
    let upper = (cell.height() * 0.6).round();
    let below = cell.origin.add(Vector::new(0.0, upper));
    [Rect::new(cell.origin, cell.width(), upper), Rect::new(below, cell.width(), cell.height() - upper)]
}

/// The font sizes tried for the drift, relative to that of the page.
const NOTE: [f64; 3] = [0.9, 0.8, 0.7];

/// The range of all values and zero, with a margin.
fn range(series: &[Vec<Series>]) -> Range {
    let all = series.iter().flatten().flat_map(Series::values);
    let all = all.chain([0.0]);
    Range::of(all).unwrap_or(Range { from: 0.0, to: 1.0 }).widened(0.08)
}

fn draw_diagram(
    series: &[Series],
    (symbol, axes): (&str, &Axes),
    timeline: &Timeline,
    note: Option<&str>,
    panels: &mut Panels,
) {
    let titles = AxisTitles { x: &axes.x.title("t"), y: &axes.y.title(symbol) };
    axes.draw(&titles, &panels.metrics, &mut panels.shapes);
    draw_timeline(timeline, axes, panels);
    for series in series {
        let ink = Ink::from(series.color);
        for part in &series.parts {
            let points = part.iter().map(|[time, value]| [*time, value - series.zero]);
            panels.shapes.push(axes.curve(points, series.width * panels.metrics.line_width, ink));
        }
    }
    if let Some(note) = note {
        let title = Line::math(titles.y, panels.metrics.text(0.9)).width + panels.metrics.font_size;
        let [first, second, third] = NOTE.map(|part| Line::math(note, panels.metrics.text(part)));
        let free_width = axes.plot_area.width() - title;
        let line = [first, second].into_iter().find(|line| line.width <= free_width).unwrap_or(third);
        axes.draw_note(line, &panels.metrics, &mut panels.shapes);
    }
}

/// The common legend of all diagrams: the curves that any of them has, changes and gaps.
fn legend(
    energies: &[Vec<Series>],
    momenta: &[Vec<Series>],
    runs: &[EnergyRun],
    language: Language,
    metrics: &DrawingMetrics,
) -> Legend {
    let widest = energies.iter().max_by_key(|series| series.len());
    let series = widest.into_iter().chain(momenta.first()).flatten();
    let entry = |series: &Series| Entry { name: series.name.to_owned(), ..Entry::new(series.color, "") };
    let timelines = runs.iter().map(|run| &run.timeline);
    Legend { entries: series.map(entry).chain(timeline_legend(timelines, language, metrics)).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The energy at t = 1 s, from which the drift is measured, is 8 J on the axis, which begins at the least potential
    /// energy of the run, at t = 0.
    #[test]
    fn the_drift_is_relative_to_the_energy_on_the_axis() {
        let mut run = EnergyRun::new(String::new(), 0.1, true);
        let sample = |time, kinetic, potential| EnergySample { time, kinetic, potential, momentum: Vector::ZERO };
        run.push(&sample(0.0, 1.0, -6.0));
        run.restart_account();
        run.push(&sample(1.0, 1.0, 1.0));
        assert_eq!(run.drift(run.least_potential, Language::English), "", "a single sample has no change");
        run.push(&sample(2.0, 0.0, 1.0));
        assert_eq!(run.drift(run.least_potential, Language::English), "ΔE/E = −0.125 \" since \" t = 1 \"s\"");
    }

    /// Two runs that begin at the same height, of which one goes deeper, and one without potential energy.
    #[test]
    fn all_runs_have_one_zero() {
        let run = |depth: f64, has_potential: bool| {
            let mut run = EnergyRun::new(String::new(), 0.0, has_potential);
            for (time, potential) in [(0.0, -6.0), (1.0, -6.0 - depth)] {
                let potential = if has_potential { potential } else { 0.0 };
                run.push(&EnergySample { time, kinetic: 1.0, potential, momentum: Vector::ZERO });
            }
            run
        };
        let runs = [run(1.0, true), run(4.0, true), run(1.0, false)];
        let metrics = DrawingMetrics::new(crate::picture::Theme::Light, Language::English, [800, 450]);
        let zero = least_potential(&runs);
        let totals = runs.iter().map(|run| run.energy_series(zero, Language::English, &metrics)[0].values().collect());
        assert_eq!(totals.collect::<Vec<Vec<f64>>>(), [[5.0, 4.0], [5.0, 1.0], [1.0, 1.0]]);
        assert_eq!(run(1.0, true).drift(zero, Language::English), "ΔE/E = −0.2");
    }
}
