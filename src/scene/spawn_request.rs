use crate::physics::{Rect, Spawn, Vector};

/// A body to be, with its place; the run gives it a name if it has none.
#[derive(Clone, Debug, PartialEq)]
pub struct SpawnRequest {
    /// Unique while alive; does not begin with `#`.
    pub name: Option<String>,
    /// First position and lifelong size, m; extents positive, corners finite.
    pub rect: Rect,
    /// kg, positive; infinity for what is never pushed.
    pub mass: f64,
    /// First velocity, m/s.
    pub velocity: Vector,
    /// Constant force, N.
    pub force: Vector,
    /// Name of its material; empty for none.
    pub material: String,
    /// Its colour in pictures, `#rrggbb`.
    pub color: Option<String>,
}

impl SpawnRequest {
    /// The physics' spawn of this body under the name it got.
    pub fn spawn(&self, name: String) -> Spawn {
        Spawn {
            name,
            rect: self.rect,
            mass: self.mass,
            velocity: self.velocity,
            force: self.force,
            material: self.material.clone(),
        }
    }
}

/// A body to be that has no place yet: what a click spawns.
#[derive(Clone, Debug, PartialEq)]
pub struct Blueprint {
    /// Unique while alive; does not begin with `#`.
    pub name: Option<String>,
    /// Width and height, m; positive.
    pub size: [f64; 2],
    /// kg, positive; infinity for what is never pushed.
    pub mass: f64,
    /// First velocity, m/s.
    pub velocity: Vector,
    /// Constant force, N.
    pub force: Vector,
    /// Name of its material; empty for none.
    pub material: String,
    /// Its colour in pictures, `#rrggbb`.
    pub color: Option<String>,
}

impl Blueprint {
    /// The body with its upper-left corner at `corner`.
    pub fn placed_at(self, corner: Vector) -> SpawnRequest {
        let Blueprint { name, size: [width, height], mass, velocity, force, material, color } = self;
        SpawnRequest { name, rect: Rect::new(corner, width, height), mass, velocity, force, material, color }
    }

    /// The body with its middle at `point`.
    pub fn centered_on(self, point: Vector) -> SpawnRequest {
        let half = Vector::new(self.size[0], self.size[1]).mult(0.5);
        self.placed_at(point.sub(half))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_click_spawns_around_its_point() {
        let blueprint = Blueprint {
            name: None,
            size: [1.0, 2.0],
            mass: 1.0,
            velocity: Vector::ZERO,
            force: Vector::ZERO,
            material: String::new(),
            color: None,
        };
        let request = blueprint.centered_on(Vector::new(4.0, 5.0));
        assert_eq!(request.rect, Rect::new(Vector::new(3.5, 4.0), 1.0, 2.0));
        assert_eq!(request.rect.center(), Vector::new(4.0, 5.0));
    }
}
