use super::FigureOptions;
use super::panels::{Panels, world_view};
use crate::physics::{Rect, Vector};
use crate::render::layers::bodies::{draw_box, seen};
use crate::render::layers::{self, Page};
use crate::render::text::Line;
use crate::render::{Color, DisplayList, Frame, Ink, Shape, Sprite, palette};

/// Many instants in one picture, the earlier the fainter: how things moved.
pub fn strobe(frames: &[Frame], options: &FigureOptions) -> DisplayList {
    let mut panels = Panels::new(options);
    let Some((last, earlier)) = frames.split_last() else { return panels.finish() };
    let room = panels.room;
    let above = Rect::new(room.origin, room.width(), room.height() - 1.6 * panels.look.text);
    let view = world_view(&above, panels.look.text.round(), options);
    let page = Page { view: &view, look: panels.look };
    panels.shapes.push(layers::backdrop(last, &page));
    panels.shapes.push(ghosts(earlier, last, &page));
    panels.shapes.push(layers::world(last, &page));
    let times = Line::math(&span(frames), panels.look.text);
    let window = view.camera.window;
    let at = Vector::new(window.center().x, window.far_corner().y + 1.2 * panels.look.text);
    panels.centered(times, at, panels.look.palette.ink.into());
    panels.finish()
}

/// From when to when, and how often.
fn span(frames: &[Frame]) -> String {
    match frames {
        [] => String::new(),
        [only] => format!("t = {:.2} \"s\"", only.time),
        [first, .., last] => {
            let apart = (last.time - first.time) / (frames.len() - 1) as f64;
            let apart = super::number::significant(apart, 2);
            format!("t = {:.2} … {:.2} \"s\",  Δt = {apart} \"s\"", first.time, last.time)
        }
    }
}

/// The bodies that move, as they were at earlier instants.
fn ghosts(earlier: &[Frame], last: &Frame, page: &Page) -> Shape {
    let mut shapes = Vec::new();
    for (age, frame) in earlier.iter().enumerate() {
        for sprite in frame.sprites.iter().filter(|sprite| moves(sprite, last)) {
            let Some(rect) = seen(sprite, page) else { continue };
            let fill = palette::body_color(sprite, &page.view.style);
            ghost(&rect, faint(fill, age, earlier.len(), page), page, &mut shapes);
        }
    }
    Shape::Clip { window: page.view.camera.window, shapes }
}

/// Whether a body is elsewhere, or gone, at the last instant.
fn moves(sprite: &Sprite, last: &Frame) -> bool {
    let id = sprite.appearance.id;
    let now = last.sprites.iter().find(|now| now.appearance.id == id);
    now.is_none_or(|now| now.rect != sprite.rect)
}

/// From a quarter of a colour at the first of `count` instants to nearly all of it.
fn faint(color: Color, age: usize, count: usize, page: &Page) -> Color {
    let part = 75 - 45 * age / count;
    color.mix(page.look.palette.background, part as u8)
}

/// A box of which what is behind it can be seen.
fn ghost(rect: &Rect, fill: Color, page: &Page, shapes: &mut Vec<Shape>) {
    let mut opaque = Vec::new();
    draw_box(rect, fill, &page.look, &mut opaque);
    shapes.extend(opaque.into_iter().map(|shape| match shape {
        Shape::Rect { rect, ink } => Shape::Rect { rect, ink: Ink { opacity: 200, ..ink } },
        other => other,
    }));
}
