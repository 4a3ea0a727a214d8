use crate::picture::Theme;
use crate::picture_options::{ReversedRange, StepOrTime, parse_size};
use crate::recording::limits;
use crate::scene::{Override, Sweep};
use crate::table::Table;
use clap::Args;
use std::num::NonZero;
use std::ops::{Range, RangeInclusive};
use std::path::{Path, PathBuf};

/// Returns true if `path` stands for standard output.
pub fn is_standard_output(path: &Path) -> bool {
    path == Path::new("-")
}

/// The output file, and permission to overwrite it.
#[derive(Args, Debug)]
pub struct OutputOptions {
    /// Write to this file, - for standard output
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// Overwrite an existing file
    #[arg(short, long)]
    pub force: bool,
}

/// The number of threads.
#[derive(Args, Debug)]
pub struct JobOptions {
    /// Use N threads [default: one per processor]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub jobs: Option<NonZero<usize>>,
}

impl JobOptions {
    /// The number of threads to use.
    pub fn threads(&self) -> NonZero<usize> {
        self.jobs.or(std::thread::available_parallelism().ok()).unwrap_or(NonZero::<usize>::MIN)
    }
}

/// Options of `record`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  rebond record recordings/figure-1.toml -o figure-1.mcap
  rebond record scene.toml -o long.mcap --steps 100000 --every 100
  rebond record scene.toml -o heavy.mcap --set spawn.c.mass=2
  rebond record scene.toml -o clicked.mcap --events - < clicks.jsonl")]
pub struct RecordOptions {
    /// The scene to run (TOML), - for standard input
    pub scene: PathBuf,
    /// Write the recording to this file, - for standard output
    #[arg(short, long, value_name = "OUT.mcap")]
    pub output: PathBuf,
    /// Overwrite an existing recording
    #[arg(short, long)]
    pub force: bool,
    /// Read more events from a JSON Lines file, - for standard input
    #[arg(long, value_name = "FILE.jsonl")]
    pub events: Option<PathBuf>,
    /// Override a value of the scene: spawn.c.mass=2
    #[arg(long, value_name = "KEY=VALUE", value_parser = single_override)]
    pub set: Vec<Override>,
    /// Keep OUT.mcap if it has this run, and replace it if it has only a part of it
    #[arg(long, conflicts_with = "events")]
    pub skip_existing: bool,
    /// Run N steps instead of the number in the scene
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub steps: Option<u64>,
    /// Record only every N-th state, but all digests
    #[arg(
        long, value_name = "N", default_value_t = 1, allow_negative_numbers = true,
        value_parser = clap::value_parser!(u64).range(1..=limits::STEPS)
    )]
    pub every: u64,
    /// Sync each flush to disk, to survive a power failure
    #[arg(long)]
    pub sync: bool,
    /// Add the topic /scene for Foxglove and Lichtblick
    #[arg(long)]
    pub viewer: bool,
    /// Estimate from which step on rounding errors matter; takes about four times as long
    #[arg(long)]
    pub accuracy: bool,
    /// Skip invalid or late event lines instead of failing
    #[arg(long)]
    pub lenient: bool,
    /// Print the result as a JSON object
    #[arg(long)]
    pub json: bool,
}

/// Parses an override of a command that runs a scene once.
pub fn single_override(text: &str) -> Result<Override, String> {
    let several = || "this command runs one scene; give one value, and run it once for each value".to_owned();
    text.parse::<Sweep>()?.single().ok_or_else(several)
}

/// Options of `replay`.
#[derive(Args, Debug)]
#[command(after_help = "\
The last line of standard output is the verdict.
Exit codes: 0 same, 1 error, 3 diverged, 4 incomplete or corrupt.
STATES.csv has the columns step,name,x,y,vx,vy; rows may have any order, and
columns may be missing, as may the rows of bodies of infinite mass.

Examples:
  rebond replay recordings/figure-1.mcap
  rebond replay long.mcap --from 500 --to 600
  rebond replay figure-1.mcap --against my-engine.csv --junit marks.xml")]
