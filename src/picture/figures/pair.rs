use super::CollisionSubject;
use crate::physics::{Axis, Collision, Rect, Vector, larger, smaller};
use crate::picture::layers::arrows::LabeledArrow;
use crate::picture::layers::bodies::draw_box;
use crate::picture::layers::contacts::contact_center;
use crate::picture::layers::labels::{Halo, Label, LabelPlacer};
use crate::picture::layers::lanes::{Lanes, separate};
use crate::picture::text::Line;
use crate::picture::{Appearance, Arrow, Camera, Color, DrawingMetrics, ReferenceFrame, Shape, Sprite, Style, color};
use std::sync::Arc;

/// The two boxes of a collision and how they are drawn.
#[derive(Clone)]
pub struct Pair {
    /// The collision, its bodies in the order of [`ROLES`].
    pub collision: Collision,
    names: [String; 2],
    /// The masses of c and b, kg.
    pub masses: [f64; 2],
    /// The colours of c and b.
    pub colors: [Color; 2],
    /// The boxes at contact and after the displacement, m. A box far larger than the other is cropped around it.
    boxes: Rect,
    /// Factor from velocity to arrow length, px per m/s: one scale for all pairs of a page. 0 without arrows.
    arrow_scale: f64,
}

/// The handout's names of the two bodies. The body of finite mass is c; if both masses are finite or infinite, c is the
/// body created first. This does not depend on the order in the recorded collision.
pub const ROLES: [&str; 2] = ["c", "b"];

/// The collision of a subject in a frame of reference, and the velocity of that frame, m/s.
pub fn seen_from(subject: &CollisionSubject, frame: ReferenceFrame) -> (CollisionSubject, Vector) {
    let velocity = match frame {
        ReferenceFrame::Laboratory => Vector::ZERO,
        ReferenceFrame::CenterOfMass => {
            velocity_of_center(subject.bodies.each_ref().map(|body| body.mass), subject.collision.before)
        }
    };
    let mut subject = subject.clone();
    let Collision { before, after, .. } = &mut subject.collision;
    before.iter_mut().chain(after).for_each(|seen| *seen = seen.sub(velocity));
    (subject, velocity)
}

/// The velocity of the centre of mass of two bodies, m/s; that of an infinite mass if there is one.
fn velocity_of_center([c, b]: [f64; 2], velocities: [Vector; 2]) -> Vector {
    // The ratio of the masses does not overflow, unlike their momenta.
    let ([heavy, light], ratio) = if c >= b { (velocities, b / c) } else { ([velocities[1], velocities[0]], c / b) };
    // Two infinite masses have no ratio.
    let ratio = if ratio.is_nan() { 0.0 } else { ratio };
    heavy.add(light.mult(ratio)).mult(1.0 / (1.0 + ratio))
}

impl Pair {
    /// Creates the pair of a collision.
    pub fn new(subject: &CollisionSubject, arrow_scale: f64, style: &Style) -> Pair {
        let [c, b] = &subject.bodies;
        let (collision, bodies) = assign_roles(&subject.collision, [c, b]);
        let names = [0, 1].map(|at| match bodies[at].name.as_str() {
            name if name == ROLES[at] => format!("\"{name}\""),
            name => format!("{}: \"{}\"", ROLES[at], name.replace('"', "'")),
        });
        let masses = bodies.map(|body| body.mass);
        let colors = [0, 1].map(|at| body_color(bodies[at], collision.before[at], style));
        let boxes = cropped_bounds(&collision.rects);
        let mut pair = Pair { collision, names, masses, colors, boxes, arrow_scale };
        pair.boxes = boxes.union(&cropped_bounds(&pair.displaced()));
        pair
    }

    /// Returns true if other bodies, which the two push through contacts, take part in the collision: its impulse is
    /// not that of the two alone.
    pub fn pushes_others(&self) -> bool {
        let Collision { restitution, impulse, normal_velocity: [approach, _], .. } = self.collision;
        let inverse: f64 = self.masses.iter().map(|mass| 1.0 / mass).sum();
        let alone = -(1.0 + restitution) * approach / inverse;
        let is_alone = (alone - impulse).abs() <= IMPULSE_TOLERANCE * impulse.abs();
        impulse != 0.0 && !(is_alone && alone.is_finite())
    }

    /// The pair in colours faded towards the background.
    pub fn faded(&self, metrics: &DrawingMetrics) -> Pair {
        Pair { colors: self.colors.map(|color| color.mix(metrics.palette.background, 45)), ..self.clone() }
    }

