//! The options of the commands that draw.

use super::arguments::{JobOptions, OutputOptions, Shard};
use crate::body_selector::BodySelector;
use crate::physics::Axis;
use crate::picture::{
    CollisionFigure, FigureOptions, MAX_HOLD, MIN_HOLD, PictureOptions, Quantity, SPEEDS, StatesFigure,
};
use crate::picture_options::StepOrTime;
use crate::scene::Sweep;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Options of `render`.
#[derive(Args, Debug)]
#[command(after_help = "\
OUT is .gif, .apng, .mp4, .webm, a folder of PNG, or with --at .png, .svg, .pdf.

Examples:
  rebond render run.mcap -o slow.apng --slow 0.1 --hold 0.5 at collisions
  rebond render bullet-handout.mcap bullet-exact.mcap -o bullets.gif")]
pub struct RenderOptions {
    /// Scenes (.toml) or recordings (.mcap), side by side
    #[arg(required = true, value_name = "SOURCE")]
    pub sources: Vec<PathBuf>,
    /// The output file or folder.
    #[command(flatten)]
    pub output: OutputOptions,
    /// Override values of scenes; KEY=[A | B] are two
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<Sweep>,
    /// Draw only the state of this step or time (1.5s)
    #[arg(long, value_name = "STEP", conflicts_with_all = ["from", "to", "every", "fps"])]
    pub at: Option<StepOrTime>,
    /// Draw about this many frames per second
    #[arg(long, conflicts_with = "every", value_parser = positive)]
    pub fps: Option<f64>,
    /// Draw only part I of N of a folder of PNG files
    #[arg(long, value_name = "I/N", default_value = "1/1", hide_default_value = true, conflicts_with = "at")]
    pub shard: Shard,
    /// Play in slow motion, for example 0.1 times as fast
    #[arg(long, value_name = "PACE", value_parser = speed)]
    pub slow: Option<f64>,
    /// Pause S seconds, for example 0.5 at collisions
    #[arg(long, num_args = 3, value_names = ["S", "at", "…"])]
    pub hold: Option<Vec<HoldWord>>,
    /// Allow more than an hour or 100,000 frames
    #[arg(long)]
    pub long: bool,
    /// Title of a source; repeatable [default: the scene's]
    #[arg(long, value_name = "TEXT")]
    pub title: Vec<String>,
    /// The appearance.
    #[command(flatten)]
    pub picture: PictureOptions,
    /// The number of threads.
    #[command(flatten)]
    pub jobs: JobOptions,
}

impl RenderOptions {
    /// The options of the picture.
    pub fn picture_options(&self) -> PictureOptions {
        let hold = self.hold.iter().flatten().find_map(|word| match word {
            HoldWord::Seconds(seconds) => Some(*seconds),
            HoldWord::At | HoldWord::Collisions => None,
        });
        let titles = Some(self.title.clone()).filter(|titles| !titles.is_empty());
        PictureOptions { fps: self.fps, slow: self.slow, hold, titles, ..self.picture.clone() }
    }
}

/// Options of `figure`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  rebond figure collision recordings/figure-1.toml -o collision.svg
  rebond figure filmstrip run.mcap -o strip.png --from 40 --to 90 --every 10
  rebond figure lines run.toml --set 'restitution.default=[0.9 | 0.5]' -o e.svg
  rebond figure strobe bullet-handout.mcap bullet-exact.mcap -o bullets.svg")]
pub struct FigureCommandOptions {
    /// The figure: collision, minkowski, strobe, spacetime, energy, filmstrip,
    /// lines, speeds or velocity-space
    #[arg(hide_possible_values = true)]
    pub kind: FigureKind,
    /// Scenes (.toml) or recordings (.mcap), side by side
    #[arg(required = true, value_name = "SOURCE")]
    pub sources: Vec<PathBuf>,
    /// The output file: .png, .svg or .pdf.
    #[command(flatten)]
    pub output: OutputOptions,
    /// Override values of scenes; KEY=[A | B] are two
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<Sweep>,
    /// The appearance.
    #[command(flatten)]
    pub picture: PictureOptions,
    /// collision, minkowski: start at this step or time
    #[arg(long, value_name = "STEP", default_value = "0", hide_default_value = true)]
    pub step: StepOrTime,
    /// collision, minkowski: only collisions of these bodies
    #[arg(long, value_name = "A,B", value_parser = pair)]
    pub pair: Option<[String; 2]>,
    /// Show only these bodies, for example 'a,b,#1..#9'
    #[arg(long, value_name = "LIST")]
    pub bodies: Option<BodySelector>,
    /// lines: x, y, vx, vy, speed (default), height, E or p
    #[arg(long, value_name = "NAME", default_value = "speed", hide_default_value = true)]
    pub quantity: Quantity,
    /// spacetime, velocity-space: draw x or y
    #[arg(long, default_value = "x", hide_possible_values = true)]
    pub axis: FigureAxis,
    /// Title of a source; repeatable [default: the scene's]
    #[arg(long, value_name = "TEXT")]
    pub title: Vec<String>,
}