pub struct ReplayOptions {
    /// The recording
    pub recording: PathBuf,
    /// Start comparing at this step or time (1.5s)
    #[arg(long, value_name = "STEP", allow_negative_numbers = true)]
    pub from: Option<StepOrTime>,
    /// Stop comparing after this step or time
    #[arg(long, value_name = "STEP", allow_negative_numbers = true)]
    pub to: Option<StepOrTime>,
    /// Compare the states of another program; - for standard input
    #[arg(long, value_name = "STATES.csv")]
    pub against: Option<PathBuf>,
    /// Accept differences up to T (m, m/s) of that program
    #[arg(long, value_name = "T", requires = "against", allow_negative_numbers = true, value_parser = tolerance)]
    pub tolerance: Option<f64>,
    /// Write the result of --against as a JUnit report
    #[arg(long, value_name = "FILE.xml", requires = "against")]
    pub junit: Option<PathBuf>,
    /// Overwrite FILE.xml even if it is not a JUnit report
    #[arg(short, long, requires = "junit")]
    pub force: bool,
    /// Print the verdict as a JSON object
    #[arg(long)]
    pub json: bool,
}

impl ReplayOptions {
    /// The steps to compare in a recording of a `rate`, Hz.
    pub fn steps(&self, rate: f64) -> Result<RangeInclusive<u64>, ReversedRange> {
        ReversedRange::refuse(self.from, self.to, rate)?;
        let step = |point: StepOrTime| point.step(rate);
        Ok(self.from.map_or(0, step)..=self.to.map_or(u64::MAX, step))
    }
}

/// Parses a number, 0 or more.
fn tolerance(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite() && *number >= 0.0);
    number.ok_or_else(|| "expected a number, 0 or more, such as 1e-9".into())
}

/// Options of `export`.
#[derive(Args, Debug)]
#[command(after_help = "\
Tables and their columns:
  states      step,time,name,x,y,vx,vy: one row per body and recorded step,
              walls included
  collisions  time,step,a,b,axis,nx,ny,e,vn_before,vn_after,impulse: one row
              per impulse, from a replay
  energy      step,time,kinetic,potential,total,px,py: the bodies of finite mass
  bodies      name,id,mass,width,height,material,e_default,spawned_step,
              deleted_step,fx,fy,color; a step lost in a gap is unknown
Several sources have a first column, source, and one for each key that --set
has changed in any of them. A folder stands for its recordings. Numbers are the
shortest decimals that read back to the same value, in SI units. FILE.mcap has
one topic per body, for plots in Foxglove or PlotJuggler. Steps select rows by
their step. Times select collisions by their instant, both ends included, and
other rows by the nearest step.

Examples:
  rebond export figure-1.mcap > figure-1.csv
  rebond export study/ --table energy -o study.csv
  rebond export --table energy elastic.mcap plastic.toml -o energy.csv")]
pub struct ExportOptions {
    /// Recordings (.mcap), folders of recordings, or scenes (.toml)
    #[arg(required = true, value_name = "SOURCE")]
    pub sources: Vec<PathBuf>,
    /// Export states, collisions, energy or bodies
    #[arg(long, default_value = "states", hide_possible_values = true)]
    pub table: Table,
    /// Write to this .csv, .jsonl or .mcap file, - for CSV on standard output
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    pub output: PathBuf,
    /// Overwrite an existing table
    #[arg(short, long)]
    pub force: bool,
    /// Start at this step, or at a time such as 1.5s
    #[arg(long, value_name = "STEP", allow_hyphen_values = true)]
    pub from: Option<StepOrTime>,
    /// Stop after this step or time
    #[arg(long, value_name = "STEP", allow_hyphen_values = true)]
    pub to: Option<StepOrTime>,
    /// Override scene values; KEY=[A | B] are two runs
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<Sweep>,
    /// Export part I of N; the parts concatenate to the whole table
    #[arg(long, value_name = "I/N", default_value = "1/1", hide_default_value = true)]
    pub shard: Shard,
}

/// Options of `info`.
#[derive(Args, Debug)]
#[command(after_help = "\
For a picture made by rebond (PNG, GIF, animated PNG, SVG, PDF), prints the
recording, the steps and the options it was drawn from.

Examples:
  rebond info figure-1.mcap
  rebond info figure-1.mcap --json
  rebond info collision.svg
  rebond info study/ --json | jq .identity")]
pub struct InfoOptions {
    /// Recordings, folders of recordings, or pictures made by rebond
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Print one JSON object per file, each on its own line
    #[arg(long)]
    pub json: bool,
    /// Verify all chunks, which is the default up to 16 MiB
    #[arg(long)]
    pub verify: bool,
}

