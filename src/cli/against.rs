//! `replay --against`: the states of another program, compared with a recording.

use super::arguments::{ReplayOptions, is_standard_output};
use super::error::CommandError;
use super::output_file::{OutputFile, Overwrite};
use super::states_table::{FIELDS, StateRow, StatesTable};
use super::{Exit, output};
use crate::junit::{TestCase, TestOutcome, TestSuite};
use crate::physics::{Body, BodyId, Collision, Engine, Observer};
use crate::recording::{self, Missing, body_state};
use crate::replay::{Replayer, Verdict, distance, ulps};
use crate::text::counted;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io;
use std::path::Path;

/// Compares the states of another program with those of a recording, and prints the verdict.
pub fn run(options: &ReplayOptions, states: &Path) -> Result<Exit, CommandError> {
    let inputs = [options.recording.as_path(), states];
    let create = |path: &Path| OutputFile::create(path, Overwrite::for_junit(path, options.force), &inputs);
    let report = options.junit.as_deref().map(create).transpose()?;
    let compared = compare(options, states);
    if let Some(report) = report {
        let outcome = match &compared {
            Ok(comparison) => comparison.outcome(),
            Err(error) => TestOutcome::Error { message: error.to_string() },
        };
        let name = |path: &Path| path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        let case = TestCase { class: name(&options.recording), name: name(states), outcome };
        let suite = TestSuite { name: "rebond replay --against".into(), cases: vec![case] };
        let path = report.name().to_owned();
        report.write(|file| file.write_all(suite.to_string().as_bytes()).map_err(CommandError::unwritable(&path)))?;
    }
    let comparison = compared?;
    let text = if options.json { comparison.json().to_string() } else { comparison.text() };
    output::print(&format!("{text}\n"))?;
    Ok(comparison.exit())
}

fn compare(options: &ReplayOptions, states: &Path) -> Result<Comparison, CommandError> {
    let path = &options.recording;
    let recording = recording::open(path).map_err(CommandError::in_recording(path))?;
    let (rate, every, last) = (recording.header.config.rate, recording.header.every, recording.header.steps);
    let table = if is_standard_output(states) {
        StatesTable::read(io::stdin(), rate)
    } else {
        StatesTable::read(File::open(states).map_err(CommandError::unreadable(states))?, rate)
    };
    let table = table.map_err(|source| CommandError::StatesTable { path: states.into(), source })?;
    let steps = options.steps(rate)?;
    let bar = output::progress_bar("comparing", last);
    let mut replayer = Replayer::new(recording, steps).map_err(CommandError::in_recording(path))?;
    let mut comparison = Comparison::new(table, every, options.tolerance);
    let mut collisions = LatestCollisions::default();
    while let Some(step) = replayer.next_state(&mut collisions).map_err(CommandError::in_recording(path))? {
        bar.set_position(step);
        if let Some(engine) = replayer.engine() {
            collisions.update_names(engine);
            comparison.compare(step, engine, &collisions, replayer.last_event());
        }
    }
    bar.finish_and_clear();
    match replayer.verdict() {
        Verdict::Same { .. } => {}
        Verdict::Incomplete { missing, .. } => comparison.missing_in_recording = Some(missing),
        verdict @ (Verdict::Diverged(_) | Verdict::Corrupt { .. }) => {
            return Err(CommandError::NoReference { path: path.clone(), verdict: Box::new(verdict) });
        }
    }
    if comparison.states == 0 {
        return Err(CommandError::NoCommonSteps { path: states.into(), last });
    }
    Ok(comparison)
}

/// The states of another program beside those of a recording.
struct Comparison {
    table: StatesTable,
    /// The recording has every N-th state in full, N being this number; the table needs no others.
    every: u64,
    tolerance: Option<f64>,
    /// The names in the table; a body of infinite mass is compared if it is one of them.
    names: BTreeSet<String>,
    /// The number of states that were compared, and of those that are the same.
    states: u64,
    same: u64,
    /// The bodies that were compared.
    bodies: BTreeSet<BodyId>,
    /// The recorded steps without a row, as ranges.
    gaps: Vec<(u64, u64)>,
    /// The last recorded step.
    last: u64,
    first: Option<FirstDifference>,
    growth: Growth,
    /// The parts that the recording itself lacks.
    missing_in_recording: Option<Missing>,
}

