//! The grid from which the lists of a window are made.

use super::body_state::{NONE, Slot};
use super::swept_aabb::SweptAabb;
use super::threads::Threads;
use crate::physics::{Axis, larger, smaller};
use std::ops::Range;

/// The greatest side of a home in the grid as a fraction of the side of a cell: less than 1 by more than the rounding
/// of the indices of cells.
const MAX_FILL: f64 = 1.0 - 1.0 / (1_u64 << 12) as f64;

/// The greatest magnitude of a coordinate in sides of a cell: beyond it, the rounding of borders to single precision
/// is not much smaller than a cell.
const MAX_COORDINATE: f64 = (1_u64 << 16) as f64;

/// The greatest distance, in sides of a cell, of the centre of a home from a rectangle that it overlaps: half a side,
/// and the rounding of the borders.
const MAX_CENTRE_DISTANCE: f64 = 0.5 + 1.0 / 64.0;

/// The greatest number of cells per body. Where bodies are sparser, lists do not pay.
const MAX_CELLS_PER_BODY: f64 = 4.0;

/// The greatest number per body of pairs in the same cell or in adjacent ones. With more, for instance with dust among
/// boxes, lists do not pay.
const MAX_CANDIDATES_PER_BODY: usize = 128;

/// The number of cells in which the candidates of a body are counted.
const CELLS_OF_CANDIDATES: usize = 5;

/// The number of bodies in the parts that are sorted independently.
const BODIES_PER_PART: usize = 4096;

/// Moving bodies sorted by the cells of a square grid that contain the centres of their homes.
///
/// The grid covers the region of the bodies when it was made; a cell at its edge also stands for the plane beyond.
/// Around it is a margin of empty cells. Invariant: no home is longer than the side of a cell, so homes that overlap
/// are in the same cell or in adjacent ones.
#[derive(Clone, Debug, Default)]
pub struct HomeGrid {
    /// Side of a cell, m.
    side: f64,
    /// The lower corner of the first cell inside the margin, m.
    origin: [f64; 2],
    /// The number of columns and rows, without the margin.
    cells: [u32; 2],
    /// The last column and row, without the margin.
    last: [f64; 2],
    /// The number of columns with the margin.
    columns: usize,
    /// By bucket, the index in `slots` of its first body; the last entry is the number of bodies.
    starts: Vec<u32>,
    /// The bodies in the order of their buckets.
    slots: Vec<Slot>,
    /// The homes of `slots` when the grid was made.
    homes: Vec<SweptAabb>,
    /// By bucket, the index in `strays` of its latest stray, or [`NONE`].
    latest_strays: Vec<u32>,
    /// The strays. One that strayed repeatedly is listed repeatedly.
    strays: Vec<Stray>,
    /// All bodies in the order in which they are sorted: that of the last time, so that memory is read and written
    /// almost in order.
    entries: Vec<Entry>,
}

/// A body to be sorted.
#[derive(Clone, Copy, Debug)]
struct Entry {
    home: SweptAabb,
    slot: Slot,
    /// Its bucket, or [`NONE`] if the home is larger than a cell.
    bucket: u32,
}

/// The lower and upper corners of the smallest rectangle around two, m.
fn hull(a: [[f64; 2]; 2], b: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    [Axis::BOTH.map(|axis| smaller(a[0][axis], b[0][axis])), Axis::BOTH.map(|axis| larger(a[1][axis], b[1][axis]))]
}

/// Some rows of the grid, and the pairs of bodies that are found in them.
///
/// The bodies are numbered by their indices in [`HomeGrid::slots`].
#[derive(Clone, Debug, Default)]
pub struct Band {
    rows: Range<usize>,
    /// The bodies in the rows.
    bodies: Range<usize>,
    /// The pairs whose homes overlap, the first one in the band, in the order of the rows; then spare space.
    pairs: Vec<[u32; 2]>,
    /// The number of pairs before those with the first one in the last row, and of all.
    counts: [usize; 2],
    /// The pairs whose paths may overlap, the body that is to predict their event first; then spare space.
    close_pairs: Vec<[Slot; 2]>,
    /// The number of these pairs.
    close_pair_count: usize,
}

impl Band {
    /// The pairs of bodies whose paths may overlap; the first of a pair is to predict their event.
    pub fn close_pairs(&self) -> &[[Slot; 2]] {
        &self.close_pairs[..self.close_pair_count]
    }

