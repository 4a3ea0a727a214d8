//! The grid from which the lists of a window are made.

use super::body_state::Slot;
use super::spatial_hash::NONE;
use super::swept_aabb::SweptAabb;
use crate::physics::Axis;
use std::ops::Range;

/// The greatest side of a home in the grid as a fraction of the side of a cell: less than 1 by more than the rounding of
/// the indices of cells.
const MAX_FILL: f64 = 1.0 - 1.0 / (1_u64 << 12) as f64;

/// The greatest magnitude of a coordinate in sides of a cell: beyond it, the rounding of borders to single precision
/// is not much smaller than a cell.
const MAX_COORDINATE: f64 = (1_u64 << 16) as f64;

/// The greatest distance, in sides of a cell, of the centre of a home from a rectangle that it overlaps: half a side,
/// and the rounding of the borders.
const MAX_REACH: f64 = 0.5 + 1.0 / 64.0;

/// The greatest number of cells per body. Where bodies are sparser, lists do not pay.
const MAX_CELLS_PER_BODY: f64 = 4.0;

/// The greatest number per body of pairs in the same cell or in adjacent ones. With more, for instance with dust among
/// boxes, lists do not pay.
const MAX_CANDIDATES_PER_BODY: usize = 128;

/// Moving bodies sorted by the cells of a square grid that contain the centres of their homes.
///
/// The grid covers the region of the bodies when it was made; a cell at its edge also stands for the plane beyond. Around
/// it is a margin of empty cells. Invariant: no home is longer than the side of a cell, so homes that overlap are in the
/// same cell or in adjacent ones.
#[derive(Clone, Debug, Default)]
pub struct HomeGrid {
    /// Side of a cell, m.
    side: f64,
    /// The lower corner of the first cell inside the margin, m.
    origin: [f64; 2],
    /// The number of columns and rows, without the margin.
    cells: [u32; 2],
    /// The number of columns with the margin.
    columns: usize,
    /// By bucket, the index in `slots` of its first body; at last the number of bodies.
    starts: Vec<u32>,
    /// The bodies in the order of their buckets.
    pub slots: Vec<Slot>,
    /// The homes of `slots` when the grid was made.
    homes: Vec<SweptAabb>,
    /// The paths of `slots` when the grid was made.
    pub paths: Vec<SweptAabb>,
    /// The pairs of bodies whose homes overlapped when the grid was made, as indices in `slots`.
    pub pairs: Vec<[u32; 2]>,
    /// By index in `slots`, the number of pairs.
    pub lengths: Vec<u32>,
    /// By bucket, the index in `strays` of its latest stray, or [`NONE`].
    latest_strays: Vec<u32>,
    /// The strays. One that strayed repeatedly is listed repeatedly.
    strays: Vec<Stray>,
    /// Buffer for the buckets of the bodies.
    buckets: Vec<u32>,
}

/// A body that has left its home.
#[derive(Clone, Copy, Debug)]
struct Stray {
    /// The new home.
    home: SweptAabb,
    slot: Slot,
    /// The index in [`HomeGrid::strays`] of the stray before it in the same bucket, or [`NONE`].
    previous: u32,
}

impl HomeGrid {
    /// Returns true if a home is small enough for a grid with cells of a side, m.
    #[inline]
    fn fits(home: &SweptAabb, side: f64) -> bool {
        home.longer_side() <= side * MAX_FILL
    }

    /// Sorts bodies into cells of a side (m), given their homes and paths by slot; adds those whose homes are larger than
    /// a cell to `large`. Returns false if lists do not pay.
    pub fn sort(
        &mut self,
        side: f64,
        bodies: &[Slot],
        homes: &[SweptAabb],
        paths: &[SweptAabb],
        large: &mut Vec<Slot>,
    ) -> bool {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for slot in bodies {
            let centre = homes[*slot as usize].centre();
            low = Axis::BOTH.map(|axis| if centre[axis] < low[axis] { centre[axis] } else { low[axis] });
            high = Axis::BOTH.map(|axis| if centre[axis] > high[axis] { centre[axis] } else { high[axis] });
        }
        let spans = Axis::BOTH.map(|axis| (high[axis] - low[axis]) / side + 1.0);
        let is_dense = spans[0] * spans[1] <= bodies.len() as f64 * MAX_CELLS_PER_BODY;
        let is_precise = low.into_iter().chain(high).all(|coordinate| coordinate.abs() < side * MAX_COORDINATE);
        if !is_dense || !is_precise {
            return false;
        }
        (self.side, self.origin) = (side, low);
        self.cells = spans.map(|span| span as u32);
        self.columns = self.cells[0] as usize + 2;
        self.place(bodies, homes, paths, large);
        self.candidates() <= bodies.len() * MAX_CANDIDATES_PER_BODY
    }

