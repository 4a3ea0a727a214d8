//! Damaged recordings: every command names what is missing, with the same exit code.

use crate::altered_recordings::{SCENE, recorded, renamed, without_topic};
use crate::forge::{self, Item, Layout, each_record, op};
use crate::rebond::{Outcome, Workplace};
use std::collections::BTreeSet;

/// Returns a folder of damaged recordings: with a flipped bit in the chunk of the steps 20 to 39, and recovered from that
/// (gap.mcap), also without saying so (other-gap.mcap); without that chunk (hole.mcap); cut, and cut in the index; with
/// bytes before the start and after the end; with another top speed; without its scene; without keyframes, or with another
/// name of their topic; with a bit flipped in the index, or other statistics.
fn damaged() -> Workplace {
    let (workplace, file) = recorded();
    let parts = forge::take_apart(&file);
    let mut chunks = 0;
    let place = file.windows(8).enumerate().find(|(_, window)| {
        chunks += usize::from(window == b"\x04\0\0\0zstd");
        chunks == 4
    });
    let mut broken = file.clone();
    broken[place.unwrap().0 + 30] ^= 1;
    std::fs::write(workplace.path("flip.mcap"), &broken).unwrap();
    std::fs::write(workplace.path("cut.mcap"), &file[..file.len() / 2]).unwrap();
    std::fs::write(workplace.path("zeros.mcap"), [&file[..], &[0; 64]].concat()).unwrap();
    std::fs::write(workplace.path("bom.mcap"), [&b"\xef\xbb\xbf"[..], &file].concat()).unwrap();
    let mut altered = parts.clone();
    each_record(&mut altered, |record| {
        if record.0 == op::METADATA {
            let (name, mut map) = forge::parse_metadata(&record.1);
            map.entry("top_speed".into()).and_modify(|speed| *speed = "999.0 0x408f380000000000".into());
            *record = forge::metadata(&name, map);
        }
    });
    std::fs::write(workplace.path("altered.mcap"), forge::put_together(&altered, Layout::Zstd)).unwrap();
    let mut hole = parts.clone();
    let chunk = hole.iter().position(|item| matches!(item, Item::Chunk(_))).unwrap() + 3;
    hole.remove(chunk);
    std::fs::write(workplace.path("hole.mcap"), forge::put_together(&hole, Layout::Zstd)).unwrap();
    std::fs::write(workplace.path("no-footer.mcap"), &file[..file.len() - 20]).unwrap();
    let statistics = place_of_statistics(&file);
    broken = file.clone();
    broken[statistics] ^= 1;
    std::fs::write(workplace.path("index.mcap"), &broken).unwrap();
    let footer = broken.len() - 8;
    broken[footer - 4..footer].fill(0); // No checksum of the index.
    std::fs::write(workplace.path("statistics.mcap"), &broken).unwrap();
    std::fs::write(workplace.path("renamed.mcap"), renamed(&parts, "/bodies", "/boxes")).unwrap();
    std::fs::write(workplace.path("no-bodies.mcap"), without_topic(&parts, 3)).unwrap();
    altered.retain(|item| matches!(item, Item::Record(_)));
    std::fs::write(workplace.path("no-states.mcap"), forge::put_together(&altered, Layout::Zstd)).unwrap();
    let without_scene: Vec<Item> =
        parts.into_iter().filter(|item| !matches!(item, Item::Record((op::ATTACHMENT, _)))).collect();
    std::fs::write(workplace.path("no-scene.mcap"), forge::put_together(&without_scene, Layout::Zstd)).unwrap();
    assert_eq!(workplace.rebond("recover flip.mcap -o gap.mcap").code, 4);
    let mut gap = forge::take_apart(&workplace.read("gap.mcap"));
    each_record(&mut gap, |record| {
        if record.0 == op::METADATA {
            let (name, mut map) = forge::parse_metadata(&record.1);
            map.remove("recovered");
            *record = forge::metadata(&name, map);
        }
    });
    std::fs::write(workplace.path("other-gap.mcap"), forge::put_together(&gap, Layout::Zstd)).unwrap();
    workplace
}

