//! Palettes of pictures. The arithmetic is on integers; quantisers that cluster colours in floating point give other
//! palettes on other processors. NeuQuant, the quantiser of the gif crate, is made for photographs: of a drawing of
//! 960×540 pixels with 1668 colours it takes 45 times as long, and colours differ by up to 44/255 instead of 28/255.
//! `quantize` and `neuquant` of `cargo bench --bench kernels` measure both with regular boxes: 0.65 and 64 ms.

use foldhash::fast::FixedState;
use indexmap::IndexSet;
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

/// Colours with their indices in the order of insertion, on which hashes have no influence.
type ColorTable = IndexSet<[u8; 4], FixedState>;

/// The number of palette entries for the most frequent colours. The other entries are chosen for their
/// distance to the palette.
const FREQUENT_COLORS: usize = 192;

impl IndexedImage {
    /// Converts pixels without loss; `None` if they have more than 256 colours.
    pub fn exact(pixels: &[[u8; 4]]) -> Option<IndexedImage> {
        let mut table = ColorTable::default();
        let mut indices = Vec::with_capacity(pixels.len());
        for run in pixels.chunk_by(|a, b| a == b) {
            let index = table.insert_full(run[0]).0;
            if index == MAX_COLORS {
                return None;
            }
            indices.resize(indices.len() + run.len(), index as u8);
        }
        Some(IndexedImage { palette: table.into_iter().collect(), pixels: indices })
    }

    /// Converts pixels to 256 of their colours, choosing the nearest one for each pixel.
    ///
    /// A drawing has few fill colours and many antialiased edge colours between them. The palette holds
    /// the most frequent colours, then repeatedly the colour farthest from the palette, which leaves no
    /// visible error. Transparent pixels stay transparent.
    pub fn quantized(pixels: &[[u8; 4]]) -> IndexedImage {
        let mut table = ColorTable::default();
        let mut counts = Vec::new();
        let mut runs = Vec::new();
        for run in pixels.chunk_by(|a, b| a == b) {
            let color = table.insert_full(run[0]).0;
            counts.resize(table.len(), 0_usize);
            counts[color] += run.len();
            runs.push((color, run.len()));
        }
        let colors: Vec<[u8; 4]> = table.into_iter().collect();
        let chosen = PaletteBuilder::build(&colors, &counts);
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
}
