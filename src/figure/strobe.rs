use super::panels::{Panels, TITLE, extent, outline, world_view};
use super::run::legend;
use super::{FigureOptions, Run};
use crate::physics::{Rect, Vector};
use crate::render::layers::bodies::{draw_box, seen};
use crate::render::layers::{self, Page};
use crate::render::number::significant;
use crate::render::text::Line;
use crate::render::{Color, DisplayList, Frame, Ink, Shape, Sprite, palette};

/// Many instants in one picture, the earlier the fainter: how things moved.
pub fn strobe(runs: &[Run], options: &FigureOptions) -> DisplayList {
    let mut panels = Panels::new(options, &legend(runs, options));
    let titles: Vec<&str> = runs.iter().map(|run| run.title.as_str()).collect();
    let extents: Vec<Vector> = runs.iter().map(|run| extent(run, options)).collect();
    let columns = panels.columns(&extents, (TITLE + 1.6) * panels.look.text);
    for (run, place) in runs.iter().zip(panels.titled(&titles, columns)) {
        picture(run, &place, &mut panels, options);
    }
    panels.finish()
}

fn picture(run: &Run, place: &Rect, panels: &mut Panels, options: &FigureOptions) {
    let Some((last, earlier)) = run.frames.split_last() else { return };
    let above = Rect::new(place.origin, place.width(), place.height() - 1.6 * panels.look.text);
    let view = world_view(&above, panels.look.text.round(), run, last, options);
    let page = Page { view: &view, camera: view.camera, look: panels.look };
    panels.shapes.push(layers::backdrop(last, &page));
    if !last.sprites.iter().any(|sprite| sprite.appearance.is_wall) {
        let thin = (panels.look.line / 2.0).ceil();
        panels.shapes.extend(outline(&view.camera.window, thin, panels.look.palette.grid.into()));
    }
    panels.shapes.push(ghosts(earlier, last, &page));
    panels.shapes.push(layers::world(last, &page));
    let times = Line::math(&span(&run.frames), panels.look.text);
    let window = view.camera.window;
    let at = Vector::new(window.center().x, window.far_corner().y + 1.2 * panels.look.text);
    panels.centered(times, at, panels.look.palette.ink.into());
}

/// From when to when, and how often.
fn span(frames: &[Frame]) -> String {
    match frames {
        [] => String::new(),
        [only] => format!("t = {:.2} \"s\"", only.time),
        [first, .., last] => {
            let apart = (last.time - first.time) / (frames.len() - 1) as f64;
            let apart = significant(apart, 2);
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
    Shape::Clip { window: page.camera.window, shapes }
}

/// Whether a body is elsewhere, or gone, at the last instant.
fn moves(sprite: &Sprite, last: &Frame) -> bool {
    let id = sprite.appearance.id;
    let now = last.sprites.binary_search_by_key(&id, |now| now.appearance.id).ok().map(|at| &last.sprites[at]);
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
