//! Events and keyframes as they are laid out in messages, and back, checked.
//!
//! The structs mirror `schemas/*.msg` field by field: the order is the format.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::physics::{BodyId, Memory, Rect, Spawn, Vector};

use super::{
    Change, Keyframe, KeyframeBody, KnownBody, RecordedEvent,
    columns::{by_bodies, by_columns},
    limits,
};

/// `rebond_msgs/msg/Event`.
#[derive(Serialize, Deserialize)]
pub struct EventMessage {
    step: u64,
    spawn: Vec<SpawnMessage>,
    delete: Vec<BodyId>,
}

/// `rebond_msgs/Spawn`.
#[derive(Serialize, Deserialize)]
struct SpawnMessage {
    id: BodyId,
    name: String,
    x: f64,
    y: f64,
    width: f64,
    height: f64,
    mass: f64,
    vx: f64,
    vy: f64,
    fx: f64,
    fy: f64,
    material: String,
    color: String,
}

/// `rebond_msgs/msg/Bodies`.
#[derive(Serialize, Deserialize)]
pub struct BodiesMessage {
    step: u64,
    next_id: BodyId,
    spawned: Vec<Spawned>,
    x: Vec<f64>,
    y: Vec<f64>,
    vx: Vec<f64>,
    vy: Vec<f64>,
    fx: Vec<f64>,
    fy: Vec<f64>,
    solver_integers: Vec<u64>,
    solver_numbers: Vec<f64>,
}

/// A body of a keyframe, made what it is as soon as it is read: there may be many.
#[derive(Clone, Serialize, Deserialize)]
#[serde(try_from = "SpawnMessage", into = "SpawnMessage")]
struct Spawned(Arc<KnownBody>);

impl TryFrom<SpawnMessage> for Spawned {
    type Error = String;

    fn try_from(message: SpawnMessage) -> Result<Spawned, String> {
        message.body().map(|body| Spawned(body.into()))
    }
}

impl From<Spawned> for SpawnMessage {
    fn from(Spawned(body): Spawned) -> SpawnMessage {
        SpawnMessage::new(body.id, &body.spawn, body.color.as_deref())
    }
}

impl EventMessage {
    /// The message of an event.
    pub fn new(event: &RecordedEvent) -> EventMessage {
        let (spawn, delete) = match &event.change {
            Change::Spawn { id, spawn, color } => (vec![SpawnMessage::new(*id, spawn, color.as_deref())], vec![]),
            Change::Delete { id } => (vec![], vec![*id]),
        };
        EventMessage { step: event.step, spawn, delete }
    }

    /// The event of a message.
    ///
    /// # Errors
    /// In words, if it is not one this program could have recorded.
    pub fn event(self) -> Result<RecordedEvent, String> {
        let found = (self.spawn.len(), self.delete.len());
        let change = match (self.spawn.into_iter().next(), self.delete.first()) {
            (Some(spawn), None) if found.0 == 1 => {
                let KnownBody { id, spawn, color } = spawn.body()?;
                Change::Spawn { id, spawn, color }
            }
            (None, Some(&id)) if found.1 == 1 => Change::Delete { id },
            _ => return Err(format!("an event of {} spawns and {} deletes", found.0, found.1)),
        };
        Ok(RecordedEvent { step: self.step, change })
    }
}

impl SpawnMessage {
    fn new(id: BodyId, spawn: &Spawn, color: Option<&str>) -> SpawnMessage {
        SpawnMessage {
            id,
            name: spawn.name.clone(),
            x: spawn.rect.origin.x,
            y: spawn.rect.origin.y,
            width: spawn.rect.width(),
            height: spawn.rect.height(),
            mass: spawn.mass,
            vx: spawn.velocity.x,
            vy: spawn.velocity.y,
            fx: spawn.force.x,
            fy: spawn.force.y,
            material: spawn.material.clone(),
            color: color.unwrap_or_default().into(),
        }
    }

    fn body(self) -> Result<KnownBody, String> {
        self.check()?;
        let impossible = format!("body {:?} has impossible constants", self.name);
        let spawn = Spawn {
            rect: Rect::new(Vector::new(self.x, self.y), self.width, self.height),
            mass: self.mass,
            velocity: Vector::new(self.vx, self.vy),
            force: Vector::new(self.fx, self.fy),
            name: self.name,
            material: self.material,
        };
        let color = (!self.color.is_empty()).then_some(self.color);
        if spawn.is_possible() { Ok(KnownBody { id: self.id, spawn, color }) } else { Err(impossible) }
    }

    fn check(&self) -> Result<(), String> {
        if let Some(long) =
            [&self.name, &self.material, &self.color].into_iter().find(|s| s.len() > limits::STRING_BYTES)
        {
            return Err(format!("body {} has a string of {} bytes", self.id, long.len()));
        }
        Ok(())
    }
}

impl BodiesMessage {
    /// The message of a keyframe in a recording of that format.
    pub fn new(keyframe: &Keyframe, format: u32) -> BodiesMessage {
        let column = |number: fn(&KeyframeBody) -> f64| keyframe.bodies.iter().map(number).collect();
        BodiesMessage {
            step: keyframe.step,
            next_id: keyframe.next_id,
            spawned: keyframe.bodies.iter().map(|body| Spawned(body.known.clone())).collect(),
            x: column(|body| body.position.x),
            y: column(|body| body.position.y),
            vx: column(|body| body.velocity.x),
            vy: column(|body| body.velocity.y),
            fx: column(|body| body.force.x),
            fy: column(|body| body.force.y),
            solver_integers: keyframe.memory.integers.clone(),
            solver_numbers: by_columns(&keyframe.memory.numbers, keyframe.bodies.len(), format),
        }
    }

