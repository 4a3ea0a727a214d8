//! Recordings that were altered with all checksums correct: `same` means that everything was compared.

use crate::forge::{self, Item, Layout, each_record, op, verdict};
use crate::rebond::Workplace;
use rebond::internals::recording::{self, Recording};
use std::io::Cursor;

/// Two boxes between walls, one of them spawned in a later chunk than the first; three seconds.
pub const SCENE: &str = r##"
title = "Altered"
[world]
size = [8.0, 6.0]
walls = true
gravity = [0.0, 9.81]
[run]
rate = 20
steps = 60
[restitution]
default = 0.9
[[spawn]]
name = "a"
at = [1.0, 1.0]
size = [1.0, 1.0]
mass = 2.0
velocity = [3.0, -1.0]
color = "#3366cc"
[[spawn]]
name = "c"
step = 5
at = [5.0, 3.0]
size = [0.5, 1.5]
mass = 1.0
force = [-1.0, 0.0]
[[delete]]
name = "a"
step = 50
"##;

pub fn recorded() -> (Workplace, Vec<u8>) {
    let workplace = Workplace::with_scene(SCENE);
    workplace.done("record scene.toml -o run.mcap --viewer --accuracy");
    let file = workplace.read("run.mcap");
    (workplace, file)
}

/// The items of a recording.
pub fn items(file: &[u8]) -> Vec<recording::Item> {
    Recording::read(Cursor::new(file)).map_or(Vec::new(), |recording| recording.map(|item| item.unwrap()).collect())
}

/// Flips a bit of every few bytes of every record, with all checksums correct.
#[test]
#[cfg_attr(debug_assertions, ignore = "slow in debug")]
fn no_altered_record_replays_the_same() {
    let (_workplace, file) = recorded();
    let parts = forge::take_apart(&file);
    let original = items(&file);
    let mut seen = 0;
    let mut count = 0;
    each_record(&mut parts.clone(), |(_, body)| count += body.len());
    let stride = count / 600 + 1;
    for target in (0..count).step_by(stride) {
        let mut altered = parts.clone();
        let mut position = 0;
        let mut what = String::new();
        each_record(&mut altered, |(opcode, body)| {
            if (position..position + body.len()).contains(&target) {
                let index = target - position;
                // Channels, sequence numbers, the header and the checksums belong to the container.
                let is_container = match *opcode {
                    op::MESSAGE => index < 6,
                    op::ATTACHMENT => index + 4 >= body.len(),
                    op::METADATA | op::CHANNEL | 0x01 => true,
                    _ => false,
                };
                if !is_container {
                    body[index] ^= 1 << (target % 8);
                    what = format!("opcode {opcode:#04x}, byte {index}");
                    if *opcode == op::ATTACHMENT {
                        forge::seal_attachment(body);
                    }
                }
            }
            position += body.len();
        });
        if what.is_empty() {
            continue;
        }
        let altered = forge::put_together(&altered, Layout::Uncompressed);
        let found = verdict(&altered);
        let is_padding = found.starts_with("same: ") && items(&altered) == original;
        assert!(!found.starts_with("same: ") || is_padding, "{what}: {found}");
        seen += 1;
    }
    assert!(seen > 400, "only {seen} alterations");
}

