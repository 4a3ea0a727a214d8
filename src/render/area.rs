//! Operations on rectangles, mostly of a page in px.

use crate::physics::{Rect, Vector};

/// The intersection of two rectangles, if it has a positive area.
pub fn intersection(a: &Rect, b: &Rect) -> Option<Rect> {
    let (far_a, far_b) = (a.far_corner(), b.far_corner());
    let x = [larger(a.origin.x, b.origin.x), smaller(far_a.x, far_b.x)];
    let y = [larger(a.origin.y, b.origin.y), smaller(far_a.y, far_b.y)];
    (x[0] < x[1] && y[0] < y[1]).then(|| Rect::new(Vector::new(x[0], y[0]), x[1] - x[0], y[1] - y[0]))
}

/// The smallest rectangle that contains both.
pub fn union(a: &Rect, b: &Rect) -> Rect {
    let (far_a, far_b) = (a.far_corner(), b.far_corner());
    let near = Vector::new(smaller(a.origin.x, b.origin.x), smaller(a.origin.y, b.origin.y));
    Rect::new(near, larger(far_a.x, far_b.x) - near.x, larger(far_a.y, far_b.y) - near.y)
}

/// The rectangle shrunk by `by` on every side.
pub fn inset(rect: &Rect, by: f64) -> Rect {
    Rect::new(rect.origin.add(Vector::new(by, by)), rect.width() - 2.0 * by, rect.height() - 2.0 * by)
}

/// Returns true if `inner` lies within `outer`; borders may touch.
pub fn contains(outer: &Rect, inner: &Rect) -> bool {
    let (near, far) = (inner.origin, inner.far_corner());
    let (low, high) = (outer.origin, outer.far_corner());
    low.x <= near.x && low.y <= near.y && far.x <= high.x && far.y <= high.y
}

/// The larger of two numbers; `b` if either is NaN.
pub const fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The smaller of two numbers; `b` if either is NaN.
pub const fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}
