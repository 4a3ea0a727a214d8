use super::CollisionSubject;
use super::close_up::{CloseUp, label_arrow};
use super::pair::{Pair, ROLES};
use super::panels::{Panels, above_caption, caption, dashed, draw_rows};
use crate::physics::{Collision, Rect, Vector};
use crate::picture::layers::bodies::border_color;
use crate::picture::layers::labels::LabelPlacer;
use crate::picture::number::{TimeFormat, Unit, format_significant};
use crate::picture::text::Line;
use crate::picture::{Arrow, Camera, DisplayList, DrawingMetrics, Ink, Shape, Style};

/// Figure 1 of the handout: (a) boxes c and b at contact, with their velocities; (b) a close-up of their overlap with
/// the unit normal n̂, the penetration vector n⃗ and the share of it by which each box is displaced; (c) the boxes
/// after the displacement, with their velocities after the rebound, dashed.
pub fn collision(subjects: &[CollisionSubject], style: &Style) -> DisplayList {
    draw_rows(subjects, style, row)
}

/// Draws the three panels of one collision, with its values below.
fn row(subject: &CollisionSubject, panels: &mut Panels, style: &Style) {
    let pair = Pair::new(subject, style);
    let values = Line::math(&values(&pair.collision, style.time_format.finer(2)), 0.9 * panels.metrics.font_size);
    let bottom = Vector::new(panels.content.center().x, panels.content.far_corner().y);
    panels.centered(values, bottom, panels.metrics.palette.ink.into());
    panels.split_bottom(1.8 * panels.metrics.font_size);
    let cells = panels.grid(3, 3);
    let [before, center, after] = [0, 1, 2].map(|at| above_caption(&cells[at], &panels.metrics));
    let scale = pair.scale(&before);
    draw_before(&pair, &before, scale, panels);
    let close_up = CloseUp::new(&pair, scale, &panels.metrics);
    close_up.draw(&center, panels);
    draw_after(&pair, &after, scale, panels);
    caption(&before, "\"(a) before\"", panels);
    caption(&center, &close_up.title(), panels);
    caption(&after, "\"(c) after\"", panels);
}

fn draw_before(pair: &Pair, panel: &Rect, scale: f64, panels: &mut Panels) {
    let (camera, metrics) = (pair.camera(panel, scale), panels.metrics);
    let rects = pair.collision.rects;
    let arrows = pair.arrows(&camera, &rects, &pair.collision.before, metrics.palette.ink, &metrics);
    pair.draw_at_contact(panel, scale, &arrows, panels);
    let mut placer = placer(pair, panel, &camera, &rects, &arrows, &metrics);
    for (at, arrow) in arrows.iter().enumerate() {
        arrow.draw(&metrics, &mut panels.shapes);
        label_arrow(arrow, &format!("v⃗_{}", ROLES[at]), &mut placer, panels);
    }
}

fn draw_after(pair: &Pair, panel: &Rect, scale: f64, panels: &mut Panels) {
    let (camera, metrics) = (pair.camera(panel, scale), panels.metrics);
    let rects = pair.displaced();
    let arrows = pair.arrows(&camera, &rects, &pair.collision.after, metrics.palette.ink, &metrics);
    let mut shapes = pair.named_boxes(&camera, &rects, &arrows, &metrics);
    for (initial, _) in pair.collision.rects.iter().zip(&rects).filter(|(initial, displaced)| initial != displaced) {
        shapes.extend(dashed_outline(&camera.rect(initial), &metrics));
    }
    panels.shapes.push(Shape::Clip { window: *panel, shapes });
    let mut placer = placer(pair, panel, &camera, &rects, &arrows, &metrics);
    for (at, arrow) in arrows.iter().enumerate() {
        draw_dashed(arrow, &metrics, &mut panels.shapes);
        label_arrow(arrow, &format!("v⃗′_{}", ROLES[at]), &mut placer, panels);
    }
}

/// A label placer that avoids arrows, names and the borders of boxes.
fn placer(
    pair: &Pair,
    panel: &Rect,
    camera: &Camera,
    rects: &[Rect; 2],
    arrows: &[Arrow; 2],
    metrics: &DrawingMetrics,
) -> LabelPlacer {
    let mut placer = LabelPlacer::within(*panel);
    pair.names(camera, rects, arrows, metrics).iter().for_each(|name| placer.reserve(name.bounds()));
    for rect in rects.iter().filter_map(|rect| camera.rect(rect).intersection(panel)) {
        // Also avoids the vicinity of the border, so that labels do not appear to touch it.
        for distance in [-0.3, 0.0, 0.3] {
            placer.avoid_border(&rect.inset(distance * metrics.font_size), 1.0);
        }
        placer.avoid(rect, 0.3);
    }
    for arrow in arrows {
        placer.avoid_line(arrow.from, arrow.to, 3.0);
    }
    placer
}

/// The values of the collision in one line, as markup.
fn values(collision: &Collision, format: TimeFormat) -> String {
    let time = format!("t = {} \"{}\"", format.number(collision.instant), format.unit());
    let mut values = vec![format!("\"step\" {}", collision.step), time];
    if collision.penetration != Vector::ZERO {
        values.push(format!("|n⃗| = {}", Unit::METRE.format(collision.penetration.norm(), 3)));
        let shares = ["N_c", "N_b"].into_iter().zip(collision.shares);
        values.extend(shares.map(|(symbol, share)| format!("{symbol} = {}", format_significant(share, 3))));
    }
    if collision.impulse == 0.0 {
        let is_at_rest = collision.before.iter().all(|velocity| *velocity == Vector::ZERO);
        values.push(if is_at_rest { "|v⃗_c| = |v⃗_b| = 0".to_owned() } else { "\"no impulse\"".to_owned() });
    } else {
        values.push(format!("e = {}", format_significant(collision.restitution, 3)));
        values.push(format!("j = {}", Unit::NEWTON_SECOND.format(collision.impulse, 3)));
    }
    values.join(",   ")
}

/// Draws an arrow with a dashed shaft.
fn draw_dashed(arrow: &Arrow, metrics: &DrawingMetrics, shapes: &mut Vec<Shape>) {
    let direction = arrow.to.sub(arrow.from);
    let length = direction.norm();
    let head = 6.0 * arrow.width;
    if length <= head {
        return arrow.draw(metrics, shapes);
    }
    let neck = arrow.to.sub(direction.mult(head / length));
    let halo = Ink::from(metrics.palette.background);
    shapes.push(Shape::Polyline { points: vec![arrow.from, neck], width: arrow.width + metrics.line_width, ink: halo });
    shapes.extend(dashed(arrow.from, neck, 2.0 * arrow.width, arrow.width, arrow.color.into()));
    Arrow { from: neck, ..*arrow }.draw(metrics, shapes);
}

/// The outline of a box, dashed.
fn dashed_outline(rect: &Rect, metrics: &DrawingMetrics) -> Vec<Shape> {
    let (near, far) = (rect.origin, rect.far_corner());
    let corners = [near, Vector::new(far.x, near.y), far, Vector::new(near.x, far.y), near];
    let ink = Ink::from(border_color(metrics.palette.muted, metrics));
    corners
        .windows(2)
        .flat_map(|side| dashed(side[0], side[1], 3.0 * metrics.line_width, metrics.line_width / 2.0, ink))
        .collect()
}
