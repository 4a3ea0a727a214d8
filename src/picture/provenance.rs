use super::option_line::OptionLine;
use super::{
    Animation, CameraTarget, CollisionFigure, CollisionSelector, Error, Format, Language, Look, Metadata, Page,
    ReferenceFrame, ResolvedPicture, Source, StatesFigure, StepRange, Subject, Timing, Window,
};
use super::{MAX_FRAMES_PER_STEP, MAX_HOLD, MIN_HOLD, SPEEDS};
use crate::physics::Axis;
use crate::picture_options::{Written, check_extent};
use crate::recording::limits;
use std::ops::RangeInclusive;
use std::str::FromStr;

/// The provenance stored in a picture file: everything needed to draw it again from the recordings.
#[doc(alias("reproducibility", "metadata"))]
#[derive(Clone, Debug, PartialEq)]
pub struct Provenance {
    /// Name and version of the program that drew the picture.
    pub software: String,
    /// The identity of each recording shown.
    pub recordings: Vec<String>,
    /// The interval, in steps, at which each recording stores full states.
    pub recorded_every: Vec<u64>,
    /// The picture drawn from the recordings.
    pub picture: ResolvedPicture,
    /// Title and description for readers and search; `None` in pictures of older versions.
    pub texts: Option<[String; 2]>,
}

/// Name and version of this program as stored in pictures.
pub const SOFTWARE: &str = concat!("rebond ", env!("CARGO_PKG_VERSION"));

const DRAWN_BY: &str = "Software";
const RECORDING: &str = "rebond recording";
const STEPS: &str = "rebond steps";
const OPTIONS: &str = "rebond options";

/// Stored instead of the identity of a recording that has none yet.
const UNFINISHED: &str = "none, the recording is unfinished";

/// The largest length of the name and version of a program, bytes.
const MAX_SOFTWARE: usize = 256;

impl Provenance {
    /// The provenance of `picture` of `sources`, drawn by this program.
    pub fn new(picture: &ResolvedPicture, sources: &[Source]) -> Provenance {
        let identity = |source: &Source| source.statistics.identity.clone().unwrap_or_else(|| UNFINISHED.into());
        Provenance {
            software: SOFTWARE.to_owned(),
            recordings: sources.iter().map(identity).collect(),
            recorded_every: sources.iter().map(|source| source.header.every).collect(),
            picture: picture.clone(),
            texts: Some([title(picture, sources), description(picture)]),
        }
    }

    /// Reads the provenance of a picture file.
    ///
    /// # Errors
    /// Returns [`Error::NoProvenance`] if the file is not a picture drawn by rebond, another error if it is damaged.
    pub fn read(file: &[u8]) -> Result<Provenance, Error> {
        let Some(format) = Format::from_content(file) else {
            return Err(Error::NoProvenance { reason: "it is neither PNG, GIF, SVG nor PDF".into() });
        };
        Provenance::parse(&format.metadata(file)?, format)
    }

    /// The canonical form stored in files: keys and values in a fixed notation and order.
    pub fn metadata(&self) -> Metadata {
        let ResolvedPicture { subject, look, titles } = &self.picture;
        let mut options = OptionLine::default();
        write_subject(subject, &mut options);
        options.extend(look.texts(Written::Always));
        write_camera_target(&look.camera_target, &mut options);
        let mut every: Vec<String> = self.recorded_every.iter().map(u64::to_string).collect();
        // One number if it applies to all, and none if all recordings store all states.
        if every.iter().all(|one| *one == every[0]) {
            every.truncate(1);
        }
        if every.iter().any(|every| every != "1") {
            options.push("recorded_every", every.join(","));
        }
        if !titles.is_empty() {
            options.push_strings("title", titles);
        }
        options.extend(look.texts(Written::IfChanged));
        let entry = |key: &str, value: String| (key.to_owned(), value);
        let mut entries = vec![
            entry(DRAWN_BY, self.software.clone()),
            entry(RECORDING, self.recordings.join("; ")),
            entry(STEPS, steps(subject)),
            entry(OPTIONS, options.to_string()),
        ];
        if let Some([title, description]) = &self.texts {
            entries.push(entry(Metadata::TITLE, title.clone()));
            entries.push(entry(Metadata::DESCRIPTION, description.clone()));
        }
        Metadata { entries }
    }

