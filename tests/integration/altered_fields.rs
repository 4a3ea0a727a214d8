//! Alters each field of each record in turn, with all checksums correct: no field is left that a replay does not compare.

use crate::forge::{self, Item, Layout, each_record, op, verdict};
use crate::rebond::Workplace;
use crate::snapshot;
use rebond::internals::recording::{self, Recording, StateDigest};
use std::collections::BTreeMap;
use std::io::Cursor;
use std::ops::Range;

/// Boxes between walls, with everything that a recording can contain; three seconds.
const WHOLE: &str = r##"
title = "Altered fields"
[world]
size = [8.0, 6.0]
walls = true
gravity = [0.0, 9.81]
[run]
rate = 20
steps = 60
[restitution]
default = 0.9
"steel/wood" = 0.5
[[spawn]]
name = "a"
at = [1.0, 1.0]
size = [1.0, 1.0]
mass = 2.0
velocity = [3.0, -1.0]
color = "#3366cc"
material = "steel"
[[spawn]]
name = "c"
step = 5
at = [5.0, 3.0]
size = [0.5, 1.5]
mass = 1.0
velocity = [0.5, 0.25]
force = [-1.0, 0.5]
color = "#cc6633"
material = "wood"
[[delete]]
name = "a"
step = 50
"##;

/// Two boxes that are pushed together more often per step than is allowed.
const ERROR: &str = r#"
[world]
size = [8.0, 6.0]
[run]
rate = 20
steps = 60
events_per_step = 3
[[spawn]]
name = "a"
at = [1.0, 1.0]
size = [1.0, 1.0]
mass = 100.0
velocity = [1.0, 0.0]
[[spawn]]
name = "b"
at = [3.0, 1.0]
size = [0.1, 1.0]
mass = 0.01
[[spawn]]
name = "wall"
at = [4.0, 1.0]
size = [0.5, 1.0]
mass = inf
"#;

const SPAWN: &str = include_str!("../../src/recording/schemas/Spawn.msg");

/// The topics in CDR, with their channels and schemas.
const TOPICS: [(&str, u16, &str); 3] = [
    ("/events", 1, include_str!("../../src/recording/schemas/Event.msg")),
    ("/states", 2, include_str!("../../src/recording/schemas/State.msg")),
    ("/bodies", 3, include_str!("../../src/recording/schemas/Bodies.msg")),
];

/// The channel of the boxes for viewers, in protobuf.
const SCENE: u16 = 4;

/// Bytes of a message record before its message: channel, sequence number and times.
const RECORD_START: usize = 22;

/// Bytes before the fields of a message in CDR.
const CDR_START: usize = RECORD_START + 4;

/// A field of a record.
struct Field {
    name: String,
    range: Range<usize>,
    is_text: bool,
}

impl Field {
    fn number(name: &str, range: Range<usize>) -> Field {
        Field { name: name.into(), range, is_text: false }
    }

    fn text(name: &str, range: Range<usize>) -> Field {
        Field { name: name.into(), range, is_text: true }
    }

    /// Changes the lowest bit of a number, or the last letter of a text.
    fn alter(&self, body: &mut [u8]) {
        if self.is_text {
            body[self.range.end - 1] = if body[self.range.end - 1] == b'1' { b'2' } else { b'1' }
        } else {
            body[self.range.start] ^= 1
        }
    }
}

/// Reads the fields of a message in CDR by its schema.
struct CdrFields<'a> {
    bytes: &'a [u8],
    position: usize,
    found: Vec<Field>,
}

