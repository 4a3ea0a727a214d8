use super::axes::{Axes, AxisTitles, Range, Scale};
use super::panels::Layout;
use crate::physics::{Rect, Vector, larger};
use crate::picture::layers::footer::{Entry, Legend, gap_entries, quoted};
use crate::picture::number::{Unit, exp, format_significant};
use crate::picture::text::Line;
use crate::picture::{Color, DisplayList, DrawingMetrics, Ink, Language, RenderError, Shape, Style, color};
use std::collections::BTreeMap;

/// The number of fine bins in which speeds are counted, and which are joined to those of the diagram.
const FINE_BINS: usize = 6000;

/// The speeds of bodies in the states of one run. Memory does not grow with the number of states.
#[derive(Clone, Debug, PartialEq)]
pub struct SpeedRun {
    /// Title, shown if there are several runs.
    pub title: String,
    /// The end of the fine bins, m/s.
    top: f64,
    fine: Vec<u64>,
    /// The number of samples beyond the fine bins.
    beyond: u64,
    /// The number of samples of each mass, kg, by the bits of the mass.
    masses: BTreeMap<u64, (f64, u64)>,
    /// The sum of kinetic energies, J.
    kinetic: f64,
    count: u64,
}

impl SpeedRun {
    /// Creates a run without samples, for speeds up to `top` (m/s), the highest one of all runs of the figure or of
    /// most bodies. Faster ones are counted together.
    pub fn new(title: String, top: f64) -> SpeedRun {
        let fine = vec![0; FINE_BINS];
        SpeedRun { title, top, fine, beyond: 0, masses: BTreeMap::new(), kinetic: 0.0, count: 0 }
    }

    /// Adds the speed, m/s, of a body of a finite mass, kg.
    pub fn push(&mut self, speed: f64, mass: f64) {
        let place = (speed / self.top * FINE_BINS as f64) as usize;
        if speed > self.top {
            self.beyond += 1
        } else {
            self.fine[place.min(FINE_BINS - 1)] += 1
        }
        self.masses.entry(mass.to_bits()).or_insert((mass, 0)).1 += 1;
        self.kinetic += 0.5 * mass * speed * speed;
        self.count += 1;
    }

    /// Returns true if a body moved in a state.
    pub fn has_motion(&self) -> bool {
        self.kinetic > 0.0
    }

    /// Returns true if the sum of the energies exceeds the range of numbers.
    pub fn has_overflow(&self) -> bool {
        !self.kinetic.is_finite()
    }

    /// The mean kinetic energy of a body, J. In two dimensions, in thermal equilibrium, it is k·T.
    fn temperature(&self) -> f64 {
        self.kinetic / self.count as f64
    }

    /// The probability density of a speed (m/s) in thermal equilibrium, s/m: the distribution of Maxwell and Boltzmann
    /// in two dimensions, f(v) = m·v/(k·T)·exp(−m·v²/(2·k·T)), averaged over the bodies.
    fn maxwell_boltzmann(&self, speed: f64) -> f64 {
        let temperature = self.temperature();
        let density = |(mass, count): &(f64, u64)| {
            let part = *count as f64 / self.count as f64;
            part * mass * speed / temperature * exp(-0.5 * mass * speed * speed / temperature)
        };
        self.masses.values().map(density).sum()
    }

    /// The number of fine bins that contain 99.9 % of the samples, so that few fast bodies do not flatten the diagram;
    /// all if more are beyond them.
    fn fine_bins_shown(&self) -> usize {
        let mut below = 0;
        let needed = self.count - self.count / 1000;
        let last = self.fine.iter().position(|count| {
            below += count;
            below >= needed
        });
        last.map_or(FINE_BINS, |last| last + 1)
    }

    /// The densities, s/m, in bins of `width` fine bins, of which `count` are shown.
    fn histogram(&self, width: usize, count: usize) -> Vec<f64> {
        let bin_width = width as f64 * self.top / FINE_BINS as f64;
        let bins = self.fine.chunks(width).take(count);
        bins.map(|bin| bin.iter().sum::<u64>() as f64 / (self.count as f64 * bin_width)).collect()
    }
}

