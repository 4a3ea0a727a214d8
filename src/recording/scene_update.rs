//! Scene updates: boxes for MCAP viewers, as `foxglove.SceneUpdate` messages.
//!
//! Viewers have z up and y to the left, so the world is drawn in the plane z = 0 with y negated. Only the
//! fields in use are written; the schema in the file contains all.

use std::{collections::BTreeMap, sync::Arc};

use crate::{color::Color, physics::BodyId};

use super::{
    BodyInfo, BodyTable, RecordedState,
    model::NANOSECONDS_PER_SECOND,
    record_reader::{FieldReader, Malformed},
};

/// Returns the colour of a body in viewers.
pub type ColorFn = fn(&BodyInfo) -> Color;

/// The `FileDescriptorSet` of the schema and its dependencies, as protobuf readers need it, from
/// Foxglove's package `foxglove-schemas-protobuf` 0.4.0 (MIT).
pub const SCHEMA: &[u8] = include_bytes!("schemas/foxglove.SceneUpdate.bin");

/// Encodes the message that shows exactly these bodies (x, y, vx, vy) at `time`, in simulated
/// nanoseconds, replacing the contents of `bytes`.
///
/// Each message first deletes all previous entities, so that viewers are correct after any seek.
pub fn encode<'a>(
    time: u64,
    bodies: impl Iterator<Item = (&'a Arc<BodyInfo>, [f64; 4])>,
    color: impl Fn(&BodyInfo) -> Color,
    bytes: &mut Vec<u8>,
) {
    let timestamp = timestamp(time);
    let deletion = Message::default().message(1, &timestamp).integer(2, DELETE_ALL);
    let mut boxes = Message::default().message(1, &timestamp).text(2, "world").text(3, "boxes");
    for (info, [x, y, ..]) in bodies {
        boxes = boxes.message(8, &cube(info, x, y, color(info)));
    }
    bytes.clear();
    bytes.extend(Message::default().message(1, &deletion).message(2, &boxes).0);
}

/// The colours of the bodies alive.
pub type Colors = BTreeMap<BodyId, Color>;

/// Compares a message with the one that shows this state at `time`, and describes a difference. The colours must be
/// those of the message before, if a body was in it, and those of the scene, if it gives any. `colors` becomes those
/// of the message.
pub fn difference(
    message: &[u8],
    time: u64,
    table: &BodyTable,
    state: &RecordedState,
    colors: &mut Colors,
) -> Option<String> {
    let step = state.step;
    let found: Option<Colors> = parse_colors(message)
        .ok()
        .filter(|found| found.len() == table.bodies().len())
        .map(|found| table.bodies().iter().map(|info| info.id).zip(found).collect());
    let Some(found) = found else { return Some(format!("the scene update of state {step} does not show its bodies")) };
    let mut expected = Vec::new();
    let bodies =
        table.join_state(state).map(|(info, recorded)| (info, recorded.unwrap_or_else(|| info.initial_state())));
    encode(time, bodies, |info| found[&info.id], &mut expected);
    let previous = std::mem::replace(colors, found);
    if expected != message {
        let offset = expected.iter().zip(message).position(|(expected, found)| expected != found);
        let field = offset.and_then(|offset| path_at(&expected, offset, "").ok()).unwrap_or("length".into());
        return Some(format!("the scene update of state {step} has another {field} than the state"));
    }
    let changed = table.bodies().iter().find(|info| {
        let color = colors.get(&info.id);
        let of_scene = info.paint.color();
        previous.get(&info.id).is_some_and(|previous| Some(previous) != color)
            || of_scene.is_some_and(|of_scene| Some(&of_scene) != color)
    });
    changed.map(|info| format!("the scene update of state {step} has another colour of body {:?}", info.spawn.name))
}

/// Returns the colours of the boxes in a message, in order.
fn parse_colors(message: &[u8]) -> Result<Vec<Color>, Malformed> {
    let mut colors = Vec::new();
    for boxes in fields(message, 2)? {
        for cube in fields(boxes, 8)? {
            let mut channels = [0; 3];
            for message in fields(cube, 3)? {
                let mut rest = FieldReader::new(message);
                while !rest.is_empty() {
                    let field = usize::try_from(varint(&mut rest)? >> 3).map_err(|_| Malformed)?;
                    let number = f64::from_bits(rest.u64()?);
                    if let Some(channel) = channels.get_mut(field.wrapping_sub(1)) {
                        *channel = (number * 255.0).round() as u8;
                    }
                }
            }
            let [r, g, b] = channels;
            colors.push(Color { r, g, b });
        }
    }
    Ok(colors)
}