impl CdrFields<'_> {
    /// Returns the fields of the message in a record. Each element of an array is a field.
    fn of(body: &[u8], schema: &str) -> Vec<Field> {
        let mut fields = CdrFields { bytes: &body[CDR_START..], position: 0, found: Vec::new() };
        fields.read(schema, "");
        assert_eq!(fields.position, fields.bytes.len(), "the schema describes the whole message");
        fields.found
    }

    fn read(&mut self, schema: &str, prefix: &str) {
        let lines = schema.lines().map(|line| line.split('#').next().unwrap().trim());
        for (kind, name) in lines.filter_map(|line| line.split_once(' ')) {
            let name = format!("{prefix}{}", name.trim());
            let (kind, count) = match kind.strip_suffix("[]") {
                Some(kind) => (kind, self.length()),
                None => (kind, 1),
            };
            for _ in 0..count {
                match kind {
                    "Spawn" => self.read(SPAWN, &format!("{name}.")),
                    "string" => {
                        let end = self.length() + self.position;
                        let text = self.position + CDR_START..end - 1 + CDR_START;
                        self.found.extend((!text.is_empty()).then(|| Field::text(&name, text)));
                        self.position = end;
                    }
                    kind => {
                        let size = if kind == "uint32" { 4 } else { 8 };
                        let start = self.position.next_multiple_of(size);
                        self.position = start + size;
                        self.found.push(Field::number(&name, start + CDR_START..start + CDR_START + size));
                    }
                }
            }
        }
    }

    fn length(&mut self) -> usize {
        self.position = self.position.next_multiple_of(4) + 4;
        u32::from_le_bytes(self.bytes[self.position - 4..self.position].try_into().unwrap()) as usize
    }
}

/// Returns the length-prefixed fields of a record, of which those named are texts, from `start` on.
fn prefixed(body: &[u8], mut start: usize, names: &[&str]) -> Vec<Field> {
    let mut fields = Vec::new();
    for name in names {
        let length = u32::from_le_bytes(body[start..start + 4].try_into().unwrap()) as usize;
        fields.push(Field::text(name, start + 4..start + 4 + length));
        start += 4 + length;
    }
    fields
}

/// Returns a name for the kind of a record, and its fields; none for what belongs to the container.
fn fields((opcode, body): &forge::Record) -> Option<(String, Vec<Field>)> {
    let channel = body.first_chunk().map(|bytes| u16::from_le_bytes(*bytes));
    match *opcode {
        op::MESSAGE => {
            let times = [Field::number("log_time", 6..14), Field::number("publish_time", 14..RECORD_START)];
            let topic = TOPICS.iter().find(|(_, id, _)| Some(*id) == channel);
            let fields = topic.map_or(Vec::new(), |(_, _, schema)| CdrFields::of(body, schema));
            Some((topic.map_or("/scene", |topic| topic.0).into(), times.into_iter().chain(fields).collect()))
        }
        op::SCHEMA => {
            let mut fields = prefixed(body, 2, &["name", "encoding", "data"]);
            let name = String::from_utf8_lossy(&body[fields[0].range.clone()]).into_owned();
            fields[2].is_text = name.starts_with("rebond");
            Some((format!("schema {name}"), fields))
        }
        op::CHANNEL => {
            let fields = prefixed(body, 4, &["topic", "message_encoding"]);
            let topic = String::from_utf8_lossy(&body[fields[0].range.clone()]).into_owned();
            let schema = Field::number("schema_id", 2..4);
            Some((format!("channel {topic}"), fields.into_iter().chain([schema]).collect()))
        }
        op::ATTACHMENT => {
            let times = [Field::number("log_time", 0..8), Field::number("create_time", 8..16)];
            let texts = prefixed(body, 16, &["name", "media_type"]);
            let data = texts[1].range.end + 8..body.len() - 4;
            let fields = times.into_iter().chain(texts).chain([Field::text("data", data)]);
            Some(("attachment".into(), fields.collect()))
        }
        _ => None,
    }
}

/// Makes the digest of each state agree with its values.
fn agree(items: &mut [Item]) {
    let file = forge::put_together(items, Layout::Uncompressed);
    let mut digests = BTreeMap::new();
    let Ok(mut recording) = Recording::read(Cursor::new(file.as_slice())) else { return };
    while let Some(Ok(item)) = recording.next() {
        if let (recording::Item::SuspectState(state), Some(table)) = (item, recording.table()) {
            let mut digest = StateDigest::default();
            for (info, listed) in table.join_state(&state) {
                digest.add(info.id, listed.unwrap_or(info.initial_state()));
            }
            digests.insert(state.step, digest.value());
        }
    }
    let [_, (_, states, _), _] = TOPICS;
    each_record(items, |(opcode, body)| {
        const STEP: usize = CDR_START;
        const DIGEST: Range<usize> = STEP + 8..STEP + 16;
        if *opcode == op::MESSAGE && body[..2] == states.to_le_bytes() {
            let step = u64::from_le_bytes(body[STEP..STEP + 8].try_into().unwrap());
            if let Some(digest) = digests.get(&step) {
                body[DIGEST].copy_from_slice(&digest.to_le_bytes());
            }
        }
    });
}

