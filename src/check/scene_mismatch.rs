use crate::physics::{EngineConfig, Restitution, Spawn, Vector};
use crate::recording::{
    BodyTable, Change, Error, Header, Item, Paint, RecordedEvent, RecordedState, Recording, SceneImage,
};
use crate::replay::{Difference, ulps};
use std::collections::BTreeMap;
use std::fmt::{self, Display, Formatter};
use std::io::{Read, Seek};

/// A value that has changed: a setting of a run or an option of a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ValueChange {
    /// The name, for example `rate` or `theme`.
    pub name: String,
    /// The value of the reference.
    pub recorded: String,
    /// The present value.
    pub current: String,
}

impl ValueChange {
    /// Returns the change of a value; `None` if both are the same.
    pub fn of(name: impl Into<String>, recorded: impl Display, current: impl Display) -> Option<ValueChange> {
        let (recorded, current) = (recorded.to_string(), current.to_string());
        (recorded != current).then(|| ValueChange { name: name.into(), recorded, current })
    }
}

/// Formats the change as `rate: 60 → 120`.
impl Display for ValueChange {
    fn fmt(&self, out: &mut Formatter) -> fmt::Result {
        write!(out, "{}: {} → {}", self.name, self.recorded, self.current)
    }
}

/// The difference between a recording and a new run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneMismatch {
    /// The settings of the run that differ, and the options of the recording.
    pub changes: Vec<ValueChange>,
    /// The first event or state that differs, if the settings of the run are the same.
    pub first: Option<RunDifference>,
    /// The first line of the scene that differs.
    pub line: Option<SceneLine>,
}

/// The first difference between two runs with the same settings.
#[derive(Clone, Debug, PartialEq)]
pub enum RunDifference {
    /// An event differs.
    Events {
        /// The step of the first difference.
        step: u64,
        /// The recorded event in words.
        recorded: String,
        /// The event of the new run in words.
        current: String,
    },
    /// A state differs although all events up to it are the same.
    State {
        /// The step of the first difference.
        step: u64,
        /// The difference; its `replayed` value is the one of the new run.
        difference: Difference,
    },
    /// The run ends at another step, because the engine could not continue.
    Length {
        /// The last step of the recording.
        recorded: u64,
        /// The last step of the new run.
        current: u64,
    },
}

/// The first line of a scene that differs. A line that does not exist is empty.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneLine {
    /// The number of the line, from 1.
    pub number: usize,
    /// The line in the recording.
    pub recorded: String,
    /// The present line.
    pub current: String,
}

impl SceneMismatch {
    /// Returns the first difference between two recordings. States and events are compared by step; steps that the
    /// recording lacks are not compared.
    ///
    /// # Errors
    /// If one of them cannot be read.
    pub fn between<R: Read + Seek, S: Read + Seek>(
        mut recorded: Recording<R>,
        mut current: Recording<S>,
    ) -> Result<SceneMismatch, Error> {
        let line = SceneLine::between(&recorded.header, &current.header);
        let changes = setting_changes(&recorded.header, &current.header);
        let first = if changes.is_empty() { RunDifference::between(&mut recorded, &mut current)? } else { None };
        Ok(SceneMismatch { changes, first, line })
    }

    /// Returns true if nothing differs.
    pub fn is_empty(&self) -> bool {
        *self == SceneMismatch::default()
    }
}

/// The settings that differ: solver, rate, gravity, restitution, event limit and number of steps.
fn setting_changes(recorded: &Header, current: &Header) -> Vec<ValueChange> {
    let settings = |header: &Header| {
        let EngineConfig { solver, rate, gravity, events_per_step, .. } = &header.config;
        [
            ("solver", solver.name().to_owned()),
            ("rate", format!("{rate}")),
            ("steps", header.steps.to_string()),
            ("gravity", gravity.map_or("none".into(), pair)),
            ("events_per_step", events_per_step.to_string()),
        ]
    };
    let values = settings(recorded).into_iter().zip(settings(current));
    let mut changes: Vec<ValueChange> =
        values.filter_map(|((name, recorded), (_, current))| ValueChange::of(name, recorded, current)).collect();
    let [old, new] = [recorded, current].map(|header| restitution(&header.config.restitution));
    let names: std::collections::BTreeSet<&String> = old.keys().chain(new.keys()).collect();
    let value = |values: &BTreeMap<String, f64>, name: &String| {
        values.get(name).map_or("none".to_owned(), |value| format!("{value}"))
    };
    changes.extend(names.into_iter().filter_map(|name| ValueChange::of(name, value(&old, name), value(&new, name))));
    let [old, new] = [recorded, current].map(images);
    let names: std::collections::BTreeSet<&String> = old.keys().chain(new.keys()).collect();
    let value = |files: &BTreeMap<String, String>, name: &String| files.get(name).cloned().unwrap_or("none".into());
    let image = |name: &String| ValueChange::of(format!("image {name}"), value(&old, name), value(&new, name));
    changes.extend(names.into_iter().filter_map(image));
    changes
}