/// Alters or removes one value of the metadata, in the header record, in the end record, and in both.
#[test]
fn no_altered_metadata_replay_the_same() {
    let (_workplace, file) = recorded();
    let parts = forge::take_apart(&file);
    let mut names = Vec::new();
    each_record(&mut parts.clone(), |(opcode, body)| {
        if *opcode == op::METADATA {
            let (name, map) = forge::parse_metadata(body);
            names.extend(map.into_keys().map(|key| (name.clone(), key)));
        }
    });
    names.retain(|(_, key)| !["checksum", "library"].contains(&key.as_str()));
    for (name, key) in &names {
        for (is_everywhere, is_removed) in [(false, false), (false, true), (true, false), (true, true)] {
            let mut altered = parts.clone();
            each_record(&mut altered, |(opcode, body)| {
                if *opcode != op::METADATA {
                    return;
                }
                let (found, mut map) = forge::parse_metadata(body);
                if found == *name || is_everywhere {
                    if let Some(value) = map.remove(key)
                        && !is_removed
                    {
                        map.insert(key.clone(), altered_value(&value));
                    }
                    (*opcode, *body) = forge::metadata(&found, map);
                }
            });
            let found = verdict(&forge::put_together(&altered, Layout::Zstd));
            assert!(
                !found.starts_with("same: "),
                "{name} {key} everywhere: {is_everywhere}, removed: {is_removed}: {found}"
            );
        }
    }
}

/// Changes the last digit of a number, or of the decimal of a float, which are stored as text.
fn altered_value(value: &str) -> String {
    let (first, rest) = value.split_once(' ').unwrap_or((value, ""));
    let mut characters: Vec<char> = first.chars().collect();
    if let Some(last) = characters.last_mut() {
        *last = if *last == '1' { '2' } else { '1' };
    }
    format!("{} {rest}", String::from_iter(characters)).trim_end().to_owned()
}

#[test]
fn altered_times_schemas_and_end_records_are_named() {
    let workplace = Workplace::with_scene(SCENE);
    workplace.done("record scene.toml -o run.mcap --accuracy");
    let parts = forge::take_apart(&workplace.read("run.mcap"));
    let with = |alter: &dyn Fn(&mut forge::Record)| {
        let mut altered = parts.clone();
        each_record(&mut altered, |record| alter(record));
        verdict(&forge::put_together(&altered, Layout::Zstd))
    };
    let times = with(&|(opcode, body)| {
        if *opcode == op::MESSAGE {
            for range in [6..14, 14..22] {
                let time = u64::from_le_bytes(body[range.clone()].try_into().unwrap());
                body[range].copy_from_slice(&(time * 10).to_le_bytes());
            }
        }
    });
    assert!(times.starts_with("corrupt ") && times.contains("log time"), "{times}");
    let schemas = with(&|(opcode, body)| {
        if *opcode == op::SCHEMA {
            *body.last_mut().unwrap() ^= 1;
        }
    });
    assert!(schemas.starts_with("corrupt ") && schemas.contains("the schema of the topic"), "{schemas}");
    for (key, value, named) in [
        ("steps", "59", "a state 60, but the metadata plan 59 steps"),
        ("steps", "0", "a state 1, but the metadata plan 0 steps"),
        ("top_speed", "999.0 0x408f380000000000", "top speed"),
        ("collisions", "987654", "987654 collisions"),
        ("bodies", "9", "9 bodies"),
        ("steps_taken", "59", "59 steps"),
        ("events", "2", "2 events"),
        ("accurate_until", "30", "the accuracy 1e-10 until step 30, the replay 1e-10 throughout"),
    ] {
        let found = with(&|record| {
            if record.0 == op::METADATA {
                let (name, mut map) = forge::parse_metadata(&record.1);
                map.entry(key.into()).and_modify(|found| *found = value.into());
                *record = forge::metadata(&name, map);
            }
        });
        assert!(found.contains(named), "{key}: {found}");
    }
}

#[test]
fn duplicated_records_are_corrupt() {
    let (_workplace, file) = recorded();
    let parts = forge::take_apart(&file);
    for (index, item) in parts.iter().enumerate() {
        let Item::Record((opcode @ (op::ATTACHMENT | op::METADATA), _)) = item else { continue };
        for place in [index + 1, parts.len()] {
            let mut altered = parts.clone();
            altered.insert(place, item.clone());
            let found = verdict(&forge::put_together(&altered, Layout::Zstd));
            assert!(found.starts_with("corrupt ") && found.contains("a second "), "opcode {opcode:#04x}: {found}");
        }
    }
}

