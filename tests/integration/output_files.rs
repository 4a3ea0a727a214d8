//! Files appear complete or not at all, whatever happens meanwhile.

use crate::rebond::{Outcome, Workplace};
use std::fs::{self, File, Permissions};
use std::io::{BufRead, BufReader, Read, Write};
use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};
use std::os::unix::process::ExitStatusExt;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::Duration;

/// Two boxes of which one bounces between walls.
const SCENE: &str = r#"
[world]
size = [16.0, 9.0]
walls = true
[run]
steps = 120
[[spawn]]
name = "a"
at = [2.0, 3.0]
size = [1.0, 1.0]
mass = 1.0
velocity = [4.0, 0.0]
[[spawn]]
name = "b"
at = [8.0, 3.0]
size = [1.0, 1.0]
mass = 1.0
"#;

/// A scene with far too many steps to finish during a test.
fn endless() -> String {
    SCENE.replace("steps = 120", "steps = 1000000000")
}

/// A folder with a scene, its recording and a file `old` that is not one of them.
fn workplace() -> Workplace {
    let workplace = Workplace::with_scene(SCENE);
    workplace.write("endless.toml", &endless());
    workplace.done("record scene.toml -o run.mcap");
    workplace
}

/// One command for each kind of output. The last word is the output.
const COMMANDS: [&str; 7] = [
    "record scene.toml -o new.mcap",
    "recover run.mcap -o new.mcap",
    "export run.mcap -o new.csv",
    "render run.mcap --every 20 -o new.gif",
    "render run.mcap --at 3 -o new.svg",
    "render run.mcap --at 3 --size 64x36 -o new.png",
    "figure strobe run.mcap -o new.pdf",
];

/// A recording of which a part was written stays, as the message says; everything else is removed.
#[test]
fn a_full_disk_leaves_only_the_begun_recording_and_its_last_step_is_named() {
    let workplace = workplace();
    let limited = |blocks: u32, line: &str| {
        // A file that grows beyond the limit is an error of writing instead of a signal.
        let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec '{}' {line}", env!("CARGO_BIN_EXE_rebond"));
        workplace.run(assert_cmd::Command::new("sh").args(["-c", &script]).current_dir(workplace.path("")))
    };
    let recorded = limited(200, "record endless.toml -o new.mcap");
    assert_eq!(recorded.code, 1, "{recorded:?}");
    let (_, last) = recorded.errors.split_once("it is unfinished and has the steps 0 to ").expect("the last step");
    let last: u64 = last.lines().next().unwrap().parse().unwrap();
    assert!(last > 60 && recorded.errors.contains("rebond recover"), "{recorded:?}");
    let recovered = workplace.rebond("recover new.mcap -o fixed.mcap");
    assert!(
        recovered.output.starts_with(&format!("recovered {} states up to step {last}\n", last + 1)),
        "{recovered:?}"
    );
    for name in ["new.mcap", "fixed.mcap", "endless.toml"] {
        fs::remove_file(workplace.path(name)).unwrap();
    }
    let names = workplace.names();
    for command in COMMANDS.iter().chain(&["render run.mcap -o frames/"]) {
        let failed = limited(0, command);
        assert_eq!(failed.code, 1, "{command}: {failed:?}");
        assert!(
            failed.errors.contains("cannot write ") && !failed.errors.contains("unfinished"),
            "{command}: {failed:?}"
        );
        assert_eq!(workplace.names(), names, "{command}");
    }
    workplace.write("pictures.check", "rebond render scene.toml --at 3 -o pictures/at.png\n");
    workplace.done("check . --update");
    let kept = workplace.read("run.mcap");
    workplace.write("scene.toml", &SCENE.replace("[4.0, 0.0]", "[5.0, 0.0]"));
    let names = workplace.names();
    let updated = limited(0, "check . --update --report page");
    assert_eq!(updated.code, 1, "{updated:?}");
    assert_eq!((workplace.names(), workplace.read("run.mcap")), (names, kept));
}

fn output_of(command: &str) -> &str {
    command.split(' ').next_back().expect("an output")
}

