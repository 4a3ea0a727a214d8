use super::super::area::{inset, intersection};
use super::super::{Frame, Ink, Shape};
use super::LayoutContext;
use super::bodies::visible_rect;
use crate::physics::{Rect, Vector};

/// Draws the four walls as hatched slabs, clipped to the viewport.
pub fn draw(frame: &Frame, context: &LayoutContext, shapes: &mut Vec<Shape>) {
    let walls = frame.sprites.iter().filter(|sprite| sprite.appearance.is_wall);
    let slabs: Vec<Rect> = walls.filter_map(|sprite| visible_rect(sprite, context)).collect();
    let viewport = context.camera.viewport;
    let visible: Vec<Rect> = slabs.iter().filter_map(|slab| intersection(slab, &viewport)).collect();
    shapes.extend(visible.iter().map(|&rect| Shape::Rect { rect, ink: Ink::from(context.metrics.palette.wall) }));
    visible.iter().for_each(|slab| draw_hatch(slab, context, shapes));
    slabs.iter().for_each(|slab| draw_edge(slab, context, shapes));
}

/// Draws diagonal hatch lines from lower left to upper right. All walls share one grid of lines, so that the hatching
/// is continuous.
fn draw_hatch(slab: &Rect, context: &LayoutContext, shapes: &mut Vec<Shape>) {
    let (near, far) = (slab.origin, slab.far_corner());
    let gap = 6.0 * context.metrics.line_width;
    let first = ((near.x + near.y) / gap).ceil() as i64;
    let last = ((far.x + far.y) / gap).floor() as i64;
    let ink = Ink { color: context.metrics.palette.wall_edge, opacity: 110 };
    for diagonal in first..=last {
        let diagonal_sum = diagonal as f64 * gap;
        let at = |x: f64| Vector::new(x, diagonal_sum - x);
        let left = if diagonal_sum - near.x > far.y { diagonal_sum - far.y } else { near.x };
        let right = if diagonal_sum - far.x < near.y { diagonal_sum - near.y } else { far.x };
        if right - left >= 1.0 {
            shapes.push(Shape::Polyline {
                points: vec![at(left), at(right)],
                width: context.metrics.line_width / 2.0,
                ink,
            });
        }
    }
}

/// Draws a line along the sides of the wall that face the world.
fn draw_edge(slab: &Rect, context: &LayoutContext, shapes: &mut Vec<Shape>) {
    let world = context.camera.rect(&Rect::new(Vector::ZERO, context.camera.world.x, context.camera.world.y));
    let rim = inset(&world, -context.metrics.line_width);
    if let Some(rect) = intersection(slab, &rim) {
        shapes.push(Shape::Rect { rect, ink: Ink::from(context.metrics.palette.wall_edge) });
    }
}
