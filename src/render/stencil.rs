use super::canvas::{Clip, FULL};
use super::line_coverage;
use super::text::{Font, Segment, UNITS_PER_EM};
use crate::physics::Vector;
use tiny_skia::{FillRule, Mask, Path, PathBuilder, Transform};

/// Which part of each pixel a shape covers, in sixteenths.
pub struct Stencil {
    /// The column of its first pixels; of a glyph, from where the glyph is placed.
    pub left: i64,
    /// The row of its first pixels, likewise.
    pub top: i64,
    /// Pixels in a row.
    pub width: usize,
    /// Row by row.
    pub coverage: Vec<u8>,
}

impl Stencil {
    fn empty() -> Stencil {
        Stencil { left: 0, top: 0, width: 1, coverage: Vec::new() }
    }

    /// What of a polygon lies within `clip`.
    pub fn polygon(points: &[Vector], clip: &Clip) -> Stencil {
        let Some(first) = points.first() else { return Stencil::empty() };
        // Moved near the origin, where f32 is exact enough.
        let corner = Vector::new(first.x.floor(), first.y.floor());
        let Some(path) = closed_path(points, corner) else { return Stencil::empty() };
        let Some(window) = Window::around(&path).meet(&Window::of(clip, corner)) else { return Stencil::empty() };
        let near = Stencil::of(&path, &window).unwrap_or_else(Stencil::empty);
        Stencil { left: corner.x as i64 + near.left, top: corner.y as i64 + near.top, ..near }
    }

    /// What of a line of round ends and corners lies within `clip`.
    pub fn line(points: &[Vector], width: f64, clip: &Clip) -> Stencil {
        let Some(bounds) = line_coverage::bounds(points, width, clip) else { return Stencil::empty() };
        let coverage = line_coverage::coverage(points, width, &bounds);
        Stencil { left: bounds.left as i64, top: bounds.top as i64, width: bounds.right - bounds.left, coverage }
    }

    /// A glyph, its em that many quarters of a pixel high, its origin as many quarters right of
    /// and below the corner of a pixel.
    pub fn glyph(id: u16, size: u32, [x, y]: [u8; 2]) -> Stencil {
        let [size, x, y] = [size, u32::from(x), u32::from(y)].map(|quarters| quarters as f32 / 4.0);
        let scale = size / UNITS_PER_EM as f32;
        let place = |[across, up]: [f32; 2]| [x + across * scale, y - up * scale];
        let mut path = PathBuilder::new();
        for segment in Font::embedded().outline(id) {
            add_segment(&mut path, segment, place);
        }
        path.finish().and_then(|path| Stencil::of(&path, &Window::around(&path))).unwrap_or_else(Stencil::empty)
    }

    fn of(path: &Path, window: &Window) -> Option<Stencil> {
        let [left, top] = window.from;
        let [width, height] = [0, 1].map(|axis| (window.to[axis] - window.from[axis]) as u32);
        let mut mask = Mask::new(width, height)?;
        let path = path.clone().transform(Transform::from_translate(-left, -top))?;
        mask.fill_path(&path, FillRule::Winding, true, Transform::identity());
        let mut coverage = mask.take();
        coverage.iter_mut().for_each(|part| *part = sixteenths(f64::from(*part) / 255.0));
        Some(Stencil { left: left as i64, top: top as i64, width: width as usize, coverage })
    }
}

/// A part of 1 in sixteenths, to the nearest eighth: finer steps are not seen, and each would
/// cost a colour for every pair of colours that meet.
pub fn sixteenths(part: f64) -> u8 {
    const STEPS: u8 = FULL / 2;
    (part * f64::from(STEPS)).round() as u8 * 2
}

fn closed_path(points: &[Vector], corner: Vector) -> Option<Path> {
    let mut path = PathBuilder::new();
    for (place, point) in points.iter().enumerate() {
        let (x, y) = ((point.x - corner.x) as f32, (point.y - corner.y) as f32);
        if place == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
    }
    path.close();
    path.finish()
}

fn add_segment(path: &mut PathBuilder, segment: Segment, place: impl Fn([f32; 2]) -> [f32; 2]) {
    match segment {
        Segment::Move(to) => {
            let [x, y] = place(to);
            path.move_to(x, y);
        }
        Segment::Line(to) => {
            let [x, y] = place(to);
            path.line_to(x, y);
        }
        Segment::Quadratic(points) => {
            let [[cx, cy], [x, y]] = points.map(place);
            path.quad_to(cx, cy, x, y);
        }
        Segment::Close => path.close(),
    }
}

/// Whole pixels from `from` to before `to`, along x and y.
struct Window {
    from: [f32; 2],
    to: [f32; 2],
}

impl Window {
    fn around(path: &Path) -> Window {
        let bounds = path.bounds();
        Window {
            from: [bounds.left().floor(), bounds.top().floor()],
            to: [bounds.right().floor() + 1.0, bounds.bottom().floor() + 1.0],
        }
    }

    /// A part of the page as seen from a point of it.
    fn of(clip: &Clip, point: Vector) -> Window {
        let from = |at: usize, origin: f64| (at as f64 - origin) as f32;
        Window {
            from: [from(clip.left, point.x), from(clip.top, point.y)],
            to: [from(clip.right, point.x), from(clip.bottom, point.y)],
        }
    }

    fn meet(&self, other: &Window) -> Option<Window> {
        let larger = |a: f32, b: f32| if a > b { a } else { b };
        let smaller = |a: f32, b: f32| if a < b { a } else { b };
        let from = [0, 1].map(|axis| larger(self.from[axis], other.from[axis]));
        let to = [0, 1].map(|axis| smaller(self.to[axis], other.to[axis]));
        (from[0] < to[0] && from[1] < to[1]).then_some(Window { from, to })
    }
}
