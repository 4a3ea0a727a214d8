use super::{
    Action, Diagnostic, DiagnosticKind, SpawnRequest, Walls,
    action::{self, Request, read_click, read_delete, read_spawn},
    diagnostic::{ErrorReported, Reporter},
    lifetimes::{self, Effect, NameField},
    options::{WALL_NAMES, WorldOptions},
    scatter::{self, MAX_SCATTERED, Scatter},
    tree::{Key, Node, Table},
};
use crate::physics::Rect;
use std::{collections::BTreeMap, ops::Range};

/// An action of a scene on the world at one step.
#[derive(Clone, Debug, PartialEq)]
pub struct Input {
    /// The step of the state that it changes; it is applied before that state is recorded.
    pub step: u64,
    /// The action.
    pub action: Action,
    /// The text that it comes from, for errors that are only found during the run.
    pub location: InputLocation,
}

/// The text that an input comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum InputLocation {
    /// A range of bytes of the scene.
    Scene(Range<usize>),
    /// A line of JSON Lines events, from 1.
    EventLine(u64),
}

const SPAWN: Key = Key { name: "spawn", accepts: "one table [[spawn]] for each body" };
const SCATTER: Key = Key { name: "scatter", accepts: "one table [[scatter]] for each group of random bodies" };
const DELETE: Key = Key { name: "delete", accepts: "one table [[delete]] for each body to delete" };
const CLICK: Key = Key { name: "click", accepts: "one table [[click]] for each click" };

/// The keys of the document that hold events.
pub const KEYS: &[Key] = &[SPAWN, SCATTER, DELETE, CLICK];

/// Reads all inputs of a run, in order. The last step is `None` if it could not be read.
pub fn read(
    root: &Table,
    world: &WorldOptions,
    last: Option<u64>,
    reporter: &Reporter,
) -> Result<Vec<Input>, ErrorReported> {
    let mut reader = Reader {
        last,
        reporter,
        inputs: Vec::new(),
        entries: Vec::new(),
        refused: None,
        occupied: OccupiedRects::default(),
        scattered: 0,
        over_limit: None,
    };
    reader.read_walls(world);
    reader.read_deletes(root);
    reader.read_bodies(root);
    reader.read_clicks(root);
    reader.finish()
}

struct Reader<'a> {
    last: Option<u64>,
    reporter: &'a Reporter,
    inputs: Vec<Input>,
    /// All events, including those with errors, for the check of names.
    entries: Vec<lifetimes::Entry>,
    /// An error of an event, if there is one.
    refused: Option<ErrorReported>,
    occupied: OccupiedRects,
    /// The number of scattered bodies so far.
    scattered: u64,
    /// The error of the first scatter beyond the limit.
    over_limit: Option<ErrorReported>,
}

/// The rectangles of bodies when they are spawned. A scatter must not overlap walls or bodies spawned before it in its
/// step.
#[derive(Default)]
struct OccupiedRects {
    walls: Vec<Rect>,
    by_step: BTreeMap<u64, Vec<Rect>>,
}

