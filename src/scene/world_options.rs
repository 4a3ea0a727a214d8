use std::ops::Range;

use super::{
    Walls, action,
    refusal::Refusal,
    tree::{Key, Node, Table},
};
use crate::physics::Vector;

/// The scene's `[world]`.
pub struct WorldOptions {
    /// m.
    pub size: [f64; 2],
    /// The walls and where they are asked for.
    pub walls: Option<(Walls, Range<usize>)>,
    /// m/s².
    pub gravity: Option<Vector>,
}

const SIZE: Key = Key { name: "size", accepts: "two positive finite extents, m" };
const WALLS: Key = Key { name: "walls", accepts: "true or false" };
const WALL_MATERIAL: Key = Key { name: "wall_material", accepts: action::MATERIAL.accepts };
const GRAVITY: Key = Key { name: "gravity", accepts: "two finite numbers, m/s²; y points down" };

pub fn read(node: &Node) -> Result<WorldOptions, Refusal> {
    let table = Table::open("world", node, &[SIZE, WALLS, WALL_MATERIAL, GRAVITY])?;
    let material = table.optional(WALL_MATERIAL, action::material)?.map(String::from);
    let walls = match table.get(WALLS) {
        Some(field) if field.read(Node::boolean)? => Some((Walls { material }, field.node.span.clone())),
        Some(_) | None => None,
    };
    Ok(WorldOptions { size: table.required(SIZE, Node::size)?, walls, gravity: table.optional(GRAVITY, Node::vector)? })
}