/// The verdicts on altered recordings, by record and field.
#[derive(Default)]
struct Table {
    rows: String,
    /// The alterations that were not noticed, or whose field a damage does not name.
    failures: String,
}

impl Table {
    /// Adds the verdict on a recording in which this field was altered. `word` names the field in messages.
    fn add(&mut self, record: &str, field: &str, word: &str, items: &[Item]) {
        let verdict = verdict(&forge::put_together(items, Layout::Uncompressed));
        let words: Vec<&str> = verdict.split(' ').collect();
        let is_offset = |index: usize| index > 1 && words[index - 2..index] == ["at", "byte"];
        // The offset depends on the length of everything before it.
        let shown = (0..words.len()).map(|index| {
            if is_offset(index) {
                words[index].replace(|letter: char| letter.is_ascii_digit(), "")
            } else {
                words[index].to_owned()
            }
        });
        let verdict = shown.collect::<Vec<String>>().join(" ").replace("at byte ", "at byte …");
        let row = format!("{record} {field}: {verdict}\n");
        // A divergence names the first value that differs, which may be another one that depends on the field.
        let is_named = verdict.starts_with("diverged at step ") || verdict.contains(word);
        let is_same = verdict.starts_with("same") && !word.starts_with("same");
        if is_same || !is_named {
            self.failures += &row;
        }
        self.rows += &row;
    }
}

fn recorded(scene: &str, options: &str) -> Vec<Item> {
    let workplace = Workplace::with_scene(scene);
    workplace.rebond(&format!("record scene.toml -o run.mcap {options}"));
    forge::take_apart(&workplace.read("run.mcap"))
}

/// Alters each field in the record in the middle of those that have it, and in the last.
fn alter_records(parts: &[Item], table: &mut Table) {
    let mut places: BTreeMap<(String, String), Vec<(usize, usize)>> = BTreeMap::new();
    let mut index = 0;
    each_record(&mut parts.to_vec(), |record| {
        let (name, fields) = fields(record).unwrap_or_default();
        for (number, field) in fields.iter().enumerate() {
            places.entry((name.clone(), field.name.clone())).or_default().push((index, number));
        }
        index += 1;
    });
    for ((record, field), places) in places {
        let mut chosen = vec![places[places.len() / 2], places[places.len() - 1]];
        chosen.dedup();
        for (place, (target, number)) in chosen.into_iter().enumerate() {
            let is_first = place == 0;
            let mut altered = parts.to_vec();
            let mut index = 0;
            each_record(&mut altered, |record| {
                if index == target {
                    fields(record).unwrap().1[number].alter(&mut record.1);
                    if record.0 == op::ATTACHMENT {
                        forge::seal_attachment(&mut record.1);
                    }
                }
                index += 1;
            });
            if field != "digest" {
                agree(&mut altered);
            }
            let last = field.rsplit('.').next().unwrap();
            let word = match (record.split(' ').next().unwrap(), last) {
                // In the order of time the message is one of another step.
                ("/events", "log_time") if is_first => "a body is spawned with id",
                ("/scene", "log_time") => "scene update",
                (_, "log_time" | "create_time") => "time",
                (_, "publish_time") => "publish time",
                ("schema", _) | ("channel", "schema_id") => "schema",
                ("channel", "message_encoding") => "unexpected encoding",
                // A topic of another name is not one of a recording: its messages are missing.
                ("channel", "topic") => match record.as_str() {
                    "channel /events" => "the events 0 bodies",
                    "channel /states" => "steps 0 to 60 are missing",
                    "channel /bodies" => "the topic /bodies is missing",
                    _ => "the topic /scene is missing",
                },
                ("attachment", "media_type") => "the text of the scene is missing",
                ("/events", "delete") => "ids",
                // The mass of a wall, of which the lowest bit makes it not a number.
                (_, "mass") if is_first => "has invalid constants",
                // The first thing that depends on these is the box of the body for viewers.
                ("/events", "color") => "another colour of body",
                ("/events", "width") if !is_first => "entities.cubes",
                _ => last,
            };
            table.add(&record, &field, word, &altered);
        }
    }
}