impl Reader<'_> {
    fn read_walls(&mut self, world: &WorldOptions) {
        let (walls, span) = match &world.walls {
            Ok(None) => return,
            Ok(Some((walls, span))) => (Some(walls), span.clone()),
            Err(_) => (None, 0..0),
        };
        for name in WALL_NAMES {
            let effect = Effect::Wall { name, is_certain: walls.is_some() };
            self.entries.push(lifetimes::Entry { step: Some(0), span: span.clone(), effect });
        }
        match (walls, world.size) {
            (Some(walls), Ok(size)) => self.add_walls(walls, size, span),
            (None, _) | (_, Err(_)) => {} // The error is that of [world].
        }
    }

    fn add_walls(&mut self, walls: &Walls, size: [f64; 2], span: Range<usize>) {
        for request in walls.spawn_requests(size) {
            self.occupied.walls.push(request.rect());
            let location = InputLocation::Scene(span.clone());
            self.inputs.push(Input { step: 0, action: Action::Wall(request), location });
        }
    }

    fn read_deletes(&mut self, root: &Table) {
        let unreadable = || Effect::Delete { name: None };
        for node in self.tables(root, DELETE, unreadable) {
            let table = Table::open("delete", node, action::DELETE_KEYS, self.reporter);
            self.add(node, table.map(|table| read_delete(&table)), unreadable);
        }
    }

    fn read_clicks(&mut self, root: &Table) {
        let unreadable = || Effect::SpawningClick { name: NameField::Unreadable };
        for node in self.tables(root, CLICK, unreadable) {
            let table = Table::open("click", node, action::CLICK_KEYS, self.reporter);
            self.add(node, table.map(|table| read_click(&table)), unreadable);
        }
    }

    /// Reads the spawns and scatters in the order of the file and expands the scatters to spawns.
    fn read_bodies(&mut self, root: &Table) {
        let unreadable_spawn = || Effect::Spawn { name: NameField::Unreadable, is_infinite: false };
        let unreadable_scatter = || Effect::Scatter { count: None, is_infinite: false };
        let spawns = self.tables(root, SPAWN, unreadable_spawn).iter().map(|node| (node, true));
        let scatters = self.tables(root, SCATTER, unreadable_scatter).iter().map(|node| (node, false));
        let mut nodes: Vec<(&Node, bool)> = spawns.chain(scatters).collect();
        nodes.sort_by_key(|(node, _)| node.span.start);
        for (node, is_spawn) in nodes {
            if is_spawn {
                let table = Table::open("spawn", node, action::SPAWN_KEYS, self.reporter);
                self.add(node, table.map(|table| read_spawn(&table)), unreadable_spawn);
            } else {
                let table = Table::open("scatter", node, scatter::KEYS, self.reporter);
                let request = table
                    .map(|table| scatter::read(&table))
                    .unwrap_or_else(|reported| Request::unreadable(reported, unreadable_scatter(), node.span.clone()));
                self.add_scatter(request);
            }
        }
    }

    /// The tables of `key`. If some cannot be read, an event of unknown step with the effect `unreadable` represents
    /// them.
    fn tables<'a>(&mut self, root: &Table<'a>, key: Key, unreadable: impl Fn() -> Effect) -> &'a [Node] {
        let nodes = root.optional(key, Node::nodes);
        if let Some(reported) = nodes.err().or(root.misspelled_lists(key)) {
            self.refused = Some(reported);
            self.entries.push(lifetimes::Entry { step: None, span: root.span.clone(), effect: unreadable() });
        }
        nodes.ok().flatten().unwrap_or_default()
    }

    /// Adds the event that was read from a table.
    fn add(&mut self, node: &Node, request: Result<Request<Action>, ErrorReported>, unreadable: impl Fn() -> Effect) {
        let Request { step, event, effect, span } =
            request.unwrap_or_else(|reported| Request::unreadable(reported, unreadable(), node.span.clone()));
        let step = self.checked_step(step);
        self.entries.push(lifetimes::Entry { step: step.ok(), span: span.clone(), effect });
        match (step, event) {
            (Ok(step), Ok(action)) => {
                if let Action::Spawn(request) = &action {
                    self.occupied.by_step.entry(step).or_default().push(request.rect());
                }
                self.inputs.push(Input { step, action, location: InputLocation::Scene(span) });
            }
            (Err(reported), _) | (_, Err(reported)) => self.refused = Some(reported),
        }
    }

    fn add_scatter(&mut self, request: Request<Scatter>) {
        let Request { step, event, mut effect, span } = request;
        let step = self.checked_step(step);
        let mut is_over_limit = false;
        if let Effect::Scatter { count, .. } = &mut effect {
            self.scattered += count.unwrap_or(0);
            is_over_limit = self.scattered > MAX_SCATTERED;
            *count = if is_over_limit { None } else { *count };
        }
        let event = match event {
            Ok(scatter) if is_over_limit => Err(self.report_too_many(scatter.count_span)),
            event => event,
        };
        self.entries.push(lifetimes::Entry { step: step.ok(), span: span.clone(), effect });
        match (step, event) {
            (Ok(step), Ok(scatter)) => self.expand(&scatter, step, &span),
            (Err(reported), _) | (_, Err(reported)) => self.refused = Some(reported),
        }
    }

    /// Reports the first scatter beyond the limit.
    fn report_too_many(&mut self, count_span: Range<usize>) -> ErrorReported {
        *self.over_limit.get_or_insert_with(|| {
            let kind = DiagnosticKind::TooMany { what: "scattered bodies", limit: MAX_SCATTERED };
            self.reporter.report(Diagnostic::new(kind, count_span))
        })
    }

    fn expand(&mut self, scatter: &Scatter, step: u64, span: &Range<usize>) {
        let others = self.occupied.walls.iter().chain(self.occupied.by_step.get(&step).into_iter().flatten());
        match scatter.expand(others, self.reporter) {
            Ok(requests) => {
                self.occupied.by_step.entry(step).or_default().extend(requests.iter().map(SpawnRequest::rect));
                let location = InputLocation::Scene(span.clone());
                let input = |request| Input { step, action: Action::Spawn(request), location: location.clone() };
                self.inputs.extend(requests.into_iter().map(input));
            }
            Err(reported) => self.refused = Some(reported),
        }
    }

    /// The step, 0 if none is given, unless it is after the last one.
    fn checked_step(&self, step: Result<Option<(u64, Range<usize>)>, ErrorReported>) -> Result<u64, ErrorReported> {
        match (step?, self.last) {
            (Some((step, span)), Some(last)) if step > last => {
                Err(self.reporter.report(Diagnostic::new(DiagnosticKind::AfterLastStep { step, last }, span)))
            }
            (Some((step, _)), _) => Ok(step),
            (None, _) => Ok(0),
        }
    }

    fn finish(mut self) -> Result<Vec<Input>, ErrorReported> {
        // The sorts are stable: within a step and a kind, events keep the order of the file.
        self.entries.sort_by_key(|entry| (entry.step, entry.effect.phase()));
        lifetimes::check(&self.entries, self.reporter)?;
        self.inputs.sort_by_key(|input| (input.step, input.action.phase()));
        match self.refused {
            Some(reported) => Err(reported),
            None => Ok(self.inputs),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Scene, parse};

    const START: &str = "[world]\nsize = [16.0, 9.0]\n[run]\nrate = 60\nsteps = 10\nsolver = \"handout\"\n";
    const BODY: &str = "at = [1.0, 2.0]\nsize = [1.0, 1.0]\nmass = 2.0";

    fn scene(events: &str) -> Scene {
        parse("test.toml", &format!("{START}{events}")).unwrap_or_else(|error| panic!("{error}"))
    }

    /// A short description of each input, in order.
    fn summary(scene: &Scene) -> Vec<String> {
        let short = |input: &Input| match &input.action {
            Action::Wall(request) => {
                format!("{} wall {}", input.step, request.blueprint.name.as_deref().unwrap_or_default())
            }
            Action::Spawn(request) => {
                format!("{} spawn {}", input.step, request.blueprint.name.as_deref().unwrap_or("-"))
            }
            Action::Delete { name } => format!("{} delete {name}", input.step),
            Action::Click { at, .. } => format!("{} click {}", input.step, at.x),
        };
        scene.inputs.iter().map(short).collect()
    }

    #[test]
    fn within_a_step_deletes_are_before_spawns_before_clicks_in_the_order_of_the_file() {
        let click = |x: u64, step: u64| format!("[[click]]\nstep = {step}\nat = [{x}, 0]\n");
        let spawn = |name: &str, step: u64| format!("[[spawn]]\nname = \"{name}\"\nstep = {step}\n{BODY}\n");
        let scatter =
            "[[scatter]]\nstep = 3\ncount = 2\nregion = [8, 0, 4, 4]\nsize = [[1, 1], [1, 1]]\nmass = [1, 1]\n";
        let delete = "[[delete]]\nstep = 3\nname = \"a\"\n";
        let events = [&click(9, 3), &spawn("b", 3), &click(8, 3), scatter, &spawn("c", 3), delete, &spawn("a", 0)];
        let expected =
            ["0 spawn a", "3 delete a", "3 spawn b", "3 spawn -", "3 spawn -", "3 spawn c", "3 click 9", "3 click 8"];
        assert_eq!(summary(&scene(&events.map(|event| event as &str).concat())), expected);
    }

    #[test]
    fn walls_are_first_and_the_horizontal_ones_cover_the_corners() {
        let text = START.replace("9.0]", "9.0]\nwalls = true\nwall_material = \"steel\"");
        let scene = parse("test.toml", &format!("{text}[[delete]]\nname = \"wall-top\"\n[[spawn]]\n{BODY}\n")).unwrap();
        let expected = [
            "0 wall wall-top",
            "0 wall wall-bottom",
            "0 wall wall-left",
            "0 wall wall-right",
            "0 delete wall-top",
            "0 spawn -",
        ];
        assert_eq!(summary(&scene), expected);
        let rects: Vec<[f64; 4]> = scene.inputs[..4].iter().map(rect).collect();
        let expected = [[-1.0, -1.0, 18.0, 1.0], [-1.0, 9.0, 18.0, 1.0], [-1.0, 0.0, 1.0, 9.0], [16.0, 0.0, 1.0, 9.0]];
        assert_eq!(rects, expected);
    }

    fn rect(input: &Input) -> [f64; 4] {
        let (Action::Wall(request) | Action::Spawn(request)) = &input.action else { panic!("a body") };
        assert_eq!((request.blueprint.mass, request.blueprint.material.as_str()), (f64::INFINITY, "steel"));
        let rect = request.rect();
        [rect.origin.x, rect.origin.y, rect.width(), rect.height()]
    }

    #[test]
    fn a_scatter_overlaps_neither_walls_nor_earlier_bodies_of_its_step() {
        let body = "[[spawn]]\nstep = 4\nat = [0.0, 0.0]\nsize = [3.0, 9.0]\nmass = 1.0\n";
        let scatter = "[[scatter]]\nstep = 4\ncount = 6\nregion = [-1, -1, 6, 6]\nsize = [[0.5, 0.5], [0.5, 0.5]]\nmass = [1, 1]\n";
        let text = START.replace("9.0]", "9.0]\nwalls = true");
        let scene = parse("test.toml", &format!("{text}{body}{scatter}")).unwrap();
        for input in &scene.inputs[5..] {
            let Action::Spawn(request) = &input.action else { panic!("a body") };
            assert!(request.origin.x >= 3.0 && request.origin.y >= 0.0, "{:?}", request.origin);
        }
    }
}
