use super::{error::CommandError, output, picture_arguments::RenderOptions, shard::Shard};
use crate::picture::Format;
use std::path::Path;

/// The kind of output of `render`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputKind {
    /// One animation.
    Animation(Format),
    /// One animation, compressed by ffmpeg.
    Video(VideoContainer),
    /// A picture of one state.
    Picture(Format),
    /// A folder with one picture per step.
    Sequence,
}

/// The file format that ffmpeg writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VideoContainer {
    /// H.264 in MP4, for slides and browsers.
    Mp4,
    /// VP9 in WebM.
    Webm,
}

impl OutputKind {
    /// Determines the kind from the name of the output and `--at`.
    pub fn from_options(options: &RenderOptions) -> Result<OutputKind, CommandError> {
        let path = &options.output.output;
        let unsupported = |expected| Err(CommandError::UnsupportedOutput { path: path.clone(), expected });
        let is_folder = path.is_dir() || path.as_os_str().to_string_lossy().ends_with('/');
        let extension = path.extension().and_then(|extension| extension.to_str());
        match (extension, Format::from_path(path), options.at) {
            (_, Some(format), Some(_)) if !format.is_animated() => Ok(OutputKind::Picture(format)),
            (_, Some(format), None) if format.is_animated() => Ok(OutputKind::Animation(format)),
            (_, Some(_), None) => {
                unsupported("a single picture needs --at STEP; a folder of pictures needs a name without an extension")
            }
            (Some("mp4"), _, None) => Ok(OutputKind::Video(VideoContainer::Mp4)),
            (Some("webm"), _, None) => Ok(OutputKind::Video(VideoContainer::Webm)),
            (None, None, Some(_)) if output::is_standard_output(path) => Ok(OutputKind::Picture(Format::Png)),
            (None, None, None) if output::is_standard_output(path) => Ok(OutputKind::Animation(Format::Gif)),
            (None, None, None) => Ok(OutputKind::Sequence),
            (_, _, Some(_)) => unsupported("--at STEP draws a single picture: OUT.png, OUT.svg or OUT.pdf"),
            (Some(_), None, None) if is_folder => Ok(OutputKind::Sequence),
            (Some(_), None, None) => unsupported(
                "expected OUT.gif, OUT.apng, OUT.mp4, OUT.webm, a folder OUT/, or with --at STEP OUT.png, OUT.svg or \
                     OUT.pdf",
            ),
        }
    }

    /// Returns an error if only a part is requested of an output that has no parts.
    pub fn refuse_shard(self, path: &Path, shard: Shard) -> Result<(), CommandError> {
        match self {
            OutputKind::Sequence => Ok(()),
            OutputKind::Animation(_) | OutputKind::Picture(_) | OutputKind::Video(_) if shard == Shard::WHOLE => Ok(()),
            OutputKind::Animation(_) | OutputKind::Picture(_) | OutputKind::Video(_) => {
                Err(CommandError::UnsupportedOutput {
                    path: path.into(),
                    expected: "--shard needs a folder OUT/ as output; a single file has no parts",
                })
            }
        }
    }

    /// Returns an error before any work is done if the output exists and may not be overwritten.
    pub fn refuse_existing(self, path: &Path, force: bool) -> Result<(), CommandError> {
        match self {
            OutputKind::Sequence => Ok(()),
            OutputKind::Animation(_) | OutputKind::Picture(_) if output::is_standard_output(path) => Ok(()),
            OutputKind::Animation(_) | OutputKind::Picture(_) | OutputKind::Video(_) => {
                output::refuse_existing(path, force)
            }
        }
    }
}
