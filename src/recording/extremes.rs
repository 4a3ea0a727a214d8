use crate::physics::{Rect, Vector};

use super::KnownBody;

/// What no state of a run exceeds: pictures drawn apart need it to be on one scale.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extremes {
    /// The highest speed of any body, m/s.
    pub top_speed: f64,
    /// The least rectangle that holds all bodies of finite mass; none if there never is one.
    pub reach: Option<Reach>,
}

/// A rectangle by two of its corners, so that it does not matter in which order it grew.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// The upper-left corner, m.
    pub near: Vector,
    /// The corner opposite to it, m.
    pub far: Vector,
}

impl Extremes {
    /// Takes in a body of a state: x, y (m), vx, vy (m/s).
    pub fn see(&mut self, known: &KnownBody, [x, y, vx, vy]: [f64; 4]) {
        let speed = Vector::new(vx, vy).norm();
        if speed > self.top_speed {
            self.top_speed = speed;
        }
        if known.spawn.mass == f64::INFINITY {
            return;
        }
        let size = &known.spawn.rect;
        let body = Reach::of(&Rect::new(Vector::new(x, y), size.width(), size.height()));
        if body.near.is_finite() && body.far.is_finite() {
            self.reach = Some(self.reach.map_or(body, |reach| reach.with(&body)));
        }
    }
}

impl Reach {
    /// That of one rectangle.
    pub fn of(rect: &Rect) -> Reach {
        Reach { near: rect.origin, far: rect.far_corner() }
    }

    /// The rectangle.
    pub fn rect(&self) -> Rect {
        Rect::new(self.near, self.far.x - self.near.x, self.far.y - self.near.y)
    }

    fn with(&self, other: &Reach) -> Reach {
        let smaller = |a, b| if b < a { b } else { a };
        let larger = |a, b| if b > a { b } else { a };
        Reach {
            near: Vector::new(smaller(self.near.x, other.near.x), smaller(self.near.y, other.near.y)),
            far: Vector::new(larger(self.far.x, other.far.x), larger(self.far.y, other.far.y)),
        }
    }
}
