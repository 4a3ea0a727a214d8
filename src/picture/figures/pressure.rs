use super::axes::{Axes, AxisTitles, Range, Scale};
use super::lines::run_color;
use super::panels::{Layout, Panels};
use super::pressure_run::{PressureRun, WallSide};
use super::timeline::{draw_timeline, timeline_legend};
use crate::physics::{Axis, Rect, Side, Vector, larger};
use crate::picture::layers::footer::{Entry, Legend, MAX_NAME_CHARS, quoted};
use crate::picture::number::Unit;
use crate::picture::text::{Line, truncated};
use crate::picture::{Color, DisplayList, DrawingMetrics, Ink, Language, Palette, RenderError, Style};

/// A curve of a diagram.
struct Curve {
    color: Color,
    /// Its width, in line widths.
    width: f64,
    parts: Vec<Vec<[f64; 2]>>,
}

/// The curves of one run: pressure against time, and against the volume if that changes.
struct Curves {
    over_time: Vec<Curve>,
    over_volume: Vec<Curve>,
}

/// Draws the pressure on the sides of walls and pistons over `time` (s), beside that of an ideal gas with the same
/// kinetic energy, and over the volume where that changes. Several runs have the same scales.
///
/// # Errors
/// If the page is too small.
pub fn pressure(runs: &[PressureRun], time: Range, style: &Style) -> Result<DisplayList, RenderError> {
    let language = style.look.language;
    let names = side_names(runs, language);
    let curves: Vec<Curves> = runs.iter().map(|run| curves(run, &names, style)).collect();
    let values = |over: fn(&Curves) -> &Vec<Curve>, at: usize| {
        curves.iter().flat_map(over).flat_map(|curve| &curve.parts).flatten().map(move |point| point[at])
    };
    let highest = values(|all| &all.over_time, 1).chain(values(|all| &all.over_volume, 1)).fold(0.0, larger);
    let p = Scale::linear(
        Range { from: 0.0, to: if highest > 0.0 { 1.06 * highest } else { 1.0 } },
        Unit::NEWTON_PER_METRE,
    );
    let volumes = Range::of(values(|all| &all.over_volume, 0)).map(|volumes| volumes.widened(0.05));
    let volume = volumes.map(|volumes| Scale::linear(volumes, Unit::SQUARE_METRE));
    let t = Scale::linear(time, Unit::SECOND);
    let notes: Vec<String> = runs.iter().map(|run| note(run, language)).collect();
    let fits = |cell: &Rect, metrics: &DrawingMetrics| {
        let areas = split(cell, volume.is_some(), metrics);
        let plot = |panel: &Rect| Axes::within(panel, t, p, 0.0, metrics).plot_area;
        let title = Line::math(&p.title("p"), metrics.text(0.9)).width + metrics.font_size;
        let note = notes.iter().map(|note| Line::math(note, metrics.text(0.8)).width).fold(0.0, larger);
        areas.iter().all(|area| {
            plot(area).width() >= larger(6.0 * metrics.font_size, title)
                && plot(area).height() >= 4.0 * metrics.font_size
        }) && plot(&areas[0]).width() >= title + note
    };
    let titles: Vec<&str> = runs.iter().map(|run| run.title.as_str()).collect();
    let layout = Layout {
        legend: &|metrics| legend(runs, &names, style, metrics),
        shape: Vector::new(1.5, 1.0),
        ..Layout::new(style, &titles, &fits)
    };
    let (mut panels, cells) = layout.lay_out()?;
    for (at, cell) in cells.iter().enumerate() {
        panels.clip(cell, |panels| {
            let areas = split(cell, volume.is_some(), &panels.metrics);
            let axes = Axes::within(&areas[0], t, p, 0.0, &panels.metrics);
            axes.draw(&AxisTitles { x: &t.title("t"), y: &p.title("p") }, &panels.metrics, &mut panels.shapes);
            draw_timeline(&runs[at].timeline, &axes, panels);
            draw_curves(&curves[at].over_time, &axes, panels);
            let note = Line::math(&notes[at], panels.metrics.text(0.8));
            axes.draw_note(note, &panels.metrics, &mut panels.shapes);
            if let (Some(area), Some(volume)) = (areas.get(1), volume) {
                let axes = Axes::within(area, volume, p, 0.0, &panels.metrics);
                let titles = AxisTitles { x: &volume.title("V"), y: &p.title("p") };
                axes.draw(&titles, &panels.metrics, &mut panels.shapes);
                draw_curves(&curves[at].over_volume, &axes, panels);
            }
        });
    }
    Ok(panels.finish())
}

