use super::super::area::{contains, inset, overlap};
use super::super::labels::{Label, Labels};
use super::super::number::significant;
use super::super::text::Line;
use super::super::{Color, Frame, Shape, Sprite, palette};
use super::bodies::seen;
use super::legend::quoted;
use super::{NamedArrow, Page};
use crate::physics::{Rect, Vector};
use crate::scene::Overlay;

/// More boxes than that, and names beside them would only be a clutter.
const FEW: usize = 40;

/// What is written on boxes and beside arrows, where it hides nothing.
///
/// A label that would hide much is left out. Of a crowd only those are written that fit into
/// their boxes: see [`inside`].
pub fn draw(frame: &Frame, page: &Page, arrows: &[NamedArrow], shapes: &mut Vec<Shape>) {
    let mut labels = Labels::within(page.camera.window);
    for NamedArrow { arrow, .. } in arrows {
        labels.avoid_line(arrow.from, arrow.to, 3.0);
    }
    let boxes = boxes(frame, page);
    if is_few(boxes.len()) && writes(page) {
        boxes.iter().for_each(|(_, rect)| labels.avoid(*rect, BOX));
        let size = common_size(&boxes, page);
        for at in 0..boxes.len() {
            match place(&boxes[at], &boxes[at + 1..], size, &mut labels, page) {
                Some(Written::Inside(label)) => label.draw_bare(shapes),
                Some(Written::Beside(label)) => label.draw(&page.look, shapes),
                None => {}
            }
        }
    }
    for NamedArrow { arrow, name } in arrows.iter().filter(|arrow| !arrow.name.is_empty()) {
        let line = Line::math(name, 0.8 * page.look.text);
        let gap = 0.5 * page.look.text;
        labels.place(line, arrow.to, arrow.to.sub(arrow.from), gap, arrow.color).draw(&page.look, shapes);
    }
}

fn is_few(boxes: usize) -> bool {
    boxes <= FEW
}

fn writes(page: &Page) -> bool {
    page.view.style.shows(Overlay::Name) || page.view.style.shows(Overlay::Mass)
}

fn boxes<'a>(frame: &'a Frame, page: &Page) -> Vec<(&'a Sprite, Rect)> {
    let named = frame.sprites.iter().filter(|sprite| !sprite.appearance.is_wall);
    named.filter_map(|sprite| Some((sprite, seen(sprite, page)?))).collect()
}

/// Letters of a name beside a box at most.
const LONGEST: usize = 24;

/// What is written on a box: its name, its mass, or both.
fn text(sprite: &Sprite, name: &str, page: &Page) -> String {
    let style = &page.view.style;
    let mass = match sprite.appearance.mass {
        f64::INFINITY => "∞ \"kg\"".to_owned(),
        mass => format!("{} \"kg\"", significant(mass, 3)),
    };
    match (style.shows(Overlay::Name), style.shows(Overlay::Mass)) {
        (true, true) => format!("{}\", \"{mass}", quoted(name)),
        (false, true) => mass,
        (true, false) | (false, false) => quoted(name),
    }
}

/// Sizes tried inside a box, in parts of the page's text.
const SIZES: [f64; 3] = [1.0, 0.8, 0.65];

/// The size of text in boxes, px: one for all that can move, so large that none of them is without
/// that could have it in the smallest.
fn common_size(boxes: &[(&Sprite, Rect)], page: &Page) -> f64 {
    let [.., smallest] = SIZES;
    let movable = boxes.iter().filter(|(sprite, _)| sprite.appearance.mass != f64::INFINITY);
    let fitting: Vec<&(&Sprite, Rect)> = movable.filter(|entry| fits(entry, smallest, page)).collect();
    let size = SIZES.into_iter().find(|&size| fitting.iter().all(|entry| fits(entry, size, page)));
    size.unwrap_or(smallest) * page.look.text
}

/// Whether what is written on a box fits into it, in a size in parts of the page's text.
fn fits((sprite, rect): &(&Sprite, Rect), size: f64, page: &Page) -> bool {
    let line = Line::math(&text(sprite, &sprite.appearance.name, page), size * page.look.text);
    !places_in(&line, rect, page).is_empty()
}

/// What a label may hide, in parts of itself, before it is rather left out.
const MOST_HIDDEN: f64 = 1.0;

/// The label of a box: in it, or else beside it.
fn place(
    (sprite, rect): &(&Sprite, Rect),
    in_front: &[(&Sprite, Rect)],
    size: f64,
    labels: &mut Labels,
    page: &Page,
) -> Option<Written> {
    let own = SIZES.into_iter().find(|&own| own * page.look.text <= size && fits(&(sprite, *rect), own, page));
    let line = Line::math(&text(sprite, &sprite.appearance.name, page), own.map_or(size, |own| own * page.look.text));
    let mut within = labels.clone();
    within.avoid(*rect, -BOX);
    in_front.iter().for_each(|(_, front)| within.avoid(*front, BOX));
    let free = places_in(&line, rect, page).into_iter().find(|place| within.cost(place) <= 0.0);
    if let Some(place) = free {
        labels.take(place);
        let fill = palette::body_color(sprite, &page.view.style);
        return Some(Written::Inside(Label::at(&place, line, page.look.palette.text_on(fill))));
    }
    let most = 0.8 * page.look.text;
    let size = if size < most { size } else { most };
    let line = Line::math(&text(sprite, &shortened(&sprite.appearance.name), page), size);
    let (place, hidden) = labels.best(places_beside(&line, rect, page).into_iter())?;
    if hidden > MOST_HIDDEN * place.width() * place.height() || is_crowded(sprite, &place, labels, page) {
        return None;
    }
    labels.take(place);
    Some(Written::Beside(Label::at(&place, line, page.look.palette.ink)))
}

