use std::collections::{BTreeMap, VecDeque};

use mcap::records::op;

use super::{
    Damage, Header, Item, RecordedEvent, RecordedState, Trailer, cdr,
    chunk_reader::{ChunkRecord, RawMessage},
    limits,
    messages::{BodiesMessage, EventMessage},
    metadata,
    record_reader::{FieldReader, Malformed},
    scene_update,
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
    header: Header,
    /// The topics that each schema fits.
    schemas: BTreeMap<u16, Vec<Topic>>,
    channels: BTreeMap<u16, Option<Topic>>,
    /// The channels of topics that were declared.
    declared: BTreeMap<u16, Topic>,
    /// The first channel of another name that has the schema of a topic.
    renamed: BTreeMap<Topic, (Location, String)>,
    step: OpenStep,
    /// The message or damage after the items in `ready`: it changes the living bodies, which belong to these items.
    deferred: Option<(Location, Deferred)>,
    /// The offset of the last record, if it has fields that are unknown: then its length may be damaged.
    pub suspect: Option<u64>,
    /// The colours in the last scene update.
    colors: scene_update::Colors,
}

/// A location in the file.
#[derive(Clone, Copy, Debug, Default)]
pub struct Location {
    /// The number of the chunk, counted from 1; `None` outside of chunks.
    pub chunk: Option<u64>,
    /// The offset of the top-level record, in bytes from the start of the file.
    pub offset: u64,
}

/// The messages of the current step that follow its events, until a message of another step arrives. So their order in
/// the file does not matter.
#[derive(Default)]
struct OpenStep {
    location: Location,
    /// The log time, in simulated nanoseconds; `None` before the first message.
    time: Option<u64>,
    /// The step, if a message other than a scene update was read.
    number: Option<u64>,
    keyframe: Option<BodiesMessage>,
    scene_update: Option<Vec<u8>>,
    state: Option<RecordedState>,
}

impl OpenStep {
    /// Returns true if a message with this time belongs to the step. A scene update has no number.
    fn is_same(&self, time: u64, number: Option<u64>) -> bool {
        self.time == Some(time) && (number.is_none() || self.number.is_none() || number == self.number)
    }
}

#[expect(clippy::large_enum_variant, reason = "lost messages are rare: nearly all items are of the larger variant")]
enum Deferred {
    Message(Message),
    Lost(String),
}

/// A decoded message.
struct Message {
    log_time: u64,
    publish_time: u64,
    content: Content,
}

enum Content {
    Event(RecordedEvent, Vec<u8>),
    Keyframe(BodiesMessage),
    State(RecordedState),
    SceneUpdate(Vec<u8>),
}

impl Content {
    /// Returns the step and the kind of the item with its article; `None` for a scene update, which has only a time.
    fn step(&self) -> Option<(u64, &'static str)> {
        match self {
            Content::Event(event, _) => Some((event.step, "an event")),
            Content::Keyframe(part) => Some((part.step(), "a keyframe")),
            Content::State(state) => Some((state.step, "a state")),
            Content::SceneUpdate(_) => None,
        }
    }
}

impl Decoder {
    /// Creates a decoder at the start of a recording.
    pub fn new(header: &Header) -> Decoder {
        Decoder {
            validator: SequenceValidator::new(header),
            ready: VecDeque::new(),
            damage: None,
            trailer: None,
            header: header.clone(),
            schemas: BTreeMap::new(),
            declared: BTreeMap::new(),
            renamed: BTreeMap::new(),
            channels: default_channels(),
            step: OpenStep::default(),
            deferred: None,
            suspect: None,
            colors: scene_update::Colors::new(),
        }
    }

    /// Resets the decoder for reading at another place, with the schemas and channels of the index.
    pub fn reset(&mut self, definitions: &[(u8, Vec<u8>)]) {
        self.validator.reset();
        self.ready.clear();
        self.damage = None;
        self.trailer = None;
        self.step = OpenStep::default();
        self.deferred = None;
        self.suspect = None;
        self.colors.clear();
        self.schemas.clear();
        self.channels = default_channels();
        for (opcode, body) in definitions {
            // The definitions of the index are compared with the data section when that is read.
            let _ = match *opcode {
                op::SCHEMA => self.add_schema(body),
                _ => self.add_channel(None, body),
            };
        }
    }

