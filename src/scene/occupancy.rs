use crate::physics::Rect;

/// The rectangles in a region, in a uniform grid: each cell lists the rectangles that intersect it.
pub struct OccupancyGrid {
    region: Rect,
    columns: usize,
    rows: usize,
    /// The rectangles of each cell, in row-major order.
    cells: Vec<Vec<Rect>>,
    /// The rectangles that intersect more than [`MAX_CELLS`] cells.
    oversized: Vec<Rect>,
}

/// A rectangle that intersects more cells is kept in one list and tested directly.
const MAX_CELLS: usize = 64;

impl OccupancyGrid {
    /// An empty grid for about `count` rectangles up to the given extents, m.
    ///
    /// A cell is no smaller than the largest rectangle, and there are not many more cells than rectangles.
    pub fn new(region: Rect, [width, height]: [f64; 2], count: u64) -> OccupancyGrid {
        let max_cells = count.isqrt() as usize + 1;
        let columns = ((region.width() / width) as usize).clamp(1, max_cells);
        let rows = ((region.height() / height) as usize).clamp(1, max_cells);
        OccupancyGrid { region, columns, rows, cells: vec![Vec::new(); columns * rows], oversized: Vec::new() }
    }

    /// Adds a rectangle, which may overlap others.
    pub fn insert(&mut self, rect: Rect) {
        let cells: Vec<usize> = self.cells_of(&rect).take(MAX_CELLS + 1).collect();
        if cells.len() > MAX_CELLS {
            self.oversized.push(rect);
            return;
        }
        for cell in cells {
            self.cells[cell].push(rect);
        }
    }

    /// Returns true if the rectangle overlaps none in the grid; touching is not overlapping.
    pub fn is_free(&self, rect: &Rect) -> bool {
        let candidates = self.cells_of(rect).flat_map(|cell| &self.cells[cell]);
        !candidates.chain(&self.oversized).any(|other| rect.overlaps(other))
    }

    /// The cells that a rectangle intersects. Positions outside the region belong to the nearest border
    /// cells, so that overlapping rectangles always share a cell.
    fn cells_of(&self, rect: &Rect) -> impl Iterator<Item = usize> + use<> {
        let (near, far) = (rect.origin, rect.far_corner());
        let column = |x: f64| cell(x - self.region.origin.x, self.region.width(), self.columns);
        let row = |y: f64| cell(y - self.region.origin.y, self.region.height(), self.rows);
        let (columns, stride) = (column(near.x)..=column(far.x), self.columns);
        (row(near.y)..=row(far.y)).flat_map(move |row| columns.clone().map(move |column| row * stride + column))
    }
}

/// The index of the cell that contains the offset, among `count` cells along an extent; monotone in the offset.
fn cell(offset: f64, extent: f64, count: usize) -> usize {
    // The cast saturates: negative offsets give 0.
    ((offset / (extent / count as f64)) as usize).min(count - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::Vector;

    fn rect(x: f64, y: f64, width: f64, height: f64) -> Rect {
        Rect::new(Vector::new(x, y), width, height)
    }

    #[test]
    fn touching_is_free_and_overlapping_is_not() {
        let mut grid = OccupancyGrid::new(rect(0.0, 0.0, 16.0, 9.0), [1.0, 1.0], 100);
        grid.insert(rect(4.0, 4.0, 1.0, 1.0));
        assert!(grid.is_free(&rect(5.0, 4.0, 1.0, 1.0)), "side by side");
        assert!(grid.is_free(&rect(5.0, 5.0, 1.0, 1.0)), "corner to corner");
        assert!(!grid.is_free(&rect(4.9, 4.9, 1.0, 1.0)));
    }

    #[test]
    fn a_wall_along_the_border_is_found_along_all_of_it() {
        let mut grid = OccupancyGrid::new(rect(0.0, 0.0, 1000.0, 1000.0), [0.1, 0.1], 1_000_000);
        grid.insert(rect(-1.0, -1.0, 1002.0, 1.05));
        assert!(!grid.is_free(&rect(700.0, 0.0, 0.1, 0.1)));
        assert!(grid.is_free(&rect(700.0, 0.06, 0.1, 0.1)));
    }
}
