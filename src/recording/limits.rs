//! What a recording may hold at most: held when writing and when reading, so that what
//! was written can be read and a hostile length costs nothing.

/// Bytes of one MCAP record, of a chunk before and of a chunk after decompression: with
/// what is made of it, a file that lies costs less than 100 MB.
pub const RECORD_BYTES: usize = 40 << 20;

/// Bytes after which a chunk is closed; larger chunks compress better, smaller ones lose
/// less.
pub const CHUNK_BYTES: usize = 4 << 20;

/// Bytes of one message: with a chunk that is almost full it still fits into a record.
pub const MESSAGE_BYTES: usize = RECORD_BYTES - CHUNK_BYTES - (1 << 20);

/// Bytes of a keyframe: in memory it takes up to three times as much.
pub const KEYFRAME_BYTES: usize = 28 << 20;

/// Bytes of an event: one body and its three texts.
pub const EVENT_BYTES: usize = 4 * STRING_BYTES;

/// Bytes of a name, material or colour.
pub const STRING_BYTES: usize = 4096;

/// Bytes of a scene's text.
pub const SCENE_BYTES: usize = 32 << 20;

/// Bodies alive at one time: so many that a state fits into a message (36 bytes each).
pub const BODIES: usize = 1_000_000;

/// The last step of the longest run: beyond it a double does not count every step.
pub const STEPS: u64 = 1 << 53;

/// Materials that the restitution table names.
pub const MATERIALS: usize = 256;

const _: () = assert!(64 + 36 * BODIES <= MESSAGE_BYTES);
