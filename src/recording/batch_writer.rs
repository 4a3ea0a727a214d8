use std::io::Write;

use crate::physics::BodyId;

use super::{
    BodyTable, Change, Error, Header, Keyframe, RecordedEvent, RecordedState, RunEnd, StateBounds, StateDigest,
    Trailer, cdr,
    digest::IdentityChain,
    limits,
    mcap_writer::{McapWriter, Profile},
    messages::{BodiesMessage, EventMessage},
    metadata,
    scene_update::{self, ColorFn},
    topic::Topic,
    writer_thread::{Batch, Entry, Row},
};

/// Encodes batches as messages and writes them: the part of a writer that can run on a thread of its
/// own.
pub struct BatchWriter<W: Write> {
    header: Header,
    mcap: McapWriter<W>,
    identity: IdentityChain,
    table: BodyTable,
    steps: u64,
    next_id: BodyId,
    events: u64,
    unflushed_events: bool,
    state: RecordedState,
    digest: StateDigest,
    /// The bounds of all full states so far, if the end record stores them.
    state_bounds: Option<StateBounds>,
    /// The colours of the scene updates, if these are enabled.
    color: Option<ColorFn>,
    bytes: Vec<u8>,
}

/// The first format version that divides large keyframes into several messages.
const FIRST_FORMAT_WITH_SPLIT_KEYFRAMES: u32 = 3;

impl<W: Write> BatchWriter<W> {
    /// Creates a batch writer and writes the header section to `output`.
    ///
    /// # Errors
    /// Returns an error if writing fails.
    pub fn new(output: W, profile: Profile, header: &Header) -> Result<BatchWriter<W>, Error> {
        Ok(BatchWriter {
            header: header.clone(),
            mcap: McapWriter::new(
                output,
                profile,
                metadata::header_map(header),
                header.scene.as_ref(),
                &header.images,
            )?,
            identity: IdentityChain::new(header),
            table: BodyTable::default(),
            steps: 0,
            next_id: 0,
            events: 0,
            unflushed_events: false,
            state: RecordedState::default(),
            digest: StateDigest::default(),
            state_bounds: header.has_state_bounds().then(StateBounds::default),
            color: None,
            bytes: Vec::new(),
        })
    }

    /// Writes the entries of a batch.
    ///
    /// # Errors
    /// Returns an error if writing fails, or if the world has bodies whose spawn is not in the batches.
    pub fn write(&mut self, batch: &mut Batch) -> Result<(), Error> {
        let mut rows = batch.rows.as_slice();
        for entry in batch.entries.drain(..) {
            match entry {
                Entry::Colors(color) => self.color = Some(color),
                Entry::Event(event) => self.write_event(&event)?,
                Entry::Snapshot(snapshot) => self.write_keyframe(&Keyframe::new(snapshot, &self.table))?,
                Entry::State { step, rows: count } => {
                    let (state_rows, rest) = rows.split_at(count);
                    rows = rest;
                    self.write_rows(step, state_rows)?;
                }
            }
        }
        Ok(())
    }

    /// Writes the end record and the summary.
    ///
    /// # Errors
    /// Returns an error if writing fails; the file is then readable up to its last flush.
    pub fn finish(self, run_end: RunEnd, recovered: bool) -> Result<(Trailer, W), Error> {
        let trailer = Trailer {
            steps: self.steps,
            collisions: run_end.collisions,
            bodies: self.next_id.into(),
            events: self.events,
            error: run_end.error,
            accuracy: run_end.accuracy,
            recovered,
            state_bounds: self.state_bounds,
            identity: self.identity.identity(),
        };
        let output = self.mcap.finish(metadata::trailer_map(&self.header, &trailer))?;
        Ok((trailer, output))
    }

    /// Writes an event.
    ///
    /// # Errors
    /// Returns an error if writing fails.
    pub fn write_event(&mut self, event: &RecordedEvent) -> Result<(), Error> {
        self.table.apply(&event.change);
        self.events += 1;
        self.unflushed_events = true;
        if let Change::Spawn(info) = &event.change {
            self.next_id = info.id + 1;
        }
        cdr::encode(&EventMessage::new(event), &mut self.bytes);
        self.identity.event(&self.bytes);
        self.write_message(Topic::Events, event.step)
    }

