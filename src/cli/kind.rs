use super::{arguments::RenderOptions, error::CommandError, output};
use std::path::Path;

/// What is to be made, as the name of the result says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// One animation for any program: at most 256 colours a picture, at most 50 pictures a second.
    Gif,
    /// One animation with every colour and every instant exact.
    Apng,
    /// One state.
    Picture,
    /// A folder with a picture a step.
    Sequence,
}

impl Kind {
    /// The kind that the name of the result and --at ask for.
    pub fn of(options: &RenderOptions) -> Result<Kind, CommandError> {
        let path = &options.output.output;
        let unknown = |expected| Err(CommandError::UnknownKind { path: path.clone(), expected });
        let extension = path.extension().and_then(|extension| extension.to_str());
        match (extension, options.at) {
            (Some("png"), Some(_)) => Ok(Kind::Picture),
            (Some("png"), None) => unknown("one picture needs --at STEP; a folder of pictures has a name without .png"),
            (Some("gif"), None) => Ok(Kind::Gif),
            (Some("apng"), None) => Ok(Kind::Apng),
            (None, Some(_)) if output::is_standard_output(path) => Ok(Kind::Picture),
            (None, None) if output::is_standard_output(path) => Ok(Kind::Gif),
            (None, None) => Ok(Kind::Sequence),
            (_, Some(_)) => unknown("--at STEP makes one picture, OUT.png"),
            (Some(_), None) if path.is_dir() || path.as_os_str().to_string_lossy().ends_with('/') => Ok(Kind::Sequence),
            (Some(_), None) => unknown("OUT.gif, OUT.apng, OUT.png with --at STEP, or a folder OUT/"),
        }
    }

    /// Refuses early what would be refused after all the work.
    pub fn refuse_existing(self, path: &Path, force: bool) -> Result<(), CommandError> {
        match self {
            Kind::Sequence => Ok(()),
            Kind::Gif | Kind::Apng | Kind::Picture if output::is_standard_output(path) => Ok(()),
            Kind::Gif | Kind::Apng | Kind::Picture => output::refuse_existing(path, force),
        }
    }
}