/// Options of `check`.
#[derive(Args, Debug)]
#[command(after_help = "\
A recording must replay the same and, if NAME.toml is next to NAME.mcap, match a
new run of that scene. A scene without a recording is reported. A picture drawn
by rebond must be redrawn the same. More recordings and pictures are listed in a
manifest NAME.check, one command per line, with paths relative to its folder:
  rebond record fall.toml -o slow.mcap --set run.rate=30
  rebond figure strobe fall.mcap -o fall.svg
  skip large.toml        # no recording is kept
Exit codes: 0 same, 3 something differs or is missing, 4 a recording is
incomplete or corrupt, 1 a check failed. If several apply: 1 before 4 before 3.

Examples:
  rebond check recordings
  rebond check lecture --update
  rebond check lecture/fall.mcap --update      and pictures drawn from it
  rebond check lecture --review                one by one
  rebond check lecture --junit check.xml --github
  rebond check lecture --shard 2/4 --json > 2.jsonl")]
pub struct CheckOptions {
    /// Files, or folders to search recursively
    #[arg(required = true, value_name = "PATH")]
    pub paths: Vec<PathBuf>,
    /// Accept changes, and make what is missing
    #[arg(long)]
    pub update: bool,
    /// Ask about each change: accept, reject or skip it
    #[arg(long, conflicts_with_all = ["update", "json", "shard"])]
    pub review: bool,
    /// Check only part I of N
    #[arg(long, value_name = "I/N", default_value = "1/1", hide_default_value = true, conflicts_with = "update")]
    pub shard: Shard,
    /// The number of threads.
    #[command(flatten)]
    pub jobs: JobOptions,
    /// Write a page of all differences to this folder
    #[arg(long, value_name = "FOLDER", default_value = "rebond-check")]
    pub report: PathBuf,
    /// Print one JSON object per case
    #[arg(long)]
    pub json: bool,
    /// Write a JUnit report to this file
    #[arg(long, value_name = "FILE.xml")]
    pub junit: Option<PathBuf>,
    /// Overwrite FILE.xml even if it is not a JUnit report
    #[arg(short, long, requires = "junit")]
    pub force: bool,
    /// Annotate files on GitHub, and write the summary of the step
    #[arg(long)]
    pub github: bool,
    /// The journal of a child process.
    #[arg(long, hide = true)]
    pub journal: Option<PathBuf>,
}

/// Options of `recover`.
#[derive(Args, Debug)]
#[command(after_help = "\
Lost steps are reported, never invented. A state that contradicts its digest is
computed again, and kept if the result has its digest or its values. A new file
of a damaged recording is replayed; recover says if it does not replay the same.

Example:
  rebond recover broken.mcap -o fixed.mcap")]
pub struct RecoverOptions {
    /// The damaged recording
    pub recording: PathBuf,
    /// The new recording.
    #[command(flatten)]
    pub output: OutputOptions,
}

/// Options of `report`.
#[derive(Args, Debug)]
#[command(after_help = "\
Errors are relative to closed-form solutions or 77-digit arithmetic and do not
vary between runs. Costs are processor times: run on an idle machine. To join
the parts of --shard, concatenate their --csv or --read their --json output.

Examples:
  rebond report                      all hard scenes, in a few minutes
  rebond report --only stack,gas --plot stacks.svg
  rebond report my-scene.toml --csv > errors.csv
  rebond report --json --shard 1/2 > 1.json
  rebond report --read 1.json --read 2.json --plot all.png
  rebond report --growth --plot growth.pdf")]
