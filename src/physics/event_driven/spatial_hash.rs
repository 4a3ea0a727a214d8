//! A spatial hash: one grid of square cells, hashed to a fixed number of buckets.

use super::body_state::{NONE, Slot};

/// Maximum number of cells per bucket that a static box may cover to be listed by cell; a larger one is
/// oversized.
const MAX_STATIC_CELLS_PER_BUCKET: f64 = 4.0;

/// A grid of square cells without bounds. The hash of a cell is linear in its indices, so the buckets
/// form a torus on which adjacent cells have a constant distance.
///
/// Cells that share a bucket cause unnecessary overlap tests, but no wrong results.
#[derive(Clone, Debug)]
pub struct SpatialHash {
    /// Side of a cell, m.
    pub side: f64,
    /// Distance in buckets of a cell and the cell below it.
    pub row_stride: u64,
    /// The first body in the list of each bucket, or [`NONE`]. The number of buckets is a power of two.
    pub buckets: Vec<Slot>,
    /// The index in `static_lists` of each bucket, or [`NONE`].
    pub static_list_indices: Vec<u32>,
    /// All bodies in the grid.
    pub members: Vec<Slot>,
    /// For each bucket with static boxes nearby, these boxes.
    pub static_lists: Vec<Vec<Slot>>,
    /// The static boxes that cover too many cells to be listed by cell.
    pub oversized_statics: Vec<Slot>,
}

impl SpatialHash {
    /// Creates an empty grid with a power of two of buckets.
    pub fn new(side: f64, buckets: usize) -> SpatialHash {
        let mut grid = SpatialHash {
            side,
            row_stride: 0,
            buckets: Vec::new(),
            static_list_indices: Vec::new(),
            members: Vec::new(),
            static_lists: Vec::new(),
            oversized_statics: Vec::new(),
        };
        grid.resize(buckets);
        grid
    }

    /// Removes all list entries and sets the number of buckets, a power of two. `members` is kept.
    pub fn resize(&mut self, buckets: usize) {
        self.buckets.clear();
        self.buckets.resize(buckets, NONE);
        self.static_list_indices.clear();
        self.static_list_indices.resize(buckets, NONE);
        // Multiples of the golden ratio distribute rows evenly over the buckets, whatever the shape of
        // the occupied region (Fibonacci hashing: Knuth, TAOCP 3, 6.4).
        self.row_stride = (buckets as f64 * 0.618_033_988_749_894_9) as u64 | 1;
        self.static_lists.clear();
        self.oversized_statics.clear();
    }

    /// The bucket of a cell.
    #[inline]
    pub fn bucket(&self, [x, y]: [i64; 2]) -> usize {
        let hash = (x as u64).wrapping_add((y as u64).wrapping_mul(self.row_stride));
        (hash & (self.buckets.len() as u64 - 1)) as usize
    }

    /// The cell of a point given in m.
    #[inline]
    pub fn cell(&self, point: [f64; 2]) -> [i64; 2] {
        point.map(|coordinate| floor(coordinate / self.side))
    }

    /// Lists a static box, given by its lower and upper corner in m, in all cells within half a side of it.
    pub fn insert_static(&mut self, slot: Slot, [low, high]: [[f64; 2]; 2]) {
        let margin = self.side / 2.0;
        let [from, to] = [self.cell(low.map(|x| x - margin)), self.cell(high.map(|x| x + margin))];
        let cells = (to[0] as f64 - from[0] as f64 + 1.0) * (to[1] as f64 - from[1] as f64 + 1.0);
        if cells > MAX_STATIC_CELLS_PER_BUCKET * self.buckets.len() as f64 {
            self.oversized_statics.push(slot);
            return;
        }
        for y in from[1]..=to[1] {
            for x in from[0]..=to[0] {
                let bucket = self.bucket([x, y]);
                if self.static_list_indices[bucket] == NONE {
                    self.static_list_indices[bucket] = self.static_lists.len() as u32;
                    self.static_lists.push(Vec::new());
                }
                let list = &mut self.static_lists[self.static_list_indices[bucket] as usize];
                if list.last() != Some(&slot) {
                    list.push(slot);
                }
            }
        }
    }
}

/// The largest integer not above `number`; saturates at the bounds of `i64`.
fn floor(number: f64) -> i64 {
    let whole = number as i64;
    if whole as f64 > number { whole.saturating_sub(1) } else { whole }
}
