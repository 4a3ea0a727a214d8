use super::labels::Labels;
use super::number::significant;
use super::panels::{Panels, dashed, outline};
use super::{FigureOptions, collision::Pair};
use crate::physics::{Collision, Rect, Vector};
use crate::render::area::smaller;
use crate::render::layers::bodies::border_color;
use crate::render::text::Line;
use crate::render::{Appearance, Arrow, Camera, Color, DisplayList, Ink, Look, Shape};

/// The handout's figure 2: c and b where they met, and their Minkowski difference s = b ⊖ c
/// around the origin, with the vectors from the origin to its four sides; the shortest is the
/// penetration vector n⃗.
pub fn minkowski(collision: &Collision, bodies: [&Appearance; 2], options: &FigureOptions) -> DisplayList {
    let mut panels = Panels::new(options);
    let pair = Pair::new(collision, bodies, options);
    let places = panels.grid(2, 2);
    let [left, right] = [places[0], places[1]].map(|place| above_caption(&place, &panels.look));
    let difference = collision.rects[0].minkowski_difference(&collision.rects[1]);
    let scale = smaller(pair.scale(&left), scale_of(&difference, &right, &panels.look));
    pair.draw_met(&left, scale, &mut panels);
    draw_difference(&difference, &right, scale, &pair, &mut panels);
    caption(&left, "(a) the boxes c and b", &mut panels);
    caption(&right, "(b) s = b ⊖ c holds the origin", &mut panels);
    panels.finish()
}

/// The part of a panel that is not caption.
pub fn above_caption(place: &Rect, look: &Look) -> Rect {
    Rect::new(place.origin, place.width(), place.height() - 2.0 * look.text)
}

/// What is written below a panel.
pub fn caption(room: &Rect, markup: &str, panels: &mut Panels) {
    let line = Line::math(markup, panels.look.text);
    let at = Vector::new(room.center().x, room.far_corner().y + 1.5 * panels.look.text);
    panels.centered(line, at, panels.look.palette.ink.into());
}

/// The difference and the origin, with room for arrows around.
fn shown(difference: &Rect) -> Rect {
    let far = difference.far_corner();
    let [left, top] = [smaller(difference.origin.x, 0.0), smaller(difference.origin.y, 0.0)];
    let right = if far.x > 0.0 { far.x } else { 0.0 };
    let bottom = if far.y > 0.0 { far.y } else { 0.0 };
    let by = 0.12 * if right - left > bottom - top { right - left } else { bottom - top };
    Rect::new(Vector::new(left - by, top - by), right - left + 2.0 * by, bottom - top + 2.0 * by)
}

fn scale_of(difference: &Rect, room: &Rect, look: &Look) -> f64 {
    Camera::over(&shown(difference), [1, 1], *room, look.text).scale
}

fn draw_difference(difference: &Rect, room: &Rect, scale: f64, pair: &Pair, panels: &mut Panels) {
    let look = panels.look;
    let at_rest = Camera::over(&shown(difference), [1, 1], *room, 0.0);
    let origin = shown(difference).center().sub(room.center().mult(1.0 / scale));
    let camera = Camera { scale, origin, ..at_rest };
    let seen = camera.rect(difference);
    let fill = pair.colors[0].mix(pair.colors[1], 50).mix(look.palette.background, 60);
    panels.shapes.push(Shape::Rect { rect: seen, ink: fill.into() });
    panels.shapes.extend(outline(&seen, look.line, border_color(fill, &look).into()));
    let mut labels = Labels::within(*room);
    let zero = camera.point(Vector::ZERO);
    draw_axes(zero, room, &mut labels, panels);
    let vectors = to_sides(difference);
    let shortest = shortest(&vectors);
    for (place, vector) in vectors.iter().enumerate() {
        let (width, color) =
            if place == shortest { (2.0 * look.line, look.palette.penetration) } else { (look.line, blue(&look)) };
        let arrow = Arrow { from: zero, to: zero.add(vector.mult(scale)), width, color };
        labels.avoid_line(arrow.from, arrow.to, 2.0);
        arrow.draw(&look, &mut panels.shapes);
    }
    let s = Line::math("s", 1.2 * look.text);
    let corner = seen.far_corner().sub(Vector::new(1.2 * look.text, 0.8 * look.text));
    panels.shapes.push(Shape::Text { line: s, at: corner, ink: look.palette.ink.into() });
    let vector = vectors[shortest];
    let length = significant(vector.norm(), 3);
    let line = Line::math(&format!("n⃗,  |n⃗| = {length} \"m\""), look.text);
    let middle = zero.add(vector.mult(scale / 2.0));
    let aside = Vector::new(vector.y, -vector.x);
    let label = labels.place(line, middle, aside, look.text, look.palette.penetration.into());
    panels.shapes.push(label);
}

/// From the origin to the four sides, in the handout's order: left, right, top, bottom.
fn to_sides(s: &Rect) -> [Vector; 4] {
    let far = s.far_corner();
    [Vector::new(s.origin.x, 0.0), Vector::new(far.x, 0.0), Vector::new(0.0, s.origin.y), Vector::new(0.0, far.y)]
}

/// The first of the shortest, as the handout's solver takes it.
fn shortest(vectors: &[Vector; 4]) -> usize {
    let mut best = 0;
    for place in 1..4 {
        if vectors[place].norm() < vectors[best].norm() {
            best = place;
        }
    }
    best
}

/// The handout draws the candidates in blue.
fn blue(look: &Look) -> Color {
    Color::hex(0x0072b2).mix(look.palette.ink, 20)
}

/// The axes through the origin, dashed, with their names and that of the origin.
fn draw_axes(zero: Vector, room: &Rect, labels: &mut Labels, panels: &mut Panels) {
    let look = panels.look;
    let ink: Ink = look.palette.muted.into();
    let far = room.far_corner();
    let ends = [
        [Vector::new(room.origin.x, zero.y), Vector::new(far.x, zero.y)],
        [Vector::new(zero.x, room.origin.y), Vector::new(zero.x, far.y)],
    ];
    for [from, to] in ends {
        panels.shapes.extend(dashed(from, to, 3.0 * look.line, look.line / 2.0, ink));
    }
    for ([_, end], name) in ends.iter().zip(["x", "y"]) {
        let back = zero.sub(*end).mult(look.text / zero.sub(*end).norm());
        let label =
            labels.place(Line::math(name, look.text), end.add(back), Vector::new(-1.0, -1.0), 0.6 * look.text, ink);
        panels.shapes.push(label);
    }
    let label = labels.place(
        Line::math("0", look.text),
        zero,
        Vector::new(-1.0, 1.0),
        0.5 * look.text,
        look.palette.ink.into(),
    );
    panels.shapes.push(label);
}