/// The first difference, with the last event and the last collision before it.
struct FirstDifference {
    step: u64,
    difference: TableDifference,
    last_event: Option<String>,
    last_collision: Option<LatestCollision>,
}

enum TableDifference {
    /// A number of a body.
    Number { body: String, is_infinite: bool, field: usize, row: StateRow, recorded: [f64; 4] },
    /// The table has no row for a body that is alive.
    MissingBody { body: String },
    /// The table has a row for a body that is not alive.
    UnknownBody { body: String, line: u64 },
}

/// The conclusion of a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Conclusion {
    Same,
    /// The states that both have are the same, but the table or the recording lacks some.
    Incomplete,
    Diverged,
}

impl Conclusion {
    const fn word(self) -> &'static str {
        match self {
            Conclusion::Same => "same",
            Conclusion::Incomplete => "incomplete",
            Conclusion::Diverged => "diverged",
        }
    }
}

impl Comparison {
    fn new(table: StatesTable, every: u64, tolerance: Option<f64>) -> Comparison {
        let names = table.steps.values().flat_map(|rows| rows.keys().cloned()).collect();
        Comparison {
            table,
            every,
            tolerance,
            names,
            states: 0,
            same: 0,
            bodies: BTreeSet::new(),
            gaps: Vec::new(),
            last: 0,
            first: None,
            growth: Growth::default(),
            missing_in_recording: None,
        }
    }

    /// Compares the state of one step.
    fn compare(&mut self, step: u64, engine: &Engine, collisions: &LatestCollisions, last_event: Option<&str>) {
        self.last = step;
        let Some(rows) = self.table.steps.get(&step) else {
            if step.is_multiple_of(self.every) {
                match self.gaps.last_mut() {
                    Some((_, end)) if *end + self.every == step => *end = step,
                    Some(_) | None => self.gaps.push((step, step)),
                }
            }
            return;
        };
        self.states += 1;
        let bodies = &engine.world().bodies;
        let expected = bodies.iter().filter(|body| !body.is_infinite() || self.names.contains(&body.name));
        let mut difference = None;
        let mut largest = Deviation::default();
        for body in expected {
            let Some(row) = rows.get(&body.name) else {
                difference.get_or_insert((Some(body.id), TableDifference::MissingBody { body: body.name.clone() }));
                continue;
            };
            self.bodies.insert(body.id);
            largest = largest.max(Deviation::between(row, body));
            if let Some(field) = self.table.fields.iter().find(|field| !self.is_same(row, body, **field)) {
                let number = || TableDifference::Number {
                    body: body.name.clone(),
                    is_infinite: body.is_infinite(),
                    field: *field,
                    row: row.clone(),
                    recorded: body_state(body),
                };
                difference.get_or_insert_with(|| (Some(body.id), number()));
            }
        }
        let alive: BTreeSet<&String> = bodies.iter().map(|body| &body.name).collect();
        if let Some((name, row)) = rows.iter().find(|(name, _)| !alive.contains(name)) {
            let unknown = TableDifference::UnknownBody { body: name.clone(), line: row.line };
            difference.get_or_insert((None, unknown));
        }
        self.growth.add(step, largest, self.first.as_ref().map(|first| first.step));
        match difference {
            None => self.same += 1,
            Some((body, difference)) if self.first.is_none() => {
                let last_collision = collisions.of(body);
                let last_event = last_event.map(str::to_owned);
                self.growth = Growth::default();
                self.growth.add(step, largest, Some(step));
                self.first = Some(FirstDifference { step, difference, last_event, last_collision });
            }
            Some(_) => {}
        }
    }

    /// Returns true if a number is the recorded one, or within the tolerance. 0 and −0 are the same: programs print
    /// both as 0.
    fn is_same(&self, row: &StateRow, body: &Body, field: usize) -> bool {
        let (given, recorded) = (row.values[field], body_state(body)[field]);
        given == recorded
            || given.is_nan() && recorded.is_nan()
            || (given - recorded).abs() <= self.tolerance.unwrap_or(0.0)
    }

