/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The picture asked for cannot be held.
    #[error("a picture of {width}×{height} pixels cannot be drawn: each side must be 1 to {largest} pixels")]
    PictureSize {
        /// Pixels.
        width: u32,
        /// Pixels.
        height: u32,
        /// Pixels a side may have.
        largest: u32,
    },
    /// There is no such world.
    #[error("a world of {width} m × {height} m cannot be shown: both must be finite and positive")]
    WorldSize {
        /// m.
        width: f64,
        /// m.
        height: f64,
    },
    /// An animation has not the number of pictures it begins by announcing.
    #[error("an animation of {expected} pictures was to be written, but there are {found}")]
    PictureCount {
        /// As announced.
        expected: u64,
        /// As they came.
        found: u64,
    },
    /// The place written to refused.
    #[error(transparent)]
    Write(#[from] std::io::Error),
    /// The file read from refused.
    #[error(transparent)]
    Read(std::io::Error),
    /// A picture's file is damaged or of another kind.
    #[error("no picture file that can be read: {0}")]
    Unreadable(String),
}