/// How much it matters that a label hides no box.
const BOX: f64 = 1.5;

/// A label, and whether it is on the colour of its box.
enum Written {
    Inside(Label),
    Beside(Label),
}

/// What never moves is scenery: its name is left out where others are near.
fn is_crowded(sprite: &Sprite, place: &Rect, labels: &Labels, page: &Page) -> bool {
    let wide = Rect::new(
        place.origin.sub(Vector::new(page.look.text, 0.0)),
        place.width() + 2.0 * page.look.text,
        place.height(),
    );
    sprite.appearance.mass == f64::INFINITY && labels.cost(&wide) > 0.0
}

/// A name of at most so many letters as one beside a box may have.
fn shortened(name: &str) -> String {
    if name.chars().count() <= LONGEST {
        return name.to_owned();
    }
    let kept: String = name.chars().take(LONGEST).collect();
    format!("{}…", kept.trim_end())
}

/// The middle or the corners of a box as far as it is seen; an arrow leaves only the corners.
fn places_in(line: &Line, rect: &Rect, page: &Page) -> Vec<Rect> {
    let margin = 2.0 * page.look.line;
    let Some(part) = overlap(rect, &page.camera.window).map(|part| inset(&part, margin)) else { return Vec::new() };
    let (width, height) = (line.width, line.height());
    let (room, hold) = (part.width() - width, part.height() - height);
    if room < 0.0 || hold < 0.0 {
        return Vec::new();
    }
    let inner = if room > 2.0 * margin && hold > 2.0 * margin { margin } else { 0.0 };
    let at = |x: f64, y: f64| Rect::new(part.origin.add(Vector::new(x, y)), width, height);
    let [left, top, right, bottom] = [inner, inner, room - inner, hold - inner];
    let corners = [at(left, top), at(right, top), at(left, bottom), at(right, bottom)];
    let sides = [at(room / 2.0, top), at(room / 2.0, bottom), at(left, hold / 2.0), at(right, hold / 2.0)];
    let middle = at(room / 2.0, hold / 2.0);
    match points_somewhere(page) {
        true => [corners, sides].concat(),
        false => [&[middle], &corners[..], &sides[..]].concat(),
    }
}

/// Whether arrows begin in the middles of boxes.
fn points_somewhere(page: &Page) -> bool {
    page.view.style.shows(Overlay::Velocity) || page.view.style.shows(Overlay::Force)
}

/// Above, below, right and left of a box, and at its corners.
fn places_beside(line: &Line, rect: &Rect, page: &Page) -> Vec<Rect> {
    let (width, height, gap) = (line.width, line.height(), 2.0 * page.look.line);
    let (near, far, middle) = (rect.origin, rect.far_corner(), rect.center());
    let above = near.y - gap - height;
    let below = far.y + gap;
    let places = [
        (middle.x - width / 2.0, above),
        (middle.x - width / 2.0, below),
        (far.x + gap, middle.y - height / 2.0),
        (near.x - gap - width, middle.y - height / 2.0),
        (far.x + gap, above),
        (near.x - gap - width, above),
        (far.x + gap, below),
        (near.x - gap - width, below),
        (near.x, above),
        (far.x - width, above),
        (near.x, below),
        (far.x - width, below),
    ];
    let window = &page.camera.window;
    let places = places.map(|(x, y)| Rect::new(Vector::new(x, y), width, height));
    places.into_iter().filter(|place| contains(window, place)).collect()
}

/// What is written on a box of a crowd, drawn with the box so that those in front hide it: in its
/// upper left corner where an arrow begins in its middle.
pub fn inside(sprite: &Sprite, rect: &Rect, fill: Color, boxes: usize, page: &Page) -> Option<Shape> {
    if is_few(boxes) || !writes(page) {
        return None;
    }
    let text = text(sprite, &sprite.appearance.name, page);
    let height = if points_somewhere(page) { rect.height() / 3.0 } else { rect.height() };
    let room = Rect::new(rect.origin, rect.width(), height);
    let found = SIZES.iter().find_map(|size| {
        let line = Line::math(&text, size * page.look.text);
        let place = *places_in(&line, &room, page).first()?;
        Some((line, place))
    });
    let (line, place) = found?;
    let Label { line, at, color } = Label::at(&place, line, page.look.palette.text_on(fill));
    Some(Shape::Text { line, at, ink: color.into() })
}
