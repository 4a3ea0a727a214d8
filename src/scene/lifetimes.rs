use std::{collections::BTreeMap, ops::Range};

use super::{Action, Fault, Input, Place, refusal::Refusal};

/// Who is alive as the inputs of a scene are gone through in order.
///
/// What a click does shows only in the run. After one, a body of finite mass may be alive or
/// not, and a click that spawns makes the numbers of later bodies uncertain: what is not
/// certain to be wrong is left to the run.
#[derive(Default)]
struct Lifetimes {
    bodies: BTreeMap<Name, Life>,
    /// How many bodies were spawned, walls not counted.
    spawned: u64,
    clicks: u64,
    numbers_are_certain: bool,
}

/// What a body is called: numbers first, so that messages list them in order.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Name {
    /// The K of `#K`.
    Number(u64),
    Given(String),
}

struct Life {
    /// Where it was asked for.
    place: Range<usize>,
    infinite: bool,
    /// How many clicks there were before it.
    clicks: u64,
    /// False if a click may have spawned it.
    certain: bool,
}

/// How many names a message lists.
const LISTED: usize = 8;

/// Checks that names are free when bodies get them and alive when bodies are deleted.
pub fn check(inputs: &[Input]) -> Result<(), Refusal> {
    let mut lifetimes = Lifetimes { numbers_are_certain: true, ..Lifetimes::default() };
    inputs.iter().try_for_each(|input| lifetimes.go_through(input))
}

impl Lifetimes {
    fn go_through(&mut self, input: &Input) -> Result<(), Refusal> {
        let place = match &input.place {
            Place::Scene(span) => span.clone(),
            Place::Line(_) => 0..0,
        };
        match &input.action {
            Action::Wall(request) => self.spawn(input.step, place, request.name.as_deref(), true),
            Action::Spawn(request) => {
                self.spawned += 1;
                self.spawn(input.step, place, request.name.as_deref(), request.mass == f64::INFINITY)
            }
            Action::Delete { name } => self.delete(input.step, place, name),
            Action::Click { spawn: None, .. } => {
                self.clicks += 1;
                Ok(())
            }
            Action::Click { spawn: Some(blueprint), .. } => {
                self.click_spawning(blueprint.name.as_deref(), place);
                Ok(())
            }
        }
    }

    fn spawn(&mut self, step: u64, place: Range<usize>, name: Option<&str>, infinite: bool) -> Result<(), Refusal> {
        let name = match name {
            Some(name) => Name::Given(name.into()),
            None if self.numbers_are_certain => Name::Number(self.spawned),
            None => return Ok(()),
        };
        if let (Some(life), Name::Given(name)) = (self.bodies.get(&name), &name)
            && self.is_certain(life)
        {
            let fault = Fault::NameTaken { name: name.clone(), step };
            return Err(Refusal::new(fault, place).after(life.place.clone()));
        }
        self.bodies.insert(name, Life { place, infinite, clicks: self.clicks, certain: true });
        Ok(())
    }

    fn delete(&mut self, step: u64, place: Range<usize>, written: &str) -> Result<(), Refusal> {
        let name = Name::read(written);
        let may_be_numbered = matches!(name, Name::Number(_)) && !self.numbers_are_certain;
        if self.bodies.remove(&name).is_some() || may_be_numbered {
            return Ok(());
        }
        let alive = self.bodies.keys().take(LISTED).map(Name::written).collect();
        Err(Refusal::new(Fault::NotAlive { name: written.into(), step, alive }, place))
    }

    /// A click that spawns if it deletes nothing.
    fn click_spawning(&mut self, name: Option<&str>, place: Range<usize>) {
        self.clicks += 1;
        self.numbers_are_certain = false;
        if let Some(name) = name {
            let life = Life { place, infinite: false, clicks: self.clicks, certain: false };
            self.bodies.entry(Name::Given(name.into())).or_insert(life);
        }
    }

    /// Whether a body is sure to be alive still.
    fn is_certain(&self, life: &Life) -> bool {
        life.certain && (life.infinite || life.clicks == self.clicks)
    }
}

impl Name {
    fn read(written: &str) -> Name {
        let number = written.strip_prefix('#').and_then(|digits| digits.parse().ok()).map(Name::Number);
        match number {
            Some(number) if number.written() == written => number,
            Some(_) | None => Name::Given(written.into()),
        }
    }

    fn written(&self) -> String {
        match self {
            Name::Number(number) => format!("#{number}"),
            Name::Given(name) => name.clone(),
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

    /// The fault of a scene of these events, if it has one.
    fn fault(events: &[String]) -> Option<Fault> {
        let error = parse("test.toml", &format!("{START}{}", events.concat())).err()?;
        Some(error.fault().expect("a fault of the scene").clone())
    }

    #[test]
    fn a_name_is_free_again_at_the_step_its_body_goes() {
        assert_eq!(fault(&[spawn(0, A), delete(5, "a"), spawn(5, A), delete(9, "a")]), None);
        let taken = Fault::NameTaken { name: "a".into(), step: 5 };
        assert_eq!(fault(&[spawn(0, A), spawn(5, A), delete(6, "a")]), Some(taken));
    }

    #[test]
    fn bodies_without_a_name_are_numbered_named_ones_counted() {
        let events = [spawn(0, A), spawn(2, "mass = 1.0"), delete(5, "#2")];
        assert_eq!(fault(&events), None);
        let nobody = |name: &str, alive: &[&str]| {
            let alive = alive.iter().map(|name| (*name).into()).collect();
            Some(Fault::NotAlive { name: name.into(), step: 5, alive })
        };
        assert_eq!(fault(&[spawn(0, A), spawn(2, "mass = 1.0"), delete(5, "#1")]), nobody("#1", &["#2", "a"]));
        assert_eq!(fault(&[spawn(2, "mass = 1.0"), delete(5, "#01")]), nobody("#01", &["#1"]));
    }

    #[test]
    fn what_a_click_decides_is_left_to_the_run() {
        assert_eq!(fault(&[spawn(0, A), click(3, ""), spawn(5, A)]), None, "the click may have deleted a");
        assert_eq!(fault(&[spawn(0, A), click(3, ""), delete(5, "a")]), None, "or not");
        assert_eq!(fault(&[click(3, CLICK_A), delete(5, "a")]), None, "the click may have spawned a");
        assert_eq!(fault(&[click(3, CLICK_A), spawn(4, "mass = 1.0"), delete(5, "#1")]), None, "or not");
    }

    #[test]
    fn what_no_click_can_change_is_refused_all_the_same() {
        let infinite = "name = \"a\"\nmass = inf";
        assert!(matches!(fault(&[spawn(0, infinite), click(3, ""), spawn(5, A)]), Some(Fault::NameTaken { .. })));
        assert!(matches!(fault(&[click(3, ""), delete(5, "a")]), Some(Fault::NotAlive { .. })));
        assert!(matches!(fault(&[click(3, CLICK_A), spawn(4, A), spawn(5, A)]), Some(Fault::NameTaken { .. })));
        let twice = [spawn(0, A), click(3, ""), delete(5, "a"), delete(6, "a")];
        assert!(matches!(fault(&twice), Some(Fault::NotAlive { step: 6, .. })));
    }
}
