//! `export -o FILE.mcap`: one topic per body, for programs that plot MCAP files.

use crate::physics::BodyId;
use crate::recording::{BODY_STATE, Header, SampledBody, SampledState};
use mcap::records::MessageHeader;
use mcap::write::NoSeek;
use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};

/// An MCAP file with one topic per body, for example `/body/c`. A path such as `/body/c.x` refers to the same body
/// throughout the run, whichever others are spawned or deleted.
pub struct BodyTopics<'a> {
    mcap: mcap::Writer<NoSeek<&'a mut dyn Write>>,
    schema: u16,
    channels: BTreeMap<BodyId, Channel>,
    names: BTreeSet<String>,
}

struct Channel {
    id: u16,
    sequence: u32,
}

const SCHEMA: &str = "\
float64 x   # upper-left corner, to the right, m
float64 y   # upper-left corner, down, m
float64 vx  # velocity, m/s
float64 vy  # velocity, m/s
";

impl<'a> BodyTopics<'a> {
    /// Begins a file.
    pub fn new(output: &'a mut dyn Write) -> io::Result<BodyTopics<'a>> {
        let mut mcap = mcap::WriteOptions::new()
            .library(concat!("rebond/", env!("CARGO_PKG_VERSION")))
            .profile("ros2")
            .compression(Some(mcap::Compression::Zstd))
            .compression_threads(0)
            .disable_seeking(true)
            .create(NoSeek::new(output))
            .map_err(write_error)?;
        let schema = mcap.add_schema(BODY_STATE, "ros2msg", SCHEMA.as_bytes()).map_err(write_error)?;
        Ok(BodyTopics { mcap, schema, channels: BTreeMap::new(), names: BTreeSet::new() })
    }

    /// Writes one message per body. There may be at most 65535 bodies in all.
    pub fn write(&mut self, state: &SampledState, header: &Header) -> io::Result<()> {
        let time = header.log_time(state.step);
        for body in &state.bodies {
            let SampledBody { info, position, velocity, .. } = body;
            if !self.channels.contains_key(&info.id) {
                let channel = self.add_channel(info.id, &info.spawn.name)?;
                self.channels.insert(info.id, channel);
            }
            let Some(channel) = self.channels.get_mut(&info.id) else { continue };
            // CDR, little-endian: a header of four bytes, then the numbers.
            let mut message = vec![0, 1, 0, 0];
            message.extend([position.x, position.y, velocity.x, velocity.y].into_iter().flat_map(f64::to_le_bytes));
            let header = MessageHeader {
                channel_id: channel.id,
                sequence: channel.sequence,
                log_time: time,
                publish_time: time,
            };
            channel.sequence = channel.sequence.wrapping_add(1);
            self.mcap.write_to_known_channel(&header, &message).map_err(write_error)?;
        }
        Ok(())
    }

    /// Ends the file.
    pub fn finish(mut self) -> io::Result<()> {
        self.mcap.finish().map(drop).map_err(write_error)
    }

    /// Adds the topic of a body. Other characters of its name than letters and digits become `_`, as names of topics
    /// have no others. If another body has this topic, the id is appended.
    fn add_channel(&mut self, id: BodyId, name: &str) -> io::Result<Channel> {
        let plain: String =
            name.chars().map(|letter| if letter.is_ascii_alphanumeric() { letter } else { '_' }).collect();
        let start = if plain.starts_with(|first: char| first.is_ascii_digit()) { "_" } else { "" };
        let mut topic = format!("/body/{start}{plain}");
        while !self.names.insert(topic.clone()) {
            topic = format!("{topic}_id{id}");
        }
        let metadata = BTreeMap::from([
            ("name".to_owned(), name.to_owned()),
            ("id".to_owned(), id.to_string()),
            ("offered_qos_profiles".to_owned(), "[]".to_owned()),
        ]);
        let channel = self.mcap.add_channel(self.schema, &topic, "cdr", &metadata).map_err(write_error)?;
        Ok(Channel { id: channel, sequence: 0 })
    }
}

fn write_error(error: mcap::McapError) -> io::Error {
    match error {
        mcap::McapError::Io(error) => error,
        other => io::Error::other(other),
    }
}
