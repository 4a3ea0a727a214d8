use super::options::Options;
use super::{Encounter, Error, Figure, Format, Request, Source, Subject};
use crate::figure::Axis;
use crate::physics::{Rect, Vector};
use crate::render::{Aim, Metadata};
use crate::scene::{ColorBy, Overlay, Theme};
use std::ops::RangeInclusive;

/// What a picture carries of where it comes from: enough to draw it again.
#[derive(Clone, Debug, PartialEq)]
pub struct Evidence {
    /// The program that drew it.
    pub software: String,
    /// The identity of each recording in it.
    pub recordings: Vec<String>,
    /// States in full are those of every so many steps of the recordings, at most.
    pub recorded_every: u64,
    /// What was drawn of them.
    pub request: Request,
}

/// What this program calls itself in pictures.
pub const SOFTWARE: &str = concat!("rebond ", env!("CARGO_PKG_VERSION"));

const DRAWN_BY: &str = "Software";
const RECORDING: &str = "rebond recording";
const STEPS: &str = "rebond steps";
const OPTIONS: &str = "rebond options";

/// What stands for the identity of a recording that has none yet.
const UNFINISHED: &str = "none, the recording is unfinished";

impl Evidence {
    /// The evidence of a picture of `sources` drawn by this program.
    pub fn new(request: &Request, sources: &[Source]) -> Evidence {
        let identity = |source: &Source| source.survey.identity.clone().unwrap_or_else(|| UNFINISHED.into());
        Evidence {
            software: SOFTWARE.to_owned(),
            recordings: sources.iter().map(identity).collect(),
            recorded_every: sources.iter().map(|source| source.header.every).max().unwrap_or(1),
            request: request.clone(),
        }
    }

    /// As it stands in files: keys and values in one fixed form and order.
    pub fn metadata(&self) -> Metadata {
        let entry = |key: &str, value: String| (key.to_owned(), value);
        Metadata {
            entries: vec![
                entry(DRAWN_BY, self.software.clone()),
                entry(RECORDING, self.recordings.join("; ")),
                entry(STEPS, steps(&self.request.subject)),
                entry(OPTIONS, self.options().to_string()),
            ],
        }
    }

    /// The evidence in a picture's file, and its format.
    ///
    /// # Errors
    /// When the file is no picture of rebond, or damaged.
    pub fn read(file: &[u8]) -> Result<(Format, Evidence), Error> {
        let Some(format) = Format::of_content(file) else {
            return Err(Error::NoEvidence { what: "it is neither PNG, GIF, SVG nor PDF".into() });
        };
        Ok((format, Evidence::parse(&format.metadata(file)?)?))
    }

    /// Reads what [`Evidence::metadata`] writes.
    ///
    /// # Errors
    /// When something is missing or not understood.
    pub fn parse(metadata: &Metadata) -> Result<Evidence, Error> {
        let get = |key: &str| {
            let found = metadata.entries.iter().find(|(known, _)| known == key);
            found.map(|(_, value)| value).ok_or_else(|| Error::NoEvidence { what: format!("it has no {key:?}") })
        };
        let wrong = |what: &str| Error::NoEvidence { what: format!("its {what:?} are not understood") };
        let options = Options::parse(get(OPTIONS)?).ok_or_else(|| wrong(OPTIONS))?;
        let subject = subject(get(STEPS)?, &options).ok_or_else(|| wrong(STEPS))?;
        Ok(Evidence {
            software: get(DRAWN_BY)?.clone(),
            recordings: get(RECORDING)?.split("; ").map(str::to_owned).collect(),
            recorded_every: options.get("recorded_every").map_or(Some(1), |every| every.parse().ok()).unwrap_or(1),
            request: request(subject, &options).ok_or_else(|| wrong(OPTIONS))?,
        })
    }

    /// Every option that shapes the picture.
    fn options(&self) -> Options {
        let request = &self.request;
        let mut options = Options::default();
        match &request.subject {
            Subject::Still { .. } => {}
            Subject::Clip { parts, slow, hold, .. } => pace(&mut options, *parts, *slow, *hold),
            Subject::Figure { figure, .. } => figure_options(&mut options, *figure),
            Subject::Collision(encounters) => encounter_options(&mut options, "collision", encounters),
            Subject::Minkowski(encounters) => encounter_options(&mut options, "minkowski", encounters),
        }
        options.word("size", format_args!("{}x{}", request.size[0], request.size[1]));
        options.word("theme", Theme::name(request.theme));
        let show: Vec<&str> = request.show.iter().map(|overlay| Overlay::name(*overlay)).collect();
        options.word("show", if show.is_empty() { "none".into() } else { show.join(",") });
        options.word("color_by", ColorBy::name(request.color_by));
        aim_options(&mut options, &request.aim);
        if self.recorded_every > 1 {
            options.word("recorded_every", self.recorded_every);
        }
        if !request.titles.is_empty() {
            options.texts("title", &request.titles);
        }
        if !request.caption.is_empty() {
            options.texts("caption", [&request.caption]);
        }
        options
    }
}

