use super::{
    diagnostic::ErrorReported,
    lifetimes::{Effect, NameField},
    tree::{Field, Key, Node, Table},
};
use crate::physics::{Rect, Spawn, Vector};
use crate::{color::Color, paint::Paint};
use std::ops::Range;

/// An action on the world.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Spawns one of the four walls, which get no number `#K`.
    Wall(SpawnRequest),
    /// Spawns a body, which gets the next number `#K` even if it has a name.
    Spawn(SpawnRequest),
    /// Deletes the body of that name, which must be alive.
    Delete {
        /// The name, or `#K` for the K-th body spawned in the run.
        name: String,
    },
    /// The handout's mouse click: deletes the body of finite mass created last that contains the point;
    /// if there is none, spawns a body.
    Click {
        /// The point, m.
        at: Vector,
        /// The body to spawn, centred on the point; none if absent.
        spawn: Option<Blueprint>,
    },
}

impl Action {
    /// The phase of its step in which it is applied.
    pub const fn phase(&self) -> Phase {
        match self {
            Action::Wall(_) => Phase::Walls,
            Action::Delete { .. } => Phase::Deletes,
            Action::Spawn(_) => Phase::Spawns,
            Action::Click { .. } => Phase::Clicks,
        }
    }
}

/// The phases in which the inputs of a step are applied, in this order: walls exist before all other inputs, and
/// deletes come before spawns, so that their names are free.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Phase {
    /// The walls appear.
    Walls,
    /// Bodies are deleted.
    Deletes,
    /// Bodies are spawned.
    Spawns,
    /// Clicks are resolved.
    Clicks,
}

/// A body to spawn.
#[derive(Clone, Debug, PartialEq)]
pub struct SpawnRequest {
    /// The upper-left corner, m; all corners of the body are finite.
    pub origin: Vector,
    /// Everything else about the body.
    pub blueprint: Blueprint,
}

impl SpawnRequest {
    /// Initial position and size, m.
    pub fn rect(&self) -> Rect {
        let [width, height] = self.blueprint.size;
        Rect::new(self.origin, width, height)
    }

    /// Converts the request to a spawn event of the physics under the given name.
    pub fn spawn(&self, name: String) -> Spawn {
        let rect = self.rect();
        let Blueprint { mass, velocity, force, ref material, .. } = self.blueprint;
        Spawn { name, rect, mass, velocity, force, material: material.clone() }
    }
}

/// A body without a position.
#[derive(Clone, Debug, PartialEq)]
pub struct Blueprint {
    /// Unique among the bodies alive; does not begin with `#`. The run names a body without a name `#K`.
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
    /// Colour and image in pictures.
    pub paint: Paint,
}

impl Blueprint {
    /// Places the upper-left corner at `origin`.
    pub fn placed_at(self, origin: Vector) -> SpawnRequest {
        SpawnRequest { origin, blueprint: self }
    }

    /// Places the centre at `point`.
    pub fn centered_on(self, point: Vector) -> SpawnRequest {
        let half = Vector::new(self.size[0], self.size[1]).mult(0.5);
        self.placed_at(point.sub(half))
    }
}

/// An event as written in a text. Parts that could not be read are errors.
pub struct Request<T> {
    /// The step and its location, if given.
    pub step: Result<Option<(u64, Range<usize>)>, ErrorReported>,
    /// The event.
    pub event: Result<T, ErrorReported>,
    /// Its effect on the names in use, which is partly known even if the event could not be read.
    pub effect: Effect,
    /// The text to underline if the event is impossible: the name that it uses, else its table.
    pub span: Range<usize>,
}

impl<T> Request<T> {
    /// An event whose table could not be read at all.
    pub fn unreadable(reported: ErrorReported, effect: Effect, span: Range<usize>) -> Request<T> {
        Request { step: Err(reported), event: Err(reported), effect, span }
    }
}

pub const STEP: Key = Key { name: "step", accepts: "a whole number of steps, 0 or more" };
const CORNER: Key =
    Key { name: "at", accepts: "the upper-left corner: two finite numbers, m, whose sums with size are finite" };
const POINT: Key =
    Key { name: "at", accepts: "a point: two finite numbers, m, around which a body of that size has finite corners" };
const RESOLVED: &str =
    "a point so near to the origin that size is more than a few units in the last place of the coordinates";
const NAME: Key = Key {
    name: "name",
    accepts: "1 to 256 bytes without control characters; the first is not #, which is reserved for bodies without a name",
};
const NAME_OF_BODY: Key =
    Key { name: "name", accepts: "the name of a body, or #K for the K-th body spawned in the run" };
