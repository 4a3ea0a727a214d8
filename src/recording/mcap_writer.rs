use std::io::{self, Write};

use mcap::{Attachment, McapError, records::MessageHeader, write::NoSeek};

use super::{
    Error, SceneImage, SceneText, limits,
    metadata::{self, LIBRARY, Map},
    shared_output::SharedOutput,
    topic::Topic,
    writer::failed_earlier,
};

/// Writes the MCAP file of a recording from front to back.
///
/// The bytes depend only on the calls, not on the machine or the clock. The library field names rebond,
/// not the MCAP library.
pub struct McapWriter<W: Write> {
    /// `None` after [`McapWriter::finish`].
    mcap: Option<mcap::Writer<NoSeek<SharedOutput<W>>>>,
    output: SharedOutput<W>,
    channels: [Option<Channel>; Topic::ALL.len()],
}

/// The MCAP profile of a recording, by which ROS 2 tools decide if they read it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Profile {
    /// All topics are those of ROS 2. Its tools refuse files without this profile.
    Ros2,
    /// There are also scene updates, whose encoding the profile `ros2` does not allow.
    SceneUpdates,
}

#[derive(Clone, Copy)]
struct Channel {
    id: u16,
    sequence: u32,
}

impl Profile {
    /// The name in the MCAP header.
    const fn name(self) -> &'static str {
        match self {
            Profile::Ros2 => "ros2",
            Profile::SceneUpdates => "",
        }
    }
}

impl<W: Write> McapWriter<W> {
    /// Writes everything before the messages: metadata, the scene and its images as far as there are any, and channels.
    pub fn new(
        output: W,
        profile: Profile,
        header: Map,
        scene: Option<&SceneText>,
        images: &[SceneImage],
    ) -> Result<McapWriter<W>, Error> {
        let output = SharedOutput::new(output);
        let mut mcap = mcap::WriteOptions::new()
            .library(LIBRARY)
            .profile(profile.name())
            .compression(Some(mcap::Compression::Zstd))
            .compression_threads(0)
            .chunk_size(Some(limits::CHUNK_BYTES as u64))
            .disable_seeking(true)
            .create(NoSeek::new(output.clone()))
            .map_err(write_error)?;
        put_metadata(&mut mcap, metadata::HEADER, header)?;
        if let Some(scene) = scene {
            mcap.attach(&attachment(&scene.file_name, SCENE_MEDIA_TYPE, scene.text.as_bytes())).map_err(write_error)?;
        }
        for SceneImage { name, png, .. } in images {
            if let Some(png) = png {
                mcap.attach(&attachment(name, IMAGE_MEDIA_TYPE, png)).map_err(write_error)?;
            }
        }
        let mut writer = McapWriter { mcap: Some(mcap), output, channels: [None; Topic::ALL.len()] };
        for topic in Topic::ALL.into_iter().filter(|topic| topic.is_mandatory()) {
            writer.channels[topic as usize] = Some(writer.add_channel(topic)?);
        }
        writer.output.begin_chunks();
        Ok(writer)
    }

    /// Writes one message. `log_time` is in simulated nanoseconds.
    pub fn write_message(&mut self, topic: Topic, log_time: u64, bytes: &[u8]) -> Result<(), Error> {
        let Channel { id, sequence } = match self.channels[topic as usize] {
            Some(channel) => channel,
            None => self.add_channel(topic)?,
        };
        self.channels[topic as usize] = Some(Channel { id, sequence: sequence.wrapping_add(1) });
        let header = MessageHeader { channel_id: id, sequence, log_time, publish_time: log_time };
        self.mcap()?.write_to_known_channel(&header, bytes).map_err(write_error)
    }

    fn mcap(&mut self) -> Result<&mut mcap::Writer<NoSeek<SharedOutput<W>>>, Error> {
        self.mcap.as_mut().ok_or_else(failed_earlier)
    }

    fn add_channel(&mut self, topic: Topic) -> Result<Channel, Error> {
        let mcap = self.mcap()?;
        let schema = mcap.add_schema(topic.schema_name(), topic.schema_encoding(), &topic.schema());
        let id = schema.and_then(|schema| {
            mcap.add_channel(schema, topic.name(), topic.message_encoding(), &topic.channel_metadata())
        });
        Ok(Channel { id: id.map_err(write_error)?, sequence: 0 })
    }

    /// Ends the chunk and flushes the output: the file is readable up to here. Nothing is flushed before the first
    /// call.
    pub fn flush(&mut self) -> Result<(), Error> {
        self.mcap()?.flush().map_err(write_error)
    }

    /// Flushes the output except for the open chunk.
    pub fn flush_output(&mut self) -> Result<(), Error> {
        self.output.flush().map_err(Error::Write)
    }

    /// Returns true if a chunk was ended at its full size and is not flushed.
    pub fn has_ended_chunk(&self) -> bool {
        self.output.has_ended_chunk()
    }

    /// Writes everything after the messages, including the summary, and returns the output.
    pub fn finish(mut self, trailer: Map) -> Result<W, Error> {
        let mcap = self.mcap()?;
        put_metadata(mcap, metadata::TRAILER, trailer)?;
        mcap.finish().map_err(write_error)?;
        // All other clones of the output end with the writers that own them.
        let output = self.mcap.take().ok_or_else(failed_earlier)?.into_inner().into_inner();
        drop(self);
        output.into_file()
    }
}

impl<W: Write> Drop for McapWriter<W> {
    /// Leaves the file unfinished, without the summary and the flush by which [`mcap::Writer`] ends when it is dropped:
    /// a recording without its end is truncated.
    fn drop(&mut self) {
        if let Some(mcap) = self.mcap.take() {
            mcap.into_inner();
        }
    }
}

fn put_metadata<W: Write + io::Seek>(mcap: &mut mcap::Writer<W>, name: &str, metadata: Map) -> Result<(), Error> {
    mcap.write_metadata(&mcap::write::Metadata { name: name.into(), metadata }).map_err(write_error)
}

/// The media type of the attachment with the scene.
pub const SCENE_MEDIA_TYPE: &str = "application/toml";

/// The media type of the attachments with the images of the scene.
pub const IMAGE_MEDIA_TYPE: &str = "image/png";

fn attachment<'a>(name: &str, media_type: &str, data: &'a [u8]) -> Attachment<'a> {
    Attachment { log_time: 0, create_time: 0, name: name.into(), media_type: media_type.into(), data: data.into() }
}

fn write_error(error: McapError) -> Error {
    Error::Write(match error {
        McapError::Io(error) => error,
        other => io::Error::other(other),
    })
}
