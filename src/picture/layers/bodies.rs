use super::{LayoutContext, body_labels};
use crate::physics::{Rect, Vector, larger, smaller};
use crate::picture::{Bitmap, Color, DrawingMetrics, Frame, Ink, Shape, Sprite, color};
use crate::picture::{ColorBy, Overlay, Style};
use std::sync::Arc;

/// Draws the boxes, each with a border inside its edge. A few boxes that are hardly visible are marked by rings.
pub fn draw(frame: &Frame, context: &LayoutContext, shapes: &mut Vec<Shape>) {
    let box_count = frame.sprites.iter().filter(|sprite| !sprite.appearance.is_wall).count();
    for sprite in frame.sprites.iter().filter(|sprite| !sprite.appearance.is_wall) {
        let Some(rect) = context.visible_rect(sprite) else { continue };
        let fill = color::body_color(sprite, &context.view.style);
        let image = image_of(sprite, &context.view.style);
        match image {
            Some(image) => shapes.push(Shape::Image { bitmap: image.clone(), rect, opacity: 255 }),
            None => draw_box(&rect, fill, &context.metrics, shapes),
        }
        if let Some(visible) = rect.intersection(&context.camera.viewport) {
            Hatching::of_body(sprite, &context.view.style).draw(&visible, fill, &context.metrics, shapes);
        }
        if is_tiny(&rect) && box_count <= MAX_RINGS {
            shapes.push(ring(&rect, border_color(fill, &context.metrics), context));
        }
        if sprite.appearance.mass == f64::INFINITY && image.is_none() {
            draw_bolts(&rect, border_color(fill, &context.metrics), context, shapes);
        }
        shapes.extend(body_labels::inside(sprite, &rect, fill, box_count, context));
    }
}

/// The image that is drawn in place of the box of a body: its own, unless the colours of boxes have a meaning.
pub fn image_of<'a>(sprite: &'a Sprite, style: &Style) -> Option<&'a Arc<Bitmap>> {
    sprite.appearance.image.as_ref().filter(|_| style.look.color_by == ColorBy::Body)
}

/// The smallest box, px: a smaller one is drawn with this size.
pub const MIN_SIZE: f64 = 3.0;

/// With more boxes than this, tiny ones have no rings: a crowd of dots is visible, and rings would cover it.
const MAX_RINGS: usize = 40;

/// Returns true if a box was enlarged to the smallest size.
fn is_tiny(rect: &Rect) -> bool {
    rect.width() <= MIN_SIZE && rect.height() <= MIN_SIZE
}

/// The part of the page that a box occupies with its mark, px.
pub fn marked_rect(rect: &Rect, context: &LayoutContext) -> Rect {
    if is_tiny(rect) { rect.inset(-RING_RADIUS * context.metrics.font_size) } else { *rect }
}

/// Radius of the ring around a tiny box, in font sizes.
const RING_RADIUS: f64 = 0.4;

/// An octagon around the middle of a tiny box.
fn ring(rect: &Rect, color: Color, context: &LayoutContext) -> Shape {
    const NEAR: f64 = std::f64::consts::SQRT_2 - 1.0;
    let corners = [(1.0, NEAR), (NEAR, 1.0), (-NEAR, 1.0), (-1.0, NEAR), (-1.0, -NEAR), (-NEAR, -1.0), (NEAR, -1.0)];
    let radius = RING_RADIUS * context.metrics.font_size;
    let around = corners.into_iter().chain([(1.0, -NEAR), (1.0, NEAR)]);
    let points = around.map(|(x, y)| rect.center().add(Vector::new(x * radius, y * radius))).collect();
    Shape::Polyline { points, width: context.metrics.line_width / 2.0, ink: Ink::from(color) }
}

/// The border colour of a box.
pub fn border_color(fill: Color, metrics: &DrawingMetrics) -> Color {
    fill.mix(metrics.palette.border, 45)
}

