use super::{
    Walls, action,
    diagnostics::Reported,
    tree::{Key, Node, Table},
};
use crate::physics::Vector;
use std::ops::Range;

/// The `[world]` table of a scene. A value that could not be read is an error.
pub struct WorldOptions {
    /// Width and height of the visible world, m.
    pub size: Result<[f64; 2], Reported>,
    /// The walls and the location of their key.
    pub walls: Result<Option<(Walls, Range<usize>)>, Reported>,
    /// Gravity, m/s².
    pub gravity: Result<Option<Vector>, Reported>,
}

/// Width and height of the world of a scene that gives none, m.
pub const DEFAULT_SIZE: [f64; 2] = [16.0, 9.0];

const SIZE: Key = Key { name: "size", accepts: "two positive finite extents, m" };
const WALLS: Key = Key { name: "walls", accepts: "true or false" };
const WALL_MATERIAL: Key = Key { name: "wall_material", accepts: action::MATERIAL.accepts };
const GRAVITY: Key = Key { name: "gravity", accepts: "two finite numbers, m/s²" };

/// The keys of `[world]`.
pub const KEYS: &[Key] = &[SIZE, WALLS, WALL_MATERIAL, GRAVITY];

impl Default for WorldOptions {
    fn default() -> WorldOptions {
        WorldOptions { size: Ok(DEFAULT_SIZE), walls: Ok(None), gravity: Ok(None) }
    }
}

impl WorldOptions {
    /// The options of a table that could not be read.
    pub fn unreadable(reported: Reported) -> WorldOptions {
        WorldOptions { size: Err(reported), walls: Err(reported), gravity: Err(reported) }
    }
}

/// Reads `[world]`.
pub fn read(table: &Table) -> WorldOptions {
    let size = table.optional(SIZE, Node::size).map(|size| size.unwrap_or(DEFAULT_SIZE));
    let material = table.optional(WALL_MATERIAL, action::material).map(|material| material.map(String::from));
    let walls = table.get(WALLS).and_then(|field| {
        let Some(field) = field else { return Ok(None) };
        let has_walls = field.read(Node::boolean)?;
        Ok(if has_walls { Some((Walls { material: material? }, field.node.span.clone())) } else { None })
    });
    WorldOptions { size, walls, gravity: table.optional(GRAVITY, Node::vector) }
}
