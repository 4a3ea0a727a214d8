use super::Vector;

/// An axis-aligned rectangle with a variable position and a fixed size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// The upper-left corner, m.
    pub origin: Vector,
    width: f64,
    height: f64,
}

impl Rect {
    /// The rectangle with upper-left corner `origin` and the given size, m.
    pub const fn new(origin: Vector, width: f64, height: f64) -> Rect {
        Rect { origin, width, height }
    }

    /// The extent along x, m.
    pub const fn width(&self) -> f64 {
        self.width
    }

    /// The extent along y, m.
    pub const fn height(&self) -> f64 {
        self.height
    }

    /// The lower-right corner, m.
    pub const fn far_corner(&self) -> Vector {
        Vector::new(self.origin.x + self.width, self.origin.y + self.height)
    }

    /// The center of the rectangle, m.
    pub const fn center(&self) -> Vector {
        Vector::new(self.origin.x + self.width / 2.0, self.origin.y + self.height / 2.0)
    }

    /// True if both extents are more than a few units in the last place of the coordinates.
    pub const fn is_resolved(&self) -> bool {
        let far = self.far_corner();
        self.width > extent_resolution(self.origin.x, far.x) && self.height > extent_resolution(self.origin.y, far.y)
    }

    /// Moves the origin by `v` (the handout's `move`).
    pub const fn move_by(&mut self, v: Vector) {
        self.origin = self.origin.add(v);
    }

    /// The Minkowski difference r ⊖ c of `r` and this rectangle c (the handout's `mDiff`).
    ///
    /// It contains the origin if and only if the two rectangles overlap or touch.
    pub const fn minkowski_difference(&self, r: &Rect) -> Rect {
        let c = self;
        let x = r.origin.x - c.origin.x - c.width;
        let y = r.origin.y - c.origin.y - c.height;
        Rect::new(Vector::new(x, y), r.width + c.width, r.height + c.height)
    }

    /// True if the rectangle, including its border, contains the point (0, 0).
    pub const fn has_origin(&self) -> bool {
        self.has_point(Vector::ZERO)
    }

    /// True if the rectangle, including its border, contains the point `p`.
    pub const fn has_point(&self, p: Vector) -> bool {
        let far = self.far_corner();
        self.origin.x <= p.x && p.x <= far.x && self.origin.y <= p.y && p.y <= far.y
    }
}

/// The least extent that coordinates resolve: more than what makes faces coincide, three units in the last place.
const fn extent_resolution(near: f64, far: f64) -> f64 {
    let (near, far) = (near.abs(), far.abs());
    (if near > far { near } else { far }) * (3.0 * f64::EPSILON)
}

#[cfg(test)]
mod tests {
    use super::*;

    const C: Rect = Rect::new(Vector::new(1.0, 2.0), 3.0, 1.0);

    #[test]
    fn moving_keeps_the_size() {
        let mut c = C;
        c.move_by(Vector::new(0.5, -1.0));
        assert_eq!((c.origin, c.width(), c.height()), (Vector::new(1.5, 1.0), 3.0, 1.0));
    }

    #[test]
    fn minkowski_difference_follows_the_printed_formula() {
        let r = Rect::new(Vector::new(3.0, 2.5), 2.0, 2.0);
        let s = C.minkowski_difference(&r);
        assert_eq!(s, Rect::new(Vector::new(-1.0, -0.5), 5.0, 3.0));
    }

    #[test]
    fn minkowski_difference_contains_the_origin_iff_the_rectangles_overlap_or_touch() {
        let apart = Rect::new(Vector::new(4.1, 2.0), 1.0, 1.0);
        let touching = Rect::new(Vector::new(4.0, 2.0), 1.0, 1.0);
        let corner = Rect::new(Vector::new(4.0, 3.0), 1.0, 1.0);
        assert!(!C.minkowski_difference(&apart).has_origin());
        assert!(C.minkowski_difference(&touching).has_origin());
        assert!(C.minkowski_difference(&corner).has_origin());
    }
}
