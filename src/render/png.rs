//! Pictures as PNG files.

use super::{Metadata, Picture, RenderError};
use std::io::Write;

/// Writes a picture as a PNG file; indexed when it has at most 256 colours.
///
/// # Errors
/// When `output` refuses.
pub fn encode(_picture: &Picture, _metadata: &Metadata, _output: impl Write) -> Result<(), RenderError> {
    todo!("first pictures follow")
}
