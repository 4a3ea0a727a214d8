use super::super::area::{inset, overlap};
use super::super::{Frame, Ink, Shape};
use super::Page;
use super::bodies::seen;
use crate::physics::{Rect, Vector};

/// The four walls as hatched slabs that reach to the border of the picture.
pub fn draw(frame: &Frame, page: &Page, shapes: &mut Vec<Shape>) {
    let walls = frame.sprites.iter().filter(|sprite| sprite.appearance.is_wall);
    let slabs: Vec<Rect> = walls.filter_map(|sprite| seen(sprite, page)).collect();
    let window = page.camera.window;
    let seen: Vec<Rect> = slabs.iter().filter_map(|slab| overlap(slab, &window)).collect();
    shapes.extend(seen.iter().map(|&rect| Shape::Rect { rect, ink: Ink::from(page.look.palette.wall) }));
    seen.iter().for_each(|slab| hatch(slab, page, shapes));
    slabs.iter().for_each(|slab| edge(slab, page, shapes));
}

/// Strokes from lower left to upper right, on one grid for all walls so that they meet.
fn hatch(slab: &Rect, page: &Page, shapes: &mut Vec<Shape>) {
    let (near, far) = (slab.origin, slab.far_corner());
    let gap = 6.0 * page.look.line;
    let first = ((near.x + near.y) / gap).ceil() as i64;
    let last = ((far.x + far.y) / gap).floor() as i64;
    let ink = Ink { color: page.look.palette.wall_edge, opacity: 110 };
    for diagonal in first..=last {
        let sum = diagonal as f64 * gap;
        let at = |x: f64| Vector::new(x, sum - x);
        let left = if sum - near.x > far.y { sum - far.y } else { near.x };
        let right = if sum - far.x < near.y { sum - near.y } else { far.x };
        if right - left >= 1.0 {
            shapes.push(Shape::Polyline { points: vec![at(left), at(right)], width: page.look.line / 2.0, ink });
        }
    }
}

/// A line along the sides that are inside the picture.
fn edge(slab: &Rect, page: &Page, shapes: &mut Vec<Shape>) {
    let world = page.camera.rect(&Rect::new(Vector::ZERO, page.camera.world.x, page.camera.world.y));
    let rim = inset(&world, -page.look.line);
    if let Some(rect) = overlap(slab, &rim) {
        shapes.push(Shape::Rect { rect, ink: Ink::from(page.look.palette.wall_edge) });
    }
}
