//! The options of the commands that draw.

use super::arguments::OutputOptions;
use super::shard::Shard;
use super::values::{HoldWord, Overlays, color_by, overlays, pair, picture_size, positive, theme, window};
use crate::illustration::WishedWindow;
use crate::scene::{ColorBy, Theme};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// How pictures look; what no flag says the scene's `[figure]` says.
#[derive(Args, Debug)]
pub struct LookOptions {
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", value_parser = picture_size)]
    pub size: Option<[u32; 2]>,
    /// light or dark
    #[arg(long, value_parser = theme)]
    pub theme: Option<Theme>,
    /// none, or of velocity, force, normal, impulse, penetration, trail, name, mass, grid, axes,
    /// scale, clock
    #[arg(long, value_name = "LIST", value_parser = overlays)]
    pub show: Option<Overlays>,
    /// What colours tell: body, material or speed
    #[arg(long, value_name = "WHAT", value_parser = color_by)]
    pub color_by: Option<ColorBy>,
    /// What is seen: world, bodies, or X,Y,WIDTH,HEIGHT in metres
    #[arg(long, value_name = "AREA", value_parser = window, allow_hyphen_values = true)]
    pub window: Option<WishedWindow>,
    /// Keep this body in the middle, --window WxH around it
    #[arg(long, value_name = "NAME")]
    pub follow: Option<String>,
    /// What is written below
    #[arg(long, value_name = "TEXT")]
    pub caption: Option<String>,
}

/// Options of `render`.
#[derive(Args, Debug)]
#[command(after_help = "\
OUT.gif and .apng are animations, with ffmpeg .mp4 and .webm too; OUT.png, .svg
and .pdf with --at are one picture, any other name a folder of one PNG a step.
What no flag says the scene's [figure] says.

Examples:
  rebond render recordings/figure-1.toml -o figure-1.gif
  rebond render run.mcap -o frames/ --from 60 --to 120 --show name,clock
  rebond render run.mcap -o slow.apng --slow 0.1 --hold 0.5 at collisions
  rebond render run.mcap -o impact.svg --at 24 --theme dark --size 1920x1080")]
pub struct RenderOptions {
    /// A scene (.toml) or a recording (.mcap)
    pub source: PathBuf,
    /// Where the pictures go.
    #[command(flatten)]
    pub output: OutputOptions,
    /// Draw the state of this step alone
    #[arg(long, value_name = "STEP", conflicts_with_all = ["from", "to", "every", "fps"])]
    pub at: Option<u64>,
    /// The first step to draw
    #[arg(long, value_name = "STEP")]
    pub from: Option<u64>,
    /// The last step to draw
    #[arg(long, value_name = "STEP")]
    pub to: Option<u64>,
    /// Draw every N-th step, counted from step 0
    #[arg(long, value_name = "N", conflicts_with = "fps", value_parser = clap::value_parser!(u64).range(1..))]
    pub every: Option<u64>,
    /// Draw about that many frames for each second
    #[arg(long, value_parser = positive)]
    pub fps: Option<f64>,
    /// Draw part I of N of a folder of PNG
    #[arg(long, value_name = "I/N", default_value = "1/1", hide_default_value = true, conflicts_with = "at")]
    pub shard: Shard,
    /// Slow motion: simulated seconds a second, such as 0.1
    #[arg(long, value_name = "PACE", value_parser = positive)]
    pub slow: Option<f64>,
    /// Stop so long whenever bodies meet: 0.5 at collisions
    #[arg(long, num_args = 3, value_names = ["S", "at", "…"])]
    pub hold: Option<Vec<HoldWord>>,
    /// How it looks.
    #[command(flatten)]
    pub look: LookOptions,
    /// Threads to draw on [default: one for each processor]
    #[arg(long, value_name = "N")]
    pub jobs: Option<std::num::NonZero<usize>>,
}

impl RenderOptions {
    /// How long an animation stops at collisions, s.
    pub fn hold_seconds(&self) -> Option<f64> {
        self.hold.iter().flatten().find_map(|word| match word {
            HoldWord::Seconds(seconds) => Some(*seconds),
            HoldWord::At | HoldWord::Collisions => None,
        })
    }
}

/// Options of `figure`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  rebond figure collision recordings/figure-1.toml -o collision.svg
  rebond figure minkowski figure-1.mcap -o minkowski.pdf --pair c,b
  rebond figure filmstrip run.mcap -o strip.png --from 40 --to 90 --every 10
  rebond figure strobe bullet-handout.mcap bullet-exact.mcap -o bullets.svg")]
pub struct FigureCommandOptions {
    /// collision, minkowski, strobe, spacetime, energy or filmstrip
    #[arg(hide_possible_values = true)]
    pub kind: FigureKind,
    /// A scene (.toml) or a recording (.mcap); several are shown side by side
    #[arg(required = true, value_name = "SOURCE")]
    pub sources: Vec<PathBuf>,
    /// The file to write: .png, .svg or .pdf.
    #[command(flatten)]
    pub output: OutputOptions,
    /// How it looks.
    #[command(flatten)]
    pub look: LookOptions,
    /// collision, minkowski: the first collision from here on
    #[arg(long, value_name = "STEP", default_value_t = 0)]
    pub step: u64,
    /// collision, minkowski: only of these two bodies
    #[arg(long, value_name = "A,B", value_parser = pair)]
    pub pair: Option<[String; 2]>,
    /// spacetime: which coordinate to draw over time, x or y
    #[arg(long, default_value = "x", hide_possible_values = true)]
    pub axis: FigureAxis,
    /// The first step to draw
    #[arg(long, value_name = "STEP")]
    pub from: Option<u64>,
    /// The last step to draw
    #[arg(long, value_name = "STEP")]
    pub to: Option<u64>,
    /// Draw every N-th step, counted from step 0 [default: what suits]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub every: Option<u64>,
    /// What is written above each of several [default: their own titles]
    #[arg(long, value_name = "TEXT")]
    pub title: Vec<String>,
}

/// Which figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FigureKind {
    /// The handout's figure 1: before, the overlap and its normal, after
    Collision,
    /// The handout's figure 2: the Minkowski difference and the four ways out
    Minkowski,
    /// Many instants in one picture, fading
    Strobe,
    /// Places against time
    Spacetime,
    /// Energy and momentum against time, with their drift
    Energy,
    /// Panels of chosen steps
    Filmstrip,
}

/// Which coordinate a space-time figure shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FigureAxis {
    /// To the right
    X,
    /// Downwards
    Y,
}