    /// Adds a pair whose paths may overlap.
    pub fn add_close_pair(&mut self, pair: [Slot; 2]) {
        // The spare space remains for the next window.
        match self.close_pairs.get_mut(self.close_pair_count) {
            Some(spare) => *spare = pair,
            None => self.close_pairs.push(pair),
        }
        self.close_pair_count += 1;
    }

    /// The pairs of a body in the band and one in the next band.
    fn crossing(&self) -> impl Iterator<Item = [u32; 2]> {
        let [before, all] = self.counts;
        self.pairs[before..all].iter().copied().filter(|[_, second]| *second as usize >= self.bodies.end)
    }
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

    /// Sorts bodies into cells of a side (m), given their homes; adds those whose homes are larger than a cell to
    /// `large`. Returns false if lists do not pay. The bodies must be the same each time.
    pub fn sort<'a>(
        &mut self,
        side: f64,
        bodies: &[Slot],
        home: impl Fn(Slot) -> &'a SweptAabb + Sync,
        large: &mut Vec<Slot>,
        threads: Threads,
    ) -> bool {
        let mut entries = std::mem::take(&mut self.entries);
        if entries.is_empty() {
            entries.extend(bodies.iter().map(|slot| Entry { home: SweptAabb::EVERYWHERE, slot: *slot, bucket: NONE }));
        }
        let mut corners = vec![[[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]]; bodies.len().div_ceil(BODIES_PER_PART)];
        threads.share(entries.chunks_mut(BODIES_PER_PART).zip(&mut corners), |(entries, corners)| {
            let mut around = *corners;
            for entry in entries {
                entry.home = *home(entry.slot);
                around = hull(around, [entry.home.centre(); 2]);
            }
            *corners = around;
        });
        let [low, high] = corners.into_iter().reduce(hull).unwrap_or_default();
        let spans = Axis::BOTH.map(|axis| (high[axis] - low[axis]) / side + 1.0);
        let is_dense = spans[0] * spans[1] <= bodies.len() as f64 * MAX_CELLS_PER_BODY;
        let is_precise = low.into_iter().chain(high).all(|coordinate| coordinate.abs() < side * MAX_COORDINATE);
        if !is_dense || !is_precise {
            return false;
        }
        (self.side, self.origin) = (side, low);
        self.cells = spans.map(|span| span as u32);
        self.last = self.cells.map(|count| f64::from(count - 1));
        self.columns = self.cells[0] as usize + 2;
        threads.share(entries.chunks_mut(BODIES_PER_PART), |entries: &mut [Entry]| {
            for entry in entries {
                let fits = HomeGrid::fits(&entry.home, side);
                entry.bucket = if fits { self.bucket(entry.home.centre()) as u32 } else { NONE };
            }
        });
        self.sort_by_bucket(&mut entries, large);
        self.entries = entries;
        self.most_in_a_cell() <= MAX_CANDIDATES_PER_BODY / CELLS_OF_CANDIDATES
            || self.candidates() <= bodies.len() * MAX_CANDIDATES_PER_BODY
    }

    /// The greatest number of bodies in a cell.
    fn most_in_a_cell(&self) -> usize {
        let counts = self.starts.iter().zip(&self.starts[1..]).map(|(start, end)| end - start);
        counts.fold(0, |most, count| if count > most { count } else { most }) as usize
    }

    /// Sorts the bodies by counting; in a cell they keep their order.
    fn sort_by_bucket(&mut self, entries: &mut [Entry], large: &mut Vec<Slot>) {
        let count = self.columns * (self.cells[1] as usize + 2);
        self.strays.clear();
        self.latest_strays.clear();
        self.latest_strays.resize(count, NONE);
        self.starts.clear();
        self.starts.resize(count + 1, 0);
        for entry in &*entries {
            match entry.bucket {
                NONE => large.push(entry.slot),
                bucket => self.starts[bucket as usize] += 1,
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
        for entry in entries.iter().rev().filter(|entry| entry.bucket != NONE) {
            let start = &mut self.starts[entry.bucket as usize];
            *start -= 1;
            let place = *start as usize;
            self.slots[place] = entry.slot;
            self.homes[place] = entry.home;
        }
        for (entry, slot) in entries.iter_mut().zip(self.slots.iter().chain(&*large)) {
            entry.slot = *slot;
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

    /// The approximate greatest magnitude of a coordinate, m.
    pub fn extent(&self) -> f64 {
        let ends = Axis::BOTH.map(|axis| self.origin[axis] + self.side * f64::from(self.cells[axis]));
        self.origin.into_iter().chain(ends).map(f64::abs).fold(self.side, larger)
    }

    /// Divides the rows of cells into bands, at least one, each of about the given number of bodies.
    pub fn divide(&self, bodies: usize, bands: &mut Vec<Band>) {
        let rows = self.cells[1] as usize;
        let rows_per_band = rows.div_ceil(self.slots.len().div_ceil(bodies).clamp(1, rows));
        bands.resize_with(rows.div_ceil(rows_per_band), Band::default);
        for (band, first) in bands.iter_mut().zip((1..).step_by(rows_per_band)) {
            band.rows = first..(first + rows_per_band).min(rows + 1);
            band.bodies = self.bodies_in(band.rows.start * self.columns..band.rows.end * self.columns);
        }
    }

    /// Makes the lists of the bodies whose homes overlap. Sets `ends` to the starts of the lists of `slots`
    /// in `members`, and calls `set_list` with each body and its list as a range of them. If homes overlap by more than
    /// `distance` (m), the paths may overlap.
    pub fn make_lists(
        &self,
        distance: f32,
        bands: &mut [Band],
        ends: &mut Vec<u32>,
        members: &mut Vec<Slot>,
        threads: Threads,
        mut set_list: impl FnMut(Slot, [u32; 2]),
    ) {
        ends.clear();
        ends.resize(self.slots.len(), 0);
        let mut rest = &mut ends[..];
        let parts = bands.iter_mut().map(|band| (rest.split_off_mut(..band.bodies.len()).unwrap_or_default(), band));
        threads.share(parts, |(lengths, band)| self.find_pairs(band, lengths, distance));
        for [_, second] in bands.iter().flat_map(Band::crossing) {
            ends[second as usize] += 1;
        }
        // Each entry is first the end of a list, and is lowered to its start as members are added.
        let mut sum = 0;
        for (slot, length) in self.slots.iter().zip(&mut *ends) {
            let start = sum;
            sum += *length;
            *length = sum;
            set_list(*slot, [start, sum]);
        }
        members.resize(sum as usize, NONE);
        let (mut rest, mut members, mut before, mut start) = (&mut ends[..], &mut members[..], None, 0);
        let parts = bands.iter().map(|band| {
            let ends = rest.split_off_mut(..band.bodies.len()).unwrap_or_default();
            let end = ends.last().copied().unwrap_or(start);
            let lists = members.split_off_mut(..(end - start) as usize).unwrap_or_default();
            let part = (before.replace(band), band, ends, start, lists);
            start = end;
            part
        });
        threads.share(parts, |(before, band, ends, start, lists)| self.fill_lists(before, band, ends, start, lists));
    }

    /// Finds the pairs of a body in a band and a later one whose homes overlap. Adds to `lengths` the number of pairs
    /// of each body in the band. If the homes overlap by more than `distance` (m), the paths may overlap.
    fn find_pairs(&self, band: &mut Band, lengths: &mut [u32], distance: f32) {
        // Of one length, so that an index that fits one fits the other.
        let slots = &self.slots[..];
        let homes = &self.homes[..slots.len()];
        let mut count = 0;
        for row in band.rows.clone() {
            band.counts[0] = count;
            for bucket in row * self.columns + 1..(row + 1) * self.columns - 1 {
                // A pair is found from the one of its bodies that is first in the order of the buckets.
                let own = self.bodies_in(bucket..bucket + 1);
                let (end, below) = (self.starts[bucket + 2] as usize, self.bodies_below(bucket));
                let candidates = own.len() * (end - own.start + below.len());
                if band.pairs.len() < count + candidates {
                    band.pairs.resize(2 * count + candidates, [NONE; 2]);
                }
                let pairs = &mut band.pairs[..];
                for first in own {
                    let (home, start) = (homes[first], count);
                    let mut second = first;
                    for _ in 0..end - (first + 1) + below.len() {
                        second = if second + 1 == end { below.start } else { second + 1 };
                        pairs[count] = [first as u32, second as u32];
                        count += usize::from(!home.is_disjoint_from(&homes[second]));
                    }
                    lengths[first - band.bodies.start] += (count - start) as u32;
                }
            }
        }
        band.counts[1] = count;
        if band.close_pairs.len() < count {
            band.close_pairs.resize(2 * count, [NONE; 2]);
        }
        let mut found = 0;
        for [first, second] in band.pairs[..count].iter().map(|pair| pair.map(|body| body as usize)) {
            if let Some(length) = lengths.get_mut(second - band.bodies.start) {
                *length += 1;
            }
            let [slot, other] = [slots[first], slots[second]];
            band.close_pairs[found] = if slot < other { [slot, other] } else { [other, slot] };
            found += usize::from(!homes[first].is_farther_from(&homes[second], -distance));
        }
        band.close_pair_count = found;
    }

    /// Fills the lists of the bodies in a band, given the one before it. `ends` are the ends of their lists among the
    /// lists of all bodies, and are lowered to the starts; `members` are the lists of the band, the first of which
    /// starts at `start`.
    fn fill_lists(&self, before: Option<&Band>, band: &Band, ends: &mut [u32], start: u32, members: &mut [Slot]) {
        let mut add = |body: u32, other: u32| {
            let end = &mut ends[body as usize - band.bodies.start];
            *end -= 1;
            members[(*end - start) as usize] = self.slots[other as usize];
        };
        for [first, second] in &band.pairs[..band.counts[1]] {
            add(*first, *second);
            if (*second as usize) < band.bodies.end {
                add(*second, *first);
            }
        }
        for [first, second] in before.into_iter().flat_map(Band::crossing) {
            add(second, first);
        }
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

    /// The number of times that bodies have left their homes.
    pub fn strays(&self) -> usize {
        self.strays.len()
    }

    /// Calls `visit` for the bodies in the cells around a rectangle, with true for those whose homes overlap it. A
    /// stray is visited with each of its homes, also the earlier ones.
    pub fn visit_near(&self, rectangle: &SweptAabb, mut visit: impl FnMut(Slot, bool)) {
        let margin = self.side * MAX_CENTRE_DISTANCE;
        let [low, high] = rectangle.corners();
        let first = self.bucket(low.map(|coordinate| coordinate - margin));
        let last = self.bucket(high.map(|coordinate| coordinate + margin));
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
        let index = |axis: Axis| smaller((point[axis] - self.origin[axis]) / self.side, self.last[axis]) as u32;
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
    use std::num::NonZero;

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
            assert!(
                grid.sort(side, &slots, |slot| &homes[slot as usize], &mut large, Threads::new(None)) && large == [50]
            );
            let overlap = |[a, b]: [Slot; 2]| !homes[a as usize].is_disjoint_from(&homes[b as usize]);
            let all = (0..100).flat_map(|a| (0..100).map(move |b| [a, b])).filter(|pair| !pair.contains(&50));
            let expected: Vec<[Slot; 2]> = all.filter(|pair| pair[0] != pair[1] && overlap(*pair)).collect();
            for bodies_per_band in [1, 20, 1000] {
                let (mut bands, mut ends, mut members) = (Vec::new(), Vec::new(), Vec::new());
                grid.divide(bodies_per_band, &mut bands);
                grid.make_lists(0.0, &mut bands, &mut ends, &mut members, Threads::new(NonZero::new(3)), |_, _| ());
                let starts = ends.iter().map(|start| *start as usize);
                let lists = starts.clone().zip(starts.skip(1).chain([members.len()])).zip(&grid.slots);
                let mut pairs: Vec<[Slot; 2]> = lists
                    .flat_map(|((start, end), slot)| members[start..end].iter().map(|other| [*slot, *other]))
                    .collect();
                pairs.sort_unstable();
                assert_eq!(pairs, expected);
            }
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
        assert!(grid.sort(2.0, &[0, 1], |slot| &homes[slot as usize], &mut large, Threads::new(None)));
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
            let bodies = Vec::from_iter(0..bodies);
            let home = |slot: Slot| &homes[slot as usize];
            HomeGrid::default().sort(1.0, &bodies, home, &mut Vec::new(), Threads::new(None))
        };
        assert!(pays(1000, 1.0) && !pays(1000, 5.0) && !pays(1000, 1e-4));
    }
}
