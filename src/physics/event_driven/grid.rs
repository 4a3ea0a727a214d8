//! One grid of square cells, wound onto a torus of buckets.

use super::mover::Slot;

/// No body.
pub const NONE: u32 = u32::MAX;

/// An anchored box is entered in its cells one by one only while they are at most so many
/// for each bucket of the grid.
const ANCHOR_CELLS_PER_BUCKET: f64 = 4.0;

/// One grid: a torus of buckets onto which the unbounded plane of cells is wound.
///
/// Two cells that fall on the same bucket cost a few needless questions, nothing else.
#[derive(Clone, Debug)]
pub struct Grid {
    /// Of a cell, m.
    pub side: f64,
    /// Along which multiple of rows the plane is wound.
    pub row: u64,
    /// Where the cells wound onto the same place keep their bodies: the first of a list, or
    /// [`NONE`]. As many as a power of two.
    pub buckets: Vec<Slot>,
    /// For each bucket the index of its anchored boxes, or [`NONE`].
    pub anchors_of: Vec<u32>,
    /// Who sits in it.
    pub members: Vec<Slot>,
    /// The anchored boxes near each bucket that has any.
    pub anchors: Vec<Vec<Slot>>,
    /// The anchored boxes too large to be entered cell by cell.
    pub everywhere: Vec<Slot>,
}

impl Grid {
    /// An empty grid.
    pub fn new(side: f64, buckets: usize) -> Grid {
        let mut grid = Grid {
            side,
            row: 0,
            buckets: Vec::new(),
            anchors_of: Vec::new(),
            members: Vec::new(),
            anchors: Vec::new(),
            everywhere: Vec::new(),
        };
        grid.resize(buckets);
        grid
    }

    /// Empties it and gives it so many buckets, a power of two.
    pub fn resize(&mut self, buckets: usize) {
        self.buckets.clear();
        self.buckets.resize(buckets, NONE);
        self.anchors_of.clear();
        self.anchors_of.resize(buckets, NONE);
        // Rows a golden section apart lie as evenly on the ring of buckets as can be,
        // whatever the shape of the inhabited region (Knuth, TAOCP 3, 6.4).
        self.row = (buckets as f64 * 0.618_033_988_749_894_9) as u64 | 1;
        self.anchors.clear();
        self.everywhere.clear();
    }

    /// The bucket of a cell.
    #[inline]
    pub fn bucket(&self, [x, y]: [i64; 2]) -> usize {
        let wound = (x as u64).wrapping_add((y as u64).wrapping_mul(self.row));
        (wound & (self.buckets.len() as u64 - 1)) as usize
    }

    /// The cell of a point, m.
    #[inline]
    pub fn cell(&self, point: [f64; 2]) -> [i64; 2] {
        point.map(|coordinate| floor(coordinate / self.side))
    }

    /// Enters an anchored box by its lower and upper corner, m.
    pub fn anchor(&mut self, slot: Slot, [low, high]: [[f64; 2]; 2]) {
        let reach = self.side / 2.0;
        let [from, to] = [self.cell(low.map(|x| x - reach)), self.cell(high.map(|x| x + reach))];
        let cells = (to[0] as f64 - from[0] as f64 + 1.0) * (to[1] as f64 - from[1] as f64 + 1.0);
        if cells > ANCHOR_CELLS_PER_BUCKET * self.buckets.len() as f64 {
            self.everywhere.push(slot);
            return;
        }
        for y in from[1]..=to[1] {
            for x in from[0]..=to[0] {
                let bucket = self.bucket([x, y]);
                if self.anchors_of[bucket] == NONE {
                    self.anchors_of[bucket] = self.anchors.len() as u32;
                    self.anchors.push(Vec::new());
                }
                let anchors = &mut self.anchors[self.anchors_of[bucket] as usize];
                if anchors.last() != Some(&slot) {
                    anchors.push(slot);
                }
            }
        }
    }
}

/// The greatest whole number not above this one, as far as there are such numbers.
fn floor(number: f64) -> i64 {
    let whole = number as i64;
    if whole as f64 > number { whole.saturating_sub(1) } else { whole }
}