    fn conclusion(&self) -> Conclusion {
        match (&self.first, self.gaps.is_empty() && self.missing_in_recording.is_none()) {
            (Some(_), _) => Conclusion::Diverged,
            (None, false) => Conclusion::Incomplete,
            (None, true) => Conclusion::Same,
        }
    }

    fn exit(&self) -> Exit {
        match self.conclusion() {
            Conclusion::Same => Exit::Done,
            Conclusion::Incomplete => Exit::Damaged,
            Conclusion::Diverged => Exit::Diverged,
        }
    }

    /// The verdict in one line.
    fn verdict(&self) -> String {
        let same = counted(self.same, "state");
        match (&self.first, self.gaps.first(), &self.missing_in_recording) {
            (Some(first), _, _) => {
                let event = first.last_event.as_ref().map(|event| format!(", after event {event}")).unwrap_or_default();
                format!("diverged at step {}: {}{event}", first.step, first.difference.text())
            }
            (None, Some((from, to)), _) => {
                let missing: u64 = self.gaps.iter().map(|(from, to)| (to - from) / self.every + 1).sum();
                let steps = if from == to { format!("step {from}") } else { format!("steps {from} to {to}") };
                let more = missing - ((to - from) / self.every + 1);
                let more = if more > 0 { format!(" and {}", counted(more, "more step")) } else { String::new() };
                format!("incomplete: the table has no rows for {steps}{more}; {same} same")
            }
            (None, None, Some(missing)) => format!("incomplete recording: {missing}; {same} same"),
            (None, None, None) => {
                let within = self.tolerance.map(|tolerance| format!(" within {tolerance:?}")).unwrap_or_default();
                let bodies = counted(self.bodies.len() as u64, "body");
                format!("same{within}: {same}, {bodies}; compared {}", self.table.field_names())
            }
        }
    }

    /// Returns everything that is known, one fact a line. The last line is the verdict.
    fn text(&self) -> String {
        let mut lines = Vec::new();
        if let Some(first) = &self.first {
            lines.extend(first.difference.lines(&self.table.fields));
            let event = first.last_event.as_deref().unwrap_or("none");
            lines.push(format!("last event: {event}"));
            let collision = first.last_collision.as_ref().map_or("none".to_owned(), LatestCollision::text);
            lines.push(format!("last collision: {collision}"));
            lines.extend(self.growth.lines());
            lines.push(format!("states: {} same, {} compared", self.same, self.states));
        } else if self.tolerance.is_some() && self.growth.largest.1 != Deviation::default() {
            let (step, Deviation { position, velocity }) = self.growth.largest;
            lines.push(format!("largest difference: {position:?} m, {velocity:?} m/s, at step {step}"));
        }
        if !self.table.ignored.is_empty() {
            lines.push(format!("ignored columns: {}", self.table.ignored.join(", ")));
        }
        if let Some(beyond) = self.table.steps.keys().next_back().filter(|step| **step > self.last) {
            lines.push(format!(
                "not compared: rows up to step {beyond}, after step {}, the last one compared",
                self.last
            ));
        }
        lines.push(self.verdict());
        lines.join("\n")
    }

    fn json(&self) -> Value {
        let first = self.first.as_ref();
        json!({
            "verdict": self.conclusion().word(), "same_states": self.same, "states": self.states, "bodies": self.bodies.len(),
            "columns": self.table.fields.iter().map(|field| FIELDS[*field]).collect::<Vec<_>>(),
            "tolerance": self.tolerance,
            "divergence": first.map(|first| first.difference.json(first.step)),
            "last_event": first.and_then(|first| first.last_event.clone()),
            "last_collision": first.and_then(|first| first.last_collision.as_ref()).map(LatestCollision::json),
            "growth": self.growth.json(),
            "missing_steps": self.gaps.iter().map(|(from, to)| json!({ "from": from, "to": to })).collect::<Vec<_>>(),
            "what": self.verdict(),
        })
    }

    fn outcome(&self) -> TestOutcome {
        match self.conclusion() {
            Conclusion::Same => TestOutcome::Passed,
            Conclusion::Incomplete | Conclusion::Diverged => {
                TestOutcome::Failed { message: self.verdict(), details: self.text() }
            }
        }
    }
}

