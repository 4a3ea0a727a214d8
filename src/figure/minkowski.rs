use super::pair::Pair;
use super::panels::{Panels, above_caption, caption, dashed, in_rows, outline};
use super::{FigureOptions, Meeting};
use crate::physics::{Rect, Vector};
use crate::render::area::{contains, inset, larger, smaller};
use crate::render::labels::Labels;
use crate::render::layers::bodies::border_color;
use crate::render::layers::grid::round_spacing;
use crate::render::number::significant;
use crate::render::text::Line;
use crate::render::{Arrow, Camera, Color, DisplayList, Look, Shape};

/// The handout's figure 2: (a) c and b where they met; (b) their Minkowski difference
/// s = b ⊖ c around the origin, with the vectors from the origin to its four sides, of which
/// the shortest is the penetration vector n⃗; (c) the same close by, where n⃗ is too short.
pub fn minkowski(meetings: &[Meeting], options: &FigureOptions) -> DisplayList {
    in_rows(meetings, options, row)
}

/// The pictures of one collision.
fn row(meeting: &Meeting, panels: &mut Panels, options: &FigureOptions) {
    let pair = Pair::new(meeting, options);
    let difference = Difference::new(&pair, &panels.look);
    let rooms = |count: usize, panels: &Panels| -> Vec<Rect> {
        panels.grid(count, count).iter().map(|place| above_caption(place, &panels.look)).collect()
    };
    let scale = |room: &Rect| smaller(pair.scale(room), difference.scale(room));
    let two = rooms(2, panels);
    let zoom = difference.zoom(scale(&two[0]), &panels.look);
    let rooms = if zoom == 1.0 { two } else { rooms(3, panels) };
    let scale = scale(&rooms[0]);
    pair.draw_met(&rooms[0], scale, &[], panels);
    caption(&rooms[0], "\"(a) the boxes\" c \"and\" b", panels);
    difference.draw(&rooms[1], scale, difference.middle, zoom == 1.0, panels);
    caption(&rooms[1], "\"(b)\" s = b ⊖ c \"around the origin\"", panels);
    if let Some(room) = rooms.get(2) {
        difference.draw(room, scale * zoom, Vector::ZERO, true, panels);
        caption(room, &format!("\"(c)\" {} \"times larger\"", significant(zoom, 1)), panels);
    }
}

/// s = b ⊖ c and how it is drawn.
struct Difference {
    rect: Rect,
    fill: Color,
    /// From the origin to the four sides, in the handout's order: left, right, top, bottom.
    vectors: [Vector; 4],
    /// The place of the shortest of them.
    shortest: usize,
    /// The middle of what is shown, m.
    middle: Vector,
    /// Width and height of what is shown, m.
    extent: Vector,
}

/// A penetration of that part of the difference and less is none.
const TOUCHING: f64 = 1e-12;

/// Parts of the smaller box that are shown at most on each side of the origin.
const FARTHEST: f64 = 2.5;

impl Difference {
    fn new(pair: &Pair, look: &Look) -> Difference {
        let [c, b] = &pair.collision.rects;
        let rect = c.minkowski_difference(b);
        let size = smaller(larger(c.width(), c.height()), larger(b.width(), b.height()));
        let most = FARTHEST * size;
        let far = rect.far_corner();
        let near = Vector::new(larger(smaller(rect.origin.x, 0.0), -most), larger(smaller(rect.origin.y, 0.0), -most));
        let end = Vector::new(smaller(larger(far.x, 0.0), most), smaller(larger(far.y, 0.0), most));
        let mut vectors = to_sides(&rect);
        let shortest = shortest(&vectors);
        // What is left by rounding where the two just touch is nothing.
        if vectors[shortest].norm() <= TOUCHING * larger(rect.width(), rect.height()) {
            vectors[shortest] = Vector::ZERO;
        }
        let extent = end.sub(near);
        let margin = 0.25 * larger(extent.x, extent.y);
        Difference {
            rect,
            fill: pair.colors[0].mix(pair.colors[1], 50).mix(look.palette.background, 65),
            vectors,
            shortest,
            middle: near.add(end).mult(0.5),
            extent: extent.add(Vector::new(margin, margin)),
        }
    }

    /// Pixels per metre with which all that is shown fits into a panel.
    fn scale(&self, room: &Rect) -> f64 {
        smaller(room.width() / self.extent.x, room.height() / self.extent.y)
    }

    /// How many times larger n⃗ must be drawn to be seen well.
    fn zoom(&self, scale: f64, look: &Look) -> f64 {
        let (length, wanted) = (self.vectors[self.shortest].norm() * scale, 5.0 * look.text);
        let is_seen = length == 0.0 || length >= 0.5 * wanted;
        if is_seen { 1.0 } else { smaller(round_spacing(wanted / length), 1e9) }
    }

