use super::{arguments::Shard, error::CommandError, output, picture_arguments::RenderOptions};
use crate::picture::{AnimationFormat, Format, StillFormat, SubjectOptions};
use std::path::Path;

/// The kind of output of `render`.
#[derive(Clone, Debug, PartialEq)]
pub enum OutputKind {
    /// One file that is drawn without ffmpeg.
    File(SubjectOptions),
    /// One animation, compressed by ffmpeg.
    Video(VideoContainer),
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
        let state = |step, format| Ok(OutputKind::File(SubjectOptions::State { step, format }));
        let animation = |format| Ok(OutputKind::File(SubjectOptions::Animation { format }));
        let is_folder = path.is_dir() || path.as_os_str().to_string_lossy().ends_with('/');
        let extension = path.extension().and_then(|extension| extension.to_str());
        match (extension, Format::from_path(path), options.at) {
            (_, Some(Format::Still(format)), Some(step)) => state(step, format),
            (_, Some(Format::Animation(format)), None) => animation(format),
            (_, Some(Format::Still(_)), None) => {
                unsupported("a single picture needs --at STEP; a folder of pictures needs a name without an extension")
            }
            (Some("mp4"), _, None) => Ok(OutputKind::Video(VideoContainer::Mp4)),
            (Some("webm"), _, None) => Ok(OutputKind::Video(VideoContainer::Webm)),
            (None, None, Some(step)) if output::is_standard_output(path) => state(step, StillFormat::Png),
            (None, None, None) if output::is_standard_output(path) => animation(AnimationFormat::Gif),
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
    pub fn refuse_shard(&self, path: &Path, shard: Shard) -> Result<(), CommandError> {
        match self {
            OutputKind::Sequence => Ok(()),
            OutputKind::File(_) | OutputKind::Video(_) if shard == Shard::WHOLE => Ok(()),
            OutputKind::File(_) | OutputKind::Video(_) => Err(CommandError::UnsupportedOutput {
                path: path.into(),
                expected: "--shard needs a folder OUT/ as output; a single file has no parts",
            }),
        }
    }

    /// Returns an error before any work is done if the output exists and may not be overwritten.
    pub fn refuse_existing(&self, path: &Path, force: bool) -> Result<(), CommandError> {
        match self {
            OutputKind::Sequence => Ok(()),
            OutputKind::File(_) if output::is_standard_output(path) => Ok(()),
            OutputKind::File(_) | OutputKind::Video(_) => output::refuse_existing(path, force),
        }
    }
}
