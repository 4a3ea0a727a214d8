use super::FigureOptions;
use super::labels::Labels;
use super::minkowski::{above_caption, caption};
use super::number::significant;
use super::panels::{Panels, dashed};
use crate::physics::{Collision, Rect, Vector};
use crate::render::area::{larger, overlap, smaller};
use crate::render::layers::bodies::{border_color, draw_box};
use crate::render::layers::grid::round_spacing;
use crate::render::text::Line;
use crate::render::{Appearance, Arrow, Camera, Color, DisplayList, Ink, Look, Shape, Sprite, palette};
use std::sync::Arc;

/// The handout's figure 1: (a) c and b as they meet, with their velocities; (b) their overlap
/// close by, the unit normal n̂, the penetration vector n⃗ and the share of it by which each is
/// displaced; (c) the two apart again, with the velocities of their rebound, dotted.
pub fn collision(collision: &Collision, bodies: [&Appearance; 2], options: &FigureOptions) -> DisplayList {
    let mut panels = Panels::new(options);
    let pair = Pair::new(collision, bodies, options);
    let facts = Line::math(&pair.facts(), 0.9 * panels.look.text);
    let foot = Vector::new(panels.room.center().x, panels.room.far_corner().y);
    panels.centered(facts, foot, panels.look.palette.ink.into());
    panels.room = Rect::new(panels.room.origin, panels.room.width(), panels.room.height() - 1.8 * panels.look.text);
    let places = panels.grid(3, 3);
    let [before, close, after] = [0, 1, 2].map(|at| above_caption(&places[at], &panels.look));
    let scale = pair.scale(&before);
    pair.draw_before(&before, scale, &mut panels);
    let zoom = pair.draw_close(&close, scale, &mut panels);
    pair.draw_after(&after, scale, &mut panels);
    caption(&before, "(a) \"before\"", &mut panels);
    caption(&close, &pair.close_title(zoom), &mut panels);
    caption(&after, "(c) \"after\"", &mut panels);
    panels.finish()
}

/// The two boxes of a collision, and how they are drawn.
pub struct Pair<'a> {
    collision: &'a Collision,
    names: [String; 2],
    /// Of c and b.
    pub colors: [Color; 2],
    /// What is to be seen, m: of a box far larger than the other only the part beside it.
    area: Rect,
    /// Seconds that turn a velocity into an arrow, m.
    time: f64,
}

/// The handout's names of the two.
const ROLES: [&str; 2] = ["c", "b"];

/// The length of the longest arrow in parts of what is seen.
const LONGEST_ARROW: f64 = 0.4;