    /// Names and values of all that determines the picture: recording, steps and options.
    pub fn values(&self) -> Vec<(String, String)> {
        let entries = self.metadata().entries.into_iter();
        let values = entries.filter(|(key, _)| [RECORDING, STEPS, OPTIONS].contains(&key.as_str()));
        values
            .flat_map(|(key, value)| match OptionLine::parse(&value).filter(|_| key == OPTIONS) {
                Some(options) => options.into_pairs(),
                None => vec![(key.trim_start_matches("rebond ").to_owned(), value)],
            })
            .collect()
    }

    /// Parses metadata written by [`Provenance::metadata`] in a file of this format.
    ///
    /// # Errors
    /// If an entry is missing or cannot be parsed.
    pub fn parse(metadata: &Metadata, format: Format) -> Result<Provenance, Error> {
        let get = |key: &str| {
            let found = metadata.entries.iter().find(|(name, _)| name == key);
            found
                .map(|(_, value)| value)
                .ok_or_else(|| Error::DamagedProvenance { reason: format!("it has no {key:?} entry") })
        };
        if !metadata.entries.iter().any(|(key, _)| [RECORDING, STEPS, OPTIONS].contains(&key.as_str())) {
            return Err(Error::NoProvenance { reason: format!("it has no {OPTIONS:?} entry") });
        }
        let invalid = |key: &str| Error::DamagedProvenance { reason: format!("its {key:?} entry cannot be parsed") };
        let options = OptionLine::parse(get(OPTIONS)?).ok_or_else(|| invalid(OPTIONS))?;
        let subject = read_subject(get(STEPS)?, &options, format).ok_or_else(|| invalid(STEPS))?;
        let camera_target = read_camera_target(&options).ok_or_else(|| invalid(OPTIONS))?;
        let look = Look::from_texts(|key| options.get(key), camera_target).ok_or_else(|| invalid(OPTIONS))?;
        let titles = options.get_strings("title").ok_or_else(|| invalid(OPTIONS))?;
        let recordings: Vec<String> = get(RECORDING)?.split("; ").map(str::to_owned).collect();
        let is_identity = |text: &String| {
            text == UNFINISHED || text.len() == 32 && text.bytes().all(|digit| digit.is_ascii_hexdigit())
        };
        if !recordings.iter().all(is_identity) {
            return Err(invalid(RECORDING));
        }
        let every = options.get("recorded_every").unwrap_or("1").split(',').map(read_interval);
        let recorded_every = match every.collect::<Option<Vec<u64>>>().as_deref() {
            Some(&[every]) => vec![every; recordings.len()],
            Some(every) if every.len() == recordings.len() => every.to_vec(),
            Some(_) | None => return Err(invalid(OPTIONS)),
        };
        let software = get(DRAWN_BY)?.clone();
        if software.len() > MAX_SOFTWARE {
            return Err(invalid(DRAWN_BY));
        }
        check_extent(&look.caption, &titles, recordings.len()).map_err(|reason| Error::DamagedProvenance { reason })?;
        let text = |key| metadata.get(key).map(str::to_owned);
        Ok(Provenance {
            software,
            recordings,
            recorded_every,
            picture: ResolvedPicture { subject, look, titles },
            texts: text(Metadata::TITLE).zip(text(Metadata::DESCRIPTION)).map(<[String; 2]>::from),
        })
    }
}

