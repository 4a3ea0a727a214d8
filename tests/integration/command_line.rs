//! The commands of the README, on a small scene.

use crate::rebond::Workplace;
use crate::snapshot::assert_text;

/// A scene with everything that a recording can contain: walls, gravity, materials, a spawn and a delete.
pub const SCENE: &str = r##"title = "A small run"
[world]
size = [8.0, 4.5]
walls = true
wall_material = "steel"
gravity = [0.0, 9.81]
[run]
rate = 60
steps = 90
solver = "handout"
[restitution]
default = 0.5
"steel/steel" = 0.95
[[spawn]]
name = "c"
at = [1.0, 1.0]
size = [1.0, 1.0]
mass = 2.0
velocity = [3.0, 0.0]
material = "steel"
color = "#3366cc"
[[spawn]]
at = [5.0, 2.0]
size = [0.5, 0.75]
mass = 1.0
[[spawn]]
step = 30
name = "late"
at = [3.0, 0.25]
size = [0.5, 0.5]
mass = 1.0
[[delete]]
step = 60
name = "late"
[figure]
size = [320, 180]
"##;

/// The folder with the scene and its recording `run.mcap`.
pub fn recorded() -> Workplace {
    let workplace = Workplace::with_scene(SCENE);
    workplace.done("record scene.toml -o run.mcap");
    workplace
}

#[test]
fn record_prints_a_summary() {
    let workplace = Workplace::with_scene(SCENE);
    let outcome = workplace.done("record scene.toml -o run.mcap");
    assert_text("record", &outcome.output);
    assert_eq!(outcome.errors, "", "no progress bar in a pipe");
    assert_eq!(workplace.names(), ["run.mcap", "scene.toml"]);
}

#[test]
fn two_recordings_of_a_scene_have_the_same_bytes() {
    let workplace = recorded();
    workplace.done("record scene.toml -o again.mcap");
    assert!(workplace.read("run.mcap") == workplace.read("again.mcap"));
    workplace.done("record scene.toml -o -");
}

#[test]
fn a_recording_on_standard_output_has_the_same_bytes() {
    let workplace = recorded();
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_rebond"))
        .args(["record", "scene.toml", "-o", "-"])
        .current_dir(workplace.path("."))
        .output()
        .unwrap();
    assert!(output.stdout == workplace.read("run.mcap"));
}

#[test]
fn replay_prints_the_verdict_last() {
    let outcome = recorded().done("replay run.mcap");
    assert_eq!(outcome.output.lines().last(), Some("same: 90 steps, 7 bodies"));
    assert_eq!(outcome.errors, "");
}

#[test]
fn a_thinned_recording_replays_the_same() {
    let workplace = recorded();
    workplace.done("record scene.toml -o thin.mcap --every 10 --steps 85");
    let outcome = workplace.done("replay thin.mcap");
    assert_eq!(outcome.output.lines().last(), Some("same: 85 steps, 7 bodies"));
    let rows = workplace.done("export thin.mcap").output;
    let mut steps: Vec<&str> = rows.lines().skip(1).filter_map(|row| row.split(',').next()).collect();
    steps.dedup();
    assert_eq!(steps, ["0", "10", "20", "30", "40", "50", "60", "70", "80"]);
    assert!(workplace.read("thin.mcap").len() < workplace.read("run.mcap").len());
}

#[test]
fn export_writes_one_row_per_body_and_step() {
    let workplace = recorded();
    let outcome = workplace.done("export run.mcap --from 29 --to 31");
    assert_text("export", &outcome.output);
    workplace.done("export run.mcap -o table.jsonl --from 29 --to 31");
    assert_text("export-json-lines", &String::from_utf8(workplace.read("table.jsonl")).unwrap());
    workplace.done("export run.mcap -o table.csv --from 29 --to 31");
    assert_eq!(workplace.read("table.csv"), outcome.output.as_bytes());
}

#[test]
fn info_prints_one_value_per_line() {
    let workplace = recorded();
    assert_text("info", &workplace.done("info run.mcap").output);
    let json = workplace.done("info run.mcap --json").output;
    assert_text("info-json", &json);
    let value: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(value["steps"], 90);
}

