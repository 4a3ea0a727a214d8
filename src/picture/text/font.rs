use skrifa::instance::{LocationRef, Size};
use skrifa::metrics::GlyphMetrics;
use skrifa::outline::{DrawSettings, OutlineGlyphCollection, OutlinePen};
use skrifa::raw::tables::gpos::{PairPos, PositionSubtables};
use skrifa::raw::{FontRef, TableProvider};
use skrifa::{GlyphId, MetadataProvider, charmap::Charmap};
use std::sync::LazyLock;

/// Units of the font per em.
pub const UNITS_PER_EM: f64 = 1000.0;

static FONT: LazyLock<Font> = LazyLock::new(|| {
    let file = FontRef::new(Font::FILE).expect("the embedded font is valid");
    Font::new(file)
});

/// The embedded font, STIX Two Math; lengths are thousandths of an em.
pub struct Font {
    characters: Charmap<'static>,
    metrics: GlyphMetrics<'static>,
    outlines: OutlineGlyphCollection<'static>,
    kerning: Vec<PairPos<'static>>,
}

impl Font {
    /// The TrueType file of the embedded font.
    pub const FILE: &[u8] = include_bytes!("fonts/STIXTwoMath-subset.ttf");

    /// The embedded font.
    pub fn embedded() -> &'static Font {
        &FONT
    }

    fn new(file: FontRef<'static>) -> Font {
        Font {
            characters: file.charmap(),
            metrics: file.glyph_metrics(Size::unscaled(), LocationRef::default()),
            outlines: file.outline_glyphs(),
            kerning: pair_tables(&file),
        }
    }

    /// The glyph of a character; glyph 0, drawn as a box, if the font lacks it.
    pub fn glyph(&self, character: char) -> u16 {
        self.characters.map(character).map_or(0, |glyph| glyph.to_u32() as u16)
    }

    /// The advance width of a glyph.
    pub fn advance(&self, glyph: u16) -> f64 {
        f64::from(self.metrics.advance_width(GlyphId::from(glyph)).unwrap_or(0.0))
    }

    /// The bounding box of a glyph.
    pub fn bounds(&self, glyph: u16) -> Bounds {
        let bounds = self.metrics.bounds(GlyphId::from(glyph)).unwrap_or_default();
        let [left, right, top] = [bounds.x_min, bounds.x_max, bounds.y_max].map(f64::from);
        Bounds { left, right, top }
    }

    /// The kerning of two adjacent glyphs, added to the advance width of the first.
    ///
    /// As OpenType specifies, the first pair table that contains the pair applies.
    pub fn kerning(&self, left: u16, right: u16) -> f64 {
        self.kerning.iter().find_map(|table| pair_advance(table, left, right)).map_or(0.0, f64::from)
    }

    /// The outline of a glyph relative to its origin, y **up**.
    pub fn outline(&self, glyph: u16) -> Vec<PathSegment> {
        let Some(outline) = self.outlines.get(GlyphId::from(glyph)) else { return Vec::new() };
        let settings = DrawSettings::unhinted(Size::unscaled(), LocationRef::default());
        let mut pen = Pen(Vec::new());
        outline.draw(settings, &mut pen).expect("the embedded font's outlines are valid");
        pen.0
    }
}

/// The bounds of a glyph relative to its origin, y **up**.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Left border.
    pub left: f64,
    /// Right border.
    pub right: f64,
    /// Upper border.
    pub top: f64,
}

/// A segment of an outline. Each segment begins at the end of the one before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PathSegment {
    /// Begins a contour at this point.
    Move([f32; 2]),
    /// A straight line to this point.
    Line([f32; 2]),
    /// A quadratic Bézier curve: control point and end.
    Quadratic([[f32; 2]; 2]),
    /// Closes the contour.
    Close,
}

/// The pair tables of the font's `GPOS` table, in lookup order.
fn pair_tables(file: &FontRef<'static>) -> Vec<PairPos<'static>> {
    let Ok(lookups) = file.gpos().and_then(|table| table.lookup_list()) else { return Vec::new() };
    let subtables = lookups.lookups().iter().flatten().filter_map(|lookup| lookup.subtables().ok());
    subtables.flat_map(pairs).collect()
}

fn pairs(subtables: PositionSubtables<'static>) -> Vec<PairPos<'static>> {
    match subtables {
        PositionSubtables::Pair(pairs) => pairs.iter().flatten().collect(),
        _ => Vec::new(),
    }
}

fn pair_advance(table: &PairPos, left: u16, right: u16) -> Option<i16> {
    let (left, right) = (skrifa::raw::types::GlyphId16::new(left), skrifa::raw::types::GlyphId16::new(right));
    match table {
        PairPos::Format1(table) => {
            let set = table.pair_sets().get(table.coverage().ok()?.get(left)? as usize).ok()?;
            set.find_pair_value_record(right)?.value_record1().x_advance()
        }
        PairPos::Format2(table) => {
            table.coverage().ok()?.get(left)?;
            let (first, second) = (table.class_def1().ok()?.get(left), table.class_def2().ok()?.get(right));
            table.value_record_refs(first as u16, second as u16)?[0].x_advance()
        }
        _ => None,
    }
}

struct Pen(Vec<PathSegment>);

impl OutlinePen for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.0.push(PathSegment::Move([x, y]));
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.0.push(PathSegment::Line([x, y]));
    }

    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        self.0.push(PathSegment::Quadratic([[cx, cy], [x, y]]));
    }

    fn curve_to(&mut self, _: f32, _: f32, _: f32, _: f32, _: f32, _: f32) {
        unreachable!("the embedded font is a TrueType font, which has quadratic curves only");
    }

    fn close(&mut self) {
        self.0.push(PathSegment::Close);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_font_has_all_characters_of_labels() {
        let needed = "azAZ09äÿŁαωΑΩ𝑎𝑧𝐴𝑍ℎ𝛼𝜔′⃗̂·×−±≤≥→⊖Δ²₁⊥∞√";
        for character in needed.chars() {
            assert_ne!(Font::embedded().glyph(character), 0, "{character:?}");
        }
    }

    #[test]
    fn a_character_that_the_font_lacks_is_drawn_as_a_box() {
        assert_eq!(Font::embedded().glyph('字'), 0);
        assert!(!Font::embedded().outline(0).is_empty());
    }

    /// Advances with kerning as computed by HarfBuzz for this font.
    #[test]
    fn kerning_equals_that_of_a_shaper() {
        let advances = |text: &str| {
            let font = Font::embedded();
            let glyphs: Vec<u16> = text.chars().map(|character| font.glyph(character)).collect();
            let pairs = glyphs.windows(2).map(|pair| font.advance(pair[0]) + font.kerning(pair[0], pair[1]));
            pairs.collect::<Vec<f64>>()
        };
        assert_eq!(advances("AVATo"), [618.0, 575.0, 658.0, 533.0]);
        assert_eq!(advances("Wall-left"), [884.0, 480.0, 283.0, 283.0, 315.0, 283.0, 464.0, 307.0]);
    }
}