/// The kind of a picture and the titles of its recordings, in one line.
fn title(picture: &ResolvedPicture, sources: &[Source]) -> String {
    let language = picture.look.language;
    let over_time;
    let kind = match &picture.subject {
        Subject::Animation { .. } => "Animation",
        Subject::Page { page: Page::State { .. }, .. } => language.of("State", "État"),
        Subject::Page { page: Page::Collision { figure: CollisionFigure::Stages(_), .. }, .. } => "Collision",
        Subject::Page { page: Page::Collision { figure: CollisionFigure::Minkowski, .. }, .. } => {
            language.of("Minkowski difference", "Différence de Minkowski")
        }
        Subject::Page { page: Page::States { figure, .. }, .. } => match figure {
            StatesFigure::Strobe => language.of("Stroboscopic picture", "Image stroboscopique"),
            StatesFigure::Spacetime(_) => language.of("Position over time", "Position en fonction du temps"),
            StatesFigure::Filmstrip => language.of("Filmstrip", "Suite d’instants"),
        },
        Subject::Page { page: Page::Speeds { .. }, .. } => {
            language.of("Distribution of speeds", "Distribution des vitesses")
        }
        Subject::Page { page: Page::Pressure { .. }, .. } => language.of("Pressure", "Pression"),
        Subject::Page { page: Page::VelocitySpace { .. }, .. } => language.of("Velocity space", "Espace des vitesses"),
        Subject::Page { page: Page::Lines { quantity, .. }, .. } => {
            over_time = format!("{} {}", quantity.title(language), language.of("over time", "en fonction du temps"));
            &over_time
        }
        Subject::Page { page: Page::Energy { .. }, .. } => {
            language.of("Energy and momentum over time", "Énergie et quantité de mouvement en fonction du temps")
        }
    };
    let own: Vec<String> = sources.iter().map(|source| source.title().to_owned()).collect();
    let titles = if picture.titles.is_empty() { &own } else { &picture.titles };
    in_one_line(&format!("{kind}{}: {}", language.of("", "\u{a0}"), titles.join("; ")))
}

/// The caption and the steps of a picture, in one line.
fn description(picture: &ResolvedPicture) -> String {
    let caption = picture.look.caption.trim_end();
    let separator = if caption.is_empty() {
        ""
    } else if caption.ends_with(['.', '!', '?']) {
        " "
    } else {
        ". "
    };
    let steps = steps(&picture.subject);
    let is_single = !steps.contains(" to ") && !steps.contains(", ");
    let steps = match picture.look.language {
        Language::English if is_single => format!("Step {steps}"),
        Language::English => format!("Steps {steps}"),
        Language::French => format!("Pas {}", in_french(&steps)),
    };
    in_one_line(&format!("{caption}{separator}{steps}"))
}

/// The text of steps with French words. Every step of a range needs none.
fn in_french(steps: &str) -> String {
    let range = |range: &str| {
        let range = range.strip_suffix(" every 1").unwrap_or(range);
        range.replace(" to ", " à ").replace(" every ", " tous les ")
    };
    steps.split(", ").map(range).collect::<Vec<String>>().join(", ")
}

/// A text without control characters and line breaks, which the text form of metadata cannot contain.
fn in_one_line(text: &str) -> String {
    text.split(|character: char| character.is_whitespace() || character.is_control())
        .filter(|word| !word.is_empty())
        .collect::<Vec<&str>>()
        .join(" ")
}

/// The drawn steps.
fn steps(subject: &Subject) -> String {
    let range = |steps: &RangeInclusive<u64>, every: u64| format!("{} to {} every {every}", steps.start(), steps.end());
    match subject {
        Subject::Animation { animation: Animation { steps, every, .. }, .. } => range(steps, *every),
        Subject::Page { page, .. } => match page {
            Page::State { step, every: None } => step.to_string(),
            Page::State { step, every: Some(every) } => format!("{step} every {every}"),
            Page::States { steps, .. }
            | Page::Energy { steps }
            | Page::Lines { steps, .. }
            | Page::Speeds { steps }
            | Page::Pressure { steps }
            | Page::VelocitySpace { steps, .. } => {
                steps.iter().map(|one| range(&one.steps, one.every)).collect::<Vec<String>>().join(", ")
            }
            Page::Collision { collisions, .. } => {
                collisions.iter().map(|selector| selector.step.to_string()).collect::<Vec<String>>().join(", ")
            }
        },
    }
}