#[test]
fn a_single_picture_of_a_scene_simulates_it_once() {
    let workplace = Workplace::with_scene(SCENE);
    for line in ["render scene.toml --at 30 -o still.png", "figure strobe scene.toml -o strobe.svg"] {
        let outcome = workplace.done(line);
        assert_eq!(outcome.errors, "", "{line}");
    }
    // It is the picture of the recording.
    workplace.done("record scene.toml -o run.mcap");
    workplace.done("render run.mcap --at 30 -o recorded.png");
    assert_eq!(workplace.read("still.png"), workplace.read("recorded.png"));
}

#[test]
fn a_picture_of_too_many_instants_is_refused_with_a_sufficient_interval() {
    let workplace = Workplace::with_scene(SCENE);
    workplace.done("record scene.toml -o run.mcap --steps 1000");
    for kind in ["strobe", "filmstrip"] {
        let refused = workplace.rebond(&format!("figure {kind} run.mcap --every 1 -o {kind}.svg"));
        assert_eq!(refused.code, 1, "{refused:?}");
        assert!(refused.errors.contains("1001 instants") && refused.errors.contains("--every 4"), "{refused:?}");
        workplace.done(&format!("figure {kind} run.mcap --every 100 -o {kind}.svg"));
    }
    workplace.done("figure strobe run.mcap --every 4 -o all.svg");
}

#[test]
fn a_rendered_gif_has_the_duration_of_the_run() {
    let workplace = Workplace::with_scene(SCENE);
    let outcome = workplace.done("render scene.toml -o run.gif");
    assert!(outcome.errors.contains("same: 90 steps, 7 bodies"), "{outcome:?}");
    assert_eq!(workplace.names(), ["run.gif", "scene.toml"]);
    let file = workplace.read("run.gif");
    let mut decoder = gif::DecodeOptions::new().read_info(&file[..]).unwrap();
    let mut hundredths = 0;
    let mut frames = 0;
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        hundredths += u32::from(frame.delay);
        frames += 1;
    }
    assert_eq!((frames, hundredths), (46, 153), "steps 0, 2, … 90, each shown for two steps");
}

#[test]
fn an_animation_of_a_thinned_recording_shows_every_recorded_state() {
    let workplace = Workplace::with_scene(SCENE);
    workplace.done("record scene.toml -o thin.mcap --every 10");
    for name in ["thin.gif", "thin.apng"] {
        let outcome = workplace.done(&format!("render thin.mcap -o {name}"));
        assert!(outcome.output.contains("every 10th step"), "{outcome:?}");
    }
    let file = workplace.read("thin.gif");
    let mut decoder = gif::DecodeOptions::new().read_info(&file[..]).unwrap();
    let mut delays = Vec::new();
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        delays.push(u32::from(frame.delay));
    }
    assert_eq!((delays.len(), delays.iter().sum::<u32>()), (10, 167));
}

#[test]
fn a_recording_and_its_scene_give_the_same_pictures() {
    let workplace = recorded();
    workplace.done("render scene.toml -o of-scene.gif --show velocity,name,clock");
    workplace.done("render run.mcap -o of-recording.gif --show velocity,name,clock --jobs 1");
    assert!(workplace.read("of-scene.gif") == workplace.read("of-recording.gif"));
}

#[test]
fn parts_of_a_sequence_have_the_same_bytes_as_the_whole() {
    let workplace = recorded();
    workplace.done("render run.mcap -o whole --every 10 --show trail,normal,penetration,grid,clock");
    workplace.done("render run.mcap -o parts --every 10 --to 44 --show trail,normal,penetration,grid,clock");
    workplace.done("render run.mcap -o parts --every 10 --from 45 --show trail,normal,penetration,grid,clock");
    for step in (0..=90).step_by(10) {
        let [whole, part] = ["whole", "parts"].map(|folder| workplace.read(&format!("{folder}/{step:06}.png")));
        assert!(whole == part, "step {step}");
    }
    workplace.done("render run.mcap -o one.png --at 40 --show trail,normal,penetration,grid,clock");
}

#[test]
fn completions_contain_the_commands() {
    for shell in ["bash", "zsh", "fish"] {
        let script = Workplace::new().done(&format!("completions {shell}")).output;
        assert!(script.contains("replay") && script.contains("theme"), "{shell}");
    }
}

