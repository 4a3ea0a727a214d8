use std::io::{self, Read, Seek, SeekFrom};

use mcap::{MAGIC, McapError, records::op};

use super::{
    Error, Header, SceneText,
    metadata::{self, HeaderError, Map},
    record_reader::{Cursor, Malformed, ReadFault, RecordHeader, RecordReader},
    resync::{self, Resync},
};

/// The records before the messages, as far as they can be read.
pub struct HeaderSection {
    /// The settings, and the scene if it is readable.
    pub header: Header,
    /// A record that was already read and belongs to the data after the header section.
    pub pending: Option<RecordHeader>,
    /// The defects found so far.
    pub defects: Vec<Defect>,
    /// The likely cause if the data section does not match its checksum.
    pub crc_suspect: Option<Defect>,
}

/// A damaged record.
#[derive(Clone, Debug)]
pub struct Defect {
    /// The offset of the record, in bytes from the start of the file.
    pub offset: u64,
    /// A description of the damage.
    pub reason: String,
}

/// The state of reading the header section.
#[derive(Default)]
struct SectionReader {
    library: Option<String>,
    settings: Option<Settings>,
    scene: Option<SceneText>,
    pending: Option<RecordHeader>,
    defects: Vec<Defect>,
    is_cut: bool,
}

/// The settings in a metadata record.
struct Settings {
    offset: u64,
    header: Header,
    map: Map,
}

/// Reads all records before the first message.
///
/// A finished recording has the settings at the start and at the end; either copy is enough.
///
/// # Errors
/// Returns an error if there are no readable settings, or if their format is newer than this program.
pub fn read<R: Read + Seek>(records: &mut RecordReader<R>) -> Result<HeaderSection, Error> {
    let mut section = SectionReader::default();
    while !section.is_done() {
        match records.next_record() {
            Ok(Some(record)) => section.add_record(record, records)?,
            Ok(None) => break,
            Err(fault) => section.recover_from(fault, records)?,
        }
    }
    let settings = match section.settings.take() {
        Some(settings) => settings,
        None => section.find_settings(records)?,
    };
    let header = Header { scene: section.scene, ..settings.header };
    section.defects.extend(settings_defect(settings.offset, &settings.map, &header));
    let crc_suspect = (section.library.as_ref() != settings.map.get("library"))
        .then(|| Defect { offset: MAGIC.len() as u64, reason: "the header names another program".into() });
    Ok(HeaderSection { header, pending: section.pending, defects: section.defects, crc_suspect })
}

impl SectionReader {
    fn is_done(&self) -> bool {
        self.settings.is_some() && self.scene.is_some() || self.pending.is_some() || self.is_cut
    }

    fn add_record<R: Read + Seek>(&mut self, record: RecordHeader, records: &mut RecordReader<R>) -> Result<(), Error> {
        let body = &records.body;
        let result = match record.opcode {
            op::HEADER => self.set_library(body),
            op::METADATA => self.set_settings(record.offset, body),
            op::ATTACHMENT => self.set_scene(body),
            op::CHUNK | op::DATA_END => {
                self.pending = Some(record);
                Ok(())
            }
            other => Err(format!("a record with opcode {other:#04x} is not allowed here").into()),
        };
        match result {
            Ok(()) => Ok(()),
            Err(HeaderError::Newer { format }) => Err(Error::NewerFormat { found: format }),
            Err(HeaderError::Damaged(reason)) => {
                self.defects.push(Defect { offset: record.offset, reason });
                records.resume_after(record.offset).map_err(Error::Read)
            }
        }
    }

    fn set_library(&mut self, body: &[u8]) -> Result<(), HeaderError> {
        let (profile, library) = parse_library(body).map_err(|Malformed| "the header is damaged".to_string())?;
        self.library = ["", "ros2"].contains(&profile).then(|| library.into());
        Ok(())
    }

    fn set_settings(&mut self, offset: u64, body: &[u8]) -> Result<(), HeaderError> {
        if let Some(settings) = parse_settings(offset, body)? {
            self.settings = Some(settings);
        }
        Ok(())
    }

    fn set_scene(&mut self, body: &[u8]) -> Result<(), HeaderError> {
        let scene = parse_scene(body).map_err(|Malformed| "the scene attachment is damaged".to_string())?;
        mcap::parse_record(op::ATTACHMENT, body).map_err(|error| error.to_string())?;
        self.scene = Some(scene);
        Ok(())
    }