/// The areas of the diagrams of a cell: side by side in a wide cell, else one above the other.
fn split(cell: &Rect, has_volume: bool, metrics: &DrawingMetrics) -> Vec<Rect> {
    if has_volume {
        Panels::of_cell(cell, metrics).grid(2, if cell.width() > 1.4 * cell.height() { 2 } else { 1 })
    } else {
        vec![*cell]
    }
}

fn draw_curves(curves: &[Curve], axes: &Axes, panels: &mut Panels) {
    for Curve { color, width, parts } in curves {
        for part in parts {
            let width = width * panels.metrics.line_width;
            panels.shapes.push(axes.curve(part.iter().copied(), width, Ink::from(*color)));
        }
    }
}

/// The names of all sides of all runs, in the order in which they were hit. The side is named if two sides of a wall
/// were hit.
fn side_names(runs: &[PressureRun], language: Language) -> Vec<(String, Axis, Side, String)> {
    let mut names: Vec<(String, Axis, Side, String)> = Vec::new();
    for side in runs.iter().flat_map(|run| &run.sides) {
        if !names.iter().any(|(name, axis, end, _)| (name, *axis, *end) == (&side.name, side.axis, side.side)) {
            names.push((side.name.clone(), side.axis, side.side, String::new()));
        }
    }
    names.sort();
    let count = |name: &str| names.iter().filter(|(other, ..)| other == name).count();
    let is_single: Vec<bool> = names.iter().map(|(name, ..)| count(name) == 1).collect();
    for ((name, axis, side, label), is_single) in names.iter_mut().zip(is_single) {
        let word = match (axis, side) {
            (Axis::X, Side::Low) => language.of("left", "gauche"),
            (Axis::X, Side::High) => language.of("right", "droite"),
            (Axis::Y, Side::Low) => language.of("top", "haut"),
            (Axis::Y, Side::High) => language.of("bottom", "bas"),
        };
        *label = if is_single { name.clone() } else { format!("{name}, {word}") };
    }
    names
}

/// The colour of a side.
fn side_color(side: &WallSide, names: &[(String, Axis, Side, String)], style: &Style) -> Color {
    let is_side =
        |(name, axis, end, _): &(String, Axis, Side, String)| (name, *axis, *end) == (&side.name, side.axis, side.side);
    let place = names.iter().position(is_side).unwrap_or(0);
    Palette::of(style.look.theme).line(run_color(place, names.len(), style))
}

/// The colours of the pressures of an ideal gas along x and y.
fn ideal_colors(palette: &Palette) -> [Color; 2] {
    [palette.ink, palette.muted]
}

/// The curves of a run: those of the ideal gas above the steps, which they approach.
fn curves(run: &PressureRun, names: &[(String, Axis, Side, String)], style: &Style) -> Curves {
    let palette = Palette::of(style.look.theme);
    let count = interval_count(run.sides.iter().map(|side| side.count).max().unwrap_or(0));
    let (mut over_time, mut over_volume) = (Vec::new(), Vec::new());
    let is_any_moving = run.sides.iter().any(|side| side.is_moving);
    for side in &run.sides {
        let (color, pressures) = (side_color(side, names, style), run.pressures(side, count));
        let step = |[from, to]: [f64; 2], pressure: f64| vec![[from, pressure], [to, pressure]];
        over_time.push(Curve { color, width: 1.25, parts: over_spans(&run.spans_of(side, count), &pressures, step) });
        if run.has_changing_volume() && (side.is_moving || !is_any_moving) {
            let ideal = run.ideal(side.axis, count);
            let points = ideal.iter().zip(&pressures).map(|(ideal, pressure)| Some([[(*ideal)?[1], (*pressure)?]]));
            over_volume.push(Curve { color, width: 1.25, parts: parts(points) });
        }
    }
    for axis in Axis::BOTH.into_iter().filter(|axis| run.sides.iter().any(|side| side.axis == *axis)) {
        let (ideal, color) = (run.ideal(axis, IDEAL_POINTS), ideal_colors(&palette)[axis]);
        let point = |[from, to]: [f64; 2], [pressure, _]: [f64; 2]| vec![[f64::midpoint(from, to), pressure]];
        over_time.push(Curve { color, width: 0.75, parts: over_spans(&run.ideal_spans(IDEAL_POINTS), &ideal, point) });
        let is_shown = |side: &WallSide| side.axis == axis && (side.is_moving || !is_any_moving);
        if run.has_changing_volume() && run.sides.iter().any(is_shown) {
            let points = ideal.iter().map(|ideal| Some([[(*ideal)?[1], (*ideal)?[0]]]));
            over_volume.push(Curve { color, width: 0.75, parts: parts(points) });
        }
    }
    Curves { over_time, over_volume }
}