/// Returns the offset of the number of messages in the statistics.
fn place_of_statistics(file: &[u8]) -> usize {
    let footer = file.len() - 8 - 20;
    let mut place = u64::from_le_bytes(file[footer..footer + 8].try_into().unwrap()) as usize;
    while file[place] != 0x0b {
        place += 9 + u64::from_le_bytes(file[place + 1..place + 9].try_into().unwrap()) as usize;
    }
    place + 9
}

#[test]
#[cfg_attr(debug_assertions, ignore = "slow in debug")]
fn every_command_names_the_gap_of_a_recovered_recording_and_draws_its_bodies() {
    let workplace = damaged();
    let missing = "steps 20 to 39 are missing";
    for command in ["info gap.mcap", "info gap.mcap --json", "replay gap.mcap", "replay gap.mcap --json"] {
        let Outcome { code, output, .. } = workplace.rebond(command);
        assert_eq!(code, 4, "{command}: {output}");
        assert!(output.contains(missing) && output.contains("recovered"), "{command}: {output}");
    }
    let checked = workplace.rebond("check gap.mcap");
    assert!(checked.code == 4 && checked.output.contains(missing), "{checked:?}");
    let overlays = [
        "none",
        "velocity",
        "momentum",
        "force",
        "normal",
        "impulse",
        "penetration",
        "com",
        "trail",
        "name",
        "mass",
        "grid",
        "axes",
        "scale",
        "clock",
    ];
    let help = workplace.done("render --help").output.split_whitespace().collect::<Vec<&str>>().join(" ");
    assert!(help.contains(&format!("none, or a list of {}", overlays[1..].join(", "))), "{help}");
    for (number, overlay) in overlays.into_iter().enumerate() {
        let drawn = workplace.rebond(&format!("render gap.mcap --at 55 --show {overlay} -o {number}.svg"));
        assert!(drawn.code == 4 && drawn.errors.contains(missing), "{overlay}: {drawn:?}");
        let picture = String::from_utf8(workplace.read(&format!("{number}.svg"))).unwrap();
        assert!(picture.matches("<path").count() + picture.matches("<rect").count() >= 2, "{overlay}: {picture}");
    }
    for (number, command) in [
        "render gap.mcap --follow c",
        "render gap.mcap --hold 0.2 at collisions",
        "figure strobe gap.mcap",
        "figure spacetime gap.mcap",
        "figure energy gap.mcap",
        "figure lines gap.mcap",
        "figure speeds gap.mcap",
        "figure pressure gap.mcap",
        "figure velocity-space gap.mcap",
        "figure filmstrip gap.mcap",
        "figure collision gap.mcap",
        "figure minkowski gap.mcap",
        "export gap.mcap",
    ]
    .into_iter()
    .enumerate()
    {
        let kind = match command.split(' ').next() {
            Some("render") => "gif",
            Some("export") => "csv",
            _ => "svg",
        };
        let done = workplace.rebond(&format!("{command} -o out{number}.{kind}"));
        assert!(done.code == 4 && done.errors.contains(missing), "{command}: {done:?}");
    }
    let range = workplace.rebond("render gap.mcap --from 25 --to 30 -o range.gif");
    assert_ne!(range.code, 0, "{range:?}");
}

