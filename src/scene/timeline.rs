use std::{collections::BTreeMap, ops::Range};

use super::{
    Action, Fault, Input, Place,
    action::{Request, read_click, read_delete, read_spawn},
    lifetimes,
    refusal::Refusal,
    scatter::{MOST_SCATTERED, Scatter},
    tree::{Key, Node, Table},
    world_options::WorldOptions,
};
use crate::physics::Rect;

const SPAWN: Key = Key { name: "spawn", accepts: "one table [[spawn]] for each body" };
const SCATTER: Key = Key { name: "scatter", accepts: "one table [[scatter]] for each swarm of bodies" };
const DELETE: Key = Key { name: "delete", accepts: "one table [[delete]] for each body that goes" };
const CLICK: Key = Key { name: "click", accepts: "one table [[click]] for each click" };

/// The keys of the document that make up the timeline.
pub const KEYS: [Key; 4] = [SPAWN, SCATTER, DELETE, CLICK];

/// All that happens in a run of `last` steps, in order.
pub fn read(root: &Table, world: &WorldOptions, last: u64) -> Result<Vec<Input>, Refusal> {
    let mut inputs = Vec::new();
    if let Some((walls, place)) = &world.walls {
        let wall = |request| Input { step: 0, action: Action::Wall(request), place: Place::Scene(place.clone()) };
        inputs.extend(walls.requests(world.size).map(wall));
    }
    for node in tables(root, DELETE)? {
        inputs.push(input(read_delete(node)?, last)?);
    }
    read_bodies(root, last, &mut inputs)?;
    for node in tables(root, CLICK)? {
        inputs.push(input(read_click(node)?, last)?);
    }
    // A stable sort: what ties stays in the order of the file.
    inputs.sort_by_key(|input| (input.step, rank(&input.action)));
    lifetimes::check(&inputs)?;
    Ok(inputs)
}

/// The order of what happens within one step.
const fn rank(action: &Action) -> u8 {
    match action {
        Action::Wall(_) => 0,
        Action::Delete { .. } => 1,
        Action::Spawn(_) => 2,
        Action::Click { .. } => 3,
    }
}

fn tables<'a>(root: &Table<'a>, key: Key) -> Result<&'a [Node], Refusal> {
    Ok(root.optional(key, Node::nodes)?.unwrap_or_default())
}

fn input(request: Request, last: u64) -> Result<Input, Refusal> {
    let Request { step, action, place } = request;
    Ok(Input { step: within(step, last)?, action, place: Place::Scene(place) })
}

/// The step, 0 if none is named, unless it lies after the last.
fn within(step: Option<(u64, Range<usize>)>, last: u64) -> Result<u64, Refusal> {
    match step {
        Some((step, place)) if step > last => Err(Refusal::new(Fault::AfterLastStep { step, last }, place)),
        Some((step, _)) => Ok(step),
        None => Ok(0),
    }
}

/// The spawns and scatters in the order of the file, scatters made into spawns.
fn read_bodies(root: &Table, last: u64, inputs: &mut Vec<Input>) -> Result<(), Refusal> {
    let spawns = tables(root, SPAWN)?.iter().map(|node| (node, Kind::Spawn));
    let scatters = tables(root, SCATTER)?.iter().map(|node| (node, Kind::Scatter));
    let mut nodes: Vec<(&Node, Kind)> = spawns.chain(scatters).collect();
    nodes.sort_by_key(|(node, _)| node.span.start);

    let mut crowd = Crowd::of(inputs);
    for (node, kind) in nodes {
        let from = inputs.len();
        match kind {
            Kind::Spawn => inputs.push(input(read_spawn(node)?, last)?),
            Kind::Scatter => crowd.scatter(Scatter::read(node)?, last, inputs)?,
        }
        crowd.add(&inputs[from..]);
    }
    Ok(())
}

enum Kind {
    Spawn,
    Scatter,
}

/// Where bodies stand when they come into being: what a scatter keeps clear of.
struct Crowd {
    walls: Vec<Rect>,
    by_step: BTreeMap<u64, Vec<Rect>>,
    scattered: u64,
}

impl Crowd {
    /// The walls among `inputs`.
    fn of(inputs: &[Input]) -> Crowd {
        let mut crowd = Crowd { walls: Vec::new(), by_step: BTreeMap::new(), scattered: 0 };
        crowd.add(inputs);
        crowd
    }

