use super::option_line::OptionLine;
use super::{CollisionSelector, Error, Figure, Format, ResolvedPicture, Source, Subject};
use crate::figure::Axis;
use crate::physics::{Rect, Vector};
use crate::render::{CameraTarget, Metadata};
use crate::scene::{ColorBy, Overlay, Theme};
use std::ops::RangeInclusive;

/// The provenance stored in a picture file: everything needed to draw it again from the recordings.
#[derive(Clone, Debug, PartialEq)]
pub struct Provenance {
    /// Name and version of the program that drew the picture.
    pub software: String,
    /// The identity of each recording shown.
    pub recordings: Vec<String>,
    /// The largest interval, in steps, at which one of the recordings stores full states.
    pub recorded_every: u64,
    /// The picture drawn from the recordings.
    pub picture: ResolvedPicture,
}

/// Name and version of this program as stored in pictures.
pub const SOFTWARE: &str = concat!("rebond ", env!("CARGO_PKG_VERSION"));

const DRAWN_BY: &str = "Software";
const RECORDING: &str = "rebond recording";
const STEPS: &str = "rebond steps";
const OPTIONS: &str = "rebond options";

/// Stored instead of the identity of a recording that has none yet.
const UNFINISHED: &str = "none, the recording is unfinished";

impl Provenance {
    /// The provenance of `picture` of `sources`, drawn by this program.
    pub fn new(picture: &ResolvedPicture, sources: &[Source]) -> Provenance {
        let identity = |source: &Source| source.summary.identity.clone().unwrap_or_else(|| UNFINISHED.into());
        Provenance {
            software: SOFTWARE.to_owned(),
            recordings: sources.iter().map(identity).collect(),
            recorded_every: sources.iter().map(|source| source.header.every).max().unwrap_or(1),
            picture: picture.clone(),
        }
    }

    /// The canonical form stored in files: keys and values in a fixed notation and order.
    pub fn metadata(&self) -> Metadata {
        let entry = |key: &str, value: String| (key.to_owned(), value);
        Metadata {
            entries: vec![
                entry(DRAWN_BY, self.software.clone()),
                entry(RECORDING, self.recordings.join("; ")),
                entry(STEPS, steps(&self.picture.subject)),
                entry(OPTIONS, self.options().to_string()),
            ],
        }
    }

    /// Reads the format and the provenance of a picture file.
    ///
    /// # Errors
    /// If the file is not a picture drawn by rebond, or is damaged.
    pub fn read(file: &[u8]) -> Result<(Format, Provenance), Error> {
        let Some(format) = Format::from_content(file) else {
            return Err(Error::NoProvenance { reason: "it is neither PNG, GIF, SVG nor PDF".into() });
        };
        Ok((format, Provenance::parse(&format.metadata(file)?)?))
    }

    /// Parses metadata written by [`Provenance::metadata`].
    ///
    /// # Errors
    /// If an entry is missing or cannot be parsed.
    pub fn parse(metadata: &Metadata) -> Result<Provenance, Error> {
        let get = |key: &str| {
            let found = metadata.entries.iter().find(|(name, _)| name == key);
            found
                .map(|(_, value)| value)
                .ok_or_else(|| Error::NoProvenance { reason: format!("it has no {key:?} entry") })
        };
        let invalid = |key: &str| Error::NoProvenance { reason: format!("its {key:?} entry cannot be parsed") };
        let options = OptionLine::parse(get(OPTIONS)?).ok_or_else(|| invalid(OPTIONS))?;
        let subject = subject(get(STEPS)?, &options).ok_or_else(|| invalid(STEPS))?;
        Ok(Provenance {
            software: get(DRAWN_BY)?.clone(),
            recordings: get(RECORDING)?.split("; ").map(str::to_owned).collect(),
            recorded_every: options.get("recorded_every").map_or(Some(1), |every| every.parse().ok()).unwrap_or(1),
            picture: picture(subject, &options).ok_or_else(|| invalid(OPTIONS))?,
        })
    }

    /// All options that determine the picture.
    fn options(&self) -> OptionLine {
        let picture = &self.picture;
        let mut options = OptionLine::default();
        match &picture.subject {
            Subject::Still { .. } => {}
            Subject::Animation { frames_per_step, slow, hold, .. } => {
                timing_options(&mut options, *frames_per_step, *slow, *hold);
            }
            Subject::Figure { figure, .. } => figure_options(&mut options, *figure),
            Subject::Collision(selectors) => selector_options(&mut options, "collision", selectors),
            Subject::Minkowski(selectors) => selector_options(&mut options, "minkowski", selectors),
        }
        options.push("size", format_args!("{}x{}", picture.size[0], picture.size[1]));
        options.push("theme", Theme::name(picture.theme));
        let show: Vec<&str> = picture.show.iter().map(|overlay| Overlay::name(*overlay)).collect();
        options.push("show", if show.is_empty() { "none".into() } else { show.join(",") });
        options.push("color_by", ColorBy::name(picture.color_by));
        camera_options(&mut options, &picture.camera_target);
        if self.recorded_every > 1 {
            options.push("recorded_every", self.recorded_every);
        }
        if !picture.titles.is_empty() {
            options.push_strings("title", &picture.titles);
        }
        if !picture.caption.is_empty() {
            options.push_strings("caption", [&picture.caption]);
        }
        options
    }
}

