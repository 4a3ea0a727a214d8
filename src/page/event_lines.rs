use crate::EventLine;
use crate::scene_text::retimed;
use rebond::internals::scene::{Action, Input, InputLocation};
use std::ops::Deref;

/// The largest number of events.
pub const MAX_LINES: usize = 100_000;

/// Lines of events in the order of their steps.
#[derive(Clone, Default)]
pub struct EventLines(Vec<EventLine>);

impl Deref for EventLines {
    type Target = [EventLine];

    fn deref(&self) -> &[EventLine] {
        &self.0
    }
}

impl EventLines {
    /// Parses lines as `rebond record --events` reads them. Returns those that are accepted, and messages about the
    /// others.
    pub fn parse(text: &str) -> (EventLines, Vec<String>) {
        let (mut lines, mut refused) = (Vec::new(), Vec::new());
        let mut step = 0;
        for (index, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
            let parsed = EventLine::parse(line, None).or_else(|_| EventLine::parse(line, Some(step + 1)));
            match parsed {
                _ if lines.len() >= MAX_LINES => {
                    refused.push(format!("the page keeps at most {MAX_LINES} events"));
                    break;
                }
                Ok(line) if line.step < step => {
                    let number = index + 1;
                    refused.push(format!("line {number}: its step, {}, is before step {step}", line.step));
                }
                Ok(line) => {
                    step = line.step;
                    lines.push(line);
                }
                Err(error) => refused.push(format!("line {}: {error}", index + 1)),
            }
        }
        (EventLines(lines), refused)
    }

    /// Returns the text of the lines, as `rebond record --events` reads them.
    pub fn text(&self) -> String {
        self.iter().map(|line| line.json() + "\n").collect()
    }

    /// Returns the lines until `step`.
    pub fn until(&self, step: u64) -> EventLines {
        EventLines(self[..self.count_until(step)].to_vec())
    }

    /// Returns the lines of a step as inputs.
    pub fn inputs_at(&self, step: u64) -> Vec<Input> {
        let first = self.count_before(step);
        let input = |(index, line): (usize, &EventLine)| {
            let location = InputLocation::EventLine((first + index) as u64);
            Input { step, action: line.action.clone(), location }
        };
        self[first..self.count_until(step)].iter().enumerate().map(input).collect()
    }

    /// Returns the lines at the same times in seconds, if the rate changes. Lines of different steps stay in different
    /// steps, because the order within a step is another one.
    pub fn retimed(&self, from: f64, to: f64) -> EventLines {
        let mut last: Option<[u64; 2]> = None;
        let retime = |line: &EventLine| {
            let step = match last {
                Some([old, new]) if old == line.step => new,
                Some([_, new]) => retimed(line.step, from, to).max(new + 1),
                None => retimed(line.step, from, to),
            };
            last = Some([line.step, step]);
            EventLine { step, ..line.clone() }
        };
        EventLines(self.iter().map(retime).collect())
    }

    /// Returns the first step in which the lines differ from `others`; the greatest number if they are the same.
    pub fn first_difference(&self, others: &EventLines) -> u64 {
        let same = self.iter().zip(others.iter()).take_while(|(one, other)| one == other).count();
        let step = |lines: &EventLines| lines.get(same).map_or(u64::MAX, |line| line.step);
        step(self).min(step(others))
    }

    /// Adds lines at the end, whose steps must not be before the last one.
    pub fn extend(&mut self, added: Vec<EventLine>) {
        self.0.extend(added);
    }

    /// Removes a line.
    pub fn remove(&mut self, index: usize) {
        self.0.remove(index);
    }

    /// Replaces the lines from `step` on by lines of that step.
    pub fn replace_from(&mut self, step: u64, lines: Vec<EventLine>) {
        self.0.truncate(self.count_before(step));
        self.0.extend(lines);
    }

    /// Adds `spawn`, which spawns the body `name` again. Its step must be the last one.
    pub fn throw(&mut self, name: &str, spawn: EventLine) {
        let step = spawn.step;
        let first = self.count_before(step);
        let lines = &mut self.0;
        let is_own = |line: &EventLine| line.blueprint().is_some_and(|body| body.name.as_deref() == Some(name));
        match lines[first..].iter().position(is_own) {
            // A body of an event in this very step: that event is changed, because deletes come before spawns.
            Some(index) => lines[first + index] = spawn,
            None => {
                let delete = EventLine { step, action: Action::Delete { name: name.to_owned() } };
                if !lines[first..].contains(&delete) {
                    lines.push(delete);
                }
                lines.push(spawn);
            }
        }
    }

    fn count_before(&self, step: u64) -> usize {
        self.partition_point(|line| line.step < step)
    }

    fn count_until(&self, step: u64) -> usize {
        self.partition_point(|line| line.step <= step)
    }
}
