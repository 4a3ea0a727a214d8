use super::canvas::Canvas;
use super::stencil::Stencil;
use super::text::{Glyph, Line};
use super::{Color, DisplayList, Ink, Picture, Shape};
use crate::physics::Vector;
use std::collections::BTreeMap;

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
            Shape::Polygon { points, ink } => canvas.fill_stencil(Stencil::polygon(points, &canvas.clip), *ink),
            Shape::Polyline { points, width, ink } => {
                canvas.fill_stencil(Stencil::line(points, *width, &canvas.clip), *ink);
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
        let stencil = self.glyphs.entry(key).or_insert_with(|| Stencil::glyph(glyph.id, key.1, [key.2, key.3]));
        let (left, top) = (x.div_euclid(4) + stencil.left, y.div_euclid(4) + stencil.top);
        canvas.fill_mask(&stencil.coverage, stencil.width, left, top, ink);
    }
}