pub struct ReportOptions {
    /// Measure these scenes instead of the built-in ones
    #[arg(value_name = "SCENE.toml", conflicts_with_all = ["growth", "read", "only"])]
    pub scenes: Vec<PathBuf>,
    /// Override scene values; KEY=[A | B] are two runs
    #[arg(long, value_name = "KEY=VALUE", requires = "scenes")]
    pub set: Vec<Sweep>,
    /// Include runs that take long
    #[arg(long)]
    pub full: bool,
    /// Measure how cost grows with bodies and steps
    #[arg(long)]
    pub growth: bool,
    /// Run only these families of scenes, for example stack,gas
    #[arg(long, value_name = "FAMILIES", value_delimiter = ',')]
    pub only: Vec<String>,
    /// Run only part I of N of the scenes
    #[arg(long, value_name = "I/N", default_value = "1/1", hide_default_value = true)]
    pub shard: Shard,
    /// Read results of --json instead of measuring; repeatable
    #[arg(long, value_name = "FILE.json", conflicts_with_all = ["full", "growth", "shard"])]
    pub read: Vec<PathBuf>,
    /// Print a JSON list instead of a table
    #[arg(long, conflicts_with = "csv")]
    pub json: bool,
    /// Print CSV instead of a table
    #[arg(long)]
    pub csv: bool,
    /// Draw error against cost to this .png, .svg or .pdf file
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Overwrite an existing diagram
    #[arg(short, long, requires = "plot")]
    pub force: bool,
    /// Set the size in pixels [default: automatic]
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size, requires = "plot")]
    pub size: Option<[u32; 2]>,
    /// Use the light or dark theme
    #[arg(long, requires = "plot")]
    pub theme: Option<Theme>,
    /// Write this text below the diagram
    #[arg(long, value_name = "TEXT", requires = "plot")]
    pub caption: Option<String>,
    /// Measure the cost of a single run; the report starts one such process per run
    #[arg(long, hide = true, value_name = "NUMBER")]
    pub cost_of: Option<usize>,
}

/// Options of `completions`.
#[derive(Args, Debug)]
#[command(after_help = "\
Example:
  rebond completions bash > ~/.local/share/bash-completion/completions/rebond")]
pub struct CompletionsOptions {
    /// The shell to generate completions for
    pub shell: clap_complete::Shell,
}

/// Options of `man`.
#[derive(Args, Debug)]
#[command(after_help = "\
Example:
  rebond man ~/.local/share/man/man1       then: man rebond, man rebond-render")]
pub struct ManOptions {
    /// The folder to write to
    pub folder: PathBuf,
    /// Overwrite existing pages
    #[arg(short, long)]
    pub force: bool,
}

/// One of several parts of some work. The parts are consecutive slices, so their outputs can be concatenated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// The number of this part, from 1.
    pub number: u64,
    /// The number of parts.
    pub count: u64,
}

impl Shard {
    /// The only part of one.
    pub const WHOLE: Shard = Shard { number: 1, count: 1 };

    /// The indices of this part among `length` items.
    pub fn range(self, length: usize) -> Range<usize> {
        let Range { start, end } = self.slice(length as u64);
        start as usize..end as usize
    }

    /// The steps of this part among the steps `from..=to`. `None` if this part is empty.
    pub fn steps(self, from: u64, to: u64) -> Option<RangeInclusive<u64>> {
        let Range { start, end } = self.slice((to + 1).saturating_sub(from));
        (start < end).then(|| from + start..=from + end - 1)
    }

    fn slice(self, length: u64) -> Range<u64> {
        let border = |number: u64| (u128::from(length) * u128::from(number) / u128::from(self.count)) as u64;
        border(self.number - 1)..border(self.number)
    }
}

/// Parses `2/4`.
impl std::str::FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Shard, String> {
        let parts = text.split_once('/').and_then(|(number, count)| Some((number.parse().ok()?, count.parse().ok()?)));
        match parts {
            Some((number, count)) if (1..=count).contains(&number) => Ok(Shard { number, count }),
            Some(_) | None => Err("expected I/N with I from 1 to N, for example 2/4".into()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ranges_of_all_shards_concatenate_to_the_whole() {
        for length in [0, 1, 5, 12] {
            for count in 1..=7 {
                let all: Vec<usize> = (1..=count).flat_map(|number| Shard { number, count }.range(length)).collect();
                assert_eq!(all, (0..length).collect::<Vec<usize>>(), "{length} in {count}");
            }
        }
    }

    #[test]
    fn the_steps_of_all_shards_concatenate_to_all_steps() {
        let all: Vec<u64> = (1..=4).filter_map(|number| Shard { number, count: 4 }.steps(3, 12)).flatten().collect();
        assert_eq!(all, (3..=12).collect::<Vec<u64>>());
        assert_eq!(Shard { number: 1, count: 4 }.steps(3, 3), None, "the last shard has the only step");
    }

    #[test]
    fn shards_are_counted_from_one() {
        assert_eq!("2/4".parse(), Ok(Shard { number: 2, count: 4 }));
        for wrong in ["0/4", "5/4", "1/0", "1", "a/b", "-1/2"] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
    }
}
