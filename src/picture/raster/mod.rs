//! Rasterises shapes to pixels. Colours are blended with integer arithmetic, so that pixels are the same on every
//! machine.
//!
//! The coverage of a pixel is a number of sixteenths: the edges of rectangles are rounded to quarter pixels, and the
//! coverage masks of polygons, lines and glyphs to eighths. Finer steps are invisible, and each would add a colour for
//! every pair of adjacent colours. With so few levels a frame usually has at most 256 colours, so that PNG and GIF are
//! stored with a palette, which keeps them small and exact. For the same reason the camera rounds positions to quarter
//! pixels. A frame of more colours is written as RGB in PNG and reduced to 256 colours in GIF.

pub(crate) mod bitmap;
pub(crate) mod canvas;
pub(crate) mod color;
pub(crate) mod coverage_mask;
mod display_list;
mod simplified;
mod stroke;

pub use bitmap::Bitmap;
pub use color::{Color, Palette, color_by_speed};
pub(crate) use display_list::distinct_bitmaps;
pub use display_list::{DisplayList, Ink, Shape};
pub(crate) use simplified::simplified;

use crate::physics::{Rect, Vector};
use crate::picture::text::{Glyph, Line};
use bitmap::{QuarterRect, ScaledBitmap};
use canvas::Canvas;
use coverage_mask::CoverageMask;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A raster image: the output of the painter, the input of the encoders.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Width and height, px.
    pub size: [u32; 2],
    /// Rows from the top, as red, green, blue and alpha; alpha is always 255.
    pub pixels: Vec<[u8; 4]>,
}

impl Picture {
    /// The rows of pixels, from the top.
    pub fn rows(&self) -> std::slice::ChunksExact<'_, [u8; 4]> {
        self.pixels.chunks_exact(self.size[0] as usize)
    }
}

/// Columns `left..right` and rows `top..bottom`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ClipRect {
    left: usize,
    top: usize,
    right: usize,
    bottom: usize,
}

/// The largest magnitude of page coordinates, px: quarter pixels are exact up to there, and everything beyond is outside
/// any page.
pub(crate) const MAX_COORDINATE: f64 = 1e9;

/// The coverage of a fully covered pixel.
pub(crate) const FULL_COVERAGE: u8 = 16;

/// Coverage from 0 to 1 in sixteenths, rounded to eighths.
pub(crate) fn quantize_coverage(coverage: f64) -> u8 {
    const STEPS: u8 = FULL_COVERAGE / 2;
    (coverage * f64::from(STEPS)).round() as u8 * 2
}

/// Rasterises display lists, with a cache of glyphs and of the last backdrop.
///
/// The caches do not affect the pixels: a new painter draws the same.
#[derive(Default)]
pub struct Painter {
    backdrop: Option<Backdrop>,
    glyphs: BTreeMap<GlyphKey, CoverageMask>,
    /// Bitmaps at the sizes in which they were drawn, and the number of their pixels.
    bitmaps: BTreeMap<(usize, QuarterRect), (Arc<Bitmap>, ScaledBitmap)>,
    bitmap_pixels: usize,
}

struct Backdrop {
    size: [u32; 2],
    background: Color,
    shapes: Vec<Shape>,
    pixels: Vec<[u8; 4]>,
}

/// Glyph number, size, and subpixel position along x and y; all but the first in quarter pixels.
type GlyphKey = (u16, u32, u8, u8);

/// Maximum number of pixels of a cached bitmap, and of all of them.
const MAX_BITMAP_PIXELS: [usize; 2] = [1 << 18, 1 << 22];

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
            Shape::Image { bitmap, rect, opacity } => self.draw_bitmap(canvas, bitmap, rect, *opacity),
        }
    }

    fn draw_line(&mut self, canvas: &mut Canvas, line: &Line, at: Vector, ink: Ink) {
        for glyph in &line.glyphs {
            self.draw_glyph(canvas, glyph, at.add(Vector::new(glyph.x, glyph.y)), ink);
        }
    }

    fn draw_bitmap(&mut self, canvas: &mut Canvas, bitmap: &Arc<Bitmap>, rect: &Rect, opacity: u8) {
        let Some((quarters, corner)) = QuarterRect::of(rect) else { return };
        let [width, height] = quarters.pixels();
        let [of_one, of_all] = MAX_BITMAP_PIXELS;
        if width.saturating_mul(height) > of_one {
            return canvas.draw_bitmap(bitmap, rect, opacity);
        }
        if self.bitmap_pixels > of_all {
            self.bitmaps.clear();
            self.bitmap_pixels = 0;
        }
        // The cache keeps the bitmap alive, so no other one has its address.
        let key = (Arc::as_ptr(bitmap) as usize, quarters);
        let (_, scaled) = self.bitmaps.entry(key).or_insert_with(|| {
            self.bitmap_pixels += width * height;
            (bitmap.clone(), bitmap.scaled(&quarters, 0..width, 0..height))
        });
        scaled.draw(canvas, corner, opacity);
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
