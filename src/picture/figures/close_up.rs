use super::pair::{Pair, ROLES};
use super::panels::Panels;
use crate::physics::{Axis, Rect, Vector, larger, smaller};
use crate::picture::layers::contacts::contact_center;
use crate::picture::layers::labels::{Halo, Label, LabelPlacer};
use crate::picture::number::{format_significant, nice_below, nice_spacing};
use crate::picture::text::Line;
use crate::picture::{Arrow, Camera, Color, DrawingMetrics, Language, Shape};

/// A close-up of the contact, magnified until the penetration is clearly visible, but only as far as both boxes stay
/// recognisable. A penetration that would then be too short to see is magnified further, as a detail.
pub struct CloseUp {
    /// The pair in faded colours, so that vectors stand out.
    pair: Pair,
    /// Pixels per metre.
    scale: f64,
    /// Magnification relative to the other panels of the figure.
    zoom: f64,
    extent: Extent,
}

/// The part of the boxes that a close-up shows.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Extent {
    /// Enough of both to recognise them.
    Boxes,
    /// The vicinity of the penetration.
    Detail,
}

/// The part of the smaller box, on each side of the contact, by which boxes are recognised.
const RECOGNISABLE: f64 = 0.4;

impl CloseUp {
    /// Creates the close-up in a panel of a figure whose other panels have `scale` pixels per metre. On both sides of
    /// the overlap there is space for the boxes.
    pub fn new(pair: &Pair, panel: &Rect, scale: f64, metrics: &DrawingMetrics) -> CloseUp {
        let depth = pair.collision.penetration.norm() * scale;
        let along = if pair.collision.normal.x == 0.0 { panel.height() } else { panel.width() };
        let target_length = smaller(5.0 * metrics.font_size, 0.3 * along);
        let (zoom, extent) = if depth > 0.0 && depth < target_length {
            let detail = smaller(nice_spacing(target_length / depth), nice_below(0.6 * along / depth));
            let recognisable = recognisable_zoom(pair, panel, scale);
            let is_visible = depth * recognisable >= MIN_DEPTH * metrics.font_size;
            let boxes =
                smaller(detail, if recognisable < 10.0 { recognisable.floor() } else { nice_below(recognisable) });
            if is_visible { (larger(boxes, 1.0), Extent::Boxes) } else { (smaller(detail, 1e9), Extent::Detail) }
        } else {
            (1.0, Extent::Boxes)
        };
        CloseUp { pair: pair.faded(metrics), scale: scale * zoom, zoom, extent }
    }

    /// The area of a detail in a panel, m.
    pub fn detail(&self, panel: &Rect) -> Option<Rect> {
        let size = Vector::new(panel.width(), panel.height()).mult(1.0 / self.scale);
        let origin = contact_center(&self.pair.collision.rects).sub(size.mult(0.5));
        (self.extent == Extent::Detail).then(|| Rect::new(origin, size.x, size.y))
    }

    /// Draws the boxes, their overlap, and the vectors of the contact.
    pub fn draw(&self, panel: &Rect, panels: &mut Panels) {
        let metrics = panels.metrics;
        let rects = &self.pair.collision.rects;
        let origin = contact_center(rects).sub(panel.center().mult(1.0 / self.scale));
        let camera = Camera { scale: self.scale, origin, ..self.pair.camera(panel, self.scale) };
        let mut shapes = self.pair.boxes(&camera, rects, &metrics);
        let mut fills = self.pair.fills(&camera, rects).to_vec();
        let page_rects = rects.map(|rect| camera.rect(&rect));
        if let Some(rect) = page_rects[0].intersection(&page_rects[1]) {
            let pale = metrics.palette.penetration.mix(metrics.palette.background, 70);
            shapes.push(Shape::Rect { rect, ink: pale.into() });
            fills.push((rect, pale));
        }
        let mut placer = LabelPlacer::within(*panel);
        if self.extent == Extent::Boxes {
            let arrows = self
                .vectors(panel, &metrics)
                .map(|(from, vector, color, _)| Arrow::new(from, from.add(vector), metrics.line_width, color).into());
            let names = self.pair.names(&camera, rects, &arrows, &metrics);
            names.iter().for_each(|name| placer.reserve(name.bounds()));
            names.into_iter().for_each(|name| name.draw_over(&fills, Halo::None, &metrics, &mut shapes));
        } else {
            for at in [0, 1] {
                let label = self.role_label(at, panel, &metrics);
                placer.reserve(label.bounds());
                label.draw_over(&fills, Halo::None, &metrics, &mut shapes);
            }
        }
        panels.shapes.push(Shape::Clip { window: *panel, shapes });
        if page_rects.iter().any(|rect| !panel.contains(rect)) {
            panels.draw_frame(panel);
        }
        self.draw_vectors(panel, &fills, &mut placer, panels);
    }

