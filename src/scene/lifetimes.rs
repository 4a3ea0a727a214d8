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
