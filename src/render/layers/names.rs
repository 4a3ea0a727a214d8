use super::super::area::{contains, overlap};
use super::super::text::Line;
use super::super::{Color, Frame, Ink, Shape, Sprite};
use super::Page;
use super::bodies::seen;
use crate::physics::{Rect, Vector};
use crate::scene::Overlay;

/// More boxes than that, and names beside them would only be a clutter.
const NAMED_OUTSIDE: usize = 40;

/// Names that do not fit into their boxes, each beside its box where nothing else is.
///
/// Those that fit are drawn with their boxes, so that a box in front hides them too.
pub fn draw(frame: &Frame, page: &Page, shapes: &mut Vec<Shape>) {
    let named = frame.sprites.iter().filter(|sprite| !sprite.appearance.is_wall);
    let boxes: Vec<(&Sprite, Rect)> = named.filter_map(|sprite| Some((sprite, seen(sprite, page)?))).collect();
    if !page.view.style.shows(Overlay::Name) || boxes.len() > NAMED_OUTSIDE {
        return;
    }
    let mut taken: Vec<Rect> = boxes.iter().map(|(_, rect)| *rect).collect();
    for (sprite, rect) in boxes.iter().filter(|(sprite, rect)| fitting(sprite, rect, page).is_none()) {
        if let Some((place, shape)) = beside(sprite, rect, page, &taken) {
            taken.push(place);
            shapes.push(shape);
        }
    }
}

/// The name of a box within it, if it fits; in a corner where an arrow begins in the middle.
pub fn inside(sprite: &Sprite, rect: &Rect, fill: Color, page: &Page) -> Option<Shape> {
    let line = fitting(sprite, rect, page)?;
    let margin = 4.0 * page.look.line;
    let at = if page.view.style.shows(Overlay::Velocity) {
        rect.origin.add(Vector::new(margin, margin + line.height()))
    } else {
        rect.center().add(Vector::new(-line.width / 2.0, line.height() / 2.0))
    };
    Some(Shape::Text { line, at, ink: Ink::from(page.look.palette.text_on(fill)) })
}

/// Sizes tried inside a box, in parts of the page's text.
const SIZES: [f64; 3] = [1.0, 0.8, 0.65];

/// The name in the largest size that fits into the box, leaving room for an arrow.
fn fitting(sprite: &Sprite, rect: &Rect, page: &Page) -> Option<Line> {
    let margin = 2.0 * page.look.line;
    let (width, height) = (rect.width() - 2.0 * margin, rect.height() - 2.0 * margin);
    let height = if page.view.style.shows(Overlay::Velocity) { height / 3.0 } else { height };
    let lines = SIZES.iter().map(|size| Line::plain(&sprite.appearance.name, size * page.look.text));
    lines.into_iter().find(|line| line.width <= width && line.height() <= height)
}

/// Above, below, right or left of the box, the first that is free.
fn beside(sprite: &Sprite, rect: &Rect, page: &Page, taken: &[Rect]) -> Option<(Rect, Shape)> {
    let line = Line::plain(&sprite.appearance.name, 0.8 * page.look.text);
    let (width, height, gap) = (line.width, line.height(), 2.0 * page.look.line);
    let (near, far, middle) = (rect.origin, rect.far_corner(), rect.center());
    let places = [
        Vector::new(middle.x - width / 2.0, near.y - gap - height),
        Vector::new(middle.x - width / 2.0, far.y + gap),
        Vector::new(far.x + gap, middle.y - height / 2.0),
        Vector::new(near.x - gap - width, middle.y - height / 2.0),
    ];
    let place = places.into_iter().map(|at| Rect::new(at, width, height)).find(|place| is_free(place, page, taken))?;
    let at = place.origin.add(Vector::new(0.0, height));
    Some((place, Shape::Text { line, at, ink: Ink::from(page.look.palette.ink) }))
}

fn is_free(place: &Rect, page: &Page, taken: &[Rect]) -> bool {
    contains(&page.view.camera.window, place) && taken.iter().all(|other| overlap(place, other).is_none())
}