    /// The difference in a panel whose middle shows the point `middle`, m; the length of the
    /// shortest vector is written where it is seen best.
    fn draw(&self, room: &Rect, scale: f64, middle: Vector, measured: bool, panels: &mut Panels) {
        let look = panels.look;
        let origin = middle.sub(room.center().mult(1.0 / scale));
        let world = self.rect.far_corner();
        let camera = Camera { size: [1, 1], window: *room, scale, origin, world };
        let seen = camera.rect(&self.rect);
        let mut shapes = vec![Shape::Rect { rect: seen, ink: self.fill.into() }];
        shapes.extend(outline(&seen, look.line, border_color(self.fill, &look).into()));
        let zero = camera.point(Vector::ZERO);
        let mut labels = Labels::within(*room);
        labels.avoid_border(&seen, 1.0);
        draw_axes(zero, room, &mut labels, &look, &mut shapes);
        for (vector, color, width) in self.candidates(&look) {
            let arrow = Arrow { from: zero, to: zero.add(vector.mult(scale)), width, color };
            labels.avoid_line(arrow.from, arrow.to, 2.0);
            arrow.draw(&look, &mut shapes);
        }
        if self.vectors[self.shortest] == Vector::ZERO {
            let side = 4.0 * look.line;
            let mark = Rect::new(zero.sub(Vector::new(side / 2.0, side / 2.0)), side, side);
            shapes.push(Shape::Rect { rect: mark, ink: look.palette.penetration.into() });
        }
        self.name(&seen, room, &mut labels, &look, &mut shapes);
        if measured {
            self.measure_shortest(zero, scale, &mut labels, &look, &mut shapes);
        }
        panels.shapes.push(Shape::Clip { window: *room, shapes });
        if !contains(room, &seen) {
            panels.frame(room);
        }
    }

    /// The four vectors, the shortest last and marked.
    fn candidates(&self, look: &Look) -> Vec<(Vector, Color, f64)> {
        let others = (0..4).filter(|&place| place != self.shortest);
        let mut candidates: Vec<_> = others.map(|place| (self.vectors[place], blue(look), look.line)).collect();
        candidates.push((self.vectors[self.shortest], look.palette.penetration, 2.0 * look.line));
        candidates
    }

    fn name(&self, seen: &Rect, room: &Rect, labels: &mut Labels, look: &Look, shapes: &mut Vec<Shape>) {
        let Some(part) = crate::render::area::overlap(seen, room) else { return };
        let part = inset(&part, smaller(look.text, smaller(part.width(), part.height()) / 2.0));
        let (near, far) = (part.origin, part.far_corner());
        let corners = [far, near, Vector::new(near.x, far.y), Vector::new(far.x, near.y)];
        let line = Line::math("s", 1.2 * look.text);
        labels.place_along(line, &corners, Vector::new(-1.0, -1.0), 0.0, look.palette.ink).draw(look, shapes);
    }

    fn measure_shortest(&self, zero: Vector, scale: f64, labels: &mut Labels, look: &Look, shapes: &mut Vec<Shape>) {
        let vector = self.vectors[self.shortest];
        let line = Line::math(&format!("|n⃗| = {} \"m\"", significant(vector.norm(), 3)), look.text);
        let aside = Vector::new(vector.y, -vector.x);
        let middle = zero.add(vector.mult(scale / 2.0));
        labels.place(line, middle, aside, look.text, look.palette.penetration).draw(look, shapes);
    }
}

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
fn draw_axes(zero: Vector, room: &Rect, labels: &mut Labels, look: &Look, shapes: &mut Vec<Shape>) {
    let far = room.far_corner();
    let muted = look.palette.muted;
    let ends = [
        [Vector::new(room.origin.x, zero.y), Vector::new(far.x, zero.y)],
        [Vector::new(zero.x, room.origin.y), Vector::new(zero.x, far.y)],
    ];
    for [from, to] in ends {
        shapes.extend(dashed(from, to, 3.0 * look.line, look.line / 2.0, muted.into()));
        labels.avoid_line(from, to, 1.0);
    }
    for ([_, end], name) in ends.iter().zip(["x", "y"]) {
        let back = zero.sub(*end).mult(look.text / zero.sub(*end).norm());
        let line = Line::math(name, look.text);
        labels.place(line, end.add(back), Vector::new(-1.0, -1.0), 0.6 * look.text, muted).draw(look, shapes);
    }
    let line = Line::math("0", look.text);
    labels.place(line, zero, Vector::new(-1.0, 1.0), 0.5 * look.text, look.palette.ink).draw(look, shapes);
}
