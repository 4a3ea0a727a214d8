use std::ops::Range;

use super::{
    Blueprint, SpawnRequest,
    refusal::Refusal,
    tree::{Field, Key, Node, Table},
};
use crate::physics::Vector;

/// What can be done to the world.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// One of the four walls comes into being; the numbering of bodies passes over it.
    Wall(SpawnRequest),
    /// A body comes into being: the next in the numbering, named or not.
    Spawn(SpawnRequest),
    /// The body of that name goes; it has to be alive then.
    Delete {
        /// Its name, or `#K` for the K-th body spawned in the run.
        name: String,
    },
    /// The handout's mouse: the body of finite mass created last that covers the point goes;
    /// only if there is none, one is spawned.
    Click {
        /// The point, m.
        at: Vector,
        /// What to spawn, centred on the point; nothing if absent.
        spawn: Option<Blueprint>,
    },
}

/// An action as it stands in a text.
pub struct Request {
    /// The step it names and where.
    pub step: Option<(u64, Range<usize>)>,
    pub action: Action,
    /// What to point at if it cannot be done: the name it gives or takes, else its table.
    pub place: Range<usize>,
}

pub const STEP: Key = Key { name: "step", accepts: "a whole number of steps, 0 or more" };
const CORNER: Key =
    Key { name: "at", accepts: "the upper-left corner: two finite numbers, m, to which size can be added" };
const POINT: Key = Key { name: "at", accepts: "a point: two finite numbers, m, around which there is room for size" };
const NAME: Key = Key {
    name: "name",
    accepts: "1 to 256 bytes without control characters, not beginning with #, which is kept for bodies without a name",
};
const NAME_OF_OTHER: Key = Key { name: "name", accepts: "the name of a body, or #K for the K-th spawned in the run" };
const SIZE: Key = Key { name: "size", accepts: "two positive finite extents, m" };
pub const MASS: Key = Key { name: "mass", accepts: "a positive number of kg, or inf for what is never pushed" };
const VELOCITY: Key = Key { name: "velocity", accepts: "two finite numbers, m/s" };
pub const FORCE: Key = Key { name: "force", accepts: "two finite numbers, N" };
pub const MATERIAL: Key = Key { name: "material", accepts: "1 to 256 bytes without control characters and without /" };
pub const COLOR: Key = Key { name: "color", accepts: "a colour written \"#rrggbb\" in hexadecimal digits" };
const BLUEPRINT: Key = Key { name: "spawn", accepts: "the keys of a body without its place" };

/// The keys of `[[spawn]]`.
pub fn read_spawn(node: &Node) -> Result<Request, Refusal> {
    let keys = [NAME, STEP, CORNER, SIZE, MASS, VELOCITY, FORCE, MATERIAL, COLOR];
    let table = Table::open("spawn", node, &keys)?;
    let corner = table.require(CORNER)?;
    let request = read_blueprint(&table)?.placed_at(corner.read(Node::vector)?);
    require_finite(&corner, &request)?;
    Ok(Request { step: read_step(&table)?, action: Action::Spawn(request), place: name_or_table(&table) })
}

/// The keys of `[[delete]]`.
pub fn read_delete(node: &Node) -> Result<Request, Refusal> {
    let table = Table::open("delete", node, &[STEP, NAME_OF_OTHER])?;
    let name = table.required(NAME_OF_OTHER, Node::text)?.into();
    Ok(Request { step: read_step(&table)?, action: Action::Delete { name }, place: name_or_table(&table) })
}

/// The keys of `[[click]]`.
pub fn read_click(node: &Node) -> Result<Request, Refusal> {
    let table = Table::open("click", node, &[STEP, POINT, BLUEPRINT])?;
    let point = table.require(POINT)?;
    let at = point.read(Node::vector)?;
    let mut place = table.span.clone();
    let mut spawn = None;
    if let Some(field) = table.get(BLUEPRINT) {
        let inner = Table::open("click.spawn", field.node, &[NAME, SIZE, MASS, VELOCITY, FORCE, MATERIAL, COLOR])?;
        let blueprint = read_blueprint(&inner)?;
        require_finite(&point, &blueprint.clone().centered_on(at))?;
        place = name_or_table(&inner);
        spawn = Some(blueprint);
    }
    Ok(Request { step: read_step(&table)?, action: Action::Click { at, spawn }, place })
}

/// The step a table names and where.
pub fn read_step(table: &Table) -> Result<Option<(u64, Range<usize>)>, Refusal> {
    table.get(STEP).map(|field| Ok((field.read(Node::count)?, field.node.span.clone()))).transpose()
}

/// An infinite mass keeps its velocity for life, so −0 would be recorded as moving.
pub fn canonical_velocity(mass: f64, velocity: Vector) -> Vector {
    // −0 + 0 is +0; any other number stays what it is.
    if mass == f64::INFINITY { velocity.add(Vector::ZERO) } else { velocity }
}

/// A text fit to be one side of a pair in the restitution table.
pub fn material(node: &Node) -> Result<&str, &Node> {
    let text = node.text()?;
    if text.contains('/') { Err(node) } else { Ok(text) }
}

/// A colour `#rrggbb`.
pub fn color(node: &Node) -> Result<&str, &Node> {
    let text = node.text()?;
    let digits = text.strip_prefix('#').ok_or(node)?;
    if digits.len() == 6 && digits.bytes().all(|digit| digit.is_ascii_hexdigit()) { Ok(text) } else { Err(node) }
}

fn read_blueprint(table: &Table) -> Result<Blueprint, Refusal> {
    let mass = table.required(MASS, Node::mass)?;
    let velocity = table.optional(VELOCITY, Node::vector)?.unwrap_or_default();
    Ok(Blueprint {
        name: table.optional(NAME, own_name)?.map(String::from),
        size: table.required(SIZE, Node::size)?,
        mass,
        velocity: canonical_velocity(mass, velocity),
        force: table.optional(FORCE, Node::vector)?.unwrap_or_default(),
        material: table.optional(MATERIAL, material)?.unwrap_or_default().into(),
        color: table.optional(COLOR, color)?.map(String::from),
    })
}

/// A name a scene may give: `#1` and its like are given by the run.
fn own_name(node: &Node) -> Result<&str, &Node> {
    let name = node.text()?;
    if name.starts_with('#') { Err(node) } else { Ok(name) }
}

/// Refuses a place so far out that a corner of the body is not a number.
fn require_finite(place: &Field, request: &SpawnRequest) -> Result<(), Refusal> {
    let is_finite = request.rect.origin.is_finite() && request.rect.far_corner().is_finite();
    if is_finite { Ok(()) } else { Err(place.refuse(place.node)) }
}

fn name_or_table(table: &Table) -> Range<usize> {
    table.get(NAME).map_or_else(|| table.span.clone(), |field| field.node.span.clone())
}
