use super::Picture;
use super::indexed::Indexed;

/// What of a picture differs from the one before it: a rectangle of indexed pixels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Patch {
    /// Its upper-left corner in the picture, px.
    pub at: [u32; 2],
    /// Width and height, px.
    pub size: [u32; 2],
    /// At most 256 colours.
    pub palette: Vec<[u8; 4]>,
    /// The palette's place that leaves a pixel as it was.
    pub unchanged: Option<u8>,
    /// Places in the palette, row by row.
    pub pixels: Vec<u8>,
}

impl Patch {
    /// All of `after`, or what of it differs from `before`; both have the same size.
    ///
    /// Exact when the pixels that differ have few enough colours, else each takes the nearest
    /// of the most frequent ones.
    pub fn between(before: Option<&Picture>, after: &Picture) -> Patch {
        let Some(before) = before else { return whole(after) };
        let Some(area) = changed_area(before, after) else { return nothing() };
        let width = after.size[0] as usize;
        let mut pixels = Vec::with_capacity((area.right - area.left) * (area.bottom - area.top));
        for row in area.top..area.bottom {
            let span = row * width + area.left..row * width + area.right;
            let both = before.pixels[span.clone()].iter().zip(&after.pixels[span]);
            pixels.extend(both.map(|(before, after)| if before == after { UNCHANGED } else { *after }));
        }
        let [left, top] = [area.left, area.top].map(|at| at as u32);
        let size = [area.right - area.left, area.bottom - area.top].map(|side| side as u32);
        index([left, top], size, &pixels)
    }
}

/// No pixel of a picture has this value: theirs are opaque.
const UNCHANGED: [u8; 4] = [0; 4];

fn whole(picture: &Picture) -> Patch {
    index([0, 0], picture.size, &picture.pixels)
}

/// One pixel that leaves what was: every picture of an animation needs an image.
fn nothing() -> Patch {
    index([0, 0], [1, 1], &[UNCHANGED])
}

fn index(at: [u32; 2], size: [u32; 2], pixels: &[[u8; 4]]) -> Patch {
    let Indexed { palette, pixels } = Indexed::exact(pixels).unwrap_or_else(|| nearest(pixels));
    let unchanged = palette.iter().position(|&color| color == UNCHANGED).map(|place| place as u8);
    Patch { at, size, palette, unchanged, pixels }
}

/// The 256 most frequent colours, and for every pixel the nearest of them.
///
/// Drawings have few colours of area and many of edges, which lie between those: an edge's
/// colour always has a near neighbour among the others.
fn nearest(pixels: &[[u8; 4]]) -> Indexed {
    let counted = count(pixels);
    let mut ranking: Vec<(u64, [u8; 4])> = counted.iter().map(|&(color, count)| (count, color)).collect();
    ranking.sort_unstable_by(|a, b| (b.0, a.1).cmp(&(a.0, b.1)));
    let palette: Vec<[u8; 4]> = ranking.iter().take(256).map(|&(_, color)| color).collect();
    let places: Vec<u8> = counted.iter().map(|&(color, _)| nearest_place(&palette, color)).collect();
    let place = |color: [u8; 4]| places[counted.binary_search_by_key(&color, |&(known, _)| known).unwrap_or(0)];
    let mut indexed = Vec::with_capacity(pixels.len());
    for run in pixels.chunk_by(|a, b| a == b) {
        indexed.resize(indexed.len() + run.len(), place(run[0]));
    }
    Indexed { palette, pixels: indexed }
}

/// Every colour and how many pixels have it, sorted by colour.
fn count(pixels: &[[u8; 4]]) -> Vec<([u8; 4], u64)> {
    let mut runs: Vec<([u8; 4], u64)> = pixels.chunk_by(|a, b| a == b).map(|run| (run[0], run.len() as u64)).collect();
    runs.sort_unstable();
    let mut counted: Vec<([u8; 4], u64)> = Vec::new();
    for (color, length) in runs {
        match counted.last_mut() {
            Some(last) if last.0 == color => last.1 += length,
            _ => counted.push((color, length)),
        }
    }
    // Leaving a pixel as it was is never to be traded for a colour that is near.
    if let Some(unchanged) = counted.first_mut().filter(|first| first.0 == UNCHANGED) {
        unchanged.1 = u64::MAX;
    }
    counted
}

/// The place of the nearest opaque colour; of equals the first.
fn nearest_place(palette: &[[u8; 4]], color: [u8; 4]) -> u8 {
    let places = palette.iter().enumerate().filter(|(_, known)| known[3] == color[3]);
    places.min_by_key(|(_, known)| distance(**known, color)).map_or(0, |(place, _)| place as u8)
}

/// Squared differences weighted by what each component adds to brightness.
fn distance(a: [u8; 4], b: [u8; 4]) -> u32 {
    let squared = |place: usize| u32::from(a[place].abs_diff(b[place])) * u32::from(a[place].abs_diff(b[place]));
    3 * squared(0) + 6 * squared(1) + squared(2)
}

/// Columns `left` to before `right`, rows `top` to before `bottom`.
struct Area {
    left: usize,
    top: usize,
    right: usize,
    bottom: usize,
}

/// The smallest area outside of which the two agree.
fn changed_area(before: &Picture, after: &Picture) -> Option<Area> {
    let differing = |(_, (a, b)): &(usize, (&[[u8; 4]], &[[u8; 4]]))| a != b;
    let mut rows = before.rows().zip(after.rows()).enumerate().filter(differing);
    let (top, first) = rows.next()?;
    let (mut left, mut right) = changed_columns(first);
    let mut bottom = top + 1;
    for (row, pair) in rows {
        let (from, to) = changed_columns(pair);
        (left, right, bottom) = (left.min(from), right.max(to), row + 1);
    }
    Some(Area { left, top, right, bottom })
}

/// The first column in which two rows that differ do, and the one after the last.
fn changed_columns((a, b): (&[[u8; 4]], &[[u8; 4]])) -> (usize, usize) {
    let from = a.iter().zip(b).position(|(a, b)| a != b).unwrap_or(0);
    let to = a.iter().zip(b).rposition(|(a, b)| a != b).map_or(0, |last| last + 1);
    (from, to)
}
