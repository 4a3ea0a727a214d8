//! Boxes as viewers of MCAP draw them: `foxglove.SceneUpdate` of Foxglove's schemas.
//!
//! In a viewer z is up and y goes to the left, so the world lies on its floor, y turned
//! over. Only the fields that are used are spelt out; the schema in the file has them all.

use std::sync::Arc;

use prost::Message;

use super::KnownBody;

/// The colour in which viewers are to show a body: red, green, blue.
pub type Paint = fn(&KnownBody) -> [u8; 3];

/// A `FileDescriptorSet` of the schema and all that it names, which protobuf readers want:
/// that of Foxglove's package `foxglove-schemas-protobuf` 0.4.0 (MIT).
pub const SCHEMA: &[u8] = include_bytes!("schemas/foxglove.SceneUpdate.bin");

/// The message that shows these bodies at that time (simulated nanoseconds) and no others.
///
/// Each message first deletes whatever was shown, so that a viewer shows the right picture
/// wherever it is scrubbed to.
pub fn encode<'a>(
    time: u64,
    bodies: impl Iterator<Item = (&'a Arc<KnownBody>, [f64; 4])>,
    paint: Paint,
    bytes: &mut Vec<u8>,
) {
    let timestamp = Some(Timestamp::at(time));
    let cubes = bodies.map(|(known, [x, y, ..])| CubePrimitive::new(known, x, y, paint)).collect();
    let update = SceneUpdate {
        deletions: vec![SceneEntityDeletion { timestamp, kind: DELETE_ALL }],
        entities: vec![SceneEntity { timestamp, frame_id: "world".into(), id: "boxes".into(), cubes }],
    };
    bytes.clear();
    update.encode(bytes).expect("memory takes all bytes");
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
    /// A body whose upper-left corner is there, m; as deep as its smaller side is long.
    fn new(known: &KnownBody, x: f64, y: f64, paint: Paint) -> CubePrimitive {
        let [width, height] = [known.spawn.rect.width(), known.spawn.rect.height()];
        let depth = if width < height { width } else { height };
        let middle = Vector3 { x: x + width / 2.0, y: -(y + height / 2.0), z: depth / 2.0 };
        let [r, g, b] = paint(known).map(|part| f64::from(part) / 255.0);
        CubePrimitive {
            pose: Some(Pose { position: Some(middle), orientation: Some(Quaternion { w: 1.0 }) }),
            size: Some(Vector3 { x: width, y: height, z: depth }),
            color: Some(Color { r, g, b, a: 1.0 }),
        }
    }
}
