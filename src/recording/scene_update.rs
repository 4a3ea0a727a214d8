//! Scene updates: boxes for MCAP viewers, as `foxglove.SceneUpdate` messages.
//!
//! Viewers have z up and y to the left, so the world is drawn in the plane z = 0 with y negated. The
//! structs contain only the fields in use; the schema in the file contains all.

use std::sync::Arc;

use prost::Message;

use super::BodyInfo;

/// Returns the colour of a body in viewers: red, green, blue.
pub type ColorFn = fn(&BodyInfo) -> [u8; 3];

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
    color: ColorFn,
    bytes: &mut Vec<u8>,
) {
    let timestamp = Some(Timestamp::at(time));
    let cubes = bodies.map(|(info, [x, y, ..])| CubePrimitive::new(info, x, y, color)).collect();
    let update = SceneUpdate {
        deletions: vec![SceneEntityDeletion { timestamp, kind: DELETE_ALL }],
        entities: vec![SceneEntity { timestamp, frame_id: "world".into(), id: "boxes".into(), cubes }],
    };
    bytes.clear();
    update.encode(bytes).expect("writing to memory cannot fail");
}

/// `SceneEntityDeletion.ALL`.
const DELETE_ALL: i32 = 1;

#[derive(Clone, PartialEq, Message)]
struct SceneUpdate {
    #[prost(message, repeated, tag = "1")]
    deletions: Vec<SceneEntityDeletion>,
    #[prost(message, repeated, tag = "2")]
    entities: Vec<SceneEntity>,
}

#[derive(Clone, PartialEq, Message)]
struct SceneEntityDeletion {
    #[prost(message, tag = "1")]
    timestamp: Option<Timestamp>,
    #[prost(int32, tag = "2")]
    kind: i32,
}

#[derive(Clone, PartialEq, Message)]
struct SceneEntity {
    #[prost(message, tag = "1")]
    timestamp: Option<Timestamp>,
    #[prost(string, tag = "2")]
    frame_id: String,
    #[prost(string, tag = "3")]
    id: String,
    #[prost(message, repeated, tag = "8")]
    cubes: Vec<CubePrimitive>,
}

#[derive(Clone, PartialEq, Message)]
struct CubePrimitive {
    #[prost(message, tag = "1")]
    pose: Option<Pose>,
    #[prost(message, tag = "2")]
    size: Option<Vector3>,
    #[prost(message, tag = "3")]
    color: Option<Color>,
}

#[derive(Clone, Copy, PartialEq, Message)]
struct Pose {
    #[prost(message, tag = "1")]
    position: Option<Vector3>,
    #[prost(message, tag = "2")]
    orientation: Option<Quaternion>,
}

#[derive(Clone, Copy, PartialEq, Message)]
struct Vector3 {
    #[prost(double, tag = "1")]
    x: f64,
    #[prost(double, tag = "2")]
    y: f64,
    #[prost(double, tag = "3")]
    z: f64,
}

#[derive(Clone, Copy, PartialEq, Message)]
struct Quaternion {
    #[prost(double, tag = "4")]
    w: f64,
}

#[derive(Clone, Copy, PartialEq, Message)]
struct Color {
    #[prost(double, tag = "1")]
    r: f64,
    #[prost(double, tag = "2")]
    g: f64,
    #[prost(double, tag = "3")]
    b: f64,
    #[prost(double, tag = "4")]
    a: f64,
}

#[derive(Clone, Copy, PartialEq, Message)]
struct Timestamp {
    #[prost(int64, tag = "1")]
    seconds: i64,
    #[prost(int32, tag = "2")]
    nanos: i32,
}

impl Timestamp {
    fn at(nanoseconds: u64) -> Timestamp {
        const SECOND: u64 = 1_000_000_000;
        Timestamp { seconds: (nanoseconds / SECOND) as i64, nanos: (nanoseconds % SECOND) as i32 }
    }
}

impl CubePrimitive {
    /// The cube of a body whose upper-left corner is at `x`, `y` (m). Its depth is its smaller side.
    fn new(info: &BodyInfo, x: f64, y: f64, color: ColorFn) -> CubePrimitive {
        let [width, height] = [info.spawn.rect.width(), info.spawn.rect.height()];
        let depth = if width < height { width } else { height };
        let center = Vector3 { x: x + width / 2.0, y: -(y + height / 2.0), z: depth / 2.0 };
        let [r, g, b] = color(info).map(|channel| f64::from(channel) / 255.0);
        CubePrimitive {
            pose: Some(Pose { position: Some(center), orientation: Some(Quaternion { w: 1.0 }) }),
            size: Some(Vector3 { x: width, y: height, z: depth }),
            color: Some(Color { r, g, b, a: 1.0 }),
        }
    }
}
