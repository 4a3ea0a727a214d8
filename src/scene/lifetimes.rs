//! Checks that a spawned body's name is not in use, and that a deleted body is alive.

use super::{
    Diagnostic, DiagnosticKind, Phase,
    diagnostic::{ErrorReported, Reporter},
};
use std::{
    collections::{BTreeMap, BTreeSet},
    ops::Range,
};

/// The step of an event and its effect on the names in use, as far as they are known.
pub struct Entry {
    /// The step; `None` if it could not be read.
    pub step: Option<u64>,
    /// The text to underline.
    pub span: Range<usize>,
    pub effect: Effect,
}

/// The effect of an event on the names in use.
pub enum Effect {
    Wall {
        name: &'static str,
        /// False if the key `walls` could not be read.
        is_certain: bool,
    },
    Spawn {
        name: NameField,
        is_infinite: bool,
    },
    /// Spawns of bodies without a name; `None` if their number is not known.
    Scatter {
        count: Option<u64>,
        is_infinite: bool,
    },
    /// A delete; `None` if the name could not be read.
    Delete {
        name: Option<String>,
    },
    /// A click that spawns nothing.
    Click,
    /// A click that spawns a body if it deletes none.
    SpawningClick {
        name: NameField,
    },
}

impl Effect {
    /// The phase of the action of the event.
    pub const fn phase(&self) -> Phase {
        match self {
            Effect::Wall { .. } => Phase::Walls,
            Effect::Delete { .. } => Phase::Deletes,
            Effect::Spawn { .. } | Effect::Scatter { .. } => Phase::Spawns,
            Effect::Click | Effect::SpawningClick { .. } => Phase::Clicks,
        }
    }
}

/// The name of a body to spawn.
pub enum NameField {
    Given(String),
    Absent,
    /// There is a name that could not be read, or a key that may be a misspelling of `name`.
    Unreadable,
}

/// The names in use while the events are checked in order.
///
/// The effect of a click is known only during the run: after it, a body of finite mass may be alive or
/// not, and a click that spawns makes the numbers of later bodies uncertain. Likewise, an event with
/// an error may spawn or delete bodies once the error is corrected. Only certain errors are reported:
/// those of clicks are left to the run, and those that follow from another error vanish with it.
struct Lifetimes<'a> {
    bodies: BTreeMap<Name, Lifetime>,
    /// The number of bodies spawned so far, without walls.
    spawned: u64,
    /// The number of clicks so far.
    clicks: u64,
    numbers_are_certain: bool,
    /// Events with errors, which may take effect at any step.
    uncertain: Uncertain,
    reporter: &'a Reporter,
}

/// The names that events with errors may spawn or delete at any step.
#[derive(Default)]
struct Uncertain {
    spawned: BTreeSet<String>,
    deleted: BTreeSet<String>,
    may_spawn_any_name: bool,
    may_delete_any_name: bool,
    /// A click may delete a body of finite mass at any step.
    may_click: bool,
}

/// The name of a body; numbers are first, so that messages list them in order.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Name {
    /// The K of `#K`.
    Number(u64),
    Given(String),
}

struct Lifetime {
    /// The text of the spawn.
    span: Range<usize>,
    is_infinite: bool,
    /// The number of clicks before the spawn.
    clicks: u64,
    /// False if it is not certain that the body was spawned.
    is_certain: bool,
}

/// The number of names that a message lists.
const MAX_LISTED: usize = 8;

/// Reports spawns of names in use and deletes of bodies that are not alive. `entries` must be in the order of the run.
pub fn check(entries: &[Entry], reporter: &Reporter) -> Result<(), ErrorReported> {
    let mut lifetimes = Lifetimes {
        bodies: BTreeMap::new(),
        spawned: 0,
        clicks: 0,
        numbers_are_certain: true,
        uncertain: Uncertain::default(),
        reporter,
    };
    for entry in entries.iter().filter(|entry| entry.step.is_none()) {
        lifetimes.allow_at_any_step(&entry.effect);
    }
    let mut refused = Ok(());
    for entry in entries {
        if let Some(step) = entry.step
            && let Err(reported) = lifetimes.apply(step, entry)
        {
            refused = Err(reported);
        }
    }
    refused
}

