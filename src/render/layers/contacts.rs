use super::super::area::overlap;
use super::super::number::significant;
use super::super::{Arrow, Frame, Ink, Shape};
use super::velocities::length;
use super::{NamedArrow, Page};
use crate::physics::{Collision, Rect, Vector};
use crate::scene::Overlay;

/// What the two boxes of each collision that led to this frame share.
pub fn draw_overlaps(frame: &Frame, page: &Page, shapes: &mut Vec<Shape>) {
    if !page.view.style.shows(Overlay::Penetration) {
        return;
    }
    let ink = Ink { color: page.look.palette.penetration, opacity: 140 };
    let shared = frame.collisions.iter().filter_map(|collision| shared(collision, page));
    shapes.extend(shared.map(|rect| Shape::Rect { rect, ink }));
}

fn shared(collision: &Collision, page: &Page) -> Option<Rect> {
    let [c, b] = collision.rects.map(|rect| page.camera.rect(&rect));
    overlap(&c, &b)
}

/// More collisions than that in one frame, and numbers beside impulses would be a clutter.
const NUMBERED: usize = 4;

/// Penetration vectors, normals and impulses of the collisions that led to this frame.
pub fn arrows(frame: &Frame, page: &Page) -> Vec<NamedArrow> {
    let numbered = frame.collisions.iter().filter(|collision| collision.impulse != 0.0).count() <= NUMBERED;
    let mut arrows = Vec::new();
    for collision in &frame.collisions {
        if page.view.style.shows(Overlay::Penetration) {
            arrows.extend(penetration(collision, page).map(NamedArrow::from));
        }
        if page.view.style.shows(Overlay::Normal) {
            arrows.push(normal(collision, page).into());
        }
        if page.view.style.shows(Overlay::Impulse) && collision.impulse != 0.0 {
            arrows.extend(impulses(collision, numbered, page));
        }
    }
    arrows
}

/// The vector by which the two boxes are pushed apart.
fn penetration(collision: &Collision, page: &Page) -> Option<Arrow> {
    let by = collision.penetration.mult(page.camera.scale);
    let from = shared(collision, page)?.center().sub(by.mult(0.5));
    Some(Arrow { from, to: from.add(by), width: page.look.line, color: page.look.palette.penetration })
}

/// The unit normal, 2.5 heights of text long, from the middle of the contact.
fn normal(collision: &Collision, page: &Page) -> Arrow {
    let from = page.camera.point(contact(&collision.rects));
    let to = from.add(collision.normal.mult(2.5 * page.look.text));
    Arrow { from, to, width: 1.5 * page.look.line, color: page.look.palette.normal }
}

/// What each of the two is given: +j·n̂ for c and −j·n̂ for b, with j written at the first.
fn impulses(collision: &Collision, numbered: bool, page: &Page) -> [NamedArrow; 2] {
    // Beside the normal, where both are shown.
    let aside = if page.view.style.shows(Overlay::Normal) { 4.0 * page.look.line } else { 0.0 };
    let aside = Vector::new(-collision.normal.y, collision.normal.x).mult(aside);
    let from = page.camera.point(contact(&collision.rects)).add(aside);
    let along = length(collision.normal.mult(collision.impulse), page.view.style.top_impulse, page);
    let arrow = |by: Vector| {
        let color = page.look.palette.impulse;
        Arrow { from, to: from.add(by), width: 1.5 * page.look.line, color }
    };
    let name = if numbered { format!("j = {} \"N·s\"", significant(collision.impulse, 3)) } else { String::new() };
    [NamedArrow { arrow: arrow(along), name }, NamedArrow::from(arrow(along.mult(-1.0)))]
}

/// The middle of what two rectangles share, or of the gap between them.
pub fn contact([c, b]: &[Rect; 2]) -> Vector {
    let middle = |c: [f64; 2], b: [f64; 2]| {
        let from = if c[0] > b[0] { c[0] } else { b[0] };
        let to = if c[1] < b[1] { c[1] } else { b[1] };
        (from + to) / 2.0
    };
    let (far_c, far_b) = (c.far_corner(), b.far_corner());
    Vector::new(
        middle([c.origin.x, far_c.x], [b.origin.x, far_b.x]),
        middle([c.origin.y, far_c.y], [b.origin.y, far_b.y]),
    )
}
