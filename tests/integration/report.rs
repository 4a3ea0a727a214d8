//! Error against cost: the errors are deterministic and compared with snapshots; costs are not tested.

use crate::{rebond::Workplace, reference_image::assert_reference_image, snapshot::assert_text};
use rebond::internals::picture::png;
use rebond::internals::report::{self, Budget, Case, Expectation, Row, cases};
use std::io::Cursor;

/// The rows of a case at its two lowest rates, without costs.
fn rows(case: &Case) -> Vec<Row> {
    let expectation = Expectation::compute(case);
    let lowest = |factor: &u64| case.factors.iter().take(2).any(|low| low == factor);
    let run_specs = case.run_specs().into_iter().filter(|spec| lowest(&spec.factor));
    run_specs.map(|spec| Row::measure_errors(case, spec, &expectation, Budget::Minutes).unwrap()).collect()
}

#[test]
fn errors_of_the_hard_scenes_are_unchanged() {
    let is_quick = |case: &Case| match case.family.as_str() {
        "galperin" => case.collisions < Some(1000),
        "stack" | "burst" => case.text.len() < 2000,
        "zeno" | "shot" | "cradle" | "corner" | "squeeze" | "tiles" | "support" | "overlap" => true,
        _ => false,
    };
    let all: Vec<Row> = cases::all(Budget::Minutes).iter().filter(|case| is_quick(case)).flat_map(rows).collect();
    assert_text("report-errors", &report::table(&all));
}

#[test]
fn every_hard_scene_parses() {
    for case in cases::all(Budget::Hours).iter().chain(&cases::growth()) {
        let has_many_bodies = case.text.contains("000\nseed");
        let spec = case.run_specs()[0];
        assert!(has_many_bodies || case.scene(spec).is_ok(), "{}: {:?}", case.name, case.scene(spec).err());
        assert!(case.from < case.steps);
    }
}

/// Two boxes that collide once in half a second.
const SCENE: &str = "[world]\nsize = [9.0, 9.0]\n[run]\nrate = 60\nsteps = 30\nsolver = \"handout\"\n\
    [[spawn]]\nat = [1.0, 1.0]\nsize = [1.0, 1.0]\nmass = 1.0\nvelocity = [4.0, 0.0]\n\
    [[spawn]]\nat = [3.0, 1.0]\nsize = [1.0, 1.0]\nmass = 1.0\n";

#[test]
fn a_user_scene_is_compared_with_a_simulation_of_77_decimals() {
    let workplace = Workplace::with_scene(SCENE);
    let output = workplace.done("report scene.toml --json").output;
    let rows: Vec<Row> = serde_json::from_str(&output).unwrap();
    let found: Vec<(&str, f64)> = rows.iter().map(|row| (row.solver.as_str(), row.rate)).collect();
    let rates = [60.0, 240.0, 960.0];
    let expected = ["event-driven", "handout"].into_iter().flat_map(|solver| rates.map(|rate| (solver, rate)));
    assert_eq!(found, expected.collect::<Vec<_>>());
    assert!(rows.iter().all(|row| row.truth == "simulation with 77 decimals" && row.true_collisions == Some(1)));
    assert!(rows[0].position_error < Some(1e-15), "{rows:?}");
    assert!(rows[3].position_error > Some(1e-3), "{rows:?}");
    assert!(rows.iter().all(|row| row.ns_per_body_step > Some(0.0) && row.was_run()));
}

#[test]
fn a_scene_without_moving_bodies_has_no_cost_and_a_later_body_has_one() {
    let workplace = Workplace::with_scene("run.steps = 6\n");
    let body = "[[spawn]]\nstep = 3\nat = [1.0, 1.0]\nsize = [1.0, 1.0]\nmass = 1.0\n";
    workplace.write("later.toml", &format!("run.steps = 6\n{body}"));
    let rows = |scene: &str| -> Vec<Row> {
        serde_json::from_str(&workplace.done(&format!("report {scene} --json")).output).unwrap()
    };
    for row in rows("scene.toml") {
        let remark = row.remark.as_deref().unwrap_or_default();
        assert!(row.ns_per_body_step.is_none() && remark.contains("no body of finite mass takes a step"), "{row:?}");
    }
    assert!(rows("later.toml").iter().all(|row| row.ns_per_body_step > Some(0.0)));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "slow in debug")]
