use super::{Axis, Vector, larger, smaller};

/// An axis-aligned rectangle with a variable position and a fixed size.
#[doc(alias("aabb", "bounding box"))]
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

    /// The centre of the rectangle, m.
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

    /// The ends of the rectangle along an axis: its origin and its far corner, m.
    pub const fn along(&self, axis: Axis) -> [f64; 2] {
        match axis {
            Axis::X => [self.origin.x, self.origin.x + self.width],
            Axis::Y => [self.origin.y, self.origin.y + self.height],
        }
    }

    /// The smallest rectangle that contains both.
    pub const fn union(&self, other: &Rect) -> Rect {
        let near = self.origin.min(other.origin);
        let size = self.far_corner().max(other.far_corner()).sub(near);
        Rect::new(near, size.x, size.y)
    }

    /// The intersection of two rectangles, if it has a positive area.
    pub fn intersection(&self, other: &Rect) -> Option<Rect> {
        let (near, far) = (self.origin.max(other.origin), self.far_corner().min(other.far_corner()));
        (near.x < far.x && near.y < far.y).then(|| Rect::new(near, far.x - near.x, far.y - near.y))
    }

    /// The length over which two rectangles overlap along an axis, m; if they are apart, the width of the gap, negated.
    pub const fn overlap_along(&self, axis: Axis, other: &Rect) -> f64 {
        let ([low, high], [other_low, other_high]) = (self.along(axis), other.along(axis));
        smaller(high, other_high) - larger(low, other_low)
    }

    /// True if the interiors of two rectangles intersect; touching is not overlapping.
    pub const fn overlaps(&self, other: &Rect) -> bool {
        let (far, other_far) = (self.far_corner(), other.far_corner());
        self.origin.x < other_far.x && other.origin.x < far.x && self.origin.y < other_far.y && other.origin.y < far.y
    }

    /// True if `inner` lies within this rectangle; borders may touch.
    pub const fn contains(&self, inner: &Rect) -> bool {
        let (near, far, end) = (inner.origin, inner.far_corner(), self.far_corner());
        self.origin.x <= near.x && self.origin.y <= near.y && far.x <= end.x && far.y <= end.y
    }

    /// The rectangle shrunk by `by` on every side; expanded if `by` is negative.
    pub const fn inset(&self, by: f64) -> Rect {
        Rect::new(self.origin.add(Vector::new(by, by)), self.width - 2.0 * by, self.height - 2.0 * by)
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

/// The least extent at which faces stay distinct, m: three units in the last place of the coordinates, one more than
/// the difference at which faces are made to coincide.
const fn extent_resolution(near: f64, far: f64) -> f64 {
    let (near, far) = (near.abs(), far.abs());
    larger(near, far) * (3.0 * f64::EPSILON)
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

    #[test]
    fn rectangles_that_touch_do_not_overlap() {
        let beside = Rect::new(Vector::new(4.0, 2.0), 1.0, 1.0);
        assert!(!C.overlaps(&beside) && C.intersection(&beside).is_none());
        assert_eq!([C.overlap_along(Axis::X, &beside), C.overlap_along(Axis::Y, &beside)], [0.0, 1.0]);
    }

    #[test]
    fn the_union_contains_and_the_intersection_is_contained_in_both() {
        let other = Rect::new(Vector::new(2.0, 1.0), 5.0, 1.5);
        let (union, intersection) = (C.union(&other), C.intersection(&other).unwrap());
        assert_eq!(union, Rect::new(Vector::new(1.0, 1.0), 6.0, 2.0));
        assert_eq!(intersection, Rect::new(Vector::new(2.0, 2.0), 2.0, 0.5));
        assert!([C, other].iter().all(|rect| union.contains(rect) && rect.contains(&intersection)));
        assert_eq!(C.inset(0.25).inset(-0.25), C);
        assert_eq!([C.along(Axis::X), C.along(Axis::Y)], [[1.0, 4.0], [2.0, 3.0]]);
    }
}