#[test]
fn there_is_a_manual_page_for_each_command() {
    let workplace = Workplace::new();
    workplace.done("man man1");
    let page = String::from_utf8(workplace.read("man1/rebond-render.1")).unwrap();
    assert!(page.contains(".TH rebond-render 1") && page.contains(".nf\nOUT is .gif, .apng"), "{page}");
    assert!(workplace.path("man1/rebond.1").exists() && workplace.path("man1/rebond-check.1").exists());
    assert_eq!(workplace.rebond("man man1").code, 1, "existing pages are not overwritten");
    workplace.done("man man1 --force");
}

#[test]
fn quiet_prints_only_results_and_errors() {
    let workplace = Workplace::with_scene(SCENE);
    for line in
        ["--quiet record scene.toml -o run.mcap", "render -q run.mcap -o run.gif", "-q render scene.toml -o a.gif"]
    {
        let outcome = workplace.done(line);
        assert_eq!((outcome.output.as_str(), outcome.errors.as_str()), ("", ""), "{line}");
    }
    let object = workplace.done("record -q --json scene.toml -o again.mcap").output;
    assert!(object.starts_with("{\"path\":\"again.mcap\""), "{object}");
    assert_eq!(workplace.done("replay run.mcap --quiet").output, "same: 90 steps, 7 bodies\n");
    assert!(workplace.rebond("replay none.mcap --quiet").errors.contains("none.mcap"));
}

#[test]
fn json_output_can_be_parsed() {
    let workplace = Workplace::with_scene(SCENE);
    let json = |line: &str| -> serde_json::Value { serde_json::from_str(&workplace.rebond(line).output).unwrap() };
    let recorded = json("record scene.toml -o run.mcap --json");
    assert_eq!((recorded["steps"].as_u64(), recorded["path"].as_str()), (Some(90), Some("run.mcap")));
    let verdict = json("replay run.mcap --json");
    assert_eq!((verdict["verdict"].as_str(), verdict["same_steps"].as_u64()), (Some("same"), Some(90)));
    let bytes = workplace.read("run.mcap");
    std::fs::write(workplace.path("cut.mcap"), &bytes[..bytes.len() * 2 / 3]).unwrap();
    assert_eq!(json("replay cut.mcap --json")["verdict"], "incomplete");
}

/// Colours are used only on terminals, even if NO_COLOR is not set.
#[test]
fn output_to_a_pipe_has_no_colours() {
    let workplace = Workplace::with_scene(&SCENE.replace("rate = 60", "rate = 0"));
    for line in ["record scene.toml -o a.mcap", "--help", "render --helb", "check ."] {
        let output = std::process::Command::new(env!("CARGO_BIN_EXE_rebond"))
            .args(line.split(' '))
            .current_dir(workplace.path("."))
            .env_remove("NO_COLOR")
            .output()
            .unwrap();
        assert!(!output.stdout.contains(&0x1b) && !output.stderr.contains(&0x1b), "{line}");
    }
}

#[test]
fn help_has_examples_and_fits_on_a_screen() {
    let workplace = Workplace::new();
    let mut all = workplace.done_in("80", "--help").output;
    for command in
        ["record", "replay", "render", "figure", "export", "info", "check", "recover", "report", "completions", "man"]
    {
        let help = workplace.done_in("80", &format!("{command} --help")).output;
        assert!(help.contains("Example"), "{command}");
        assert!(help.lines().count() <= 41, "{command}: {} lines", help.lines().count());
        all += &format!("\n$ rebond {command} --help\n{help}");
    }
    assert_text("help", &all);
    assert_eq!(workplace.done("help").output, workplace.done("--help").output);
    assert_eq!(workplace.done("help record").output, workplace.done("record --help").output);
}

#[test]
fn recover_keeps_the_readable_part_which_replays_the_same() {
    let workplace = recorded();
    workplace.done("recover run.mcap -o whole.mcap");
    assert!(
        workplace.read("run.mcap") == workplace.read("whole.mcap"),
        "recovering a complete recording changes nothing"
    );
    let bytes = workplace.read("run.mcap");
    std::fs::write(workplace.path("cut.mcap"), &bytes[..bytes.len() * 2 / 3]).unwrap();
    let recovered = workplace.rebond("recover cut.mcap -o fixed.mcap");
    assert_eq!(recovered.code, 4, "{recovered:?}");
    let report = recovered.output;
    assert!(report.starts_with("recovered ") && report.contains("lost"), "{report}");
    let verdict = workplace.rebond("replay fixed.mcap");
    assert!(verdict.output.lines().last().unwrap().contains("same"), "{verdict:?}");
}