fn timing_options(options: &mut OptionLine, frames_per_step: u64, slow: f64, hold: f64) {
    if frames_per_step != 1 {
        options.push("parts", frames_per_step);
    }
    if slow != 1.0 {
        options.push("slow", slow);
    }
    if hold != 0.0 {
        options.push("hold", hold);
    }
}

fn figure_options(options: &mut OptionLine, figure: Figure) {
    let name = match figure {
        Figure::Strobe => "strobe",
        Figure::Spacetime(_) => "spacetime",
        Figure::Energy => "energy",
        Figure::Filmstrip => "filmstrip",
    };
    options.push("figure", name);
    if let Figure::Spacetime(axis) = figure {
        options.push("axis", if axis == Axis::X { "x" } else { "y" });
    }
}

fn selector_options(options: &mut OptionLine, name: &str, selectors: &[CollisionSelector]) {
    options.push("figure", name);
    options.push_strings("pair", selectors.iter().flat_map(|selector| &selector.pair));
}

fn camera_options(options: &mut OptionLine, camera_target: &CameraTarget) {
    match camera_target {
        CameraTarget::World => {}
        CameraTarget::Window(area) => {
            let Vector { x, y } = area.origin;
            options.push("window", format_args!("{x},{y},{},{}", area.width(), area.height()));
        }
        CameraTarget::Follow { name, size } => {
            options.push_strings("follow", [name]);
            options.push("window", format_args!("{}x{}", size.x, size.y));
        }
    }
}

/// The drawn steps in canonical form.
fn steps(subject: &Subject) -> String {
    let range = |steps: &RangeInclusive<u64>, every: u64| format!("{} to {} every {every}", steps.start(), steps.end());
    match subject {
        Subject::Still { step, every: 1 } => step.to_string(),
        Subject::Still { step, every } => format!("{step} every {every}"),
        Subject::Animation { steps, every, .. } | Subject::Figure { steps, every, .. } => range(steps, *every),
        Subject::Collision(selectors) | Subject::Minkowski(selectors) => {
            let steps: Vec<String> = selectors.iter().map(|selector| selector.step.to_string()).collect();
            steps.join(", ")
        }
    }
}

fn subject(steps: &str, options: &OptionLine) -> Option<Subject> {
    let range = || {
        let (first, rest) = steps.split_once(" to ")?;
        let (last, every) = rest.split_once(" every ")?;
        Some((first.parse().ok()?..=last.parse().ok()?, every.parse().ok()?))
    };
    let figure = match options.get("figure") {
        None if steps.contains(" to ") => {
            let (steps, every) = range()?;
            let number = |key: &str, default: f64| options.get(key).map_or(Some(default), |text| text.parse().ok());
            let frames_per_step = options.get("parts").map_or(Some(1), |count| count.parse().ok())?;
            let (slow, hold) = (number("slow", 1.0)?, number("hold", 0.0)?);
            return Some(Subject::Animation { steps, every, frames_per_step, slow, hold });
        }
        None => {
            let (step, every) = steps.split_once(" every ").unwrap_or((steps, "1"));
            return Some(Subject::Still { step: step.parse().ok()?, every: every.parse().ok()? });
        }
        Some("collision") => return Some(Subject::Collision(selectors(steps, options)?)),
        Some("minkowski") => return Some(Subject::Minkowski(selectors(steps, options)?)),
        Some("strobe") => Figure::Strobe,
        Some("spacetime") => Figure::Spacetime(if options.get("axis")? == "x" { Axis::X } else { Axis::Y }),
        Some("energy") => Figure::Energy,
        Some("filmstrip") => Figure::Filmstrip,
        Some(_) => return None,
    };
    let (steps, every) = range()?;
    Some(Subject::Figure { figure, steps, every })
}

fn selectors(steps: &str, options: &OptionLine) -> Option<Vec<CollisionSelector>> {
    let names = options.get_strings("pair")?;
    let steps: Vec<u64> = steps.split(", ").map(|step| step.parse().ok()).collect::<Option<_>>()?;
    let (pairs, []) = names.as_chunks::<2>() else { return None };
    let selector = |(&step, pair): (&u64, &[String; 2])| CollisionSelector { step, pair: pair.clone() };
    (steps.len() == pairs.len()).then(|| steps.iter().zip(pairs).map(selector).collect())
}

