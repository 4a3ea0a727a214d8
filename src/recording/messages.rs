//! Message layouts of events and keyframes, and conversions with validation.
//!
//! The structs mirror `schemas/*.msg` field by field. The order of the fields is part of the format.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::physics::{BodyId, Rect, SolverSnapshot, Spawn, Vector};
use crate::text::counted;

use super::{BodyInfo, Change, Keyframe, KeyframeBody, RecordedEvent, limits};

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

/// A body of a keyframe, converted while it is decoded, because there may be many.
#[derive(Clone, Serialize, Deserialize)]
#[serde(try_from = "SpawnMessage", into = "SpawnMessage")]
struct Spawned(Arc<BodyInfo>);

impl TryFrom<SpawnMessage> for Spawned {
    type Error = String;

    fn try_from(message: SpawnMessage) -> Result<Spawned, String> {
        message.into_body_info().map(|info| Spawned(info.into()))
    }
}

impl From<Spawned> for SpawnMessage {
    fn from(Spawned(info): Spawned) -> SpawnMessage {
        SpawnMessage::from(&*info)
    }
}

impl EventMessage {
    /// Creates the message of an event.
    pub fn new(event: &RecordedEvent) -> EventMessage {
        let (spawn, delete) = match &event.change {
            Change::Spawn(info) => (vec![SpawnMessage::from(&**info)], vec![]),
            Change::Delete { id } => (vec![], vec![*id]),
        };
        EventMessage { step: event.step, spawn, delete }
    }

    /// Converts the message to an event.
    ///
    /// # Errors
    /// Returns a description of the problem if the event is invalid.
    pub fn into_event(self) -> Result<RecordedEvent, String> {
        let counts = (self.spawn.len(), self.delete.len());
        let change = match (self.spawn.into_iter().next(), self.delete.first()) {
            (Some(spawn), None) if counts.0 == 1 => Change::Spawn(spawn.into_body_info()?.into()),
            (None, Some(&id)) if counts.1 == 1 => Change::Delete { id },
            _ => {
                return Err(format!(
                    "an event has {} and {}, but must have exactly one spawn or delete",
                    counted(counts.0, "spawn"),
                    counted(counts.1, "delete"),
                ));
            }
        };
        Ok(RecordedEvent { step: self.step, change })
    }
}

impl From<&BodyInfo> for SpawnMessage {
    fn from(BodyInfo { id, spawn, paint }: &BodyInfo) -> SpawnMessage {
        SpawnMessage {
            id: *id,
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
            color: paint.as_str().into(),
        }
    }
}

impl SpawnMessage {
    fn into_body_info(self) -> Result<BodyInfo, String> {
        self.check_strings()?;
        let invalid = format!("body {:?} has invalid constants", self.name.chars().take(200).collect::<String>());
        let spawn = Spawn {
            rect: Rect::new(Vector::new(self.x, self.y), self.width, self.height),
            mass: self.mass,
            velocity: Vector::new(self.vx, self.vy),
            force: Vector::new(self.fx, self.fy),
            name: self.name,
            material: self.material,
        };
        if spawn.is_valid() { Ok(BodyInfo { id: self.id, spawn, paint: self.color.into() }) } else { Err(invalid) }
    }

    fn check_strings(&self) -> Result<(), String> {
        if let Some(text) =
            [&self.name, &self.material, &self.color].into_iter().find(|text| text.len() > limits::STRING_BYTES)
        {
            return Err(format!(
                "body {} has a string of {} bytes, but at most {} are allowed",
                self.id,
                text.len(),
                limits::STRING_BYTES,
            ));
        }
        Ok(())
    }
}

impl BodiesMessage {
    /// Creates the message of a keyframe for a recording of this format version.
    pub fn new(keyframe: &Keyframe, format: u32) -> BodiesMessage {
        let column = |value: fn(&KeyframeBody) -> f64| keyframe.bodies.iter().map(value).collect();
        BodiesMessage {
            step: keyframe.step,
            next_id: keyframe.next_id,
            spawned: keyframe.bodies.iter().map(|body| Spawned(body.info.clone())).collect(),
            x: column(|body| body.position.x),
            y: column(|body| body.position.y),
            vx: column(|body| body.velocity.x),
            vy: column(|body| body.velocity.y),
            fx: column(|body| body.force.x),
            fy: column(|body| body.force.y),
            solver_integers: keyframe.solver.integers.clone(),
            solver_numbers: to_columns(&keyframe.solver.numbers, format, keyframe.bodies.len()),
        }
    }