/// Draws a box with a border inside its edge, at least one pixel wide and high. A box too small for a border is drawn
/// without one, in a colour that contrasts with the page.
///
/// The fill is drawn over a rectangle in the border colour: two rectangles are cheaper than four edges.
pub fn draw_box(rect: &Rect, fill: Color, metrics: &DrawingMetrics, shapes: &mut Vec<Shape>) {
    let border = if smaller(rect.width(), rect.height()) < 8.0 * metrics.line_width { 1.0 } else { metrics.line_width };
    let rect = Rect::new(rect.origin, larger(rect.width(), 1.0), larger(rect.height(), 1.0));
    let inner = rect.inset(border);
    if inner.width() < 1.0 || inner.height() < 1.0 {
        shapes.push(Shape::Rect { rect, ink: Ink::from(metrics.palette.line(fill)) });
        return;
    }
    shapes.push(Shape::Rect { rect, ink: Ink::from(border_color(fill, metrics)) });
    shapes.push(Shape::Rect { rect: inner, ink: Ink::from(fill) });
}

/// The hatching of a box, which distinguishes materials of the same colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hatching {
    /// No lines.
    None,
    /// Lines from lower left to upper right.
    Rising,
    /// Lines from upper left to lower right.
    Falling,
    /// Horizontal lines.
    Horizontal,
    /// Vertical lines.
    Vertical,
    /// Rising and falling lines.
    Crossed,
    /// Horizontal and vertical lines.
    Grid,
    /// The pattern of an area that a recording lacks, in a legend.
    Missing,
}

impl Hatching {
    const ALL: [Hatching; 7] = [
        Hatching::None,
        Hatching::Rising,
        Hatching::Falling,
        Hatching::Horizontal,
        Hatching::Vertical,
        Hatching::Crossed,
        Hatching::Grid,
    ];

    /// The hatching of a body in `style`.
    pub fn of_body(sprite: &Sprite, style: &Style) -> Hatching {
        match style.look.color_by {
            ColorBy::Material => Hatching::of_material(&sprite.appearance.material, style),
            ColorBy::Body | ColorBy::Speed => Hatching::None,
        }
    }

    /// The hatching of a material: none for the first ones, which have different colours.
    pub fn of_material(material: &str, style: &Style) -> Hatching {
        let index = style.materials.iter().position(|listed| listed == material).unwrap_or(0);
        Hatching::ALL[index / color::BODY_COLORS.len() % Hatching::ALL.len()]
    }

    /// Draws the lines over a rectangle filled with a colour.
    pub fn draw(self, rect: &Rect, fill: Color, metrics: &DrawingMetrics, shapes: &mut Vec<Shape>) {
        let (near, width, height) = (rect.origin, rect.width(), rect.height());
        let gap = larger(4.0 * metrics.line_width, 4.0);
        if self == Hatching::None || !(width.is_finite() && height.is_finite()) || smaller(width, height) < gap {
            return;
        }
        let ink = Ink::from(color::contrasting(fill));
        let thin = larger(metrics.line_width / 2.0, 1.0);
        let mut line = |from: [f64; 2], to: [f64; 2]| {
            let points = [from, to].map(|[x, y]| near.add(Vector::new(x, y))).to_vec();
            shapes.push(Shape::Polyline { points, width: thin, ink });
        };
        let count = |length: f64| (length / gap).ceil().clamp(0.0, 1000.0) as u32;
        let at = |number: u32| f64::from(number) * gap;
        if matches!(self, Hatching::Horizontal | Hatching::Grid) {
            (1..count(height)).for_each(|number| line([0.0, at(number)], [width, at(number)]));
        }
        if matches!(self, Hatching::Vertical | Hatching::Grid) {
            (1..count(width)).for_each(|number| line([at(number), 0.0], [at(number), height]));
        }
        if matches!(self, Hatching::Rising | Hatching::Falling | Hatching::Crossed) {
            for number in 1..count(width + height) {
                // The diagonal on which the distances from the left and from the upper or lower side sum to this.
                let sum = at(number);
                let (left, right) = (larger(sum - height, 0.0), smaller(sum, width));
                if self != Hatching::Falling {
                    line([left, sum - left], [right, sum - right]);
                }
                if self != Hatching::Rising {
                    line([left, height - (sum - left)], [right, height - (sum - right)]);
                }
            }
        }
    }
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
    let palette = &context.metrics.palette;
    let color = palette.line(color::body_color(sprite, &context.view.style)).mix(palette.background, 15);
    let segments = points.len().saturating_sub(1);
    for part in 0..TRAIL_PARTS {
        let (from, to) = (segments * part / TRAIL_PARTS, segments * (part + 1) / TRAIL_PARTS);
        let fade = (80 * (TRAIL_PARTS - 1 - part) / TRAIL_PARTS) as u8;
        let ink = Ink::from(color.mix(palette.background, fade));
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
