//! Recordings whose writer is killed or whose output fails.

use crate::rebond::Workplace;
use rebond::internals::recording::{self, Health};
use std::{
    process::{Child, Command, Stdio},
    thread,
    time::{Duration, SystemTime},
};

/// A scene with far too many steps to finish during a test.
const ENDLESS: &str = r#"
[world]
size = [16.0, 9.0]
[run]
rate = 60
steps = 100000000
solver = "handout"
[[scatter]]
count = 20
seed = 1
region = [0.5, 0.5, 15.0, 8.0]
size = [[0.3, 0.3], [0.6, 0.6]]
mass = [1.0, 1.0]
velocity = [[-2.0, -2.0], [2.0, 2.0]]
"#;

fn start(workplace: &Workplace, output: &str, stdout: Stdio) -> Child {
    Command::new(env!("CARGO_BIN_EXE_rebond"))
        .args(["record", "scene.toml", "-o", output])
        .current_dir(workplace.path(""))
        .stdin(Stdio::null())
        .stdout(stdout)
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts")
}

/// Random times at which to kill the process. Setting REBOND_SEED repeats those of a failed test.
fn kill_times() -> impl Iterator<Item = Duration> {
    #[expect(clippy::disallowed_methods, reason = "only the kill times depend on the clock")]
    let random = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap().as_nanos() as u64;
    let mut state = std::env::var("REBOND_SEED").map_or(random, |seed| seed.parse().expect("a number")) | 1;
    println!("REBOND_SEED={state}");
    std::iter::repeat_with(move || {
        // Marsaglia's xorshift64.
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        Duration::from_micros(state % 600_000)
    })
}

/// Kills a recording in progress after `time`, and returns the step of the last state, if any.
fn last_step_when_killed_after(time: Duration) -> Option<u64> {
    let workplace = Workplace::with_scene(ENDLESS);
    let mut writer = start(&workplace, "run.mcap", Stdio::null());
    thread::sleep(time);
    writer.kill().unwrap();
    writer.wait().unwrap();
    // The file may not exist yet, or may be empty.
    let mut recording = recording::open(&workplace.path("run.mcap")).ok()?;
    recording.by_ref().for_each(|item| drop(item.unwrap()));
    let Health::Incomplete(missing) = recording.health() else { panic!("{:?}", recording.health()) };
    let replayed = workplace.rebond("replay run.mcap");
    assert_eq!(replayed.code, 4, "{replayed:?}");
    let recovered = workplace.rebond("recover run.mcap -o fixed.mcap");
    let Some(step) = missing.end?.after else {
        assert_eq!(recovered.code, 4, "{recovered:?}");
        assert!(!workplace.path("fixed.mcap").exists());
        return None;
    };
    assert_eq!(recovered.code, 4, "{recovered:?}");
    let (steps, states) = (plural(step, "step"), plural(step + 1, "state"));
    assert_eq!(replayed.output, format!("incomplete: truncated after step {step} of 100000000; {steps} same\n"));
    assert!(recovered.output.contains(&format!("{states} up to step {step}")), "{recovered:?}");
    let replayed = workplace.rebond("replay fixed.mcap");
    let missing = format!("recovered; steps {} to 100000000 are missing", step + 1);
    assert_eq!((replayed.code, replayed.output), (4, format!("incomplete: {missing}; {steps} same\n")));
    Some(step)
}

fn plural(count: u64, noun: &str) -> String {
    if count == 1 { format!("1 {noun}") } else { format!("{count} {noun}s") }
}

#[test]
fn a_recording_killed_at_any_time_keeps_all_flushed_data() {
    let mut last_steps = Vec::new();
    for time in kill_times().take(10).chain([Duration::from_millis(700)]) {
        let after = last_step_when_killed_after(time);
        println!("killed after {time:?}: last step {after:?}");
        last_steps.extend(after);
    }
    for step in &last_steps {
        assert!(*step == 0 || (step + 1).is_multiple_of(60), "step {step} is not the last one of a second");
    }
    assert!(last_steps.last().is_some_and(|step| *step >= 59), "nothing was flushed: {last_steps:?}");
}