#[test]
fn a_missing_keyframe_and_missing_settings_are_named() {
    let (workplace, file) = recorded();
    let parts = forge::take_apart(&file);
    let mut keyframes = 0;
    each_record(&mut parts.clone(), |record| keyframes += u32::from(is_keyframe(record)));
    assert_eq!(keyframes, 4, "of three seconds");
    for removed in 0..keyframes {
        let mut altered = parts.clone();
        let mut number = 0;
        for item in &mut altered {
            if let Item::Chunk(records) = item {
                records.retain(|record| {
                    number += u32::from(is_keyframe(record));
                    !is_keyframe(record) || number != removed + 1
                });
            }
        }
        let found = verdict(&forge::put_together(&altered, Layout::Zstd));
        let named = format!("the keyframe of step {} is missing", removed * 20);
        assert!(found.starts_with("corrupt ") && found.contains(&named), "{named}: {found}");
        assert!(!found.contains("topic"), "{named}: {found}");
    }
    let without_settings: Vec<Item> = parts.into_iter().filter(|item| !is_metadata(item, "rebond")).collect();
    let altered = forge::put_together(&without_settings, Layout::Zstd);
    let found = verdict(&altered);
    assert!(found.starts_with("corrupt ") && found.contains("the metadata record \"rebond\" is missing"), "{found}");
    std::fs::write(workplace.path("altered.mcap"), altered).unwrap();
    assert_eq!(workplace.rebond("recover altered.mcap -o fixed.mcap").code, 4);
    let fixed = workplace.rebond("replay fixed.mcap").output;
    assert_eq!(fixed, "incomplete: recovered; 60 steps same\n");
}

/// Alters and removes the boxes for viewers of each state in turn.
#[test]
fn a_recording_with_some_damaged_scene_updates_is_recovered_without_them() {
    const SCENE_UPDATES: [u8; 2] = 4_u16.to_le_bytes();
    let (workplace, file) = recorded();
    let parts = forge::take_apart(&file);
    let is_scene_update = |(opcode, body): &forge::Record| *opcode == op::MESSAGE && body[..2] == SCENE_UPDATES;
    for (damaged, removed) in [0, 1, 30, 60].into_iter().flat_map(|step| [(step, false), (step, true)]) {
        let mut altered = parts.clone();
        let mut step = -1;
        for item in &mut altered {
            if let Item::Chunk(records) = item {
                records.retain_mut(|record| {
                    step += i32::from(is_scene_update(record));
                    let is_damaged = is_scene_update(record) && step == damaged;
                    if is_damaged && !removed {
                        *record.1.last_mut().unwrap() ^= 0x10; // The colour or position of the last box.
                    }
                    !is_damaged || !removed
                });
            }
        }
        let altered = forge::put_together(&altered, Layout::Zstd);
        let found = verdict(&altered);
        assert!(found.starts_with("corrupt ") && found.contains("scene update"), "step {damaged}: {found}");
        std::fs::write(workplace.path("altered.mcap"), altered).unwrap();
        let recovered = workplace.rebond("recover altered.mcap -o fixed.mcap --force");
        assert!(recovered.code == 4 && recovered.output.contains("lost the topic /scene"), "{recovered:?}");
        assert_eq!(workplace.rebond("replay fixed.mcap").output, "incomplete: recovered; 60 steps same\n");
    }
}

/// Recognises a keyframe by the channel of `/bodies`.
fn is_keyframe((opcode, body): &forge::Record) -> bool {
    const BODIES: [u8; 2] = 3_u16.to_le_bytes();
    *opcode == op::MESSAGE && body[..2] == BODIES
}

