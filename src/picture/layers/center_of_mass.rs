use super::LayoutContext;
use crate::physics::{Rect, Vector};
use crate::picture::{Frame, Ink, Overlay, Shape};

/// Radius of the mark, in font sizes.
const RADIUS: f64 = 0.5;

/// The centre of mass of the bodies of finite mass, m; `None` without any.
fn center_of_mass(frame: &Frame) -> Option<Vector> {
    let (mut mass, mut moment) = (0.0, Vector::ZERO);
    for sprite in frame.sprites.iter().filter(|sprite| sprite.appearance.mass.is_finite()) {
        mass += sprite.appearance.mass;
        moment = moment.add(sprite.rect.center().mult(sprite.appearance.mass));
    }
    (mass > 0.0).then(|| moment.mult(1.0 / mass)).filter(|center| center.is_finite())
}

/// The bounds of the mark, px, if the overlay is shown.
pub fn bounds(frame: &Frame, context: &LayoutContext) -> Option<Rect> {
    let center = center_of_mass(frame).filter(|_| context.view.style.shows(Overlay::Com))?;
    Some(Rect::new(context.camera.point(center), 0.0, 0.0).inset(-RADIUS * context.metrics.font_size))
}

/// Draws the centre of mass as a disc with two opposite quarters filled, as is usual in engineering drawings.
pub fn draw(frame: &Frame, context: &LayoutContext, shapes: &mut Vec<Shape>) {
    let Some(bounds) = bounds(frame, context) else { return };
    let (middle, radius) = (bounds.center(), bounds.width() / 2.0);
    let point = |[x, y]: [f64; 2], radius: f64| middle.add(Vector::new(x, y).mult(radius));
    let disc = |radius: f64| QUARTERS.iter().flatten().map(|at| point(*at, radius)).collect();
    let (ink, page) = (Ink::from(context.metrics.palette.ink), Ink::from(context.metrics.palette.background));
    let line = context.metrics.line_width;
    // The outermost ring separates the mark from a box in the colour of the ink.
    for (radius, ink) in [(radius + line, page), (radius, ink), (radius - 0.75 * line, page)] {
        shapes.push(Shape::Polygon { points: disc(radius), ink });
    }
    for quarter in [&QUARTERS[0], &QUARTERS[2]] {
        let arc = quarter.iter().map(|at| point(*at, radius));
        shapes.push(Shape::Polygon { points: std::iter::once(middle).chain(arc).collect(), ink });
    }
}

/// Points of the four quarters of the unit circle, 15° apart.
const QUARTERS: [[[f64; 2]; 7]; 4] = {
    const A: f64 = 0.965_925_826_289_068_3;
    const B: f64 = 0.866_025_403_784_438_6;
    const C: f64 = std::f64::consts::FRAC_1_SQRT_2;
    const D: f64 = 0.258_819_045_102_520_8;
    [
        [[1.0, 0.0], [A, D], [B, 0.5], [C, C], [0.5, B], [D, A], [0.0, 1.0]],
        [[0.0, 1.0], [-D, A], [-0.5, B], [-C, C], [-B, 0.5], [-A, D], [-1.0, 0.0]],
        [[-1.0, 0.0], [-A, -D], [-B, -0.5], [-C, -C], [-0.5, -B], [-D, -A], [0.0, -1.0]],
        [[0.0, -1.0], [D, -A], [0.5, -B], [C, -C], [B, -0.5], [A, -D], [1.0, 0.0]],
    ]
};
