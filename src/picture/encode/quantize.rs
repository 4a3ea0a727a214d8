//! Palettes of pictures. The arithmetic is on integers; quantisers that cluster colours in floating point give other
//! palettes on other processors. The row `by speed` of `cargo bench --bench drawing` has many colours.

use std::cmp::Reverse;

/// A picture as a palette of at most 256 colours and an index into it for each pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IndexedImage {
    /// The colours.
    pub palette: Vec<[u8; 4]>,
    /// The index into the palette of each pixel.
    pub pixels: Vec<u8>,
}

const MAX_COLORS: usize = 256;

/// The number of palette entries for the most frequent colours. The other entries are chosen for their
/// distance to the palette.
const FREQUENT_COLORS: usize = 192;

impl IndexedImage {
    /// Converts pixels without loss; `None` if they have more than 256 colours.
    pub fn exact(pixels: &[[u8; 4]]) -> Option<IndexedImage> {
        let mut table = ColorTable::new();
        let mut indices = Vec::with_capacity(pixels.len());
        for run in pixels.chunk_by(|a, b| a == b) {
            let index = table.index_of(run[0]);
            if index == MAX_COLORS {
                return None;
            }
            indices.resize(indices.len() + run.len(), index as u8);
        }
        Some(IndexedImage { palette: table.colors, pixels: indices })
    }

    /// Converts pixels to 256 of their colours, choosing the nearest one for each pixel.
    ///
    /// A drawing has few fill colours and many antialiased edge colours between them. The palette holds
    /// the most frequent colours, then repeatedly the colour farthest from the palette, which leaves no
    /// visible error. Transparent pixels stay transparent.
    pub fn quantized(pixels: &[[u8; 4]]) -> IndexedImage {
        let mut table = ColorTable::new();
        let mut counts = Vec::new();
        let mut runs = Vec::new();
        for run in pixels.chunk_by(|a, b| a == b) {
            let color = table.index_of(run[0]);
            counts.resize(table.colors.len(), 0_usize);
            counts[color] += run.len();
            runs.push((color, run.len()));
        }
        let chosen = PaletteBuilder::build(&table.colors, &counts);
        let mut indices = Vec::with_capacity(pixels.len());
        for (color, length) in runs {
            indices.resize(indices.len() + length, chosen.nearest[color]);
        }
        IndexedImage { palette: chosen.palette, pixels: indices }
    }
}

/// Chooses a palette from colours and tracks the nearest entry of each colour.
struct PaletteBuilder {
    /// Red, green and blue of the colours in separate arrays, so that distances are computed with SIMD.
    components: [Vec<i32>; 3],
    palette: Vec<[u8; 4]>,
    /// The distance of each colour to the nearest palette entry, and the index of that entry.
    distances: Vec<i32>,
    nearest: Vec<u8>,
}

impl PaletteBuilder {
    /// Chooses a palette for `colors`, which occur `counts` times.
    fn build(colors: &[[u8; 4]], counts: &[usize]) -> PaletteBuilder {
        let components = [0, 1, 2].map(|at| colors.iter().map(|color| i32::from(color[at])).collect());
        let distances = vec![i32::MAX; colors.len()];
        let mut builder = PaletteBuilder { components, palette: Vec::new(), distances, nearest: vec![0; colors.len()] };
        let mut ranking: Vec<usize> = (0..colors.len()).collect();
        ranking.sort_by_key(|&color| (colors[color][3], Reverse(counts[color])));
        ranking.iter().take(FREQUENT_COLORS).for_each(|&color| builder.add(color, colors[color]));
        while builder.palette.len() < MAX_COLORS
            && let Some(color) = builder.farthest()
        {
            builder.add(color, colors[color]);
        }
        builder
    }

    /// Adds the colour with this index to the palette. A transparent colour is the nearest only to itself.
    fn add(&mut self, index: usize, color: [u8; 4]) {
        let entry = self.palette.len() as u8;
        self.palette.push(color);
        if color[3] == 255 {
            self.update_nearest(color.map(i32::from), entry);
        }
        self.distances[index] = 0;
        self.nearest[index] = entry;
    }

