use std::{
    collections::BTreeMap,
    io::{self, BufWriter, Write},
};

use mcap::{Attachment, McapError, records::MessageHeader, write::NoSeek};

use super::{
    Error, SceneText, limits,
    metadata::{self, LIBRARY, Map},
    topic::{MESSAGE_ENCODING, SCHEMA_ENCODING, Topic},
};

/// The MCAP file around the messages, written from front to back.
///
/// The same calls give the same bytes: nothing of the machine, the clock or the library's
/// version gets into the file.
pub struct Container<W: Write> {
    mcap: mcap::Writer<NoSeek<BufWriter<W>>>,
    channels: [Channel; Topic::ALL.len()],
}

#[derive(Clone, Copy)]
struct Channel {
    id: u16,
    sequence: u32,
}

impl<W: Write> Container<W> {
    /// Writes what stands before the messages.
    pub fn new(write: W, start: Map, scene: &SceneText) -> Result<Container<W>, Error> {
        let mut mcap = mcap::WriteOptions::new()
            .library(LIBRARY)
            .profile("")
            .compression(Some(mcap::Compression::Zstd))
            .compression_threads(0)
            .chunk_size(Some(limits::CHUNK_BYTES as u64))
            .disable_seeking(true)
            .create(NoSeek::new(BufWriter::new(write)))
            .map_err(write_error)?;
        put_metadata(&mut mcap, metadata::START, start)?;
        mcap.attach(&attachment(scene)).map_err(write_error)?;
        mcap.flush().map_err(write_error)?;
        let mut channels = [Channel { id: 0, sequence: 0 }; Topic::ALL.len()];
        for (channel, topic) in channels.iter_mut().zip(Topic::ALL) {
            channel.id = declare(&mut mcap, topic).map_err(write_error)?;
        }
        Ok(Container { mcap, channels })
    }

    /// Writes one message; `log_time` is in simulated nanoseconds.
    pub fn message(&mut self, topic: Topic, log_time: u64, bytes: &[u8]) -> Result<(), Error> {
        let channel = &mut self.channels[topic as usize];
        let header =
            MessageHeader { channel_id: channel.id, sequence: channel.sequence, log_time, publish_time: log_time };
        channel.sequence = channel.sequence.wrapping_add(1);
        self.mcap.write_to_known_channel(&header, bytes).map_err(write_error)
    }

    /// Ends the chunk and hands everything down: up to here the file is readable.
    pub fn flush(&mut self) -> Result<(), Error> {
        self.mcap.flush().map_err(write_error)
    }

    /// Writes what stands after the messages, index included.
    pub fn finish(mut self, end: Map) -> Result<W, Error> {
        put_metadata(&mut self.mcap, metadata::END, end)?;
        self.mcap.finish().map_err(write_error)?;
        let mut buffer = self.mcap.into_inner().into_inner();
        buffer.flush().map_err(Error::Write)?;
        buffer.into_inner().map_err(|error| Error::Write(error.into_error()))
    }
}

fn put_metadata<W: Write + io::Seek>(mcap: &mut mcap::Writer<W>, name: &str, metadata: Map) -> Result<(), Error> {
    mcap.write_metadata(&mcap::write::Metadata { name: name.into(), metadata }).map_err(write_error)
}

fn attachment(scene: &SceneText) -> Attachment<'_> {
    Attachment {
        log_time: 0,
        create_time: 0,
        name: scene.file_name.clone(),
        media_type: "application/toml".into(),
        data: scene.text.as_bytes().into(),
    }
}

fn declare<W: Write + io::Seek>(mcap: &mut mcap::Writer<W>, topic: Topic) -> Result<u16, McapError> {
    let schema = mcap.add_schema(topic.schema_name(), SCHEMA_ENCODING, topic.schema().as_bytes())?;
    mcap.add_channel(schema, topic.name(), MESSAGE_ENCODING, &BTreeMap::new())
}

fn write_error(error: McapError) -> Error {
    Error::Write(match error {
        McapError::Io(error) => error,
        other => io::Error::other(other),
    })
}
