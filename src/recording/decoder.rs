use std::collections::{BTreeMap, VecDeque};

use mcap::records::op;

use super::{
    Damage, Item, RecordedState, Trailer, cdr,
    chunk_reader::{ChunkRecord, RawMessage},
    limits,
    messages::{BodiesMessage, EventMessage},
    metadata,
    record_reader::{Cursor, Malformed},
    sequence_validator::SequenceValidator,
    topic::Topic,
};

/// Decodes MCAP records to items and reports damage.
pub struct Decoder {
    /// Checks the order of the items.
    pub validator: SequenceValidator,
    /// Decoded items, not yet returned to the caller.
    pub ready: VecDeque<Item>,
    /// The first damage.
    pub damage: Option<Damage>,
    /// The end record, once decoded.
    pub trailer: Option<Trailer>,
    format: u32,
    channels: BTreeMap<u16, Option<Topic>>,
    /// The scene update of the next state.
    scene_update: Option<Item>,
    /// The messages of a keyframe read so far.
    keyframe: Option<BodiesMessage>,
}

/// A location in the file.
#[derive(Clone, Copy, Debug)]
pub struct Location {
    /// The number of the chunk, counted from 1; `None` outside of chunks.
    pub chunk: Option<u64>,
    /// The offset of the top-level record, in bytes from the start of the file.
    pub offset: u64,
}

impl Decoder {
    /// Creates a decoder at the start of a recording of this format version.
    pub fn new(validator: SequenceValidator, format: u32) -> Decoder {
        let channels = default_channels();
        Decoder {
            validator,
            ready: VecDeque::new(),
            damage: None,
            trailer: None,
            format,
            channels,
            scene_update: None,
            keyframe: None,
        }
    }

    /// Resets the decoder for reading at another place, with the channels of the index.
    pub fn reset(&mut self, channels: &[Vec<u8>]) {
        self.validator.reset();
        self.ready.clear();
        self.damage = None;
        self.trailer = None;
        self.scene_update = None;
        self.keyframe = None;
        self.channels = default_channels();
        for body in channels {
            // The index passed its CRC, so an unparsable channel is not one of ours.
            let _ = self.add_channel(body);
        }
    }

    /// Decodes a record of a chunk.
    pub fn decode_chunk_record(&mut self, location: Location, record: &ChunkRecord<'_>) {
        let result = match record.opcode {
            op::MESSAGE => self.decode_message(location, record),
            op::CHANNEL => self.add_channel(record.body),
            op::SCHEMA => Ok(()),
            other => Err(format!("a record with opcode {other:#04x} is not allowed in a chunk")),
        };
        if let Err(reason) = result {
            self.mark_lost(location, reason);
        }
    }

    /// Decodes a metadata record.
    pub fn decode_metadata(&mut self, location: Location, body: &[u8]) {
        match metadata::parse(body) {
            Ok((metadata::TRAILER, map)) => match metadata::parse_trailer(&map)
                .and_then(|trailer| self.validator.check_trailer(&trailer).map(|()| trailer))
            {
                Ok(trailer) => {
                    self.trailer = Some(trailer.clone());
                    self.ready.push_back(Item::Trailer(trailer));
                }
                Err(reason) => self.report_damage(location, reason),
            },
            Ok(_) => {}
            Err(Malformed) => self.report_damage(location, "the metadata is damaged".into()),
        }
    }

    /// Reports damage through which messages were lost.
    pub fn mark_lost(&mut self, location: Location, reason: String) {
        self.validator.mark_lost();
        self.scene_update = None;
        self.keyframe = None;
        self.report_damage(location, reason);
    }

    /// Reports damage through which no message was lost.
    pub fn report_damage(&mut self, location: Location, reason: String) {
        let Location { chunk, offset } = location;
        let damage = Damage { chunk, offset, reason, after: self.validator.last_step() };
        self.damage.get_or_insert_with(|| damage.clone());
        self.ready.push_back(Item::Damaged(damage));
    }

    fn decode_message(&mut self, location: Location, record: &ChunkRecord<'_>) -> Result<(), String> {
        let RawMessage { channel, log_time, data } = record.message().ok_or("a message record is damaged")?;
        let Some(topic) = self.channels.get(&channel).copied().flatten() else { return Ok(()) };
        if topic != Topic::Bodies {
            self.finish_keyframe()?;
        }
        match topic {
            Topic::Events => {
                check_length(data, limits::EVENT_BYTES)?;
                let event = cdr::decode::<EventMessage>(data)?.into_event()?;
                self.cross_gap(event.step);
                self.validator.add_event(&event, data)?;
                self.ready.push_back(Item::Event(event));
            }
            Topic::Bodies => {
                check_length(data, limits::KEYFRAME_BYTES)?;
                let part = cdr::decode::<BodiesMessage>(data)?;
                match &mut self.keyframe {
                    Some(keyframe) => keyframe.append(part)?,
                    None => self.keyframe = Some(part),
                }
            }
            Topic::States => self.add_state(location, RecordedState::decode(data)?)?,
            Topic::Scene => self.scene_update = Some(Item::SceneUpdate { time: log_time, message: data.into() }),
        }
        Ok(())
    }

    fn finish_keyframe(&mut self) -> Result<(), String> {
        let Some(message) = self.keyframe.take() else { return Ok(()) };
        let keyframe = message.into_keyframe(self.format)?;
        self.cross_gap(keyframe.step);
        self.validator.add_keyframe(&keyframe)?;
        self.ready.push_back(Item::Keyframe(keyframe));
        Ok(())
    }

    fn cross_gap(&mut self, step: u64) {
        self.ready.extend(self.validator.cross_gap(step).map(Item::Gap));
    }

    fn add_state(&mut self, location: Location, state: RecordedState) -> Result<(), String> {
        self.cross_gap(state.step);
        let scene_update = self.scene_update.take();
        match self.validator.add_state(&state)? {
            None => self.ready.extend(scene_update.into_iter().chain([Item::State(state)])),
            Some(reason) => {
                self.ready.push_back(Item::SuspectState(state));
                self.report_damage(location, reason);
            }
        }
        Ok(())
    }

    fn add_channel(&mut self, body: &[u8]) -> Result<(), String> {
        let mut fields = Cursor::new(body);
        let mut read = || Ok((fields.u16()?, fields.u16()?, fields.text()?, fields.text()?));
        let (id, _schema, name, encoding) = read().map_err(|Malformed| "a channel record is damaged")?;
        let topic = Topic::from_name(name);
        if topic.is_some_and(|topic| topic.message_encoding() != encoding) {
            return Err(format!("the topic {name} has the unexpected encoding {encoding:?}"));
        }
        self.channels.insert(id, topic);
        Ok(())
    }
}

fn check_length(message: &[u8], limit: usize) -> Result<(), String> {
    match message.len() <= limit {
        true => Ok(()),
        false => Err(format!("a message has {} bytes, but at most {limit} are allowed", message.len())),
    }
}

/// The channels of every recording, in case the first chunk, which declares them, is damaged.
fn default_channels() -> BTreeMap<u16, Option<Topic>> {
    (1..).zip(Topic::ALL.map(Some)).collect()
}