/// Waits until `condition` holds; fails after a minute.
fn wait_until(what: &str, mut condition: impl FnMut() -> bool) {
    for _ in 0..6000 {
        if condition() {
            return;
        }
        thread::sleep(Duration::from_millis(10));
    }
    panic!("not within a minute: {what}");
}

fn send(signal: &str, process: &Child) {
    let status = Command::new("kill").args(["-s", signal, &process.id().to_string()]).status();
    assert!(status.unwrap().success(), "kill -s {signal}");
}

/// Waits for the end and returns the number of the signal, the exit code and standard error.
fn end_of(process: Child) -> (Option<i32>, Option<i32>, String) {
    let output = process.wait_with_output().unwrap();
    (output.status.signal(), output.status.code(), String::from_utf8(output.stderr).unwrap())
}

/// Runs a command on a recording that is not finished.
fn on_unfinished(workplace: &Workplace, line: &str) -> Outcome {
    let outcome = workplace.rebond(line);
    assert!([0, 4].contains(&outcome.code), "{line}: {outcome:?}");
    outcome
}

#[test]
fn a_command_that_fails_leaves_no_file_and_keeps_the_old_one() {
    let workplace = workplace();
    workplace.write("bad.toml", "[run]\nsteps = -1\n");
    workplace.write("bad.jsonl", "{\"delete\": {\"name\": \"nobody\"}}\n");
    workplace.write("bad.mcap", "not a recording");
    let valid = workplace.names();
    let failing = [
        "record bad.toml -o new.mcap",
        "record missing.toml -o new.mcap",
        "record scene.toml --events bad.jsonl -o new.mcap",
        "recover bad.mcap -o new.mcap",
        "recover missing.mcap -o new.mcap",
        "export bad.mcap -o new.csv",
        "render bad.mcap -o new.gif",
        "render run.mcap --at 121 -o new.png",
        "render run.mcap --at 3 --size 20000x20000 -o new.png",
        "render bad.toml -o new/",
        "figure collision run.mcap --step 119 -o new.svg",
        "report --only nothing --plot new.png",
    ];
    for command in failing {
        let outcome = workplace.rebond(command);
        assert_ne!(outcome.code, 0, "{command}: {outcome:?}");
        assert_eq!(workplace.names(), valid, "{command}: {outcome:?}");
        let output = output_of(command);
        if output.ends_with('/') {
            continue;
        }
        workplace.write(output, "old");
        let outcome = workplace.rebond(&format!("{command} --force"));
        assert_ne!(outcome.code, 0, "{command}: {outcome:?}");
        assert_eq!(workplace.read(output), b"old", "{command}");
        fs::remove_file(workplace.path(output)).unwrap();
        assert_eq!(workplace.names(), valid, "{command}: {outcome:?}");
    }
}

#[test]
fn an_existing_file_is_replaced_only_with_force_and_keeps_its_permissions() {
    let workplace = workplace();
    for command in COMMANDS {
        let output = output_of(command);
        workplace.write(output, "old");
        fs::set_permissions(workplace.path(output), Permissions::from_mode(0o640)).unwrap();
        let refused = workplace.rebond(command);
        assert_eq!((refused.code, workplace.read(output)), (1, b"old".to_vec()), "{command}: {refused:?}");
        assert!(refused.errors.contains("already exists"), "{command}: {refused:?}");
        workplace.done(&format!("{command} --force"));
        assert!(workplace.read(output).len() > 100, "{command}");
        let mode = workplace.path(output).metadata().unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o640, "{command}");
        fs::remove_file(workplace.path(output)).unwrap();
    }
    let names = workplace.names();
    assert!(!names.iter().any(|name| name.starts_with('.')), "{names:?}");
}

#[test]
fn a_frame_never_replaces_what_is_no_file() {
    let workplace = workplace();
    let line = "render scene.toml --to 5 --size 160x120 -o frames/";
    workplace.done(line);
    let frame = workplace.path("frames/000003.png");
    fs::remove_file(&frame).unwrap();
    symlink("elsewhere.png", &frame).unwrap();
    let is_refused = |kind: &str| {
        let refused = workplace.rebond(&format!("{line} --force"));
        let reason = format!("000003.png: it is {kind}; remove it, or choose another folder");
        assert!(refused.code == 1 && refused.errors.contains(&reason), "{refused:?}");
    };
    is_refused("a symbolic link");
    fs::remove_file(&frame).unwrap();
    fs::create_dir(&frame).unwrap();
    is_refused("a folder");
}