/// Everything can be read, because bytes only follow the end.
#[test]
fn recovering_from_damage_never_succeeds_silently() {
    let workplace = recorded();
    let mut bytes = workplace.read("run.mcap");
    bytes.extend(b"more");
    std::fs::write(workplace.path("long.mcap"), bytes).unwrap();
    for quiet in ["", " -q"] {
        let recovered = workplace.rebond(&format!("recover long.mcap -o fixed.mcap --force{quiet}"));
        assert_eq!(recovered.code, 4, "{recovered:?}");
        let report = if quiet.is_empty() { recovered.output } else { recovered.errors };
        assert!(report.starts_with("recovered 91 states") && report.contains("first damage: "), "{report}");
    }
}

#[test]
fn a_range_that_the_run_never_had_is_refused() {
    let workplace = recorded();
    workplace.done("record scene.toml -o thin.mcap --steps 89 --every 10");
    workplace.write(
        "short.toml",
        "run.steps = 20\n[[spawn]]\nname = \"c\"\nat = [1.0, 1.0]\nsize = [1.0, 1.0]\nmass = 1.0\n",
    );
    workplace.done("record short.toml -o short.mcap");
    workplace.done("export run.mcap -o table.csv");
    let names = workplace.names();
    for (range, reason) in [
        ("run.mcap --from 91", "there is no state from step 91 on: the recording has the steps 0 to 90"),
        ("scene.toml --from 2s --to 3s", "there is no state in the steps 120 to 180"),
        ("run.mcap --from 3 --to 2", "no step is in the range --from 3 --to 2; exchange the two"),
        ("run.mcap --from 1.001s --to 1s", "no step is in the range --from 1.001s --to 1s"),
    ] {
        for table in ["states", "collisions", "energy", "bodies"] {
            for output in ["", " -o new.csv"] {
                let refused = workplace.rebond(&format!("export {range} --table {table}{output}"));
                let is_clear = refused.output.is_empty() && refused.errors.contains(reason);
                assert!(refused.code == 1 && is_clear, "{range} {table}: {refused:?}");
            }
        }
        assert_eq!(workplace.rebond(&format!("export {range} -o new.mcap")).code, 1, "{range}");
    }
    let thin = workplace.rebond("export thin.mcap --from 3 --to 5 -o new.csv");
    assert!(thin.code == 1 && thin.errors.contains("has no full state in the steps 3 to 5"), "{thin:?}");
    for command in [
        "replay run.mcap",
        "replay run.mcap --against table.csv",
        "render run.mcap -o new.gif",
        "render run.mcap -o frames/",
        "figure strobe run.mcap -o new.svg",
        "figure energy run.mcap -o new.svg",
    ] {
        for range in ["--from 6 --to 5", "--from 1s --to 6"] {
            let refused = workplace.rebond(&format!("{command} {range}"));
            let message = format!("no step is in the range {range}; exchange the two");
            assert!(refused.code == 1 && refused.errors.contains(&message), "{command} {range}: {refused:?}");
        }
    }
    for (command, message) in [
        (
            "render run.mcap -o new.gif --from 5 --to 5",
            "only multiples of 2 are drawn, counted from step 0, and step 5",
        ),
        ("render run.mcap -o new.apng --from 5 --to 5", "step 5 is not one; include step 6"),
        (
            "figure strobe run.mcap -o new.svg --from 81 --to 89 --every 40",
            "none is in the steps 81 to 89; include step 80",
        ),
        ("render thin.mcap -o new.gif --from 3 --to 5", "no full state in the steps 3 to 5 by 10"),
        ("export thin.mcap --from 85", "thin.mcap has no full state from step 85 on"),
        ("export thin.mcap --from 85 --to 85", "thin.mcap has no full state at step 85"),
        ("figure energy thin.mcap -o new.svg --from 91", "no state from step 91 on; its last one is at step 89"),
        (
            "figure energy run.mcap short.mcap -o new.svg --from 30",
            "short.mcap: the recording has no full state from step 30",
        ),
        (
            "figure strobe run.mcap short.mcap -o new.svg --from 30",
            "short.mcap: the recording has no full state from step 30",
        ),
        ("figure speeds run.mcap short.mcap -o new.svg --from 30", "its last one is at step 20"),
        (
            "render run.mcap thin.mcap -o new.png --at 85",
            "thin.mcap: the recording has no full state at step 85, but one every 10 steps; its last one is at step 80",
        ),
        (
            "render run.mcap thin.mcap -o new.png --at 25",
            "thin.mcap: the recording has no full state at step 25, but one every 10",
        ),
        ("render run.mcap short.mcap -o new.png --at 25", "short.mcap: the recording has no full state at step 25"),
    ] {
        let refused = workplace.rebond(command);
        assert!(refused.code == 1 && refused.errors.contains(message), "{command}: {refused:?}");
    }
    assert_eq!(workplace.names(), names);
    workplace.done("export thin.mcap --from 3 --to 5 --table bodies");
    workplace.done("export run.mcap --from 90 --to 500 --shard 2/2");
}