/// After a loss the bodies alive are unknown until the next keyframe (steps 20, 40 and 60). The chunks begin at the steps 0,
/// 1, 6, 20, 40, 51 and 60.
#[test]
fn a_gap_reaches_to_the_next_keyframe() {
    let workplace = Workplace::with_scene(SCENE);
    workplace.done("record scene.toml -o run.mcap");
    let file = workplace.read("run.mcap");
    let chunks: Vec<usize> = (0..file.len() - 8).filter(|at| file[*at..*at + 8] == *b"\x04\0\0\0zstd").collect();
    assert_eq!(chunks.iter().filter(|at| file[**at - 37] == op::CHUNK).count(), 7, "{chunks:?}");
    for (chunk, first, last) in [(1, 1, 19), (2, 6, 19), (3, 20, 39), (4, 40, 59), (5, 51, 59), (6, 60, 60)] {
        let mut broken = file.clone();
        broken[chunks[chunk] + 30] ^= 1;
        std::fs::write(workplace.path("broken.mcap"), &broken).unwrap();
        let recovered = workplace.rebond("recover broken.mcap -o fixed.mcap --force");
        let kept = 60 - (last - first);
        let states = format!("recovered {kept} states up to step {}\n", if last == 60 { 59 } else { 60 });
        assert!(recovered.code == 4 && recovered.output.starts_with(&states), "{chunk}: {recovered:?}");
        let lost = match (first, last) {
            (60, _) => "\nlost step 60: 1 state, 0.05 s\n".to_owned(),
            _ => format!("\nlost steps {first} to {last}: {} states, ", last - first + 1),
        };
        assert!(recovered.output.contains(&lost), "{chunk}: {recovered:?}");
        let words = match last - first {
            0 => "step 60 is missing".to_owned(),
            _ => format!("steps {first} to {last} are missing"),
        };
        let json = format!("\"steps\":[{{\"from\":{first},\"to\":{last}}}]");
        for name in ["broken", "fixed"] {
            for command in ["info FILE", "replay FILE", "export FILE -o out.csv --force", "info FILE --json"] {
                let done = workplace.rebond(&command.replace("FILE", &format!("{name}.mcap")));
                let text = format!("{}{}", done.output, done.errors);
                assert!(done.code == 4 && text.contains(&words), "{chunk}, {command}, {name}: {done:?}");
                let is_listed = text.replace(' ', "").contains(&json);
                assert!(is_listed || !command.contains("--json"), "{chunk}, {name}: {text}");
            }
            let table = String::from_utf8(workplace.read("out.csv")).unwrap();
            let against = workplace.rebond(&format!("replay {name}.mcap --against out.csv"));
            let is_corrupt = name == "broken";
            assert_eq!(against.output.starts_with("incomplete recording: recovered; step"), !is_corrupt, "{against:?}");
            let steps: BTreeSet<u64> =
                table.lines().skip(1).map(|line| line.split(',').next().unwrap().parse().unwrap()).collect();
            let expected: BTreeSet<u64> = (0..=60).filter(|step| !(first..=last).contains(step)).collect();
            assert_eq!(steps, expected, "{chunk}, {name}");
        }
    }
}

/// Of the kinds that show one collision, see below.
#[test]
fn every_kind_of_figure_of_a_run_shows_a_gap_with_its_reason() {
    let workplace = damaged();
    let help = workplace.done("figure --help").output.split_whitespace().collect::<Vec<&str>>().join(" ");
    let kinds = help.split("The figure: ").nth(1).unwrap().split(" <SOURCE>").next().unwrap();
    let kinds = kinds.replace(" or ", ", ");
    let kinds: Vec<&str> = kinds.split([',', ' ']).filter(|kind| !kind.is_empty() && *kind != "...").collect();
    let kinds =
        kinds.into_iter().take_while(|kind| kind.chars().all(|letter| letter.is_ascii_lowercase() || letter == '-'));
    let kinds: Vec<&str> = kinds.filter(|kind| !["collision", "minkowski"].contains(kind)).collect();
    assert!(kinds.len() >= 7 && kinds.contains(&"velocity-space"), "{kinds:?}");
    let variants = ["x", "y", "vx", "vy", "speed", "height", "E", "p"].map(|name| format!("lines --quantity {name}"));
    for kind in kinds.iter().map(|kind| (*kind).to_owned()).chain(variants) {
        let (lost, unreadable) = ("lost in a damaged recording", "unreadable");
        for (sources, reason) in [("gap.mcap", lost), ("gap.mcap run.mcap", lost), ("flip.mcap", unreadable)] {
            // Velocities of many bodies are those of the last state, which needs no other; those of a pair are a path.
            let bodies = if kind == "velocity-space" && reason == unreadable { "--bodies a,c" } else { "" };
            let drawn = workplace.rebond(&format!("figure {kind} {sources} {bodies} --force -o kind.svg"));
            assert_eq!(drawn.code, 4, "{kind} {sources}: {drawn:?}");
            let picture = String::from_utf8(workplace.read("kind.svg")).unwrap();
            let words = format!("steps 20–39 {reason}</text>");
            assert!(picture.contains(&words), "{kind} {sources} shows no gap");
        }
    }
}

