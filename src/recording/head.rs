use std::io::{self, Read, Seek, SeekFrom};

use mcap::{MAGIC, McapError, records::op};

use super::{
    Error, Header, SceneText,
    fields::{Fields, Malformed},
    metadata::{self, Refusal},
    records::{Broken, Place, Records},
    resync::{self, Remedy},
};

/// What stands before the messages, as far as it can be read.
pub struct Head {
    /// The settings, and the scene if it could be read.
    pub header: Header,
    /// Whether the scene could be read.
    pub has_scene: bool,
    /// A record that was read already and belongs to what follows.
    pub pending: Option<Place>,
    /// What is not as it was written: offsets and words.
    pub faults: Vec<Fault>,
    /// What is to blame if the data section does not fit its checksum.
    pub suspect: Option<Fault>,
}

/// Something that is not as it was written.
#[derive(Clone, Debug)]
pub struct Fault {
    /// Of the record, bytes from the start of the file.
    pub offset: u64,
    /// In words.
    pub what: String,
}

/// The head while it is being read.
#[derive(Default)]
struct Reading {
    library: Option<String>,
    start: Option<Settings>,
    scene: Option<SceneText>,
    pending: Option<Place>,
    faults: Vec<Fault>,
    cut: bool,
}

/// The settings as a metadata record tells them.
struct Settings {
    header: Header,
    library: Option<String>,
}

/// Reads up to the first message.
///
/// The settings stand at both ends of a finished recording: one of the two is enough.
///
/// # Errors
/// If there are no settings to be read, or they are newer than this program.
pub fn read<R: Read + Seek>(records: &mut Records<R>) -> Result<Head, Error> {
    let mut reading = Reading::default();
    while !reading.is_done() {
        match records.advance() {
            Ok(Some(place)) => reading.record(place, records)?,
            Ok(None) => break,
            Err(broken) => reading.mend(records, broken)?,
        }
    }
    let settings = match reading.start.take() {
        Some(settings) => settings,
        None => reading.settings_elsewhere(records)?,
    };
    let suspect = (reading.library != settings.library)
        .then(|| Fault { offset: MAGIC.len() as u64, what: "the header names another program".into() });
    let has_scene = reading.scene.is_some();
    let header = Header { scene: reading.scene.unwrap_or_default(), ..settings.header };
    Ok(Head { header, has_scene, pending: reading.pending, faults: reading.faults, suspect })
}

impl Reading {
    fn is_done(&self) -> bool {
        self.start.is_some() && self.scene.is_some() || self.pending.is_some() || self.cut
    }

    fn record<R: Read + Seek>(&mut self, place: Place, records: &mut Records<R>) -> Result<(), Error> {
        let body = &records.body;
        let read = match place.opcode {
            op::HEADER => self.library(body),
            op::METADATA => self.metadata(body),
            op::ATTACHMENT => self.scene(body),
            op::CHUNK | op::DATA_END => {
                self.pending = Some(place);
                Ok(())
            }
            other => Err(format!("a record of kind {other:#04x} does not belong here").into()),
        };
        match read {
            Ok(()) => Ok(()),
            Err(Refusal::Newer { format }) => Err(Error::NewerFormat { found: format }),
            Err(Refusal::Damaged(what)) => {
                self.faults.push(Fault { offset: place.offset, what });
                records.resume_after(place.offset).map_err(Error::Read)
            }
        }
    }

    fn library(&mut self, body: &[u8]) -> Result<(), Refusal> {
        let (profile, library) = library(body).map_err(|Malformed| "the header is damaged".to_string())?;
        self.library = profile.is_empty().then(|| library.into());
        Ok(())
    }

    fn metadata(&mut self, body: &[u8]) -> Result<(), Refusal> {
        if let Some(settings) = settings(body)? {
            self.start = Some(settings);
        }
        Ok(())
    }

    fn scene(&mut self, body: &[u8]) -> Result<(), Refusal> {
        let scene = scene(body).map_err(|Malformed| "the scene's text is damaged".to_string())?;
        mcap::parse_record(op::ATTACHMENT, body).map_err(|error| error.to_string())?;
        self.scene = Some(scene);
        Ok(())
    }