    /// Decodes a record of the data section, inside or outside of a chunk.
    ///
    /// # Errors
    /// If a message cannot be decoded, which is reported as damage: outside of a chunk, its length may be damaged, too.
    pub fn decode_record(&mut self, location: Location, record: &ChunkRecord<'_>) -> Result<(), Malformed> {
        let added = match record.opcode {
            op::MESSAGE => match self.decode_message(record) {
                Ok(Some(message)) => {
                    self.add_message(location, message);
                    Ok(())
                }
                Ok(None) => Ok(()),
                Err(reason) => {
                    self.mark_lost(location, reason);
                    return Err(Malformed);
                }
            },
            op::SCHEMA => self.add_schema(record.body),
            op::CHANNEL => self.add_channel(Some(location), record.body),
            0x80.. => Ok(()), // Private records of other programs.
            other => {
                self.mark_lost(location, format!("a record with opcode {other:#04x} is not allowed in a chunk"));
                Ok(())
            }
        };
        if let Err(reason) = added {
            self.report_damage(location, reason);
        }
        Ok(())
    }

    /// Continues after the items in `ready` were returned. Returns false if there was nothing to do.
    pub fn resume(&mut self) -> bool {
        let Some((location, deferred)) = self.deferred.take() else { return false };
        match deferred {
            Deferred::Message(message) => self.add_message(location, message),
            Deferred::Lost(reason) => self.mark_lost(location, reason),
        }
        true
    }

    /// Returns true if the step at `time`, in simulated nanoseconds, has begun and may continue.
    pub fn is_reading_step_at(&self, time: u64) -> bool {
        self.step.time == Some(time)
    }

    /// Decodes a metadata record of the data section.
    pub fn decode_metadata(&mut self, location: Location, body: &[u8], settings_offset: u64) {
        let Ok((name, map)) = metadata::parse(body) else {
            return self.report_damage(location, "the metadata is damaged".into());
        };
        match name {
            metadata::HEADER if location.offset != settings_offset => {
                self.report_damage(location, format!("a second metadata record {name:?}"));
            }
            metadata::TRAILER => self.decode_trailer(location, &map),
            _ => {}
        }
    }

    fn decode_trailer(&mut self, location: Location, map: &metadata::Map) {
        self.finish_step();
        if self.trailer.is_some() {
            return self.report_damage(location, format!("a second metadata record {:?}", metadata::TRAILER));
        }
        let trailer = match metadata::parse_trailer(map) {
            Ok(trailer) => trailer,
            Err(reason) => return self.report_damage(location, reason),
        };
        let expected = metadata::trailer_map(&self.header, &trailer);
        let difference = metadata::difference(map, &expected, self.header.scene.as_ref());
        let checked = difference.map_or_else(|| self.validator.check_trailer(&trailer), Err);
        self.trailer = Some(trailer.clone());
        match checked {
            Ok(()) => self.ready.push_back(Item::Trailer(trailer)),
            Err(reason) => self.report_damage(location, reason),
        }
    }

    /// Reports damage through which messages were lost.
    pub fn mark_lost(&mut self, location: Location, reason: String) {
        self.finish_step();
        if self.ready.is_empty() {
            self.report_loss(location, reason);
        } else {
            self.deferred = Some((location, Deferred::Lost(reason)));
        }
    }

    fn report_loss(&mut self, location: Location, reason: String) {
        self.validator.mark_lost();
        self.report_damage(location, reason);
    }

    /// Reports damage through which no message was lost.
    pub fn report_damage(&mut self, location: Location, mut reason: String) {
        const REASON_BYTES: usize = 2000;
        if reason.len() > REASON_BYTES {
            let end = (0..=REASON_BYTES).rev().find(|end| reason.is_char_boundary(*end)).unwrap_or(0);
            reason.truncate(end);
            reason.push('…');
        }
        let Location { chunk, offset } = self.suspect.map_or(location, |offset| Location { chunk: None, offset });
        let damage = Damage { chunk, offset, reason, after: self.validator.last_step() };
        self.damage.get_or_insert_with(|| damage.clone());
        self.ready.push_back(Item::Damaged(damage));
    }

    /// Returns the items of the current step. No message of it follows.
    pub fn finish_step(&mut self) {
        let step = std::mem::take(&mut self.step);
        let location = step.location;
        if let Err(reason) = self.emit_step(step) {
            self.report_loss(location, reason);
        }
    }