/// The table of the guide: the exit code of each command on each kind of damage.
#[test]
#[cfg_attr(debug_assertions, ignore = "slow in debug")]
fn exit_codes_agree_between_commands_on_the_same_damaged_file() {
    let workplace = damaged();
    workplace.write("text.mcap", "\u{feff}not MCAP");
    std::fs::write(workplace.path("start.mcap"), &workplace.read("run.mcap")[..400]).unwrap();
    let corrupt = ["flip", "hole", "zeros", "bom", "altered", "index", "statistics", "renamed", "no-states"];
    let incomplete = ["cut", "no-footer", "gap", "other-gap", "no-scene", "no-bodies"];
    let files =
        corrupt.map(|file| (file, 4, "corrupt")).into_iter().chain(incomplete.map(|file| (file, 4, "incomplete")));
    let files = files.chain([("start", 4, "truncated before its settings"), ("run", 0, ""), ("text", 1, "MCAP file")]);
    for (file, code, word) in files {
        for command in [
            "info FILE.mcap",
            "replay FILE.mcap",
            "check FILE.mcap",
            "export FILE.mcap -o FILE.csv",
            "export FILE.mcap --table collisions -o FILE.csv",
            "export FILE.mcap --table energy -o FILE.csv",
            "render FILE.mcap --at 15 -o FILE.png",
            "render FILE.mcap -o FILE.gif",
            "render FILE.mcap --size 320x180 -o FILE.apng",
            "render FILE.mcap --size 320x180 -o FILE-frames/",
            "figure strobe FILE.mcap -o FILE.svg",
            "figure energy FILE.mcap -o FILE.svg",
            "figure spacetime FILE.mcap -o FILE.svg",
            "figure filmstrip FILE.mcap -o FILE.svg",
            "export FILE.mcap -o FILE-bodies.mcap",
            "export FILE.mcap --table bodies -o FILE.csv",
            "figure collision FILE.mcap -o FILE.svg",
        ] {
            // These end before the damage and need not read it; what metadata and index say is missing is known to all.
            let is_partial = command.contains("--at") || command.contains("figure collision");
            let may_miss = is_partial && ["flip", "altered"].contains(&file);
            let force = if command.contains(" -o ") { " --force" } else { "" };
            let done = workplace.rebond(&format!("{}{force}", command.replace("FILE", file)));
            let text = format!("{}{}", done.output, done.errors);
            let is_named = text.contains(word) || file == "no-states" && text.contains("no state of the recording");
            assert!(done.code == code && is_named || may_miss && done.code == 0, "{command} {file}: {done:?}");
        }
    }
}

/// The steps 20 to 39 are missing.
#[test]
fn steps_that_are_all_missing_are_an_error_of_every_command() {
    let workplace = damaged();
    let before = workplace.names();
    let kinds = ["strobe", "spacetime", "energy", "filmstrip", "lines", "speeds", "pressure", "velocity-space"];
    let figures = kinds.iter().map(|kind| format!("figure {kind} FILE --from 25 --to 30 -o out.svg"));
    let others = [
        "replay FILE --from 25 --to 30",
        "render FILE --from 25 --to 30 -o out.gif",
        "render FILE --from 25 --to 30 --show impulse -o out.apng",
        "render FILE --from 25 --to 30 -o out/",
        "render FILE --at 25 -o out.png",
        "render FILE --at 25 --show impulse -o out.png",
        "figure velocity-space FILE --bodies a,c --from 25 --to 30 -o out.svg",
        "export FILE --from 25 --to 30 -o out.csv",
        "export FILE --from 25 --to 30 -o out.mcap",
        "export FILE --table energy --from 25 --to 30",
        "export FILE --table collisions --from 25 --to 30 -o out.jsonl",
    ];
    for command in figures.chain(others.map(str::to_owned)) {
        for file in ["gap.mcap", "flip.mcap", "hole.mcap"] {
            let done = workplace.rebond(&command.replace("FILE", file));
            let is_named = done.errors.contains("there is no state ") && done.errors.contains("20 to 39 are missing");
            assert!(done.code == 4 && is_named && done.output.is_empty(), "{command} {file}: {done:?}");
            assert_eq!(workplace.names(), before, "{command} {file}");
        }
    }
    for command in ["replay FILE --from 59", "render FILE --at 59 -o out.png", "render FILE --from 59 -o out.gif"]
        .into_iter()
        .chain(["figure energy FILE --from 59 -o out.svg", "figure strobe FILE --from 59 -o out.svg"])
        .chain(["export FILE --from 59 -o out.csv", "export FILE --table collisions --from 59"])
    {
        let done = workplace.rebond(&command.replace("FILE", "cut.mcap"));
        let is_named = done.errors.contains("there is no state ") && done.errors.contains("incomplete: ");
        assert!(done.code == 4 && is_named, "{command}: {done:?}");
        assert_eq!(workplace.rebond(&command.replace("FILE", "run.mcap").replace("59", "61")).code, 1, "{command}");
    }
    assert_eq!(workplace.names(), before);
}

