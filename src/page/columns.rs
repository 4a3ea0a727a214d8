use rebond::internals::picture::{Color, body_color, color_by_speed};
use rebond::internals::scene::Walls;
use rebond::recordings::{BodyInfo, Paint};
use rebond::{BodyId, Collision, Rect, Vector};

/// Numbers of a body for the canvas: id, x, y, width, height, vx, vy, mass, colour, and
/// 1 for a wall.
pub const BODY_COLUMNS: usize = 10;

/// Numbers of a collision: the ids of c and b, the normal, e, the impulse, vn before and after, the instant, the
/// penetration, both rectangles, and the shares Nc and Nb.
pub const COLLISION_COLUMNS: usize = 21;

/// The property that determines the colours of bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColorKey {
    /// The body.
    Body,
    /// The material.
    Material,
    /// The speed.
    Speed,
}

/// Appends the columns of a body.
pub fn push_body(
    columns: &mut Vec<f64>,
    info: &BodyInfo,
    rect: &Rect,
    velocity: Vector,
    key: ColorKey,
    top_speed: f64,
    materials: &[&str],
) {
    let spawn = &info.spawn;
    let is_wall = info.paint.is_empty() && Walls::is_wall(info.id, spawn);
    let numbered = |id: BodyId| body_color(&BodyInfo { id, paint: Paint::default(), ..info.clone() });
    let Color { r, g, b } = match key {
        ColorKey::Speed if spawn.mass.is_finite() && top_speed > 0.0 => color_by_speed(velocity.norm(), top_speed),
        // Pictures number the materials so, too.
        ColorKey::Material if !is_wall => match materials.iter().position(|name| *name == spawn.material) {
            Some(index) => numbered(index as BodyId + 4),
            None => Color::hex(0x999999),
        },
        ColorKey::Body | ColorKey::Material | ColorKey::Speed => body_color(info),
    };
    let color = f64::from(u32::from_be_bytes([0, r, g, b]));
    let Vector { x, y, .. } = rect.origin;
    columns.extend([f64::from(info.id), x, y, rect.width(), rect.height(), velocity.x, velocity.y, spawn.mass]);
    columns.extend([color, f64::from(u8::from(is_wall))]);
}

/// Appends the columns of a collision.
pub fn push_collision(columns: &mut Vec<f64>, collision: &Collision) {
    let Collision {
        bodies: [c, b],
        normal,
        restitution,
        impulse,
        normal_velocity,
        instant,
        penetration,
        rects,
        shares,
        ..
    } = collision;
    columns.extend([f64::from(*c), f64::from(*b), normal.x, normal.y, *restitution, *impulse]);
    columns.extend(normal_velocity.iter().chain([instant, &penetration.x, &penetration.y]));
    for rect in rects {
        columns.extend([rect.origin.x, rect.origin.y, rect.width(), rect.height()]);
    }
    columns.extend(shares);
}
