use crate::illustration::{Evidence, Format, SOFTWARE};
use crate::render::compare::{Comparison, compare, side_by_side};
use crate::render::{Exposure, Picture, Projector, RenderError};
use std::fmt::{self, Display, Formatter};

/// How a picture differs from its reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Mismatch {
    /// In words.
    pub what: String,
    /// Expected, difference and actual side by side, of what is made of pixels.
    pub shown: Option<Picture>,
    /// The program that drew the reference, if it was another.
    pub drawn_by: Option<String>,
    /// What both files are.
    pub format: Format,
}

impl Display for Mismatch {
    fn fmt(&self, out: &mut Formatter) -> fmt::Result {
        out.write_str(&self.what)?;
        match &self.drawn_by {
            Some(software) => write!(out, "; it was drawn by {software}, and {SOFTWARE} draws it differently"),
            None => Ok(()),
        }
    }
}

/// How the file of a picture differs from the one that was expected, if what they show does.
///
/// # Errors
/// When the expected file cannot be read.
pub fn mismatch(format: Format, expected: &[u8], actual: &[u8]) -> Result<Option<Mismatch>, RenderError> {
    if expected == actual {
        return Ok(None);
    }
    let found = match (Format::of_content(expected), format) {
        (Some(Format::Png | Format::Gif | Format::Apng), Format::Png | Format::Gif | Format::Apng) => {
            pixels(expected, actual)?
        }
        (_, Format::Png | Format::Gif | Format::Apng) => Some((format!("it is no {}", format.name()), None)),
        (_, Format::Svg | Format::Pdf) => Some((bytes(expected, actual), None)),
    };
    let found = found.or_else(|| sources(expected, actual).map(|what| (what, None)));
    Ok(found.map(|(what, shown)| Mismatch { what, shown, drawn_by: other_software(expected), format }))
}

type Found = (String, Option<Picture>);

/// The first exposure that differs.
fn pixels(expected: &[u8], actual: &[u8]) -> Result<Option<Found>, RenderError> {
    let mut actual = Projector::new(actual)?;
    let mut count = 0_u64;
    let mut first = None;
    for was in Projector::new(expected)? {
        let was = was?;
        count += 1;
        let Some(is) = actual.next().transpose()? else {
            return Ok(Some((format!("{} pictures, expected more", count - 1), None)));
        };
        first = first.or_else(|| exposures(&was, &is).map(|found| (count, found)));
    }
    let more = actual.count() as u64;
    match first {
        Some((1, found)) if count == 1 && more == 0 => Ok(Some(found)),
        Some((place, (what, shown))) => Ok(Some((format!("picture {place} of {count}: {what}"), shown))),
        None if more > 0 => Ok(Some((format!("{} pictures, expected {count}", count + more), None))),
        None => Ok(None),
    }
}

fn exposures(was: &Exposure, is: &Exposure) -> Option<Found> {
    match compare(&was.picture, &is.picture) {
        Comparison::Same if was.is_as_long_as(is) => None,
        Comparison::Same => {
            let [expected, actual] = [was, is].map(|seen| f64::from(seen.parts) / f64::from(seen.per_second));
            Some((format!("it is seen for {actual} s, expected {expected} s"), None))
        }
        comparison => Some((comparison.to_string(), Some(side_by_side(&was.picture, &is.picture)))),
    }
}

fn bytes(expected: &[u8], actual: &[u8]) -> String {
    let [was, is] = [expected, actual].map(String::from_utf8_lossy);
    let place = was.lines().zip(is.lines()).position(|(was, is)| was != is);
    let place = place.unwrap_or_else(|| was.lines().count().min(is.lines().count()));
    let [was, is] = [&was, &is].map(|text| text.lines().nth(place).unwrap_or_default().trim());
    let alike = was.chars().zip(is.chars()).take_while(|(was, is)| was == is).count();
    let [was, is] = [was, is].map(|line| excerpt(line, alike));
    format!("line {} is {is:?}, expected {was:?}", place + 1)
}

/// What of a line is around a place in it.
fn excerpt(line: &str, place: usize) -> String {
    let (before, length) = (place.saturating_sub(20), 60);
    let part: String = line.chars().skip(before).take(length).collect();
    let [begin, end] = [before > 0, line.chars().count() > before + length].map(|cut| if cut { "…" } else { "" });
    format!("{begin}{part}{end}")
}

/// What the files say of themselves, where the expected one says anything.
fn sources(expected: &[u8], actual: &[u8]) -> Option<String> {
    let [was, is] = [expected, actual].map(|file| Evidence::read(file).ok().map(|(_, evidence)| evidence));
    let (was, is) = (was?, is?);
    let entries = was.metadata().entries.into_iter().zip(is.metadata().entries);
    let mut differing = entries.filter(|(was, is)| was != is && was.0 != "Software");
    differing.next().map(|((key, was), (_, is))| {
        format!("all pixels are the same, but its {} is {is}, expected {was}", key.trim_start_matches("rebond "))
    })
}

fn other_software(expected: &[u8]) -> Option<String> {
    let (_, evidence) = Evidence::read(expected).ok()?;
    (evidence.software != SOFTWARE).then_some(evidence.software)
}