/// A chunk of 4 MiB is flushed, too, however little simulated time it has.
#[test]
fn a_recording_killed_in_its_first_simulated_second_keeps_its_chunks() {
    let workplace = Workplace::with_scene(&ENDLESS.replace("rate = 60", "rate = 1e9"));
    let mut writer = start(&workplace, "run.mcap", Stdio::null());
    let bytes = || std::fs::metadata(workplace.path("run.mcap")).map_or(0, |metadata| metadata.len());
    for _ in 0..12_000 {
        if bytes() >= 1 << 20 {
            break;
        }
        thread::sleep(Duration::from_millis(10));
    }
    writer.kill().unwrap();
    writer.wait().unwrap();
    let recovered = workplace.rebond("recover run.mcap -o fixed.mcap");
    let states = recovered.output.strip_prefix("recovered ").unwrap_or_default();
    let states: u64 = states.split_once(' ').and_then(|(count, _)| count.parse().ok()).unwrap_or(0);
    assert!(recovered.code == 4 && states > 1000, "{recovered:?}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error() {
    let workplace = Workplace::with_scene(ENDLESS);
    let recorded = workplace.rebond("record scene.toml -o /dev/full");
    assert_eq!(recorded.code, 1, "{recorded:?}");
    assert!(recorded.errors.contains("/dev/full"), "{recorded:?}");
    assert!(recorded.errors.contains("No space left on device"), "{recorded:?}");
}

/// `/dev/null` accepts all data but cannot be synced, so only `--sync` fails.
#[cfg(target_os = "linux")]
#[test]
fn sync_waits_for_the_disk() {
    let workplace = Workplace::with_scene(ENDLESS);
    workplace.done("record scene.toml -o /dev/null --steps 10");
    let recorded = workplace.rebond("record scene.toml -o /dev/null --steps 10 --sync");
    assert_eq!(recorded.code, 1, "{recorded:?}");
    assert!(recorded.errors.contains("Invalid argument"), "{recorded:?}");
    workplace.done("record scene.toml -o run.mcap --steps 10 --sync");
    assert_eq!(workplace.done("replay run.mcap").output, "same: 10 steps, 20 bodies\n");
}

#[test]
fn a_closed_pipe_ends_a_recording() {
    let workplace = Workplace::with_scene(ENDLESS);
    let mut writer = start(&workplace, "-", Stdio::piped());
    drop(writer.stdout.take());
    assert_eq!(writer.wait().unwrap().code(), Some(0));
}

#[test]
fn a_missing_folder_is_an_error() {
    let workplace = Workplace::with_scene(ENDLESS);
    let recorded = workplace.rebond("record scene.toml -o missing/run.mcap");
    assert_eq!(recorded.code, 1, "{recorded:?}");
    assert!(recorded.errors.contains("missing/run.mcap"), "{recorded:?}");
    assert_eq!(workplace.names(), ["scene.toml"]);
}

#[test]
fn a_recording_cut_before_its_settings_has_the_exit_code_of_damage() {
    let workplace = Workplace::with_scene(ENDLESS);
    workplace.done("record scene.toml -o run.mcap --steps 10");
    for length in [0, 5, 8, 100] {
        std::fs::write(workplace.path("cut.mcap"), &workplace.read("run.mcap")[..length]).unwrap();
        let replayed = workplace.rebond("replay cut.mcap");
        assert_eq!(replayed.code, 4, "{replayed:?}");
        assert!(replayed.errors.contains("cut.mcap: truncated before its settings"), "{replayed:?}");
    }
    workplace.write("cut.mcap", "not a recording");
    assert_eq!(workplace.rebond("replay cut.mcap").code, 1);
}
