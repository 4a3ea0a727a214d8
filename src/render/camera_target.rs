use crate::physics::{Rect, Vector};

/// The part of the world that a camera shows.
#[derive(Clone, Debug, PartialEq)]
pub enum CameraTarget {
    /// The whole world.
    World,
    /// A rectangle of the plane, m. More is visible if the picture has a different aspect ratio.
    Window(Rect),
    /// The surroundings of a body, which stays in the middle.
    Follow {
        /// Name of the body.
        name: String,
        /// Width and height of the visible area around it, m.
        size: Vector,
    },
}

impl CameraTarget {
    /// The name of the body that the camera follows, if any.
    pub fn followed_body(&self) -> Option<&str> {
        match self {
            CameraTarget::Follow { name, .. } => Some(name),
            CameraTarget::World | CameraTarget::Window(_) => None,
        }
    }
}
