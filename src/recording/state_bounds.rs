use crate::physics::{Rect, Vector};

use super::BodyInfo;

/// Bounds of all states of a run, so that pictures drawn separately can share one scale.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StateBounds {
    /// The highest speed of any body, m/s.
    pub top_speed: f64,
    /// The bounding box of all bodies of finite mass; `None` if there never is one.
    pub bounds: Option<Bounds>,
}

/// A rectangle stored as two corners, so that the result does not depend on the order of unions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The upper-left corner, m.
    pub near: Vector,
    /// The lower-right corner, m.
    pub far: Vector,
}

impl StateBounds {
    /// Extends the bounds by a body in a state: x, y (m), vx, vy (m/s).
    pub fn include(&mut self, info: &BodyInfo, [x, y, vx, vy]: [f64; 4]) {
        let speed = Vector::new(vx, vy).norm();
        if speed > self.top_speed {
            self.top_speed = speed;
        }
        if info.spawn.mass == f64::INFINITY {
            return;
        }
        let size = &info.spawn.rect;
        let body = Bounds::of(&Rect::new(Vector::new(x, y), size.width(), size.height()));
        if body.near.is_finite() && body.far.is_finite() {
            self.bounds = Some(self.bounds.map_or(body, |bounds| bounds.union(&body)));
        }
    }
}

impl Bounds {
    /// Returns the bounds of one rectangle.
    pub fn of(rect: &Rect) -> Bounds {
        Bounds { near: rect.origin, far: rect.far_corner() }
    }

    /// Returns the bounds as a rectangle.
    pub fn rect(&self) -> Rect {
        Rect::new(self.near, self.far.x - self.near.x, self.far.y - self.near.y)
    }

    fn union(&self, other: &Bounds) -> Bounds {
        let smaller = |a, b| if b < a { b } else { a };
        let larger = |a, b| if b > a { b } else { a };
        Bounds {
            near: Vector::new(smaller(self.near.x, other.near.x), smaller(self.near.y, other.near.y)),
            far: Vector::new(larger(self.far.x, other.far.x), larger(self.far.y, other.far.y)),
        }
    }
}