impl Lifetimes<'_> {
    /// Allows for an event of unknown step, which may take effect at any step.
    fn allow_at_any_step(&mut self, effect: &Effect) {
        match effect {
            Effect::Wall { name, .. } => {
                self.uncertain.spawned.insert((*name).into());
            }
            Effect::Spawn { name, .. } => {
                self.numbers_are_certain = false;
                self.uncertain.spawn(name);
            }
            Effect::Scatter { .. } => self.numbers_are_certain = false,
            Effect::Delete { name: Some(name) } => {
                self.uncertain.deleted.insert(name.clone());
            }
            Effect::Delete { name: None } => self.uncertain.may_delete_any_name = true,
            Effect::Click => self.uncertain.may_click = true,
            Effect::SpawningClick { name } => {
                self.numbers_are_certain = false;
                self.uncertain.may_click = true;
                self.uncertain.spawn(name);
            }
        }
    }

    fn apply(&mut self, step: u64, entry: &Entry) -> Result<(), ErrorReported> {
        let span = &entry.span;
        match &entry.effect {
            Effect::Wall { name, is_certain } => {
                let lifetime = Lifetime { is_infinite: true, is_certain: *is_certain, ..self.lifetime(span) };
                self.spawn(step, Name::Given((*name).into()), lifetime)
            }
            Effect::Spawn { name, is_infinite } => {
                self.spawned += 1;
                let lifetime = Lifetime { is_infinite: *is_infinite, ..self.lifetime(span) };
                match name {
                    NameField::Given(name) => self.spawn(step, Name::Given(name.clone()), lifetime),
                    NameField::Absent => self.spawn_numbered(step, lifetime),
                    NameField::Unreadable => {
                        self.uncertain.may_spawn_any_name = true;
                        self.spawn_numbered(step, Lifetime { is_certain: false, ..lifetime })
                    }
                }
            }
            Effect::Scatter { count: Some(count), is_infinite } => (0..*count).try_for_each(|_| {
                self.spawned += 1;
                self.spawn_numbered(step, Lifetime { is_infinite: *is_infinite, ..self.lifetime(span) })
            }),
            Effect::Scatter { count: None, .. } => {
                self.numbers_are_certain = false;
                Ok(())
            }
            Effect::Delete { name: Some(name) } => self.delete(step, span, name),
            Effect::Delete { name: None } => {
                self.uncertain.may_delete_any_name = true;
                Ok(())
            }
            Effect::Click => {
                self.clicks += 1;
                Ok(())
            }
            Effect::SpawningClick { name } => {
                self.click_and_spawn(name, span);
                Ok(())
            }
        }
    }

    /// Returns the lifetime of a finite body that is certainly spawned now.
    fn lifetime(&self, span: &Range<usize>) -> Lifetime {
        Lifetime { span: span.clone(), is_infinite: false, clicks: self.clicks, is_certain: true }
    }

    fn spawn_numbered(&mut self, step: u64, lifetime: Lifetime) -> Result<(), ErrorReported> {
        if !self.numbers_are_certain {
            return Ok(());
        }
        self.spawn(step, Name::Number(self.spawned), lifetime)
    }

    fn spawn(&mut self, step: u64, name: Name, lifetime: Lifetime) -> Result<(), ErrorReported> {
        if let (Some(earlier), Name::Given(name)) = (self.bodies.get(&name), &name)
            && self.is_certainly_alive(name, earlier)
        {
            let kind = DiagnosticKind::NameTaken { name: name.clone(), step };
            let diagnostic = Diagnostic::new(kind, lifetime.span).conflicting_with(earlier.span.clone());
            // A later delete of that name may be meant for this body.
            self.uncertain.spawned.insert(name.clone());
            return Err(self.reporter.report(diagnostic));
        }
        self.bodies.insert(name, lifetime);
        Ok(())
    }

    fn delete(&mut self, step: u64, span: &Range<usize>, written: &str) -> Result<(), ErrorReported> {
        let name = Name::parse(written);
        let may_be_alive = match &name {
            Name::Number(_) => !self.numbers_are_certain,
            Name::Given(name) => self.uncertain.may_spawn_any_name || self.uncertain.spawned.contains(name),
        };
        if self.bodies.remove(&name).is_some() || may_be_alive {
            return Ok(());
        }
        let alive = self.bodies.keys().take(MAX_LISTED).map(Name::to_string).collect();
        let kind = DiagnosticKind::NotAlive { name: written.into(), step, alive };
        Err(self.reporter.report(Diagnostic::new(kind, span.clone())))
    }

    fn click_and_spawn(&mut self, name: &NameField, span: &Range<usize>) {
        self.clicks += 1;
        self.numbers_are_certain = false;
        match name {
            NameField::Given(name) => {
                let lifetime = Lifetime { is_certain: false, ..self.lifetime(span) };
                self.bodies.entry(Name::Given(name.clone())).or_insert(lifetime);
            }
            NameField::Absent => {}
            NameField::Unreadable => self.uncertain.may_spawn_any_name = true,
        }
    }

    fn is_certainly_alive(&self, name: &str, lifetime: &Lifetime) -> bool {
        let may_be_clicked = self.uncertain.may_click || lifetime.clicks != self.clicks;
        let may_be_deleted = self.uncertain.may_delete_any_name || self.uncertain.deleted.contains(name);
        lifetime.is_certain && (lifetime.is_infinite || !may_be_clicked) && !may_be_deleted
    }
}

