use super::ValueChange;
use super::scene_mismatch::joined;
use crate::picture::encode::compare::{Comparison, compare, magnified, side_by_side};
use crate::picture::number::format_significant;
use crate::picture::{AnimationDecoder, DecodedFrame, Picture, RenderError};
use crate::picture::{Format, Provenance, SOFTWARE, StillFormat};
use crate::text::counted;
use std::fmt::{self, Display, Formatter};

/// The difference between a picture and its reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Mismatch {
    /// The options, steps and recordings that have changed, as the provenance of both says.
    pub changes: Vec<ValueChange>,
    /// The difference in words.
    pub description: String,
    /// Pictures that show the difference: expected, difference and actual side by side, and their differing part
    /// magnified.
    pub shown: Vec<ShownPicture>,
    /// The version of rebond that drew the reference, if it was another one.
    pub drawn_by: Option<String>,
    /// The file format.
    pub format: Format,
}

/// A picture that shows a difference.
#[derive(Clone, Debug, PartialEq)]
pub struct ShownPicture {
    /// The caption.
    pub caption: &'static str,
    /// The picture.
    pub picture: Picture,
}

impl ShownPicture {
    /// Shows the difference of two pictures, if there is one.
    pub fn of(expected: &Picture, actual: &Picture) -> Vec<ShownPicture> {
        let comparison = compare(expected, actual);
        if comparison == Comparison::Same {
            return Vec::new();
        }
        let whole =
            ShownPicture { caption: "expected · difference · actual", picture: side_by_side(expected, actual) };
        let close_up = match comparison {
            // If much differs, a part of it shows nothing more.
            Comparison::Pixels(difference) if difference.count < expected.pixels.len() as u64 / 10 => {
                Some(magnified(expected, actual, &difference))
            }
            Comparison::Pixels(_) | Comparison::Same | Comparison::Size { .. } => None,
        };
        let close_up = close_up.map(|picture| ShownPicture { caption: "magnified", picture });
        std::iter::once(whole).chain(close_up).collect()
    }
}

impl Display for Mismatch {
    fn fmt(&self, out: &mut Formatter) -> fmt::Result {
        if !self.changes.is_empty() {
            write!(out, "{}; ", joined(&self.changes))?;
        }
        out.write_str(&self.description)?;
        match &self.drawn_by {
            Some(software) => write!(out, "; it was drawn by {software}, and {SOFTWARE} draws it differently"),
            None => Ok(()),
        }
    }
}

/// Compares the file of a picture with the expected one. `None` if both show the same and have the same provenance.
///
/// # Errors
/// If the expected file cannot be read.
pub fn mismatch(format: Format, expected: &[u8], actual: &[u8]) -> Result<Option<Mismatch>, RenderError> {
    if expected == actual {
        return Ok(None);
    }
    // Version control may store the lines of an SVG file with other ends.
    let lines = |file: &[u8]| String::from_utf8_lossy(file).replace("\r\n", "\n");
    if format == Format::Still(StillFormat::Svg) && lines(expected) == lines(actual) {
        return Ok(None);
    }
    let found = match Format::from_content(expected) {
        _ if format.is_vector() => {
            let has_changes = || !provenance_changes(expected, actual).is_empty();
            match differing_line(expected, actual) {
                Some(description) => Some((description, Vec::new())),
                None if has_changes() => None,
                None => {
                    let description = differing_provenance(expected, actual);
                    Some((description.unwrap_or_else(|| "the bytes differ".into()), Vec::new()))
                }
            }
        }
        Some(found) if !found.is_vector() => differing_frame(expected, actual)?,
        Some(_) | None => Some((format!("the reference is not a valid {} file", format.name()), Vec::new())),
    };
    let changes = provenance_changes(expected, actual);
    let found = found.or_else(|| {
        if changes.is_empty() {
            differing_provenance(expected, actual).map(|description| (description, Vec::new()))
        } else {
            Some(("the drawing is the same".into(), Vec::new()))
        }
    });
    Ok(found.map(|(description, shown)| Mismatch {
        changes,
        description,
        shown,
        drawn_by: other_software(expected),
        format,
    }))
}

/// A description and the pictures to show.
type FrameDifference = (String, Vec<ShownPicture>);

