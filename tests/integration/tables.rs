//! The tables that `rebond export` writes.

use crate::command_line::{SCENE, recorded};
use crate::rebond::Workplace;

#[test]
fn an_exported_range_equals_that_part_of_the_whole_table() {
    let workplace = recorded();
    let whole = workplace.done("export run.mcap").output;
    for from in [0, 1, 45, 59, 60, 61, 90] {
        let part = workplace.done(&format!("export run.mcap --from {from}")).output;
        let step = |row: &&str| row.split(',').next().and_then(|step| step.parse::<u64>().ok());
        let expected: Vec<&str> = whole.lines().skip(1).filter(|row| step(row) >= Some(from)).collect();
        assert_eq!(part.lines().skip(1).collect::<Vec<&str>>(), expected, "from {from}");
    }
}

#[test]
fn a_folder_with_one_recording_is_exported_as_topics() {
    let workplace = recorded();
    std::fs::create_dir(workplace.path("one")).unwrap();
    std::fs::copy(workplace.path("run.mcap"), workplace.path("one/run.mcap")).unwrap();
    workplace.done("export one -o folder.mcap");
    workplace.done("export run.mcap -o file.mcap");
    assert_eq!(workplace.read("folder.mcap"), workplace.read("file.mcap"));
    std::fs::copy(workplace.path("run.mcap"), workplace.path("one/second.mcap")).unwrap();
    let refused = workplace.rebond("export one -o two.mcap");
    assert!(refused.code == 2 && refused.errors.contains("states of one source"), "{refused:?}");
}

#[test]
fn a_body_that_is_deleted_when_it_is_spawned_has_a_row() {
    let click = "[[click]]\nat = [8.0, 5.0]\n";
    let spawn = "spawn = { name = \"brief\", size = [0.1, 0.1], mass = 1.0 }\n";
    let scene = format!("{SCENE}{click}{spawn}{click}");
    let workplace = Workplace::with_scene(&scene);
    let has_row = |options: &str| {
        workplace.done(&format!("export scene.toml --table bodies {options}")).output.contains("\nbrief,")
    };
    assert!(has_row("") && has_row("--from 0 --to 0") && !has_row("--from 1"));
}

#[test]
fn a_table_with_names_that_end_with_a_space_is_compared_with_its_recording() {
    let body = |name: &str, x: f64| {
        format!("[[spawn]]\nname = \"{name}\"\nat = [{x:?}, 1.0]\nsize = [0.5, 0.5]\nmass = 1.0\n")
    };
    let workplace = Workplace::with_scene(&format!("[run]\nsteps = 3\n{}{}", body("a", 1.0), body("a ", 3.0)));
    workplace.done("record scene.toml -o run.mcap");
    workplace.done("export run.mcap -o run.csv");
    assert!(workplace.done("replay run.mcap --against run.csv").output.starts_with("same: 4 states, 2 bodies"));
}

#[test]
fn a_range_of_times_selects_collisions_by_their_instant() {
    let body = |name: &str, x: f64, speed: f64| {
        format!(
            "[[spawn]]\nname = \"{name}\"\nat = [{x:?}, 4.0]\nsize = [1.0, 1.0]\nmass = 1.0\n\
             velocity = [{speed:?}, 0.0]\n"
        )
    };
    // At one step per second, each step has several collisions.
    let bouncing = format!(
        "run = {{ duration = 6.0, rate = 1.0 }}\nworld = {{ walls = true, size = [10.0, 10.0] }}\n{}",
        body("ball", 0.0, 40.0)
    );
    let workplace = Workplace::with_scene(&bouncing);
    // Two bodies that touch after half a second, which is the time of state 30.
    workplace.write("pair.toml", &format!("run.duration = 2.0\n{}{}", body("a", 1.0, 4.0), body("b", 4.0, 0.0)));
    let times = |line: &str| -> Vec<f64> {
        let table = workplace.done(&format!("export {line} --table collisions")).output;
        table.lines().skip(1).map(|row| row.split(',').next().unwrap().parse().unwrap()).collect()
    };
    let all = times("scene.toml");
    for range in [0.0..=2.0, 2.25..=3.15, 0.45..=0.9, 5.8..=6.0] {
        let expected: Vec<f64> = all.iter().copied().filter(|time| range.contains(time)).collect();
        let (from, to) = (range.start(), range.end());
        assert_eq!(times(&format!("scene.toml --from {from}s --to {to}s")), expected, "{range:?}");
        assert!(!expected.is_empty(), "{range:?}");
    }
    assert_eq!((times("pair.toml --from 0.5s"), times("pair.toml --to 0.5s")), (vec![0.5], vec![0.5]));
    assert_eq!((times("pair.toml --from 30"), times("pair.toml --to 29")), (vec![], vec![0.5]));
    workplace.done("figure collision pair.toml --step 0.5s -o pair.svg");
    assert_eq!(workplace.rebond("figure collision pair.toml --step 0.51s -o late.svg").code, 1);
    let ambiguous = workplace.rebond("figure collision scene.toml --step 2.5s --pair ball,wall-left -o ball.svg");
    assert!(ambiguous.code == 1 && ambiguous.errors.contains("is not their first one in step 2"), "{ambiguous:?}");
}

/// The rows of a CSV table as columns by name. No field of these tests is quoted.
fn columns(table: &str) -> std::collections::BTreeMap<String, Vec<String>> {
    let mut lines = table.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<String>>());
    let names = lines.next().unwrap();
    let rows: Vec<Vec<String>> = lines.collect();
    names.into_iter().enumerate().map(|(at, name)| (name, rows.iter().map(|row| row[at].clone()).collect())).collect()
}

