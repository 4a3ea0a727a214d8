use crate::physics::Rect;

/// The boxes that stand in a region, found by place: a grid of cells with the boxes that reach into each.
pub struct Room {
    region: Rect,
    columns: usize,
    rows: usize,
    /// Row by row, the boxes that reach into each cell.
    cells: Vec<Vec<Rect>>,
    /// The boxes that reach into more cells than is worth writing into each.
    wide: Vec<Rect>,
}

/// Boxes that reach into more cells than this are looked at one by one instead.
const WIDE: usize = 64;

impl Room {
    /// An empty region for about `count` boxes up to the given extents, m.
    ///
    /// Cells are no smaller than a box, so that it reaches into few, and no more than boxes.
    pub fn new(region: Rect, [width, height]: [f64; 2], count: u64) -> Room {
        let most = count.isqrt() as usize + 1;
        let columns = ((region.width() / width) as usize).clamp(1, most);
        let rows = ((region.height() / height) as usize).clamp(1, most);
        Room { region, columns, rows, cells: vec![Vec::new(); columns * rows], wide: Vec::new() }
    }

    /// Puts a box in, whatever stands there.
    pub fn insert(&mut self, rect: Rect) {
        let cells: Vec<usize> = self.cells_of(&rect).take(WIDE + 1).collect();
        if cells.len() > WIDE {
            self.wide.push(rect);
            return;
        }
        for cell in cells {
            self.cells[cell].push(rect);
        }
    }

    /// Whether a box there would overlap none that is in; touching is no overlap.
    pub fn is_free(&self, rect: &Rect) -> bool {
        let near = self.cells_of(rect).flat_map(|cell| &self.cells[cell]);
        !near.chain(&self.wide).any(|other| overlap(rect, other))
    }

    /// The cells a box reaches into. What lies outside the region counts to the cells at its
    /// border: overlapping boxes still share a cell.
    fn cells_of(&self, rect: &Rect) -> impl Iterator<Item = usize> + use<> {
        let (near, far) = (rect.origin, rect.far_corner());
        let column = |x: f64| cell(x - self.region.origin.x, self.region.width(), self.columns);
        let row = |y: f64| cell(y - self.region.origin.y, self.region.height(), self.rows);
        let (columns, all) = (column(near.x)..=column(far.x), self.columns);
        (row(near.y)..=row(far.y)).flat_map(move |row| columns.clone().map(move |column| row * all + column))
    }
}

/// Which of `count` cells along an extent holds the offset; monotone, so that order is kept.
fn cell(offset: f64, extent: f64, count: usize) -> usize {
    // The cast takes what is below 0 to 0 and what is too large to the largest.
    ((offset / (extent / count as f64)) as usize).min(count - 1)
}

/// Whether two boxes share more than a border.
pub fn overlap(a: &Rect, b: &Rect) -> bool {
    let (a_far, b_far) = (a.far_corner(), b.far_corner());
    a.origin.x < b_far.x && b.origin.x < a_far.x && a.origin.y < b_far.y && b.origin.y < a_far.y
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
        let mut room = Room::new(rect(0.0, 0.0, 16.0, 9.0), [1.0, 1.0], 100);
        room.insert(rect(4.0, 4.0, 1.0, 1.0));
        assert!(room.is_free(&rect(5.0, 4.0, 1.0, 1.0)), "side by side");
        assert!(room.is_free(&rect(5.0, 5.0, 1.0, 1.0)), "corner to corner");
        assert!(!room.is_free(&rect(4.9, 4.9, 1.0, 1.0)));
    }

    #[test]
    fn a_wall_along_the_border_is_seen_everywhere() {
        let mut room = Room::new(rect(0.0, 0.0, 1000.0, 1000.0), [0.1, 0.1], 1_000_000);
        room.insert(rect(-1.0, -1.0, 1002.0, 1.05));
        assert!(!room.is_free(&rect(700.0, 0.0, 0.1, 0.1)));
        assert!(room.is_free(&rect(700.0, 0.06, 0.1, 0.1)));
    }
}
