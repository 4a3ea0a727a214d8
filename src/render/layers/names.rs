use super::super::text::Line;
use super::super::{Frame, Ink, Shape, Sprite, palette};
use super::Page;
use super::bodies::{overlap, seen, smaller};
use crate::physics::{Rect, Vector};
use crate::scene::Overlay;

/// More boxes than that, and names beside them would only be a clutter.
const NAMED_OUTSIDE: usize = 40;

/// The name of each box: inside if it fits, else beside it where nothing else is.
pub fn draw(frame: &Frame, page: &Page, shapes: &mut Vec<Shape>) {
    if !page.view.style.shows(Overlay::Name) {
        return;
    }
    let named = frame.sprites.iter().filter(|sprite| !sprite.appearance.is_wall);
    let boxes: Vec<(&Sprite, Rect)> = named.filter_map(|sprite| Some((sprite, seen(sprite, page)?))).collect();
    let mut taken: Vec<Rect> = boxes.iter().map(|(_, rect)| *rect).collect();
    let outside = boxes.len() <= NAMED_OUTSIDE;
    for (sprite, rect) in &boxes {
        if let Some(shape) = inside(sprite, rect, page) {
            shapes.push(shape);
        } else if outside && let Some((place, shape)) = beside(sprite, rect, page, &taken) {
            taken.push(place);
            shapes.push(shape);
        }
    }
}

/// Sizes tried inside a box, in parts of the page's text.
const SIZES: [f64; 3] = [1.0, 0.8, 0.65];

fn inside(sprite: &Sprite, rect: &Rect, page: &Page) -> Option<Shape> {
    let margin = 2.0 * page.line;
    let arrows = page.view.style.shows(Overlay::Velocity);
    let room = Vector::new(rect.width() - 2.0 * margin, rect.height() - 2.0 * margin);
    let height = if arrows { room.y / 3.0 } else { room.y };
    let line = SIZES
        .iter()
        .map(|size| Line::plain(&sprite.appearance.name, size * page.text))
        .find(|line| line.width <= room.x && line.height() <= height)?;
    let middle = rect.center().add(Vector::new(-line.width / 2.0, line.height() / 2.0));
    let corner = rect.origin.add(Vector::new(2.0 * margin, 2.0 * margin + line.height()));
    let at = if arrows { corner } else { middle };
    let fill = palette::body_color(sprite, &page.view.style);
    Some(Shape::Text { line, at, ink: Ink::from(page.palette.text_on(fill)) })
}

/// Above, below, right or left of the box, the first that is free.
fn beside(sprite: &Sprite, rect: &Rect, page: &Page, taken: &[Rect]) -> Option<(Rect, Shape)> {
    let line = Line::plain(&sprite.appearance.name, 0.8 * page.text);
    let (width, height, gap) = (line.width, line.height(), 2.0 * page.line);
    let (near, far, middle) = (rect.origin, rect.far_corner(), rect.center());
    let places = [
        Vector::new(middle.x - width / 2.0, near.y - gap - height),
        Vector::new(middle.x - width / 2.0, far.y + gap),
        Vector::new(far.x + gap, middle.y - height / 2.0),
        Vector::new(near.x - gap - width, middle.y - height / 2.0),
    ];
    let place = places.into_iter().map(|at| Rect::new(at, width, height)).find(|place| is_free(place, page, taken))?;
    let at = place.origin.add(Vector::new(0.0, height));
    Some((place, Shape::Text { line, at, ink: Ink::from(page.palette.ink) }))
}

fn is_free(place: &Rect, page: &Page, taken: &[Rect]) -> bool {
    let window = page.view.camera.window();
    let whole = smaller(place.origin.x, place.origin.y) >= 0.0
        && place.far_corner().x <= window.width()
        && place.far_corner().y <= window.height();
    whole && taken.iter().all(|other| overlap(place, other).is_none())
}
