//! Tables for plotting: MCAP files with one topic per body, which `rebond export -o FILE.mcap` writes. They are not
//! recordings.

use std::{fs::File, io, path::Path};

use mcap::records::op;

use super::{
    Error,
    index::{self, Tail},
    open_file,
    record_reader::RecordReader,
};

/// The schema of all topics of a table for plotting.
pub const BODY_STATE: &str = "rebond_msgs/msg/BodyState";

/// Returns true if the file at `path` is a table for plotting: the only schema in its summary is that of bodies.
pub fn is_plot_table(path: &Path) -> bool {
    open_file(path).is_ok_and(|file| has_only_body_states(file).unwrap_or(false))
}

impl Error {
    /// Returns this error of reading the file at `path`, or [`Error::PlotTable`] if the file is a table for plotting.
    pub fn or_plot_table(self, path: &Path) -> Error {
        match self {
            Error::NotARecording { .. } if is_plot_table(path) => Error::PlotTable,
            error => error,
        }
    }
}

/// Returns true if the summary of an MCAP file has the schema of bodies and no other one.
fn has_only_body_states(file: File) -> io::Result<bool> {
    let mut records = RecordReader::new(file)?;
    let Tail::Summary(start) = index::tail(records.source())? else { return Ok(false) };
    records.seek(start)?;
    let mut has_body_states = false;
    while let Ok(Some(record)) = records.next_record() {
        match record.opcode {
            op::SCHEMA if index::schema_name(&records.body) == Ok(BODY_STATE) => has_body_states = true,
            op::SCHEMA => return Ok(false),
            op::CHANNEL => {}
            _ => break, // Schemas and channels are at the start of the summary.
        }
    }
    Ok(has_body_states)
}