    /// The area that boxes and arrows take on a page of `scale` pixels per metre, px from the world's origin.
    fn area_on_page(&self, scale: f64) -> Rect {
        let on_page = |at: Vector| at.mult(scale);
        let boxes = Rect::new(on_page(self.boxes.origin), self.boxes.width() * scale, self.boxes.height() * scale);
        let arrows = [(self.collision.rects, self.collision.before), (self.displaced(), self.collision.after)];
        let tips = arrows.into_iter().flat_map(|(rects, velocities)| {
            [0, 1].map(|at| {
                let start = on_page(visible_center(&rects[at], &self.boxes));
                start.add(velocities[at].mult(self.arrow_scale))
            })
        });
        let all = tips.map(|tip| Rect::new(tip, 0.0, 0.0)).fold(boxes, |all, tip| all.union(&tip));
        all.inset(-MARGIN * larger(boxes.width(), boxes.height()))
    }

    /// The largest scale, in pixels per metre, with which boxes and arrows fit into a panel.
    pub fn scale(&self, panel: &Rect) -> f64 {
        let fits = |scale: f64| {
            let area = self.area_on_page(scale);
            area.width() <= panel.width() && area.height() <= panel.height()
        };
        // Without arrows; these have a fixed length, so the boxes become smaller. Their area grows with the scale.
        let mut high = Camera::fit(
            &self.boxes.inset(-MARGIN * larger(self.boxes.width(), self.boxes.height())),
            [1, 1],
            *panel,
            0.0,
        )
        .scale;
        let mut low = high / 64.0;
        if fits(high) || !high.is_finite() {
            return high;
        }
        for _ in 0..40 {
            let middle = (low + high) / 2.0;
            if fits(middle) { low = middle } else { high = middle }
        }
        low
    }

    /// The camera that shows the pair in a panel with `scale` pixels per metre.
    pub fn camera(&self, panel: &Rect, scale: f64) -> Camera {
        let origin = self.area_on_page(scale).center().sub(panel.center()).mult(1.0 / scale);
        Camera { size: [1, 1], viewport: *panel, scale, origin, world: self.boxes.far_corner() }
    }

    /// The boxes after each is displaced by its share of the penetration.
    pub fn displaced(&self) -> [Rect; 2] {
        let mut rects = self.collision.rects;
        let [share_c, share_b] = self.collision.shares;
        rects[0].move_by(self.collision.penetration.mult(share_c));
        rects[1].move_by(self.collision.penetration.mult(-share_b));
        rects
    }

    /// The boxes with their names in corners without arrows.
    pub fn named_boxes(
        &self,
        camera: &Camera,
        rects: &[Rect; 2],
        arrows: &[LabeledArrow],
        metrics: &DrawingMetrics,
    ) -> Vec<Shape> {
        let mut shapes = self.boxes(camera, rects, metrics);
        let fills = self.fills(camera, rects);
        for name in self.names(camera, rects, arrows, metrics) {
            name.draw_over(&fills, Halo::None, metrics, &mut shapes);
        }
        shapes
    }

    /// The names of the boxes, where they fit.
    pub fn names(
        &self,
        camera: &Camera,
        rects: &[Rect; 2],
        arrows: &[LabeledArrow],
        metrics: &DrawingMetrics,
    ) -> Vec<Label> {
        let mut placer = LabelPlacer::within(camera.viewport);
        arrows.iter().for_each(|LabeledArrow { arrow, .. }| placer.avoid_line(arrow.from, arrow.to, 1.0));
        self.collision.rects.iter().for_each(|rect| placer.avoid_border(&camera.rect(rect), 1.0));
        let mut names: Vec<Label> = Vec::new();
        for at in [0, 1] {
            let name = self.name_in_corner(at, &camera.rect(&rects[at]), camera, &placer, metrics);
            name.iter().for_each(|name| placer.reserve(name.bounds()));
            names.extend(name);
        }
        names
    }

    /// The boxes in drawing order.
    pub fn boxes(&self, camera: &Camera, rects: &[Rect; 2], metrics: &DrawingMetrics) -> Vec<Shape> {
        let mut shapes = Vec::new();
        for (rect, color) in self.fills(camera, rects) {
            draw_box(&rect, color, metrics, &mut shapes);
        }
        shapes
    }

    /// The areas of the boxes on the page and their colours in drawing order: the larger one first, so that the smaller
    /// one stays visible.
    pub fn fills(&self, camera: &Camera, rects: &[Rect; 2]) -> [(Rect, Color); 2] {
        let size = |at: usize| rects[at].width() * rects[at].height();
        let order = if size(0) > size(1) { [0, 1] } else { [1, 0] };
        order.map(|at| (camera.rect(&rects[at]), self.colors[at]))
    }

