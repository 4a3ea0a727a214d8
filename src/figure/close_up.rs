use super::collision::name_arrow;
use super::pair::{Pair, ROLES};
use super::panels::Panels;
use crate::physics::{Rect, Vector};
use crate::render::area::{contains, larger, overlap, smaller};
use crate::render::labels::Labels;
use crate::render::layers::contacts::contact;
use crate::render::layers::grid::round_spacing;
use crate::render::number::significant;
use crate::render::text::Line;
use crate::render::{Arrow, Camera, Color, Look, Shape};

/// What happens where the two meet, as large as is needed to see it.
pub struct CloseUp {
    /// The pair in pale colours, so that vectors stand out.
    pair: Pair,
    /// Pixels per metre.
    scale: f64,
    /// How many times larger than elsewhere in the figure.
    zoom: f64,
}

impl CloseUp {
    /// The close-up beside pictures with `scale` pixels per metre.
    pub fn new(pair: &Pair, scale: f64, look: &Look) -> CloseUp {
        let depth = pair.collision.penetration.norm() * scale;
        let wanted = 5.0 * look.text;
        let zoom = if depth > 0.0 && depth < wanted { smaller(round_spacing(wanted / depth), 1e9) } else { 1.0 };
        CloseUp { pair: pair.paler(look), scale: scale * zoom, zoom }
    }

    /// The boxes, what they share, and the vectors there.
    pub fn draw(&self, room: &Rect, panels: &mut Panels) {
        let look = panels.look;
        let rects = &self.pair.collision.rects;
        let origin = contact(rects).sub(room.center().mult(1.0 / self.scale));
        let camera = Camera { scale: self.scale, origin, ..self.pair.camera(room, self.scale) };
        let mut shapes = self.pair.boxes(&camera, rects, &look);
        let seen = rects.map(|rect| camera.rect(&rect));
        if let Some(rect) = overlap(&seen[0], &seen[1]) {
            let pale = look.palette.penetration.mix(look.palette.background, 70);
            shapes.push(Shape::Rect { rect, ink: pale.into() });
        }
        if self.zoom == 1.0 {
            let normal = self.pair.collision.normal.mult(5.0 * look.text);
            let from = camera.point(contact(rects));
            let arrow = Arrow { from, to: from.add(normal.mult(1.4)), width: look.line, color: look.palette.normal };
            let names = self.pair.names(&camera, rects, &[arrow], &look);
            names.into_iter().for_each(|name| name.draw_bare(&mut shapes));
        } else {
            shapes.extend([0, 1].map(|at| self.role(at, room, &look)));
        }
        panels.shapes.push(Shape::Clip { window: *room, shapes });
        if seen.iter().any(|rect| !contains(room, rect)) {
            panels.frame(room);
        }
        self.draw_vectors(room, panels);
    }

    /// The handout's name of a box, on the side of the contact where the box is.
    fn role(&self, at: usize, room: &Rect, look: &Look) -> Shape {
        let line = Line::math(ROLES[at], 1.4 * look.text);
        let side = self.pair.collision.normal.mult(if at == 0 { 0.4 } else { -0.4 });
        let normal = Vector::new(side.x * room.width(), side.y * room.height());
        let middle = room.center().add(normal);
        let at_middle = middle.add(Vector::new(-line.width / 2.0, line.height() / 2.0));
        Shape::Text { line, at: at_middle, ink: look.palette.text_on(self.pair.colors[at]).into() }
    }

    /// Normal, penetration and shares, side by side along the contact.
    fn draw_vectors(&self, room: &Rect, panels: &mut Panels) {
        let look = panels.look;
        let normal = self.pair.collision.normal;
        let penetration = self.pair.collision.penetration.mult(self.scale);
        let apart = if penetration == Vector::ZERO { 0.0 } else { self.contact_length() * self.scale / 3.0 };
        let across = if normal.x == 0.0 { room.width() } else { room.height() };
        let apart = smaller(apart, smaller(4.0 * look.text, 0.3 * across));
        let aside = Vector::new(-normal.y, normal.x).mult(apart);
        let [share_c, share_b] = self.pair.collision.shares;
        let blue = Color::hex(0x0072b2).mix(look.palette.ink, 20);
        let from = |place: f64, back: f64| room.center().add(aside.mult(place)).sub(penetration.mult(back));
        let vectors = [
            (from(-1.0, 0.0), normal.mult(5.0 * look.text), look.palette.normal, "n̂"),
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

    /// How long the face is along which the two meet, m.
    fn contact_length(&self) -> f64 {
        let [c, b] = &self.pair.collision.rects;
        let (far_c, far_b) = (c.far_corner(), b.far_corner());
        let x = smaller(far_c.x, far_b.x) - larger(c.origin.x, b.origin.x);
        let y = smaller(far_c.y, far_b.y) - larger(c.origin.y, b.origin.y);
        if self.pair.collision.normal.x == 0.0 { x } else { y }
    }

    /// What is written below it.
    pub fn title(&self) -> String {
        let what = if self.pair.collision.penetration == Vector::ZERO { "they touch" } else { "they overlap" };
        let zoom =
            if self.zoom == 1.0 { String::new() } else { format!(", {} \"times larger\"", significant(self.zoom, 1)) };
        format!("\"(b) {what}\"{zoom}")
    }
}