    /// The keyframe of a message in a recording of that format.
    ///
    /// # Errors
    /// In words, if it is not one this program could have recorded.
    pub fn keyframe(self, format: u32) -> Result<Keyframe, String> {
        let columns = [&self.x, &self.y, &self.vx, &self.vy, &self.fx, &self.fy];
        if columns.iter().any(|column| column.len() != self.spawned.len()) {
            return Err("a keyframe with columns of different lengths".into());
        }
        if columns.into_iter().flatten().any(|number| !number.is_finite()) {
            return Err("a keyframe with a number that is not finite".into());
        }
        if self.spawned.windows(2).any(|pair| pair[0].0.id >= pair[1].0.id)
            || self.spawned.last().is_some_and(|last| last.0.id >= self.next_id)
        {
            return Err("a keyframe with ids out of order".into());
        }
        let at = |x: &[f64], y: &[f64], place: usize| Vector::new(x[place], y[place]);
        let numbers = by_bodies(self.solver_numbers, self.spawned.len(), format);
        let bodies = self.spawned.into_iter().enumerate().map(|(place, Spawned(known))| KeyframeBody {
            known,
            position: at(&self.x, &self.y, place),
            velocity: at(&self.vx, &self.vy, place),
            force: at(&self.fx, &self.fy, place),
        });
        Ok(Keyframe {
            step: self.step,
            next_id: self.next_id,
            bodies: bodies.collect(),
            memory: Memory { integers: self.solver_integers, numbers },
        })
    }
}

#[cfg(test)]
mod tests {
    use proptest::{collection::vec, prelude::*};

    use super::{
        super::{FORMAT_VERSION, cdr},
        *,
    };

    /// Any finite double, -0.0 and subnormals included.
    fn finite() -> impl Strategy<Value = f64> {
        prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO
    }

    fn positive() -> impl Strategy<Value = f64> {
        (prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL).prop_map(f64::abs)
    }

    fn vector() -> impl Strategy<Value = Vector> {
        (finite(), finite()).prop_map(|(x, y)| Vector::new(x, y))
    }

    fn spawn() -> impl Strategy<Value = Spawn> {
        let mass = prop_oneof![positive(), Just(f64::INFINITY)];
        (".*", vector(), positive(), positive(), mass, vector(), vector(), ".*").prop_map(
            |(name, origin, width, height, mass, velocity, force, material)| Spawn {
                name,
                rect: Rect::new(origin, width, height),
                mass,
                velocity,
                force,
                material,
            },
        )
    }

    fn known(id: BodyId) -> impl Strategy<Value = KnownBody> {
        (spawn(), prop::option::of(".+")).prop_map(move |(spawn, color)| KnownBody { id, spawn, color })
    }

    fn body(id: BodyId) -> impl Strategy<Value = KeyframeBody> {
        (known(id), vector(), vector(), vector()).prop_map(|(known, position, velocity, force)| KeyframeBody {
            known: Arc::new(known),
            position,
            velocity,
            force,
        })
    }

    /// Equal to the bit: what `==` says of values whose text distinguishes -0.0.
    fn same<T: PartialEq + std::fmt::Debug>(a: &T, b: &T) -> bool {
        a == b && format!("{a:?}") == format!("{b:?}")
    }

    proptest! {
        #[test]
        fn events_come_back(step: u64, id: BodyId, body in known(0), deletes: bool) {
            let change = match deletes {
                true => Change::Delete { id },
                false => Change::Spawn { id, spawn: body.spawn, color: body.color },
            };
            let event = RecordedEvent { step, change };
            let mut bytes = Vec::new();
            cdr::encode(&EventMessage::new(&event), &mut bytes);
            let back = cdr::decode::<EventMessage>(&bytes).unwrap().event().unwrap();
            prop_assert!(same(&back, &event), "{back:?}");
        }

        #[test]
        fn keyframes_come_back(
            step: u64,
            bodies in (body(3), body(7), body(8)),
            integers in vec(any::<u64>(), 0..5),
            numbers in vec(finite(), 0..10),
            format in 1_u32..3,
        ) {
            let bodies = vec![bodies.0, bodies.1, bodies.2];
            let keyframe = Keyframe { step, next_id: 9, bodies, memory: Memory { integers, numbers } };
            let mut bytes = Vec::new();
            cdr::encode(&BodiesMessage::new(&keyframe, format), &mut bytes);
            let back = cdr::decode::<BodiesMessage>(&bytes).unwrap().keyframe(format).unwrap();
            prop_assert!(same(&back, &keyframe), "{back:?}");
        }

        #[test]
        fn any_bytes_are_a_message_or_an_error(bytes in vec(any::<u8>(), 0..300)) {
            let with_header = [cdr::HEADER.as_slice(), &bytes].concat();
            let _ = cdr::decode::<EventMessage>(&with_header).map(EventMessage::event);
            let _ = cdr::decode::<BodiesMessage>(&with_header).map(|message| message.keyframe(FORMAT_VERSION));
        }
    }
}