fn picture(subject: Subject, options: &OptionLine) -> Option<ResolvedPicture> {
    let (width, height) = options.get("size")?.split_once('x')?;
    let show = match options.get("show")? {
        "none" => Vec::new(),
        names => names.split(',').map(Overlay::named).collect::<Option<_>>()?,
    };
    let caption = options.get_strings("caption")?.into_iter().next().unwrap_or_default();
    Some(ResolvedPicture {
        subject,
        size: [width.parse().ok()?, height.parse().ok()?],
        theme: Theme::named(options.get("theme")?)?,
        show,
        color_by: ColorBy::named(options.get("color_by")?)?,
        camera_target: camera_target(options)?,
        caption,
        titles: options.get_strings("title")?,
    })
}

fn camera_target(options: &OptionLine) -> Option<CameraTarget> {
    let numbers = |text: &str, separator: char| {
        text.split(separator).map(|number| number.parse().ok()).collect::<Option<Vec<f64>>>()
    };
    match (options.get_strings("follow")?.into_iter().next(), options.get("window")) {
        (None, None) => Some(CameraTarget::World),
        (None, Some(window)) => match numbers(window, ',')?[..] {
            [x, y, width, height] => Some(CameraTarget::Window(Rect::new(Vector::new(x, y), width, height))),
            _ => None,
        },
        (Some(name), Some(window)) => match numbers(window, 'x')?[..] {
            [x, y] => Some(CameraTarget::Follow { name, size: Vector::new(x, y) }),
            _ => None,
        },
        (Some(_), None) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn provenance(subject: Subject, camera_target: CameraTarget) -> Provenance {
        let picture = ResolvedPicture {
            subject,
            size: [640, 360],
            theme: Theme::Dark,
            show: vec![Overlay::Velocity, Overlay::Clock],
            color_by: ColorBy::Speed,
            camera_target,
            caption: "a \"b\" = c".into(),
            titles: vec!["one".into(), "and two".into()],
        };
        Provenance {
            software: "rebond 0".into(),
            recordings: vec!["12".into(), "ab".into()],
            recorded_every: 5,
            picture,
        }
    }

    #[test]
    fn every_subject_round_trips_through_metadata() {
        let pair = |a: &str, b: &str| [a.to_owned(), b.to_owned()];
        let selectors = vec![
            CollisionSelector { step: 3, pair: pair("c", "b b") },
            CollisionSelector { step: 4, pair: pair("x", "\"") },
        ];
        let figure = |figure| Subject::Figure { figure, steps: 0..=60, every: 3 };
        let subjects = [
            Subject::Still { step: 7, every: 1 },
            Subject::Still { step: 8, every: 4 },
            Subject::Animation { steps: 0..=600, every: 2, frames_per_step: 1, slow: 1.0, hold: 0.0 },
            Subject::Animation { steps: 5..=5, every: 1, frames_per_step: 5, slow: 0.1, hold: 0.5 },
            figure(Figure::Strobe),
            figure(Figure::Spacetime(Axis::Y)),
            figure(Figure::Energy),
            figure(Figure::Filmstrip),
            Subject::Collision(selectors.clone()),
            Subject::Minkowski(selectors),
        ];
        let aims = [
            CameraTarget::World,
            CameraTarget::Window(Rect::new(Vector::new(-1e6, 0.1), 16.0, 1e-3)),
            CameraTarget::Follow { name: "a b".into(), size: Vector::new(2.5, 1.0) },
        ];
        for subject in &subjects {
            for camera_target in &aims {
                let provenance = provenance(subject.clone(), camera_target.clone());
                assert_eq!(Provenance::parse(&provenance.metadata()).unwrap(), provenance);
            }
        }
    }

    #[test]
    fn the_canonical_form_is_stable() {
        let clip = Subject::Animation { steps: 0..=600, every: 2, frames_per_step: 1, slow: 0.5, hold: 0.0 };
        let text = provenance(clip, CameraTarget::World).metadata().to_string();
        let expected = "Software: rebond 0\nrebond recording: 12; ab\nrebond steps: 0 to 600 every 2\nrebond options: \
                        slow=0.5 size=640x360 theme=dark show=velocity,clock color_by=speed recorded_every=5 \
                        title=\"one\",\"and two\" caption=\"a \\\"b\\\" = c\"\n";
        assert_eq!(text, expected);
    }

    #[test]
    fn the_error_names_the_missing_entry() {
        let mut metadata = provenance(Subject::Still { step: 7, every: 1 }, CameraTarget::World).metadata();
        metadata.entries.pop();
        let error = Provenance::parse(&metadata).unwrap_err().to_string();
        assert_eq!(error, "the file carries no rebond provenance: it has no \"rebond options\" entry");
    }
}
