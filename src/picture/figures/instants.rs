//! Figures of several instants of a run: in one picture, or side by side.

use super::panels::{Layout, Panels, TITLE, fitted_math, missing_panel, outline, target_extent, world_view};
use super::{FigureRun, MissingInstant, legend};
use crate::physics::{Rect, Vector, larger, smaller};
use crate::picture::layers::bodies::{draw_box, image_of};
use crate::picture::layers::footer::gap_text;
use crate::picture::layers::{self, LayoutContext};
use crate::picture::number::Unit;
use crate::picture::text::Line;
use crate::picture::view::MIN_TEXT;
use crate::picture::{Color, DisplayList, DrawingMetrics, Frame, Ink, RenderError, Shape, Sprite, Style, color};

/// Draws several instants in one picture, earlier ones fainter, to show motion.
///
/// # Errors
/// If the page is too small.
pub fn strobe(runs: &[FigureRun], style: &Style) -> Result<DisplayList, RenderError> {
    let times: Vec<String> = runs.iter().map(|run| time_label(&run.frames, style)).collect();
    let titles: Vec<&str> = runs.iter().map(|run| run.title.as_str()).collect();
    let fits = |cell: &Rect, metrics: &DrawingMetrics| is_world_legible(cell, &times, metrics);
    let layout = Layout {
        legend: &|metrics| legend(runs, style, metrics),
        shape: widest(runs, style),
        text_height: TITLE + TIME,
        ..Layout::new(style, &titles, &fits)
    };
    let (mut panels, cells) = layout.lay_out()?;
    let extent = widest(runs, style);
    for (run, cell) in runs.iter().zip(cells) {
        panels.clip(&cell, |panels| draw_strobe(run, extent, &cell, panels, style));
    }
    Ok(panels.finish())
}

/// Height of the times below a picture of the world, in font sizes.
const TIME: f64 = 1.6;

/// The largest width and height of the camera targets, m.
fn widest(runs: &[FigureRun], style: &Style) -> Vector {
    let extents = runs.iter().map(|run| target_extent(run, style));
    extents.reduce(|widest, extent| widest.max(extent)).unwrap_or(Vector::new(1.0, 1.0))
}

/// Returns true if a picture of the world with its times below is legible in a cell.
fn is_world_legible(cell: &Rect, times: &[String], metrics: &DrawingMetrics) -> bool {
    let width = times.iter().map(|time| Line::math(time, metrics.text(0.7)).width).fold(0.0, larger);
    cell.width() >= larger(width, 5.0 * metrics.font_size) && cell.height() >= (TIME + 3.0) * metrics.font_size
}

fn draw_strobe(run: &FigureRun, extent: Vector, cell: &Rect, panels: &mut Panels, style: &Style) {
    let Some((last, earlier)) = run.frames.split_last() else { return };
    let panel = Rect::new(cell.origin, cell.width(), cell.height() - TIME * panels.metrics.font_size);
    let view = world_view(&panel, panels.metrics.font_size.round(), run, extent, Some(last), style);
    let context = LayoutContext { view: &view, camera: view.camera, metrics: panels.metrics };
    panels.shapes.push(layers::backdrop(last, &context));
    if !last.sprites.iter().any(|sprite| sprite.appearance.is_wall) {
        let thin = (panels.metrics.line_width / 2.0).ceil();
        panels.shapes.extend(outline(&view.camera.viewport, thin, panels.metrics.palette.grid.into()));
    }
    panels.shapes.push(ghosts(earlier, last, &context));
    panels.shapes.push(layers::foreground(last, &context));
    let times = time_label(&run.frames, style);
    let times = fitted_math(&times, panels.metrics.font_size, MIN_TEXT, cell.width());
    let viewport = view.camera.viewport;
    let at = Vector::new(cell.center().x, viewport.far_corner().y + 1.2 * panels.metrics.font_size);
    panels.centered(times, at, panels.metrics.palette.ink.into());
}

/// The label with the times of first and last frame and the time between frames.
fn time_label(frames: &[Frame], style: &Style) -> String {
    let format = style.time_format;
    match frames {
        [] => String::new(),
        [only] => instant_label(only.time, style),
        [first, .., last] => {
            // The least one: instants that the recording lacks are left out.
            let intervals = frames.windows(2).map(|pair| pair[1].time - pair[0].time);
            let interval = intervals.fold(last.time - first.time, smaller);
            let [from, to] = [first, last].map(|frame| format.number(frame.time));
            let interval = style.look.language.decimal(Unit::SECOND.format(interval, 2));
            format!("t = {from} … {to} \"{}\",  Δt = {interval}", format.unit())
        }
    }
}

/// The label of an instant, s.
fn instant_label(time: f64, style: &Style) -> String {
    format!("t = {} \"{}\"", style.time_format.number(time), style.time_format.unit())
}

/// The moving bodies at earlier instants.
fn ghosts(earlier: &[Frame], last: &Frame, context: &LayoutContext) -> Shape {
    let mut shapes = Vec::new();
    for (index, frame) in earlier.iter().enumerate() {
        for sprite in frame.sprites.iter().filter(|sprite| !sprite.appearance.is_wall && has_moved(sprite, last)) {
            let Some(rect) = context.visible_rect(sprite) else { continue };
            let fill = color::body_color(sprite, &context.view.style);
            if let Some(image) = image_of(sprite, &context.view.style) {
                let opacity = (255 * (100 - faded_percent(index, earlier.len())) / 100) as u8;
                shapes.push(Shape::Image { bitmap: image.clone(), rect, opacity });
                continue;
            }
            draw_ghost(&rect, faded(fill, index, earlier.len(), context), context, &mut shapes);
        }
    }
    Shape::Clip { window: context.camera.viewport, shapes }
}

