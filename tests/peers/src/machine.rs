//! Where and how it was measured, in words.

use std::process::Command;

/// All that a reader has to know of the machine.
#[derive(Clone, Debug)]
pub struct Conditions {
    /// As year-month-day.
    pub date: String,
    /// The processor, and how many.
    pub processor: String,
    /// The system.
    pub system: String,
    /// Compilers and interpreters.
    pub tools: Vec<String>,
    /// Processes that wanted to run in the last minute, at the begin and at the end.
    pub load: [f64; 2],
}

/// Processes that wanted to run in the last minute, on average.
pub fn load() -> f64 {
    let average = read("/proc/loadavg");
    average.split(' ').next().and_then(|number| number.parse().ok()).unwrap_or(f64::NAN)
}

/// The conditions of a run that began under that load.
pub fn conditions(begin: f64) -> Conditions {
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let model = field(&read("/proc/cpuinfo"), "model name", ':');
    let tools = [["rustc", "--version"], ["gcc", "--version"], ["python3", "--version"], ["node", "--version"]];
    Conditions {
        date: first_line(&["date", "--utc", "+%F"]),
        processor: format!("{processors} cores of an {model}"),
        system: field(&read("/etc/os-release"), "PRETTY_NAME", '=').trim_matches('"').to_owned(),
        tools: tools.iter().map(|command| format!("{} {}", command[0], version(&first_line(command)))).collect(),
        load: [begin, load()],
    }
}

fn read(path: &str) -> String {
    std::fs::read_to_string(path).unwrap_or_default()
}

/// What stands behind a key.
fn field(text: &str, key: &str, separator: char) -> String {
    let line = text.lines().find(|line| line.starts_with(key)).unwrap_or_default();
    line.split_once(separator).map_or("unknown", |(_, value)| value.trim()).to_owned()
}

fn first_line(command: &[&str]) -> String {
    let output = Command::new(command[0]).args(&command[1..]).output();
    let text = output.map(|output| String::from_utf8_lossy(&output.stdout).into_owned()).unwrap_or_default();
    text.lines().next().unwrap_or("unknown").to_owned()
}

/// The first number with dots in a line.
fn version(line: &str) -> String {
    let words = line.split(|c: char| !c.is_ascii_digit() && c != '.');
    words.into_iter().find(|word| word.contains('.')).unwrap_or("?").to_owned()
}
