use super::arguments::ExportOptions;
use super::error::CommandError;
use super::{Exit, output};
use crate::picture::{ReadExtent, ReadStatus};
use crate::recording::{self, Playback, SampledState};
use crate::text::csv_field;
use std::{io::Write, path::Path};

/// Exports the states of a recording as a table.
pub fn run(options: &ExportOptions) -> Result<Exit, CommandError> {
    let path = &options.recording;
    let format = Format::from_path(&options.output)?;
    let mut playback = Playback::new(recording::open(path).map_err(CommandError::in_recording(path))?);
    let last = playback.header().steps;
    let from = options.from.unwrap_or(0);
    let steps = options.shard.steps(from, options.to.unwrap_or(last).min(last));
    let first = steps.as_ref().map_or(from.max(last + 1), |steps| *steps.start());
    playback.seek(first).map_err(CommandError::in_recording(path))?;
    let extent = output::write_file(&options.output, options.force, |table| {
        if options.shard.number == 1 {
            table.write_all(format.header().as_bytes()).map_err(CommandError::unwritable(&options.output))?;
        }
        for frame in playback.by_ref() {
            let frame = frame.map_err(CommandError::in_recording(path))?;
            if steps.as_ref().is_none_or(|steps| frame.step > *steps.end()) {
                return Ok(ReadExtent::LastStep);
            }
            if frame.step >= first {
                format.write(&frame, table).map_err(CommandError::unwritable(&options.output))?;
            }
        }
        Ok(ReadExtent::End)
    })?;
    Ok(output::warn_of_damage(&[ReadStatus { path: path.clone(), health: playback.health(), extent }]))
}

/// The format of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Csv,
    JsonLines,
}

impl Format {
    fn from_path(path: &Path) -> Result<Format, CommandError> {
        let extension = path.extension().and_then(|extension| extension.to_str());
        match extension {
            None if output::is_standard_output(path) => Ok(Format::Csv),
            Some("csv") => Ok(Format::Csv),
            Some("jsonl") => Ok(Format::JsonLines),
            None | Some(_) => Err(CommandError::UnsupportedOutput {
                path: path.into(),
                expected: "expected F.csv or F.jsonl, or - for CSV on standard output",
            }),
        }
    }

    fn header(self) -> &'static str {
        match self {
            Format::Csv => "step,time,name,x,y,vx,vy\n",
            Format::JsonLines => "",
        }
    }

    /// Writes one line per body.
    fn write(self, frame: &SampledState, table: &mut dyn Write) -> std::io::Result<()> {
        let SampledState { step, time, bodies } = frame;
        for body in bodies {
            let name = &body.info.spawn.name;
            let [x, y, vx, vy] = [body.position.x, body.position.y, body.velocity.x, body.velocity.y];
            match self {
                Format::Csv => {
                    let [time, x, y, vx, vy] = [*time, x, y, vx, vy].map(shortest_decimal);
                    writeln!(table, "{step},{time},{},{x},{y},{vx},{vy}", csv_field(name))?;
                }
                Format::JsonLines => {
                    let row = Row { step: *step, time: *time, name, x, y, vx, vy };
                    serde_json::to_writer(&mut *table, &row)?;
                    table.write_all(b"\n")?;
                }
            }
        }
        Ok(())
    }
}

/// A row of the table as JSON, with keys in the order of the CSV columns.
#[derive(serde::Serialize)]
struct Row<'a> {
    step: u64,
    time: f64,
    name: &'a str,
    x: f64,
    y: f64,
    vx: f64,
    vy: f64,
}

/// The shortest decimal that reads back to the same bits. Very small and very large numbers have an exponent.
fn shortest_decimal(number: f64) -> String {
    let size = number.abs();
    if size == 0.0 || (1e-5..1e17).contains(&size) { format!("{number}") } else { format!("{number:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back_to_the_same_bits() {
        for number in [-0.0, 5e-324, 0.1 + 0.2, 1e300, -1.7976931348623157e308] {
            let text = shortest_decimal(number);
            assert!(text.len() < 25, "{text}");
            assert_eq!(text.parse::<f64>().map(f64::to_bits), Ok(f64::to_bits(number)), "{text}");
        }
    }
}