    /// The name of a box, or only its role if the name does not fit, in the corner of the least label cost. Of equal
    /// corners the one farthest from the contact is used.
    fn name_in_corner(
        &self,
        at: usize,
        page_rect: &Rect,
        camera: &Camera,
        placer: &LabelPlacer,
        metrics: &DrawingMetrics,
    ) -> Option<Label> {
        let margin = 4.0 * metrics.line_width;
        let visible = page_rect.intersection(&camera.viewport)?.inset(margin);
        let lines = [self.names[at].as_str(), ROLES[at]].map(|name| Line::math(name, metrics.text(0.9)));
        let line = lines.into_iter().find(|line| line.width <= visible.width() && line.height() <= visible.height())?;
        let (near, far) = (visible.origin, visible.far_corner());
        let (right, low) = (far.x - line.width, far.y - line.height());
        let corners = [(near.x, near.y), (right, near.y), (near.x, low), (right, low)];
        let contact = camera.point(contact_center(&self.collision.rects));
        let mut candidates = corners.map(|(x, y)| Rect::new(Vector::new(x, y), line.width, line.height()));
        let distance = |bounds: &Rect| bounds.center().sub(contact).norm().round();
        candidates.sort_by(|a, b| distance(b).total_cmp(&distance(a)));
        let (bounds, _) = placer.best(candidates)?;
        Some(Label::in_bounds(&bounds, line, metrics.palette.text_on(self.colors[at])))
    }

    /// The velocity arrows with labels of this symbol, from the middle of the visible part of each box. A box at rest
    /// has none.
    pub fn arrows(
        &self,
        camera: &Camera,
        rects: &[Rect; 2],
        velocities: &[Vector; 2],
        symbol: &str,
        metrics: &DrawingMetrics,
    ) -> Vec<LabeledArrow> {
        let longest = self.collision.before.iter().chain(&self.collision.after).map(|velocity| velocity.norm());
        let longest = longest.fold(0.0, larger) * self.arrow_scale;
        let arrow = |at: usize| {
            let from = camera.point(visible_center(&rects[at], &self.boxes));
            let vector = velocities[at].mult(self.arrow_scale);
            let arrow = Arrow::of_vector(from, vector, ARROW_WIDTH * metrics.line_width, metrics.palette.ink, longest)?;
            Some(LabeledArrow { arrow, key: None, label: format!("{symbol}_{}", ROLES[at]) })
        };
        let mut arrows: Vec<LabeledArrow> = [0, 1].into_iter().filter_map(arrow).collect();
        separate(&mut arrows, &Lanes::default());
        arrows
    }
}

/// The impulse of two bodies alone is exact up to this part of it: more than rounding errors, less than the digits that
/// figures show.
const IMPULSE_TOLERANCE: f64 = 1e-6;

/// Space around boxes and arrows relative to the size of the boxes.
const MARGIN: f64 = 0.06;

/// The width of velocity arrows, in line widths.
pub const ARROW_WIDTH: f64 = 1.5;

/// The collision and its bodies, swapped if necessary so that they are in the order of [`ROLES`].
fn assign_roles<'a>(collision: &Collision, bodies: [&'a Appearance; 2]) -> (Collision, [&'a Appearance; 2]) {
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

/// The colour of the body, as in frames.
fn body_color(body: &Appearance, velocity: Vector, style: &Style) -> Color {
    let metrics = DrawingMetrics::new(style.look.theme, style.look.language, style.look.size);
    if body.is_wall {
        return metrics.palette.wall;
    }
    let sprite = Sprite {
        appearance: Arc::new(body.clone()),
        rect: Rect::new(Vector::ZERO, 1.0, 1.0),
        velocity,
        trail: Vec::new(),
    };
    color::body_color(&sprite, style)
}

/// The union of both boxes; a box more than four times larger than the other is cropped around it.
fn cropped_bounds([c, b]: &[Rect; 2]) -> Rect {
    crop(c, b).union(&crop(b, c))
}

fn crop(rect: &Rect, other: &Rect) -> Rect {
    let size = larger(other.width(), other.height());
    let [[left, right], [top, bottom]] = Axis::BOTH.map(|axis| {
        let ([from, to], [low, high]) = (rect.along(axis), other.along(axis));
        if to - from <= 4.0 * size {
            [from, to]
        } else {
            [larger(from, low - 0.6 * size), smaller(to, high + 0.6 * size)]
        }
    });
    Rect::new(Vector::new(left, top), right - left, bottom - top)
}

/// The middle of the visible part of a rectangle; of the whole rectangle if none is visible.
fn visible_center(rect: &Rect, area: &Rect) -> Vector {
    rect.intersection(area).map_or(rect.center(), |visible| visible.center())
}
