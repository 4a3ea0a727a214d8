use crate::physics::{Rect, Vector};

/// What a camera is aimed at.
#[derive(Clone, Debug, PartialEq)]
pub enum Aim {
    /// The world, whole.
    World,
    /// A part of the plane, m; more of it is seen where the picture has another shape.
    Window(Rect),
    /// A body: it stays in the middle.
    Follow {
        /// Its name.
        name: String,
        /// Width and height of what is seen around it, m.
        size: Vector,
    },
}

impl Aim {
    /// The body that is followed, if any.
    pub fn follows(&self) -> Option<&str> {
        match self {
            Aim::Follow { name, .. } => Some(name),
            Aim::World | Aim::Window(_) => None,
        }
    }
}
