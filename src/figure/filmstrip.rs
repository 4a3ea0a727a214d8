use super::FigureOptions;
use super::panels::{Panels, outline, world_view};
use crate::physics::{Rect, Vector};
use crate::render::area::inset;
use crate::render::layers::{self, Page};
use crate::render::text::Line;
use crate::render::{DisplayList, Frame, Look};

/// Chosen instants side by side, each with its time: read like a page, row by row.
pub fn filmstrip(frames: &[Frame], options: &FigureOptions) -> DisplayList {
    let mut panels = Panels::new(options);
    let columns = columns(frames.len(), &panels.room, options.world);
    for (frame, place) in frames.iter().zip(panels.grid(frames.len(), columns)) {
        picture(frame, &place, &mut panels, options);
    }
    panels.finish()
}

/// The number of columns with which the world is seen largest.
fn columns(count: usize, room: &Rect, world: Vector) -> usize {
    let scale = |columns: usize| {
        let rows = count.div_ceil(columns) as f64;
        let (across, down) = (room.width() / columns as f64 / world.x, room.height() / rows / world.y);
        if across < down { across } else { down }
    };
    (1..=count).reduce(|best, columns| if scale(columns) > scale(best) { columns } else { best }).unwrap_or(1)
}

/// One instant, with its time below.
fn picture(frame: &Frame, place: &Rect, panels: &mut Panels, options: &FigureOptions) {
    let look = Look { text: (0.8 * panels.look.text).round(), ..panels.look };
    let room = Rect::new(place.origin, place.width(), place.height() - 1.6 * look.text);
    let view = world_view(&room, look.line, options);
    let world = inset(&view.camera.window, look.line);
    let page = Page { view: &view, look };
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
