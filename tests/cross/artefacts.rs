//! The digests of a fixed set of artefacts that rebond makes, which are the same on every machine.
//!
//! Only the program itself may run in an emulator; its files are read by this process.

#[path = "content.rs"]
mod content;
#[path = "workspace.rs"]
mod workspace;

pub use workspace::Program;

use workspace::Workspace;

/// Returns one line per artefact: size (bytes), digest of the decoded content, digest of the file, name.
pub fn digests(program: &Program) -> String {
    let mut workspace = Workspace::new(program);
    for (scene, steps) in SCENES {
        workspace.copy_in(&format!("{scene}.toml"));
        runs(&mut workspace, scene, *steps);
    }
    live_events(&mut workspace);
    overflow(&mut workspace);
    for scene in ["click-session", "pile"] {
        damage(&mut workspace, scene);
        pictures(&mut workspace, scene);
    }
    for scene in ["figure-1", "cradle"] {
        figures(&mut workspace, scene);
    }
    committed(&mut workspace);
    workspace.lines
}

/// Scenes of both solvers, and the number of steps of each.
const SCENES: &[(&str, u64)] = &[
    // The handout solver.
    ("click-session", 480),
    ("constant-force", 240),
    ("falling-heap", 180),
    ("figure-1", 60),
    ("gas", 90),
    ("materials", 480),
    ("overlapping-boxes", 14),
    ("sinking-stack", 180),
    ("spawn-and-delete", 480),
    // The event-driven solver.
    ("bullet-exact", 120),
    ("cradle", 600),
    ("elastic-gas", 60),
    ("galperin", 1200),
    ("pile", 180),
    ("stack-foot-removed", 600),
    ("tile-seams", 300),
    ("zeno-bounce", 1200),
];

/// Records, replays completely and from a keyframe, prints information and exports a table.
fn runs(workspace: &mut Workspace, scene: &str, steps: u64) {
    let [from, to] = [steps / 2, steps / 2 + 10];
    workspace.run(&format!("record {scene}.toml -o {scene}.mcap --steps {steps}"));
    workspace.run(&format!("replay {scene}.mcap"));
    workspace.run(&format!("replay {scene}.mcap --from {from} --to {to}"));
    workspace.run(&format!("info {scene}.mcap --json"));
    workspace.run(&format!("export {scene}.mcap -o {scene}.csv --from {from} --to {to}"));
}

/// Live events, with states recorded every 7 steps.
fn live_events(workspace: &mut Workspace) {
    let events = r#"{"click": {"step": 30, "at": [8, 2], "spawn": {"size": [0.7, 0.3], "mass": 0.1}}}
{"spawn": {"step": 31, "name": "late", "at": [1.1, 1.3], "size": [0.2, 0.2], "mass": 3, "velocity": [1e-3, -0.0]}}
{"delete": {"step": 70, "name": "late"}}
"#;
    workspace.write("events.jsonl", events.as_bytes());
    workspace.run("record figure-1.toml -o live.mcap --steps 90 --every 7 --events events.jsonl");
    workspace.run("replay live.mcap");
    workspace.run("export live.mcap -o live.jsonl");
}

/// Runs in which numbers overflow, because processors produce different NaNs.
fn overflow(workspace: &mut Workspace) {
    for solver in ["handout", "event-driven"] {
        let scene = format!(
            r#"
[world]
size = [16.0, 9.0]
gravity = [1e307, -1e306]
[run]
rate = 1
steps = 50
solver = "{solver}"
[[spawn]]
name = "a"
at = [1.0, 1.0]
size = [1.0, 1.0]
mass = 1.0
velocity = [3e305, 1e300]
[[spawn]]
name = "b"
at = [4.0, 1.0]
size = [1.0, 1.0]
mass = 1e300
"#
        );
        let name = format!("overflow-{solver}");
        workspace.write(&format!("{name}.toml"), scene.as_bytes());
        workspace.run_with_code(1, &format!("record {name}.toml -o {name}.mcap"));
        workspace.run(&format!("replay {name}.mcap"));
    }
}

/// Recordings that are cut, or have a flipped bit: replayed, inspected and recovered.
fn damage(workspace: &mut Workspace, scene: &str) {
    let complete = workspace.read(&format!("{scene}.mcap"));
    let cut = complete[..complete.len() * 2 / 3].to_vec();
    let mut flipped = complete;
    let middle = flipped.len() / 2;
    flipped[middle] ^= 1;
    for (kind, bytes) in [("cut", cut), ("flipped", flipped)] {
        let name = format!("{scene}-{kind}");
        workspace.write(&format!("{name}.mcap"), &bytes);
        workspace.run_with_code(4, &format!("replay {name}.mcap"));
        workspace.run_with_code(4, &format!("info {name}.mcap"));
        workspace.run_with_code(4, &format!("recover {name}.mcap -o {name}-recovered.mcap"));
        workspace.run_with_code(4, &format!("replay {name}-recovered.mcap"));
    }
}

/// Animations and pictures with every colouring, on one thread and on three.
fn pictures(workspace: &mut Workspace, scene: &str) {
    let all = "--show velocity,normal,penetration,trail,name,grid,clock --size 400x225";
    for jobs in [1, 3] {
        let flags = format!("--from 60 --to 150 --every 3 --jobs {jobs} --size 400x225");
        workspace.run(&format!("render {scene}.mcap -o {scene}-{jobs}.gif {flags}"));
        workspace.run(&format!("render {scene}.mcap -o {scene}-{jobs}.apng {flags} --theme dark"));
        workspace
            .run(&format!("render {scene}.mcap -o {scene}-{jobs} --from 100 --to 104 --every 2 --jobs {jobs} {all}"));
    }
    for (theme, color_by) in [("light", "body"), ("dark", "material"), ("light", "speed")] {
        let name = format!("{scene}-{theme}-{color_by}.png");
        workspace.run(&format!("render {scene}.mcap -o {name} --at 77 --theme {theme} --color-by {color_by} {all}"));
    }
}

/// Every figure in every format.
fn figures(workspace: &mut Workspace, scene: &str) {
    let kinds = ["collision", "minkowski", "strobe", "spacetime", "energy", "filmstrip"];
    for (kind, theme) in kinds.into_iter().zip(["light", "dark"].into_iter().cycle()) {
        for format in ["png", "svg", "pdf"] {
            let name = format!("{scene}-{kind}.{format}");
            workspace.run(&format!("figure {kind} {scene}.mcap -o {name} --size 640x360 --theme {theme}"));
        }
    }
}

/// The committed recordings.
fn committed(workspace: &mut Workspace) {
    for name in workspace::committed_recordings() {
        workspace.copy_in(&name);
        workspace.run(&format!("replay {name}"));
    }
}