/// Alters each byte of the boxes for viewers of a state.
fn alter_scene_update(parts: &[Item], table: &mut Table) {
    const STEP: usize = 30;
    let with = |offset: usize| {
        let mut altered = parts.to_vec();
        let mut seen = 0;
        let mut length = 0;
        each_record(&mut altered, |(opcode, body)| {
            if *opcode == op::MESSAGE && body[..2] == SCENE.to_le_bytes() {
                if seen == STEP {
                    body[RECORD_START + offset] ^= 1;
                    length = body.len() - RECORD_START;
                }
                seen += 1;
            }
        });
        (altered, length)
    };
    let (_, length) = with(0);
    for offset in (0..length).step_by(3) {
        table.add("/scene", &format!("byte {offset}"), "scene update", &with(offset).0);
    }
}

/// Returns the value with another last digit; of a float, the next float in decimal and bits.
fn altered_value(value: &str) -> String {
    if let Some((_, bits)) = value.split_once(" 0x") {
        let number = f64::from_bits(u64::from_str_radix(bits, 16).unwrap()).next_up();
        return format!("{number:?} 0x{:016x}", number.to_bits());
    }
    let mut letters: Vec<char> = value.chars().collect();
    let place =
        letters.iter().rposition(|letter| letter.is_ascii_alphanumeric()).expect("a value with a letter or digit");
    letters[place] = if letters[place] == '1' { '2' } else { '1' };
    letters.into_iter().collect()
}

/// Replaces a value in the metadata of this name, or in all.
fn with_value(parts: &[Item], record: &str, key: &str, value: &str) -> Vec<Item> {
    let mut altered = parts.to_vec();
    each_record(&mut altered, |(opcode, body)| {
        if *opcode == op::METADATA {
            let (name, mut map) = forge::parse_metadata(body);
            if record == name || record == "metadata" {
                map.insert(key.into(), value.into());
                (*opcode, *body) = forge::metadata(&name, map);
            }
        }
    });
    altered
}

/// Alters each value of the metadata in `rebond`, in `rebond_end`, and in both.
fn alter_metadata(parts: &[Item], table: &mut Table) {
    let mut values: Vec<(String, String, String)> = Vec::new();
    each_record(&mut parts.to_vec(), |(opcode, body)| {
        if *opcode == op::METADATA {
            let (name, map) = forge::parse_metadata(body);
            values.extend(map.into_iter().map(|(key, value)| (name.clone(), key, value)));
        }
    });
    values.retain(|(_, key, _)| !["checksum", "library"].contains(&key.as_str()));
    let records =
        |name: &str| if name == "rebond" { vec!["rebond", "rebond_end", "metadata"] } else { vec!["rebond_end"] };
    let is_of_both = |key: &str| values.iter().any(|(name, found, _)| name == "rebond" && found == key);
    for (name, key, value) in values.iter().filter(|(name, key, _)| name == "rebond" || !is_of_both(key)) {
        for record in records(name) {
            table.add(record, key, "", &with_value(parts, record, key, &altered_value(value)));
        }
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "slow in debug")]
fn each_altered_field_is_found_and_named() {
    let parts = recorded(WHOLE, "--viewer --accuracy --set run.steps=60");
    let mut table = Table::default();
    alter_records(&parts, &mut table);
    alter_scene_update(&parts, &mut table);
    alter_metadata(&parts, &mut table);
    for (key, value) in [
        ("live_events", "yes"),
        ("images", r#"[["car.png",3,"0000000000000007"]]"#),
        ("gaps", "20>40"),
        ("recovered", "yes"),
        ("error", r#"{"kind":"not-finite","step":60,"body":"c"}"#),
    ] {
        for record in ["rebond", "rebond_end", "metadata"] {
            table.add(record, &format!("{key} (added)"), "", &with_value(&parts, record, key, value));
        }
    }
    let failed = recorded(ERROR, "");
    let error = r#"{"kind":"too-many-events","step":1,"limit":3}"#;
    table.add("rebond_end", "error", "error", &with_value(&failed, "rebond_end", "error", error));
    assert!(table.failures.is_empty(), "{}", table.failures);
    snapshot::assert_text("altered-fields", &table.rows);
}
