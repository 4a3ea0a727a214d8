use super::SpawnRequest;
use crate::physics::{Rect, Vector};

/// The four walls just outside the world: infinite masses 1 m thick.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Walls {
    /// What they are made of.
    pub material: Option<String>,
}

impl Walls {
    /// The bodies they are around a world of that size, in creation order: top, bottom, left, right.
    ///
    /// The horizontal ones reach over the corners.
    pub fn requests(&self, [width, height]: [f64; 2]) -> [SpawnRequest; 4] {
        [
            self.request("wall-top", Rect::new(Vector::new(-1.0, -1.0), width + 2.0, 1.0)),
            self.request("wall-bottom", Rect::new(Vector::new(-1.0, height), width + 2.0, 1.0)),
            self.request("wall-left", Rect::new(Vector::new(-1.0, 0.0), 1.0, height)),
            self.request("wall-right", Rect::new(Vector::new(width, 0.0), 1.0, height)),
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
