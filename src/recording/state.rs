use serde::{Deserialize, Serialize};

use crate::physics::BodyId;

use super::{
    cdr,
    fields::{Fields, Malformed},
};

/// The state of one step as recorded: columns of equal length, ids ascending.
///
/// Bodies of infinite mass that never left the state they were spawned in are left out; a
/// step thinned away by [`Header::every`](super::Header::every) has its digest only. The
/// fields are laid out as in `schemas/State.msg`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RecordedState {
    /// Number of the state; the first is 0.
    pub step: u64,
    /// Over all bodies, those left out included; see [`StateDigest`](super::StateDigest).
    pub digest: u64,
    /// Which bodies.
    pub id: Vec<BodyId>,
    /// Upper-left corners, m.
    pub x: Vec<f64>,
    /// Upper-left corners, m, down.
    pub y: Vec<f64>,
    /// Velocities, m/s.
    pub vx: Vec<f64>,
    /// Velocities, m/s, down.
    pub vy: Vec<f64>,
}

impl RecordedState {
    /// Takes all bodies out, keeping the memory.
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

    /// x, y (m), vx, vy (m/s) of the body at `place`.
    pub fn numbers(&self, place: usize) -> [f64; 4] {
        [self.x[place], self.y[place], self.vx[place], self.vy[place]]
    }

    /// The state in a message, which it must fill exactly.
    ///
    /// Nothing is allocated for a length before so many bytes are seen to be there.
    ///
    /// # Errors
    /// In words, if the bytes are not a state.
    pub fn decode(bytes: &[u8]) -> Result<RecordedState, String> {
        let body = bytes.strip_prefix(&cdr::HEADER).ok_or("the message does not start as little-endian CDR")?;
        let mut columns = Columns { body, fields: Fields::new(body) };
        let state = columns.state().map_err(|Malformed| "the state is cut short")?;
        match columns.fields.remaining() {
            0 => Ok(state),
            rest => Err(format!("{rest} bytes follow the message")),
        }
    }

    /// Replaces the contents of `bytes` by the message of this state.
    ///
    /// The bytes are those of `cdr::encode`; whole columns at a time they cost the
    /// stepping thread a tenth.
    pub fn encode(&self, bytes: &mut Vec<u8>) {
        bytes.clear();
        bytes.extend_from_slice(&cdr::HEADER);
        bytes.extend_from_slice(&self.step.to_le_bytes());
        bytes.extend_from_slice(&self.digest.to_le_bytes());
        put_column(bytes, &self.id, u32::to_le_bytes);
        for column in [&self.x, &self.y, &self.vx, &self.vy] {
            put_column(bytes, column, f64::to_le_bytes);
        }
    }
}

/// Takes the fields of a state out of a message, as [`RecordedState::encode`] put them in.
struct Columns<'a> {
    body: &'a [u8],
    fields: Fields<'a>,
}

impl Columns<'_> {
    fn state(&mut self) -> Result<RecordedState, Malformed> {
        Ok(RecordedState {
            step: self.fields.u64()?,
            digest: self.fields.u64()?,
            id: self.column(u32::from_le_bytes)?,
            x: self.column(f64::from_le_bytes)?,
            y: self.column(f64::from_le_bytes)?,
            vx: self.column(f64::from_le_bytes)?,
            vy: self.column(f64::from_le_bytes)?,
        })
    }

    fn column<T, const N: usize>(&mut self, number: fn([u8; N]) -> T) -> Result<Vec<T>, Malformed> {
        self.align(4)?;
        let length = self.fields.u32()?;
        if length == 0 {
            return Ok(Vec::new());
        }
        self.align(N)?;
        let bytes = self.fields.bytes(u64::from(length) * N as u64)?;
        Ok(bytes.as_chunks().0.iter().map(|bytes| number(*bytes)).collect())
    }

    fn align(&mut self, size: usize) -> Result<(), Malformed> {
        let taken = self.body.len() - self.fields.remaining();
        self.fields.bytes((taken.next_multiple_of(size) - taken) as u64).map(drop)
    }
}

/// A CDR sequence of numbers of N bytes: aligned length, then the aligned numbers.
fn put_column<T: Copy, const N: usize>(bytes: &mut Vec<u8>, column: &[T], to_bytes: fn(T) -> [u8; N]) {
    align(bytes, 4);
    bytes.extend_from_slice(&(column.len() as u32).to_le_bytes());
    if column.is_empty() {
        return;
    }
    align(bytes, N);
    let start = bytes.len();
    bytes.resize(start + N * column.len(), 0);
    for (place, number) in bytes[start..].chunks_exact_mut(N).zip(column) {
        place.copy_from_slice(&to_bytes(*number));
    }
}

/// Pads to a multiple of `size` bytes, counted from behind the header.
fn align(bytes: &mut Vec<u8>, size: usize) {
    let length = (bytes.len() - cdr::HEADER.len()).next_multiple_of(size);
    bytes.resize(cdr::HEADER.len() + length, 0);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn whole_columns_give_the_bytes_of_cdr(step: u64, digest: u64, rows: Vec<(u32, [u64; 4])>) {
            let mut state = RecordedState { step, digest, ..RecordedState::default() };
            for (id, bits) in rows {
                state.push(id, bits.map(f64::from_bits));
            }
            let (mut ours, mut theirs) = (Vec::new(), Vec::new());
            state.encode(&mut ours);
            cdr::encode(&state, &mut theirs);
            prop_assert_eq!(&ours, &theirs);
            let back = RecordedState::decode(&ours).unwrap();
            let bits = |state: &RecordedState| (0..state.id.len()).map(|i| state.numbers(i).map(f64::to_bits)).collect::<Vec<_>>();
            prop_assert_eq!((back.step, back.digest, &back.id), (step, digest, &state.id));
            prop_assert_eq!(bits(&back), bits(&state));
        }

        #[test]
        fn any_bytes_are_a_state_or_an_error_as_cdr_has_it(bytes in proptest::collection::vec(0_u8..4, 0..120)) {
            let message = [cdr::HEADER.as_slice(), &bytes].concat();
            let (ours, theirs) = (RecordedState::decode(&message), cdr::decode::<RecordedState>(&message));
            prop_assert_eq!(ours.ok(), theirs.ok());
        }
    }
}
