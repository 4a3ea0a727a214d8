//! The options of the commands that draw.

use super::arguments::{JobOptions, OutputOptions, Shard};
use crate::body_selector::BodySelector;
use crate::physics::Axis;
use crate::picture::{
    self, CollisionFigure, FigureOptions, MAX_HOLD, MIN_HOLD, PictureOptions, Quantity, ReferenceFrame, SPEEDS,
    StatesFigure,
};
use crate::picture_options::{MAX_FPS, StepOrTime};
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
    /// Override scene values; KEY=[A | B] are two runs
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<Sweep>,
    /// Draw only the state of this step or time (1.5s)
    #[arg(
        long, value_name = "STEP", allow_hyphen_values = true,
        conflicts_with_all = ["from", "to", "every", "fps", "slow", "hold"]
    )]
    pub at: Option<StepOrTime>,
    /// Draw about this many frames per second
    #[arg(long, allow_negative_numbers = true, conflicts_with = "every", value_parser = frame_rate)]
    pub fps: Option<f64>,
    /// Draw only part I of N of a folder of PNG files
    #[arg(long, value_name = "I/N", default_value = "1/1", hide_default_value = true, conflicts_with = "at")]
    pub shard: Shard,
    /// Play in slow motion, for example 0.1 times as fast
    #[arg(long, value_name = "PACE", allow_negative_numbers = true, value_parser = speed)]
    pub slow: Option<f64>,
    /// Pause S seconds at collisions: 0.5 at collisions
    #[arg(long, num_args = 3, value_names = ["S", "at", "WHEN"], allow_negative_numbers = true)]
    pub hold: Option<Vec<HoldWord>>,
    /// Allow more than an hour or 100,000 frames
    #[arg(long)]
    pub long: bool,
    /// Title of a source; repeatable [default: its own]
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
  rebond figure lines run.toml --set 'restitution.default=[0.9 | 0.5]' -o e.svg
  rebond figure strobe bullet-handout.mcap bullet-exact.mcap -o bullets.svg")]
pub struct FigureCommandOptions {
    /// The figure: collision, minkowski, strobe, spacetime, energy, filmstrip,
    /// lines, pressure, speeds or velocity-space
    #[arg(hide_possible_values = true)]
    pub kind: FigureKind,
    /// Scenes (.toml) or recordings (.mcap), side by side
    #[arg(required = true, value_name = "SOURCE")]
    pub sources: Vec<PathBuf>,
    /// The output file: .png, .svg or .pdf.
    #[command(flatten)]
    pub output: OutputOptions,
    /// Override scene values; KEY=[A | B] are two runs
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<Sweep>,
    /// The appearance.
    #[command(flatten)]
    pub picture: PictureOptions,
    /// collision, minkowski: start at this step or time
    #[arg(long, value_name = "STEP", allow_hyphen_values = true)]
    pub step: Option<StepOrTime>,
    /// collision, minkowski: only collisions of these bodies
    #[arg(long, value_name = "A,B", value_parser = pair)]
    pub pair: Option<[String; 2]>,
    /// Show only these bodies, for example 'a,b,#1..#9'
    #[arg(long, value_name = "LIST")]
    pub bodies: Option<BodySelector>,
    /// lines: x, y, vx, vy, speed (default), height, E or p
    #[arg(long, value_name = "NAME")]
    pub quantity: Option<Quantity>,
    /// spacetime, velocity-space: draw x (default) or y
    #[arg(long, hide_possible_values = true)]
    pub axis: Option<FigureAxis>,
    /// collision: velocities in the frame lab (default) or com
    #[arg(long, value_name = "NAME")]
    pub frame: Option<ReferenceFrame>,
    /// Title of a source; repeatable [default: its own]
    #[arg(long, value_name = "TEXT")]
    pub title: Vec<String>,
}

impl FigureCommandOptions {
    /// The options of the picture.
    pub fn picture_options(&self) -> PictureOptions {
        PictureOptions { titles: Some(self.title.clone()), bodies: self.bodies.clone(), ..self.picture.clone() }
    }