    fn recover_from<R: Read + Seek>(&mut self, fault: ReadFault, records: &mut RecordReader<R>) -> Result<(), Error> {
        let (offset, resync) = match &fault.error {
            McapError::Io(_) => (fault.offset, Resync::Corrupt),
            McapError::BadMagic if self.defects.is_empty() => (0, Resync::ContinueAt(MAGIC.len() as u64)),
            _ => (fault.offset, resync::resync(records.source(), &fault).map_err(Error::Read)?),
        };
        let defect = match fault.error {
            McapError::Io(error) => return Err(Error::Read(error)),
            error => Defect { offset, reason: error.to_string() },
        };
        match resync {
            Resync::ContinueAt(next) => {
                self.defects.push(defect);
                records.seek(next).map_err(Error::Read)?;
            }
            Resync::Truncated => self.is_cut = true,
            Resync::Corrupt => {
                self.defects.push(defect);
                self.is_cut = true;
            }
        }
        Ok(())
    }

    /// Searches the entire file for a copy of the settings, and returns to the current position.
    fn find_settings<R: Read + Seek>(&mut self, records: &mut RecordReader<R>) -> Result<Settings, Error> {
        let mut from = 0;
        while let Some(offset) = resync::find_metadata(records.source(), from).map_err(Error::Read)? {
            records.seek(offset).map_err(Error::Read)?;
            if let Ok(Some(_)) = records.next_record()
                && let Ok(Some(settings)) = parse_settings(offset, &records.body)
            {
                self.seek_back(records, offset)?;
                return Ok(settings);
            }
            from = offset + 1;
        }
        Err(self.error(starts_with_magic(records.source()).map_err(Error::Read)?))
    }

    /// Returns to the pending record, or to `default`. Reads from the start of the file if no defect
    /// was found so far, so that the checksum of the data section can be verified.
    fn seek_back<R: Read + Seek>(&self, records: &mut RecordReader<R>, default: u64) -> Result<(), Error> {
        let target = self.pending.map_or(default, |record| record.offset);
        if !self.defects.is_empty() {
            return records.seek(target).map_err(Error::Read);
        }
        records.rewind().map_err(Error::Read)?;
        while let Ok(Some(record)) = records.next_record() {
            if record.offset == target {
                return Ok(());
            }
        }
        records.seek(target).map_err(Error::Read)
    }

    fn error(&self, starts_with_magic: bool) -> Error {
        let is_rebond = self.library.as_ref().is_none_or(|library| library.starts_with("rebond/"));
        match self.defects.first() {
            _ if !starts_with_magic => Error::NotARecording { reason: "it does not start like an MCAP file" },
            _ if !is_rebond => Error::NotARecording { reason: "it is an MCAP file written by another program" },
            Some(Defect { offset, reason }) => Error::CorruptHeader { offset: *offset, reason: reason.clone() },
            None if self.is_cut => Error::TruncatedHeader,
            None => Error::NotARecording { reason: "it is an MCAP file without the metadata \"rebond\"" },
        }
    }
}

/// Returns the settings in a metadata record, if it is one of the two that contain them.
fn parse_settings(offset: u64, body: &[u8]) -> Result<Option<Settings>, HeaderError> {
    let (name, map) = metadata::parse(body).map_err(|Malformed| "the metadata is damaged".to_string())?;
    match name {
        metadata::HEADER | metadata::TRAILER => {
            Ok(Some(Settings { offset, header: metadata::parse_header(&map)?, map }))
        }
        _ => Ok(None),
    }
}

/// Returns a defect if the settings of `map` are not those of `header`, or do not describe its scene. The settings in
/// the end record are compared when that is read.
fn settings_defect(offset: u64, map: &Map, header: &Header) -> Option<Defect> {
    if map.contains_key("identity") {
        return None;
    }
    let difference = metadata::difference(map, &metadata::header_map(header), header.scene.as_ref());
    difference.map(|reason| Defect { offset, reason })
}

/// Returns profile and library of a header record.
fn parse_library(body: &[u8]) -> Result<(&str, &str), Malformed> {
    let mut fields = Cursor::new(body);
    let pair = (fields.text()?, fields.text()?);
    fields.finish()?;
    Ok(pair)
}

fn parse_scene(body: &[u8]) -> Result<SceneText, Malformed> {
    let mut fields = Cursor::new(body);
    let _log_time = fields.u64()?;
    let _create_time = fields.u64()?;
    let file_name = fields.text()?.into();
    let _media_type = fields.text()?;
    let length = fields.u64()?;
    let text = str::from_utf8(fields.bytes(length)?).map_err(|_| Malformed)?.into();
    let _checksum = fields.u32()?;
    fields.finish()?;
    Ok(SceneText { file_name, text })
}

/// Returns true if the file starts with the MCAP magic bytes, or with a part of them if it is shorter.
fn starts_with_magic<R: Read + Seek>(source: &mut R) -> io::Result<bool> {
    source.seek(SeekFrom::Start(0))?;
    let mut start = [0; MAGIC.len()];
    let length = resync::read_up_to(source, &mut start)?;
    Ok(MAGIC.starts_with(&start[..length]))
}
