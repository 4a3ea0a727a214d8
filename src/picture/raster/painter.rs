use crate::physics::Vector;
use crate::picture::raster::canvas::Canvas;
use crate::picture::raster::coverage_mask::CoverageMask;
use crate::picture::text::{Glyph, Line};
use crate::picture::{Color, DisplayList, Ink, Picture, Shape};
use std::collections::BTreeMap;

/// Rasterises display lists, with a cache of glyphs and of the last backdrop.
///
/// The caches do not affect the pixels: a new painter draws the same.
#[derive(Default)]
pub struct Painter {
    backdrop: Option<Backdrop>,
    glyphs: BTreeMap<GlyphKey, CoverageMask>,
}

struct Backdrop {
    size: [u32; 2],
    background: Color,
    shapes: Vec<Shape>,
    pixels: Vec<[u8; 4]>,
}

/// Glyph number, size, and subpixel position along x and y; all but the first in quarter pixels.
type GlyphKey = (u16, u32, u8, u8);

/// Maximum number of cached glyphs, which bounds the memory for an animation whose text never repeats.
const MAX_CACHED_GLYPHS: usize = 4096;

impl Painter {
    /// A painter with empty caches.
    pub fn new() -> Painter {
        Painter::default()
    }

    /// Rasterises a display list.
    pub fn draw(&mut self, list: &DisplayList) -> Picture {
        let mut canvas = self.backdrop(list);
        for shape in &list.shapes {
            self.draw_shape(&mut canvas, shape);
        }
        canvas.into_picture()
    }

    fn backdrop(&mut self, list: &DisplayList) -> Canvas {
        let [width, height] = list.size.map(|side| side as usize);
        if let Some(cached) = &self.backdrop
            && (cached.size, cached.background) == (list.size, list.background)
            && cached.shapes == list.backdrop
        {
            return Canvas::from_pixels([width, height], cached.pixels.clone());
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
            Shape::Polygon { points, ink } => canvas.fill_mask(CoverageMask::polygon(points, &canvas.clip), *ink),
            Shape::Polyline { points, width, ink } => {
                canvas.fill_mask(CoverageMask::line(points, *width, &canvas.clip), *ink);
            }
            Shape::Clip { window, shapes } => {
                let previous = canvas.intersect_clip(window);
                shapes.iter().for_each(|shape| self.draw_shape(canvas, shape));
                canvas.clip = previous;
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
        if self.glyphs.len() >= MAX_CACHED_GLYPHS {
            self.glyphs.clear();
        }
        let mask = self.glyphs.entry(key).or_insert_with(|| CoverageMask::glyph(glyph.id, key.1, [key.2, key.3]));
        let (left, top) = (x.div_euclid(4) + mask.left, y.div_euclid(4) + mask.top);
        canvas.fill_coverage(&mask.coverage, mask.width, left, top, ink);
    }
}