/// Returns the first frame that differs in its pixels or duration, or a difference in the number of frames.
fn differing_frame(expected: &[u8], actual: &[u8]) -> Result<Option<FrameDifference>, RenderError> {
    let mut actual = AnimationDecoder::new(actual)?;
    let mut count = 0_u64;
    let mut first = None;
    for expected_frame in AnimationDecoder::new(expected)? {
        let expected_frame = expected_frame?;
        count += 1;
        let Some(actual_frame) = actual.next().transpose()? else {
            return Ok(Some((format!("{}, expected more", counted(count - 1, "frame")), Vec::new())));
        };
        first = first.or_else(|| compare_frames(&expected_frame, &actual_frame).map(|found| (count, found)));
    }
    let more = actual.count() as u64;
    match first {
        Some((1, found)) if count == 1 && more == 0 => Ok(Some(found)),
        Some((number, (description, shown))) => Ok(Some((format!("frame {number} of {count}: {description}"), shown))),
        None if more > 0 => Ok(Some((format!("{}, expected {count}", counted(count + more, "frame")), Vec::new()))),
        None => Ok(None),
    }
}

fn compare_frames(expected: &DecodedFrame, actual: &DecodedFrame) -> Option<FrameDifference> {
    match compare(&expected.picture, &actual.picture) {
        Comparison::Same if expected.has_same_duration_as(actual) => None,
        Comparison::Same => {
            let [expected, actual] = [expected, actual]
                .map(|frame| format_significant(f64::from(frame.ticks) / f64::from(frame.ticks_per_second), 6));
            Some((format!("shown for {actual} s, expected {expected} s"), Vec::new()))
        }
        comparison => Some((comparison.to_string(), ShownPicture::of(&expected.picture, &actual.picture))),
    }
}

/// Describes the first line that differs, except lines of the provenance.
fn differing_line(expected: &[u8], actual: &[u8]) -> Option<String> {
    let [expected, actual] = [expected, actual].map(String::from_utf8_lossy);
    let differs = |(expected, actual): (&str, &str)| expected != actual && !expected.starts_with("rebond ");
    let [expected_length, actual_length] = [&expected, &actual].map(|text| text.lines().count());
    let first_extra = (expected_length != actual_length).then_some(expected_length.min(actual_length));
    let index = expected.lines().zip(actual.lines()).position(differs).or(first_extra)?;
    let [expected, actual] = [&expected, &actual].map(|text| text.lines().nth(index).unwrap_or_default().trim());
    let common = expected.chars().zip(actual.chars()).take_while(|(expected, actual)| expected == actual).count();
    let [expected, actual] = [expected, actual].map(|line| excerpt(line, common));
    Some(format!("line {} is {actual:?}, expected {expected:?}", index + 1))
}

/// The part of a line around a position.
fn excerpt(line: &str, position: usize) -> String {
    let (start, length) = (position.saturating_sub(20), 60);
    let part: String = line.chars().skip(start).take(length).collect();
    let [begin, end] = [start > 0, line.chars().count() > start + length].map(|cut| if cut { "…" } else { "" });
    format!("{begin}{part}{end}")
}

/// The options, steps and recordings that differ.
fn provenance_changes(expected: &[u8], actual: &[u8]) -> Vec<ValueChange> {
    let provenance = [expected, actual].map(|file| Provenance::read(file).ok());
    let [Some(expected), Some(actual)] = provenance else { return Vec::new() };
    let [expected, actual] = [&expected, &actual].map(Provenance::values);
    let value = |values: &[(String, String)], name: &str| {
        values.iter().find(|(key, _)| key == name).map_or("none".to_owned(), |(_, value)| value.clone())
    };
    let mut names: Vec<&String> = expected.iter().chain(&actual).map(|(name, _)| name).collect();
    let mut seen = std::collections::BTreeSet::new();
    names.retain(|name| seen.insert(*name));
    names.into_iter().filter_map(|name| ValueChange::of(name, value(&expected, name), value(&actual, name))).collect()
}

/// Describes the first difference in provenance, other than the version of rebond.
fn differing_provenance(expected: &[u8], actual: &[u8]) -> Option<String> {
    let [expected, actual] = [expected, actual].map(|file| Provenance::read(file).ok());
    let entries = expected?.metadata().entries.into_iter().zip(actual?.metadata().entries);
    let mut differing = entries.filter(|(expected, actual)| expected != actual && expected.0 != "Software");
    differing.next().map(|((key, expected), (_, actual))| {
        let key = key.trim_start_matches("rebond ");
        format!("the drawing is the same, but its {key} is {actual}, expected {expected}")
    })
}

fn other_software(expected: &[u8]) -> Option<String> {
    let provenance = Provenance::read(expected).ok()?;
    (provenance.software != SOFTWARE).then_some(provenance.software)
}
