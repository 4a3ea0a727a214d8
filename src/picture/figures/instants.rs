//! Figures of several instants of a run: in one picture, or side by side.

use super::panels::{Panels, TITLE, outline, target_extent, world_view};
use super::{FigureRun, legend};
use crate::physics::{Rect, Vector};
use crate::picture::layers::bodies::draw_box;
use crate::picture::layers::{self, LayoutContext};
use crate::picture::number::{TimeFormat, Unit};
use crate::picture::text::Line;
use crate::picture::{Color, DisplayList, DrawingMetrics, Frame, Ink, Shape, Sprite, Style, color};

/// Draws several instants in one picture, earlier ones fainter, to show motion.
pub fn strobe(runs: &[FigureRun], style: &Style) -> DisplayList {
    let mut panels = Panels::new(style, &legend(runs, style));
    let titles: Vec<&str> = runs.iter().map(|run| run.title.as_str()).collect();
    let extents: Vec<Vector> = runs.iter().map(|run| target_extent(run, style)).collect();
    let columns = panels.columns(&extents, (TITLE + 1.6) * panels.metrics.font_size);
    for (run, cell) in runs.iter().zip(panels.titled_cells(&titles, columns)) {
        draw_strobe(run, &cell, &mut panels, style);
    }
    panels.finish()
}

fn draw_strobe(run: &FigureRun, cell: &Rect, panels: &mut Panels, style: &Style) {
    let Some((last, earlier)) = run.frames.split_last() else { return };
    let panel = Rect::new(cell.origin, cell.width(), cell.height() - 1.6 * panels.metrics.font_size);
    let view = world_view(&panel, panels.metrics.font_size.round(), run, last, style);
    let context = LayoutContext { view: &view, camera: view.camera, metrics: panels.metrics };
    panels.shapes.push(layers::backdrop(last, &context));
    if !last.sprites.iter().any(|sprite| sprite.appearance.is_wall) {
        let thin = (panels.metrics.line_width / 2.0).ceil();
        panels.shapes.extend(outline(&view.camera.viewport, thin, panels.metrics.palette.grid.into()));
    }
    panels.shapes.push(ghosts(earlier, last, &context));
    panels.shapes.push(layers::foreground(last, &context));
    let times = Line::math(&time_label(&run.frames, style.time_format), panels.metrics.font_size);
    let viewport = view.camera.viewport;
    let at = Vector::new(viewport.center().x, viewport.far_corner().y + 1.2 * panels.metrics.font_size);
    panels.centered(times, at, panels.metrics.palette.ink.into());
}

/// The label with the times of first and last frame and the time between frames.
fn time_label(frames: &[Frame], format: TimeFormat) -> String {
    match frames {
        [] => String::new(),
        [only] => format!("t = {} \"{}\"", format.number(only.time), format.unit()),
        [first, .., last] => {
            let interval = (last.time - first.time) / (frames.len() - 1) as f64;
            let [from, to] = [first, last].map(|frame| format.number(frame.time));
            format!("t = {from} … {to} \"{}\",  Δt = {}", format.unit(), Unit::SECOND.format(interval, 2))
        }
    }
}

/// The moving bodies at earlier instants.
fn ghosts(earlier: &[Frame], last: &Frame, context: &LayoutContext) -> Shape {
    let mut shapes = Vec::new();
    for (index, frame) in earlier.iter().enumerate() {
        for sprite in frame.sprites.iter().filter(|sprite| !sprite.appearance.is_wall && has_moved(sprite, last)) {
            let Some(rect) = context.visible_rect(sprite) else { continue };
            let fill = color::body_color(sprite, &context.view.style);
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
    let percent = 75 - 45 * index / count;
    color.mix(context.metrics.palette.background, percent as u8)
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

/// Draws selected instants side by side with their times, row by row. With several runs, each run has one or more rows
/// of its own.
pub fn filmstrip(runs: &[FigureRun], style: &Style) -> DisplayList {
    let mut panels = Panels::new(style, &legend(runs, style));
    let titles: Vec<&str> = runs.iter().map(|run| run.title.as_str()).collect();
    let page_content = panels.content;
    for (run, cell) in runs.iter().zip(panels.titled_cells(&titles, 1)) {
        panels.content = cell;
        let columns =
            panels.columns(&vec![target_extent(run, style); run.frames.len()], 1.3 * panels.metrics.font_size);
        for (frame, cell) in run.frames.iter().zip(panels.grid(run.frames.len(), columns)) {
            draw_instant(run, frame, &cell, &mut panels, style);
        }
        panels.content = page_content;
    }
    panels.finish()
}

/// Draws one instant, with its time below.
fn draw_instant(run: &FigureRun, frame: &Frame, cell: &Rect, panels: &mut Panels, style: &Style) {
    let metrics = DrawingMetrics { font_size: (0.8 * panels.metrics.font_size).round(), ..panels.metrics };
    let panel = Rect::new(cell.origin, cell.width(), cell.height() - 1.6 * metrics.font_size);
    let view = world_view(&panel, metrics.line_width, run, frame, style);
    let world = view.camera.viewport.inset(metrics.line_width);
    let context = LayoutContext { view: &view, camera: view.camera, metrics };
    panels.shapes.push(layers::backdrop(frame, &context));
    panels.shapes.push(layers::foreground(frame, &context));
    panels.shapes.extend(outline(&world, metrics.line_width, metrics.palette.wall_edge.into()));
    let time = Line::math(&time_label(std::slice::from_ref(frame), style.time_format), metrics.font_size);
    panels.centered(
        time,
        Vector::new(world.center().x, world.far_corner().y + 1.3 * metrics.font_size),
        metrics.palette.ink.into(),
    );
}