/// Returns the contents of the length-delimited fields with this number.
fn fields(message: &[u8], number: u64) -> Result<Vec<&[u8]>, Malformed> {
    let mut rest = FieldReader::new(message);
    let mut found = Vec::new();
    while !rest.is_empty() {
        let tag = varint(&mut rest)?;
        match tag & 7 {
            VARINT => drop(varint(&mut rest)?),
            FIXED_64_BITS => drop(rest.u64()?),
            LENGTH_DELIMITED => {
                let length = varint(&mut rest)?;
                let content = rest.bytes(length)?;
                found.extend((tag >> 3 == number).then_some(content));
            }
            _ => return Err(Malformed),
        }
    }
    Ok(found)
}

/// The messages in a scene update: the name of the message, and the names of its fields 1, 2, …
const FIELD_NAMES: [(&str, &[&str]); 10] = [
    ("", &["deletions", "entities"]),
    ("deletions", &["timestamp", "type"]),
    ("entities", &["timestamp", "frame_id", "id", "", "", "", "", "cubes"]),
    ("timestamp", &["seconds", "nanos"]),
    ("cubes", &["pose", "size", "color"]),
    ("pose", &["position", "orientation"]),
    ("position", &["x", "y", "z"]),
    ("orientation", &["x", "y", "z", "w"]),
    ("size", &["x", "y", "z"]),
    ("color", &["r", "g", "b", "a"]),
];

/// Returns the names of the fields down to the one at `offset` of the message `name`, such as `cubes.size.x`.
fn path_at(message: &[u8], offset: usize, name: &str) -> Result<String, Malformed> {
    let mut rest = FieldReader::new(message);
    loop {
        let tag = varint(&mut rest)?;
        let content = match tag & 7 {
            VARINT => varint(&mut rest).map(|_| None)?,
            FIXED_64_BITS => rest.u64().map(|_| None)?,
            _ => {
                let length = varint(&mut rest)?;
                Some(rest.bytes(length)?)
            }
        };
        let end = message.len() - rest.remaining();
        if offset >= end {
            continue;
        }
        let names = FIELD_NAMES.into_iter().find(|(message, _)| *message == name).map_or(&[][..], |(_, names)| names);
        let field =
            usize::try_from((tag >> 3).saturating_sub(1)).ok().and_then(|index| names.get(index)).ok_or(Malformed)?;
        let start = content.map_or(end, |content| end - content.len());
        return match content.filter(|_| offset >= start && FIELD_NAMES.iter().any(|(message, _)| message == field)) {
            Some(content) => Ok(format!("{field}.{}", path_at(content, offset - start, field)?)),
            None => Ok((*field).into()),
        };
    }
}

fn varint(bytes: &mut FieldReader<'_>) -> Result<u64, Malformed> {
    let mut number = 0;
    for shift in (0..64).step_by(7) {
        let byte = *bytes.bytes(1)?.first().ok_or(Malformed)?;
        number |= u64::from(byte & 0x7f) << shift;
        if byte & 0x80 == 0 {
            return Ok(number);
        }
    }
    Err(Malformed)
}

/// `SceneEntityDeletion.ALL`.
const DELETE_ALL: u64 = 1;

/// `google.protobuf.Timestamp`.
fn timestamp(nanoseconds: u64) -> Message {
    let (seconds, rest) = (nanoseconds / NANOSECONDS_PER_SECOND, nanoseconds % NANOSECONDS_PER_SECOND);
    Message::default().integer(1, seconds).integer(2, rest)
}

/// The `foxglove.CubePrimitive` of a body whose upper-left corner is at `x`, `y` (m). Its depth is its smaller side.
fn cube(info: &BodyInfo, x: f64, y: f64, color: Color) -> Message {
    let [width, height] = [info.spawn.rect.width(), info.spawn.rect.height()];
    let depth = crate::physics::smaller(width, height);
    let center = Message::doubles([x + width / 2.0, -(y + height / 2.0), depth / 2.0]);
    let upright = Message::doubles([0.0, 0.0, 0.0, 1.0]);
    let [r, g, b] = [color.r, color.g, color.b].map(|channel| f64::from(channel) / 255.0);
    Message::default()
        .message(1, &Message::default().message(1, &center).message(2, &upright))
        .message(2, &Message::doubles([width, height, depth]))
        .message(3, &Message::doubles([r, g, b, 1.0]))
}

