use std::io::{self, Read, Seek, SeekFrom};

use mcap::{MAGIC, McapError, records::op};

use super::{
    Error, Header, SceneImage, SceneText, limits,
    mcap_writer::{IMAGE_MEDIA_TYPE, SCENE_MEDIA_TYPE},
    metadata::{self, HeaderError, Map},
    record_reader::{FieldReader, Malformed, ReadFault, RecordHeader, RecordReader, SuspectLength, is_private},
    resync::{self, Resync},
    tally,
};

/// The records before the messages, as far as they can be read.
pub struct HeaderSection {
    /// The settings, and the scene if it is readable.
    pub header: Header,
    /// The offset of the metadata record with the settings.
    pub settings_offset: u64,
    /// The offset and the body of each end record before the messages.
    pub trailers: Vec<(u64, Vec<u8>)>,
    /// The attachments with the scene and its images.
    pub attachments: Attachments,
    /// Opcode and index entry of the metadata and attachments before the messages.
    pub indexed: Vec<(u8, Vec<u8>)>,
    /// A record that was already read and belongs to the data after the header section.
    pub pending: Option<RecordHeader>,
    /// The last record, if its length may be damaged.
    pub suspect: SuspectLength,
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
    trailers: Vec<(u64, Vec<u8>)>,
    /// The attachment that is the scene as far as is known: the first one with TOML, or one that the settings describe.
    scene: Option<(u64, SceneText)>,
    /// The offsets of all attachments with TOML.
    toml_offsets: Vec<u64>,
    /// The first attachment with TOML that cannot be the scene. It is a defect if no other one is the scene.
    unusable_scene: Option<Defect>,
    /// Offset, name and content of each attached image.
    images: Vec<(u64, String, Vec<u8>)>,
    indexed: Vec<(u8, Vec<u8>)>,
    pending: Option<RecordHeader>,
    defects: Vec<Defect>,
    is_cut: bool,
    suspect: SuspectLength,
}

/// The settings in a metadata record.
struct Settings {
    offset: u64,
    /// The name of the record.
    name: &'static str,
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
    if section.toml_offsets.len() > 1 && !section.is_cut {
        section.choose_scene(&settings, records)?;
    }
    if !(section.has_scene(&settings) && section.has_images(&settings.header) || section.is_cut) {
        section.find_attachments(&settings, records)?;
    }
    let unusable_scene = section.unusable_scene.take().filter(|_| section.scene.is_none());
    section.defects.extend(unusable_scene);
    let (scene_offset, scene) = section.scene.take().unzip();
    let (images, image_offsets) = section.take_images(&settings.header);
    let attachments = Attachments { scene: scene_offset, images: image_offsets };
    let header = Header { scene, images, ..settings.header.clone() };
    section.defects.extend(settings_defect(&settings, &header, section.defects.is_empty() && !section.is_cut));
    let crc_suspect = (section.library.as_ref() != settings.map.get("library"))
        .then(|| Defect { offset: MAGIC.len() as u64, reason: "the header names another program".into() });
    Ok(HeaderSection {
        header,
        settings_offset: settings.offset,
        trailers: section.trailers,
        attachments,
        indexed: section.indexed,
        pending: section.pending,
        suspect: section.suspect,
        defects: section.defects,
        crc_suspect,
    })
}

impl SectionReader {
    fn is_done(&self) -> bool {
        let has_all = |settings: &Settings| {
            self.has_scene(settings) && self.toml_offsets.len() < 2 && self.has_images(&settings.header)
        };
        self.settings.as_ref().is_some_and(has_all) || self.pending.is_some() || self.is_cut
    }

    /// Returns true if the scene was found that the settings describe.
    fn has_scene(&self, settings: &Settings) -> bool {
        self.scene.as_ref().is_some_and(|(_, scene)| metadata::may_describe(&settings.map, scene))
    }

    /// Chooses the scene among several attachments with TOML: the first one that the settings describe, or else the
    /// first one. A second one that can be the scene, too, is a defect, those of other programs are not.
    fn choose_scene<R: Read + Seek>(
        &mut self,
        settings: &Settings,
        records: &mut RecordReader<R>,
    ) -> Result<(), Error> {
        let (offsets, mut described) = (std::mem::take(&mut self.toml_offsets), Vec::new());
        for offset in &offsets {
            let read = resync::read_attachment(records.source(), *offset).map_err(Error::Read)?;
            if let Some(Ok(Attached::Scene(Ok(scene)))) = read.map(|(_, body, _)| parse_attachment(&body))
                && metadata::may_describe(&settings.map, &scene)
            {
                described.push(*offset);
                if !self.has_scene(settings) {
                    self.scene = Some((*offset, scene));
                }
            }
        }
        let second = if described.is_empty() { offsets.get(1) } else { described.get(1) };
        self.defects.extend(second.map(|offset| Defect { offset: *offset, reason: SECOND_SCENE.into() }));
        self.seek_back(records, MAGIC.len() as u64)
    }

