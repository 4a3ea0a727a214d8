//! Pictures, animations and figures of recordings, with their provenance.
//!
//! A picture is made in these stages:
//!
//! 1. A [`Source`] is a recording with its scene and [`RunStatistics`].
//! 2. [`SubjectOptions`] name the picture and its format; [`PictureOptions`] may leave everything else open.
//! 3. [`PictureOptions::resolve`] takes open options from the scene, then from the defaults. The result is a
//!    [`ResolvedPicture`]: a [`Page`] or an [`Animation`], the format of its file, and a [`Look`].
//! 4. [`Provenance`] adds the identity of the recordings. Its text form is stored in the file, from which
//!    [`Provenance::read`] and [`redraw`] restore the picture. It contains no path, date, number of threads or shard.
//! 5. [`draw`] computes a [`Style`], that is, the look with the scales of the run, and reads [`Frames`] from the
//!    recording, or from a replay if it needs collisions or instants between steps.
//! 6. `layers` and [`figures`] lay out a frame or figure as a [`DisplayList`] of shapes; a [`Stage`] lays out the
//!    [`Instants`] of an animation, of one recording or of several side by side.
//! 7. [`encode`] writes the shapes as SVG or PDF, or rasterises them with a [`Painter`] to PNG, animated PNG or GIF.
//!
//! A [`Sequence`] of still pictures and a [`Clip`] for an external video encoder follow the same stages.

mod clip;
mod collisions;
mod draw;
pub mod encode;
pub mod figures;
mod format;
mod frames;
mod impacts;
pub(crate) mod layers;
mod moving_world;
pub(crate) mod number;
mod option_line;
mod page;
mod provenance;
pub mod raster;
mod resimulation;
mod resolve;
mod resolved;
mod run_statistics;
mod schedule;
mod side_by_side;
mod source;
pub mod text;
mod trace;
#[cfg(test)]
mod trace_tests;
mod traced_step;
mod view;
mod visibility;

use crate::recording::{self, Health, error_text};
use crate::replay::Verdict;
use crate::scene::SceneError;
use std::path::{Path, PathBuf};

pub use crate::picture_options::{
    CameraTarget, ColorBy, Language, Look, Overlay, Overlays, PictureOptions, Quantity, ReferenceFrame, TextAs, Theme,
    Window,
};
pub use clip::{Clip, Instant, Instants, Shot};
pub use draw::{Drawn, body_color, draw, draw_options, draw_sequence, draw_to_vec, redraw};
pub(crate) use draw::{lacking_states, with_states};
pub(crate) use encode::ordered_parallel_map;
pub use encode::{
    AnimationDecoder, DecodedFrame, Metadata, PngEffort, RenderError, apng, compare, draw_frames, gif, pdf, png, svg,
    write_apng, write_gif, write_png, write_png_sequence,
};
pub use figures::EnergySample;
pub use format::{AnimationFormat, Format, StillFormat};
pub use frames::Frames;
pub use layers::{Appearance, Arrow, ArrowLength, Frame, Sprite, Trails, compose};
pub use provenance::{Provenance, SOFTWARE};
pub(crate) use raster::color;
pub use raster::{Bitmap, Color, DisplayList, Ink, Painter, Palette, Picture, Shape, color_by_speed};
pub use resolve::{FigureOptions, Sequence, SubjectOptions};
pub use resolved::{
    Animation, CollisionFigure, CollisionSelector, Page, ResolvedPicture, StatesFigure, StepRange, Subject,
};
pub use run_statistics::RunStatistics;
pub use schedule::{
    AnimationSchedule, MAX_FRAMES, MAX_FRAMES_PER_STEP, MAX_GIF_FPS, MAX_HOLD, MIN_HOLD, Moment, SPEEDS, StepGrid,
    Thinning, Timing,
};
pub use side_by_side::{SideBySide, Stage};
pub use source::{ReadExtent, ReadStatus, Source, recorded_world};
pub use trace::{GapReason, TraceGap};
pub use view::{Camera, DrawingMetrics, Style, View};

/// A callback that receives the number of completed work items and their total.
pub type Progress<'a> = &'a mut dyn FnMut(u64, u64);

/// The reason why a picture could not be drawn or read.
#[non_exhaustive]
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A recording cannot be read.
    #[error("{}: {source}", path.display())]
    Recording {
        /// The recording.
        path: PathBuf,
        /// The cause.
        source: recording::Error,
    },
    /// The scene stored in a recording is invalid.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// An image of the scene cannot be drawn.
    #[error("{}: the image {image:?} of its scene cannot be drawn: {reason}", path.display())]
    Image {
        /// The recording.
        path: PathBuf,
        /// The name of the image.
        image: String,
        /// The reason.
        reason: String,
    },
    /// Drawing, encoding or decoding failed.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The recording does not contain the requested subject.
    #[error("there is nothing to show: {reason}")]
    NothingToShow {
        /// The missing subject, and the existing alternatives.
        reason: String,
    },
    /// A damaged recording does not contain the requested subject, or has lost it.
    #[error("there is nothing to show: {reason}; {} is {health}", path.display())]
    NothingReadable {
        /// The recording.
        path: PathBuf,
        /// The missing subject, and the existing alternatives.
        reason: String,
        /// The condition of the recording.
        health: Box<Health>,
    },
    /// Options that fit no recording: of another kind of figure, or for another number of recordings.
    #[error("{reason}")]
    Misused {
        /// The reason, and what to do.
        reason: String,
    },
    /// Options that cannot be combined.
    #[error("{reason}")]
    Incompatible {
        /// The conflict, and what to do instead.
        reason: String,
    },
    /// The replay of a recording diverged, so its collisions are unknown.
    #[error("{}: {verdict}", path.display())]
    Diverged {
        /// The recording.
        path: PathBuf,
        /// The divergence.
        verdict: Box<Verdict>,
    },
    /// The engine failed in a step that a picture needs.
    #[error("{}: {}", path.display(), error_text(source))]
    Step {
        /// The recording.
        path: PathBuf,
        /// The cause.
        source: crate::physics::StepError,
    },
    /// A file is not a picture drawn by rebond.
    #[error("the file carries no rebond provenance: {reason}")]
    NoProvenance {
        /// The missing or invalid part.
        reason: String,
    },
    /// The provenance of a picture is damaged.
    #[error("the rebond provenance of the file is damaged: {reason}")]
    DamagedProvenance {
        /// The missing or invalid part.
        reason: String,
    },
    /// A picture cannot be drawn again.
    #[error("the picture cannot be drawn again: {reason}")]
    CannotRedraw {
        /// The recording that is missing or unsuitable.
        reason: String,
    },
}

impl Error {
    /// Returns the health of the recording at `path` after its replay.
    ///
    /// # Errors
    /// If the replay diverged.
    pub(crate) fn unless_diverged(verdict: Verdict, path: &Path) -> Result<Health, Error> {
        match verdict.health() {
            Some(health) => Ok(health),
            None => Err(Error::Diverged { path: path.into(), verdict: Box::new(verdict) }),
        }
    }

    /// The same error, which names its recording if there are several.
    fn of_source(self, source: &Source, sources: &[Source]) -> Error {
        match self {
            Error::NothingToShow { reason } if sources.len() > 1 => {
                Error::NothingToShow { reason: format!("{}: {reason}", source.path.display()) }
            }
            error => error,
        }
    }
}
