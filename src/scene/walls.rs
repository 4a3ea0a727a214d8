use super::SpawnRequest;
use crate::physics::{Rect, Vector};

/// The four static walls just outside the world, each 1 m thick.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Walls {
    /// The material of the walls.
    pub material: Option<String>,
}

/// The names of the walls, in creation order.
pub const WALL_NAMES: [&str; 4] = ["wall-top", "wall-bottom", "wall-left", "wall-right"];

impl Walls {
    /// The wall bodies around a world of that size, m, in creation order.
    ///
    /// The horizontal walls cover the corners.
    pub fn spawn_requests(&self, [width, height]: [f64; 2]) -> [SpawnRequest; 4] {
        let [top, bottom, left, right] = WALL_NAMES;
        [
            self.request(top, Rect::new(Vector::new(-1.0, -1.0), width + 2.0, 1.0)),
            self.request(bottom, Rect::new(Vector::new(-1.0, height), width + 2.0, 1.0)),
            self.request(left, Rect::new(Vector::new(-1.0, 0.0), 1.0, height)),
            self.request(right, Rect::new(Vector::new(width, 0.0), 1.0, height)),
        ]
    }

    fn request(&self, name: &str, rect: Rect) -> SpawnRequest {
        SpawnRequest {
            name: Some(name.into()),
            rect,
            mass: f64::INFINITY,
            velocity: Vector::ZERO,
            force: Vector::ZERO,
            material: self.material.clone().unwrap_or_default(),
            color: None,
        }
    }
}