/// The state at step 40 is compared from the keyframe of step 20 on, so the keyframe of step 40 is compared, too.
#[test]
fn a_replay_that_starts_at_a_keyframe_compares_it() {
    let (workplace, file) = recorded();
    let mut parts = forge::take_apart(&file);
    let mut keyframes = 0;
    each_record(&mut parts, |record| {
        keyframes += usize::from(is_keyframe(record));
        if is_keyframe(record) && keyframes == 3 {
            let last_number = record.1.len() - 8;
            record.1[last_number] ^= 1;
        }
    });
    std::fs::write(workplace.path("altered.mcap"), forge::put_together(&parts, Layout::Zstd)).unwrap();
    for (range, code) in [("", 3), ("--from 40", 3), ("--from 40 --to 40", 3), ("--from 21 --to 39", 0)] {
        let replayed = workplace.rebond(&format!("replay altered.mcap {range}"));
        assert_eq!(replayed.code, code, "{range}: {replayed:?}");
        let is_named = replayed.output.starts_with("diverged at step 40: the keyframe has other solver_numbers");
        assert!(code == 0 || is_named, "{range}: {replayed:?}");
    }
}

fn is_metadata(item: &Item, name: &str) -> bool {
    matches!(item, Item::Record((op::METADATA, body)) if forge::parse_metadata(body).0 == name)
}

/// A state that is recorded as a digest has nothing else with which the reader could compare it.
#[test]
fn recover_reports_that_a_recording_with_an_altered_digest_does_not_replay_the_same() {
    let workplace = Workplace::with_scene(SCENE);
    workplace.done("record scene.toml -o run.mcap --every 2");
    let mut parts = forge::take_apart(&workplace.read("run.mcap"));
    each_record(&mut parts, |(opcode, body)| {
        if *opcode == op::MESSAGE && body[..2] == [2, 0] && body[26..34] == 31_u64.to_le_bytes() {
            body[34] ^= 1;
        }
    });
    std::fs::write(workplace.path("altered.mcap"), forge::put_together(&parts, Layout::Zstd)).unwrap();
    let recovered = workplace.rebond("recover altered.mcap -o fixed.mcap");
    let expected = "\nthe new recording does not replay the same: diverged at step 31: the digest of all bodies";
    assert!(recovered.code == 4 && recovered.output.contains(expected), "{recovered:?}");
    assert_eq!(workplace.rebond("replay fixed.mcap").code, 3);
}

/// A state whose step lies beyond the plan is skipped, and what follows it is read, whatever the times of its message.
#[test]
fn a_step_beyond_the_plan_does_not_hide_the_later_states() {
    let workplace = Workplace::with_scene(SCENE);
    workplace.done("record scene.toml -o run.mcap");
    let file = workplace.read("run.mcap");
    let cases = [61_u64, 1_000_000, 1 << 40, u64::MAX].map(|step| [(step, false), (step, true)]);
    for (step, has_time) in cases.into_iter().flatten() {
        let mut parts = forge::take_apart(&file);
        each_record(&mut parts, |(opcode, body)| {
            if *opcode == op::MESSAGE && body[..2] == [2, 0] && body[26..34] == 30_u64.to_le_bytes() {
                body[26..34].copy_from_slice(&step.to_le_bytes());
                let time = step.saturating_mul(50_000_000).to_le_bytes();
                if has_time {
                    body[6..22].copy_from_slice(&[time, time].concat());
                }
            }
        });
        std::fs::write(workplace.path("far.mcap"), forge::put_together(&parts, Layout::Zstd)).unwrap();
        let recovered = workplace.rebond("recover far.mcap -o fixed.mcap --force");
        let expected = "recovered 51 states up to step 60\nlost steps 30 to 39: 10 states, 0.5 s\nfirst damage: ";
        assert!(recovered.code == 4 && recovered.output.starts_with(expected), "{step}: {recovered:?}");
        assert!(has_time || recovered.output.contains(&format!("a state of step {step} ")), "{step}: {recovered:?}");
        assert_eq!(workplace.rebond("replay fixed.mcap").code, 4, "{step}");
        let states = workplace.rebond("export fixed.mcap -o -").output;
        assert!(states.lines().last().is_some_and(|line| line.starts_with("60,")), "{step}: {states}");
    }
}

