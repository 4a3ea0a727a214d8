//! Limits of a recording. The writer and the reader enforce the same limits, so that every written
//! recording is readable and a hostile length field cannot cause a large allocation.

/// Bytes of one MCAP record, and of a chunk before and after decompression. Including the
/// decoded data, reading a hostile file needs less than 100 MB of memory.
pub const RECORD_BYTES: usize = 40 << 20;

/// Bytes of all chunks that are open together, uncompressed, in a file whose messages are not in order of time.
pub const OPEN_CHUNK_BYTES: usize = 2 * RECORD_BYTES;

/// Chunks and sequences of messages that are open together in such a file.
pub const OPEN_PARTS: usize = 256;

/// Bytes after which a chunk is closed. Larger chunks compress better; smaller ones lose less data
/// when damaged.
pub const CHUNK_BYTES: usize = 4 << 20;

/// Bytes of one message. Added to an almost full chunk, it still fits into a record.
pub const MESSAGE_BYTES: usize = RECORD_BYTES - CHUNK_BYTES - (1 << 20);

/// Bytes of one message of a keyframe. In memory it needs up to three times as much. Larger keyframes are divided into
/// several messages.
pub const KEYFRAME_BYTES: usize = 28 << 20;

/// Integers, and likewise numbers, of the state of a solver in a keyframe of several messages, per body.
pub const SOLVER_NUMBERS: usize = 256;

/// Bytes of an event: one body with its three strings.
pub const EVENT_BYTES: usize = 4 * STRING_BYTES;

/// Bytes of a name, material or colour string.
pub const STRING_BYTES: usize = 4096;

/// Bytes of the scene text.
pub const SCENE_BYTES: usize = 32 << 20;

/// Bytes of an image file of a scene.
pub const IMAGE_BYTES: usize = 4 << 20;

/// Bytes of all image files of a scene.
pub const IMAGES_BYTES: usize = 16 << 20;

/// Image files of a scene.
pub const IMAGES: usize = 1000;

/// Pixels along each side of an image of a scene.
pub const IMAGE_SIDE: u32 = 4096;

/// Pixels of all images of a scene: 32 MiB in memory.
pub const IMAGES_PIXELS: u64 = 8 << 20;

/// Bodies alive at the same time. A state (36 bytes per body) then fits into a message.
pub const BODIES: usize = 1_000_000;

/// The last step of the longest run. Larger step numbers are not exact as f64.
pub const STEPS: u64 = 1 << 53;

/// The longest run, s: a recording stores its nanoseconds in 64 bits.
pub const SECONDS: f64 = 18_446_744_073.0;

/// Gaps of a recovered recording.
pub const GAPS: usize = 100_000;

/// Materials in the restitution table.
pub const MATERIALS: usize = 256;

const _: () = assert!(64 + 36 * BODIES <= MESSAGE_BYTES);
