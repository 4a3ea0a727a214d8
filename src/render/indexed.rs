use super::color_table::ColorTable;
use std::cmp::Reverse;

/// Pixels as places in a palette of at most 256 colours.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Indexed {
    /// The colours.
    pub palette: Vec<[u8; 4]>,
    /// The place in the palette of each pixel.
    pub pixels: Vec<u8>,
}

const MOST_COLORS: usize = 256;

/// Colours taken because many pixels have them; the rest because nothing else is near them.
const FREQUENT: usize = 192;

impl Indexed {
    /// The pixels with a palette of their own, if 256 colours are enough.
    pub fn exact(pixels: &[[u8; 4]]) -> Option<Indexed> {
        let mut table = ColorTable::new();
        let mut places = Vec::with_capacity(pixels.len());
        for run in pixels.chunk_by(|a, b| a == b) {
            let place = table.place(run[0]);
            if place == MOST_COLORS {
                return None;
            }
            places.resize(places.len() + run.len(), place as u8);
        }
        Some(Indexed { palette: table.colors, pixels: places })
    }

    /// The pixels with 256 of their colours, each with the nearest of them.
    ///
    /// Drawings have few colours of area and many of edges, which lie between those: taking
    /// the most frequent and then those that would be farthest off leaves no error that is
    /// seen. A transparent pixel stays one.
    pub fn nearest(pixels: &[[u8; 4]]) -> Indexed {
        let mut table = ColorTable::new();
        let mut counts = Vec::new();
        let mut runs = Vec::new();
        for run in pixels.chunk_by(|a, b| a == b) {
            let place = table.place(run[0]);
            counts.resize(table.colors.len(), 0_usize);
            counts[place] += run.len();
            runs.push((place, run.len()));
        }
        let choice = Choice::of(&table.colors, &counts);
        let mut places = Vec::with_capacity(pixels.len());
        for (place, length) in runs {
            places.resize(places.len() + length, choice.places[place]);
        }
        Indexed { palette: choice.palette, pixels: places }
    }
}

/// A palette being chosen from colours, and how well each of them is served by it.
struct Choice {
    /// Red, green and blue of the colours, apart so that distances are found many at a time.
    components: [Vec<i32>; 3],
    palette: Vec<[u8; 4]>,
    /// How far the nearest in the palette is from each colour, and its place.
    distances: Vec<i32>,
    places: Vec<u8>,
}

impl Choice {
    fn of(colors: &[[u8; 4]], counts: &[usize]) -> Choice {
        let components = [0, 1, 2].map(|at| colors.iter().map(|color| i32::from(color[at])).collect());
        let distances = vec![i32::MAX; colors.len()];
        let mut choice = Choice { components, palette: Vec::new(), distances, places: vec![0; colors.len()] };
        let mut ranking: Vec<usize> = (0..colors.len()).collect();
        ranking.sort_by_key(|&place| (colors[place][3], Reverse(counts[place])));
        ranking.iter().take(FREQUENT).for_each(|&place| choice.take(place, colors[place]));
        while choice.palette.len() < MOST_COLORS
            && let Some(place) = choice.farthest()
        {
            choice.take(place, colors[place]);
        }
        choice
    }

    /// Adds a colour to the palette; one that is transparent serves itself alone.
    fn take(&mut self, place: usize, color: [u8; 4]) {
        let number = self.palette.len() as u8;
        self.palette.push(color);
        if color[3] == 255 {
            self.serve(color.map(i32::from), number);
        }
        self.distances[place] = 0;
        self.places[place] = number;
    }

    /// Lets every colour that is nearer to this one than to any before have it.
    fn serve(&mut self, [r, g, b, _]: [i32; 4], number: u8) {
        let [reds, greens, blues] = &self.components;
        let colors = reds.iter().zip(greens).zip(blues);
        for (((&red, &green), &blue), (nearest, place)) in colors.zip(self.distances.iter_mut().zip(&mut self.places)) {
            let distance = weighted(red - r, green - g, blue - b);
            let is_nearer = distance < *nearest;
            *place = if is_nearer { number } else { *place };
            *nearest = if is_nearer { distance } else { *nearest };
        }
    }

    /// The colour that is served worst, the first of equals; none if all are served exactly.
    fn farthest(&self) -> Option<usize> {
        let worst = *self.distances.iter().max()?;
        self.distances.iter().position(|&distance| distance == worst && worst > 0)
    }
}

/// The square of a difference of colours, weighted by what each component adds to brightness.
const fn weighted(red: i32, green: i32, blue: i32) -> i32 {
    3 * red * red + 6 * green * green + blue * blue
}

#[cfg(test)]
mod tests {
    use super::*;

    fn greys(colors: u32) -> Vec<[u8; 4]> {
        (0..colors).flat_map(|at| [[at as u8, (at >> 8) as u8, 0, 255]; 3]).collect()
    }

    fn shown(indexed: &Indexed) -> Vec<[u8; 4]> {
        indexed.pixels.iter().map(|&place| indexed.palette[usize::from(place)]).collect()
    }

    #[test]
    fn up_to_256_colours_are_kept() {
        for colors in [1, 255, 256] {
            assert_eq!(shown(&Indexed::exact(&greys(colors)).unwrap()), greys(colors));
        }
        assert_eq!(Indexed::exact(&greys(257)), None);
    }

    #[test]
    fn nearest_keeps_what_fits() {
        assert_eq!(shown(&Indexed::nearest(&greys(256))), greys(256));
    }

    #[test]
    fn nearest_leaves_transparent_pixels_and_rare_colours_what_they_are() {
        let mut pixels = greys(2000);
        pixels.push([0; 4]);
        pixels.push([9, 9, 255, 255]);
        let shown = shown(&Indexed::nearest(&pixels));
        assert_eq!(shown[6000..], [[0; 4], [9, 9, 255, 255]]);
        assert!(shown[..6000].iter().all(|color| color[3] == 255));
    }

    #[test]
    fn a_table_grows_and_forgets_nothing() {
        let mut table = ColorTable::new();
        for round in 0..2 {
            for number in 0..5000_u32 {
                let color = (number * 7919).to_le_bytes();
                assert_eq!(table.place(color), number as usize, "round {round}");
            }
        }
    }
}