    /// Divides a message into messages of at most `limit` bytes, whose fields continue each other.
    pub fn split(mut self, limit: usize) -> Vec<BodiesMessage> {
        let mut parts = Vec::new();
        loop {
            let mut free = limit.saturating_sub(FIXED_BYTES);
            let bodies = self.spawned.iter().take_while(|body| take(&mut free, body.bytes())).count().max(1);
            let bodies = bodies.min(self.spawned.len());
            let integers = self.solver_integers.len().min(free / 8);
            let numbers = self.solver_numbers.len().min(free / 8 - integers);
            let front = |column: &mut Vec<f64>| split_front(column, bodies);
            parts.push(BodiesMessage {
                step: self.step,
                next_id: self.next_id,
                x: front(&mut self.x),
                y: front(&mut self.y),
                vx: front(&mut self.vx),
                vy: front(&mut self.vy),
                fx: front(&mut self.fx),
                fy: front(&mut self.fy),
                spawned: split_front(&mut self.spawned, bodies),
                solver_integers: split_front(&mut self.solver_integers, integers),
                solver_numbers: split_front(&mut self.solver_numbers, numbers),
            });
            if self.spawned.is_empty() && self.solver_integers.is_empty() && self.solver_numbers.is_empty() {
                return parts;
            }
        }
    }

    /// Appends the next message of the same keyframe.
    ///
    /// # Errors
    /// Returns a description of the problem if the messages belong to different keyframes or are too many.
    pub fn append(&mut self, next: BodiesMessage) -> Result<(), String> {
        if (next.step, next.next_id) != (self.step, self.next_id) {
            return Err(format!("the parts of the keyframe of step {} do not fit together", self.step));
        }
        self.spawned.extend(next.spawned);
        self.x.extend(next.x);
        self.y.extend(next.y);
        self.vx.extend(next.vx);
        self.vy.extend(next.vy);
        self.fx.extend(next.fx);
        self.fy.extend(next.fy);
        self.solver_integers.extend(next.solver_integers);
        self.solver_numbers.extend(next.solver_numbers);
        let bodies = self.spawned.len();
        let solver = self.solver_integers.len().max(self.solver_numbers.len());
        if bodies <= limits::BODIES && solver <= limits::SOLVER_NUMBERS * (bodies + 1) {
            Ok(())
        } else {
            Err(format!("the keyframe of step {} is too large", self.step))
        }
    }

    /// The step of the keyframe.
    pub fn step(&self) -> u64 {
        self.step
    }

    /// Converts the message to a keyframe of a recording of this format version.
    ///
    /// # Errors
    /// Returns a description of the problem if the keyframe is invalid.
    pub fn into_keyframe(self, format: u32) -> Result<Keyframe, String> {
        let columns = [&self.x, &self.y, &self.vx, &self.vy, &self.fx, &self.fy];
        if columns.iter().any(|column| column.len() != self.spawned.len()) {
            return Err("a keyframe has columns of different lengths".into());
        }
        if columns.into_iter().flatten().any(|number| !number.is_finite()) {
            return Err("a keyframe contains a value that is not finite".into());
        }
        if self.spawned.windows(2).any(|pair| pair[0].0.id >= pair[1].0.id)
            || self.spawned.last().is_some_and(|last| last.0.id >= self.next_id)
        {
            return Err("the ids in a keyframe are not in ascending order".into());
        }
        let vector = |x: &[f64], y: &[f64], index: usize| Vector::new(x[index], y[index]);
        let numbers = from_columns(self.solver_numbers, format, self.spawned.len());
        let bodies = self.spawned.into_iter().enumerate().map(|(index, Spawned(info))| KeyframeBody {
            info,
            position: vector(&self.x, &self.y, index),
            velocity: vector(&self.vx, &self.vy, index),
            force: vector(&self.fx, &self.fy, index),
        });
        Ok(Keyframe {
            step: self.step,
            next_id: self.next_id,
            bodies: bodies.collect(),
            solver: SolverSnapshot { integers: self.solver_integers, numbers },
        })
    }
}

