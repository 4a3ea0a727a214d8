use super::{error::CommandError, output, picture_arguments::RenderOptions, shard::Shard};
use crate::illustration::Format;
use std::path::Path;

/// What is to be made, as the name of the result says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// One animation.
    Animation(Format),
    /// One animation that the user's ffmpeg makes.
    Video(Container),
    /// One state.
    Picture(Format),
    /// A folder with a picture a step.
    Sequence,
}

/// What ffmpeg is to make.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Container {
    /// H.264 in MP4, for slides and browsers.
    Mp4,
    /// VP9 in WebM.
    Webm,
}

impl Kind {
    /// The kind that the name of the result and --at ask for.
    pub fn of(options: &RenderOptions) -> Result<Kind, CommandError> {
        let path = &options.output.output;
        let unknown = |expected| Err(CommandError::UnknownKind { path: path.clone(), expected });
        let is_folder = path.is_dir() || path.as_os_str().to_string_lossy().ends_with('/');
        let extension = path.extension().and_then(|extension| extension.to_str());
        match (extension, Format::of_name(path), options.at) {
            (_, Some(format), Some(_)) if !format.is_animated() => Ok(Kind::Picture(format)),
            (_, Some(format), None) if format.is_animated() => Ok(Kind::Animation(format)),
            (_, Some(_), None) => unknown("one picture needs --at STEP; a folder of pictures has a name without .png"),
            (Some("mp4"), _, None) => Ok(Kind::Video(Container::Mp4)),
            (Some("webm"), _, None) => Ok(Kind::Video(Container::Webm)),
            (None, None, Some(_)) if output::is_standard_output(path) => Ok(Kind::Picture(Format::Png)),
            (None, None, None) if output::is_standard_output(path) => Ok(Kind::Animation(Format::Gif)),
            (None, None, None) => Ok(Kind::Sequence),
            (_, _, Some(_)) => unknown("--at STEP makes one picture, OUT.png, OUT.svg or OUT.pdf"),
            (Some(_), None, None) if is_folder => Ok(Kind::Sequence),
            (Some(_), None, None) => {
                unknown("OUT.gif, OUT.apng, OUT.mp4, OUT.webm, OUT.png with --at STEP, or a folder OUT/")
            }
        }
    }

    /// Refuses to make a part of what is not made in parts.
    pub fn refuse_shard(self, path: &Path, shard: Shard) -> Result<(), CommandError> {
        match self {
            Kind::Sequence => Ok(()),
            Kind::Animation(_) | Kind::Picture(_) | Kind::Video(_) if shard == Shard::WHOLE => Ok(()),
            Kind::Animation(_) | Kind::Picture(_) | Kind::Video(_) => Err(CommandError::UnknownKind {
                path: path.into(),
                expected: "--shard makes a part of a folder OUT/ of one PNG a step; a single file has no parts",
            }),
        }
    }

    /// Refuses early what would be refused after all the work.
    pub fn refuse_existing(self, path: &Path, force: bool) -> Result<(), CommandError> {
        match self {
            Kind::Sequence => Ok(()),
            Kind::Animation(_) | Kind::Picture(_) if output::is_standard_output(path) => Ok(()),
            Kind::Animation(_) | Kind::Picture(_) | Kind::Video(_) => output::refuse_existing(path, force),
        }
    }
}