impl Uncertain {
    fn spawn(&mut self, name: &NameField) {
        match name {
            NameField::Given(name) => {
                self.spawned.insert(name.clone());
            }
            NameField::Absent => {}
            NameField::Unreadable => self.may_spawn_any_name = true,
        }
    }
}

impl From<&Result<Option<String>, ErrorReported>> for NameField {
    fn from(name: &Result<Option<String>, ErrorReported>) -> NameField {
        match name {
            Ok(Some(name)) => NameField::Given(name.clone()),
            Ok(None) => NameField::Absent,
            Err(_) => NameField::Unreadable,
        }
    }
}

impl Name {
    /// Parses a name as written; only the canonical form `#K` is a number.
    fn parse(written: &str) -> Name {
        let number = written.strip_prefix('#').and_then(|digits| digits.parse().ok()).map(Name::Number);
        match number {
            Some(number) if number.to_string() == written => number,
            Some(_) | None => Name::Given(written.into()),
        }
    }
}

impl std::fmt::Display for Name {
    fn fmt(&self, out: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Name::Number(number) => write!(out, "#{number}"),
            Name::Given(name) => out.write_str(name),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::parse;

    const START: &str = "[world]\nsize = [16.0, 9.0]\n[run]\nrate = 60\nsteps = 10\nsolver = \"handout\"\n";

    fn spawn(step: u64, keys: &str) -> String {
        format!("[[spawn]]\nstep = {step}\nat = [1.0, 2.0]\nsize = [1.0, 1.0]\n{keys}\n")
    }

    fn delete(step: u64, name: &str) -> String {
        format!("[[delete]]\nstep = {step}\nname = \"{name}\"\n")
    }

    fn click(step: u64, spawn: &str) -> String {
        format!("[[click]]\nstep = {step}\nat = [1.0, 2.0]\n{spawn}\n")
    }

    const A: &str = "name = \"a\"\nmass = 1.0";
    const CLICK_A: &str = "spawn = { name = \"a\", size = [1.0, 1.0], mass = 1.0 }";

    /// The errors of a scene with these events.
    fn errors(events: &[String]) -> Vec<DiagnosticKind> {
        match parse("test.toml", &format!("{START}{}", events.concat())) {
            Ok(_) => Vec::new(),
            Err(error) => {
                let diagnostics = error.diagnostics().expect("errors of the text");
                diagnostics.listed().map(|diagnostic| diagnostic.kind.clone()).collect()
            }
        }
    }

    /// The only error of a scene with these events, if it has one.
    fn error(events: &[String]) -> Option<DiagnosticKind> {
        let mut errors = errors(events);
        assert!(errors.len() <= 1, "{errors:?}");
        errors.pop()
    }

    #[test]
    fn a_name_is_free_from_the_step_of_its_delete() {
        assert_eq!(error(&[spawn(0, A), delete(5, "a"), spawn(5, A), delete(9, "a")]), None);
        let taken = DiagnosticKind::NameTaken { name: "a".into(), step: 5 };
        assert_eq!(error(&[spawn(0, A), spawn(5, A), delete(6, "a")]), Some(taken));
    }

    #[test]
    fn the_numbers_of_bodies_without_a_name_count_all_bodies() {
        let events = [spawn(0, A), spawn(2, "mass = 1.0"), delete(5, "#2")];
        assert_eq!(error(&events), None);
        let not_alive = |name: &str, alive: &[&str]| {
            let alive = alive.iter().map(|name| (*name).into()).collect();
            Some(DiagnosticKind::NotAlive { name: name.into(), step: 5, alive })
        };
        assert_eq!(error(&[spawn(0, A), spawn(2, "mass = 1.0"), delete(5, "#1")]), not_alive("#1", &["#2", "a"]));
        assert_eq!(error(&[spawn(2, "mass = 1.0"), delete(5, "#01")]), not_alive("#01", &["#1"]));
    }

    #[test]
    fn names_that_depend_on_a_click_are_left_to_the_run() {
        assert_eq!(error(&[spawn(0, A), click(3, ""), spawn(5, A)]), None, "the click may have deleted a");
        assert_eq!(error(&[spawn(0, A), click(3, ""), delete(5, "a")]), None, "or not");
        assert_eq!(error(&[click(3, CLICK_A), delete(5, "a")]), None, "the click may have spawned a");
        assert_eq!(error(&[click(3, CLICK_A), spawn(4, "mass = 1.0"), delete(5, "#1")]), None, "or not");
    }

    #[test]
    fn names_that_no_click_can_change_are_checked_after_a_click() {
        let infinite = "name = \"a\"\nmass = inf";
        assert!(matches!(
            error(&[spawn(0, infinite), click(3, ""), spawn(5, A)]),
            Some(DiagnosticKind::NameTaken { .. })
        ));
        assert!(matches!(error(&[click(3, ""), delete(5, "a")]), Some(DiagnosticKind::NotAlive { .. })));
        assert!(matches!(
            error(&[click(3, CLICK_A), spawn(4, A), spawn(5, A)]),
            Some(DiagnosticKind::NameTaken { .. })
        ));
        let twice = [spawn(0, A), click(3, ""), delete(5, "a"), delete(6, "a")];
        assert!(matches!(error(&twice), Some(DiagnosticKind::NotAlive { step: 6, .. })));
    }

    #[test]
    fn a_delete_of_a_refused_spawn_is_not_an_error() {
        let is_mass =
            |kind: &DiagnosticKind| matches!(kind, DiagnosticKind::InvalidValue { key, .. } if key == "spawn.mass");
        let bad_mass = errors(&[spawn(0, "name = \"a\"\nmass = -1.0"), delete(5, "a")]);
        assert!(matches!(&bad_mass[..], [mass] if is_mass(mass)), "{bad_mass:?}");
        let bad_name = errors(&[spawn(0, "nmae = \"a\"\nmass = 1.0"), delete(5, "a")]);
        assert!(matches!(&bad_name[..], [DiagnosticKind::UnknownKey { .. }]), "{bad_name:?}");
        let bad_table = errors(&[spawn(0, A).replace("[[spawn]]", "[[spwan]]"), delete(5, "a")]);
        assert!(matches!(&bad_table[..], [DiagnosticKind::UnknownKey { .. }]), "{bad_table:?}");
        let late = errors(&[spawn(11, A), delete(5, "a"), delete(5, "#1")]);
        assert!(matches!(&late[..], [DiagnosticKind::AfterLastStep { .. }]), "{late:?}");
    }

    #[test]
    fn a_spawn_after_a_refused_delete_is_not_an_error() {
        let bad_name = format!("{}\n", delete(3, "a").replace("name", "nam"));
        let errors = errors(&[spawn(0, A), bad_name, spawn(5, A)]);
        assert!(matches!(&errors[..], [DiagnosticKind::UnknownKey { .. }]), "{errors:?}");
    }

    #[test]
    fn errors_that_do_not_depend_on_a_refused_event_are_reported() {
        let errors =
            errors(&[spawn(0, "name = \"b\"\nmass = -1.0"), spawn(0, A), spawn(5, A), delete(6, "c"), delete(7, "#4")]);
        let names: Vec<&str> = errors
            .iter()
            .filter_map(|kind| match kind {
                DiagnosticKind::NameTaken { name, .. } | DiagnosticKind::NotAlive { name, .. } => Some(name.as_str()),
                _ => None,
            })
            .collect();
        assert_eq!((errors.len(), names), (4, vec!["a", "c", "#4"]));
    }
}