    /// Assigns `entry` to every colour that is nearer to it than to any earlier entry.
    fn update_nearest(&mut self, [r, g, b, _]: [i32; 4], entry: u8) {
        let [reds, greens, blues] = &self.components;
        let colors = reds.iter().zip(greens).zip(blues);
        let current = self.distances.iter_mut().zip(&mut self.nearest);
        for (((&red, &green), &blue), (min_distance, nearest)) in colors.zip(current) {
            let distance = weighted_distance(red - r, green - g, blue - b);
            let is_nearer = distance < *min_distance;
            *nearest = if is_nearer { entry } else { *nearest };
            *min_distance = if is_nearer { distance } else { *min_distance };
        }
    }

    /// The index of the colour farthest from the palette, the first of equals; `None` if the palette contains
    /// all colours.
    fn farthest(&self) -> Option<usize> {
        let max = *self.distances.iter().max()?;
        self.distances.iter().position(|&distance| distance == max && max > 0)
    }
}

/// The square of the distance of two colours, weighted by the contribution of each component to luminance.
const fn weighted_distance(red: i32, green: i32, blue: i32) -> i32 {
    3 * red * red + 6 * green * green + blue * blue
}

/// A set of colours with their indices in insertion order: a hash table with a fixed multiplicative hash,
/// so that results are deterministic.
pub struct ColorTable {
    pub colors: Vec<[u8; 4]>,
    /// Slots of the hash table: the index of a colour plus 1, or 0 if free. At least twice as many as
    /// colours.
    slots: Vec<u32>,
}

impl ColorTable {
    pub fn new() -> ColorTable {
        ColorTable { colors: Vec::with_capacity(256), slots: vec![0; 1024] }
    }

    /// Returns the index of a colour, which is inserted if it is new.
    pub fn index_of(&mut self, color: [u8; 4]) -> usize {
        let slot = self.slot(color);
        if self.slots[slot] != 0 {
            return self.slots[slot] as usize - 1;
        }
        self.colors.push(color);
        self.slots[slot] = self.colors.len() as u32;
        if 2 * self.colors.len() > self.slots.len() {
            self.grow();
        }
        self.colors.len() - 1
    }

    /// The slot of a colour, or the free slot where it belongs.
    fn slot(&self, color: [u8; 4]) -> usize {
        let last = self.slots.len() - 1;
        let hash = u32::from_le_bytes(color).wrapping_mul(0x9e37_79b1);
        let mut slot = (hash >> 8) as usize & last;
        while self.slots[slot] != 0 && self.colors[self.slots[slot] as usize - 1] != color {
            slot = (slot + 1) & last;
        }
        slot
    }

    fn grow(&mut self) {
        self.slots = vec![0; 2 * self.slots.len()];
        for index in 0..self.colors.len() {
            let slot = self.slot(self.colors[index]);
            self.slots[slot] = index as u32 + 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn distinct_colors(colors: u32) -> Vec<[u8; 4]> {
        (0..colors).flat_map(|at| [[at as u8, (at >> 8) as u8, 0, 255]; 3]).collect()
    }

    fn decoded(indexed: &IndexedImage) -> Vec<[u8; 4]> {
        indexed.pixels.iter().map(|&index| indexed.palette[usize::from(index)]).collect()
    }

    #[test]
    fn up_to_256_colors_are_exact() {
        for colors in [1, 255, 256] {
            assert_eq!(decoded(&IndexedImage::exact(&distinct_colors(colors)).unwrap()), distinct_colors(colors));
        }
        assert_eq!(IndexedImage::exact(&distinct_colors(257)), None);
    }

    #[test]
    fn quantization_of_256_colors_is_exact() {
        assert_eq!(decoded(&IndexedImage::quantized(&distinct_colors(256))), distinct_colors(256));
    }

    #[test]
    fn quantization_keeps_transparent_pixels_and_rare_distant_colours() {
        let mut pixels = distinct_colors(2000);
        pixels.push([0; 4]);
        pixels.push([9, 9, 255, 255]);
        let decoded = decoded(&IndexedImage::quantized(&pixels));
        assert_eq!(decoded[6000..], [[0; 4], [9, 9, 255, 255]]);
        assert!(decoded[..6000].iter().all(|color| color[3] == 255));
    }

    #[test]
    fn a_growing_color_table_keeps_all_indices() {
        let mut table = ColorTable::new();
        for round in 0..2 {
            for number in 0..5000_u32 {
                let color = (number * 7919).to_le_bytes();
                assert_eq!(table.index_of(color), number as usize, "round {round}");
            }
        }
    }
}
