//! Parameter studies: `--set` of all commands, recordings that exist, and tables of many recordings.

use crate::command_line::SCENE;
use crate::rebond::{Outcome, Workplace};
use serde_json::Value;
use std::process::{Command, Stdio};

/// Runs `rebond` with arguments that contain spaces.
fn run(workplace: &Workplace, arguments: &[&str]) -> Outcome {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rebond"));
    let output = command.args(arguments).current_dir(workplace.path(".")).env("NO_COLOR", "1").output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
    Outcome { code: output.status.code().unwrap_or(-1), output: text(output.stdout), errors: text(output.stderr) }
}

fn json_lines(text: &str) -> Vec<Value> {
    text.lines().map(|line| serde_json::from_str(line).unwrap_or_else(|error| panic!("{error}: {line}"))).collect()
}

#[test]
fn a_recording_has_the_values_that_were_set() {
    let workplace = Workplace::with_scene(SCENE);
    workplace
        .done("record scene.toml -o run.mcap --set restitution.steel/steel=0.25 --set spawn.c.mass=inf --set title=7");
    let [info] = &json_lines(&workplace.done("info run.mcap --json").output)[..] else { panic!("one line") };
    assert_eq!(info["set"], serde_json::json!({"restitution.steel/steel": 0.25, "spawn.c.mass": "inf", "title": "7"}));
    assert_eq!((&info["title"], &info["live_events"]), (&"7".into(), &false.into()));
    let text = workplace.done("info run.mcap").output;
    assert!(text.contains("\nset: restitution.steel/steel=0.25, spawn.c.mass=inf, title=7\n"), "{text}");
    // The same scene without --set has the same states and another identity.
    workplace.write("plain.toml", &SCENE.replace("0.95", "0.25"));
    workplace.done("record plain.toml -o plain.mcap");
    workplace.done("record scene.toml -o set.mcap --set restitution.steel/steel=0.25");
    assert_eq!(workplace.done("export plain.mcap").output, workplace.done("export set.mcap").output);
    workplace.done("record scene.toml -o live.mcap --events plain.toml --lenient");
    assert_eq!(json_lines(&workplace.done("info live.mcap --json").output)[0]["live_events"], true);
    assert_eq!(workplace.done("replay set.mcap").output, "same: 90 steps, 7 bodies\n");
}

#[test]
fn every_command_that_takes_a_scene_takes_values_for_it() {
    let workplace = Workplace::with_scene(SCENE);
    workplace.done("record scene.toml -o heavy.mcap --set spawn.c.mass=20");
    workplace.done("render scene.toml --set spawn.c.mass=20 --at 40 -o scene.png");
    workplace.done("render heavy.mcap --at 40 -o recording.png");
    assert!(workplace.read("scene.png") == workplace.read("recording.png"));
    workplace.done("figure energy scene.toml --set spawn.c.mass=20 -o scene.svg");
    workplace.done("figure energy heavy.mcap -o recording.svg");
    assert!(workplace.read("scene.svg") == workplace.read("recording.svg"));
    let [scene, recording] = ["scene.toml --set spawn.c.mass=20", "heavy.mcap"]
        .map(|source| workplace.done(&format!("export --table energy {source}")).output);
    assert_eq!(scene, recording);
    let tiny = "run.steps = 5\n[[spawn]]\nname = \"c\"\nat = [1.0, 1.0]\nsize = [1.0, 1.0]\nmass = 1.0\n";
    workplace.write("tiny.toml", tiny);
    let report = workplace.done("report tiny.toml --set run.steps=2 --csv").output;
    assert!(report.contains("tiny.toml run.steps=2"), "{report}");
}

#[test]
fn several_values_are_several_sources() {
    let workplace = Workplace::with_scene(SCENE);
    let sweep = "restitution.default=[0.3 | 0.9]";
    let outcome =
        run(&workplace, &["export", "scene.toml", "--table", "energy", "--set", sweep, "--set", "spawn.c.mass=[1|2]"]);
    assert_eq!(outcome.code, 0, "{outcome:?}");
    let mut rows = outcome.output.lines();
    assert_eq!(rows.next(), Some("source,restitution.default,spawn.c.mass,step,time,kinetic,potential,total,px,py"));
    let mut runs: Vec<String> = rows.map(|row| row.split(',').take(3).collect::<Vec<&str>>().join(",")).collect();
    runs.dedup();
    assert_eq!(runs, ["scene.toml,0.3,1.0", "scene.toml,0.3,2.0", "scene.toml,0.9,1.0", "scene.toml,0.9,2.0"]);
    let drawn = run(&workplace, &["figure", "energy", "scene.toml", "--set", sweep, "-o", "two.svg"]);
    assert_eq!(drawn.code, 0, "{drawn:?}");
    let info = workplace.done("info two.svg").output;
    assert!(
        info.contains("A small run, restitution.default = 0.3") && info.contains("restitution.default = 0.9"),
        "{info}"
    );
    let animated = run(&workplace, &["render", "scene.toml", "--set", sweep, "-o", "two.gif"]);
    assert_eq!(animated.code, 0, "{animated:?}");
    let refused = run(&workplace, &["record", "scene.toml", "-o", "x.mcap", "--set", sweep]);
    assert!(refused.code == 2 && refused.errors.contains("give one value"), "{refused:?}");
    assert_eq!(workplace.names(), ["scene.toml", "two.gif", "two.svg"]);
}