#[test]
fn a_clip_of_one_frame_is_no_longer_than_the_run() {
    let workplace = recorded();
    workplace.done("record scene.toml -o thin.mcap --every 1000000");
    for command in ["render run.mcap --every 1000000", "render thin.mcap", "render thin.mcap --every 3"] {
        for format in ["gif", "apng"] {
            let shown = workplace.done(&format!("{command} --force -o clip.{format}")).output;
            assert!(shown.contains(": 1 frame, every 9"), "{command}: {shown}");
        }
    }
}

#[test]
fn figures_of_every_kind_are_drawn_in_every_format() {
    let workplace = recorded();
    for kind in [
        "collision",
        "minkowski",
        "strobe",
        "spacetime",
        "energy",
        "filmstrip",
        "lines",
        "pressure",
        "speeds",
        "velocity-space",
    ] {
        for (format, mark) in [("png", "PNG"), ("svg", "<svg"), ("pdf", "%PDF")] {
            workplace.done(&format!("figure {kind} run.mcap -o {kind}.{format}"));
            let file = workplace.read(&format!("{kind}.{format}"));
            assert!(file.windows(mark.len()).take(200).any(|bytes| bytes == mark.as_bytes()), "{kind}.{format}");
        }
        workplace.done(&format!("figure {kind} scene.toml -o again-{kind}.png"));
        let [first, again] = [format!("{kind}.png"), format!("again-{kind}.png")].map(|name| workplace.read(&name));
        assert!(first == again, "{kind} of the scene and of its recording");
    }
    assert_eq!(workplace.rebond("figure collision run.mcap -o none.png --step 90").code, 1);
    assert_eq!(workplace.rebond("figure collision run.mcap -o none.bmp").code, 2);
    let chosen = workplace.rebond("figure lines run.mcap -o none.png --bodies c,ghost7..ghost9");
    assert!(chosen.code == 1 && chosen.errors.contains("no body is named \"ghost7..ghost9\""), "{chosen:?}");
    let pair = workplace.rebond("figure collision run.mcap -o none.png --bodies c");
    assert!(pair.code == 2 && pair.errors.contains("--pair"), "{pair:?}");
    let axis = workplace.rebond("figure strobe run.mcap -o none.png --axis y");
    assert!(axis.code == 2 && axis.errors.contains("spacetime and velocity-space"), "{axis:?}");
}

/// A body that is much faster than a crowd has the last colour; the scale ends at the speed of the others, and says so.
#[test]
fn a_single_fast_body_does_not_flatten_the_colours_of_a_crowd() {
    let crowd = |count: u32, fastest: f64| {
        Workplace::with_scene(&format!(
            "[world]\nsize = [16.0, 9.0]\n[run]\nsteps = 2\n[[scatter]]\ncount = {count}\nseed = 1\n\
             region = [0.0, 0.0, 16.0, 8.0]\nsize = [[0.1, 0.1], [0.2, 0.2]]\nmass = [1.0, 1.0]\n\
             velocity = [[2.0, 0.0], [2.0, 0.0]]\n[[spawn]]\nname = \"fast\"\nat = [0.0, 8.5]\nsize = [0.1, 0.1]\nmass = 1.0\n\
             velocity = [{fastest:?}, 0.0]\n[figure]\ncolor_by = \"speed\"\n"
        ))
    };
    for (count, fastest, end) in [(40, 300.0, "≥ 2 m/s"), (40, 5.0, "5 m/s"), (5, 300.0, "300 m/s")] {
        let workplace = crowd(count, fastest);
        for command in ["render scene.toml --at 1", "figure velocity-space scene.toml"] {
            workplace.done(&format!("{command} -o a.svg --force"));
            let file = String::from_utf8(workplace.read("a.svg")).unwrap();
            assert!(file.contains(&format!(">{end}<")), "{command} of {count} bodies up to {fastest} m/s: {end}");
            assert_eq!(file.contains('≥'), end.contains('≥'), "{command}: {end}");
        }
    }
    let workplace = crowd(40, 300.0);
    workplace.done("figure speeds scene.toml -o a.svg");
    let file = String::from_utf8(workplace.read("a.svg")).unwrap();
    assert!(file.contains("2 % &gt; 2 m/s"), "the note says how many are beyond the end of the axis");
}

