use super::close_up::CloseUp;
use super::pair::{Pair, ROLES};
use super::panels::{Panels, above_caption, caption, dashed, in_rows};
use super::{FigureOptions, Meeting};
use crate::physics::{Collision, Rect, Vector};
use crate::render::area::{inset, overlap};
use crate::render::labels::Labels;
use crate::render::layers::bodies::border_color;
use crate::render::number::significant;
use crate::render::text::Line;
use crate::render::{Arrow, Camera, DisplayList, Ink, Look, Shape};

/// The handout's figure 1: (a) c and b as they meet, with their velocities; (b) their overlap
/// close by, the unit normal n̂, the penetration vector n⃗ and the share of it by which each is
/// displaced; (c) the two apart again, with the velocities of their rebound, dotted.
pub fn collision(meetings: &[Meeting], options: &FigureOptions) -> DisplayList {
    in_rows(meetings, options, row)
}

/// The three pictures of one collision, and its numbers below.
fn row(meeting: &Meeting, panels: &mut Panels, options: &FigureOptions) {
    let pair = Pair::new(meeting, options);
    let facts = Line::math(&facts(&pair.collision), 0.9 * panels.look.text);
    let foot = Vector::new(panels.room.center().x, panels.room.far_corner().y);
    panels.centered(facts, foot, panels.look.palette.ink.into());
    panels.take_below(1.8 * panels.look.text);
    let places = panels.grid(3, 3);
    let [before, close, after] = [0, 1, 2].map(|at| above_caption(&places[at], &panels.look));
    let scale = pair.scale(&before);
    draw_before(&pair, &before, scale, panels);
    let close_up = CloseUp::new(&pair, scale, &panels.look);
    close_up.draw(&close, panels);
    draw_after(&pair, &after, scale, panels);
    caption(&before, "\"(a) before\"", panels);
    caption(&close, &close_up.title(), panels);
    caption(&after, "\"(c) after\"", panels);
}

fn draw_before(pair: &Pair, room: &Rect, scale: f64, panels: &mut Panels) {
    let (camera, look) = (pair.camera(room, scale), panels.look);
    let rects = pair.collision.rects;
    let arrows = pair.arrows(&camera, &rects, &pair.collision.before, look.palette.ink, &look);
    pair.draw_met(room, scale, &arrows, panels);
    let mut labels = labels(pair, room, &camera, &rects, &arrows, &look);
    for (at, arrow) in arrows.iter().enumerate() {
        arrow.draw(&look, &mut panels.shapes);
        name_arrow(arrow, &format!("v⃗_{}", ROLES[at]), &mut labels, panels);
    }
}

fn draw_after(pair: &Pair, room: &Rect, scale: f64, panels: &mut Panels) {
    let (camera, look) = (pair.camera(room, scale), panels.look);
    let rects = pair.displaced();
    let arrows = pair.arrows(&camera, &rects, &pair.collision.after, look.palette.ink, &look);
    let mut shapes = pair.named_boxes(&camera, &rects, &arrows, &look);
    for (met, _) in pair.collision.rects.iter().zip(&rects).filter(|(met, now)| met != now) {
        shapes.extend(dashed_outline(&camera.rect(met), &look));
    }
    panels.shapes.push(Shape::Clip { window: *room, shapes });
    let mut labels = labels(pair, room, &camera, &rects, &arrows, &look);
    for (at, arrow) in arrows.iter().enumerate() {
        draw_dotted(arrow, &look, &mut panels.shapes);
        name_arrow(arrow, &format!("v⃗′_{}", ROLES[at]), &mut labels, panels);
    }
}

/// Labels that keep off arrows, names and the borders of boxes.
fn labels(pair: &Pair, room: &Rect, camera: &Camera, rects: &[Rect; 2], arrows: &[Arrow; 2], look: &Look) -> Labels {
    let mut labels = Labels::within(*room);
    pair.names(camera, rects, arrows, look).iter().for_each(|name| labels.take(name.place()));
    for rect in rects.iter().filter_map(|rect| overlap(&camera.rect(rect), room)) {
        // Not even close to it, lest a label seem to touch.
        for apart in [-0.3, 0.0, 0.3] {
            labels.avoid_border(&inset(&rect, apart * look.text), 1.0);
        }
        labels.avoid(rect, 0.3);
    }
    for arrow in arrows {
        labels.avoid_line(arrow.from, arrow.to, 3.0);
    }
    labels
}

/// The numbers of the collision in one line.
fn facts(collision: &Collision) -> String {
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

/// How much of the speed along the normal came back.
fn restitution(collision: &Collision) -> Option<f64> {
    let along = |[c, b]: [Vector; 2]| c.sub(b).dot(collision.normal);
    let (before, after) = (along(collision.before), along(collision.after));
    (collision.impulse != 0.0 && before != 0.0).then(|| -after / before)
}

/// Writes what an arrow is called beside its tip.
pub fn name_arrow(arrow: &Arrow, markup: &str, labels: &mut Labels, panels: &mut Panels) {
    let along = arrow.to.sub(arrow.from);
    if along.norm() < arrow.width {
        return;
    }
    let line = Line::math(markup, 1.1 * panels.look.text);
    let label = labels.place(line, arrow.to, along, panels.look.text, arrow.color);
    label.draw(&panels.look, &mut panels.shapes);
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
    let halo = Ink::from(look.palette.background);
    shapes.push(Shape::Polyline { points: vec![arrow.from, neck], width: arrow.width + look.line, ink: halo });
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