/// The images of a scene with their sizes and digests.
fn images(header: &Header) -> BTreeMap<String, String> {
    let image = |image: &SceneImage| (image.name.clone(), format!("{} bytes, {:016x}", image.bytes, image.digest));
    header.images.iter().map(image).collect()
}

/// The coefficients by the names that `--set` gives them.
fn restitution(table: &Restitution) -> BTreeMap<String, f64> {
    let pairs = table.pairs().into_iter().map(|pair| {
        let [a, b] = pair.materials;
        (format!("restitution.{a}/{b}"), pair.restitution)
    });
    std::iter::once(("restitution.default".to_owned(), table.default_restitution())).chain(pairs).collect()
}

/// The options of `record` that differ. `viewer` says of both recordings if they have boxes for viewers.
pub fn option_changes(recorded: &Header, current: &Header, viewer: [bool; 2]) -> Vec<ValueChange> {
    let [was_viewer, is_viewer] = viewer.map(|viewer| if viewer { "yes" } else { "no" });
    let accuracy = |header: &Header| if header.estimates_accuracy { "estimated" } else { "no" };
    let live = |header: &Header| if header.has_live_events { "yes" } else { "no" };
    let changes = [
        ValueChange::of("every", recorded.every, current.every),
        ValueChange::of("viewer", was_viewer, is_viewer),
        ValueChange::of("accuracy", accuracy(recorded), accuracy(current)),
        ValueChange::of("live events", live(recorded), live(current)),
    ];
    changes.into_iter().flatten().collect()
}

impl SceneLine {
    fn between(recorded: &Header, current: &Header) -> Option<SceneLine> {
        let text = |header: &Header| header.scene.as_ref().map(|scene| scene.text.replace("\r\n", "\n"));
        let (old, new) = (text(recorded)?, text(current)?);
        let lines = [&old, &new].map(|text| text.lines().collect::<Vec<&str>>());
        let [old_lines, new_lines] = &lines;
        let count = old_lines.len().max(new_lines.len());
        let line = |lines: &[&str], index: usize| lines.get(index).copied().unwrap_or_default().to_owned();
        let index = (0..count).find(|&index| old_lines.get(index) != new_lines.get(index))?;
        Some(SceneLine { number: index + 1, recorded: line(old_lines, index), current: line(new_lines, index) })
    }
}

/// The events and the state of a step.
struct RecordedStep {
    step: u64,
    events: Vec<RecordedEvent>,
    state: Option<RecordedState>,
}

/// Returns the next step. Events come before the state of their step.
fn next_step<R: Read + Seek>(
    recording: &mut Recording<R>,
    pending: &mut Option<RecordedEvent>,
) -> Result<Option<RecordedStep>, Error> {
    let mut events: Vec<RecordedEvent> = pending.take().into_iter().collect();
    for item in recording.by_ref() {
        match item? {
            Item::Event(event) if events.first().is_some_and(|first| first.step != event.step) => {
                *pending = Some(event);
                break;
            }
            Item::Event(event) => events.push(event),
            Item::State(state) => return Ok(Some(RecordedStep { step: state.step, events, state: Some(state) })),
            Item::SuspectState(_) | Item::Keyframe(_) | Item::SceneUpdate { .. } => {}
            Item::Damaged(_) | Item::Gap(_) | Item::Trailer(_) => {}
        }
    }
    Ok(events.first().map(|event| event.step).map(|step| RecordedStep { step, events, state: None }))
}

impl RunDifference {
    fn between<R: Read + Seek, S: Read + Seek>(
        recorded: &mut Recording<R>,
        current: &mut Recording<S>,
    ) -> Result<Option<RunDifference>, Error> {
        let mut pending = [None, None];
        let mut last = [0, 0];
        let mut old = next_step(recorded, &mut pending[0])?;
        let mut new = next_step(current, &mut pending[1])?;
        while let (Some(a), Some(b)) = (&old, &new) {
            last = [a.step, b.step];
            if a.step > b.step {
                new = next_step(current, &mut pending[1])?;
                continue;
            }
            if a.step == b.step {
                if let Some(difference) = differing_event(a, b) {
                    return Ok(Some(difference));
                }
                let states = a.state.as_ref().zip(b.state.as_ref());
                let difference = states.and_then(|(old, new)| difference(old, new, recorded.table()));
                if let Some(difference) = difference {
                    return Ok(Some(RunDifference::State { step: a.step, difference }));
                }
                new = next_step(current, &mut pending[1])?;
            }
            old = next_step(recorded, &mut pending[0])?;
        }
        if old.is_none() && new.is_none() {
            return Ok(None);
        }
        while let Some(step) = old {
            last[0] = step.step;
            old = next_step(recorded, &mut pending[0])?;
        }
        while let Some(step) = new {
            last[1] = step.step;
            new = next_step(current, &mut pending[1])?;
        }
        let [recorded, current] = last;
        Ok((recorded != current).then_some(RunDifference::Length { recorded, current }))
    }
}

