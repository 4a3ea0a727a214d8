use super::panels::{Panels, TITLE, outline, target_extent, world_view};
use super::run::legend;
use super::{FigureOptions, FigureRun};
use crate::physics::{Rect, Vector};
use crate::render::layers::bodies::{draw_box, visible_rect};
use crate::render::layers::{self, LayoutContext};
use crate::render::number_format::format_significant;
use crate::render::text::Line;
use crate::render::{Color, DisplayList, Frame, Ink, Shape, Sprite, palette};

/// Draws several instants in one picture, earlier ones fainter, to show motion.
pub fn strobe(runs: &[FigureRun], options: &FigureOptions) -> DisplayList {
    let mut panels = Panels::new(options, &legend(runs, options));
    let titles: Vec<&str> = runs.iter().map(|run| run.title.as_str()).collect();
    let extents: Vec<Vector> = runs.iter().map(|run| target_extent(run, options)).collect();
    let columns = panels.columns(&extents, (TITLE + 1.6) * panels.metrics.font_size);
    for (run, cell) in runs.iter().zip(panels.titled_cells(&titles, columns)) {
        picture(run, &cell, &mut panels, options);
    }
    panels.finish()
}

fn picture(run: &FigureRun, cell: &Rect, panels: &mut Panels, options: &FigureOptions) {
    let Some((last, earlier)) = run.frames.split_last() else { return };
    let panel = Rect::new(cell.origin, cell.width(), cell.height() - 1.6 * panels.metrics.font_size);
    let view = world_view(&panel, panels.metrics.font_size.round(), run, last, options);
    let context = LayoutContext { view: &view, camera: view.camera, metrics: panels.metrics };
    panels.shapes.push(layers::backdrop(last, &context));
    if !last.sprites.iter().any(|sprite| sprite.appearance.is_wall) {
        let thin = (panels.metrics.line_width / 2.0).ceil();
        panels.shapes.extend(outline(&view.camera.viewport, thin, panels.metrics.palette.grid.into()));
    }
    panels.shapes.push(ghosts(earlier, last, &context));
    panels.shapes.push(layers::foreground(last, &context));
    let times = Line::math(&time_label(&run.frames), panels.metrics.font_size);
    let viewport = view.camera.viewport;
    let at = Vector::new(viewport.center().x, viewport.far_corner().y + 1.2 * panels.metrics.font_size);
    panels.centered(times, at, panels.metrics.palette.ink.into());
}

/// The label with the times of first and last frame and the time between frames.
fn time_label(frames: &[Frame]) -> String {
    match frames {
        [] => String::new(),
        [only] => format!("t = {:.2} \"s\"", only.time),
        [first, .., last] => {
            let interval = (last.time - first.time) / (frames.len() - 1) as f64;
            let interval = format_significant(interval, 2);
            format!("t = {:.2} … {:.2} \"s\",  Δt = {interval} \"s\"", first.time, last.time)
        }
    }
}

/// The moving bodies at earlier instants.
fn ghosts(earlier: &[Frame], last: &Frame, context: &LayoutContext) -> Shape {
    let mut shapes = Vec::new();
    for (index, frame) in earlier.iter().enumerate() {
        for sprite in frame.sprites.iter().filter(|sprite| has_moved(sprite, last)) {
            let Some(rect) = visible_rect(sprite, context) else { continue };
            let fill = palette::body_color(sprite, &context.view.style);
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