/// The number of bins of a histogram of so many samples (the rule of Rice: twice the cube root), 10 to 30.
fn bin_count(samples: u64) -> usize {
    (10..30).find(|bins: &u64| bins * bins * bins >= 8 * samples).unwrap_or(30) as usize
}

/// Draws the distribution of speeds of each run beside that of Maxwell and Boltzmann in two dimensions at the same mean
/// energy. Several runs have the same scales.
///
/// # Errors
/// If the page is too small.
pub fn speeds(runs: &[SpeedRun], style: &Style) -> Result<DisplayList, RenderError> {
    let language = style.look.language;
    let metrics = DrawingMetrics::new(style.look.theme, style.look.language, style.look.size);
    let shown = runs.iter().map(SpeedRun::fine_bins_shown).max().unwrap_or(0).max(1);
    let samples = runs.iter().map(|run| run.count).max().unwrap_or(0);
    let width = shown.div_ceil(bin_count(samples)).max(1);
    let count = shown.div_ceil(width);
    let top = runs.iter().map(|run| run.top).fold(0.0, larger);
    let end = (count * width) as f64 * top / FINE_BINS as f64;
    let x = Scale::linear(Range { from: 0.0, to: end }, Unit::METRE_PER_SECOND);
    let histograms: Vec<Vec<f64>> = runs.iter().map(|run| run.histogram(width, count)).collect();
    const CURVE_POINTS: u32 = 200;
    let speeds = || (0..=CURVE_POINTS).map(|at| end * f64::from(at) / f64::from(CURVE_POINTS));
    let curves: Vec<Vec<[f64; 2]>> =
        runs.iter().map(|run| speeds().map(|speed| [speed, run.maxwell_boltzmann(speed)]).collect()).collect();
    let densities = histograms.iter().flatten().copied().chain(curves.iter().flatten().map(|point| point[1]));
    let highest = densities.filter(|density| density.is_finite()).fold(0.0, larger);
    let y = Scale::linear(
        Range { from: 0.0, to: if highest > 0.0 { 1.06 * highest } else { 1.0 } },
        Unit::SECOND_PER_METRE,
    );
    let (x_title, y_title) = (x.title("v"), y.title("f"));
    let notes: Vec<String> = runs.iter().map(|run| note(run, end, language)).collect();
    let fits = |cell: &Rect, metrics: &DrawingMetrics| {
        let area = Axes::within(cell, x, y, 0.0, metrics).plot_area;
        let title = Line::math(&y_title, metrics.text(0.9)).width + metrics.font_size;
        let note = notes.iter().map(|note| Line::math(note, metrics.text(0.8)).width).fold(0.0, larger);
        area.width() >= larger(6.0 * metrics.font_size, title + note) && area.height() >= 4.0 * metrics.font_size
    };
    let [bar, line] = [color::BODY_COLORS[0], color::BODY_COLORS[5]];
    let bar = bar.mix(metrics.palette.background, 25);
    let line = metrics.palette.line(line);
    let titles: Vec<&str> = runs.iter().map(|run| run.title.as_str()).collect();
    let layout = Layout {
        legend: &|_| {
            let distribution =
                language.of("Maxwell–Boltzmann in two dimensions", "Maxwell–Boltzmann à deux dimensions");
            let mut entries = vec![
                Entry { name: quoted(language.of("bodies", "corps")), ..Entry::new(bar, "") },
                Entry { name: quoted(distribution), ..Entry::new(line, "") },
            ];
            entries.extend(gap_entries(&style.gaps, language, metrics.palette.muted));
            Legend { entries }
        },
        shape: Vector::new(1.5, 1.0),
        ..Layout::new(style, &titles, &fits)
    };
    let (mut panels, cells) = layout.lay_out()?;
    for (at, cell) in cells.iter().enumerate() {
        panels.clip(cell, |panels| {
            let metrics = panels.metrics;
            let axes = Axes::within(cell, x, y, 0.0, &metrics);
            axes.draw(&AxisTitles { x: &x_title, y: &y_title }, &metrics, &mut panels.shapes);
            panels.shapes.extend(bars(&histograms[at], end, bar, &axes));
            panels.shapes.push(axes.curve(curves[at].iter().copied(), 1.5 * metrics.line_width, Ink::from(line)));
            axes.draw_note(Line::math(&notes[at], metrics.text(0.8)), &metrics, &mut panels.shapes);
        });
    }
    Ok(panels.finish())
}

