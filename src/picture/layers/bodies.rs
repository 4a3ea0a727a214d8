use super::{LayoutContext, body_labels};
use crate::physics::{Rect, Vector, larger, smaller};
use crate::picture::Overlay;
use crate::picture::{Color, DrawingMetrics, Frame, Ink, Shape, Sprite, color};

/// Draws the boxes, each with a border inside its edge.
pub fn draw(frame: &Frame, context: &LayoutContext, shapes: &mut Vec<Shape>) {
    let box_count = frame.sprites.iter().filter(|sprite| !sprite.appearance.is_wall).count();
    for sprite in frame.sprites.iter().filter(|sprite| !sprite.appearance.is_wall) {
        let Some(rect) = context.visible_rect(sprite) else { continue };
        let fill = color::body_color(sprite, &context.view.style);
        draw_box(&rect, fill, &context.metrics, shapes);
        if sprite.appearance.mass == f64::INFINITY {
            draw_bolts(&rect, border_color(fill, &context.metrics), context, shapes);
        }
        shapes.extend(body_labels::inside(sprite, &rect, fill, box_count, context));
    }
}

/// The border colour of a box.
pub fn border_color(fill: Color, metrics: &DrawingMetrics) -> Color {
    fill.mix(metrics.palette.border, 45)
}

/// Draws a box with a border inside its edge, at least one pixel wide and high. A box too small for a border is drawn
/// without one.
///
/// The fill is drawn over a rectangle in the border colour: two rectangles are cheaper than four edges.
pub fn draw_box(rect: &Rect, fill: Color, metrics: &DrawingMetrics, shapes: &mut Vec<Shape>) {
    let border = if smaller(rect.width(), rect.height()) < 8.0 * metrics.line_width { 1.0 } else { metrics.line_width };
    let rect = Rect::new(rect.origin, larger(rect.width(), 1.0), larger(rect.height(), 1.0));
    let inner = rect.inset(border);
    if inner.width() < 1.0 || inner.height() < 1.0 {
        shapes.push(Shape::Rect { rect, ink: Ink::from(fill) });
        return;
    }
    shapes.push(Shape::Rect { rect, ink: Ink::from(border_color(fill, metrics)) });
    shapes.push(Shape::Rect { rect: inner, ink: Ink::from(fill) });
}

/// Marks a static body with a bolt in each corner.
fn draw_bolts(rect: &Rect, color: Color, context: &LayoutContext, shapes: &mut Vec<Shape>) {
    let (size, margin) = (2.0 * context.metrics.line_width, 3.0 * context.metrics.line_width);
    if smaller(rect.width(), rect.height()) < 2.0 * (size + margin) + size {
        return;
    }
    let near = rect.origin.add(Vector::new(margin, margin));
    let far = rect.far_corner().sub(Vector::new(margin + size, margin + size));
    for corner in [near, Vector::new(far.x, near.y), Vector::new(near.x, far.y), far] {
        shapes.push(Shape::Rect { rect: Rect::new(corner, size, size), ink: Ink::from(color) });
    }
}

/// Draws the four walls as hatched slabs, clipped to the viewport.
pub fn draw_walls(frame: &Frame, context: &LayoutContext, shapes: &mut Vec<Shape>) {
    let walls = frame.sprites.iter().filter(|sprite| sprite.appearance.is_wall);
    let slabs: Vec<Rect> = walls.filter_map(|sprite| context.visible_rect(sprite)).collect();
    let viewport = context.camera.viewport;
    let visible: Vec<Rect> = slabs.iter().filter_map(|slab| slab.intersection(&viewport)).collect();
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
    let rim = world.inset(-context.metrics.line_width);
    if let Some(rect) = slab.intersection(&rim) {
        shapes.push(Shape::Rect { rect, ink: Ink::from(context.metrics.palette.wall_edge) });
    }
}

/// Number of parts of a trail; older parts are fainter.
const TRAIL_PARTS: usize = 6;

/// Draws the earlier positions of each box, fading with age.
pub fn draw_trails(frame: &Frame, context: &LayoutContext, shapes: &mut Vec<Shape>) {
    if !context.view.style.shows(Overlay::Trail) {
        return;
    }
    for sprite in frame.sprites.iter().filter(|sprite| !sprite.appearance.is_wall) {
        draw_trail(sprite, context, shapes);
    }
}

fn draw_trail(sprite: &Sprite, context: &LayoutContext, shapes: &mut Vec<Shape>) {
    let points: Vec<Vector> = sprite.trail.iter().map(|&position| context.camera.point(position)).collect();
    let color = color::body_color(sprite, &context.view.style).mix(context.metrics.palette.background, 15);
    let segments = points.len().saturating_sub(1);
    for part in 0..TRAIL_PARTS {
        let (from, to) = (segments * part / TRAIL_PARTS, segments * (part + 1) / TRAIL_PARTS);
        let fade = (80 * (TRAIL_PARTS - 1 - part) / TRAIL_PARTS) as u8;
        let ink = Ink::from(color.mix(context.metrics.palette.background, fade));
        let part_points = without_repeats(&points[from..if from < to { to + 1 } else { from }]);
        if part_points.len() > 1 && is_near(&part_points, context) {
            shapes.push(Shape::Polyline { points: part_points, width: 1.5 * context.metrics.line_width, ink });
        }
    }
}

fn without_repeats(points: &[Vector]) -> Vec<Vector> {
    let mut points = points.to_vec();
    points.dedup();
    points
}

/// Returns true if all points are within one page size of the page; trails beyond that are not drawn.
fn is_near(points: &[Vector], context: &LayoutContext) -> bool {
    let [width, height] = context.camera.size.map(f64::from);
    points.iter().all(|at| (-width..=2.0 * width).contains(&at.x) && (-height..=2.0 * height).contains(&at.y))
}
