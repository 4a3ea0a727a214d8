use super::panels::{Panels, extent, outline, world_view};
use super::run::legend;
use super::{FigureOptions, Run};
use crate::physics::{Rect, Vector};
use crate::render::area::inset;
use crate::render::layers::{self, Page};
use crate::render::text::Line;
use crate::render::{DisplayList, Frame, Look};

/// Chosen instants side by side, each with its time: read like a page, row by row. Of several runs
/// each has its own row, or as many as suit it, one below the other.
pub fn filmstrip(runs: &[Run], options: &FigureOptions) -> DisplayList {
    let mut panels = Panels::new(options, &legend(runs, options));
    let titles: Vec<&str> = runs.iter().map(|run| run.title.as_str()).collect();
    let page = panels.room;
    for (run, place) in runs.iter().zip(panels.titled(&titles, 1)) {
        panels.room = place;
        let columns = panels.columns(&vec![extent(run, options); run.frames.len()], 1.3 * panels.look.text);
        for (frame, place) in run.frames.iter().zip(panels.grid(run.frames.len(), columns)) {
            picture(run, frame, &place, &mut panels, options);
        }
        panels.room = page;
    }
    panels.finish()
}

/// One instant, with its time below.
fn picture(run: &Run, frame: &Frame, place: &Rect, panels: &mut Panels, options: &FigureOptions) {
    let look = Look { text: (0.8 * panels.look.text).round(), ..panels.look };
    let room = Rect::new(place.origin, place.width(), place.height() - 1.6 * look.text);
    let view = world_view(&room, look.line, run, frame, options);
    let world = inset(&view.camera.window, look.line);
    let page = Page { view: &view, camera: view.camera, look };
    panels.shapes.push(layers::backdrop(frame, &page));
    panels.shapes.push(layers::world(frame, &page));
    panels.shapes.extend(outline(&world, look.line, look.palette.wall_edge.into()));
    let time = Line::math(&format!("t = {:.2} \"s\"", frame.time), look.text);
    panels.centered(
        time,
        Vector::new(world.center().x, world.far_corner().y + 1.3 * look.text),
        look.palette.ink.into(),
    );
}
