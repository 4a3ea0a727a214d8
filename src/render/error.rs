use crate::counted::counted;

/// An error of drawing, encoding or decoding a picture.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The size of the picture is zero or too large.
    #[error("a picture of {width}×{height} pixels cannot be drawn: each side must be 1 to {max_side} pixels")]
    PictureSize {
        /// Width, px.
        width: u32,
        /// Height, px.
        height: u32,
        /// Maximum width and height, px.
        max_side: u32,
    },
    /// The visible part of the world is empty or not finite.
    #[error("an area of {width} m × {height} m cannot be shown: width and height must be finite and positive")]
    WorldSize {
        /// Width, m.
        width: f64,
        /// Height, m.
        height: f64,
    },
    /// The number of frames of an animation differs from the number in its header.
    #[error("the header of the animation announces {}, but it has {found}", counted(*.expected, "frame"))]
    PictureCount {
        /// Number in the header.
        expected: u64,
        /// Number of frames written.
        found: u64,
    },
    /// Writing the output failed.
    #[error(transparent)]
    Write(#[from] std::io::Error),
    /// Reading the input failed.
    #[error(transparent)]
    Read(std::io::Error),
    /// The picture file is damaged or has another format.
    #[error("the picture file cannot be read: {0}")]
    Unreadable(String),
}