/// Returns true if a body is elsewhere or deleted in the last frame.
fn has_moved(sprite: &Sprite, last: &Frame) -> bool {
    let id = sprite.appearance.id;
    let current =
        last.sprites.binary_search_by_key(&id, |current| current.appearance.id).ok().map(|at| &last.sprites[at]);
    current.is_none_or(|current| current.rect != sprite.rect)
}

/// Fades a colour towards the background: from 25 % of it at the first of `count` instants to almost 70 % at the last.
fn faded(color: Color, index: usize, count: usize, context: &LayoutContext) -> Color {
    color.mix(context.metrics.palette.background, faded_percent(index, count) as u8)
}

/// The part of the background in the colour of an instant, %.
fn faded_percent(index: usize, count: usize) -> usize {
    75 - 45 * index / count
}

/// Draws a box semi-transparently.
fn draw_ghost(rect: &Rect, fill: Color, context: &LayoutContext, shapes: &mut Vec<Shape>) {
    let mut opaque = Vec::new();
    draw_box(rect, fill, &context.metrics, &mut opaque);
    shapes.extend(opaque.into_iter().map(|shape| match shape {
        Shape::Rect { rect, ink } => Shape::Rect { rect, ink: Ink { opacity: 200, ..ink } },
        other => other,
    }));
}

/// Draws selected instants side by side with their times, row by row, all on one scale. With several runs, each run has
/// one or more rows of its own. An instant that a recording lacks is a hatched panel with the reason.
///
/// # Errors
/// If the page is too small.
pub fn filmstrip(runs: &[FigureRun], style: &Style) -> Result<DisplayList, RenderError> {
    let extent = widest(runs, style);
    let count = runs.iter().map(|run| run.frames.len() + run.missing.len()).max().unwrap_or(1);
    let strips: Vec<Vec<Instant>> = runs.iter().map(strip).collect();
    let mut times: Vec<String> = strips.iter().flatten().map(|instant| instant_label(instant.time(), style)).collect();
    times.sort_unstable();
    times.dedup();
    let cells_of = |cell: &Rect, metrics: &DrawingMetrics| {
        let panels = Panels::of_cell(cell, metrics);
        panels.grid(count, panels.columns(count, extent, 1.3 * metrics.font_size))
    };
    let is_legible = |cell: &Rect, metrics: &DrawingMetrics| {
        // All panels have one size.
        let panels = cells_of(cell, metrics);
        panels.first().is_none_or(|panel| is_world_legible(panel, &times, &instant_metrics(metrics)))
    };
    let titles: Vec<&str> = runs.iter().map(|run| run.title.as_str()).collect();
    let layout = Layout {
        legend: &|metrics| legend(runs, style, &instant_metrics(metrics)),
        shape: Vector::new(extent.x * count as f64, extent.y),
        text_height: TITLE + TIME,
        ..Layout::new(style, &titles, &is_legible)
    };
    let (mut panels, cells) = layout.lay_out()?;
    for ((run, strip), cell) in runs.iter().zip(&strips).zip(cells) {
        for (instant, panel) in strip.iter().zip(cells_of(&cell, &panels.metrics)) {
            panels.clip(&panel, |panels| draw_instant(run, instant, extent, &panel, panels, style));
        }
    }
    Ok(panels.finish())
}

/// An instant of a filmstrip.
#[derive(Clone, Copy)]
enum Instant<'a> {
    Frame(&'a Frame),
    Missing(&'a MissingInstant),
}

impl Instant<'_> {
    /// Simulated time, s.
    fn time(&self) -> f64 {
        match self {
            Instant::Frame(frame) => frame.time,
            Instant::Missing(missing) => missing.time,
        }
    }
}

/// All instants of a run, in the order of time.
fn strip(run: &FigureRun) -> Vec<Instant<'_>> {
    let frames = run.frames.iter().map(Instant::Frame);
    let mut strip: Vec<Instant> = frames.chain(run.missing.iter().map(Instant::Missing)).collect();
    strip.sort_by(|a, b| a.time().total_cmp(&b.time()));
    strip
}

/// The metrics of a picture in a filmstrip, whose arrows are shorter because it is small.
fn instant_metrics(metrics: &DrawingMetrics) -> DrawingMetrics {
    let font_size = metrics.text(0.8).round();
    DrawingMetrics { font_size, arrow_length: 3.0 * font_size, ..*metrics }
}

/// Draws one instant, with its time below.
fn draw_instant(run: &FigureRun, instant: &Instant, extent: Vector, cell: &Rect, panels: &mut Panels, style: &Style) {
    let metrics = instant_metrics(&panels.metrics);
    let panel = Rect::new(cell.origin, cell.width(), cell.height() - TIME * metrics.font_size);
    let frame = match instant {
        Instant::Frame(frame) => Some(*frame),
        Instant::Missing(_) => None,
    };
    let view = world_view(&panel, metrics.line_width, run, extent, frame, style);
    let world = view.camera.viewport.inset(metrics.line_width);
    let context = LayoutContext { view: &view, camera: view.camera, metrics };
    match instant {
        Instant::Frame(frame) => {
            panels.shapes.push(layers::backdrop(frame, &context));
            panels.shapes.push(layers::foreground(frame, &context));
        }
        Instant::Missing(missing) => {
            panels.shapes.push(missing_panel(&world, &gap_text(&missing.gap, style.look.language), &metrics));
        }
    }
    panels.shapes.extend(outline(&world, metrics.line_width, metrics.palette.wall_edge.into()));
    panels.centered(
        fitted_math(&instant_label(instant.time(), style), metrics.font_size, MIN_TEXT, cell.width()),
        Vector::new(cell.center().x, world.far_corner().y + 1.3 * metrics.font_size),
        metrics.palette.ink.into(),
    );
}
