use super::canvas::{Canvas, FULL};
use super::text::{Font, Glyph, Line, Segment, UNITS_PER_EM};
use super::{Color, DisplayList, Ink, Picture, Shape};
use crate::physics::Vector;
use std::collections::BTreeMap;
use tiny_skia::{FillRule, LineJoin, Mask, Path, PathBuilder, Stroke, Transform};

/// Draws display lists, remembering what the next one is likely to need again.
///
/// What it remembers never shows: a fresh painter draws the same pixels.
#[derive(Default)]
pub struct Painter {
    backdrop: Option<Backdrop>,
    glyphs: BTreeMap<GlyphKey, Stencil>,
}

struct Backdrop {
    size: [u32; 2],
    background: Color,
    shapes: Vec<Shape>,
    pixels: Vec<[u8; 4]>,
}

/// A glyph, its size and where between pixels it stands, in quarters of a pixel.
type GlyphKey = (u16, u32, u8, u8);

/// Which part of each pixel a shape covers, in sixteenths, around the pixel it is placed at.
struct Stencil {
    left: i64,
    top: i64,
    width: usize,
    coverage: Vec<u8>,
}

/// Glyphs remembered at most: a clip whose text never repeats must not fill the memory.
const GLYPHS_KEPT: usize = 4096;

impl Painter {
    /// A painter that remembers nothing yet.
    pub fn new() -> Painter {
        Painter::default()
    }

    /// The pixels of a display list.
    pub fn draw(&mut self, list: &DisplayList) -> Picture {
        let mut canvas = self.backdrop(list);
        for shape in &list.shapes {
            self.draw_shape(&mut canvas, shape);
        }
        canvas.into_picture()
    }

    fn backdrop(&mut self, list: &DisplayList) -> Canvas {
        let [width, height] = list.size.map(|side| side as usize);
        if let Some(known) = &self.backdrop
            && (known.size, known.background) == (list.size, list.background)
            && known.shapes == list.backdrop
        {
            return Canvas::from_pixels([width, height], known.pixels.clone());
        }
        let mut canvas = Canvas::new([width, height], list.background);
        for shape in &list.backdrop {
            self.draw_shape(&mut canvas, shape);
        }
        self.backdrop = Some(Backdrop {
            size: list.size,
            background: list.background,
            shapes: list.backdrop.clone(),
            pixels: canvas.pixels.clone(),
        });
        canvas
    }

    fn draw_shape(&mut self, canvas: &mut Canvas, shape: &Shape) {
        match shape {
            Shape::Rect { rect, ink } => canvas.fill_rect(rect, *ink),
            Shape::Polygon { points, ink } => fill_path(canvas, points, *ink, |points| polygon(points, true)),
            Shape::Polyline { points, width, ink } => {
                fill_path(canvas, points, *ink, |points| stroke(points, *width));
            }
            Shape::Clip { window, shapes } => {
                let outside = canvas.narrow(window);
                shapes.iter().for_each(|shape| self.draw_shape(canvas, shape));
                canvas.clip = outside;
            }
            Shape::Text { line, at, ink } => self.draw_line(canvas, line, *at, *ink),
        }
    }

    fn draw_line(&mut self, canvas: &mut Canvas, line: &Line, at: Vector, ink: Ink) {
        for glyph in &line.glyphs {
            self.draw_glyph(canvas, glyph, at.add(Vector::new(glyph.x, glyph.y)), ink);
        }
    }

    fn draw_glyph(&mut self, canvas: &mut Canvas, glyph: &Glyph, at: Vector, ink: Ink) {
        let [x, y] = [at.x, at.y].map(|along| (along * 4.0).round() as i64);
        let key = (glyph.id, (glyph.size * 4.0).round() as u32, x.rem_euclid(4) as u8, y.rem_euclid(4) as u8);
        if self.glyphs.len() >= GLYPHS_KEPT {
            self.glyphs.clear();
        }
        let stencil = self.glyphs.entry(key).or_insert_with(|| glyph_stencil(key));
        canvas.fill_mask(
            &stencil.coverage,
            stencil.width,
            x.div_euclid(4) + stencil.left,
            y.div_euclid(4) + stencil.top,
            ink,
        );
    }
}

fn glyph_stencil((id, size, x, y): GlyphKey) -> Stencil {
    let [size, x, y] = [size, u32::from(x), u32::from(y)].map(|quarters| quarters as f32 / 4.0);
    let scale = size / UNITS_PER_EM as f32;
    let place = |[across, up]: [f32; 2]| [x + across * scale, y - up * scale];
    let mut path = PathBuilder::new();
    for segment in Font::embedded().outline(id) {
        add_segment(&mut path, segment, place);
    }
    path.finish().and_then(|path| Stencil::of(&path, &Window::around(&path))).unwrap_or_else(Stencil::empty)
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

/// Fills what `outline` makes of the points; it sees them moved near the origin, where f32
/// is exact enough.
fn fill_path(canvas: &mut Canvas, points: &[Vector], ink: Ink, outline: impl Fn(&[Vector]) -> Option<Path>) {
    let Some(first) = points.first() else { return };
    let corner = Vector::new(first.x.floor(), first.y.floor());
    let moved: Vec<Vector> = points.iter().map(|point| point.sub(corner)).collect();
    let Some(path) = outline(&moved) else { return };
    let page = Window::page(canvas, corner);
    let Some(stencil) = Window::around(&path).meet(&page).and_then(|window| Stencil::of(&path, &window)) else {
        return;
    };
    let (x, y) = (corner.x as i64 + stencil.left, corner.y as i64 + stencil.top);
    canvas.fill_mask(&stencil.coverage, stencil.width, x, y, ink);
}

fn polygon(points: &[Vector], closed: bool) -> Option<Path> {
    let mut path = PathBuilder::new();
    for (place, point) in points.iter().enumerate() {
        let (x, y) = (point.x as f32, point.y as f32);
        if place == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
    }
    if closed {
        path.close();
    }
    path.finish()
}

fn stroke(points: &[Vector], width: f64) -> Option<Path> {
    let stroke = Stroke { width: width as f32, line_join: LineJoin::Bevel, ..Stroke::default() };
    polygon(points, false)?.stroke(&stroke, 1.0)
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

    /// What of the page can be drawn on, as seen from a point of it.
    fn page(canvas: &Canvas, point: Vector) -> Window {
        let from = |at: usize, origin: f64| (at as f64 - origin) as f32;
        let clip = &canvas.clip;
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

impl Stencil {
    fn empty() -> Stencil {
        Stencil { left: 0, top: 0, width: 1, coverage: Vec::new() }
    }

    fn of(path: &Path, window: &Window) -> Option<Stencil> {
        let [left, top] = window.from;
        let [width, height] = [0, 1].map(|axis| (window.to[axis] - window.from[axis]) as u32);
        let mut mask = Mask::new(width, height)?;
        let path = path.clone().transform(Transform::from_translate(-left, -top))?;
        mask.fill_path(&path, FillRule::Winding, true, Transform::identity());
        let mut coverage = mask.take();
        coverage.iter_mut().for_each(|part| *part = sixteenths(*part));
        Some(Stencil { left: left as i64, top: top as i64, width: width as usize, coverage })
    }
}

/// Coverage of 0 to 255 in sixteenths, to the nearest eighth: finer steps are not seen, and
/// each would cost a colour for every pair of colours that meet.
const fn sixteenths(coverage: u8) -> u8 {
    ((coverage as u16 + 16) / (2 * FULL as u16) * 2) as u8
}