    /// Sorts the bodies by counting; in a cell they keep their order.
    fn place(&mut self, bodies: &[Slot], homes: &[SweptAabb], paths: &[SweptAabb], large: &mut Vec<Slot>) {
        let buckets = self.columns * (self.cells[1] as usize + 2);
        self.strays.clear();
        self.latest_strays.clear();
        self.latest_strays.resize(buckets, NONE);
        self.starts.clear();
        self.starts.resize(buckets + 1, 0);
        self.buckets.clear();
        for slot in bodies {
            let home = &homes[*slot as usize];
            if HomeGrid::fits(home, self.side) {
                let bucket = self.bucket(home.centre());
                self.buckets.push(bucket as u32);
                self.starts[bucket] += 1;
            } else {
                self.buckets.push(NONE);
                large.push(*slot);
            }
        }
        // Each start is first that of the next bucket, and is lowered as bodies are placed from the last one on.
        let mut sum = 0;
        for start in &mut self.starts {
            sum += *start;
            *start = sum;
        }
        self.slots.resize(sum as usize, NONE);
        self.homes.resize(sum as usize, SweptAabb::EVERYWHERE);
        self.paths.resize(sum as usize, SweptAabb::EVERYWHERE);
        for (slot, bucket) in bodies.iter().zip(&self.buckets).rev().filter(|(_, bucket)| **bucket != NONE) {
            let start = &mut self.starts[*bucket as usize];
            *start -= 1;
            let place = *start as usize;
            self.slots[place] = *slot;
            self.homes[place] = homes[*slot as usize];
            self.paths[place] = paths[*slot as usize];
        }
    }

    /// The number of pairs of bodies in the same cell or in adjacent ones, or somewhat more.
    fn candidates(&self) -> usize {
        let of_bucket = |bucket: usize| {
            let after = self.bodies_in(bucket..bucket + 2).len() + self.bodies_below(bucket).len();
            self.bodies_in(bucket..bucket + 1).len() * after
        };
        self.buckets_inside().map(of_bucket).sum()
    }

    /// Finds the pairs of bodies whose homes overlap, and counts those of each body.
    pub fn find_pairs(&mut self) {
        self.lengths.clear();
        self.lengths.resize(self.slots.len(), 0);
        let mut count = 0;
        for bucket in self.buckets_inside() {
            // A pair is found from the one of its bodies that is first in the order of the buckets.
            let own = self.bodies_in(bucket..bucket + 1);
            let (end, below) = (self.starts[bucket + 2] as usize, self.bodies_below(bucket));
            let candidates = own.len() * (end - own.start + below.len());
            if self.pairs.len() < count + candidates {
                self.pairs.resize(2 * count + candidates, [NONE; 2]);
            }
            let pairs = &mut self.pairs[..];
            for first in own {
                let (home, start) = (&self.homes[first], count);
                for seconds in [first + 1..end, below.clone()] {
                    for (second, other) in seconds.clone().zip(&self.homes[seconds]) {
                        pairs[count] = [first as u32, second as u32];
                        count += usize::from(!home.is_disjoint_from(other));
                    }
                }
                self.lengths[first] += (count - start) as u32;
                pairs[start..count].iter().for_each(|[_, second]| self.lengths[*second as usize] += 1);
            }
        }
        self.pairs.truncate(count);
    }

    /// Enters a body that has left its home; returns false if the new one is larger than a cell.
    pub fn add_stray(&mut self, slot: Slot, home: &SweptAabb) -> bool {
        let fits = HomeGrid::fits(home, self.side);
        if fits {
            let bucket = self.bucket(home.centre());
            self.strays.push(Stray { home: *home, slot, previous: self.latest_strays[bucket] });
            self.latest_strays[bucket] = self.strays.len() as u32 - 1;
        }
        fits
    }

    /// How often bodies have left their homes.
    pub fn strays(&self) -> usize {
        self.strays.len()
    }

    /// Calls `visit` for the bodies in the cells around a rectangle, with true for those whose homes overlap it. A stray is
    /// visited with each of its homes, the earlier ones, too.
    pub fn visit_near(&self, rectangle: &SweptAabb, mut visit: impl FnMut(Slot, bool)) {
        let reach = self.side * MAX_REACH;
        let [low, high] = rectangle.corners();
        let first = self.bucket(low.map(|coordinate| coordinate - reach));
        let last = self.bucket(high.map(|coordinate| coordinate + reach));
        let width = last % self.columns - first % self.columns;
        for start in (first..=last - width).step_by(self.columns) {
            let row = start..start + width + 1;
            let bodies = self.bodies_in(row.clone());
            for (slot, home) in self.slots[bodies.clone()].iter().zip(&self.homes[bodies]) {
                visit(*slot, !rectangle.is_disjoint_from(home));
            }
            for latest in &self.latest_strays[row] {
                let mut next = *latest;
                while next != NONE {
                    let stray = &self.strays[next as usize];
                    visit(stray.slot, !rectangle.is_disjoint_from(&stray.home));
                    next = stray.previous;
                }
            }
        }
    }

    /// The bucket of the cell that contains a point, or of the nearest one.
    #[inline]
    fn bucket(&self, point: [f64; 2]) -> usize {
        // A cast rounds negative numbers to 0.
        let index = |axis: Axis| (((point[axis] - self.origin[axis]) / self.side) as u32).min(self.cells[axis] - 1);
        let [x, y] = Axis::BOTH.map(|axis| index(axis) as usize + 1);
        y * self.columns + x
    }

