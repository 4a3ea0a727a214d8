use super::picture_arguments::{FigureCommandOptions, RenderOptions};
use super::shard::Shard;
use super::values::{picture_size, theme};
use crate::scene::Theme;
use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;

/// A physics engine of boxes that records, replays bit for bit, and draws itself
#[derive(Debug, Parser)]
#[command(
    version,
    arg_required_else_help = true,
    disable_help_subcommand = true,
    max_term_width = 100,
    next_line_help = false
)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// Say nothing but results and errors
    #[arg(short, long, global = true, display_order = 900)]
    pub quiet: bool,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a scene and record its events and states
    Record(RecordOptions),
    /// Run a recording again and compare every recorded state bit for bit
    Replay(ReplayOptions),
    /// Draw a scene or a recording as GIF, animated PNG or PNG
    Render(RenderOptions),
    /// Draw a lecture figure of a scene or a recording as PNG, SVG or PDF
    Figure(FigureCommandOptions),
    /// Write the states of a recording as a table
    Export(ExportOptions),
    /// Tell what is inside a recording, or what a picture was drawn from
    Info(InfoOptions),
    /// Hold recordings and pictures to what they were
    Check(CheckOptions),
    /// Save all that can be read of a damaged or unfinished recording
    Recover(RecoverOptions),
    /// Measure errors and costs of both solvers on hard scenes
    Report(ReportOptions),
    /// Print the completions for a shell
    Completions(CompletionsOptions),
    /// Write the manual pages
    Man(ManOptions),
}

/// Where a result goes, and whether something may stand there already.
#[derive(Args, Debug)]
pub struct OutputOptions {
    /// The file to write, - for standard output
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// Replace what is there
    #[arg(short, long)]
    pub force: bool,
}

/// Options of `record`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  rebond record recordings/figure-1.toml -o figure-1.mcap
  rebond record scene.toml -o long.mcap --steps 100000 --every 100
  rebond record scene.toml -o heavy.mcap --set restitution.default=0.5 --set spawn.c.mass=2
  printf '{\"click\": {\"step\": 30, \"at\": [4, 5]}}\\n' | rebond record scene.toml -o clicked.mcap --events -")]
pub struct RecordOptions {
    /// The scene, a TOML file
    pub scene: PathBuf,
    /// The recording to write, - for standard output
    #[arg(short, long, value_name = "OUT.mcap")]
    pub output: PathBuf,
    /// Replace the recording that is there
    #[arg(short, long)]
    pub force: bool,
    /// More events, one JSON object a line; - for standard input
    #[arg(long, value_name = "FILE.jsonl")]
    pub events: Option<PathBuf>,
    /// Set a value of the scene anew, such as spawn.c.mass=2
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<crate::scene::Setting>,
    /// Stop after that many steps, whatever the scene says
    #[arg(long, value_name = "N")]
    pub steps: Option<u64>,
    /// Record the states of every N-th step only, digests of all
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..))]
    pub every: u64,
    /// Wait for the disk at each flush, against loss of power
    #[arg(long)]
    pub sync: bool,
    /// Add boxes that Foxglove and Lichtblick show, in the topic /scene
    #[arg(long)]
    pub viewer: bool,
    /// Skip event lines that are malformed or late, and count them
    #[arg(long)]
    pub lenient: bool,
    /// Tell what was recorded as one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Options of `replay`.
#[derive(Args, Debug)]
#[command(after_help = "\
The last line of standard output is the verdict. Exit codes: 0 same, 3 diverged, 4 truncated or corrupt.

Examples:
  rebond replay recordings/figure-1.mcap
  rebond replay long.mcap --from 500 --to 600")]