    fn emit_step(&mut self, step: OpenStep) -> Result<(), String> {
        let OpenStep { location, time, keyframe, scene_update, state, .. } = step;
        let Some(state) = state else {
            if scene_update.is_some() && step.number.is_none() {
                self.report_damage(location, "a scene update belongs to no state".into());
            }
            return Ok(()); // The rest of the step is missing, which the next state shows.
        };
        self.validator.note_keyframe(state.step, keyframe.is_some());
        if let Some(message) = keyframe {
            let keyframe = message.into_keyframe(self.header.versions.format)?;
            self.validator.add_keyframe(&keyframe)?;
            match self.validator.compare_keyframe(&keyframe, &state) {
                None => self.ready.push_back(Item::Keyframe(keyframe)),
                Some(reason) => self.report_damage(location, reason),
            }
        }
        if let Some(reason) = self.validator.add_state(&state)? {
            self.ready.push_back(Item::SuspectState(state));
            self.report_damage(location, reason);
            return Ok(());
        }
        let difference = self.validator.table().and_then(|table| {
            let time = self.header.log_time(state.step);
            let colors = &mut self.colors;
            scene_update.as_ref().and_then(|message| scene_update::difference(message, time, table, &state, colors))
        });
        // A state without bodies has no boxes.
        let is_shown = difference.is_none() && self.validator.is_full(state.step);
        let problem = difference.or_else(|| self.validator.check_presence(scene_update.is_some(), &state));
        let problem = problem.or_else(|| self.validator.check_plan(&state));
        if let (Some(time), Some(message), true) = (time, scene_update, is_shown) {
            self.ready.push_back(Item::SceneUpdate { time, message });
        }
        self.ready.push_back(Item::State(state));
        if let Some(reason) = problem {
            self.report_damage(location, reason);
        }
        Ok(())
    }

    /// Decodes a message, if its topic is one of rebond.
    fn decode_message(&self, record: &ChunkRecord<'_>) -> Result<Option<Message>, String> {
        let RawMessage { channel, log_time, publish_time, data } =
            record.message().ok_or("a message record is damaged")?;
        let Some(topic) = self.channels.get(&channel).copied().flatten() else { return Ok(None) };
        let content = match topic {
            Topic::Events => {
                check_length(data, limits::EVENT_BYTES)?;
                Content::Event(cdr::decode::<EventMessage>(data)?.into_event()?, data.into())
            }
            Topic::Bodies => {
                check_length(data, limits::KEYFRAME_BYTES)?;
                Content::Keyframe(cdr::decode::<BodiesMessage>(data)?)
            }
            Topic::States => Content::State(RecordedState::decode(data)?),
            Topic::Scene => Content::SceneUpdate(data.into()),
        };
        Ok(Some(Message { log_time, publish_time, content }))
    }

    fn add_message(&mut self, location: Location, message: Message) {
        let step = message.content.step();
        let expected = step.map_or(message.log_time, |(step, _)| self.header.log_time(step));
        if !self.step.is_same(expected, step.map(|(step, _)| step)) {
            self.finish_step();
            if !self.ready.is_empty() {
                self.deferred = Some((location, Deferred::Message(message)));
                return;
            }
            self.step = OpenStep { location, time: Some(expected), ..OpenStep::default() };
        }
        self.check_times(location, &message, expected);
        if let Some((step, what)) = step {
            if let Some(reason) = self.validator.skipped_beyond_plan(step, what) {
                self.step = OpenStep::default();
                return self.report_loss(location, reason);
            }
            self.step.number = Some(step);
            self.ready.extend(self.validator.cross_gap(step).map(Item::Gap));
            if let Some(reason) = self.validator.missing_before(step, what) {
                self.report_loss(location, reason);
            }
        }
        if let Err(reason) = self.add_content(message.content) {
            self.step = OpenStep::default();
            self.report_loss(location, reason);
        }
    }

    fn add_content(&mut self, content: Content) -> Result<(), String> {
        match content {
            Content::Event(event, message) => {
                self.validator.add_event(&event, &message)?;
                self.ready.push_back(Item::Event(event));
            }
            Content::Keyframe(part) => match &mut self.step.keyframe {
                Some(keyframe) => keyframe.append(part)?,
                None => self.step.keyframe = Some(part),
            },
            Content::State(state) => {
                let step = state.step;
                if self.step.state.replace(state).is_some() {
                    return Err(format!("state {step} occurs twice"));
                }
            }
            Content::SceneUpdate(message) => {
                if self.step.scene_update.replace(message).is_some() {
                    return Err("a state has two scene updates".into());
                }
            }
        }
        Ok(())
    }