    /// The buckets of the cells inside the margin, row by row.
    fn buckets_inside(&self) -> impl Iterator<Item = usize> + use<> {
        let ([width, height], columns) = (self.cells.map(|count| count as usize), self.columns);
        (1..=height).flat_map(move |y| y * columns + 1..y * columns + 1 + width)
    }

    /// The bodies in consecutive buckets, as indices in `slots`.
    #[inline]
    fn bodies_in(&self, buckets: Range<usize>) -> Range<usize> {
        self.starts[buckets.start] as usize..self.starts[buckets.end] as usize
    }

    /// The bodies in the cells of the next row that are adjacent to that of a bucket, as indices in `slots`.
    #[inline]
    fn bodies_below(&self, bucket: usize) -> Range<usize> {
        let below = bucket + self.columns;
        self.bodies_in(below - 1..below + 2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::event_driven::pseudo_random::PseudoRandom;

    impl PseudoRandom {
        /// A rectangle with sides of up to `size` in a room of 40 m.
        fn rectangle(&mut self, size: f64) -> SweptAabb {
            let [x, y] = [0, 1].map(|_| self.between(-20.0, 20.0));
            let borders = [x, y, -x - size * self.next(), -y - size * self.next()];
            SweptAabb::of(borders.map(|border| border as f32))
        }
    }

    #[test]
    fn the_grid_finds_all_homes_that_overlap() {
        let mut random = PseudoRandom(7);
        for side in [3.0, 7.0, 1e4] {
            let mut homes: Vec<SweptAabb> = (0..100).map(|_| random.rectangle(side * 0.9)).collect();
            homes[50] = homes[50].enlarged(side as f32);
            let (mut grid, mut large) = (HomeGrid::default(), Vec::new());
            let slots = Vec::from_iter(0..100);
            assert!(grid.sort(side, &slots, &homes, &homes, &mut large) && large == [50]);
            grid.find_pairs();
            let sorted = |[a, b]: [Slot; 2]| if a < b { [a, b] } else { [b, a] };
            let mut pairs: Vec<[Slot; 2]> =
                grid.pairs.iter().map(|pair| sorted(pair.map(|place| grid.slots[place as usize]))).collect();
            pairs.sort_unstable();
            let overlap = |[a, b]: [Slot; 2]| !homes[a as usize].is_disjoint_from(&homes[b as usize]);
            let all = (0..100).flat_map(|a| (a + 1..100).map(move |b| [a, b])).filter(|pair| !pair.contains(&50));
            assert_eq!(pairs, all.filter(|pair| overlap(*pair)).collect::<Vec<[Slot; 2]>>());
            for size in [0.1, 5.0, 100.0] {
                let rectangle = random.rectangle(size);
                let mut found = Vec::new();
                grid.visit_near(&rectangle, |slot, overlaps| found.extend(overlaps.then_some(slot)));
                let overlapping = slots.iter().filter(|slot| !rectangle.is_disjoint_from(&homes[**slot as usize]));
                assert!(overlapping.filter(|slot| **slot != 50).all(|slot| found.contains(slot)));
                found.sort_unstable();
                assert!(found.windows(2).all(|pair| pair[0] < pair[1]), "each once");
            }
        }
    }

    #[test]
    fn a_stray_is_found_at_its_new_home() {
        let homes = [0.0, 10.0].map(|x| SweptAabb::of([x, 0.0, -x - 1.0, -1.0]));
        let (mut grid, mut large) = (HomeGrid::default(), Vec::new());
        assert!(grid.sort(2.0, &[0, 1], &homes, &homes, &mut large));
        assert!(grid.add_stray(0, &SweptAabb::of([20.0, 0.0, -21.0, -1.0])));
        assert!(!grid.add_stray(0, &SweptAabb::of([20.0, 0.0, -23.0, -1.0])), "larger than a cell");
        let mut found = Vec::new();
        grid.visit_near(&SweptAabb::of([20.5, 0.5, -20.5, -0.5]), |slot, overlaps| found.push((slot, overlaps)));
        found.sort_unstable();
        let expected = vec![(0, true), (1, false)];
        assert_eq!((found, grid.strays()), (expected, 1), "the last cell also stands for the plane beyond");
    }

    #[test]
    fn lists_do_not_pay_where_bodies_are_sparse_or_crowded_in_a_cell() {
        let pays = |bodies: u32, spacing: f32| {
            let home = |index: u32| {
                let x = spacing * index as f32;
                SweptAabb::of([x, 0.0, -x - 0.5, -0.5])
            };
            let homes: Vec<SweptAabb> = (0..bodies).map(home).collect();
            HomeGrid::default().sort(1.0, &Vec::from_iter(0..bodies), &homes, &homes, &mut Vec::new())
        };
        assert!(pays(1000, 1.0) && !pays(1000, 5.0) && !pays(1000, 1e-4));
    }
}