/// Gives a topic another name.
pub fn renamed(parts: &[Item], from: &str, to: &str) -> Vec<u8> {
    let mut altered = parts.to_vec();
    each_record(&mut altered, |(opcode, body)| {
        if *opcode == op::CHANNEL && body[8..].starts_with(from.as_bytes()) {
            let rest = body.split_off(8 + from.len());
            body.truncate(4);
            body.extend((to.len() as u32).to_le_bytes());
            body.extend(to.as_bytes());
            body.extend(rest);
        }
    });
    forge::put_together(&altered, Layout::Zstd)
}

/// Removes the channel and the messages of a topic.
pub fn without_topic(parts: &[Item], channel: u16) -> Vec<u8> {
    let mut altered = parts.to_vec();
    for item in &mut altered {
        if let Item::Chunk(records) = item {
            let is_removed = |(opcode, body): &forge::Record| {
                [op::CHANNEL, op::MESSAGE].contains(opcode) && body[..2] == channel.to_le_bytes()
            };
            records.retain(|record| !is_removed(record));
        }
    }
    forge::put_together(&altered, Layout::Zstd)
}

#[test]
fn a_topic_that_is_missing_or_has_another_name_is_named() {
    let (workplace, file) = recorded();
    let parts = forge::take_apart(&file);
    let bodies = "the topic /bodies is missing";
    assert_eq!(verdict(&without_topic(&parts, 3)), format!("incomplete: {bodies}; 60 steps same"));
    // Boxes for viewers are in a recording only on request.
    assert_eq!(verdict(&without_topic(&parts, 4)), "same: 60 steps, 6 bodies");
    for (topic, name) in [("/bodies", "/b"), ("/scene", "/scenes")] {
        let found = verdict(&renamed(&parts, topic, name));
        let reason = format!("the topic {topic} is missing, but the topic {name:?} has its schema");
        assert!(found.starts_with("corrupt ") && found.contains(&reason), "{topic}: {found}");
    }
    std::fs::write(workplace.path("no-bodies.mcap"), without_topic(&parts, 3)).unwrap();
    let recovered = workplace.rebond("recover no-bodies.mcap -o fixed.mcap");
    assert!(recovered.code == 4 && recovered.output.contains("lost the topic /bodies"), "{recovered:?}");
    let fixed = workplace.rebond("replay fixed.mcap");
    assert_eq!((fixed.code, fixed.output), (4, format!("incomplete: recovered; {bodies}; 60 steps same\n")));
}

#[test]
fn a_range_without_states_is_an_error() {
    let (workplace, _) = recorded();
    for (range, named) in [("--from 5000", "from step 5000 on"), ("--from 70 --to 80", "in the steps 70 to 80")] {
        let replayed = workplace.rebond(&format!("replay run.mcap {range}"));
        assert!(replayed.code == 1 && replayed.errors.contains(&format!("no state {named}")), "{replayed:?}");
    }
    workplace.write("empty.mcap", "");
    assert_ne!(workplace.rebond("recover empty.mcap -o fixed.mcap").code, 0);
    assert!(!workplace.path("fixed.mcap").exists());
}

#[test]
fn a_channel_whose_metadata_do_not_fit_is_reported() {
    let (_workplace, file) = recorded();
    let mut parts = forge::take_apart(&file);
    each_record(&mut parts, |(opcode, body)| {
        if *opcode == op::CHANNEL && body[8..].starts_with(b"/states") {
            let length = |place: usize| u32::from_le_bytes(body[place..place + 4].try_into().unwrap()) as usize;
            let encoding = 8 + length(4);
            let metadata = encoding + 4 + length(encoding);
            body[metadata + 1] ^= 4;
        }
    });
    let found = verdict(&forge::put_together(&parts, Layout::Zstd));
    assert!(found.starts_with("corrupt ") && found.contains("a channel record is damaged"), "{found}");
}