/// The bars of a histogram whose last bin ends at `end` m/s.
fn bars(histogram: &[f64], end: f64, color: Color, axes: &Axes) -> impl Iterator<Item = Shape> {
    let bottom = axes.plot_area.far_corner().y;
    histogram.iter().enumerate().filter_map(move |(number, density)| {
        let edge = |number: usize| axes.point(end * number as f64 / histogram.len() as f64, *density);
        let [from, to] = [edge(number), edge(number + 1)];
        // Bars are separated by a thin gap.
        let near = Vector::new(from.x.round(), from.y.round());
        let (wide, high) = (larger(to.x.round() - near.x - 1.0, 1.0), bottom - near.y);
        (high >= 0.5).then(|| Shape::Rect { rect: Rect::new(near, wide, high), ink: color.into() })
    })
}

/// The mean energy of a run, the number of its samples, and the part of them that is beyond the end of the axis, `end`
/// m/s.
fn note(run: &SpeedRun, end: f64, language: Language) -> String {
    let temperature = language.decimal(Unit::JOULE.format(run.temperature(), 3));
    let shown = (end / run.top * FINE_BINS as f64).round() as usize;
    let beyond = run.beyond + run.fine.iter().skip(shown).sum::<u64>();
    let faster = match beyond {
        0 => String::new(),
        beyond => {
            let part = language.decimal(format_significant(100.0 * beyond as f64 / run.count as f64, 1));
            format!(",  {part} \"%\" > {}", language.decimal(Unit::METRE_PER_SECOND.format(end, 3)))
        }
    };
    format!("k T = {temperature},  N = {}{faster}", run.count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn histogram_and_distribution_have_the_area_one() {
        let mut run = SpeedRun::new(String::new(), 50.0);
        for at in 0..10_000 {
            run.push(f64::from(at * 7919 % 10_000) / 1000.0, if at % 3 == 0 { 1.0 } else { 4.0 });
        }
        let width = FINE_BINS / 100;
        let area: f64 = run.histogram(width, 100).iter().sum::<f64>() * 0.5;
        assert!((area - 1.0).abs() < 1e-12, "{area}");
        let step = 0.01;
        let area: f64 = (0..5000).map(|at| run.maxwell_boltzmann((f64::from(at) + 0.5) * step) * step).sum();
        assert!((area - 1.0).abs() < 1e-4, "{area}");
        // The mean energy of the distribution is k·T, whatever the masses.
        let one = SpeedRun { masses: [(1, (2.0, 1))].into(), count: 1, kinetic: 3.0, ..run };
        let energy = |speed: f64| one.maxwell_boltzmann(speed) * speed * speed * step;
        let mean: f64 = (0..5000).map(|at| energy((f64::from(at) + 0.5) * step)).sum();
        assert!((mean - 3.0).abs() < 1e-3, "{mean}");
    }

    #[test]
    fn few_fast_bodies_do_not_flatten_the_diagram() {
        let mut run = SpeedRun::new(String::new(), 1000.0);
        (0..2000).for_each(|_| run.push(1.0, 1.0));
        run.push(1000.0, 1.0);
        assert!(run.fine_bins_shown() < FINE_BINS / 100);
        let mut run = SpeedRun::new(String::new(), 2.0);
        (0..90).for_each(|_| run.push(1.0, 1.0));
        (0..10).for_each(|_| run.push(1000.0, 1.0));
        assert_eq!((run.fine_bins_shown(), run.beyond), (FINE_BINS, 10));
        assert!(note(&run, 2.0, Language::English).contains("10 \"%\" > 2"), "{}", note(&run, 2.0, Language::English));
        assert!((run.histogram(FINE_BINS, 1)[0] - 0.45).abs() < 1e-12, "nine tenths of the samples are shown");
    }
}
