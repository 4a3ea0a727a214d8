use super::super::{Frame, Ink, Shape, Sprite, palette};
use super::LayoutContext;
use crate::physics::Vector;
use crate::scene::Overlay;

/// Number of parts of a trail; older parts are fainter.
const PARTS: usize = 6;

/// Draws the earlier positions of each box, fading with age.
pub fn draw(frame: &Frame, context: &LayoutContext, shapes: &mut Vec<Shape>) {
    if !context.view.style.shows(Overlay::Trail) {
        return;
    }
    for sprite in frame.sprites.iter().filter(|sprite| !sprite.appearance.is_wall) {
        draw_trail(sprite, context, shapes);
    }
}

fn draw_trail(sprite: &Sprite, context: &LayoutContext, shapes: &mut Vec<Shape>) {
    let points: Vec<Vector> = sprite.trail.iter().map(|&position| context.camera.point(position)).collect();
    let color = palette::body_color(sprite, &context.view.style).mix(context.metrics.palette.background, 15);
    let segments = points.len().saturating_sub(1);
    for part in 0..PARTS {
        let (from, to) = (segments * part / PARTS, segments * (part + 1) / PARTS);
        let fade = (80 * (PARTS - 1 - part) / PARTS) as u8;
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
