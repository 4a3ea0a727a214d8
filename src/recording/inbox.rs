use std::collections::{BTreeMap, VecDeque};

use mcap::records::op;

use super::{
    Damage, End, Item, RecordedState, cdr,
    chunk::{ChunkRecord, RawMessage},
    course::Course,
    fields::{Fields, Malformed},
    limits,
    messages::{BodiesMessage, EventMessage},
    metadata,
    topic::Topic,
};

/// Turns records into the items they hold, or into the damage they are.
pub struct Inbox {
    /// What is known so far.
    pub course: Course,
    /// Items not yet taken.
    pub ready: VecDeque<Item>,
    /// The first damage.
    pub damage: Option<Damage>,
    /// How the run ended, once known.
    pub end: Option<End>,
    format: u32,
    channels: BTreeMap<u16, Option<Topic>>,
    /// What viewers draw of the state that is to come.
    view: Option<Item>,
}

/// Where in the file something was found.
#[derive(Clone, Copy, Debug)]
pub struct Locus {
    /// The chunk, counted from 1; none outside of chunks.
    pub chunk: Option<u64>,
    /// Of the top-level record, bytes from the start of the file.
    pub offset: u64,
}

impl Inbox {
    /// At the start of a recording of that format.
    pub fn new(course: Course, format: u32) -> Inbox {
        let channels = first_channels();
        Inbox { course, ready: VecDeque::new(), damage: None, end: None, format, channels, view: None }
    }

    /// Starts over somewhere else in the recording, with the channels of its index.
    pub fn jump(&mut self, channels: &[Vec<u8>]) {
        self.course.jump();
        self.ready.clear();
        self.damage = None;
        self.end = None;
        self.view = None;
        self.channels = first_channels();
        for body in channels {
            // The index has passed its checksum; what is no channel there is none of ours.
            let _ = self.channel(body);
        }
    }

    /// Takes a record of a chunk.
    pub fn chunk_record(&mut self, locus: Locus, record: &ChunkRecord<'_>) {
        let taken = match record.opcode {
            op::MESSAGE => self.message(locus, record),
            op::CHANNEL => self.channel(record.body),
            op::SCHEMA => Ok(()),
            other => Err(format!("a record of kind {other:#04x} does not belong into a chunk")),
        };
        if let Err(what) = taken {
            self.lose(locus, what);
        }
    }

    /// Takes a metadata record.
    pub fn metadata(&mut self, locus: Locus, body: &[u8]) {
        match metadata::parse(body) {
            Ok((metadata::END, map)) => match metadata::end(&map).and_then(|end| self.course.end(&end).map(|()| end)) {
                Ok(end) => {
                    self.end = Some(end.clone());
                    self.ready.push_back(Item::End(end));
                }
                Err(what) => self.note(locus, what),
            },
            Ok(_) => {}
            Err(Malformed) => self.note(locus, "the metadata is damaged".into()),
        }
    }

    /// Notes damage that has cost messages.
    pub fn lose(&mut self, locus: Locus, what: String) {
        self.course.lose();
        self.view = None;
        self.note(locus, what);
    }

    /// Notes damage that has cost nothing.
    pub fn note(&mut self, locus: Locus, what: String) {
        let Locus { chunk, offset } = locus;
        let damage = Damage { chunk, offset, what, after: self.course.last_step() };
        self.damage.get_or_insert_with(|| damage.clone());
        self.ready.push_back(Item::Damaged(damage));
    }

    fn message(&mut self, locus: Locus, record: &ChunkRecord<'_>) -> Result<(), String> {
        let RawMessage { channel, log_time, data } = record.message().ok_or("a message is damaged")?;
        let Some(topic) = self.channels.get(&channel).copied().flatten() else { return Ok(()) };
        match topic {
            Topic::Events => {
                check_length(data, limits::EVENT_BYTES)?;
                let event = cdr::decode::<EventMessage>(data)?.event()?;
                self.cross_gap(event.step);
                self.course.event(&event, data)?;
                self.ready.push_back(Item::Event(event));
            }
            Topic::Bodies => {
                check_length(data, limits::KEYFRAME_BYTES)?;
                let keyframe = cdr::decode::<BodiesMessage>(data)?.keyframe(self.format)?;
                self.cross_gap(keyframe.step);
                self.course.keyframe(&keyframe)?;
                self.ready.push_back(Item::Keyframe(keyframe));
            }
            Topic::States => self.state(locus, RecordedState::decode(data)?)?,
            Topic::Scene => self.view = Some(Item::View { time: log_time, message: data.into() }),
        }
        Ok(())
    }

    fn cross_gap(&mut self, step: u64) {
        self.ready.extend(self.course.cross_gap(step).map(Item::Gap));
    }

    fn state(&mut self, locus: Locus, state: RecordedState) -> Result<(), String> {
        self.cross_gap(state.step);
        let view = self.view.take();
        let doubt = self.course.state(&state)?;
        match doubt {
            None => self.ready.extend(view.into_iter().chain([Item::State(state)])),
            Some(what) => {
                self.ready.push_back(Item::Doubtful(state));
                self.note(locus, what);
            }
        }
        Ok(())
    }

    fn channel(&mut self, body: &[u8]) -> Result<(), String> {
        let mut fields = Fields::new(body);
        let mut read = || Ok((fields.u16()?, fields.u16()?, fields.text()?, fields.text()?));
        let (id, _schema, name, encoding) = read().map_err(|Malformed| "a channel is damaged")?;
        let topic = Topic::named(name);
        if topic.is_some_and(|topic| topic.message_encoding() != encoding) {
            return Err(format!("the topic {name} is encoded as {encoding:?}"));
        }
        self.channels.insert(id, topic);
        Ok(())
    }
}

fn check_length(message: &[u8], limit: usize) -> Result<(), String> {
    match message.len() <= limit {
        true => Ok(()),
        false => Err(format!("a message of {} bytes, where {limit} are the most", message.len())),
    }
}

/// What a recording declares in its first chunk, should that be damaged.
fn first_channels() -> BTreeMap<u16, Option<Topic>> {
    (1..).zip(Topic::ALL.map(Some)).collect()
}