impl FigureCommandOptions {
    /// The options of the picture.
    pub fn picture_options(&self) -> PictureOptions {
        PictureOptions { titles: Some(self.title.clone()), bodies: self.bodies.clone(), ..self.picture.clone() }
    }

    /// The figure to draw.
    pub fn figure(&self) -> FigureOptions {
        let (step, pair) = (self.step, self.pair.clone());
        let axis = match self.axis {
            FigureAxis::X => Axis::X,
            FigureAxis::Y => Axis::Y,
        };
        match self.kind {
            FigureKind::Collision => FigureOptions::Collision { figure: CollisionFigure::Stages, step, pair },
            FigureKind::Minkowski => FigureOptions::Collision { figure: CollisionFigure::Minkowski, step, pair },
            FigureKind::Strobe => FigureOptions::States(StatesFigure::Strobe),
            FigureKind::Spacetime => FigureOptions::States(StatesFigure::Spacetime(axis)),
            FigureKind::Energy => FigureOptions::Energy,
            FigureKind::Speeds => FigureOptions::Speeds,
            FigureKind::VelocitySpace => FigureOptions::VelocitySpace(axis),
            FigureKind::Lines => FigureOptions::Lines(self.quantity),
            FigureKind::Filmstrip => FigureOptions::States(StatesFigure::Filmstrip),
        }
    }
}

/// The kind of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FigureKind {
    /// The handout's figure 1: before, the overlap and its normal, after
    Collision,
    /// The handout's figure 2: the Minkowski difference and the four penetration depths
    Minkowski,
    /// Many instants in one picture, older ones fainter
    Strobe,
    /// Positions against time
    Spacetime,
    /// Energy and momentum against time, with their drift
    Energy,
    /// Panels of chosen steps
    Filmstrip,
    /// The distribution of speeds beside that of Maxwell and Boltzmann
    Speeds,
    /// Velocities of two bodies as a path on a circle, or of many as points
    VelocitySpace,
    /// A quantity of bodies against time, of all sources in one diagram
    Lines,
}

/// The coordinate that a space-time figure shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FigureAxis {
    /// To the right
    X,
    /// Downwards
    Y,
}

/// A word of `0.5 at collisions`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HoldWord {
    /// The duration, s.
    Seconds(f64),
    /// The word `at`.
    At,
    /// The word `collisions`.
    Collisions,
}

impl std::str::FromStr for HoldWord {
    type Err = String;

    fn from_str(text: &str) -> Result<HoldWord, String> {
        match text {
            "at" => Ok(HoldWord::At),
            "collisions" => Ok(HoldWord::Collisions),
            text => match text.parse() {
                Ok(seconds) if (MIN_HOLD..=MAX_HOLD).contains(&seconds) => Ok(HoldWord::Seconds(seconds)),
                Ok(_) | Err(_) => Err("expected 0.05 to 60 seconds, for example 0.5 at collisions".into()),
            },
        }
    }
}

/// Parses the names of two bodies: `c,b`.
fn pair(text: &str) -> Result<[String; 2], String> {
    let names = text.split_once(',').filter(|(a, b)| !a.is_empty() && !b.is_empty() && !b.contains(','));
    names.map(|(a, b)| [a.to_owned(), b.to_owned()]).ok_or_else(|| "expected two names, for example c,b".into())
}

/// Parses a playback speed.
fn speed(text: &str) -> Result<f64, String> {
    let speed = text.parse().ok().filter(|speed| SPEEDS.contains(speed));
    speed.ok_or_else(|| format!("expected a number from {:e} to {:e}", SPEEDS.start(), SPEEDS.end()))
}

/// Parses a number greater than 0.
fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite() && *number > 0.0);
    number.ok_or_else(|| "expected a positive number".into())
}
