use super::panels::Panels;
use super::{FigureOptions, Meeting};
use crate::physics::{Collision, Rect, Vector};
use crate::render::area::{inset, larger, overlap, smaller, union};
use crate::render::labels::{Label, Labels};
use crate::render::layers::bodies::draw_box;
use crate::render::layers::contacts::contact;
use crate::render::text::Line;
use crate::render::{Appearance, Arrow, Camera, Color, Look, Shape, Sprite, palette};
use std::sync::Arc;

/// The two boxes of a collision, and how they are drawn.
#[derive(Clone)]
pub struct Pair {
    /// Told with [`ROLES`] as they are drawn.
    pub collision: Collision,
    names: [String; 2],
    /// Of c and b.
    pub colors: [Color; 2],
    /// What is to be seen, m: of a box far larger than the other only the part beside it.
    pub area: Rect,
    /// Seconds that turn a velocity into an arrow, m.
    time: f64,
}

/// The handout's names of the two. Whichever a solver looked at first, c is drawn as the one
/// that can be pushed, or else as the one created first.
pub const ROLES: [&str; 2] = ["c", "b"];

/// The length of the longest arrow in parts of what is seen.
const LONGEST_ARROW: f64 = 0.4;

impl Pair {
    /// The pair of a collision.
    pub fn new(meeting: &Meeting, options: &FigureOptions) -> Pair {
        let [c, b] = &meeting.bodies;
        let (collision, bodies) = in_roles(&meeting.collision, [c, b]);
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
        let apart = near_parts(&pair.displaced());
        pair.area = pair.with_arrows(union(&boxes, &apart), size);
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

    /// The same pair in paler colours.
    pub fn paler(&self, look: &Look) -> Pair {
        Pair { colors: self.colors.map(|color| color.mix(look.palette.background, 45)), ..self.clone() }
    }

    /// Pixels per metre with which all of it is seen in a panel.
    pub fn scale(&self, room: &Rect) -> f64 {
        Camera::over(&self.area, [1, 1], *room, 0.0).scale
    }

    /// The camera that shows the pair with so many pixels per metre.
    pub fn camera(&self, room: &Rect, scale: f64) -> Camera {
        let middle = self.area.center().sub(room.center().mult(1.0 / scale));
        Camera { scale, origin: middle, ..Camera::over(&self.area, [1, 1], *room, 0.0) }
    }

    /// The boxes where they met, with their names.
    pub fn draw_met(&self, room: &Rect, scale: f64, arrows: &[Arrow], panels: &mut Panels) {
        let camera = self.camera(room, scale);
        let shapes = self.named_boxes(&camera, &self.collision.rects, arrows, &panels.look);
        panels.shapes.push(Shape::Clip { window: *room, shapes });
    }

    /// Where the two are once each was displaced by its share.
    pub fn displaced(&self) -> [Rect; 2] {
        let mut rects = self.collision.rects;
        let [share_c, share_b] = self.collision.shares;
        rects[0].move_by(self.collision.penetration.mult(share_c));
        rects[1].move_by(self.collision.penetration.mult(-share_b));
        rects
    }

    /// The boxes with their names in corners where no arrow is.
    pub fn named_boxes(&self, camera: &Camera, rects: &[Rect; 2], arrows: &[Arrow], look: &Look) -> Vec<Shape> {
        let mut shapes = self.boxes(camera, rects, look);
        for name in self.names(camera, rects, arrows, look) {
            name.draw_bare(&mut shapes);
        }
        shapes
    }

    /// The names of the boxes that have room for them.
    pub fn names(&self, camera: &Camera, rects: &[Rect; 2], arrows: &[Arrow], look: &Look) -> Vec<Label> {
        let mut labels = Labels::within(camera.window);
        arrows.iter().for_each(|arrow| labels.avoid_line(arrow.from, arrow.to, 1.0));
        self.collision.rects.iter().for_each(|rect| labels.avoid_border(&camera.rect(rect), 1.0));
        let name = |at: usize| self.name_in_corner(at, &camera.rect(&rects[at]), camera, &labels, look);
        [0, 1].into_iter().filter_map(name).collect()
    }

    /// The larger box first, so that the smaller one is seen.
    pub fn boxes(&self, camera: &Camera, rects: &[Rect; 2], look: &Look) -> Vec<Shape> {
        let mut shapes = Vec::new();
        let size = |at: usize| rects[at].width() * rects[at].height();
        let order = if size(0) > size(1) { [0, 1] } else { [1, 0] };
        for at in order {
            draw_box(&camera.rect(&rects[at]), self.colors[at], look, &mut shapes);
        }
        shapes
    }

    /// The name of a box, or only its role, as there is room; in the corner that is freest, and of
    /// equals the one farthest from where the two meet.
    fn name_in_corner(&self, at: usize, seen: &Rect, camera: &Camera, labels: &Labels, look: &Look) -> Option<Label> {
        let margin = 4.0 * look.line;
        let part = inset(&overlap(seen, &camera.window)?, margin);
        let lines = [self.names[at].as_str(), ROLES[at]].map(|name| Line::math(name, 0.9 * look.text));
        let line = lines.into_iter().find(|line| line.width <= part.width() && line.height() <= part.height())?;
        let (near, far) = (part.origin, part.far_corner());
        let (right, low) = (far.x - line.width, far.y - line.height());
        let corners = [(near.x, near.y), (right, near.y), (near.x, low), (right, low)];
        let meeting = camera.point(contact(&self.collision.rects));
        let mut places = corners.map(|(x, y)| Rect::new(Vector::new(x, y), line.width, line.height()));
        let distance = |place: &Rect| place.center().sub(meeting).norm().round();
        places.sort_by(|a, b| distance(b).total_cmp(&distance(a)));
        let (place, _) = labels.best(places.into_iter())?;
        Some(Label::at(&place, line, look.palette.text_on(self.colors[at])))
    }

    /// The velocities, each from the middle of what is seen of its box.
    pub fn arrows(
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
}

/// The collision as it is if the bodies change names where that suits their roles better.
fn in_roles<'a>(collision: &Collision, bodies: [&'a Appearance; 2]) -> (Collision, [&'a Appearance; 2]) {
    let rank = |body: &Appearance| (body.mass == f64::INFINITY, body.id);
    let [c, b] = bodies;
    if rank(c) <= rank(b) {
        return (collision.clone(), bodies);
    }
    let swapped = |[c, b]: [Vector; 2]| [b, c];
    let other = Collision {
        bodies: [collision.bodies[1], collision.bodies[0]],
        rects: [collision.rects[1], collision.rects[0]],
        normal: collision.normal.mult(-1.0),
        penetration: collision.penetration.mult(-1.0),
        shares: [collision.shares[1], collision.shares[0]],
        before: swapped(collision.before),
        after: swapped(collision.after),
        ..collision.clone()
    };
    (other, [b, c])
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