#[test]
fn the_energy_table_is_computed_from_the_states_and_has_no_potential_without_force() {
    let workplace = recorded();
    let states = columns(&workplace.done("export run.mcap").output);
    let energy = columns(&workplace.done("export run.mcap --table energy").output);
    let masses = columns(&workplace.done("export run.mcap --table bodies").output);
    assert_eq!(energy["step"].len(), 91);
    let number = |text: &String| text.parse::<f64>().unwrap();
    let mass =
        |name: &String| number(&masses["mass"][masses["name"].iter().position(|listed| listed == name).unwrap()]);
    for (row, step) in energy["step"].iter().enumerate() {
        let bodies = (0..states["step"].len()).filter(|&at| states["step"][at] == *step);
        let (mut kinetic, mut px) = (0.0, 0.0);
        for at in bodies.filter(|&at| mass(&states["name"][at]).is_finite()) {
            let [vx, vy] = [number(&states["vx"][at]), number(&states["vy"][at])];
            kinetic += 0.5 * mass(&states["name"][at]) * (vx * vx + vy * vy);
            px += vx * mass(&states["name"][at]);
        }
        assert_eq!((number(&energy["kinetic"][row]), number(&energy["px"][row])), (kinetic, px), "step {step}");
        assert_eq!(number(&energy["total"][row]), kinetic + number(&energy["potential"][row]), "step {step}");
    }
    assert!(energy["potential"].iter().any(|potential| number(potential) < 0.0), "the scene has gravity");
    workplace.write("free.toml", &SCENE.replace("gravity = [0.0, 9.81]\n", ""));
    let free = columns(&workplace.done("export free.toml --table energy").output);
    assert!(free["potential"].iter().all(|potential| potential == "0.0"), "{:?}", free["potential"]);
}

#[test]
fn the_collision_table_explains_every_change_of_velocity() {
    let workplace = Workplace::with_scene(
        &SCENE
            .replace("gravity = [0.0, 9.81]\n", "")
            .replace("handout", "event-driven")
            .replace("steps = 90", "steps = 900"),
    );
    workplace.done("record scene.toml -o run.mcap");
    let collisions = columns(&workplace.done("export run.mcap --table collisions").output);
    let states = columns(&workplace.done("export run.mcap").output);
    let number = |text: &String| text.parse::<f64>().unwrap();
    assert!(collisions["time"].len() > 3);
    let rows = 0..collisions["time"].len();
    for row in rows.clone() {
        let of = |column: &str| number(&collisions[column][row]);
        assert!(
            (of("vn_after") + of("e") * of("vn_before")).abs() < 1e-12 && of("vn_before") < 0.0 && of("impulse") > 0.0
        );
        assert_eq!(of("nx").abs() + of("ny").abs(), 1.0);
        assert_eq!(collisions["axis"][row], if of("nx") != 0.0 { "x" } else { "y" });
    }
    // Without forces only impulses change the momentum of c: j·n̂ where c is the first body, −j·n̂ where it is the second.
    let momentum = |step: &str| {
        let at = (0..states["step"].len()).find(|&at| states["step"][at] == step && states["name"][at] == "c").unwrap();
        [2.0 * number(&states["vx"][at]), 2.0 * number(&states["vy"][at])]
    };
    let mut expected = momentum("0");
    for row in rows {
        let sign = if collisions["a"][row] == "c" { 1.0 } else { -1.0 };
        if [&collisions["a"][row], &collisions["b"][row]].into_iter().any(|name| name == "c") {
            expected[0] += sign * number(&collisions["impulse"][row]) * number(&collisions["nx"][row]);
            expected[1] += sign * number(&collisions["impulse"][row]) * number(&collisions["ny"][row]);
        }
    }
    let last = momentum("900");
    assert!((0..2).all(|at| (last[at] - expected[at]).abs() < 1e-12), "{last:?} {expected:?}");
    let part = workplace.done("export run.mcap --table collisions --from 100 --to 700").output;
    let steps = columns(&part).remove("step").unwrap();
    assert!(!steps.is_empty() && steps.iter().all(|step| (100..=700).contains(&step.parse::<u64>().unwrap())));
}

#[test]
fn a_table_of_several_sources_names_the_source_of_each_row() {
    let workplace = recorded();
    for table in ["states", "collisions", "energy", "bodies"] {
        let one = workplace.done(&format!("export run.mcap --table {table}")).output;
        let two = workplace.done(&format!("export run.mcap scene.toml --table {table}")).output;
        let (header, rows) = one.split_once('\n').unwrap();
        let named = |source: &str| rows.lines().map(|row| format!("{source},{row}\n")).collect::<String>();
        assert_eq!(two, format!("source,{header}\n{}{}", named("run.mcap"), named("scene.toml")), "{table}");
        let json = workplace.done(&format!("export run.mcap --table {table} --force -o table.jsonl"));
        assert!(json.output.is_empty());
        let lines = String::from_utf8(workplace.read("table.jsonl")).unwrap();
        let keys: Vec<&str> = header.split(',').collect();
        assert_eq!(lines.lines().count(), rows.lines().count());
        for line in lines.lines() {
            let object: serde_json::Map<String, serde_json::Value> = serde_json::from_str(line).unwrap();
            assert!(keys.iter().all(|key| object.contains_key(*key)) && object.len() == keys.len(), "{line}");
        }
    }
    let bodies = columns(&workplace.done("export run.mcap --table bodies").output);
    let late = bodies["name"].iter().position(|name| name == "late").unwrap();
    assert_eq!([&bodies["spawned_step"][late], &bodies["deleted_step"][late]], ["30", "60"]);
    assert_eq!((bodies["mass"][0].as_str(), bodies["color"][4].as_str()), ("inf", "#3366cc"));
    assert_eq!(workplace.rebond("export run.mcap scene.toml --shard 1/2").code, 2);
}