/// The number of intervals for a number of impulses, by which the noise and the number of steps are balanced (the rule
/// of Rice: twice the cube root): a divisor of the number of slices.
fn interval_count(impulses: u64) -> usize {
    const COUNTS: [usize; 12] = [60, 56, 45, 42, 40, 36, 30, 28, 24, 20, 15, 12];
    let is_enough = |count: &usize| (*count as u64).pow(3) <= 8 * impulses;
    COUNTS.into_iter().find(is_enough).unwrap_or(10)
}

/// The number of points of the curve of an ideal gas, a divisor of the number of slices.
const IDEAL_POINTS: usize = 252;

/// The parts of a curve over time, from the values of intervals and the spans of each interval in which they are known,
/// s. A part ends where the next span does not follow at once.
fn over_spans<T: Copy>(
    spans: &[Vec<[f64; 2]>],
    values: &[Option<T>],
    points: impl Fn([f64; 2], T) -> Vec<[f64; 2]>,
) -> Vec<Vec<[f64; 2]>> {
    let (mut parts, mut end) = (Vec::new(), f64::NAN);
    let known = spans.iter().zip(values).filter_map(|(spans, value)| Some((spans, (*value)?)));
    for (span, value) in known.flat_map(|(spans, value)| spans.iter().map(move |span| (*span, value))) {
        if span[0] != end {
            parts.push(Vec::new());
        }
        parts.last_mut().into_iter().for_each(|part: &mut Vec<[f64; 2]>| part.extend(points(span, value)));
        end = span[1];
    }
    parts
}

/// The parts of a curve between missing points.
fn parts<const N: usize>(points: impl Iterator<Item = Option<[[f64; 2]; N]>>) -> Vec<Vec<[f64; 2]>> {
    let mut parts = vec![Vec::new()];
    for point in points {
        match (point, parts.last_mut()) {
            (Some(points), Some(part)) => part.extend(points),
            _ => parts.push(Vec::new()),
        }
    }
    parts.retain(|part: &Vec<[f64; 2]>| !part.is_empty());
    parts
}

/// The mean pressure times the volume beside the mean kinetic energy, which are equal for an ideal gas in two
/// dimensions, if the volume is constant and walls along both axes were hit.
fn note(run: &PressureRun, language: Language) -> String {
    let mean = |axis| run.mean_pressure(axis).zip(run.ideal_pressure(axis));
    let (Some([x, y]), Some(volumes)) = (mean(Axis::X).zip(mean(Axis::Y)).map(|(x, y)| [x, y]), run.volumes) else {
        return String::new();
    };
    if run.has_changing_volume() {
        return String::new();
    }
    let [measured, ideal] = [(x.0 + y.0) / 2.0, (x.1 + y.1) / 2.0].map(|pressure| pressure * volumes.to);
    let [measured, ideal] = [measured, ideal].map(|energy| language.decimal(Unit::JOULE.format(energy, 3)));
    format!("p V = {measured},  E = {ideal}")
}

/// The common legend of all diagrams.
fn legend(
    runs: &[PressureRun],
    names: &[(String, Axis, Side, String)],
    style: &Style,
    metrics: &DrawingMetrics,
) -> Legend {
    let palette = Palette::of(style.look.theme);
    let entry = |(at, (_, _, _, label)): (usize, &(String, Axis, Side, String))| {
        let color = palette.line(run_color(at, names.len(), style));
        Entry { name: quoted(&truncated(label, MAX_NAME_CHARS)), ..Entry::new(color, "") }
    };
    let mut entries: Vec<Entry> = names.iter().enumerate().map(entry).collect();
    for axis in Axis::BOTH {
        let is_shown = |run: &PressureRun| run.volumes.is_some() && run.sides.iter().any(|side| side.axis == axis);
        if runs.iter().any(is_shown) {
            let name = ["Σ m v_x^2 / V", "Σ m v_y^2 / V"][axis].to_owned();
            entries.push(Entry { name, ..Entry::new(ideal_colors(&palette)[axis], "") });
        }
    }
    entries.extend(timeline_legend(runs.iter().map(|run| &run.timeline), style.look.language, metrics));
    Legend { entries }
}