#[test]
fn a_gap_at_the_end_of_the_chosen_steps_is_shown() {
    let workplace = damaged();
    for (file, reason) in [("gap.mcap", "lost in a damaged recording"), ("flip.mcap", "unreadable")] {
        for kind in ["energy", "spacetime", "lines", "speeds", "pressure", "strobe", "filmstrip"] {
            for (range, steps) in [("--from 0 --to 30", "20–30"), ("--from 30 --to 50", "30–39")] {
                if kind == "pressure" && steps == "30–39" {
                    continue; // No body hits a wall there.
                }
                let drawn = workplace.rebond(&format!("figure {kind} {file} {range} --force -o out.svg"));
                assert_eq!(drawn.code, 4, "{kind} {file} {range}: {drawn:?}");
                let picture = String::from_utf8(workplace.read("out.svg")).unwrap();
                // Single states are not those of a part of the gap.
                let steps = if ["strobe", "filmstrip"].contains(&kind) { "20–39" } else { steps };
                let words = format!("steps {steps} {reason}</text>");
                assert!(picture.contains(&words), "{kind} {file} {range} lacks {words:?}");
            }
        }
    }
    let folder = workplace.rebond("render gap.mcap --size 160x120 -o frames/");
    assert!(folder.output.starts_with("frames/: 41 frames, every step"), "{folder:?}");
}

/// The first collision of all may be in the part that cannot be read.
#[test]
fn a_collision_after_a_damaged_part_is_shown_with_the_damage() {
    let workplace = damaged();
    for (figure, name) in [("collision", "a.svg"), ("minkowski", "b.svg")] {
        let line = format!("figure {figure} flip.mcap --step 25 -o {name}");
        let drawn = workplace.rebond(&line);
        assert!(drawn.code == 4 && drawn.errors.contains("steps 20 to 39 are missing"), "{line}: {drawn:?}");
    }
}

/// The collision shown may not be the first one, which the picture itself says.
#[test]
fn a_figure_of_a_collision_names_the_steps_before_it_that_are_missing() {
    let workplace = damaged();
    for figure in ["collision", "minkowski"] {
        for (file, reason) in [("gap.mcap", "lost in a damaged recording"), ("flip.mcap", "unreadable")] {
            let line = format!("figure {figure} {file} --step 25 -o {figure}.svg --force");
            let drawn = workplace.rebond(&line);
            let picture = String::from_utf8(workplace.read(&format!("{figure}.svg"))).unwrap();
            assert!(drawn.code == 4 && picture.contains(&format!("steps 20–39 {reason}</text>")), "{line}: {drawn:?}");
        }
        workplace.done(&format!("figure {figure} run.mcap --step 0 -o whole.svg --force"));
        let whole = String::from_utf8(workplace.read("whole.svg")).unwrap();
        assert!(!whole.contains("steps 20–39"), "{figure}");
    }
}

/// A body may have lived only in the part that is lost.
#[test]
fn a_body_that_a_damaged_recording_does_not_contain_is_reported_with_the_damage() {
    let workplace = damaged();
    for line in [
        "render FILE --at 10 --follow lost -o a.png",
        "figure lines FILE --bodies lost -o a.svg",
        "figure strobe FILE --bodies lost -o a.svg",
        "figure collision FILE --pair a,lost -o a.svg",
        "figure pressure FILE --from 41 --to 42 -o a.svg",
    ] {
        for file in ["gap.mcap", "flip.mcap", "hole.mcap"] {
            let drawn = workplace.rebond(&line.replace("FILE", file));
            assert!(drawn.code == 4 && drawn.errors.contains("nothing to show"), "{line}, {file}: {drawn:?}");
            assert!(drawn.errors.contains("steps 20 to 39 are missing"), "{line}, {file}: {drawn:?}");
        }
        let drawn = workplace.rebond(&line.replace("FILE", "run.mcap"));
        assert!(drawn.code == 1 && drawn.errors.contains("nothing to show"), "{line}: {drawn:?}");
    }
}