#[test]
fn a_symbolic_link_stays_and_the_file_behind_it_is_written() {
    let workplace = workplace();
    fs::create_dir(workplace.path("elsewhere")).unwrap();
    for command in COMMANDS {
        let output = output_of(command);
        symlink(format!("elsewhere/{output}"), workplace.path(output)).unwrap();
        assert_eq!(workplace.rebond(command).code, 1, "{command}: the link exists");
        for _ in 0..2 {
            workplace.done(&format!("{command} --force"));
            assert!(workplace.path(output).symlink_metadata().unwrap().is_symlink(), "{command}");
            assert!(workplace.read(&format!("elsewhere/{output}")).len() > 100, "{command}");
        }
        fs::remove_file(workplace.path(output)).unwrap();
        fs::remove_file(workplace.path(&format!("elsewhere/{output}"))).unwrap();
    }
}

#[test]
fn an_input_is_never_the_output() {
    let workplace = workplace();
    symlink("run.mcap", workplace.path("link.mcap")).unwrap();
    fs::hard_link(workplace.path("run.mcap"), workplace.path("hard.mcap")).unwrap();
    fs::copy(workplace.path("run.mcap"), workplace.path("run.csv")).unwrap();
    let manifest = "rebond record scene.toml -o run.mcap\n";
    workplace.write("run.check", manifest);
    let (scene, recording) = (workplace.read("scene.toml"), workplace.read("run.mcap"));
    for command in [
        "record scene.toml -o scene.toml --force",
        "record scene.toml -o ./scene.toml --force",
        "record endless.toml --events scene.toml -o scene.toml --force",
        "recover run.mcap -o run.mcap --force",
        "recover run.mcap -o link.mcap --force",
        "recover link.mcap -o hard.mcap --force",
        "export run.csv -o run.csv --force",
        "check run.check --junit run.check --force",
        "check run.mcap --junit run.check --force",
        "report scene.toml --plot scene.toml --force",
    ] {
        let outcome = workplace.rebond(command);
        let code = if command.starts_with("report") { 2 } else { 1 };
        assert_eq!(outcome.code, code, "{command}: {outcome:?}");
        assert_eq!((workplace.read("scene.toml"), workplace.read("run.mcap")), (scene.clone(), recording.clone()));
        assert_eq!(workplace.read("run.check"), manifest.as_bytes(), "{command}");
        assert!(outcome.errors.contains("reads this file") || command.starts_with("report"), "{command}: {outcome:?}");
    }
    let output = File::options().append(true).open(workplace.path("run.mcap")).unwrap();
    let (_, code, errors) = end_of(workplace.start("export run.mcap", Stdio::null(), output.into()));
    assert_eq!((code, workplace.read("run.mcap")), (Some(1), recording), "{errors}");
}

