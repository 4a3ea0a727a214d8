use crate::recording::{BodyTable, Change, Error, Item, RecordedState, Recording};
use crate::replay::{Difference, ulps};
use std::fmt::{self, Display, Formatter};
use std::io::{Read, Seek};

/// How what a scene gives now differs from the recording beside it.
#[derive(Clone, Debug, PartialEq)]
pub enum Drift {
    /// Only in its text: the same things happen.
    Text,
    /// In what the engine is told: solver, rate, gravity, restitution.
    Settings,
    /// In what happens to the world.
    Events {
        /// The first step at which it does.
        step: u64,
        /// What happened there, in words.
        recorded: String,
        /// What happens there now.
        now: String,
    },
    /// In a state, although the same happens to the world.
    State {
        /// The first that does.
        step: u64,
        /// How; what is called replayed is what the scene gives now.
        difference: Difference,
    },
    /// In how far it runs.
    Length {
        /// The last step recorded.
        recorded: u64,
        /// The last step now.
        now: u64,
    },
}

impl Drift {
    /// The first difference between two recordings known to be of different identity.
    ///
    /// # Errors
    /// When one of them cannot be read.
    pub fn between<R: Read + Seek, S: Read + Seek>(
        mut recorded: Recording<R>,
        mut now: Recording<S>,
    ) -> Result<Drift, Error> {
        if recorded.header.settings != now.header.settings {
            return Ok(Drift::Settings);
        }
        let mut last = 0;
        loop {
            let [was, is] = [next(&mut recorded)?, next(&mut now)?];
            match (was, is) {
                (None, None) => return Ok(Drift::Text),
                (Some(Item::State(was)), Some(Item::State(is))) => {
                    if let Some(difference) = difference(&was, &is, recorded.table()) {
                        return Ok(Drift::State { step: was.step, difference });
                    }
                    last = was.step;
                }
                (Some(Item::State(_)), None) => {
                    return Ok(Drift::Length { recorded: recorded.header.steps, now: last });
                }
                (None, Some(Item::State(is))) => {
                    return Ok(Drift::Length { recorded: last, now: now.header.steps.max(is.step) });
                }
                (was, is) if was == is => {}
                (was, is) => return Ok(events(was.as_ref(), is.as_ref())),
            }
        }
    }
}

/// The next item that belongs to what happened.
fn next<R: Read + Seek>(recording: &mut Recording<R>) -> Result<Option<Item>, Error> {
    for item in recording.by_ref() {
        match item? {
            item @ (Item::Event(_) | Item::State(_)) => return Ok(Some(item)),
            Item::Doubtful(_) | Item::Keyframe(_) | Item::View { .. } => {}
            Item::Damaged(_) | Item::Gap(_) | Item::End(_) => {}
        }
    }
    Ok(None)
}

fn difference(was: &RecordedState, is: &RecordedState, table: Option<&BodyTable>) -> Option<Difference> {
    if was.id == is.id {
        for (place, &id) in was.id.iter().enumerate() {
            let pairs = was.numbers(place).into_iter().zip(is.numbers(place)).zip(["x", "y", "vx", "vy"]);
            for ((recorded, replayed), field) in pairs {
                if ulps(recorded, replayed) > 0 {
                    let known = table.and_then(|table| table.with_state(was).find(|(known, _)| known.id == id));
                    let body = known.map_or(format!("{id}"), |(known, _)| known.spawn.name.clone());
                    return Some(Difference::Number { body, field, recorded, replayed });
                }
            }
        }
    }
    (was.digest != is.digest).then_some(Difference::Digest { recorded: was.digest, replayed: is.digest })
}

fn events(was: Option<&Item>, is: Option<&Item>) -> Drift {
    let step = [was, is].into_iter().flatten().filter_map(step).min().unwrap_or(0);
    match (was, is) {
        (Some(Item::Event(was)), Some(Item::Event(is))) if was.step == is.step => {
            let (recorded, now) = changes(&was.change, &is.change);
            Drift::Events { step, recorded, now }
        }
        (was, is) => Drift::Events { step, recorded: happening(was, step), now: happening(is, step) },
    }
}

fn step(item: &Item) -> Option<u64> {
    match item {
        Item::Event(event) => Some(event.step),
        Item::State(state) | Item::Doubtful(state) => Some(state.step),
        Item::Keyframe(_) | Item::View { .. } | Item::Damaged(_) | Item::Gap(_) | Item::End(_) => None,
    }
}

/// An item in words, if it is an event of that step.
fn happening(item: Option<&Item>, step: u64) -> String {
    match item {
        Some(Item::Event(event)) if event.step == step => change(&event.change),
        Some(_) | None => "nothing more".into(),
    }
}

fn change(change: &Change) -> String {
    match change {
        Change::Spawn { spawn, .. } => format!("spawn {:?}", spawn.name),
        Change::Delete { id } => format!("delete body {id}"),
    }
}

/// Two events, down to the first thing in which they differ.
fn changes(was: &Change, is: &Change) -> (String, String) {
    let (Change::Spawn { spawn: a, color: a_color, .. }, Change::Spawn { spawn: b, color: b_color, .. }) = (was, is)
    else {
        return (change(was), change(is));
    };
    let both = |what: &str, a: String, b: String| {
        (format!("{} with {what} {a}", change(was)), format!("{} with {what} {b}", change(is)))
    };
    let pair = |vector: crate::physics::Vector| format!("[{:?}, {:?}]", vector.x, vector.y);
    let size = |spawn: &crate::physics::Spawn| format!("[{:?}, {:?}]", spawn.rect.width(), spawn.rect.height());
    let color = |color: &Option<String>| color.clone().unwrap_or_else(|| "none".into());
    match () {
        () if a.name != b.name => (change(was), change(is)),
        () if a.rect.origin != b.rect.origin => both("at", pair(a.rect.origin), pair(b.rect.origin)),
        () if a.mass != b.mass => both("mass", format!("{:?}", a.mass), format!("{:?}", b.mass)),
        () if a.velocity != b.velocity => both("velocity", pair(a.velocity), pair(b.velocity)),
        () if a.force != b.force => both("force", pair(a.force), pair(b.force)),
        () if a.material != b.material => both("material", format!("{:?}", a.material), format!("{:?}", b.material)),
        () if a_color != b_color => both("color", color(a_color), color(b_color)),
        () => both("size", size(a), size(b)),
    }
}

impl Display for Drift {
    fn fmt(&self, out: &mut Formatter) -> fmt::Result {
        match self {
            Drift::Text => write!(out, "the text of its scene is another; the same happens"),
            Drift::Settings => write!(out, "its scene gives another solver, rate, gravity, restitution or limit now"),
            Drift::Events { step, recorded, now } => {
                write!(out, "its scene gives another run now: at step {step} recorded {recorded}, now {now}")
            }
            Drift::State { step, difference } => {
                write!(out, "its scene gives another run now, \"replayed\" here: at step {step} {difference}")
            }
            Drift::Length { recorded, now } => {
                write!(out, "its scene gives a run of {now} steps now, recorded were {recorded}")
            }
        }
    }
}