pub struct ReplayOptions {
    /// The recording
    pub recording: PathBuf,
    /// The first step to compare
    #[arg(long, value_name = "STEP")]
    pub from: Option<u64>,
    /// The last step to compare
    #[arg(long, value_name = "STEP")]
    pub to: Option<u64>,
    /// The verdict as one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Options of `export`.
#[derive(Args, Debug)]
#[command(after_help = "\
Columns: step,time,name,x,y,vx,vy; one row for each body alive at each step, walls included;
decimals are the shortest that give the same number back.

Examples:
  rebond export figure-1.mcap > figure-1.csv
  rebond export figure-1.mcap -o figure-1.jsonl --from 60 --to 120")]
pub struct ExportOptions {
    /// The recording
    pub recording: PathBuf,
    /// The table to write: .csv or .jsonl; - for CSV on standard output
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    pub output: PathBuf,
    /// Replace the table that is there
    #[arg(short, long)]
    pub force: bool,
    /// The first step to write
    #[arg(long, value_name = "STEP")]
    pub from: Option<u64>,
    /// The last step to write
    #[arg(long, value_name = "STEP")]
    pub to: Option<u64>,
    /// Write part I of N; in a row they are the whole
    #[arg(long, value_name = "I/N", default_value = "1/1", hide_default_value = true)]
    pub shard: Shard,
}

/// Options of `info`.
#[derive(Args, Debug)]
#[command(after_help = "\
Of a picture made by rebond (PNG, GIF, animated PNG, SVG, PDF) it tells the recording, the steps
and the options it was drawn from.

Examples:
  rebond info figure-1.mcap
  rebond info figure-1.mcap --json
  rebond info collision.svg")]
pub struct InfoOptions {
    /// A recording, or a picture of one
    pub file: PathBuf,
    /// One JSON object in place of lines
    #[arg(long)]
    pub json: bool,
    /// Read and verify all of a recording, however large; up to 16 MiB that is done anyway
    #[arg(long)]
    pub verify: bool,
}

/// Options of `check`.
#[derive(Args, Debug)]
#[command(after_help = "\
Every recording must replay and, if NAME.toml stands beside NAME.mcap, still be
what that scene gives. Every picture drawn by rebond must come out again. More
pictures are listed in a manifest NAME.check: a command a line, as typed there:
  rebond figure strobe fall.mcap -o fall.svg
Exit codes: 0 same, 3 something differs, 4 a recording is truncated or corrupt,
1 something cannot be checked; of several the first of 1, 4, 3.

Examples:
  rebond check recordings
  rebond check lecture --update        accepts, and draws what is missing
  rebond check lecture --shard 2/4     with --json parts join as they are")]
pub struct CheckOptions {
    /// Files, or folders and all below them
    #[arg(required = true, value_name = "PATH")]
    pub paths: Vec<PathBuf>,
    /// Accept what changed, after it is shown
    #[arg(long)]
    pub update: bool,
    /// Check the I-th of N parts only
    #[arg(long, value_name = "I/N", default_value = "1/1", hide_default_value = true, conflicts_with = "update")]
    pub shard: Shard,
    /// Threads to check on [default: one for each processor]
    #[arg(long, value_name = "N")]
    pub jobs: Option<std::num::NonZero<usize>>,
    /// Where a page goes that shows what differs
    #[arg(long, value_name = "FOLDER", default_value = "rebond-check")]
    pub report: PathBuf,
    /// One JSON object a case
    #[arg(long)]
    pub json: bool,
}

/// Options of `recover`.
#[derive(Args, Debug)]
#[command(after_help = "\
Nothing is invented: what is missing is said to be missing, and the rest replays the same.

Example:
  rebond recover broken.mcap -o fixed.mcap")]
pub struct RecoverOptions {
    /// The damaged recording
    pub recording: PathBuf,
    /// Where the new recording goes.
    #[command(flatten)]
    pub output: OutputOptions,
}

/// Options of `report`.
#[derive(Args, Debug)]
#[command(after_help = "\
Errors are found against closed forms and arithmetic of 77 decimals and are the
same each time. Costs are processor time: let the machine be quiet. Parts join:
--csv byte for byte, --json by --read.

Examples:
  rebond report                      all hard scenes, in a few minutes
  rebond report --only stack,gas --plot stacks.svg
  rebond report my-scene.toml --csv > errors.csv
  rebond report --json --shard 1/2 > 1.json
  rebond report --read 1.json --read 2.json --plot all.png
  rebond report --growth --plot growth.pdf")]
pub struct ReportOptions {
    /// Scenes of your own, in place of the hard ones
    #[arg(value_name = "SCENE.toml", conflicts_with_all = ["growth", "read"])]
    pub scenes: Vec<PathBuf>,
    /// Run what takes long, too
    #[arg(long)]
    pub full: bool,
    /// How costs grow with bodies and steps instead
    #[arg(long)]
    pub growth: bool,
    /// Only these families of scenes, such as stack,gas
    #[arg(long, value_name = "FAMILIES", value_delimiter = ',')]
    pub only: Vec<String>,
    /// Only one of several parts of the scenes: 2/4
    #[arg(long, value_name = "I/N", default_value = "1/1", hide_default_value = true)]
    pub shard: Shard,
    /// Show what --json wrote before; may be repeated
    #[arg(long, value_name = "FILE.json", conflicts_with_all = ["full", "growth"])]
    pub read: Vec<PathBuf>,
    /// A JSON list in place of the table
    #[arg(long, conflicts_with = "csv")]
    pub json: bool,
    /// Comma-separated values in place of the table
    #[arg(long)]
    pub csv: bool,
    /// Draw error against cost: .png, .svg or .pdf
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Replace the diagram that is there
    #[arg(short, long, requires = "plot")]
    pub force: bool,
    /// Pixels of the diagram [default: as many as suit]
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = picture_size, requires = "plot")]
    pub size: Option<[u32; 2]>,
    /// light or dark
    #[arg(long, value_parser = theme, requires = "plot")]
    pub theme: Option<Theme>,
    /// What is written below the diagram
    #[arg(long, value_name = "TEXT", requires = "plot")]
    pub caption: Option<String>,
    /// Measure the cost of one run alone: what the report does for each, in a process of its own
    #[arg(long, hide = true, value_name = "NUMBER")]
    pub cost_of: Option<usize>,
}

/// Options of `completions`.
#[derive(Args, Debug)]
#[command(after_help = "\
Example:
  rebond completions bash > ~/.local/share/bash-completion/completions/rebond")]
pub struct CompletionsOptions {
    /// bash, zsh, fish, elvish or powershell
    pub shell: clap_complete::Shell,
}

/// Options of `man`.
#[derive(Args, Debug)]
#[command(after_help = "\
Example:
  rebond man ~/.local/share/man/man1       then: man rebond, man rebond-render")]
pub struct ManOptions {
    /// The folder they go to
    pub folder: PathBuf,
    /// Replace those that are there
    #[arg(short, long)]
    pub force: bool,
}