impl<'a> Pair<'a> {
    /// The pair of a collision between bodies of these looks, c before b.
    pub fn new(collision: &'a Collision, bodies: [&Appearance; 2], options: &FigureOptions) -> Pair<'a> {
        let boxes = near_parts(&collision.rects);
        let size = larger(boxes.width(), boxes.height());
        let speeds = collision.before.iter().chain(&collision.after).map(|velocity| velocity.norm());
        let top = speeds.fold(0.0, larger);
        let time = if top > 0.0 { LONGEST_ARROW * size / top } else { 0.0 };
        let names = [0, 1].map(|at| match bodies[at].name.as_str() {
            name if name == ROLES[at] => format!("\"{name}\""),
            name => format!("{}: \"{}\"", ROLES[at], name.replace('"', "'")),
        });
        let colors = [0, 1].map(|at| color(bodies[at], collision.before[at], options));
        let mut pair = Pair { collision, names, colors, area: boxes, time };
        pair.area = pair.with_arrows(boxes, size);
        pair
    }

    fn with_arrows(&self, boxes: Rect, size: f64) -> Rect {
        let starts = self.collision.rects.map(|rect| visible_middle(&rect, &boxes));
        let tips = [self.collision.before, self.collision.after]
            .into_iter()
            .flat_map(|velocities| [0, 1].map(|at| starts[at].add(velocities[at].mult(self.time))));
        let all = tips.map(|tip| Rect::new(tip, 0.0, 0.0)).fold(boxes, |all, tip| union(&all, &tip));
        let by = 0.06 * size;
        Rect::new(all.origin.sub(Vector::new(by, by)), all.width() + 2.0 * by, all.height() + 2.0 * by)
    }

    /// Pixels per metre with which all of it is seen in a panel.
    pub fn scale(&self, room: &Rect) -> f64 {
        Camera::over(&self.area, [1, 1], *room, 0.0).scale
    }

    fn camera(&self, room: &Rect, scale: f64) -> Camera {
        let middle = self.area.center().sub(room.center().mult(1.0 / scale));
        Camera { scale, origin: middle, ..Camera::over(&self.area, [1, 1], *room, 0.0) }
    }

    /// The boxes where they met, with their names.
    pub fn draw_met(&self, room: &Rect, scale: f64, panels: &mut Panels) {
        let camera = self.camera(room, scale);
        let shapes = self.boxes(&camera, &self.collision.rects, &panels.look);
        panels.shapes.push(Shape::Clip { window: *room, shapes });
    }

    fn draw_before(&self, room: &Rect, scale: f64, panels: &mut Panels) {
        self.draw_met(room, scale, panels);
        let camera = self.camera(room, scale);
        let arrows =
            self.arrows(&camera, &self.collision.rects, &self.collision.before, panels.look.palette.ink, &panels.look);
        let mut labels = self.labels(room, &arrows);
        for (at, arrow) in arrows.iter().enumerate() {
            arrow.draw(&panels.look, &mut panels.shapes);
            name_arrow(arrow, &format!("v⃗_{}", ROLES[at]), &mut labels, panels);
        }
    }

    fn draw_after(&self, room: &Rect, scale: f64, panels: &mut Panels) {
        let camera = self.camera(room, scale);
        let look = panels.look;
        let rects = self.displaced();
        let mut shapes = self.boxes(&camera, &rects, &look);
        for rect in &self.collision.rects {
            shapes.extend(dashed_outline(&camera.rect(rect), &look));
        }
        panels.shapes.push(Shape::Clip { window: *room, shapes });
        let arrows = self.arrows(&camera, &rects, &self.collision.after, look.palette.ink, &look);
        let mut labels = self.labels(room, &arrows);
        for (at, arrow) in arrows.iter().enumerate() {
            draw_dotted(arrow, &look, &mut panels.shapes);
            name_arrow(arrow, &format!("v⃗′_{}", ROLES[at]), &mut labels, panels);
        }
    }

    /// Where the two are once each was displaced by its share.
    fn displaced(&self) -> [Rect; 2] {
        let mut rects = self.collision.rects;
        let [share_c, share_b] = self.collision.shares;
        rects[0].move_by(self.collision.penetration.mult(share_c));
        rects[1].move_by(self.collision.penetration.mult(-share_b));
        rects
    }

    fn boxes(&self, camera: &Camera, rects: &[Rect; 2], look: &Look) -> Vec<Shape> {
        let mut shapes = Vec::new();
        for at in [1, 0] {
            let seen = camera.rect(&rects[at]);
            draw_box(&seen, self.colors[at], look, &mut shapes);
            let line = Line::math(&self.names[at], 0.9 * look.text);
            let Some(part) = overlap(&seen, &camera.window) else { continue };
            let corner = part.origin.add(Vector::new(4.0 * look.line, 4.0 * look.line + line.height()));
            let ink = look.palette.text_on(self.colors[at]).into();
            shapes.push(Shape::Text { line, at: corner, ink });
        }
        shapes
    }

    fn arrows(
        &self,
        camera: &Camera,
        rects: &[Rect; 2],
        velocities: &[Vector; 2],
        color: Color,
        look: &Look,
    ) -> [Arrow; 2] {
        [0, 1].map(|at| {
            let from = camera.point(visible_middle(&rects[at], &self.area));
            let to = from.add(velocities[at].mult(self.time * camera.scale));
            Arrow { from, to, width: 1.5 * look.line, color }
        })
    }

    fn labels(&self, room: &Rect, arrows: &[Arrow; 2]) -> Labels {
        let mut labels = Labels::within(*room);
        for arrow in arrows {
            labels.avoid_line(arrow.from, arrow.to, 3.0);
        }
        labels
    }

    /// The overlap as large as is needed to see it; tells how many times larger than beside.
    fn draw_close(&self, room: &Rect, scale: f64, panels: &mut Panels) -> f64 {
        let look = panels.look;
        let depth = self.collision.penetration.norm() * scale;
        let wanted = 5.0 * look.text;
        let zoom = if depth > 0.0 && depth < wanted { round_spacing(wanted / depth) } else { 1.0 };
        let zoom = smaller(zoom, 1e9);
        let (contact, scale) = (contact(&self.collision.rects), scale * zoom);
        let camera = Camera {
            scale,
            origin: contact.sub(room.center().mult(1.0 / scale)),
            ..Camera::over(&self.area, [1, 1], *room, 0.0)
        };
        let mut shapes = self.boxes(&camera, &self.collision.rects, &look);
        let [c, b] = self.collision.rects.map(|rect| camera.rect(&rect));
        if let Some(rect) = overlap(&c, &b) {
            shapes.push(Shape::Rect { rect, ink: Ink { color: look.palette.penetration, opacity: 120 } });
        }
        panels.shapes.push(Shape::Clip { window: *room, shapes });
        self.draw_vectors(room, scale, panels);
        zoom
    }

    /// Normal, penetration and shares, side by side along the contact.
    fn draw_vectors(&self, room: &Rect, scale: f64, panels: &mut Panels) {
        let look = panels.look;
        let normal = self.collision.normal;
        let aside = Vector::new(-normal.y, normal.x).mult(4.0 * look.text);
        let middle = room.center();
        let penetration = self.collision.penetration.mult(scale);
        let [share_c, share_b] = self.collision.shares;
        let blue = Color::hex(0x0072b2).mix(look.palette.ink, 20);
        let from = |place: f64, back: f64| middle.add(aside.mult(place)).sub(penetration.mult(back));
        let vectors = [
            (from(-1.0, 0.0), normal.mult(6.0 * look.text), look.palette.normal, "n̂"),
            (from(0.0, 0.5), penetration, look.palette.penetration, "n⃗"),
            (from(1.0, 0.0), penetration.mult(share_c), blue, "N_c n⃗"),
            (from(1.0, 0.0), penetration.mult(-share_b), blue, "-N_b n⃗"),
        ];
        let mut labels = Labels::within(*room);
        for &(from, vector, _, _) in &vectors {
            labels.avoid_line(from, from.add(vector), 3.0);
        }
        for (from, vector, color, name) in vectors.into_iter().filter(|(_, vector, _, _)| vector.norm() > 0.0) {
            let arrow = Arrow { from, to: from.add(vector), width: 1.5 * look.line, color };
            arrow.draw(&look, &mut panels.shapes);
            name_arrow(&arrow, name, &mut labels, panels);
        }
    }

    fn close_title(&self, zoom: f64) -> String {
        let what = if self.collision.penetration == Vector::ZERO { "they touch" } else { "they overlap" };
        let zoom = if zoom == 1.0 { String::new() } else { format!(", {} × larger", significant(zoom, 1)) };
        format!("(b) \"{what}{}\"", zoom.replace("·10^{", "e").replace('}', ""))
    }

    /// The numbers of the collision in one line.
    fn facts(&self) -> String {
        let collision = self.collision;
        let [share_c, share_b] = collision.shares.map(|share| significant(share, 3));
        let mut facts = vec![format!("\"step\" {}", collision.step)];
        if collision.penetration != Vector::ZERO {
            facts.push(format!("|n⃗| = {} \"m\"", significant(collision.penetration.norm(), 3)));
            facts.push(format!("N_c = {share_c}"));
            facts.push(format!("N_b = {share_b}"));
        }
        if let Some(restitution) = restitution(collision) {
            facts.push(format!("e = {}", significant(restitution, 3)));
        }
        facts.push(format!("j = {} \"N·s\"", significant(collision.impulse, 3)));
        facts.join(",   ")
    }
}

/// How much of the speed along the normal came back.
fn restitution(collision: &Collision) -> Option<f64> {
    let along = |[c, b]: [Vector; 2]| c.sub(b).dot(collision.normal);
    let (before, after) = (along(collision.before), along(collision.after));
    (collision.impulse != 0.0 && before != 0.0).then(|| -after / before)
}

/// The colour the body has in frames.
fn color(body: &Appearance, velocity: Vector, options: &FigureOptions) -> Color {
    let look = Look::new(options.style.theme, options.size);
    if body.is_wall {
        return look.palette.wall;
    }
    let sprite = Sprite {
        appearance: Arc::new(body.clone()),
        rect: Rect::new(Vector::ZERO, 1.0, 1.0),
        velocity,
        trail: Vec::new(),
    };
    palette::body_color(&sprite, &options.style)
}

/// The smallest rectangle around two.
fn union(a: &Rect, b: &Rect) -> Rect {
    let (far_a, far_b) = (a.far_corner(), b.far_corner());
    let near = Vector::new(smaller(a.origin.x, b.origin.x), smaller(a.origin.y, b.origin.y));
    Rect::new(near, larger(far_a.x, far_b.x) - near.x, larger(far_a.y, far_b.y) - near.y)
}

/// Both boxes, but of one that is far larger than the other only what is beside that.
fn near_parts([c, b]: &[Rect; 2]) -> Rect {
    union(&near_part(c, b), &near_part(b, c))
}

fn near_part(rect: &Rect, other: &Rect) -> Rect {
    let size = larger(other.width(), other.height());
    let cut = |from: f64, to: f64, low: f64, high: f64| {
        if to - from <= 4.0 * size {
            return [from, to];
        }
        [larger(from, low - 0.6 * size), smaller(to, high + 0.6 * size)]
    };
    let (far, other_far) = (rect.far_corner(), other.far_corner());
    let [left, right] = cut(rect.origin.x, far.x, other.origin.x, other_far.x);
    let [top, bottom] = cut(rect.origin.y, far.y, other.origin.y, other_far.y);
    Rect::new(Vector::new(left, top), right - left, bottom - top)
}

/// The middle of what is seen of a rectangle.
fn visible_middle(rect: &Rect, area: &Rect) -> Vector {
    overlap(rect, area).map_or(rect.center(), |part| part.center())
}

/// The middle of what two rectangles share, or of where they touch.
fn contact([c, b]: &[Rect; 2]) -> Vector {
    let (far_c, far_b) = (c.far_corner(), b.far_corner());
    let middle = |from: [f64; 2], to: [f64; 2]| (larger(from[0], from[1]) + smaller(to[0], to[1])) / 2.0;
    Vector::new(
        middle([c.origin.x, b.origin.x], [far_c.x, far_b.x]),
        middle([c.origin.y, b.origin.y], [far_c.y, far_b.y]),
    )
}

/// Writes what an arrow is called beside its tip.
fn name_arrow(arrow: &Arrow, markup: &str, labels: &mut Labels, panels: &mut Panels) {
    let along = arrow.to.sub(arrow.from);
    if along.norm() < arrow.width {
        return;
    }
    let line = Line::math(markup, 1.1 * panels.look.text);
    let ink = arrow.color.into();
    let label = labels.place(line, arrow.to, along, 0.7 * panels.look.text, ink);
    panels.shapes.push(label);
}

/// An arrow with a dashed shaft.
fn draw_dotted(arrow: &Arrow, look: &Look, shapes: &mut Vec<Shape>) {
    let along = arrow.to.sub(arrow.from);
    let length = along.norm();
    let head = 6.0 * arrow.width;
    if length <= head {
        return arrow.draw(look, shapes);
    }
    let neck = arrow.to.sub(along.mult(head / length));
    shapes.extend(dashed(arrow.from, neck, 2.0 * arrow.width, arrow.width, arrow.color.into()));
    Arrow { from: neck, ..*arrow }.draw(look, shapes);
}

/// Where a box was.
fn dashed_outline(rect: &Rect, look: &Look) -> Vec<Shape> {
    let (near, far) = (rect.origin, rect.far_corner());
    let corners = [near, Vector::new(far.x, near.y), far, Vector::new(near.x, far.y), near];
    let ink = Ink::from(border_color(look.palette.muted, look));
    corners.windows(2).flat_map(|side| dashed(side[0], side[1], 3.0 * look.line, look.line / 2.0, ink)).collect()
}
