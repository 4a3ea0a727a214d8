//! The conditions of the measurement.

use std::process::Command;

/// The date, machine and tools of a measurement.
#[derive(Clone, Debug)]
pub struct Conditions {
    /// Year-month-day, UTC.
    pub date: String,
    /// The number of processors and their model.
    pub processor: String,
    /// The operating system.
    pub system: String,
    /// Compilers and interpreters with their versions.
    pub tools: Vec<String>,
    /// The load average of one minute at the start and at the end.
    pub load: [f64; 2],
}

/// The load average of one minute.
pub fn load() -> f64 {
    let average = read("/proc/loadavg");
    average.split(' ').next().and_then(|number| number.parse().ok()).unwrap_or(f64::NAN)
}

/// The conditions of a measurement that started with this load average.
pub fn conditions(load_at_start: f64) -> Conditions {
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let model = field(&read("/proc/cpuinfo"), "model name", ':');
    let tools = [["rustc", "--version"], ["gcc", "--version"], ["python3", "--version"], ["node", "--version"]];
    Conditions {
        date: first_line(&["date", "--utc", "+%F"]),
        processor: format!("{processors} cores of an {model}"),
        system: field(&read("/etc/os-release"), "PRETTY_NAME", '=').trim_matches('"').to_owned(),
        tools: tools.iter().map(|command| format!("{} {}", command[0], version(&first_line(command)))).collect(),
        load: [load_at_start, load()],
    }
}

fn read(path: &str) -> String {
    std::fs::read_to_string(path).unwrap_or_default()
}

/// The value after a key.
fn field(text: &str, key: &str, separator: char) -> String {
    let line = text.lines().find(|line| line.starts_with(key)).unwrap_or_default();
    line.split_once(separator).map_or("unknown", |(_, value)| value.trim()).to_owned()
}

fn first_line(command: &[&str]) -> String {
    let output = Command::new(command[0]).args(&command[1..]).output();
    let text = output.map(|output| String::from_utf8_lossy(&output.stdout).into_owned()).unwrap_or_default();
    text.lines().next().unwrap_or("unknown").to_owned()
}

/// The first number with a dot in a line.
fn version(line: &str) -> String {
    let words = line.split(|c: char| !c.is_ascii_digit() && c != '.');
    words.into_iter().find(|word| word.contains('.')).unwrap_or("?").to_owned()
}