    /// Reports topics that are missing while a channel of another name has their schema. No message follows.
    pub fn report_renamed_topics(&mut self) {
        for (topic, (location, name)) in std::mem::take(&mut self.renamed) {
            if !self.declared.values().any(|declared| *declared == topic) {
                let topic = topic.name();
                let reason = format!("the topic {topic} is missing, but the topic {name:?} has its schema");
                self.report_damage(location, reason);
            }
        }
    }

    fn check_times(&mut self, location: Location, message: &Message, expected: u64) {
        let times = [("log time", message.log_time), ("publish time", message.publish_time)];
        let Some((name, time)) = times.into_iter().find(|(_, time)| *time != expected) else { return };
        let what = match message.content.step() {
            Some((step, what)) => format!("{what} of step {step}"),
            None => "a scene update".into(),
        };
        self.report_damage(location, format!("{what} has the {name} {time} ns, but {expected} ns is expected"));
    }

    fn add_schema(&mut self, body: &[u8]) -> Result<(), String> {
        let mut fields = FieldReader::new(body);
        let mut read = || {
            let (id, name, encoding) = (fields.u16()?, fields.text()?, fields.text()?);
            let length = fields.u32()?;
            Ok((id, name, encoding, fields.bytes(length.into())?))
        };
        let (id, name, encoding, data) = read().map_err(|Malformed| "a schema record is damaged")?;
        // Older formats had other comments in their schemas.
        let is_compared = self.header.versions.format >= FIRST_FORMAT_WITH_COMPARED_SCHEMAS;
        let fits = |topic: &Topic| {
            (topic.schema_name(), topic.schema_encoding()) == (name, encoding)
                && (!is_compared || topic.schema() == data)
        };
        self.schemas.insert(id, Topic::ALL.into_iter().filter(fits).collect());
        Ok(())
    }

    /// Adds a channel. Its messages are read even if its schema is not the one of the format. The channels of the
    /// index, which have no location, are all of rebond.
    fn add_channel(&mut self, location: Option<Location>, body: &[u8]) -> Result<(), String> {
        let mut fields = FieldReader::new(body);
        let damaged = |Malformed| "a channel record is damaged";
        let mut read = || Ok((fields.u16()?, fields.u16()?, fields.text()?, fields.text()?));
        let (id, schema, name, encoding) = read().map_err(damaged)?;
        let topic = Topic::from_name(name);
        if self.declared.get(&id).is_some_and(|declared| Some(*declared) != topic) {
            return Err(format!("the channel {id} is declared again, for another topic"));
        }
        // Its messages can be read even if its metadata cannot.
        self.channels.insert(id, topic);
        fields.map().map_err(damaged)?;
        let Some(topic) = topic else {
            let topics = self.schemas.get(&schema).into_iter().flatten();
            for (topic, location) in topics.filter_map(|topic| Some((topic, location?))) {
                self.renamed.entry(*topic).or_insert_with(|| (location, metadata::shortened(name)));
            }
            return Ok(());
        };
        self.declared.insert(id, topic);
        if topic.message_encoding() != encoding {
            let encoding: String = encoding.chars().take(32).collect();
            return Err(format!("the topic {name} has the unexpected encoding {encoding:?}"));
        }
        if self.schemas.get(&schema).is_some_and(|topics| topics.contains(&topic)) {
            Ok(())
        } else {
            Err(format!("the schema of the topic {name} is not that of the format"))
        }
    }
}

/// The first format version whose schemas are those of this program to the byte.
const FIRST_FORMAT_WITH_COMPARED_SCHEMAS: u32 = 3;

fn check_length(message: &[u8], limit: usize) -> Result<(), String> {
    if message.len() <= limit {
        Ok(())
    } else {
        Err(format!("a message has {} bytes, but at most {limit} are allowed", message.len()))
    }
}

/// The channels of every recording, in case the first chunk, which declares them, is damaged.
fn default_channels() -> BTreeMap<u16, Option<Topic>> {
    (1..).zip(Topic::ALL.map(Some)).collect()
}
