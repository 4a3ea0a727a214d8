use super::arguments::ExportOptions;
use super::error::CommandError;
use super::{Exit, damage, output};
use crate::illustration::{Condition, Reached};
use crate::recording::{self, Frame, Playback};
use std::{io::Write, path::Path};

/// Writes the states of a recording as a table.
pub fn run(options: &ExportOptions) -> Result<Exit, CommandError> {
    let format = Format::of(&options.output)?;
    let failed = |error| CommandError::recording(&options.recording, error);
    let mut playback = Playback::new(recording::open(&options.recording).map_err(failed)?);
    let end = playback.header().steps;
    let from = options.from.unwrap_or(0);
    let to = options.to.unwrap_or(end).min(end);
    let own = options.shard.steps(from, to);
    let first = own.as_ref().map_or(from.max(end + 1), |own| *own.start());
    playback.seek(first).map_err(failed)?;
    let mut reached = Reached::End;
    output::write_file(&options.output, options.force, |table| {
        let failed_write = CommandError::unwritable(&options.output);
        if options.shard.number == 1 {
            table.write_all(format.heading().as_bytes()).map_err(&failed_write)?;
        }
        for frame in playback.by_ref() {
            let frame = frame.map_err(failed)?;
            if own.as_ref().is_none_or(|own| frame.step > *own.end()) {
                reached = Reached::LastStep;
                break;
            }
            if frame.step >= first {
                format.write(&frame, table).map_err(&failed_write)?;
            }
        }
        Ok(())
    })?;
    let path = options.recording.clone();
    Ok(damage::tell(&Condition { path, health: playback.health(), reached }))
}

/// What a table is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Csv,
    JsonLines,
}

impl Format {
    fn of(path: &Path) -> Result<Format, CommandError> {
        let extension = path.extension().and_then(|extension| extension.to_str());
        match extension {
            None if output::is_standard_output(path) => Ok(Format::Csv),
            Some("csv") => Ok(Format::Csv),
            Some("jsonl") => Ok(Format::JsonLines),
            None | Some(_) => {
                Err(CommandError::UnknownKind { path: path.into(), expected: "a table is F.csv, F.jsonl or -" })
            }
        }
    }

    fn heading(self) -> &'static str {
        match self {
            Format::Csv => "step,time,name,x,y,vx,vy\n",
            Format::JsonLines => "",
        }
    }

    /// One line for each body.
    fn write(self, frame: &Frame, table: &mut dyn Write) -> std::io::Result<()> {
        let Frame { step, time, bodies } = frame;
        for body in bodies {
            let name = &body.known.spawn.name;
            let [x, y, vx, vy] = [body.position.x, body.position.y, body.velocity.x, body.velocity.y];
            match self {
                Format::Csv => {
                    let [time, x, y, vx, vy] = [*time, x, y, vx, vy].map(shortest);
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

/// A row of the table as JSON, its keys in the order of the columns.
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

/// The shortest decimal that reads back to the same bits; with an exponent only where zeros
/// would outnumber digits.
fn shortest(number: f64) -> String {
    let size = number.abs();
    if size == 0.0 || (1e-5..1e17).contains(&size) { format!("{number}") } else { format!("{number:e}") }
}

/// A field quoted as RFC 4180 has it, where it must be.
fn csv_field(text: &str) -> std::borrow::Cow<'_, str> {
    if text.contains(['"', ',', '\n', '\r']) {
        return format!("\"{}\"", text.replace('"', "\"\"")).into();
    }
    text.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_quoted_where_a_table_would_break() {
        assert_eq!(csv_field("#1"), "#1");
        assert_eq!(csv_field("a,\"b\""), "\"a,\"\"b\"\"\"");
    }

    #[test]
    fn numbers_read_back_to_the_same_bits() {
        for number in [-0.0, 5e-324, 0.1 + 0.2, 1e300, -1.7976931348623157e308] {
            let text = shortest(number);
            assert!(text.len() < 25, "{text}");
            assert_eq!(text.parse::<f64>().map(f64::to_bits), Ok(f64::to_bits(number)), "{text}");
        }
    }
}