    /// The figure to draw.
    ///
    /// # Errors
    /// If an option is given that the kind of figure does not have.
    pub fn figure(&self) -> Result<FigureOptions, picture::Error> {
        if let Some(option) = KIND_OPTIONS.iter().find(|option| option.is_misplaced(self)) {
            return Err(picture::Error::Misused { reason: option.refusal(self.kind) });
        }
        let collision = |figure| FigureOptions::Collision {
            figure,
            step: self.step.unwrap_or(StepOrTime::Step(0)),
            pair: self.pair.clone(),
        };
        let axis = match self.axis {
            Some(FigureAxis::X) | None => Axis::X,
            Some(FigureAxis::Y) => Axis::Y,
        };
        Ok(match self.kind {
            FigureKind::Collision => {
                collision(CollisionFigure::Stages(self.frame.unwrap_or(ReferenceFrame::Laboratory)))
            }
            FigureKind::Minkowski => collision(CollisionFigure::Minkowski),
            FigureKind::Strobe => FigureOptions::States(StatesFigure::Strobe),
            FigureKind::Spacetime => FigureOptions::States(StatesFigure::Spacetime(axis)),
            FigureKind::Energy => FigureOptions::Energy,
            FigureKind::Speeds => FigureOptions::Speeds,
            FigureKind::Pressure => FigureOptions::Pressure,
            FigureKind::VelocitySpace => FigureOptions::VelocitySpace(axis),
            FigureKind::Lines => FigureOptions::Lines(self.quantity.unwrap_or(Quantity::Speed)),
            FigureKind::Filmstrip => FigureOptions::States(StatesFigure::Filmstrip),
        })
    }
}

/// An option that only some kinds of figures have.
struct KindOption {
    flag: &'static str,
    is_given: fn(&FigureCommandOptions) -> bool,
    kinds: &'static [FigureKind],
    /// The end of the refusal: what to do instead.
    instead: &'static str,
}

/// The kinds that show instants of a run as pictures of the world.
const OF_WORLD: &[FigureKind] = &[FigureKind::Strobe, FigureKind::Filmstrip];

/// The kinds that show a single collision.
const OF_COLLISION: &[FigureKind] = &[FigureKind::Collision, FigureKind::Minkowski];

/// The kinds that show a part of a run.
const OF_RUN: &[FigureKind] = &[
    FigureKind::Strobe,
    FigureKind::Spacetime,
    FigureKind::Energy,
    FigureKind::Filmstrip,
    FigureKind::Lines,
    FigureKind::Pressure,
    FigureKind::Speeds,
    FigureKind::VelocitySpace,
];

/// Every option that some kinds lack, with the kinds that have it.
const KIND_OPTIONS: [KindOption; 11] = [
    KindOption { flag: "--step", is_given: |all| all.step.is_some(), kinds: OF_COLLISION, instead: "" },
    KindOption { flag: "--pair", is_given: |all| all.pair.is_some(), kinds: OF_COLLISION, instead: "" },
    KindOption {
        flag: "--bodies",
        is_given: |all| all.bodies.is_some(),
        kinds: &[
            FigureKind::Strobe,
            FigureKind::Spacetime,
            FigureKind::Filmstrip,
            FigureKind::Lines,
            FigureKind::Pressure,
            FigureKind::Speeds,
            FigureKind::VelocitySpace,
        ],
        instead: "; the bodies of a collision are chosen with --pair",
    },
    KindOption { flag: "--quantity", is_given: |all| all.quantity.is_some(), kinds: &[FigureKind::Lines], instead: "" },
    KindOption {
        flag: "--axis",
        is_given: |all| all.axis.is_some(),
        kinds: &[FigureKind::Spacetime, FigureKind::VelocitySpace],
        instead: "",
    },
    KindOption { flag: "--frame", is_given: |all| all.frame.is_some(), kinds: &[FigureKind::Collision], instead: "" },
    KindOption {
        flag: "--from",
        is_given: |all| all.picture.from.is_some(),
        kinds: OF_RUN,
        instead: "; a collision is chosen with --step",
    },
    KindOption {
        flag: "--to",
        is_given: |all| all.picture.to.is_some(),
        kinds: OF_RUN,
        instead: "; a collision is chosen with --step",
    },
    KindOption {
        flag: "--every",
        is_given: |all| all.picture.every.is_some(),
        kinds: &[
            FigureKind::Strobe,
            FigureKind::Spacetime,
            FigureKind::Energy,
            FigureKind::Filmstrip,
            FigureKind::Lines,
            FigureKind::Speeds,
        ],
        instead: "",
    },
    KindOption {
        flag: "--window",
        is_given: |all| all.picture.window.is_some(),
        kinds: &[FigureKind::Strobe, FigureKind::Spacetime, FigureKind::Filmstrip],
        instead: "",
    },
    KindOption { flag: "--follow", is_given: |all| all.picture.follow.is_some(), kinds: OF_WORLD, instead: "" },
];