    fn add(&mut self, inputs: &[Input]) {
        for input in inputs {
            match &input.action {
                Action::Wall(request) => self.walls.push(request.rect),
                Action::Spawn(request) => self.by_step.entry(input.step).or_default().push(request.rect),
                Action::Delete { .. } | Action::Click { .. } => {}
            }
        }
    }

    fn scatter(&mut self, scatter: Scatter, last: u64, inputs: &mut Vec<Input>) -> Result<(), Refusal> {
        self.scattered += scatter.count;
        if self.scattered > MOST_SCATTERED {
            let fault = Fault::TooMany { what: "scattered bodies", limit: MOST_SCATTERED };
            return Err(Refusal::new(fault, scatter.count_span));
        }
        let step = within(scatter.step.clone(), last)?;
        let others = self.walls.iter().chain(self.by_step.get(&step).into_iter().flatten());
        let place = Place::Scene(scatter.place.clone());
        let input = |request| Input { step, action: Action::Spawn(request), place: place.clone() };
        inputs.extend(scatter.expand(others)?.into_iter().map(input));
        Ok(())
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

    /// What happens, in order, in short.
    fn happenings(scene: &Scene) -> Vec<String> {
        let short = |input: &Input| match &input.action {
            Action::Wall(request) => format!("{} wall {}", input.step, request.name.as_deref().unwrap_or_default()),
            Action::Spawn(request) => format!("{} spawn {}", input.step, request.name.as_deref().unwrap_or("-")),
            Action::Delete { name } => format!("{} delete {name}", input.step),
            Action::Click { at, .. } => format!("{} click {}", input.step, at.x),
        };
        scene.inputs.iter().map(short).collect()
    }

    #[test]
    fn steps_go_up_and_within_one_deletes_spawns_and_clicks_stand_as_in_the_file() {
        let click = |x: u64, step: u64| format!("[[click]]\nstep = {step}\nat = [{x}, 0]\n");
        let spawn = |name: &str, step: u64| format!("[[spawn]]\nname = \"{name}\"\nstep = {step}\n{BODY}\n");
        let scatter =
            "[[scatter]]\nstep = 3\ncount = 2\nregion = [8, 0, 4, 4]\nsize = [[1, 1], [1, 1]]\nmass = [1, 1]\n";
        let delete = "[[delete]]\nstep = 3\nname = \"a\"\n";
        let events = [&click(9, 3), &spawn("b", 3), &click(8, 3), scatter, &spawn("c", 3), delete, &spawn("a", 0)];
        let expected =
            ["0 spawn a", "3 delete a", "3 spawn b", "3 spawn -", "3 spawn -", "3 spawn c", "3 click 9", "3 click 8"];
        assert_eq!(happenings(&scene(&events.map(|event| event as &str).concat())), expected);
    }

    #[test]
    fn walls_come_first_and_reach_over_the_corners() {
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
        assert_eq!(happenings(&scene), expected);
        let rects: Vec<[f64; 4]> = scene.inputs[..4].iter().map(rect).collect();
        let expected = [[-1.0, -1.0, 18.0, 1.0], [-1.0, 9.0, 18.0, 1.0], [-1.0, 0.0, 1.0, 9.0], [16.0, 0.0, 1.0, 9.0]];
        assert_eq!(rects, expected);
    }

    fn rect(input: &Input) -> [f64; 4] {
        let (Action::Wall(request) | Action::Spawn(request)) = &input.action else { panic!("a body") };
        assert_eq!((request.mass, request.material.as_str()), (f64::INFINITY, "steel"));
        let rect = request.rect;
        [rect.origin.x, rect.origin.y, rect.width(), rect.height()]
    }

    #[test]
    fn a_scatter_keeps_clear_of_walls_and_of_what_stands_before_it_at_its_step() {
        let body = "[[spawn]]\nstep = 4\nat = [0.0, 0.0]\nsize = [3.0, 9.0]\nmass = 1.0\n";
        let scatter = "[[scatter]]\nstep = 4\ncount = 6\nregion = [-1, -1, 6, 6]\nsize = [[0.5, 0.5], [0.5, 0.5]]\nmass = [1, 1]\n";
        let text = START.replace("9.0]", "9.0]\nwalls = true");
        let scene = parse("test.toml", &format!("{text}{body}{scatter}")).unwrap();
        for input in &scene.inputs[5..] {
            let Action::Spawn(request) = &input.action else { panic!("a body") };
            assert!(request.rect.origin.x >= 3.0 && request.rect.origin.y >= 0.0, "{:?}", request.rect);
        }
    }
}