    /// Returns true if every image that the settings declare was found.
    fn has_images(&self, header: &Header) -> bool {
        // Names are only compared once there are enough, since this is asked after each record.
        self.images.len() >= header.images.len()
            && header.images.iter().all(|image| self.images.iter().any(|(_, name, _)| *name == image.name))
    }

    /// The declared images with their content, and the offsets of their attachments. Content that does not match its
    /// digest is a defect.
    fn take_images(&mut self, header: &Header) -> (Vec<SceneImage>, Vec<u64>) {
        let (mut images, mut offsets) = (header.images.clone(), Vec::new());
        for image in &mut images {
            let Some(at) = self.images.iter().position(|(_, name, _)| *name == image.name) else { continue };
            let (offset, _, png) = self.images.swap_remove(at);
            offsets.push(offset);
            let found = SceneImage::new(&image.name, png);
            if (found.bytes, found.digest) == (image.bytes, image.digest) {
                *image = found;
            } else {
                let reason = format!("the image {:?} is not the one that the metadata describe", image.name);
                self.defects.push(Defect { offset, reason });
            }
        }
        (images, offsets)
    }

    fn add_record<R: Read + Seek>(&mut self, record: RecordHeader, records: &mut RecordReader<R>) -> Result<(), Error> {
        let body = &records.body;
        let suspect = self.suspect.follow(record, body);
        if is_private(record.opcode) {
            return Ok(());
        }
        if let op::METADATA | op::ATTACHMENT = record.opcode {
            self.indexed.push((record.opcode, tally::entry(record.opcode, record.offset, body)));
        }
        let result = match record.opcode {
            op::HEADER => self.set_library(body),
            op::METADATA => self.set_settings(record.offset, body),
            op::ATTACHMENT => self.add_attachment(record.offset, body),
            op::SCHEMA | op::CHANNEL | op::MESSAGE | op::CHUNK | op::DATA_END => {
                self.pending = Some(record);
                Ok(())
            }
            other => Err(format!("a record with opcode {other:#04x} is not allowed here").into()),
        };
        match result {
            Ok(()) => Ok(()),
            Err(HeaderError::Newer { format }) => Err(Error::NewerFormat { found: format }),
            Err(HeaderError::Damaged(reason)) => {
                let offset = suspect.unwrap_or(record.offset);
                self.defects.push(Defect { offset, reason });
                self.is_cut |= !records.resume_after(offset).map_err(Error::Read)?;
                Ok(())
            }
        }
    }

    fn set_library(&mut self, body: &[u8]) -> Result<(), HeaderError> {
        let library = parse_library(body).map_err(|Malformed| "the header is damaged".to_string())?;
        self.library = Some(library.into());
        Ok(())
    }

    fn set_settings(&mut self, offset: u64, body: &[u8]) -> Result<(), HeaderError> {
        match (parse_settings(offset, body)?, &self.settings) {
            // A third one changes nothing: the second is reported.
            (Some(Settings { name: metadata::TRAILER, .. }), _) if self.trailers.len() < 2 => {
                self.trailers.push((offset, body.into()));
            }
            (Some(Settings { name: metadata::TRAILER, .. }), _) => {}
            (Some(_), Some(_)) => return Err(format!("a second metadata record {:?}", metadata::HEADER).into()),
            (Some(settings), None) => self.settings = Some(settings),
            (None, _) => {}
        }
        Ok(())
    }

    fn add_attachment(&mut self, offset: u64, body: &[u8]) -> Result<(), HeaderError> {
        match parse_attachment(body)? {
            Attached::Scene(scene) => {
                self.toml_offsets.push(offset);
                match scene {
                    Ok(scene) => self.scene = self.scene.take().or(Some((offset, scene))),
                    Err(reason) => self.unusable_scene = self.unusable_scene.take().or(Some(Defect { offset, reason })),
                }
            }
            Attached::Image(name, png) => self.add_image(offset, name, png),
            Attached::Other => {}
        }
        Ok(())
    }

