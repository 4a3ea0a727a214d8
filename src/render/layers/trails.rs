use super::super::{Frame, Ink, Shape, Sprite, palette};
use super::Page;
use crate::physics::Vector;
use crate::scene::Overlay;

/// Into so many parts a trail is cut, each fainter than the one after it.
const PARTS: usize = 6;

/// Where each box was, fading with age.
pub fn draw(frame: &Frame, page: &Page, shapes: &mut Vec<Shape>) {
    if !page.view.style.shows(Overlay::Trail) {
        return;
    }
    for sprite in frame.sprites.iter().filter(|sprite| !sprite.appearance.is_wall) {
        trail(sprite, page, shapes);
    }
}

fn trail(sprite: &Sprite, page: &Page, shapes: &mut Vec<Shape>) {
    let points: Vec<Vector> = sprite.trail.iter().map(|&place| page.camera.point(place)).collect();
    let color = palette::body_color(sprite, &page.view.style).mix(page.look.palette.background, 15);
    let cuts = points.len().saturating_sub(1);
    for part in 0..PARTS {
        let (from, to) = (cuts * part / PARTS, cuts * (part + 1) / PARTS);
        let faint = (80 * (PARTS - 1 - part) / PARTS) as u8;
        let ink = Ink::from(color.mix(page.look.palette.background, faint));
        let seen = without_repeats(&points[from..if from < to { to + 1 } else { from }]);
        if seen.len() > 1 && is_near(&seen, page) {
            shapes.push(Shape::Polyline { points: seen, width: 1.5 * page.look.line, ink });
        }
    }
}

fn without_repeats(points: &[Vector]) -> Vec<Vector> {
    let mut points = points.to_vec();
    points.dedup();
    points
}

/// Whether all points are within a page's width of the page: what is farther is not drawn.
fn is_near(points: &[Vector], page: &Page) -> bool {
    let [width, height] = page.camera.size.map(f64::from);
    points.iter().all(|at| (-width..=2.0 * width).contains(&at.x) && (-height..=2.0 * height).contains(&at.y))
}