    /// The handout's name of a box as a label on the box's side of the contact.
    fn role_label(&self, at: usize, panel: &Rect, metrics: &DrawingMetrics) -> Label {
        let line = Line::math(ROLES[at], 1.4 * metrics.font_size);
        // Within the panel, however small it is.
        let distance = |extent: f64| smaller(0.4 * extent, extent / 2.0 - line.size);
        let side = self.pair.collision.normal.mult(if at == 0 { 1.0 } else { -1.0 });
        // Beside the arrows, so that no label of an arrow follows the name.
        let beside = Vector::new(side.y.abs() * distance(panel.width()), side.x.abs() * distance(panel.height()));
        let offset = Vector::new(side.x * distance(panel.width()), side.y * distance(panel.height())).sub(beside);
        let middle = panel.center().add(offset);
        let baseline = middle.add(Vector::new(-line.width / 2.0, line.height() / 2.0));
        Label { line, at: baseline, color: metrics.palette.text_on(self.pair.colors[at]) }
    }

    /// Normal, penetration and its shares side by side along the contact: start and vector, px, colour and name.
    fn vectors(&self, panel: &Rect, metrics: &DrawingMetrics) -> [(Vector, Vector, Color, &'static str); 4] {
        let normal = self.pair.collision.normal;
        let penetration = self.pair.collision.penetration.mult(self.scale);
        let spacing = if penetration == Vector::ZERO { 0.0 } else { self.contact_length() * self.scale / 3.0 };
        let across = if normal.x == 0.0 { panel.width() } else { panel.height() };
        let spacing = smaller(spacing, smaller(4.0 * metrics.font_size, 0.3 * across));
        let step = Vector::new(-normal.y, normal.x).mult(spacing);
        let along = if normal.x == 0.0 { panel.height() } else { panel.width() };
        let normal_length = smaller(5.0 * metrics.font_size, 0.35 * along);
        let [share_c, share_b] = self.pair.collision.shares;
        let blue = Color::hex(0x0072b2).mix(metrics.palette.ink, 20);
        let from =
            |steps: f64, penetrations: f64| panel.center().add(step.mult(steps)).sub(penetration.mult(penetrations));
        [
            (from(-1.0, 0.0), normal.mult(normal_length), metrics.palette.normal, "n̂"),
            (from(0.0, 0.5), penetration, metrics.palette.penetration, "n⃗"),
            (from(1.0, 0.0), penetration.mult(share_c), blue, "N_c n⃗"),
            (from(1.0, 0.0), penetration.mult(-share_b), blue, "-N_b n⃗"),
        ]
    }

    /// Draws the vectors.
    fn draw_vectors(&self, panel: &Rect, fills: &[(Rect, Color)], placer: &mut LabelPlacer, panels: &mut Panels) {
        let metrics = panels.metrics;
        let vectors = self.vectors(panel, &metrics);
        for &(from, vector, _, _) in &vectors {
            placer.avoid_line(from, from.add(vector), 3.0);
        }
        for (from, vector, color, name) in vectors.into_iter().filter(|(_, vector, _, _)| vector.norm() > 0.0) {
            let arrow = Arrow::new(from, from.add(vector), 1.5 * metrics.line_width, color);
            arrow.draw(&metrics, &mut panels.shapes);
            label_arrow(&arrow, name, fills, placer, panels);
        }
    }

    /// Length of the shared face of the two boxes, m.
    fn contact_length(&self) -> f64 {
        let [c, b] = &self.pair.collision.rects;
        c.overlap_along(if self.pair.collision.normal.x == 0.0 { Axis::X } else { Axis::Y }, b)
    }

    /// A long and a short caption below the panel, as markup.
    pub fn titles(&self, language: Language) -> [String; 2] {
        let state = match self.pair.collision.penetration {
            Vector::ZERO => language.of("they touch", "contact"),
            _ => language.of("they overlap", "chevauchement"),
        };
        let larger = language.of("times larger", "fois plus grand");
        let zoom = language.decimal(format_significant(self.zoom, 1));
        match self.zoom {
            1.0 => [0, 1].map(|_| format!("\"(b) {state}\"")),
            _ => [format!("\"(b) {state}\", {zoom} \"{larger}\""), format!("\"(b) {state}, \"×{zoom}")],
        }
    }
}

/// The shortest visible penetration, in font sizes.
const MIN_DEPTH: f64 = 0.6;

/// The largest magnification with which a panel around the contact shows the recognisable part of the smaller box,
/// along both axes.
fn recognisable_zoom(pair: &Pair, panel: &Rect, scale: f64) -> f64 {
    let [c, b] = &pair.collision.rects;
    let along = |panel: f64, c: f64, b: f64| panel / 2.0 / (RECOGNISABLE * smaller(c, b) * scale);
    smaller(along(panel.width(), c.width(), b.width()), along(panel.height(), c.height(), b.height()))
}

/// Draws the label of an arrow at its tip, over boxes of these areas and colours.
pub fn label_arrow(
    arrow: &Arrow,
    markup: &str,
    fills: &[(Rect, Color)],
    placer: &mut LabelPlacer,
    panels: &mut Panels,
) {
    let direction = arrow.to.sub(arrow.from);
    if direction.norm() < arrow.width {
        return;
    }
    let line = Line::math(markup, 1.1 * panels.metrics.font_size);
    if let Some(label) = placer.place(line, arrow.to, direction, panels.metrics.font_size, arrow.color) {
        label.draw_over(fills, Halo::Around, &panels.metrics, &mut panels.shapes);
    }
}
