use super::{ClipRect, quantize_coverage, stroke};
use crate::physics::Vector;
use crate::picture::text::{Font, PathSegment, UNITS_PER_EM};
use tiny_skia::{FillRule, Mask, Path, PathBuilder, Transform};

/// The part of each pixel that a shape covers, in sixteenths.
pub struct CoverageMask {
    /// Leftmost column; for a glyph, relative to the pixel of its origin.
    pub left: i64,
    /// Topmost row; for a glyph, relative to the pixel of its origin.
    pub top: i64,
    /// Number of columns.
    pub width: usize,
    /// Coverage, row by row.
    pub coverage: Vec<u8>,
}

impl CoverageMask {
    fn empty() -> CoverageMask {
        CoverageMask { left: 0, top: 0, width: 1, coverage: Vec::new() }
    }

    /// The part of a polygon within `clip`.
    pub fn polygon(points: &[Vector], clip: &ClipRect) -> CoverageMask {
        let Some(first) = points.first() else { return CoverageMask::empty() };
        // Shifted close to the origin, where f32 is precise enough.
        let offset = Vector::new(first.x.floor(), first.y.floor());
        let Some(path) = closed_path(points, offset) else { return CoverageMask::empty() };
        let Some(rect) = PixelRect::around(&path).intersect(&PixelRect::of(clip, offset)) else {
            return CoverageMask::empty();
        };
        let shifted = CoverageMask::of(&path, &rect).unwrap_or_else(CoverageMask::empty);
        CoverageMask { left: offset.x as i64 + shifted.left, top: offset.y as i64 + shifted.top, ..shifted }
    }

    /// The part of a polyline with round caps and joins within `clip`.
    pub fn line(points: &[Vector], width: f64, clip: &ClipRect) -> CoverageMask {
        let Some(bounds) = stroke::bounds(points, width, clip) else { return CoverageMask::empty() };
        let coverage = stroke::coverage(points, width, &bounds);
        CoverageMask { left: bounds.left as i64, top: bounds.top as i64, width: bounds.right - bounds.left, coverage }
    }

    /// A glyph. All lengths are in quarter pixels: `size` is the font size, and (x, y) the offset of the origin from
    /// the upper-left corner of its pixel.
    pub fn glyph(id: u16, size: u32, [x, y]: [u8; 2]) -> CoverageMask {
        let [size, x, y] = [size, u32::from(x), u32::from(y)].map(|quarters| quarters as f32 / 4.0);
        let scale = size / UNITS_PER_EM as f32;
        let to_page = |[across, up]: [f32; 2]| [x + across * scale, y - up * scale];
        let mut path = PathBuilder::new();
        for segment in Font::embedded().outline(id) {
            add_segment(&mut path, segment, to_page);
        }
        path.finish()
            .and_then(|path| CoverageMask::of(&path, &PixelRect::around(&path)))
            .unwrap_or_else(CoverageMask::empty)
    }

    fn of(path: &Path, rect: &PixelRect) -> Option<CoverageMask> {
        let [left, top] = rect.from;
        let [width, height] = [0, 1].map(|axis| (rect.to[axis] - rect.from[axis]) as u32);
        let mut mask = Mask::new(width, height)?;
        let path = path.clone().transform(Transform::from_translate(-left, -top))?;
        mask.fill_path(&path, FillRule::Winding, true, Transform::identity());
        let mut coverage = mask.take();
        coverage.iter_mut().for_each(|alpha| *alpha = quantize_coverage(f64::from(*alpha) / 255.0));
        Some(CoverageMask { left: left as i64, top: top as i64, width: width as usize, coverage })
    }
}

fn closed_path(points: &[Vector], offset: Vector) -> Option<Path> {
    let mut path = PathBuilder::new();
    for (index, point) in points.iter().enumerate() {
        let (x, y) = ((point.x - offset.x) as f32, (point.y - offset.y) as f32);
        if index == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
    }
    path.close();
    path.finish()
}

fn add_segment(path: &mut PathBuilder, segment: PathSegment, to_page: impl Fn([f32; 2]) -> [f32; 2]) {
    match segment {
        PathSegment::Move(to) => {
            let [x, y] = to_page(to);
            path.move_to(x, y);
        }
        PathSegment::Line(to) => {
            let [x, y] = to_page(to);
            path.line_to(x, y);
        }
        PathSegment::Quadratic(points) => {
            let [[cx, cy], [x, y]] = points.map(to_page);
            path.quad_to(cx, cy, x, y);
        }
        PathSegment::Close => path.close(),
    }
}

/// A rectangle of whole pixels: `from` inclusive, `to` exclusive, along x and y.
struct PixelRect {
    from: [f32; 2],
    to: [f32; 2],
}

impl PixelRect {
    fn around(path: &Path) -> PixelRect {
        let bounds = path.bounds();
        PixelRect {
            from: [bounds.left().floor(), bounds.top().floor()],
            to: [bounds.right().floor() + 1.0, bounds.bottom().floor() + 1.0],
        }
    }

    /// A clip rectangle relative to a point of the page.
    fn of(clip: &ClipRect, point: Vector) -> PixelRect {
        let from = |at: usize, origin: f64| (at as f64 - origin) as f32;
        PixelRect {
            from: [from(clip.left, point.x), from(clip.top, point.y)],
            to: [from(clip.right, point.x), from(clip.bottom, point.y)],
        }
    }

    fn intersect(&self, other: &PixelRect) -> Option<PixelRect> {
        let larger = |a: f32, b: f32| if a > b { a } else { b };
        let smaller = |a: f32, b: f32| if a < b { a } else { b };
        let from = [0, 1].map(|axis| larger(self.from[axis], other.from[axis]));
        let to = [0, 1].map(|axis| smaller(self.to[axis], other.to[axis]));
        (from[0] < to[0] && from[1] < to[1]).then_some(PixelRect { from, to })
    }
}
