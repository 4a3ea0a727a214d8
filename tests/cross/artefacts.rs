//! A fixed set of what rebond makes: one line for each artefact, the same on every machine.
//!
//! Only the program that is asked for runs elsewhere; what it leaves behind is read here.

#[path = "bench.rs"]
mod bench;
#[path = "content.rs"]
mod content;

pub use bench::Program;

use bench::Bench;

/// Size (bytes), digest of what is decoded, digest of the file, name: a line for each.
pub fn digests(program: &Program) -> String {
    let mut bench = Bench::new(program);
    for (scene, steps) in SCENES {
        bench.take(&format!("{scene}.toml"));
        runs(&mut bench, scene, *steps);
    }
    live_events(&mut bench);
    overflow(&mut bench);
    for scene in ["click-session", "pile"] {
        damage(&mut bench, scene);
        pictures(&mut bench, scene);
    }
    for scene in ["figure-1", "cradle"] {
        figures(&mut bench, scene);
    }
    committed(&mut bench);
    bench.lines
}

/// Both solvers, and how far each scene is run.
const SCENES: &[(&str, u64)] = &[
    // The handout's.
    ("click-session", 480),
    ("constant-force", 240),
    ("falling-heap", 180),
    ("figure-1", 60),
    ("gas", 90),
    ("materials", 480),
    ("overlapping-boxes", 14),
    ("sinking-stack", 180),
    ("spawn-and-delete", 480),
    // The exact one.
    ("bullet-exact", 120),
    ("cradle", 600),
    ("elastic-gas", 60),
    ("galperin", 1200),
    ("pile", 180),
    ("stack-foot-removed", 600),
    ("tile-seams", 300),
    ("zeno-bounce", 1200),
];

/// Records, replays all and a part that a keyframe is found for, tells and tabulates.
fn runs(bench: &mut Bench, scene: &str, steps: u64) {
    let [from, to] = [steps / 2, steps / 2 + 10];
    bench.done(&format!("record {scene}.toml -o {scene}.mcap --steps {steps}"));
    bench.done(&format!("replay {scene}.mcap"));
    bench.done(&format!("replay {scene}.mcap --from {from} --to {to}"));
    bench.done(&format!("info {scene}.mcap --json"));
    bench.done(&format!("export {scene}.mcap -o {scene}.csv --from {from} --to {to}"));
}

/// What comes in while a run goes on, thinned.
fn live_events(bench: &mut Bench) {
    let events = r#"{"click": {"step": 30, "at": [8, 2], "spawn": {"size": [0.7, 0.3], "mass": 0.1}}}
{"spawn": {"step": 31, "name": "late", "at": [1.1, 1.3], "size": [0.2, 0.2], "mass": 3, "velocity": [1e-3, -0.0]}}
{"delete": {"step": 70, "name": "late"}}
"#;
    bench.put("events.jsonl", events.as_bytes());
    bench.done("record figure-1.toml -o live.mcap --steps 90 --every 7 --events events.jsonl");
    bench.done("replay live.mcap");
    bench.done("export live.mcap -o live.jsonl");
}

/// A run that leaves the finite numbers: where processors make different NaN.
fn overflow(bench: &mut Bench) {
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
        bench.put(&format!("{name}.toml"), scene.as_bytes());
        bench.ends(1, &format!("record {name}.toml -o {name}.mcap"));
        bench.done(&format!("replay {name}.mcap"));
    }
}

/// Recordings cut short and with a bit turned over: judged, searched and recovered.
fn damage(bench: &mut Bench, scene: &str) {
    let whole = bench.read(&format!("{scene}.mcap"));
    let cut = whole[..whole.len() * 2 / 3].to_vec();
    let mut flipped = whole;
    let middle = flipped.len() / 2;
    flipped[middle] ^= 1;
    for (kind, bytes) in [("cut", cut), ("flipped", flipped)] {
        let name = format!("{scene}-{kind}");
        bench.put(&format!("{name}.mcap"), &bytes);
        bench.ends(4, &format!("replay {name}.mcap"));
        bench.ends(4, &format!("info {name}.mcap"));
        bench.done(&format!("recover {name}.mcap -o {name}-recovered.mcap"));
        bench.done(&format!("replay {name}-recovered.mcap"));
    }
}

/// Animations and pictures in every colouring, on one thread and on three.
fn pictures(bench: &mut Bench, scene: &str) {
    let all = "--show velocity,normal,penetration,trail,name,grid,clock --size 400x225";
    for jobs in [1, 3] {
        let flags = format!("--from 60 --to 150 --every 3 --jobs {jobs} --size 400x225");
        bench.done(&format!("render {scene}.mcap -o {scene}-{jobs}.gif {flags}"));
        bench.done(&format!("render {scene}.mcap -o {scene}-{jobs}.apng {flags} --theme dark"));
        bench.done(&format!("render {scene}.mcap -o {scene}-{jobs} --from 100 --to 104 --every 2 --jobs {jobs} {all}"));
    }
    for (theme, colours) in [("light", "body"), ("dark", "material"), ("light", "speed")] {
        let name = format!("{scene}-{theme}-{colours}.png");
        bench.done(&format!("render {scene}.mcap -o {name} --at 77 --theme {theme} --color-by {colours} {all}"));
    }
}

/// Every kind in every format.
fn figures(bench: &mut Bench, scene: &str) {
    let kinds = ["collision", "minkowski", "strobe", "spacetime", "energy", "filmstrip"];
    for (kind, theme) in kinds.into_iter().zip(["light", "dark"].into_iter().cycle()) {
        for format in ["png", "svg", "pdf"] {
            let name = format!("{scene}-{kind}.{format}");
            bench.done(&format!("figure {kind} {scene}.mcap -o {name} --size 640x360 --theme {theme}"));
        }
    }
}

/// The recordings that were made long ago.
fn committed(bench: &mut Bench) {
    for name in bench::committed_recordings() {
        bench.take(&name);
        bench.done(&format!("replay {name}"));
    }
}