fn the_report_of_any_scene_says_how_rounding_errors_grow() {
    let exhausted = format!("{}/tests/coincident/precision-exhausted.toml", env!("CARGO_MANIFEST_DIR"));
    let resting = format!("{}/recordings/pile.toml", env!("CARGO_MANIFEST_DIR"));
    let workplace = Workplace::with_scene(&std::fs::read_to_string(exhausted).unwrap());
    workplace.write("pile.toml", &std::fs::read_to_string(resting).unwrap());
    let rows: Vec<Row> = serde_json::from_str(&workplace.done("report scene.toml pile.toml --json").output).unwrap();
    let estimated: Vec<&Row> = rows.iter().filter(|row| row.accuracy.is_some()).collect();
    let [exhausted, resting] = estimated[..] else { panic!("one estimate per scene: {estimated:?}") };
    for (row, rate) in [(exhausted, 64.0), (resting, 60.0)] {
        assert!(row.solver == "event-driven" && row.rate == rate, "{row:?}");
        assert!(row.error_growth.is_sorted_by(|a, b| a.0 < b.0 && a.1 <= b.1), "{row:?}");
    }
    workplace.done("record scene.toml -o run.mcap --accuracy");
    let info: serde_json::Value = serde_json::from_str(&workplace.done("info run.mcap --json").output).unwrap();
    assert_eq!(info["accuracy"].as_str(), exhausted.accuracy.as_deref());
    let last = exhausted.error_growth.last().expect("errors grow");
    assert_eq!(exhausted.accuracy, Some(format!("1e-10 until step {}", last.1 - 1)));
    assert_eq!((resting.accuracy.as_deref(), last.0), (Some("1e-10 throughout"), 1e-10));
    let table = workplace.done("report pile.toml").output;
    assert!(table.contains("event-driven: accuracy 1e-10 throughout, estimated by random rounding"), "{table}");
}

#[test]
fn shards_join_to_the_whole_report() {
    let workplace = Workplace::with_scene(SCENE);
    workplace.write("again.toml", SCENE);
    let part = |shard: &str| workplace.done(&format!("report scene.toml again.toml --csv {shard}")).output;
    let whole = part("");
    let parts = part("--shard 1/2") + &part("--shard 2/2");
    let errors = |csv: &str| {
        let fields = csv.lines().map(|line| line.split(',').take(13).map(str::to_owned).collect::<Vec<_>>());
        fields.collect::<Vec<_>>()
    };
    assert_eq!(errors(&whole), errors(&parts));
    assert_eq!(errors(&whole).len(), 1 + 2 * 6);
}

#[test]
fn a_stored_report_is_read_back() {
    let workplace = Workplace::with_scene(SCENE);
    let json = workplace.done("report scene.toml --json").output;
    workplace.write("1.json", &json);
    assert_eq!(workplace.done("report --read 1.json --json").output, json);
    let table = workplace.done("report --read 1.json --read 1.json").output;
    assert!(table.contains("scene.toml: 2 bodies, 1 collision; reference: simulation with 77 decimals"), "{table}");
    workplace.write("2.json", "{}");
    let refused = workplace.rebond("report --read 2.json");
    assert!(
        refused.code == 1 && refused.errors.contains("2.json is not a report written by rebond report --json"),
        "{refused:?}"
    );
    let refused = workplace.rebond("report --only stacks");
    assert!(refused.code == 1 && refused.errors.contains("unknown family of scenes \"stacks\""), "{refused:?}");
    let (_, known) = refused.errors.split_once("known families: ").unwrap();
    let mut known: Vec<&str> = known.trim().split(", ").collect();
    let count = known.len();
    known.sort_unstable();
    known.dedup();
    assert!(known.len() == count && known.contains(&"corner"), "{refused:?}");
}

/// A row with invented costs, so that its diagram is deterministic.
fn row(family: &str, scene: &str, solver: &str, [rate, error, cost]: [f64; 3]) -> Row {
    Row {
        family: family.into(),
        scene: scene.into(),
        solver: solver.into(),
        rate,
        bodies: rate as u64,
        position_error: Some(error),
        collisions: Some(1),
        ns_per_body_step: Some(cost),
        ..Row::default()
    }
}

#[test]
fn a_diagram_shows_error_against_cost() {
    let exact = [[30.0, 2e-15, 90.0], [60.0, 3e-15, 60.0], [240.0, 2e-15, 40.0], [960.0, 2e-15, 35.0]];
    let handout = [[30.0, 0.4, 25.0], [60.0, 0.2, 24.0], [240.0, 0.05, 24.0], [960.0, 0.012, 23.0]];
    let mut rows: Vec<Row> = exact.map(|numbers| row("bounce", "a minute", "event-driven", numbers)).into();
    rows.extend(handout.map(|numbers| row("bounce", "a minute", "handout", numbers)));
    for (scene, factor) in [("stack of 10", 1.0), ("stack of 1000", 9.0)] {
        rows.extend(exact.map(|[rate, _, cost]| row("stack", scene, "event-driven", [rate, 0.0, cost / factor])));
        rows.extend(
            handout.map(|[rate, error, cost]| row("stack", scene, "handout", [rate, factor * error, factor * cost])),
        );
    }
    let workplace = Workplace::new();
    workplace.write("rows.json", &serde_json::to_string(&rows).unwrap());
    workplace.done("report --read rows.json --plot plot.png --caption Invented");
    let (picture, _) = png::decode(Cursor::new(workplace.read("plot.png"))).unwrap();
    assert_reference_image("report-work-precision", &picture);
    workplace.done("report --read rows.json --plot plot.svg --theme dark");
    assert!(String::from_utf8(workplace.read("plot.svg")).unwrap().starts_with("<svg"));
    let refused = workplace.rebond("report --read rows.json --plot plot.gif");
    assert!(refused.code == 2 && refused.errors.contains("expected F.png, F.svg or F.pdf"), "{refused:?}");
    let refused = workplace.rebond("report --read rows.json --plot plot.png");
    assert!(refused.code == 1 && refused.errors.contains("already exists"), "{refused:?}");
}