impl KindOption {
    /// Returns true if the option is given for a kind that does not have it.
    fn is_misplaced(&self, options: &FigureCommandOptions) -> bool {
        (self.is_given)(options) && !self.kinds.contains(&options.kind)
    }

    /// The reason why a kind of figure is not drawn with this option.
    fn refusal(&self, kind: FigureKind) -> String {
        let names: Vec<String> = self.kinds.iter().map(ToString::to_string).collect();
        let (last, others) = names.split_last().expect("every option has a kind");
        let kinds = if others.is_empty() { last.clone() } else { format!("{} and {last}", others.join(", ")) };
        format!("the figure {kind} has no {}, which is an option of {kinds}{}", self.flag, self.instead)
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
    /// Impulse per time and length on walls and pistons, also against the volume
    Pressure,
    /// Velocities of two bodies as a path on a circle, or of many as points
    VelocitySpace,
    /// A quantity of bodies against time, of all sources in one diagram
    Lines,
}

impl std::fmt::Display for FigureKind {
    fn fmt(&self, out: &mut std::fmt::Formatter) -> std::fmt::Result {
        let value = self.to_possible_value().expect("no kind is skipped");
        out.write_str(value.get_name())
    }
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
                Ok(_) => Err(format!("expected {MIN_HOLD} to {MAX_HOLD} seconds, for example 0.5 at collisions")),
                Err(_) => Err("expected seconds, or seconds at collisions, for example 0.5 at collisions".into()),
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

/// Parses a frame rate, frames per second.
fn frame_rate(text: &str) -> Result<f64, String> {
    let rate = text.parse().ok().filter(|rate| 0.0 < *rate && *rate <= MAX_FPS);
    rate.ok_or_else(|| format!("expected a positive number, at most {MAX_FPS}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::Arguments;
    use clap::Parser;

    /// The options of `figure KIND` with further arguments.
    fn parse(kind: FigureKind, arguments: &[&str]) -> FigureCommandOptions {
        let kind = kind.to_string();
        let line = [&["rebond", "figure", &kind, "run.mcap", "-o", "f.svg"], arguments].concat();
        match Arguments::try_parse_from(line).unwrap().command {
            crate::cli::Command::Figure(options) => options,
            _ => unreachable!("the command is figure"),
        }
    }

    #[test]
    fn each_kind_accepts_its_options_and_refuses_the_others_by_the_kinds_that_have_them() {
        let values = [
            ("--step", "3"),
            ("--pair", "a,b"),
            ("--bodies", "a"),
            ("--quantity", "x"),
            ("--axis", "y"),
            ("--frame", "com"),
            ("--from", "1"),
            ("--to", "1s"),
            ("--every", "2"),
            ("--window", "bodies"),
            ("--follow", "a"),
        ];
        assert_eq!(values.map(|(flag, _)| flag), KIND_OPTIONS.each_ref().map(|option| option.flag));
        for kind in FigureKind::value_variants() {
            assert!(parse(*kind, &["--theme", "dark", "--caption", "any"]).figure().is_ok(), "{kind}");
            for (option, (flag, value)) in KIND_OPTIONS.iter().zip(values) {
                match parse(*kind, &[flag, value]).figure() {
                    Ok(_) => assert!(option.kinds.contains(kind), "{kind} {flag}"),
                    Err(error) => {
                        let message = error.to_string();
                        assert!(!option.kinds.contains(kind), "{kind} {flag}: {message}");
                        assert!(message.starts_with(&format!("the figure {kind} has no {flag}, ")), "{message}");
                        assert!(option.kinds.iter().all(|kind| message.contains(&kind.to_string())), "{message}");
                    }
                }
            }
        }
    }
}