pub const SIZE: Key = Key { name: "size", accepts: "two positive finite extents, m" };
const MASS: Key = Key { name: "mass", accepts: "a positive number of kg, or inf for a body that nothing can push" };
const VELOCITY: Key = Key { name: "velocity", accepts: "two finite numbers, m/s" };
pub const FORCE: Key = Key { name: "force", accepts: "two finite numbers, N" };
const ACCELERATING: &str = "a force, N, that gives the body a finite acceleration, force/mass";
const DIVIDING: &str = "a mass of 5.6e-309 kg or more, the least whose reciprocal is a number, or inf";
pub const MATERIAL: Key = Key { name: "material", accepts: "1 to 256 bytes without control characters and without /" };
pub const COLOR: Key = Key { name: "color", accepts: "a colour \"#rrggbb\" in hexadecimal digits" };
pub const IMAGE: Key = Key {
    name: "image",
    accepts: "the path of a PNG file relative to the scene, in at most 256 bytes, with / between folders: \"car.png\"",
};
const BLUEPRINT: Key = Key { name: "spawn", accepts: "a table of the keys of a body, without at and step" };

/// The keys of `[[spawn]]`.
pub const SPAWN_KEYS: &[Key] = &[NAME, STEP, CORNER, SIZE, MASS, VELOCITY, FORCE, MATERIAL, COLOR, IMAGE];
/// The keys of `[[delete]]`.
pub const DELETE_KEYS: &[Key] = &[STEP, NAME_OF_BODY];
/// The keys of `[[click]]`.
pub const CLICK_KEYS: &[Key] = &[STEP, POINT, BLUEPRINT];
/// The keys of the body that a `[[click]]` spawns.
pub const BLUEPRINT_KEYS: &[Key] = &[NAME, SIZE, MASS, VELOCITY, FORCE, MATERIAL, COLOR, IMAGE];

/// Reads `[[spawn]]`.
pub fn read_spawn(table: &Table) -> Request<Action> {
    let corner = table.require(CORNER).and_then(|field| Ok((field.read(Node::vector)?, field)));
    let (blueprint, name, is_infinite) = read_blueprint(table);
    let spawn = || {
        let (corner, field) = corner?;
        let request = blueprint?.placed_at(corner);
        require_resolved(&field, &request)?;
        Ok(Action::Spawn(request))
    };
    Request {
        step: read_step(table),
        event: spawn(),
        effect: Effect::Spawn { name, is_infinite },
        span: name_or_table(table),
    }
}

/// Reads `[[delete]]`.
pub fn read_delete(table: &Table) -> Request<Action> {
    let name = table.required(NAME_OF_BODY, Node::text).map(String::from);
    Request {
        step: read_step(table),
        effect: Effect::Delete { name: name.clone().ok() },
        event: name.map(|name| Action::Delete { name }),
        span: name_or_table(table),
    }
}

/// Reads `[[click]]`.
pub fn read_click(table: &Table) -> Request<Action> {
    let step = read_step(table);
    let point = table.require(POINT).and_then(|field| Ok((field.read(Node::vector)?, field)));
    let spawn = table.get(BLUEPRINT).and_then(|field| {
        field.map(|field| Table::open("click.spawn", field.node, BLUEPRINT_KEYS, table.reporter())).transpose()
    });
    let inner = match spawn {
        Ok(Some(inner)) => inner,
        Ok(None) => {
            let event = point.map(|(at, _)| Action::Click { at, spawn: None });
            return Request { step, event, effect: Effect::Click, span: table.span.clone() };
        }
        Err(reported) => {
            let effect = Effect::SpawningClick { name: NameField::Unreadable };
            return Request { step, event: Err(reported), effect, span: table.span.clone() };
        }
    };
    let (blueprint, name, _) = read_blueprint(&inner);
    let click = || {
        let ((at, field), blueprint) = (point?, blueprint?);
        require_resolved(&field, &blueprint.clone().centered_on(at))?;
        Ok(Action::Click { at, spawn: Some(blueprint) })
    };
    Request { step, event: click(), effect: Effect::SpawningClick { name }, span: name_or_table(&inner) }
}

/// Reads the step of an event and its location.
pub fn read_step(table: &Table) -> Result<Option<(u64, Range<usize>)>, ErrorReported> {
    table.get(STEP)?.map(|field| Ok((field.read(Node::count)?, field.node.span.clone()))).transpose()
}