#[test]
fn values_that_cannot_be_set_are_refused() {
    let workplace = Workplace::with_scene(SCENE);
    workplace.done("record scene.toml -o run.mcap");
    for (line, message) in [
        ("export run.mcap --set run.steps=2", "--set changes scenes, and run.mcap is a recording"),
        ("render run.mcap --set run.steps=2 -o x.gif", "--set changes scenes, and run.mcap is a recording"),
        ("export scene.toml --set run.steps=2 --set run.steps=3", "run.steps is set twice"),
        ("record scene.toml --set run.steps=2 --set run.steps=3 -o x.mcap", "`run.steps` is given twice"),
        ("record scene.toml --set spawn.mass=2 -o x.mcap", "there is no [[spawn]] \"mass\""),
        ("record scene.toml --set restitution.defualt=2 -o x.mcap", "did you mean `default`?"),
    ] {
        let outcome = workplace.rebond(line);
        assert!(outcome.code == 1 && outcome.errors.contains(message), "{line}: {outcome:?}");
    }
    assert_eq!(workplace.names(), ["run.mcap", "scene.toml"]);
}

#[test]
fn one_of_several_processes_records_the_run_and_the_others_skip_it() {
    let workplace = Workplace::with_scene(SCENE);
    let line = "record scene.toml -o run.mcap --steps 20000 --skip-existing";
    let started: Vec<_> = (0..3).map(|_| workplace.start(line, Stdio::null(), Stdio::piped())).collect();
    let ended: Vec<_> = started.into_iter().map(|process| process.wait_with_output().unwrap()).collect();
    assert!(ended.iter().all(|output| output.status.success()), "{ended:?}");
    let skipped = ended.iter().filter(|output| String::from_utf8_lossy(&output.stdout).contains(": skipped, "));
    assert_eq!(skipped.count(), 2, "{ended:?}");
    assert_eq!(workplace.names(), ["run.mcap", "scene.toml"]);
}

#[test]
fn an_existing_recording_of_the_run_is_kept_and_a_part_of_it_replaced() {
    let workplace = Workplace::with_scene(SCENE);
    let line = "record scene.toml -o run.mcap --set spawn.c.mass=3 --skip-existing";
    workplace.done(line);
    let whole = workplace.read("run.mcap");
    let modified = || std::fs::metadata(workplace.path("run.mcap")).unwrap().modified().unwrap();
    let before = modified();
    let skipped = workplace.done(line).output;
    assert!(skipped.starts_with("run.mcap: skipped, it has this run, identity "), "{skipped}");
    assert_eq!(modified(), before);
    let summary: Value = serde_json::from_str(&workplace.done(&format!("{line} --json")).output).unwrap();
    assert_eq!(summary["steps"], 90);
    for part in [whole.len() * 2 / 3, whole.len() - 1] {
        std::fs::write(workplace.path("run.mcap"), &whole[..part]).unwrap();
        workplace.done(line);
        assert!(workplace.read("run.mcap") == whole, "{part} bytes");
    }
    for (other, difference) in [
        ("record scene.toml -o run.mcap --skip-existing", "values of --set: spawn.c.mass=3 recorded, none asked for"),
        (&format!("{line} --steps 80"), "steps: 90 recorded, 80 asked for"),
        (&format!("{line} --every 2"), "--every: 1 recorded, 2 asked for"),
        (&format!("{line} --viewer"), "it was recorded without --viewer"),
    ] {
        let refused = workplace.rebond(other);
        assert!(refused.code == 1 && refused.errors.contains(difference), "{other}: {refused:?}");
        assert!(workplace.read("run.mcap") == whole, "{other}");
    }
    workplace.write("scene.toml", &SCENE.replace("4.5", "5.5"));
    assert!(workplace.rebond(line).errors.contains("its scene has another text"));
    workplace.done(&format!("{line} --force"));
    assert!(workplace.read("run.mcap") != whole);
    assert_eq!(workplace.rebond(&format!("{line} --events x.jsonl")).code, 2);
}

