use super::panels::{Panels, outline, target_extent, world_view};
use super::run::legend;
use super::{FigureOptions, FigureRun};
use crate::physics::{Rect, Vector};
use crate::render::area::inset;
use crate::render::layers::{self, LayoutContext};
use crate::render::text::Line;
use crate::render::{DisplayList, Frame, Metrics};

/// Draws selected instants side by side with their times, row by row. With several runs, each run has one or more rows
/// of its own.
pub fn filmstrip(runs: &[FigureRun], options: &FigureOptions) -> DisplayList {
    let mut panels = Panels::new(options, &legend(runs, options));
    let titles: Vec<&str> = runs.iter().map(|run| run.title.as_str()).collect();
    let page_content = panels.content;
    for (run, cell) in runs.iter().zip(panels.titled_cells(&titles, 1)) {
        panels.content = cell;
        let columns =
            panels.columns(&vec![target_extent(run, options); run.frames.len()], 1.3 * panels.metrics.font_size);
        for (frame, cell) in run.frames.iter().zip(panels.grid(run.frames.len(), columns)) {
            picture(run, frame, &cell, &mut panels, options);
        }
        panels.content = page_content;
    }
    panels.finish()
}

/// Draws one instant, with its time below.
fn picture(run: &FigureRun, frame: &Frame, cell: &Rect, panels: &mut Panels, options: &FigureOptions) {
    let metrics = Metrics { font_size: (0.8 * panels.metrics.font_size).round(), ..panels.metrics };
    let panel = Rect::new(cell.origin, cell.width(), cell.height() - 1.6 * metrics.font_size);
    let view = world_view(&panel, metrics.line_width, run, frame, options);
    let world = inset(&view.camera.viewport, metrics.line_width);
    let context = LayoutContext { view: &view, camera: view.camera, metrics };
    panels.shapes.push(layers::backdrop(frame, &context));
    panels.shapes.push(layers::foreground(frame, &context));
    panels.shapes.extend(outline(&world, metrics.line_width, metrics.palette.wall_edge.into()));
    let time = Line::math(&format!("t = {:.2} \"s\"", frame.time), metrics.font_size);
    panels.centered(
        time,
        Vector::new(world.center().x, world.far_corner().y + 1.3 * metrics.font_size),
        metrics.palette.ink.into(),
    );
}