impl Spawned {
    /// Returns the largest number of bytes that the body needs in a message.
    fn bytes(&self) -> usize {
        let Spawned(info) = self;
        let [name, material, paint] = [&info.spawn.name, &info.spawn.material, info.paint.as_str()].map(str::len);
        const NUMBERS: usize = 4 + (9 + 6) * 8;
        const PADDED_LENGTHS: usize = 3 * (4 + 1 + 7);
        NUMBERS + PADDED_LENGTHS + name + material + paint
    }
}

/// Bytes of a keyframe without bodies: header, step, lengths and padding.
const FIXED_BYTES: usize = 256;

/// Takes `bytes` from `free`, if there are as many.
fn take(free: &mut usize, bytes: usize) -> bool {
    let rest = free.checked_sub(bytes);
    *free = rest.unwrap_or(*free);
    rest.is_some()
}

/// Removes the first elements and returns them.
fn split_front<T>(elements: &mut Vec<T>, count: usize) -> Vec<T> {
    let rest = elements.split_off(count);
    std::mem::replace(elements, rest)
}

/// The first format version that stores the solver's numbers by columns.
const FIRST_FORMAT_WITH_COLUMNS: u32 = 2;

/// Transposes per-body rows into columns (format ≥ 2), which compress better.
///
/// Returns `numbers` unchanged if they cannot be divided evenly among the bodies.
fn to_columns(numbers: &[f64], format: u32, bodies: usize) -> Vec<f64> {
    if format < FIRST_FORMAT_WITH_COLUMNS || bodies == 0 || !numbers.len().is_multiple_of(bodies) {
        numbers.into()
    } else {
        transposed(numbers, numbers.len() / bodies)
    }
}

/// Inverts [`to_columns`].
fn from_columns(numbers: Vec<f64>, format: u32, bodies: usize) -> Vec<f64> {
    if format < FIRST_FORMAT_WITH_COLUMNS || bodies == 0 || !numbers.len().is_multiple_of(bodies) {
        numbers
    } else {
        transposed(&numbers, bodies)
    }
}

/// Transposes a matrix with rows of length `width`.
fn transposed(numbers: &[f64], width: usize) -> Vec<f64> {
    (0..width).flat_map(|column| numbers.iter().skip(column).step_by(width)).copied().collect()
}

#[cfg(test)]
mod tests {
    use proptest::{collection::vec, prelude::*};

    use super::{
        super::{FORMAT_VERSION, cdr},
        *,
    };