#[test]
fn the_recordings_of_a_folder_are_one_table() {
    let workplace = Workplace::with_scene(SCENE);
    std::fs::create_dir(workplace.path("study")).unwrap();
    for (name, set) in [("b", "--set spawn.c.mass=3"), ("a", "--set run.solver=event-driven"), ("c", "")] {
        workplace.done(&format!("record scene.toml -o study/{name}.mcap {set}"));
    }
    let table = workplace.done("export study --table energy --to 0").output;
    let rows: Vec<&str> = table.lines().collect();
    assert_eq!(rows[0], "source,run.solver,spawn.c.mass,step,time,kinetic,potential,total,px,py");
    assert!(rows[1].starts_with("study/a.mcap,event-driven,,0,0.0,"), "{table}");
    assert!(rows[2].starts_with("study/b.mcap,,3.0,0,0.0,") && rows[3].starts_with("study/c.mcap,,,0,0.0,"), "{table}");
    let text = workplace.done("info study --json").output;
    let infos = json_lines(&text);
    assert_eq!(infos.len(), 3);
    for (info, name) in infos.iter().zip(["study/a.mcap", "study/b.mcap", "study/c.mcap"]) {
        assert_eq!((&info["file"], &info["duration"]), (&name.into(), &1.5.into()));
        assert!(info["collisions"].is_u64());
        let energy = workplace.done(&format!("export {name} --table energy")).output;
        let rows: Vec<Vec<&str>> = energy.lines().skip(1).map(|row| row.split(',').collect()).collect();
        for (row, at) in [(&rows[0], "start"), (&rows[90], "end")] {
            // As text: reading JSON may lose the last bit.
            let number = |key: &str, text: &str| format!("\"{key}_{at}\":{text},");
            for expected in [number("kinetic", row[2]), number("potential", row[3]), number("total", row[4])] {
                assert!(text.contains(&expected), "{expected}: {text}");
            }
        }
    }
    std::fs::create_dir(workplace.path("empty")).unwrap();
    assert!(workplace.rebond("info empty").errors.contains("the folder empty has no recordings (*.mcap)"));
}

#[test]
fn a_table_for_plotting_is_no_recording_of_its_folder() {
    let workplace = Workplace::with_scene(SCENE);
    workplace.done("record scene.toml -o scene.mcap");
    let commands = ["check .", "info .", "export ."];
    let before = commands.map(|command| workplace.done(command).output);
    workplace.done("export scene.mcap -o plot.mcap");
    assert_eq!(commands.map(|command| workplace.done(command).output), before);
    for command in
        ["check plot.mcap", "info plot.mcap", "export plot.mcap", "replay plot.mcap", "render plot.mcap -o plot.gif"]
    {
        let refused = workplace.rebond(command);
        let text = format!("{}{}", refused.output, refused.errors);
        let is_named = text.contains("a table for plotting, written by rebond export, not a recording; use ");
        assert!(refused.code == 1 && is_named, "{command}: {refused:?}");
    }
}

#[test]
fn a_scene_may_come_from_standard_input() {
    let workplace = Workplace::with_scene(SCENE);
    let outcome = workplace.rebond_with_input("record - -o run.mcap --set spawn.c.mass=3", SCENE);
    assert_eq!(outcome.code, 0, "{outcome:?}");
    workplace.done("record scene.toml -o file.mcap --set spawn.c.mass=3");
    assert_eq!(workplace.done("export run.mcap").output, workplace.done("export file.mcap").output);
    assert!(workplace.done("info run.mcap").output.contains("scene: stdin.toml\n"));
    let refused = workplace.rebond_with_input("record - -o x.mcap --events -", SCENE);
    assert!(refused.code == 1 && refused.errors.contains("cannot both come from standard input"), "{refused:?}");
}

#[test]
fn a_click_that_changes_nothing_is_reported() {
    let clicks = "[[click]]\nstep = 5\nat = [7.5, 0.5]\n[[click]]\nstep = 5\nat = [1.5, 1.5]\n";
    let workplace = Workplace::with_scene(&format!("{SCENE}{clicks}").replace("[figure]\nsize = [320, 180]\n", ""));
    let message = "the click at step 5 on the point (7.5, 0.5) changes nothing: \
                   there is no body of finite mass, and the click has no spawn\n";
    assert_eq!(workplace.done("record scene.toml -o run.mcap").errors, message);
    assert!(workplace.done("export scene.toml -o run.csv").errors.contains(message));
    let live = "{\"click\": {\"step\": 6, \"at\": [0.25, 0.25]}}\n";
    let outcome = workplace.rebond_with_input("record scene.toml -o live.mcap --events -", live);
    assert!(outcome.errors.starts_with("2 clicks change nothing, the first one at step 5"), "{outcome:?}");
}

#[test]
fn a_value_for_a_material_that_no_body_has_is_reported() {
    let workplace = Workplace::with_scene(SCENE);
    let message = "--set restitution.stel/steel=0.95 changes nothing: no body has the material \"stel\"\n";
    assert_eq!(workplace.done("record scene.toml -o a.mcap --set restitution.stel/steel=0.95").errors, message);
    assert!(workplace.done("export scene.toml -o a.csv --set restitution.stel/steel=0.95").errors.contains(message));
    let used = workplace.done("record scene.toml -o b.mcap --set restitution.steel/steel=0.5");
    assert_eq!(used.errors, "");
    // The events of a live run may have it.
    let live =
        workplace.rebond_with_input("record scene.toml -o c.mcap --events - --set restitution.stel/steel=0.95", "");
    assert_eq!((live.code, live.errors.as_str()), (0, ""));
}

#[test]
fn the_array_script_of_the_guide_is_the_one_that_is_tried() {
    let [guide, script] = [include_str!("../../src/guide/studies.md"), include_str!("../studies/slurm.sh")];
    assert!(guide.contains(script));
}