    fn mend<R: Read + Seek>(&mut self, records: &mut Records<R>, broken: Broken) -> Result<(), Error> {
        let (offset, remedy) = match &broken.why {
            McapError::Io(_) => (broken.offset, Remedy::None),
            McapError::BadMagic if self.faults.is_empty() => (0, Remedy::GoOn(MAGIC.len() as u64)),
            _ => (broken.offset, resync::remedy(records.read(), &broken).map_err(Error::Read)?),
        };
        let fault = match broken.why {
            McapError::Io(error) => return Err(Error::Read(error)),
            why => Fault { offset, what: why.to_string() },
        };
        match remedy {
            Remedy::GoOn(next) => {
                self.faults.push(fault);
                records.seek(next).map_err(Error::Read)?;
            }
            Remedy::Cut => self.cut = true,
            Remedy::None => {
                self.faults.push(fault);
                self.cut = true;
            }
        }
        Ok(())
    }

    /// Looks for the settings through the whole file and comes back.
    fn settings_elsewhere<R: Read + Seek>(&mut self, records: &mut Records<R>) -> Result<Settings, Error> {
        let mut from = 0;
        while let Some(offset) = resync::next_metadata(records.read(), from).map_err(Error::Read)? {
            records.seek(offset).map_err(Error::Read)?;
            if let Ok(Some(_)) = records.advance()
                && let Ok(Some(settings)) = settings(&records.body)
            {
                self.come_back(records, offset)?;
                return Ok(settings);
            }
            from = offset + 1;
        }
        Err(self.failure(starts_as_mcap(records.read()).map_err(Error::Read)?))
    }

    /// Goes back to the pending record, from the start of the file if the checksum of the
    /// data section is still worth verifying.
    fn come_back<R: Read + Seek>(&self, records: &mut Records<R>, otherwise: u64) -> Result<(), Error> {
        let back = self.pending.map_or(otherwise, |place| place.offset);
        if !self.faults.is_empty() {
            return records.seek(back).map_err(Error::Read);
        }
        records.rewind().map_err(Error::Read)?;
        while let Ok(Some(place)) = records.advance() {
            if place.offset == back {
                return Ok(());
            }
        }
        records.seek(back).map_err(Error::Read)
    }

    fn failure(&self, starts_as_mcap: bool) -> Error {
        let ours = self.library.as_ref().is_none_or(|library| library.starts_with("rebond/"));
        match self.faults.first() {
            _ if !starts_as_mcap => Error::NotARecording { what: "it does not start as an MCAP file" },
            _ if !ours => Error::NotARecording { what: "it is an MCAP file of another program" },
            Some(Fault { offset, what }) => Error::DamagedHead { offset: *offset, what: what.clone() },
            None if self.cut => Error::CutHead,
            None => Error::NotARecording { what: "it is an MCAP file without the metadata \"rebond\"" },
        }
    }
}

/// The settings in a metadata record, if it is one of the two that have them.
fn settings(body: &[u8]) -> Result<Option<Settings>, Refusal> {
    let (name, map) = metadata::parse(body).map_err(|Malformed| "the metadata is damaged".to_string())?;
    match name {
        metadata::START | metadata::END => {
            Ok(Some(Settings { header: metadata::header(&map)?, library: map.get("library").cloned() }))
        }
        _ => Ok(None),
    }
}

/// Profile and library of a header record.
fn library(body: &[u8]) -> Result<(&str, &str), Malformed> {
    let mut fields = Fields::new(body);
    let both = (fields.text()?, fields.text()?);
    fields.end()?;
    Ok(both)
}

fn scene(body: &[u8]) -> Result<SceneText, Malformed> {
    let mut fields = Fields::new(body);
    let _log_time = fields.u64()?;
    let _create_time = fields.u64()?;
    let file_name = fields.text()?.into();
    let _media_type = fields.text()?;
    let length = fields.u64()?;
    let text = str::from_utf8(fields.bytes(length)?).map_err(|_| Malformed)?.into();
    let _checksum = fields.u32()?;
    fields.end()?;
    Ok(SceneText { file_name, text })
}

/// Whether the file starts as MCAP files do, as far as it reaches.
fn starts_as_mcap<R: Read + Seek>(read: &mut R) -> io::Result<bool> {
    read.seek(SeekFrom::Start(0))?;
    let mut start = [0; MAGIC.len()];
    let length = resync::read_up_to(read, &mut start)?;
    Ok(MAGIC.starts_with(&start[..length]))
}