    /// Any finite f64, including -0.0 and subnormals.
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
        let mass = positive().prop_filter("the reciprocal of a mass is a number", |mass| (1.0 / mass).is_finite());
        let mass = prop_oneof![mass, Just(f64::INFINITY)];
        (".*", vector(), positive(), positive(), mass, vector(), vector(), ".*").prop_map(
            |(name, origin, width, height, mass, velocity, force, material)| {
                let rect = Rect::new(origin, width, height);
                let spawn = Spawn { name, rect, mass, velocity, force, material };
                // A force that gives an infinite acceleration is not valid.
                if spawn.is_valid() { spawn } else { Spawn { force: Vector::ZERO, ..spawn } }
            },
        )
    }

    fn info(id: BodyId) -> impl Strategy<Value = BodyInfo> {
        (spawn(), ".*").prop_map(move |(spawn, paint)| BodyInfo { id, spawn, paint: paint.into() })
    }

    fn body(id: BodyId) -> impl Strategy<Value = KeyframeBody> {
        (info(id), vector(), vector(), vector()).prop_map(|(info, position, velocity, force)| KeyframeBody {
            info: Arc::new(info),
            position,
            velocity,
            force,
        })
    }

    /// Compares bit for bit: the `Debug` text distinguishes -0.0 from 0.0, which are equal.
    fn are_identical<T: PartialEq + std::fmt::Debug>(a: &T, b: &T) -> bool {
        a == b && format!("{a:?}") == format!("{b:?}")
    }

    #[test]
    fn rows_are_transposed_into_columns() {
        let rows = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        assert_eq!(to_columns(&rows, FIRST_FORMAT_WITH_COLUMNS, 2), [1.0, 4.0, 2.0, 5.0, 3.0, 6.0]);
        assert_eq!(
            to_columns(&rows, FIRST_FORMAT_WITH_COLUMNS, 4),
            rows,
            "six numbers cannot be divided among four bodies"
        );
        assert_eq!(to_columns(&rows, 1, 2), rows, "the first format had no columns");
        assert!(to_columns(&[], FIRST_FORMAT_WITH_COLUMNS, 2).is_empty());
    }

    proptest! {
        #[test]
        fn from_columns_inverts_to_columns(bodies in 0_usize..9, numbers in vec(-1.0..1.0, 0..40), format in 1_u32..3) {
            let columns = to_columns(&numbers, format, bodies);
            prop_assert_eq!(from_columns(columns, format, bodies), numbers);
        }

        #[test]
        fn decoding_inverts_encoding_of_events(step: u64, id: BodyId, info in info(0), is_delete: bool) {
            let change =
                if is_delete { Change::Delete { id } } else { Change::Spawn(BodyInfo { id, ..info }.into()) };
            let event = RecordedEvent { step, change };
            let mut bytes = Vec::new();
            cdr::encode(&EventMessage::new(&event), &mut bytes);
            let decoded = cdr::decode::<EventMessage>(&bytes).unwrap().into_event().unwrap();
            prop_assert!(are_identical(&decoded, &event), "{decoded:?}");
        }

        #[test]
        fn decoding_inverts_encoding_of_keyframes(
            step: u64,
            bodies in (body(3), body(7), body(8)),
            integers in vec(any::<u64>(), 0..5),
            numbers in vec(finite(), 0..10),
            format in 1_u32..3,
        ) {
            let bodies = vec![bodies.0, bodies.1, bodies.2];
            let keyframe = Keyframe { step, next_id: 9, bodies, solver: SolverSnapshot { integers, numbers } };
            let mut bytes = Vec::new();
            cdr::encode(&BodiesMessage::new(&keyframe, format), &mut bytes);
            let decoded = cdr::decode::<BodiesMessage>(&bytes).unwrap().into_keyframe(format).unwrap();
            prop_assert!(are_identical(&decoded, &keyframe), "{decoded:?}");
        }

        #[test]
        fn appending_inverts_splitting_of_keyframes(
            bodies in (body(3), body(7), body(8)),
            integers in vec(any::<u64>(), 0..50),
            numbers in vec(finite(), 0..50),
            limit in 300_usize..2000,
        ) {
            let bodies = vec![bodies.0, bodies.1, bodies.2];
            let keyframe = Keyframe { step: 5, next_id: 9, bodies, solver: SolverSnapshot { integers, numbers } };
            let mut joined: Option<BodiesMessage> = None;
            for part in BodiesMessage::new(&keyframe, FORMAT_VERSION).split(limit) {
                let mut bytes = Vec::new();
                cdr::encode(&part, &mut bytes);
                prop_assert!(bytes.len() <= limit || part.spawned.len() == 1, "{} bytes", bytes.len());
                match &mut joined {
                    Some(joined) => joined.append(part).unwrap(),
                    None => joined = Some(part),
                }
            }
            let decoded = joined.unwrap().into_keyframe(FORMAT_VERSION).unwrap();
            prop_assert!(are_identical(&decoded, &keyframe), "{decoded:?}");
        }

        #[test]
        fn arbitrary_bytes_decode_to_a_message_or_an_error(bytes in vec(any::<u8>(), 0..300)) {
            let with_header = [cdr::HEADER.as_slice(), &bytes].concat();
            let _ = cdr::decode::<EventMessage>(&with_header).map(EventMessage::into_event);
            let _ = cdr::decode::<BodiesMessage>(&with_header).map(|message| message.into_keyframe(FORMAT_VERSION));
        }
    }
}