fn write_subject(subject: &Subject, options: &mut OptionLine) {
    match subject {
        Subject::Animation { animation: Animation { timing, .. }, .. } => {
            if timing.frames_per_step != 1 {
                options.push("parts", timing.frames_per_step);
            }
            if timing.slow != 1.0 {
                options.push("slow", timing.slow);
            }
            if timing.hold != 0.0 {
                options.push("hold", timing.hold);
            }
        }
        Subject::Page { page, .. } => match page {
            Page::State { .. } => {}
            Page::Collision { figure, collisions } => {
                options.push("figure", figure.name());
                if let CollisionFigure::Stages(frame) = figure
                    && *frame != ReferenceFrame::Laboratory
                {
                    options.push("frame", frame);
                }
                options.push_strings("pair", collisions.iter().flat_map(|selector| &selector.pair));
            }
            Page::States { figure, .. } => {
                options.push("figure", figure.name());
                if let StatesFigure::Spacetime(axis) = figure {
                    options.push("axis", if *axis == Axis::X { "x" } else { "y" });
                }
            }
            Page::Energy { .. } => options.push("figure", "energy"),
            Page::Speeds { .. } => options.push("figure", "speeds"),
            Page::Pressure { .. } => options.push("figure", "pressure"),
            Page::VelocitySpace { axis, .. } => {
                options.push("figure", "velocity-space");
                options.push("axis", if *axis == Axis::X { "x" } else { "y" });
            }
            Page::Lines { quantity, .. } => {
                options.push("figure", "lines");
                options.push("quantity", quantity);
            }
        },
    }
}

/// The subject that [`steps`] and [`write_subject`] describe. `None` if a file of this format cannot contain it.
fn read_subject(steps: &str, options: &OptionLine, format: Format) -> Option<Subject> {
    match format {
        Format::Animation(format) if options.get("figure").is_none() => {
            let (steps, every) = read_range(steps)?;
            let timing = Timing {
                slow: options.parsed_or("slow", 1.0)?,
                frames_per_step: options.parsed_or("parts", 1)?,
                hold: options.parsed_or("hold", 0.0)?,
            };
            let is_accepted = SPEEDS.contains(&timing.slow)
                && (1..=MAX_FRAMES_PER_STEP).contains(&timing.frames_per_step)
                && (timing.hold == 0.0 || (MIN_HOLD..=MAX_HOLD).contains(&timing.hold));
            is_accepted.then_some(Subject::Animation { animation: Animation { steps, every, timing }, format })
        }
        Format::Animation(_) => None,
        Format::Still(format) => Some(Subject::Page { page: read_page(steps, options)?, format }),
    }
}

fn read_page(steps: &str, options: &OptionLine) -> Option<Page> {
    let ranges = || {
        let range = |text| read_range(text).map(|(steps, every)| StepRange { steps, every });
        steps.split(", ").map(range).collect::<Option<Vec<StepRange>>>()
    };
    let states = |figure| ranges().map(|steps| Page::States { figure, steps });
    let collision = |figure| Some(Page::Collision { figure, collisions: read_collisions(steps, options)? });
    match options.get("figure") {
        None => {
            let (step, every) = match steps.split_once(" every ") {
                Some((step, every)) => (step, Some(read_interval(every)?)),
                None => (steps, None),
            };
            Some(Page::State { step: read_step(step)?, every })
        }
        Some("collision") => {
            collision(CollisionFigure::Stages(options.parsed_or("frame", ReferenceFrame::Laboratory)?))
        }
        Some("minkowski") => collision(CollisionFigure::Minkowski),
        Some("strobe") => states(StatesFigure::Strobe),
        Some("spacetime") => {
            states(StatesFigure::Spacetime(if options.get("axis")? == "x" { Axis::X } else { Axis::Y }))
        }
        Some("filmstrip") => states(StatesFigure::Filmstrip),
        Some("energy") => ranges().map(|steps| Page::Energy { steps }),
        Some("pressure") => ranges().map(|steps| Page::Pressure { steps }),
        Some("speeds") => ranges().map(|steps| Page::Speeds { steps }),
        Some("velocity-space") => {
            let axis = if options.get("axis")? == "x" { Axis::X } else { Axis::Y };
            ranges().map(|steps| Page::VelocitySpace { axis, steps })
        }
        Some("lines") => {
            let quantity = options.get("quantity")?.parse().ok()?;
            ranges().map(|steps| Page::Lines { quantity, steps })
        }
        Some(_) => None,
    }
}

fn read_range(steps: &str) -> Option<(RangeInclusive<u64>, u64)> {
    let (first, rest) = steps.split_once(" to ")?;
    let (last, every) = rest.split_once(" every ")?;
    Some((read_step(first)?..=read_step(last)?, read_interval(every)?))
}