fn pace(options: &mut Options, parts: u64, slow: f64, hold: f64) {
    if parts != 1 {
        options.word("parts", parts);
    }
    if slow != 1.0 {
        options.word("slow", slow);
    }
    if hold != 0.0 {
        options.word("hold", hold);
    }
}

fn figure_options(options: &mut Options, figure: Figure) {
    let name = match figure {
        Figure::Strobe => "strobe",
        Figure::Spacetime(_) => "spacetime",
        Figure::Energy => "energy",
        Figure::Filmstrip => "filmstrip",
    };
    options.word("figure", name);
    if let Figure::Spacetime(axis) = figure {
        options.word("axis", if axis == Axis::X { "x" } else { "y" });
    }
}

fn encounter_options(options: &mut Options, name: &str, encounters: &[Encounter]) {
    options.word("figure", name);
    options.texts("pair", encounters.iter().flat_map(|encounter| &encounter.pair));
}

fn aim_options(options: &mut Options, aim: &Aim) {
    match aim {
        Aim::World => {}
        Aim::Window(area) => {
            let Vector { x, y } = area.origin;
            options.word("window", format_args!("{x},{y},{},{}", area.width(), area.height()));
        }
        Aim::Follow { name, size } => {
            options.texts("follow", [name]);
            options.word("window", format_args!("{}x{}", size.x, size.y));
        }
    }
}

/// The steps that are drawn, in canonical form.
fn steps(subject: &Subject) -> String {
    let range = |steps: &RangeInclusive<u64>, every: u64| format!("{} to {} every {every}", steps.start(), steps.end());
    match subject {
        Subject::Still { step, every: 1 } => step.to_string(),
        Subject::Still { step, every } => format!("{step} every {every}"),
        Subject::Clip { steps, every, .. } | Subject::Figure { steps, every, .. } => range(steps, *every),
        Subject::Collision(encounters) | Subject::Minkowski(encounters) => {
            let steps: Vec<String> = encounters.iter().map(|encounter| encounter.step.to_string()).collect();
            steps.join(", ")
        }
    }
}

fn subject(steps: &str, options: &Options) -> Option<Subject> {
    let range = || {
        let (first, rest) = steps.split_once(" to ")?;
        let (last, every) = rest.split_once(" every ")?;
        Some((first.parse().ok()?..=last.parse().ok()?, every.parse().ok()?))
    };
    let figure = match options.get("figure") {
        None if steps.contains(" to ") => {
            let (steps, every) = range()?;
            let number = |key: &str, default: f64| options.get(key).map_or(Some(default), |text| text.parse().ok());
            let parts = options.get("parts").map_or(Some(1), |parts| parts.parse().ok())?;
            return Some(Subject::Clip { steps, every, parts, slow: number("slow", 1.0)?, hold: number("hold", 0.0)? });
        }
        None => {
            let (step, every) = steps.split_once(" every ").unwrap_or((steps, "1"));
            return Some(Subject::Still { step: step.parse().ok()?, every: every.parse().ok()? });
        }
        Some("collision") => return Some(Subject::Collision(encounters(steps, options)?)),
        Some("minkowski") => return Some(Subject::Minkowski(encounters(steps, options)?)),
        Some("strobe") => Figure::Strobe,
        Some("spacetime") => Figure::Spacetime(if options.get("axis")? == "x" { Axis::X } else { Axis::Y }),
        Some("energy") => Figure::Energy,
        Some("filmstrip") => Figure::Filmstrip,
        Some(_) => return None,
    };
    let (steps, every) = range()?;
    Some(Subject::Figure { figure, steps, every })
}

fn encounters(steps: &str, options: &Options) -> Option<Vec<Encounter>> {
    let names = options.get_texts("pair")?;
    let steps: Vec<u64> = steps.split(", ").map(|step| step.parse().ok()).collect::<Option<_>>()?;
    let (pairs, []) = names.as_chunks::<2>() else { return None };
    let encounter = |(&step, pair): (&u64, &[String; 2])| Encounter { step, pair: pair.clone() };
    (steps.len() == pairs.len()).then(|| steps.iter().zip(pairs).map(encounter).collect())
}