fn differing_event(old: &RecordedStep, new: &RecordedStep) -> Option<RunDifference> {
    let count = old.events.len().max(new.events.len());
    let index = (0..count).find(|&index| old.events.get(index) != new.events.get(index))?;
    let (recorded, current) = match (old.events.get(index), new.events.get(index)) {
        (Some(old), Some(new)) => describe_difference(&old.change, &new.change),
        (old, new) => (describe_event(old), describe_event(new)),
    };
    Some(RunDifference::Events { step: old.step, recorded, current })
}

fn difference(old: &RecordedState, new: &RecordedState, table: Option<&BodyTable>) -> Option<Difference> {
    if old.id == new.id {
        for (index, &id) in old.id.iter().enumerate() {
            let pairs = old.body_state(index).into_iter().zip(new.body_state(index)).zip(["x", "y", "vx", "vy"]);
            for ((recorded, replayed), field) in pairs {
                if ulps(recorded, replayed) != Some(0) {
                    let info =
                        table.and_then(|table| table.join_state(old).map(|(info, _)| info).find(|info| info.id == id));
                    let body = info.map_or(format!("{id}"), |info| info.spawn.name.clone());
                    return Some(Difference::Value { body, field, recorded, replayed });
                }
            }
        }
    }
    (old.digest != new.digest).then_some(Difference::Digest { recorded: old.digest, replayed: new.digest })
}

fn describe_event(event: Option<&RecordedEvent>) -> String {
    event.map_or("no further event".into(), |event| describe(&event.change))
}

fn describe(change: &Change) -> String {
    match change {
        Change::Spawn(info) => format!("spawn {:?}", info.spawn.name),
        Change::Delete { id } => format!("delete body {id}"),
    }
}

fn pair(vector: Vector) -> String {
    format!("[{:?}, {:?}]", vector.x, vector.y)
}

/// Describes two events, including the first property in which they differ.
fn describe_difference(old: &Change, new: &Change) -> (String, String) {
    let (Change::Spawn(a), Change::Spawn(b)) = (old, new) else { return (describe(old), describe(new)) };
    let (paints, [a, b]) = ([&a.paint, &b.paint], [&a.spawn, &b.spawn]);
    let size = |spawn: &Spawn| format!("[{:?}, {:?}]", spawn.rect.width(), spawn.rect.height());
    let color = |paint: &Paint| if paint.is_empty() { "none".into() } else { paint.as_str().to_owned() };
    let (property, [a_value, b_value]) = if a.name != b.name {
        return (describe(old), describe(new));
    } else if a.rect.origin != b.rect.origin {
        ("at", [a, b].map(|spawn| pair(spawn.rect.origin)))
    } else if a.mass != b.mass {
        ("mass", [a, b].map(|spawn| format!("{:?}", spawn.mass)))
    } else if a.velocity != b.velocity {
        ("velocity", [a, b].map(|spawn| pair(spawn.velocity)))
    } else if a.force != b.force {
        ("force", [a, b].map(|spawn| pair(spawn.force)))
    } else if a.material != b.material {
        ("material", [a, b].map(|spawn| format!("{:?}", spawn.material)))
    } else if paints[0] != paints[1] {
        ("color", paints.map(color))
    } else {
        ("size", [a, b].map(size))
    };
    (format!("{} with {property} {a_value}", describe(old)), format!("{} with {property} {b_value}", describe(new)))
}

/// Joins changes to a list.
pub fn joined(changes: &[ValueChange]) -> String {
    changes.iter().map(ToString::to_string).collect::<Vec<String>>().join(", ")
}

impl Display for SceneMismatch {
    fn fmt(&self, out: &mut Formatter) -> fmt::Result {
        match (&self.first, self.changes.is_empty()) {
            (_, false) => write!(out, "its scene now gives a different run: {}", joined(&self.changes))?,
            (None, true) => write!(out, "the text of its scene has changed, without effect on the run")?,
            (Some(RunDifference::Events { step, recorded, current }), true) => {
                write!(out, "its scene now gives a different run: at step {step} recorded {recorded}, now {current}")?;
            }
            (Some(RunDifference::State { step, difference }), true) => {
                write!(
                    out,
                    "its scene now gives a different run, called \"replayed\" here: at step {step} {difference}"
                )?;
            }
            (Some(RunDifference::Length { recorded, current }), true) => {
                write!(out, "its scene now runs to step {current}, the recording to step {recorded}")?;
            }
        }
        self.line.iter().try_for_each(|line| write!(out, "; {line}"))
    }
}

impl Display for SceneLine {
    fn fmt(&self, out: &mut Formatter) -> fmt::Result {
        let [recorded, current] = [&self.recorded, &self.current].map(|line| {
            let line = line.trim();
            let cut: String = line.chars().take(80).collect();
            if cut.len() < line.len() { format!("{cut}…") } else { cut }
        });
        write!(out, "line {} of the scene: {recorded:?} → {current:?}", self.number)
    }
}