/// A step of a recording.
fn read_step(text: &str) -> Option<u64> {
    text.parse().ok().filter(|&step| step <= limits::STEPS)
}

/// A number of steps from one picture to the next.
fn read_interval(text: &str) -> Option<u64> {
    read_step(text).filter(|&every| every > 0)
}

fn read_collisions(steps: &str, options: &OptionLine) -> Option<Vec<CollisionSelector>> {
    let names = options.get_strings("pair")?;
    let steps: Vec<u64> = steps.split(", ").map(read_step).collect::<Option<_>>()?;
    let (pairs, []) = names.as_chunks::<2>() else { return None };
    let selector = |(&step, pair): (&u64, &[String; 2])| CollisionSelector { step, pair: pair.clone() };
    (steps.len() == pairs.len()).then(|| steps.iter().zip(pairs).map(selector).collect())
}

fn write_camera_target(target: &CameraTarget, options: &mut OptionLine) {
    match target {
        CameraTarget::World => {}
        CameraTarget::Window(area) => options.push("window", Window::Area(*area)),
        CameraTarget::Follow { name, size } => {
            options.push_strings("follow", [name]);
            options.push("window", Window::Size(*size));
        }
    }
}

fn read_camera_target(options: &OptionLine) -> Option<CameraTarget> {
    let followed = options.get_strings("follow")?.into_iter().next();
    let window = options.get("window").map(Window::from_str).transpose().ok()?;
    match (followed, window) {
        (None, None) => Some(CameraTarget::World),
        (None, Some(Window::Area(area))) => Some(CameraTarget::Window(area)),
        (Some(name), Some(Window::Size(size))) => Some(CameraTarget::Follow { name, size }),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::{Rect, Vector};
    use crate::picture::{AnimationFormat, ColorBy, Language, Overlay, Overlays, Quantity, StillFormat, TextAs, Theme};

    const IDENTITIES: [&str; 2] = ["00112233445566778899aabbccddeeff", "ffeeddccbbaa99887766554433221100"];

    fn provenance(subject: Subject, camera_target: CameraTarget) -> Provenance {
        let look = Look {
            size: [640, 360],
            theme: Theme::Dark,
            show: Overlays::from([Overlay::Velocity, Overlay::Clock]),
            color_by: ColorBy::Speed,
            camera_target,
            caption: "a \"b\" = c".into(),
            text: TextAs::Text,
            language: Language::French,
            bodies: "a b,#1..#9".parse().unwrap(),
        };
        Provenance {
            software: "rebond 0".into(),
            recordings: IDENTITIES.map(str::to_owned).into(),
            recorded_every: vec![5, 5],
            picture: ResolvedPicture { subject, look, titles: vec!["one".into(), "and two".into()] },
            texts: Some(["State: one; and two".into(), "Step 3".into()]),
        }
    }

    fn page(page: Page) -> Subject {
        Subject::Page { page, format: StillFormat::Pdf }
    }

    fn animation(steps: RangeInclusive<u64>, every: u64, timing: Timing) -> Subject {
        Subject::Animation { animation: Animation { steps, every, timing }, format: AnimationFormat::Gif }
    }

    #[test]
    fn every_subject_round_trips_through_metadata() {
        let pair = |a: &str, b: &str| [a.to_owned(), b.to_owned()];
        let collisions = vec![
            CollisionSelector { step: 3, pair: pair("c", "b b") },
            CollisionSelector { step: 4, pair: pair("x", "\"") },
        ];
        let steps = vec![StepRange { steps: 0..=60, every: 3 }, StepRange { steps: 0..=120, every: 6 }];
        let states = |figure| page(Page::States { figure, steps: steps.clone() });
        let collision = |figure| page(Page::Collision { figure, collisions: collisions.clone() });
        let subjects = [
            page(Page::State { step: 7, every: None }),
            page(Page::State { step: 8, every: Some(1) }),
            page(Page::State { step: 8, every: Some(4) }),
            animation(0..=600, 2, Timing::REAL_TIME),
            animation(5..=5, 1, Timing { frames_per_step: 5, slow: 0.1, hold: 0.5 }),
            states(StatesFigure::Strobe),
            states(StatesFigure::Spacetime(Axis::Y)),
            states(StatesFigure::Filmstrip),
            page(Page::Energy { steps: steps[..1].to_vec() }),
            page(Page::Lines { quantity: Quantity::Energy, steps: steps.clone() }),
            page(Page::Speeds { steps: steps.clone() }),
            page(Page::VelocitySpace { axis: Axis::Y, steps: steps.clone() }),
            page(Page::Pressure { steps: steps.clone() }),
            collision(CollisionFigure::Stages(ReferenceFrame::Laboratory)),
            collision(CollisionFigure::Stages(ReferenceFrame::CenterOfMass)),
            collision(CollisionFigure::Minkowski),
        ];
        let aims = [
            CameraTarget::World,
            CameraTarget::Window(Rect::new(Vector::new(-1e6, 0.1), 16.0, 1e-3)),
            CameraTarget::Follow { name: "a b".into(), size: Vector::new(2.5, 1.0) },
        ];
        for subject in &subjects {
            for camera_target in &aims {
                let provenance = provenance(subject.clone(), camera_target.clone());
                let format = provenance.picture.format();
                assert_eq!(Provenance::parse(&provenance.metadata(), format).unwrap(), provenance);
            }
        }
    }

    #[test]
    fn the_canonical_form_is_stable() {
        let clip = animation(0..=600, 2, Timing { slow: 0.5, ..Timing::REAL_TIME });
        let text = provenance(clip, CameraTarget::World).metadata().to_string();
        let expected = "Software: rebond 0\nrebond recording: 00112233445566778899aabbccddeeff; \
                        ffeeddccbbaa99887766554433221100\nrebond steps: 0 to 600 every 2\nrebond options: \
                        slow=0.5 size=640x360 theme=dark show=velocity,clock color_by=speed recorded_every=5 \
                        title=\"one\",\"and two\" caption=\"a \\\"b\\\" = c\" text=text language=fr \
                        bodies=\"a b,#1..#9\"\nTitle: State: one; and two\nDescription: Step 3\n";
        assert_eq!(text, expected);
    }

    #[test]
    fn a_page_is_not_read_from_an_animation_nor_an_animation_from_a_page() {
        let clip = provenance(animation(0..=600, 2, Timing::REAL_TIME), CameraTarget::World).metadata();
        assert!(Provenance::parse(&clip, Format::Still(StillFormat::Pdf)).is_err());
        let still = provenance(page(Page::State { step: 7, every: None }), CameraTarget::World).metadata();
        assert!(Provenance::parse(&still, Format::Animation(AnimationFormat::Gif)).is_err());
    }

    #[test]
    fn values_that_no_option_accepts_are_not_read() {
        let clip = animation(0..=600, 2, Timing { frames_per_step: 5, slow: 0.5, hold: 0.5 });
        let text = provenance(clip, CameraTarget::World).metadata().to_string();
        let parse = |text: &str| Provenance::parse(&Metadata::parse(text), Format::Animation(AnimationFormat::Gif));
        assert!(parse(&text).is_ok());
        for (valid, invalid) in [
            (IDENTITIES[0], "12"),
            (IDENTITIES[0], "none"),
            ("0 to 600", "0 to 18446744073709551615"),
            ("every 2", "every 0"),
            ("every 2", "every 9007199254740993"),
            ("slow=0.5", "slow=0"),
            ("slow=0.5", "slow=NaN"),
            ("slow=0.5", "slow=1e-300"),
            ("parts=5", "parts=0"),
            ("parts=5", "parts=18446744073709551615"),
            ("hold=0.5", "hold=1e9"),
            ("hold=0.5", "hold=-1"),
            ("size=640x360", "size=640x0"),
            ("recorded_every=5", "recorded_every=0"),
        ] {
            assert!(text.contains(valid), "{valid}");
            assert!(parse(&text.replace(valid, invalid)).is_err(), "{invalid}");
        }
    }

    #[test]
    fn the_error_names_the_missing_entry() {
        let subject = page(Page::State { step: 7, every: None });
        let mut metadata = provenance(subject, CameraTarget::World).metadata();
        metadata.entries.truncate(3);
        let error = Provenance::parse(&metadata, Format::Still(StillFormat::Pdf)).unwrap_err().to_string();
        assert_eq!(error, "the rebond provenance of the file is damaged: it has no \"rebond options\" entry");
    }
}
