use serde::{Deserialize, Serialize};

use crate::physics::{Body, BodyId, Rect, Vector};

use super::{
    BodyInfo, BodyTable,
    cdr::{self, ColumnReader},
    record_reader::Malformed,
};

/// The state of one step as recorded: columns of equal length, ids ascending.
///
/// Bodies of infinite mass that were spawned at rest and are still in their initial state are left out.
/// A step thinned out by [`Header::every`](super::Header::every) has only its digest. The fields are laid
/// out as in `schemas/State.msg`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RecordedState {
    /// The step; the first is 0.
    pub step: u64,
    /// The digest of all bodies, including those left out; see [`StateDigest`](super::StateDigest).
    pub digest: u64,
    /// The ids of the bodies.
    pub id: Vec<BodyId>,
    /// The x coordinates of the upper-left corners, m.
    pub x: Vec<f64>,
    /// The y coordinates (down) of the upper-left corners, m.
    pub y: Vec<f64>,
    /// The x components of the velocities, m/s.
    pub vx: Vec<f64>,
    /// The y components (down) of the velocities, m/s.
    pub vy: Vec<f64>,
}

impl RecordedState {
    /// Removes all bodies and keeps the allocated memory.
    pub fn clear(&mut self) {
        self.id.clear();
        for column in [&mut self.x, &mut self.y, &mut self.vx, &mut self.vy] {
            column.clear();
        }
    }

    /// Adds a body: x, y (m), vx, vy (m/s).
    pub fn push(&mut self, id: BodyId, [x, y, vx, vy]: [f64; 4]) {
        self.id.push(id);
        self.x.push(x);
        self.y.push(y);
        self.vx.push(vx);
        self.vy.push(vy);
    }

    /// Returns x, y (m), vx, vy (m/s) of the body at `index`.
    pub fn body_state(&self, index: usize) -> [f64; 4] {
        [self.x[index], self.y[index], self.vx[index], self.vy[index]]
    }

    /// Decodes the state in a message, which it must fill exactly. Its columns have the same length.
    ///
    /// Lengths are checked against the number of bytes left before memory is allocated.
    ///
    /// # Errors
    /// Returns a description of the problem if the bytes are not a state.
    pub fn decode(bytes: &[u8]) -> Result<RecordedState, String> {
        let mut reader = ColumnReader::new(bytes)?;
        let state = RecordedState::read(&mut reader).map_err(|Malformed| "the message of a state is too short")?;
        reader.finish()?;
        let RecordedState { step, id, x, y, vx, vy, .. } = &state;
        if [x, y, vx, vy].into_iter().any(|column| column.len() != id.len()) {
            return Err(format!("state {step} has columns of different lengths"));
        }
        Ok(state)
    }

    fn read(reader: &mut ColumnReader<'_>) -> Result<RecordedState, Malformed> {
        Ok(RecordedState {
            step: reader.u64()?,
            digest: reader.u64()?,
            id: reader.column(u32::from_le_bytes)?,
            x: reader.column(f64::from_le_bytes)?,
            y: reader.column(f64::from_le_bytes)?,
            vx: reader.column(f64::from_le_bytes)?,
            vy: reader.column(f64::from_le_bytes)?,
        })
    }

    /// Replaces the contents of `bytes` by the message of this state.
    ///
    /// The bytes are the same as those of `cdr::encode`, but encoding entire columns takes a tenth of
    /// the time.
    pub fn encode(&self, bytes: &mut Vec<u8>) {
        bytes.clear();
        bytes.extend_from_slice(&cdr::HEADER);
        bytes.extend_from_slice(&self.step.to_le_bytes());
        bytes.extend_from_slice(&self.digest.to_le_bytes());
        cdr::encode_column(bytes, &self.id, u32::to_le_bytes);
        for column in [&self.x, &self.y, &self.vx, &self.vy] {
            cdr::encode_column(bytes, column, f64::to_le_bytes);
        }
    }
}

/// Returns x, y (m), vx, vy (m/s) of a body.
pub fn body_state(body: &Body) -> [f64; 4] {
    let (position, velocity) = (body.rect.origin, body.velocity);
    [position.x, position.y, velocity.x, velocity.y]
}

/// Bounds of all full states of a recording, so that pictures drawn separately can share one scale.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StateBounds {
    /// The highest speed of any body, m/s.
    pub top_speed: f64,
    /// The bounding box of all bodies of finite mass; `None` if there never is one.
    pub bounds: Option<Bounds>,
}

/// A rectangle stored as two corners, so that the result does not depend on the order of unions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The upper-left corner, m.
    pub near: Vector,
    /// The lower-right corner, m.
    pub far: Vector,
}

impl StateBounds {
    /// Extends the bounds by a full state of the bodies of a table.
    pub fn include_state(&mut self, table: &BodyTable, state: &RecordedState) {
        for (info, recorded) in table.join_state(state) {
            self.include(info, recorded.unwrap_or_else(|| info.initial_state()));
        }
    }

    /// Extends the bounds by a body in a state: x, y (m), vx, vy (m/s).
    pub fn include(&mut self, info: &BodyInfo, [x, y, vx, vy]: [f64; 4]) {
        let speed = Vector::new(vx, vy).norm();
        if speed > self.top_speed {
            self.top_speed = speed;
        }
        if info.spawn.mass == f64::INFINITY {
            return;
        }
        let size = &info.spawn.rect;
        let body = Bounds::of(&Rect::new(Vector::new(x, y), size.width(), size.height()));
        if body.near.is_finite() && body.far.is_finite() {
            self.bounds = Some(self.bounds.map_or(body, |bounds| bounds.union(&body)));
        }
    }
}

impl Bounds {
    /// Returns the bounds of one rectangle.
    pub fn of(rect: &Rect) -> Bounds {
        Bounds { near: rect.origin, far: rect.far_corner() }
    }

    /// Returns the bounds as a rectangle.
    pub fn rect(&self) -> Rect {
        Rect::new(self.near, self.far.x - self.near.x, self.far.y - self.near.y)
    }

    fn union(&self, other: &Bounds) -> Bounds {
        Bounds { near: other.near.min(self.near), far: other.far.max(self.far) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn column_encoding_gives_the_same_bytes_as_cdr(step: u64, digest: u64, rows: Vec<(u32, [u64; 4])>) {
            let mut state = RecordedState { step, digest, ..RecordedState::default() };
            for (id, bits) in rows {
                state.push(id, bits.map(f64::from_bits));
            }
            let (mut columns, mut reference) = (Vec::new(), Vec::new());
            state.encode(&mut columns);
            cdr::encode(&state, &mut reference);
            prop_assert_eq!(&columns, &reference);
            let decoded = RecordedState::decode(&columns).unwrap();
            let bits = |state: &RecordedState| (0..state.id.len()).map(|i| state.body_state(i).map(f64::to_bits)).collect::<Vec<_>>();
            prop_assert_eq!((decoded.step, decoded.digest, &decoded.id), (step, digest, &state.id));
            prop_assert_eq!(bits(&decoded), bits(&state));
        }

        #[test]
        fn arbitrary_bytes_decode_to_the_same_result_as_cdr(bytes in proptest::collection::vec(0_u8..4, 0..120)) {
            let message = [cdr::HEADER.as_slice(), &bytes].concat();
            let (state, reference) = (RecordedState::decode(&message), cdr::decode::<RecordedState>(&message));
            prop_assert_eq!(state.ok(), reference.ok());
        }
    }
}