/// Replaces −0 by 0 in the constant velocity of an infinite mass, which would otherwise be recorded as moving.
pub fn canonical_velocity(mass: f64, velocity: Vector) -> Vector {
    // −0 + 0 is +0; any other number stays the same.
    if mass == f64::INFINITY { velocity.add(Vector::ZERO) } else { velocity }
}

/// Reads a material, which can be one side of a pair in the restitution table.
pub fn material(node: &Node) -> Result<&str, &Node> {
    let text = node.text()?;
    if text.contains('/') { Err(node) } else { Ok(text) }
}

/// Reads a colour `#rrggbb`.
pub fn color(node: &Node) -> Result<&str, &Node> {
    let text = node.text()?;
    if text.parse::<Color>().is_ok() { Ok(text) } else { Err(node) }
}

/// Reads the path of an image: relative, so that no recording depends on the folders of a computer.
pub fn image(node: &Node) -> Result<&str, &Node> {
    let text = node.text()?;
    let is_relative = !text.starts_with(['/', ' ']) && !text.contains(['\\', ':']);
    if is_relative && text.to_ascii_lowercase().ends_with(".png") { Ok(text) } else { Err(node) }
}

/// Reads a body without its position; its name and whether its mass is infinite are partly known even if
/// the body could not be read.
fn read_blueprint(table: &Table) -> (Result<Blueprint, ErrorReported>, NameField, bool) {
    let name = table.optional(NAME, own_name).map(|name| name.map(String::from));
    let size = table.required(SIZE, Node::size);
    let mass = read_mass(table);
    let velocity = table.optional(VELOCITY, Node::vector);
    let force = read_force(table, mass.unwrap_or(f64::INFINITY));
    let material = table.optional(MATERIAL, material);
    let color = table.optional(COLOR, color);
    let image = table.optional(IMAGE, image);
    let name_field = NameField::from(&name);
    let blueprint = || {
        Ok(Blueprint {
            name: name?,
            size: size?,
            mass: mass?,
            velocity: canonical_velocity(mass?, velocity?.unwrap_or_default()),
            force: force?,
            material: material?.unwrap_or_default().into(),
            paint: Paint::new(color?, image?),
        })
    };
    (blueprint(), name_field, mass == Ok(f64::INFINITY))
}

/// Reads the mass of a body, kg.
fn read_mass(table: &Table) -> Result<f64, ErrorReported> {
    let field = table.require(MASS)?;
    let is_too_small = |mass: f64| mass > 0.0 && !(1.0 / mass).is_finite();
    if field.node.number().is_ok_and(is_too_small) {
        Err(field.accepting(DIVIDING).refuse(field.node))
    } else {
        field.read(Node::mass)
    }
}

/// Reads the constant force on a body of a mass in kg, by default none.
pub fn read_force(table: &Table, mass: f64) -> Result<Vector, ErrorReported> {
    let Some(field) = table.get(FORCE)? else { return Ok(Vector::ZERO) };
    let force = field.read(Node::vector)?;
    let acceleration = Vector::new(force.x / mass, force.y / mass);
    if acceleration.is_finite() { Ok(force) } else { Err(field.accepting(ACCELERATING).refuse(field.node)) }
}

/// Reads a name that a scene may assign; names that begin with `#` are assigned only by the run.
fn own_name(node: &Node) -> Result<&str, &Node> {
    let name = node.text()?;
    if name.starts_with('#') { Err(node) } else { Ok(name) }
}

/// Returns an error for a position at which a corner of the body is not finite or at which its faces would coincide in
/// the precision of coordinates.
fn require_resolved(position: &Field, request: &SpawnRequest) -> Result<(), ErrorReported> {
    let rect = request.rect();
    if !rect.origin.is_finite() || !rect.far_corner().is_finite() {
        return Err(position.refuse(position.node));
    }
    if rect.is_resolved() { Ok(()) } else { Err(position.accepting(RESOLVED).refuse(position.node)) }
}

fn name_or_table(table: &Table) -> Range<usize> {
    table.span_of(NAME).unwrap_or_else(|| table.span.clone())
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
            paint: Paint::default(),
        };
        let request = blueprint.centered_on(Vector::new(4.0, 5.0));
        assert_eq!(request.rect(), Rect::new(Vector::new(3.5, 4.0), 1.0, 2.0));
        assert_eq!(request.rect().center(), Vector::new(4.0, 5.0));
    }
}