    /// Writes a keyframe, in several messages if it is too large for one. Before format 3 it is then left out, and a
    /// seek starts at an earlier one.
    ///
    /// # Errors
    /// Returns an error if writing fails.
    pub fn write_keyframe(&mut self, keyframe: &Keyframe) -> Result<(), Error> {
        self.next_id = keyframe.next_id;
        let format = self.header.versions.format;
        let mut parts = BodiesMessage::new(keyframe, format).split(limits::KEYFRAME_BYTES);
        if parts.len() > 1 && format < FIRST_FORMAT_WITH_SPLIT_KEYFRAMES {
            return Ok(());
        }
        for part in parts.drain(..) {
            cdr::encode(&part, &mut self.bytes);
            self.write_message(Topic::Bodies, keyframe.step)?;
        }
        Ok(())
    }

    /// Writes a state, and flushes at the end of each simulated second, after events, and when a chunk has its full
    /// size.
    ///
    /// # Errors
    /// Returns an error if writing fails.
    pub fn write_state(&mut self, state: &RecordedState) -> Result<(), Error> {
        self.steps = state.step;
        self.identity.state(state.step, state.digest);
        self.update_bounds(state);
        state.encode(&mut self.bytes);
        self.write_message(Topic::States, state.step)?;
        if self.unflushed_events || (state.step + 1).is_multiple_of(self.header.steps_per_second()) {
            self.unflushed_events = false;
            return self.mcap.flush();
        }
        // The first flush of a run with live events is always that of the initial state: a file waits for the second
        // one.
        let is_initial = state.step == 0 && self.header.has_live_events;
        if is_initial || self.mcap.has_ended_chunk() { self.mcap.flush_output() } else { Ok(()) }
    }

    /// Writes an encoded scene update at `time`, in simulated nanoseconds. A message that is too large
    /// for a record is left out.
    ///
    /// # Errors
    /// Returns an error if writing fails.
    pub fn write_scene_update(&mut self, time: u64, message: &[u8]) -> Result<(), Error> {
        if message.len() <= limits::MESSAGE_BYTES {
            self.mcap.write_message(Topic::Scene, time, message)
        } else {
            Ok(())
        }
    }

    fn update_bounds(&mut self, state: &RecordedState) {
        if let Some(state_bounds) = &mut self.state_bounds
            && state.step.is_multiple_of(self.header.every)
        {
            state_bounds.include_state(&self.table, state);
        }
    }

    fn write_boxes(&mut self, step: u64, rows: &[Row]) -> Result<(), Error> {
        let Some(color) = self.color.filter(|_| step.is_multiple_of(self.header.every)) else { return Ok(()) };
        let time = self.header.log_time(step);
        let mut message = std::mem::take(&mut self.bytes);
        let bodies = self.table.bodies().iter().zip(rows).map(|(info, row)| (info, row.state));
        scene_update::encode(time, bodies, color, &mut message);
        let written = self.write_scene_update(time, &message);
        self.bytes = message;
        written
    }

    fn write_rows(&mut self, step: u64, rows: &[Row]) -> Result<(), Error> {
        if rows.len() != self.table.bodies().len() {
            return Err(Error::UnrecordedEvent { step });
        }
        self.write_boxes(step, rows)?;
        let mut state = std::mem::take(&mut self.state);
        self.fill_state(step, rows, &mut state);
        let written = self.write_state(&state);
        self.state = state;
        written
    }

    fn fill_state(&mut self, step: u64, rows: &[Row], state: &mut RecordedState) {
        let is_full = step.is_multiple_of(self.header.every);
        state.clear();
        self.digest.clear();
        for (row, info) in rows.iter().zip(self.table.bodies()) {
            self.digest.add(row.id, row.state);
            if is_full && !(row.has_infinite_mass && info.is_at_initial_state(row.state)) {
                state.push(row.id, row.state);
            }
        }
        state.step = step;
        state.digest = self.digest.value();
    }

    fn write_message(&mut self, topic: Topic, step: u64) -> Result<(), Error> {
        self.mcap.write_message(topic, self.header.log_time(step), &self.bytes)
    }
}