    /// Keeps an image, unless there are more than any scene has.
    fn add_image(&mut self, offset: u64, name: String, png: Vec<u8>) {
        let bytes: usize = self.images.iter().map(|(_, _, png)| png.len()).sum();
        let is_new = !self.images.iter().any(|(_, known, _)| *known == name);
        if is_new && self.images.len() < limits::IMAGES && bytes + png.len() <= limits::IMAGES_BYTES {
            self.images.push((offset, name, png));
        }
    }

    fn recover_from<R: Read + Seek>(&mut self, fault: ReadFault, records: &mut RecordReader<R>) -> Result<(), Error> {
        let fault = self.suspect.locate(fault)?;
        let (offset, resync) = match fault.error {
            McapError::BadMagic if self.defects.is_empty() => (0, Resync::ContinueAt(MAGIC.len() as u64)),
            _ => (fault.offset, resync::resync(records, &fault).map_err(Error::Read)?),
        };
        let defect = Defect { offset, reason: fault.error.to_string() };
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

    /// Searches the data section for the scene and its images, which other programs may write after the messages, and
    /// returns to the current position. A damaged one is reported when it is reached.
    fn find_attachments<R: Read + Seek>(
        &mut self,
        settings: &Settings,
        records: &mut RecordReader<R>,
    ) -> Result<(), Error> {
        let mut offset = self.pending.map_or(MAGIC.len() as u64, |record| record.offset);
        while let Some((opcode, body, next)) = resync::read_attachment(records.source(), offset).map_err(Error::Read)? {
            match (opcode, parse_attachment(&body)) {
                (op::ATTACHMENT, Ok(Attached::Scene(Ok(scene))))
                    if self.scene.is_none()
                        || !self.has_scene(settings) && metadata::may_describe(&settings.map, &scene) =>
                {
                    self.scene = Some((offset, scene))
                }
                (op::ATTACHMENT, Ok(Attached::Image(name, png))) => self.add_image(offset, name, png),
                _ => {}
            }
            if self.has_scene(settings) && self.has_images(&settings.header) {
                break;
            }
            offset = next;
        }
        self.seek_back(records, MAGIC.len() as u64)
    }

    /// Searches the entire file for the settings, which other programs may write after the messages, or else for the
    /// copy in an end record, and returns to the current position.
    fn find_settings<R: Read + Seek>(&mut self, records: &mut RecordReader<R>) -> Result<Settings, Error> {
        let (mut from, mut found) = (0, None);
        while let Some(offset) = resync::find_metadata(records.source(), from).map_err(Error::Read)? {
            records.seek(offset).map_err(Error::Read)?;
            let is_record = matches!(records.next_record(), Ok(Some(_)));
            match parse_settings(offset, &records.body) {
                Ok(Some(settings)) if is_record && settings.name == metadata::HEADER => {
                    found = Some(settings);
                    break;
                }
                Ok(Some(copy)) if is_record => found = found.or(Some(copy)),
                Ok(_) | Err(_) => {}
            }
            from = offset + 1;
        }
        if let Some(settings) = found {
            self.seek_back(records, settings.offset)?;
            return Ok(settings);
        }
        if !starts_with_magic(records.source()).map_err(Error::Read)? {
            return Err(Error::NotARecording { reason: "it does not start like an MCAP file" });
        }
        Err(self.error())
    }

    /// Returns to the pending record, or to `default`. Reads from the start of the file if no defect
    /// was found so far, so that the checksum of the data section can be verified.
    fn seek_back<R: Read + Seek>(&self, records: &mut RecordReader<R>, default: u64) -> Result<(), Error> {
        let target = self.pending.map_or(default, |record| record.offset);
        if self.defects.is_empty() {
            records.rewind().map_err(Error::Read)?;
            while let Ok(Some(record)) = records.next_record() {
                if record.offset == target {
                    return Ok(());
                }
            }
        }
        records.seek(target).map_err(Error::Read)?;
        if self.pending.is_some() {
            // Reads its fields again. A fault is found when they are decoded.
            let _ = records.next_record();
        }
        Ok(())
    }

    /// Returns the reason why an MCAP file without settings is not a recording.
    fn error(&self) -> Error {
        let is_rebond = self.library.as_ref().is_none_or(|library| library.starts_with("rebond/"));
        match self.defects.first() {
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
    let Some(name) = [metadata::HEADER, metadata::TRAILER].into_iter().find(|known| *known == name) else {
        return Ok(None);
    };
    Ok(Some(Settings { offset, name, header: metadata::parse_header(&map)?, map }))
}

/// Returns a defect if the settings are not those of `header`, do not describe its scene, or are only a copy although
/// nothing else before the messages is damaged. A copy is compared when the end record is read.
fn settings_defect(settings: &Settings, header: &Header, is_intact: bool) -> Option<Defect> {
    let Settings { offset, name, map, .. } = settings;
    if *name == metadata::TRAILER {
        let reason = format!("the metadata record {:?} is missing", metadata::HEADER);
        return is_intact.then_some(Defect { offset: MAGIC.len() as u64, reason });
    }
    let reason = metadata::difference(map, &metadata::header_map(header), header.scene.as_ref())?;
    Some(Defect { offset: *offset, reason })
}

/// Returns the library of a header record.
fn parse_library(body: &[u8]) -> Result<&str, Malformed> {
    let mut fields = FieldReader::new(body);
    let _profile = fields.text()?;
    fields.text()
}

/// The attachments of a recording with its scene and images, by their offsets.
pub struct Attachments {
    scene: Option<u64>,
    images: Vec<u64>,
}

impl Attachments {
    /// Checks an attachment after the header section.
    ///
    /// # Errors
    /// Returns a description of the problem if the attachment is damaged, or a second one with the scene or with an
    /// image of it. Other programs may attach other TOML.
    pub fn check(&self, offset: u64, body: &[u8], header: &Header) -> Result<(), String> {
        match parse_attachment(body)? {
            Attached::Scene(_) if self.scene == Some(offset) => Ok(()),
            Attached::Scene(found) => match &header.scene {
                Some(scene) if metadata::describes_scene(header) && found.as_ref() != Ok(scene) => Ok(()),
                Some(_) | None => found.and(Err(SECOND_SCENE.into())),
            },
            Attached::Image(name, _)
                if !self.images.contains(&offset) && header.images.iter().any(|image| image.name == name) =>
            {
                Err(format!("another attachment with the image {name:?}"))
            }
            Attached::Image(..) | Attached::Other => Ok(()),
        }
    }
}

/// The damage of a second attachment that can be the scene.
const SECOND_SCENE: &str = "a second attachment with a scene";

/// The content of an attachment.
enum Attached {
    /// TOML: the scene, or a description of the reason why the attachment can only be one of another program.
    Scene(Result<SceneText, String>),
    /// An image: its name and file.
    Image(String, Vec<u8>),
    /// An attachment of another program.
    Other,
}

/// Returns the scene or the image in an attachment.
///
/// # Errors
/// Returns a description of the problem if the attachment does not match its checksum.
fn parse_attachment(body: &[u8]) -> Result<Attached, String> {
    let mut fields = FieldReader::new(body);
    let mut read = || {
        let times = [fields.u64()?, fields.u64()?];
        let (file_name, media_type) = (fields.text()?, fields.text()?);
        let length = fields.u64()?;
        let text = fields.bytes(length)?;
        let checked = body.len() - fields.remaining();
        let checksum = fields.u32()?;
        Ok((times, file_name, media_type, text, crc32fast::hash(&body[..checked]) == checksum || checksum == 0))
    };
    let (times, file_name, media_type, text, is_intact) =
        read().map_err(|Malformed| "an attachment is damaged".to_string())?;
    if !is_intact {
        return Err("an attachment does not match its checksum".into());
    }
    if media_type == IMAGE_MEDIA_TYPE {
        return Ok(Attached::Image(file_name.into(), text.into()));
    }
    if media_type != SCENE_MEDIA_TYPE {
        return Ok(Attached::Other);
    }
    Ok(Attached::Scene(match str::from_utf8(text) {
        _ if times != [0; 2] => {
            Err(format!("the scene attachment has the times {} ns and {} ns instead of 0", times[0], times[1]))
        }
        Ok(text) => Ok(SceneText { file_name: file_name.into(), text: text.into() }),
        Err(_) => Err("the scene attachment is not UTF-8".into()),
    }))
}

/// Returns true if the file starts with the MCAP magic bytes, or with a part of them if it is shorter.
fn starts_with_magic<R: Read + Seek>(source: &mut R) -> io::Result<bool> {
    source.seek(SeekFrom::Start(0))?;
    let mut start = [0; MAGIC.len()];
    let length = resync::read_up_to(source, &mut start)?;
    Ok(MAGIC.starts_with(&start[..length]))
}