fn request(subject: Subject, options: &Options) -> Option<Request> {
    let (width, height) = options.get("size")?.split_once('x')?;
    let show = match options.get("show")? {
        "none" => Vec::new(),
        names => names.split(',').map(Overlay::named).collect::<Option<_>>()?,
    };
    let caption = options.get_texts("caption")?.into_iter().next().unwrap_or_default();
    Some(Request {
        subject,
        size: [width.parse().ok()?, height.parse().ok()?],
        theme: Theme::named(options.get("theme")?)?,
        show,
        color_by: ColorBy::named(options.get("color_by")?)?,
        aim: aim(options)?,
        caption,
        titles: options.get_texts("title")?,
    })
}

fn aim(options: &Options) -> Option<Aim> {
    let numbers =
        |text: &str, mark: char| text.split(mark).map(|number| number.parse().ok()).collect::<Option<Vec<f64>>>();
    match (options.get_texts("follow")?.into_iter().next(), options.get("window")) {
        (None, None) => Some(Aim::World),
        (None, Some(window)) => match numbers(window, ',')?[..] {
            [x, y, width, height] => Some(Aim::Window(Rect::new(Vector::new(x, y), width, height))),
            _ => None,
        },
        (Some(name), Some(window)) => match numbers(window, 'x')?[..] {
            [x, y] => Some(Aim::Follow { name, size: Vector::new(x, y) }),
            _ => None,
        },
        (Some(_), None) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn evidence(subject: Subject, aim: Aim) -> Evidence {
        let request = Request {
            subject,
            size: [640, 360],
            theme: Theme::Dark,
            show: vec![Overlay::Velocity, Overlay::Clock],
            color_by: ColorBy::Speed,
            aim,
            caption: "a \"b\" = c".into(),
            titles: vec!["one".into(), "and two".into()],
        };
        Evidence { software: "rebond 0".into(), recordings: vec!["12".into(), "ab".into()], recorded_every: 5, request }
    }

    #[test]
    fn every_subject_is_read_as_it_was_written() {
        let pair = |a: &str, b: &str| [a.to_owned(), b.to_owned()];
        let encounters =
            vec![Encounter { step: 3, pair: pair("c", "b b") }, Encounter { step: 4, pair: pair("x", "\"") }];
        let figure = |figure| Subject::Figure { figure, steps: 0..=60, every: 3 };
        let subjects = [
            Subject::Still { step: 7, every: 1 },
            Subject::Still { step: 8, every: 4 },
            Subject::Clip { steps: 0..=600, every: 2, parts: 1, slow: 1.0, hold: 0.0 },
            Subject::Clip { steps: 5..=5, every: 1, parts: 5, slow: 0.1, hold: 0.5 },
            figure(Figure::Strobe),
            figure(Figure::Spacetime(Axis::Y)),
            figure(Figure::Energy),
            figure(Figure::Filmstrip),
            Subject::Collision(encounters.clone()),
            Subject::Minkowski(encounters),
        ];
        let aims = [
            Aim::World,
            Aim::Window(Rect::new(Vector::new(-1e6, 0.1), 16.0, 1e-3)),
            Aim::Follow { name: "a b".into(), size: Vector::new(2.5, 1.0) },
        ];
        for subject in &subjects {
            for aim in &aims {
                let evidence = evidence(subject.clone(), aim.clone());
                assert_eq!(Evidence::parse(&evidence.metadata()).unwrap(), evidence);
            }
        }
    }

    #[test]
    fn the_canonical_form() {
        let clip = Subject::Clip { steps: 0..=600, every: 2, parts: 1, slow: 0.5, hold: 0.0 };
        let text = evidence(clip, Aim::World).metadata().to_string();
        let expected = "Software: rebond 0\nrebond recording: 12; ab\nrebond steps: 0 to 600 every 2\nrebond options: \
                        slow=0.5 size=640x360 theme=dark show=velocity,clock color_by=speed recorded_every=5 \
                        title=\"one\",\"and two\" caption=\"a \\\"b\\\" = c\"\n";
        assert_eq!(text, expected);
    }

    #[test]
    fn what_is_missing_is_named() {
        let mut metadata = evidence(Subject::Still { step: 7, every: 1 }, Aim::World).metadata();
        metadata.entries.pop();
        let error = Evidence::parse(&metadata).unwrap_err().to_string();
        assert_eq!(error, "no picture that says what it was drawn from: it has no \"rebond options\"");
    }
}