impl TableDifference {
    fn text(&self) -> String {
        match self {
            TableDifference::Number { body, field, row, recorded, .. } => {
                let (recorded, given) = (recorded[*field], row.values[*field]);
                let (field, distance) = (FIELDS[*field], distance(recorded, given));
                format!("body {body:?} {field} recorded {recorded:?} given {given:?}{distance}")
            }
            TableDifference::MissingBody { body } => format!("the table has no row for body {body:?}"),
            TableDifference::UnknownBody { body, line } => {
                format!("the table has body {body:?} on line {line}, which is not alive in the recording")
            }
        }
    }

    /// All numbers of the body side by side.
    fn lines(&self, fields: &[usize]) -> Vec<String> {
        let TableDifference::Number { body, is_infinite, row, recorded, .. } = self else { return Vec::new() };
        let mass = if *is_infinite { ", of infinite mass" } else { "" };
        let mut lines = vec![format!("body {body:?}{mass}, line {} of the table:", row.line)];
        let mut rounded = None;
        for field in fields {
            let (given, recorded) = (row.values[*field], recorded[*field]);
            let mark = if given == recorded { "" } else { "  differs" };
            lines.push(format!("  {:2} recorded {recorded:?}  given {given:?}{mark}", FIELDS[*field]));
            let is_rounded = |digits: &usize| given != recorded && format!("{recorded:.digits$}").parse() == Ok(given);
            rounded = rounded.or(row.decimals[*field].filter(is_rounded));
        }
        if let Some(decimals) = rounded {
            lines.push(format!(
                "  the table is rounded to {}; write all digits, or compare with --tolerance",
                counted(decimals as u64, "decimal")
            ));
        }
        lines
    }

    fn json(&self, step: u64) -> Value {
        match self {
            TableDifference::Number { body, field, row, recorded, .. } => {
                let (recorded, given) = (recorded[*field], row.values[*field]);
                json!({
                    "step": step, "body": body, "field": FIELDS[*field], "recorded": recorded, "given": given,
                    "difference": given - recorded, "ulps": ulps(recorded, given), "line": row.line,
                })
            }
            TableDifference::MissingBody { body } => json!({ "step": step, "body": body, "what": self.text() }),
            TableDifference::UnknownBody { body, line } => {
                json!({ "step": step, "body": body, "line": line, "what": self.text() })
            }
        }
    }
}

/// The largest differences of a state: of a coordinate, m, and of a component of a velocity, m/s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Deviation {
    position: f64,
    velocity: f64,
}

impl Deviation {
    /// The differences between a row and a body. A number of the table that is NaN differs infinitely.
    fn between(row: &StateRow, body: &Body) -> Deviation {
        let recorded = body_state(body);
        let [x, y, vx, vy] = [0, 1, 2, 3].map(|field| match (row.values[field] - recorded[field]).abs() {
            difference if !difference.is_nan() => difference,
            _ if row.decimals[field].is_some() => f64::INFINITY,
            // The table does not have this column.
            _ => 0.0,
        });
        Deviation { position: greater(x, y), velocity: greater(vx, vy) }
    }

    fn max(self, other: Deviation) -> Deviation {
        let position = greater(self.position, other.position);
        Deviation { position, velocity: greater(self.velocity, other.velocity) }
    }
}

