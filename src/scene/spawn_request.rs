use crate::physics::{Rect, Spawn, Vector};

/// A body to spawn. The run names it `#K` if it has no name.
#[derive(Clone, Debug, PartialEq)]
pub struct SpawnRequest {
    /// Unique among the bodies alive; does not begin with `#`.
    pub name: Option<String>,
    /// Initial position and constant size, m; extents positive, corners finite.
    pub rect: Rect,
    /// Mass, kg; positive, infinite for a body that nothing can push.
    pub mass: f64,
    /// Initial velocity, m/s.
    pub velocity: Vector,
    /// Constant force, N.
    pub force: Vector,
    /// Name of the material; empty for none.
    pub material: String,
    /// Colour in pictures, `#rrggbb`.
    pub color: Option<String>,
}

impl SpawnRequest {
    /// Converts the request to a spawn event of the physics under the given name.
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

/// A body without a position, which a click spawns.
#[derive(Clone, Debug, PartialEq)]
pub struct Blueprint {
    /// Unique among the bodies alive; does not begin with `#`.
    pub name: Option<String>,
    /// Width and height, m; positive.
    pub size: [f64; 2],
    /// Mass, kg; positive, infinite for a body that nothing can push.
    pub mass: f64,
    /// Initial velocity, m/s.
    pub velocity: Vector,
    /// Constant force, N.
    pub force: Vector,
    /// Name of the material; empty for none.
    pub material: String,
    /// Colour in pictures, `#rrggbb`.
    pub color: Option<String>,
}

impl Blueprint {
    /// Places the upper-left corner at `corner`.
    pub fn placed_at(self, corner: Vector) -> SpawnRequest {
        let Blueprint { name, size: [width, height], mass, velocity, force, material, color } = self;
        SpawnRequest { name, rect: Rect::new(corner, width, height), mass, velocity, force, material, color }
    }

    /// Places the centre at `point`.
    pub fn centered_on(self, point: Vector) -> SpawnRequest {
        let half = Vector::new(self.size[0], self.size[1]).mult(0.5);
        self.placed_at(point.sub(half))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_blueprint_is_centred_on_the_point_of_a_click() {
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