#[test]
fn nothing_after_the_chosen_steps_is_replayed_across_a_gap() {
    let workplace = damaged();
    let collisions = |file: &str, last: u64| {
        let mut count = rebond::CollisionCount::default();
        let mut replayer = rebond::Replayer::open(&workplace.path(file), 0..=last).unwrap();
        while replayer.next_state(&mut count).unwrap().is_some() {}
        count
    };
    assert_eq!(collisions("gap.mcap", 30), collisions("run.mcap", 19));
    assert_ne!(collisions("gap.mcap", 60), collisions("run.mcap", 19));
    let early = workplace.rebond("figure velocity-space run.mcap --bodies a,c --to 4 -o early.svg");
    assert!(early.code == 1 && early.errors.contains("never alive at the same time in the steps 0 to 4"), "{early:?}");
}

#[test]
fn the_steps_of_lost_events_are_unknown() {
    let workplace =
        Workplace::with_scene(&SCENE.replace("step = 5\n", "step = 25\n").replace("step = 50", "step = 30"));
    workplace.done("record scene.toml -o run.mcap");
    let mut parts = forge::take_apart(&workplace.read("run.mcap"));
    let lost = 1_000_000_000..2_000_000_000;
    let is_lost = |(opcode, body): &forge::Record| {
        *opcode == op::MESSAGE && lost.contains(&u64::from_le_bytes(body[6..14].try_into().unwrap()))
    };
    parts.retain(|item| !matches!(item, Item::Chunk(records) if records.iter().any(is_lost)));
    std::fs::write(workplace.path("hole.mcap"), forge::put_together(&parts, Layout::Zstd)).unwrap();
    assert_eq!(workplace.rebond("recover hole.mcap -o gap.mcap").code, 4);
    for file in ["gap.mcap", "hole.mcap"] {
        let bodies = |range: &str| {
            let table = workplace.rebond(&format!("export {file} --table bodies {range}")).output;
            let rows = table.lines().map(|line| line.split(',').collect::<Vec<&str>>());
            rows.map(|row| [row[0], row[7], row[8]].join(" ")).skip(5).collect::<Vec<String>>()
        };
        assert_eq!(bodies(""), ["a 0 unknown", "c unknown "], "{file}");
        assert_eq!(bodies("--to 19"), ["a 0 unknown"], "{file}");
        assert_eq!(bodies("--from 40"), ["c unknown "], "{file}");
        assert_eq!(bodies("--from 25 --to 30"), ["a 0 unknown", "c unknown "], "{file}");
    }
}

#[test]
fn the_deletes_after_a_cut_are_unknown() {
    let workplace = Workplace::with_scene(SCENE);
    workplace.done("record scene.toml -o run.mcap");
    let file = workplace.read("run.mcap");
    std::fs::write(workplace.path("cut.mcap"), &file[..file.len() / 2]).unwrap();
    assert_eq!(workplace.rebond("recover cut.mcap -o fixed.mcap").code, 4);
    for name in ["cut.mcap", "fixed.mcap"] {
        let table = workplace.rebond(&format!("export {name} --table bodies"));
        assert_eq!(table.code, 4, "{table:?}");
        let deleted: Vec<&str> = table.output.lines().skip(1).map(|line| line.split(',').nth(8).unwrap()).collect();
        assert_eq!(deleted, ["unknown"; 6], "{name}");
    }
}

/// 1 before 4 before 3, as of `check`.
#[test]
fn an_unreadable_file_goes_before_a_damaged_one_in_info() {
    let workplace = Workplace::with_scene(SCENE);
    workplace.done("record scene.toml -o run.mcap");
    let file = workplace.read("run.mcap");
    std::fs::write(workplace.path("cut.mcap"), &file[..file.len() / 2]).unwrap();
    for (files, code) in [("missing cut.mcap", 1), ("cut.mcap missing", 1), ("run.mcap cut.mcap", 4), ("run.mcap", 0)] {
        let info = workplace.rebond(&format!("info {files}"));
        assert_eq!(info.code, code, "{files}: {info:?}");
    }
}
