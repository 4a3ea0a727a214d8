use super::super::area::overlap;
use super::super::{Arrow, Frame, Ink, Shape};
use super::Page;
use crate::physics::{Collision, Rect, Vector};
use crate::scene::Overlay;

/// Normals and penetration vectors of the collisions that led to this frame.
pub fn draw(frame: &Frame, page: &Page, shapes: &mut Vec<Shape>) {
    for collision in &frame.collisions {
        if page.view.style.shows(Overlay::Penetration) {
            penetration(collision, page, shapes);
        }
        if page.view.style.shows(Overlay::Normal) {
            normal(collision, page, shapes);
        }
    }
}

/// What the two boxes share, and the vector by which they are pushed apart.
fn penetration(collision: &Collision, page: &Page, shapes: &mut Vec<Shape>) {
    let camera = &page.view.camera;
    let [c, b] = collision.rects.map(|rect| camera.rect(&rect));
    let Some(shared) = overlap(&c, &b) else { return };
    let color = page.look.palette.penetration;
    shapes.push(Shape::Rect { rect: shared, ink: Ink { color, opacity: 140 } });
    let from = shared.center().sub(collision.penetration.mult(camera.scale / 2.0));
    let to = from.add(collision.penetration.mult(camera.scale));
    Arrow { from, to, width: page.look.line, color }.draw(&page.look, shapes);
}

/// The unit normal, 2.5 heights of text long, from the middle of the contact.
fn normal(collision: &Collision, page: &Page, shapes: &mut Vec<Shape>) {
    let from = page.view.camera.point(contact(&collision.rects));
    let to = from.add(collision.normal.mult(2.5 * page.look.text));
    Arrow { from, to, width: 1.5 * page.look.line, color: page.look.palette.normal }.draw(&page.look, shapes);
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