/// A protobuf message. As in every proto3 encoder, numbers that are 0 are left out.
///
/// Source: <https://protobuf.dev/programming-guides/encoding>.
#[derive(Default)]
struct Message(Vec<u8>);

/// The wire types of protobuf.
const VARINT: u64 = 0;
const FIXED_64_BITS: u64 = 1;
const LENGTH_DELIMITED: u64 = 2;

impl Message {
    /// A message with the doubles as the fields 1, 2, …
    fn doubles<const N: usize>(numbers: [f64; N]) -> Message {
        let mut message = Message::default();
        for (field, number) in (1..).zip(numbers).filter(|(_, number)| *number != 0.0) {
            message.write_tag(field, FIXED_64_BITS);
            message.0.extend(number.to_le_bytes());
        }
        message
    }

    fn integer(mut self, field: u64, number: u64) -> Message {
        if number != 0 {
            self.write_tag(field, VARINT);
            self.write_varint(number);
        }
        self
    }

    fn text(self, field: u64, text: &str) -> Message {
        self.with_bytes(field, text.as_bytes())
    }

    fn message(self, field: u64, message: &Message) -> Message {
        self.with_bytes(field, &message.0)
    }

    fn with_bytes(mut self, field: u64, bytes: &[u8]) -> Message {
        self.write_tag(field, LENGTH_DELIMITED);
        self.write_varint(bytes.len() as u64);
        self.0.extend(bytes);
        self
    }

    fn write_tag(&mut self, field: u64, wire_type: u64) {
        self.write_varint(field << 3 | wire_type);
    }

    /// Writes groups of 7 bits, the lowest first; the highest bit of a byte is set if another one follows.
    fn write_varint(&mut self, mut number: u64) {
        while number >= 0x80 {
            self.0.push(number as u8 | 0x80);
            number >>= 7;
        }
        self.0.push(number as u8);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::{Rect, Spawn, Vector};

    #[test]
    fn a_message_is_encoded_as_the_protobuf_specification_says() {
        let mut bytes = vec![7];
        encode(1_500_000_000, std::iter::empty(), |_| Color::hex(0), &mut bytes);
        let timestamp = [0x08, 0x01, 0x10, 0x80, 0xca, 0xb5, 0xee, 0x01];
        let deletion = [&[0x0a, 8][..], &timestamp, &[0x10, 0x01]].concat();
        let boxes = [&[0x0a, 8][..], &timestamp, &[0x12, 5], b"world", &[0x1a, 5], b"boxes"].concat();
        assert_eq!(bytes, [&[0x0a, 12][..], &deletion, &[0x12, 24], &boxes].concat());
    }

    #[test]
    fn the_colour_of_a_body_is_that_of_the_scene_also_with_an_image() {
        for paint in ["#3366cc", "#3366cc car.png"].map(String::from) {
            let spawn = Spawn::new("car", Rect::new(Vector::ZERO, 1.0, 1.0), 1.0);
            let table = BodyTable::from_iter([Arc::new(BodyInfo { id: 0, spawn, paint: paint.clone().into() })]);
            let difference_with = |color: Color| {
                let bodies = table.bodies().iter().map(|info| (info, info.initial_state()));
                let mut message = Vec::new();
                encode(0, bodies, |_| color, &mut message);
                difference(&message, 0, &table, &RecordedState::default(), &mut Colors::new())
            };
            assert_eq!(difference_with(Color::hex(0x3366cc)), None, "{paint}");
            let found = difference_with(Color::hex(0x3366cd));
            assert_eq!(
                found.as_deref(),
                Some("the scene update of state 0 has another colour of body \"car\""),
                "{paint}"
            );
        }
    }

    #[test]
    fn numbers_that_are_zero_are_left_out() {
        assert_eq!(Message::doubles([0.0, -0.0, 1.0]).0, [&[0x19][..], &1.0_f64.to_le_bytes()].concat());
    }
}