#[test]
fn labels_that_crowds_lack_are_mentioned() {
    let crowd = |count: u32| {
        Workplace::with_scene(&format!(
            "[world]\nsize = [16.0, 9.0]\n[run]\nsteps = 2\n[[scatter]]\ncount = {count}\nseed = 1\n\
             region = [0.0, 0.0, 16.0, 9.0]\nsize = [[0.1, 0.1], [0.2, 0.2]]\nmass = [1.0, 1.0]\n\
             velocity = [[-1.0, -1.0], [1.0, 1.0]]\n"
        ))
    };
    let (few, many) = (crowd(40), crowd(41));
    for picture in
        ["render scene.toml -o a.png --at 1", "render scene.toml -o a.gif", "figure strobe scene.toml -o b.png"]
    {
        let says = |workplace: &Workplace, options: &str| {
            workplace.done(&format!("{picture} --force {options}")).errors.contains("more than 40 boxes")
        };
        assert!(says(&many, "--show name") && says(&many, "--show velocity,mass"), "{picture}");
        assert!(!says(&few, "--show name") && !says(&many, "--show velocity"), "{picture}");
    }
    assert!(!many.done("figure energy scene.toml -o c.png --show name").errors.contains("boxes"));
}

#[test]
fn a_scene_whose_run_fails_is_used_up_to_there_and_returns_an_error() {
    let workplace = Workplace::new();
    let spawn = |name: &str, x: f64, mass: &str, speed: f64| {
        format!(
            "[[spawn]]\nname = \"{name}\"\nat = [{x:?}, 0.0]\nsize = [1.0, 1.0]\nmass = {mass}\nvelocity = [{speed:?}, 0.0]\n"
        )
    };
    let bodies = spawn("left", 0.0, "inf", 1.0) + &spawn("box", 2.0, "1.0", 0.0) + &spawn("right", 4.0, "inf", -1.0);
    workplace.write("crush.toml", &format!("[run]\nsteps = 120\n[restitution]\ndefault = 0.0\n{bodies}"));
    for command in [
        "record crush.toml -o crush.mcap",
        "export crush.toml",
        "render crush.toml --at 3 -o crush.png",
        "-q record crush.toml -o quiet.mcap",
        "-q export crush.toml",
        "-q render crush.toml --at 3 -o quiet.png",
        "-q figure energy crush.toml -o quiet.svg",
    ] {
        let run = workplace.rebond(command);
        assert_eq!(run.code, 1, "{command}");
        assert!(run.errors.contains("crushed"), "{command}: {}", run.errors);
    }
    assert!(workplace.rebond("export crush.toml").output.lines().count() > 100, "the states before the error");
    assert_eq!(workplace.rebond("replay crush.mcap").code, 0, "the recording replays to the same error");
    assert_eq!(workplace.rebond("export crush.mcap").code, 0, "the recording is whole");
}

#[test]
fn a_body_too_thin_for_its_position_is_refused_in_the_scene() {
    let workplace = Workplace::new();
    let body = |x: f64| format!("[run]\nsteps = 2\n[[spawn]]\nat = [{x:?}, 0.0]\nsize = [0.0002, 1.0]\nmass = 1.0\n");
    workplace.write("thin.toml", &body(1e12));
    let run = workplace.rebond("record thin.toml -o thin.mcap");
    assert_eq!(run.code, 1);
    assert!(run.errors.contains("spawn.at") && run.errors.contains("units in the last place"), "{}", run.errors);
    workplace.write("near.toml", &body(1e9));
    assert_eq!(workplace.rebond("record near.toml -o near.mcap").code, 0);
}
