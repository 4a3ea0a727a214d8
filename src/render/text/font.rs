use skrifa::instance::{LocationRef, Size};
use skrifa::metrics::GlyphMetrics;
use skrifa::outline::{DrawSettings, OutlineGlyphCollection, OutlinePen};
use skrifa::raw::tables::gpos::{PairPos, PositionSubtables};
use skrifa::raw::{FontRef, TableProvider};
use skrifa::{GlyphId, MetadataProvider, charmap::Charmap};
use std::sync::LazyLock;
use tiny_skia::PathBuilder;

/// Units of the font per em.
pub const UNITS_PER_EM: f64 = 1000.0;

const FILE: &[u8] = include_bytes!("../fonts/STIXTwoMath-subset.ttf");

static FONT: LazyLock<Font> = LazyLock::new(|| {
    let file = FontRef::new(FILE).expect("the embedded font is a font");
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
    /// The one there is.
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

    /// The glyph of a character; glyph 0, a box, for one the font lacks.
    pub fn glyph(&self, character: char) -> u16 {
        self.characters.map(character).map_or(0, |glyph| glyph.to_u32() as u16)
    }

    /// How far the next glyph stands from this one.
    pub fn advance(&self, glyph: u16) -> f64 {
        f64::from(self.metrics.advance_width(GlyphId::from(glyph)).unwrap_or(0.0))
    }

    /// What the distance between two neighbours is changed by.
    ///
    /// OpenType lets the first pair table that knows the pair decide.
    pub fn kerning(&self, left: u16, right: u16) -> f64 {
        self.kerning.iter().find_map(|table| pair_advance(table, left, right)).map_or(0.0, f64::from)
    }

    /// Adds the outline of a glyph, `size` pixels to the em, with its origin at (x, y).
    pub fn outline(&self, glyph: u16, size: f32, x: f32, y: f32, path: &mut PathBuilder) {
        let Some(outline) = self.outlines.get(GlyphId::from(glyph)) else { return };
        let settings = DrawSettings::unhinted(Size::unscaled(), LocationRef::default());
        let mut pen = Pen { path, scale: size / UNITS_PER_EM as f32, x, y };
        outline.draw(settings, &mut pen).expect("the embedded font's outlines are sound");
    }
}

/// The font's pair tables, in the order in which they are asked.
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

/// Scales an outline, turns it over (fonts have y up, pages down) and moves it.
struct Pen<'a> {
    path: &'a mut PathBuilder,
    scale: f32,
    x: f32,
    y: f32,
}

impl Pen<'_> {
    fn place(&self, x: f32, y: f32) -> (f32, f32) {
        (self.x + x * self.scale, self.y - y * self.scale)
    }
}

impl OutlinePen for Pen<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.place(x, y);
        self.path.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.place(x, y);
        self.path.line_to(x, y);
    }

    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        let ((cx, cy), (x, y)) = (self.place(cx, cy), self.place(x, y));
        self.path.quad_to(cx, cy, x, y);
    }

    fn curve_to(&mut self, ax: f32, ay: f32, bx: f32, by: f32, x: f32, y: f32) {
        let ((ax, ay), (bx, by), (x, y)) = (self.place(ax, ay), self.place(bx, by), self.place(x, y));
        self.path.cubic_to(ax, ay, bx, by, x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}