/// The images of a scene are read as well, whatever the command, and the value of `--set` that names them.
#[test]
fn an_image_of_a_scene_is_never_the_output() {
    let workplace = workplace();
    let image = crate::images::encoded([1, 1], &[200, 0, 0, 255]);
    let scene = SCENE.replace("name = \"a\"", "name = \"a\"\nimage = \"frames/000003.png\"");
    workplace.write("sprites.toml", &scene);
    workplace.write("manifest.check", "rebond render sprites.toml --at 3 -o frames/000003.png\n");
    fs::create_dir(workplace.path("frames")).unwrap();
    for name in ["frames/000003.png", "other.png"] {
        fs::write(workplace.path(name), &image).unwrap();
    }
    symlink("frames/000003.png", workplace.path("link.png")).unwrap();
    symlink("frames/000003.png", workplace.path("link.csv")).unwrap();
    for command in [
        "render sprites.toml --at 3 -o frames/000003.png --force",
        "render sprites.toml --at 3 -o link.png --force",
        "render sprites.toml --at 3 -o other.png --force --set spawn.a.image=\"other.png\"",
        "render run.mcap sprites.toml --at 3 -o ./frames/../frames/000003.png --force",
        "render sprites.toml --size 64x36 -o frames/ --force",
        "figure strobe sprites.toml -o frames/000003.png --force",
        "export sprites.toml -o link.csv --force",
        "record sprites.toml -o frames/000003.png --force",
        "report sprites.toml --plot frames/000003.png --force",
        "check sprites.toml --junit frames/000003.png --force",
        "check manifest.check --junit sprites.toml --force",
        "check manifest.check --update",
    ] {
        let outcome = workplace.rebond(command);
        assert_eq!(outcome.code, 1, "{command}: {outcome:?}");
        let text = format!("{}{}", outcome.output, outcome.errors);
        assert!(text.contains("reads this file") || text.contains("an image of its scene"), "{command}: {outcome:?}");
        assert_eq!(workplace.read("sprites.toml"), scene.as_bytes(), "{command}");
        for name in ["frames/000003.png", "other.png"] {
            assert!(workplace.read(name) == image, "{command}: {name}");
        }
        assert_eq!(fs::read_dir(workplace.path("frames")).unwrap().count(), 1, "{command}");
    }
    let output = File::options().append(true).open(workplace.path("other.png")).unwrap();
    let command = "record sprites.toml -o - --set spawn.a.image=\"other.png\"";
    let (_, code, errors) = end_of(workplace.start(command, Stdio::null(), output.into()));
    assert!(code == Some(1) && workplace.read("other.png") == image, "{errors}");
    // Frames beside the image are written.
    workplace.done("render sprites.toml --size 64x36 --from 4 --to 5 -o frames/ --force");
    assert!(workplace.read("frames/000003.png") == image);
    assert_eq!(fs::read_dir(workplace.path("frames")).unwrap().count(), 3);
}

#[test]
fn a_line_of_a_manifest_never_writes_what_it_reads() {
    let workplace = workplace();
    fs::copy(workplace.path("run.mcap"), workplace.path("run.png")).unwrap();
    workplace.write("events.mcap", "");
    workplace.write(
        "manifest.check",
        "rebond render run.png --at 3 -o ./run.png\nrebond record scene.toml --events events.mcap -o events.mcap\n",
    );
    let recording = workplace.read("run.mcap");
    let outcome = workplace.rebond("check manifest.check --update");
    assert_eq!(outcome.code, 1, "{outcome:?}");
    for line in ["line 1: the command reads run.png", "line 2: the command reads events.mcap"] {
        assert!(outcome.output.contains(line), "{outcome:?}");
    }
    assert!(workplace.read("run.png") == recording && workplace.read("events.mcap").is_empty());
}

#[test]
fn a_named_pipe_is_written_to_and_never_replaced() {
    let workplace = workplace();
    for (command, options) in COMMANDS.iter().flat_map(|command| [(command, ""), (command, " --force")]) {
        let output = output_of(command);
        let expected = {
            workplace.done(command);
            let content = workplace.read(output);
            fs::remove_file(workplace.path(output)).unwrap();
            content
        };
        assert!(Command::new("mkfifo").arg(workplace.path(output)).status().unwrap().success());
        let writer = workplace.start(&format!("{command}{options}"), Stdio::null(), Stdio::null());
        let mut content = Vec::new();
        File::open(workplace.path(output)).unwrap().read_to_end(&mut content).unwrap();
        let (_, code, errors) = end_of(writer);
        assert_eq!((code, content == expected), (Some(0), true), "{command}{options}: {errors}");
        assert!(workplace.path(output).metadata().unwrap().file_type().is_fifo(), "{command}{options}");
        fs::remove_file(workplace.path(output)).unwrap();
    }
}