fn greater(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// The growth of the differences after the first one.
#[derive(Default)]
struct Growth {
    /// The differences 0, 1, 2, 5, 10, 20, 50, … steps after the first one.
    samples: Vec<(u64, Deviation)>,
    latest: Option<(u64, Deviation)>,
    largest: (u64, Deviation),
}

impl Growth {
    fn add(&mut self, step: u64, deviation: Deviation, first: Option<u64>) {
        if first.is_some_and(|first| is_sampled(step - first)) {
            self.samples.push((step, deviation));
        }
        self.latest = Some((step, deviation));
        let (_, largest) = &self.largest;
        if deviation.position > largest.position
            || deviation.position == largest.position && deviation.velocity > largest.velocity
        {
            self.largest = (step, deviation);
        }
    }

    /// The samples and the last state, if it is none of them.
    fn points(&self) -> Vec<(u64, Deviation)> {
        let is_new = |latest: &(u64, Deviation)| self.samples.last().is_none_or(|sample| sample.0 < latest.0);
        self.samples.iter().copied().chain(self.latest.filter(is_new)).collect()
    }

    fn lines(&self) -> Vec<String> {
        let line = |(step, Deviation { position, velocity }): (u64, Deviation)| {
            format!("  step {step}: {position:.3e} m, {velocity:.3e} m/s")
        };
        let heading = "growth of the largest difference:".to_owned();
        std::iter::once(heading).chain(self.points().into_iter().map(line)).collect()
    }

    fn json(&self) -> Value {
        let point = |(step, Deviation { position, velocity })| json!({ "step": step, "position": position, "velocity": velocity });
        if self.samples.is_empty() { Value::Array(Vec::new()) } else { self.points().into_iter().map(point).collect() }
    }
}

/// Returns true for 0, 1, 2, 5, 10, 20, 50, 100 and so on.
fn is_sampled(distance: u64) -> bool {
    let mut power = 1_u64;
    while distance > 5 * power && power < u64::MAX / 50 {
        power *= 10;
    }
    distance == 0 || [power, 2 * power, 5 * power].contains(&distance)
}

/// The last collision of each body, and of all.
#[derive(Default)]
struct LatestCollisions {
    of_bodies: BTreeMap<BodyId, Collision>,
    of_all: Option<Collision>,
    /// The names of all bodies so far.
    names: BTreeMap<BodyId, String>,
    next_id: BodyId,
}

/// Collisions that neither push nor displace are left out: after each collision of the handout solver there is one,
/// when the same two bodies are compared the other way round.
impl Observer for LatestCollisions {
    fn collision(&mut self, collision: &Collision) {
        if collision.impulse == 0.0 && collision.penetration.norm() == 0.0 {
            return;
        }
        for id in collision.bodies {
            self.of_bodies.insert(id, collision.clone());
        }
        self.of_all = Some(collision.clone());
    }
}

impl LatestCollisions {
    /// Takes the names of the bodies alive, to be called after each step.
    fn update_names(&mut self, engine: &Engine) {
        if self.next_id != engine.next_id() {
            self.next_id = engine.next_id();
            self.names.extend(engine.world().bodies.iter().map(|body| (body.id, body.name.clone())));
        }
    }

    /// Returns the last collision of a body, or of all bodies if it has had none.
    fn of(&self, body: Option<BodyId>) -> Option<LatestCollision> {
        let collision = body.and_then(|body| self.of_bodies.get(&body)).or(self.of_all.as_ref())?;
        let name = |id: BodyId| self.names.get(&id).cloned().unwrap_or_else(|| format!("#{id}"));
        Some(LatestCollision { collision: collision.clone(), names: collision.bodies.map(name) })
    }
}

/// A collision with the names of its bodies.
struct LatestCollision {
    collision: Collision,
    names: [String; 2],
}

impl LatestCollision {
    fn text(&self) -> String {
        let Collision { step, normal, penetration, shares, impulse, restitution, .. } = &self.collision;
        let [c, b] = &self.names;
        // Adding 0 turns −0 into 0.
        let (nx, ny) = (normal.x + 0.0, normal.y + 0.0);
        let overlap = match penetration.norm() {
            0.0 => String::new(),
            depth => format!(", penetration {depth:?} m, shares {:?} and {:?}", shares[0], shares[1]),
        };
        let impulse = match *impulse {
            0.0 => "no impulse, because they separate".to_owned(),
            impulse => format!("e {restitution:?}, impulse {impulse:?} N·s"),
        };
        format!("{c:?} with {b:?} in step {step}: normal ({nx:?}, {ny:?}){overlap}, {impulse}")
    }

    fn json(&self) -> Value {
        let Collision { step, instant, normal, penetration, shares, impulse, restitution, .. } = &self.collision;
        json!({
            "step": step, "time": instant, "bodies": self.names, "normal": [normal.x, normal.y],
            "penetration": penetration.norm(), "shares": shares, "e": restitution, "impulse": impulse,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_sampled_at_1_2_5_and_their_decades() {
        let sampled: Vec<u64> = (0..=1000).filter(|distance| is_sampled(*distance)).collect();
        assert_eq!(sampled, [0, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000]);
        assert!(!is_sampled(u64::MAX));
    }
}