#[cfg(target_os = "linux")]
#[test]
fn devices_are_written_to_and_stay_devices() {
    let workplace = workplace();
    for (device, code) in [("/dev/null", 0), ("/dev/full", 1)] {
        for command in ["record scene.toml", "recover run.mcap"] {
            for options in ["", " --force"] {
                let outcome = workplace.rebond(&format!("{command} -o {device}{options}"));
                assert_eq!(outcome.code, code, "{command} -o {device}{options}: {outcome:?}");
                assert!(fs::metadata(device).unwrap().file_type().is_char_device());
            }
        }
    }
    for command in ["export run.mcap", "render run.mcap -o -", "record scene.toml -o -", "info run.mcap"] {
        let full = File::options().write(true).open("/dev/full").unwrap();
        let (_, code, errors) = end_of(workplace.start(command, Stdio::null(), full.into()));
        assert_eq!(code, Some(1), "{command}: {errors}");
        assert!(errors.contains("standard output: No space left on device"), "{command}: {errors}");
    }
    assert_eq!(workplace.names(), ["endless.toml", "run.mcap", "scene.toml"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_descriptor_is_written_to_where_the_shell_has_opened_it() {
    let workplace = workplace();
    let table = workplace.done("export run.mcap").output;
    let rebond = env!("CARGO_BIN_EXE_rebond");
    // A table needs a name that ends in .csv, so links give it one.
    symlink("/dev/stdout", workplace.path("out.csv")).unwrap();
    symlink("/dev/fd/3", workplace.path("third.csv")).unwrap();
    for (output, redirection) in [("out.csv", ">> log"), ("third.csv", "3>> log")] {
        workplace.write("log", "kept\n");
        let line = format!("{rebond} export run.mcap -o {output} {redirection}");
        let status = Command::new("sh").args(["-c", &line]).current_dir(workplace.path("")).status();
        assert!(status.unwrap().success(), "{line}");
        assert_eq!(workplace.read("log"), format!("kept\n{table}").into_bytes(), "{line}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_summary_never_gets_into_an_output_that_is_standard_output() {
    let workplace = workplace();
    symlink("/dev/stdout", workplace.path("out.gif")).unwrap();
    workplace.done("render scene.toml -o kept.gif --to 3");
    for (command, kept) in [
        ("record scene.toml -o /dev/stdout", "run.mcap"),
        ("record scene.toml --json -o /dev/fd/1", "run.mcap"),
        ("recover run.mcap -o /proc/self/fd/1", "run.mcap"),
        ("render scene.toml -o out.gif --to 3", "kept.gif"),
    ] {
        let output = File::create(workplace.path("log")).unwrap();
        let (_, code, errors) = end_of(workplace.start(command, Stdio::null(), output.into()));
        assert_eq!(code, Some(0), "{command}: {errors}");
        assert!(workplace.read("log") == workplace.read(kept), "{command}: {errors}");
        assert!(!errors.is_empty(), "{command}");
    }
}

#[test]
fn a_folder_is_no_output_file_and_a_file_no_output_folder() {
    let workplace = workplace();
    fs::create_dir(workplace.path("folder.csv")).unwrap();
    let outcome = workplace.rebond("export run.mcap -o folder.csv --force");
    assert!(outcome.code == 1 && outcome.errors.contains("folder.csv: it is a folder"), "{outcome:?}");
    let outcome = workplace.rebond("render run.mcap -o scene.toml/ --force");
    assert!(outcome.code == 1 && outcome.errors.contains("it is not a folder"), "{outcome:?}");
    assert_eq!(workplace.read("scene.toml"), SCENE.as_bytes());
}

#[test]
fn pictures_of_a_folder_appear_together() {
    let workplace = workplace();
    workplace.done("render run.mcap --from 5 --to 9 --size 64x36 -o deep/er/frames/");
    let first = workplace.read("deep/er/frames/000005.png");
    let refused = workplace.rebond("render run.mcap --from 0 --to 5 --size 64x36 -o deep/er/frames/");
    assert_eq!(refused.code, 1, "{refused:?}");
    let names: Vec<_> =
        fs::read_dir(workplace.path("deep/er/frames")).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(names.len(), 5, "{names:?}");
    let forced = workplace.done("render run.mcap --from 0 --to 5 --size 64x36 --theme dark -o deep/er/frames/ --force");
    let kept =
        "deep/er/frames/ has 4 other pictures from before, 000006.png to 000009.png; if these are frames of another";
    assert!(forced.errors.contains(kept), "{forced:?}");
    assert_eq!(fs::read_dir(workplace.path("deep/er/frames")).unwrap().count(), 10);
    assert_ne!(workplace.read("deep/er/frames/000005.png"), first);
    assert_eq!(workplace.names(), ["deep", "endless.toml", "run.mcap", "scene.toml"]);
}

#[test]
fn an_old_recording_stays_until_states_are_written() {
    let workplace = workplace();
    let old = workplace.read("run.mcap");
    let mut process =
        workplace.start("record scene.toml -o run.mcap --events - --force", Stdio::piped(), Stdio::null());
    let mut events = process.stdin.take().unwrap();
    let starts = |name: &str| name.starts_with(".rebond-");
    wait_until("the temporary file", || workplace.names().iter().any(|name| starts(name)));
    thread::sleep(Duration::from_millis(300));
    assert_eq!(workplace.read("run.mcap"), old);
    writeln!(events, "{{\"delete\": {{\"name\": \"a\", \"step\": 100}}}}").unwrap();
    events.flush().unwrap();
    wait_until("the first second", || workplace.read("run.mcap") != old);
    assert!(on_unfinished(&workplace, "replay run.mcap").output.starts_with("incomplete: "));
    drop(events);
    let (_, code, errors) = end_of(process);
    assert_eq!(code, Some(0), "{errors}");
    assert!(workplace.done("replay run.mcap").output.starts_with("same: 120 steps"));
    assert_eq!(workplace.names(), ["endless.toml", "run.mcap", "scene.toml"]);
}

/// The first chunk has the initial state. No input of a scene is refused after it.
#[test]
fn a_recording_is_at_its_place_from_its_first_chunk_on() {
    let workplace = workplace();
    // The first step is slow, because each pair of boxes is compared several times.
    let slow = "[run]\nsteps = 1000\nsolver = \"handout\"\n[[scatter]]\ncount = 20000\nseed = 1\n\
        region = [0.0, 0.0, 16.0, 9.0]\nsize = [[0.01, 0.01], [0.01, 0.01]]\nmass = [1.0, 1.0]\n\
        velocity = [[0.0, 0.0], [0.0, 0.0]]\noverlap = true\n";
    workplace.write("slow.toml", slow);
    let mut process = workplace.start("record slow.toml -o slow.mcap", Stdio::null(), Stdio::null());
    wait_until("the first chunk", || workplace.path("slow.mcap").exists());
    process.kill().unwrap();
    process.wait().unwrap();
    let info = workplace.rebond("info slow.mcap");
    assert!(info.code == 4 && info.output.contains("truncated after step "), "{info:?}");
}

#[test]
fn a_second_writer_of_a_recording_is_refused() {
    let workplace = workplace();
    let mut first = workplace.start("record endless.toml -o long.mcap", Stdio::null(), Stdio::null());
    wait_until("the recording", || workplace.path("long.mcap").exists());
    for command in ["record scene.toml -o long.mcap", "recover run.mcap -o long.mcap"] {
        let second = workplace.rebond(&format!("{command} --force"));
        assert_eq!(second.code, 1, "{command}: {second:?}");
        assert!(second.errors.contains("another process is recording to it"), "{command}: {second:?}");
    }
    assert_eq!(workplace.rebond("info long.mcap").code, 4, "it can be read meanwhile");
    first.kill().unwrap();
    first.wait().unwrap();
    workplace.done("record scene.toml -o long.mcap --force");
}

#[test]
fn of_many_writers_that_start_together_one_wins() {
    let workplace = workplace();
    for round in 0..3 {
        let mut writers: Vec<Child> = (0..6)
            .map(|_| workplace.start("record endless.toml -o race.mcap --force", Stdio::null(), Stdio::null()))
            .collect();
        let mut running = 6;
        wait_until("one writer is left", || {
            running =
                writers.iter_mut().filter_map(|writer| writer.try_wait().unwrap().is_none().then_some(())).count();
            running <= 1
        });
        assert_eq!(running, 1, "round {round}");
        for mut writer in writers {
            let _ = writer.kill();
            writer.wait().unwrap();
        }
    }
    assert!(on_unfinished(&workplace, "replay race.mcap --to 30").output.contains("30 steps"));
}

#[test]
fn an_interrupted_command_leaves_nothing_behind_and_ends_by_the_signal() {
    let workplace = workplace();
    workplace.write("long.toml", &SCENE.replace("steps = 120", "steps = 200000"));
    // All commands take much longer than the signal may be late on a busy machine.
    let export = format!("export {} -o new.csv --force", ["long.mcap"; 50].join(" "));
    let commands = [
        export.as_str(),
        "render long.mcap --long --size 1280x720 -o new.gif",
        "render long.mcap --long --size 640x360 -o frames/",
        "render endless.toml --long -o new.gif",
        "figure strobe endless.toml -o new.svg",
        "record scene.toml --events - -o new.mcap",
        "check .",
    ];
    workplace.done("record long.toml -o long.mcap --every 2");
    workplace.write("new.csv", "old");
    let names = workplace.names();
    for (signal, number) in [("INT", 2), ("TERM", 15), ("HUP", 1), ("QUIT", 3)] {
        for command in commands {
            let process = workplace.start(command, Stdio::piped(), Stdio::null());
            wait_until(command, || workplace.names().iter().any(|name| name.starts_with(".rebond-")));
            thread::sleep(Duration::from_millis(100));
            send(signal, &process);
            let (ended_by, code, errors) = end_of(process);
            assert_eq!((ended_by, code), (Some(number), None), "{command} after {signal}: {errors}");
            assert_eq!(workplace.names(), names, "{command} after {signal}");
        }
    }
    assert_eq!(workplace.read("new.csv"), b"old");
}

#[cfg(target_os = "linux")]
#[test]
fn signals_that_the_parent_ignores_stay_ignored() {
    let workplace = workplace();
    let line = format!("trap '' HUP; exec {} record scene.toml --events - -o new.mcap", env!("CARGO_BIN_EXE_rebond"));
    let mut command = Command::new("sh");
    command.args(["-c", &line]).current_dir(workplace.path("")).stdin(Stdio::piped()).stderr(Stdio::piped());
    let mut process = command.spawn().unwrap();
    wait_until("the temporary file", || workplace.names().iter().any(|name| name.starts_with(".rebond-")));
    thread::sleep(Duration::from_millis(100));
    send("HUP", &process);
    thread::sleep(Duration::from_millis(200));
    drop(process.stdin.take());
    assert_eq!(end_of(process).1, Some(0));
    workplace.done("replay new.mcap");
}

#[test]
fn a_reader_that_closes_the_pipe_ends_a_command_quietly() {
    let workplace = workplace();
    workplace.write("long.toml", &SCENE.replace("steps = 120", "steps = 20000"));
    workplace.done("record long.toml -o long.mcap");
    for command in [
        "export long.mcap",
        "record endless.toml -o -",
        "recover long.mcap -o -",
        "render long.mcap -o -",
        "render run.mcap --at 1 --size 4000x4000 -o -",
        "figure strobe run.mcap -o -",
        "info run.mcap",
        "replay run.mcap",
        "replay run.mcap --json",
        "check run.mcap",
        "completions bash",
    ] {
        // Once closed from the start, once after the first bytes.
        for bytes in [0, 1] {
            let mut process = workplace.start(command, Stdio::null(), Stdio::piped());
            let mut output = BufReader::with_capacity(1, process.stdout.take().unwrap());
            if bytes > 0 {
                output.fill_buf().unwrap();
            }
            drop(output);
            let (signal, code, errors) = end_of(process);
            let errors = errors.lines().filter(|line| !line.contains("step")).collect::<String>();
            assert_eq!((signal, code, errors.as_str()), (None, Some(0), ""), "{command}");
        }
    }
}

#[test]
fn a_check_whose_reader_is_gone_still_ends_with_its_verdict() {
    let workplace = workplace();
    let mut damaged = workplace.read("run.mcap");
    damaged.truncate(damaged.len() / 2);
    fs::write(workplace.path("half.mcap"), damaged).unwrap();
    let mut process = workplace.start("check run.mcap half.mcap", Stdio::null(), Stdio::piped());
    drop(process.stdout.take());
    assert_eq!(end_of(process).1, Some(4));
}
