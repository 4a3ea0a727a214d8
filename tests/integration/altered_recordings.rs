//! Recordings that were altered, rewritten or damaged with all checksums correct: `same` means that everything was
//! compared, and every command says what is missing.

use crate::forge::{self, Item, Layout, each_record, op, verdict};
use crate::rebond::{Outcome, Workplace};
use rebond::internals::recording::{self, Recording};
use std::io::Cursor;

/// Two boxes between walls, one of them spawned in a later chunk than the first; three seconds.
const SCENE: &str = r##"
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

fn recorded() -> (Workplace, Vec<u8>) {
    let workplace = Workplace::with_scene(SCENE);
    workplace.done("record scene.toml -o run.mcap --viewer --accuracy");
    let file = workplace.read("run.mcap");
    (workplace, file)
}

fn items(file: &[u8]) -> Vec<recording::Item> {
    Recording::read(Cursor::new(file)).map_or(Vec::new(), |recording| recording.map(|item| item.unwrap()).collect())
}

#[test]
fn a_recording_that_is_put_together_again_replays_the_same_in_every_layout() {
    let (workplace, file) = recorded();
    let parts = forge::take_apart(&file);
    for layout in [Layout::Zstd, Layout::Lz4, Layout::Uncompressed, Layout::Unchunked] {
        let rewritten = forge::put_together(&parts, layout);
        assert_eq!(verdict(&rewritten), "same: 60 steps, 6 bodies", "{layout:?}");
        std::fs::write(workplace.path("rewritten.mcap"), &rewritten).unwrap();
        assert!(workplace.done("info rewritten.mcap").output.contains("\nhealth: whole\n"), "{layout:?}");
        let seek = workplace.done("replay rewritten.mcap --from 45 --to 55").output;
        assert_eq!(seek, "same: 10 steps, 6 bodies\n", "{layout:?}");
        let [a, b] = ["run", "rewritten"].map(|name| workplace.done(&format!("export {name}.mcap -o -")).output);
        assert_eq!(a, b, "{layout:?}");
    }
}

#[test]
fn private_records_unknown_fields_and_the_order_within_a_step_do_not_matter() {
    let (_workplace, file) = recorded();
    let mut parts = forge::take_apart(&file);
    let place = parts.iter().position(|item| matches!(item, Item::Chunk(_))).unwrap();
    parts.insert(place + 1, Item::Record((0x80, vec![1, 2, 3])));
    for item in &mut parts {
        match item {
            Item::Chunk(records) => {
                records.push((0xff, vec![7]));
                // Sorts by time, and within a step in the opposite order of topics, except that definitions stay first.
                records.sort_by_key(|(opcode, body)| match *opcode {
                    op::MESSAGE => {
                        let time = u64::from_le_bytes(body[6..14].try_into().unwrap());
                        (1, time, u16::MAX - u16::from_le_bytes(body[..2].try_into().unwrap()))
                    }
                    _ => (0, 0, 0),
                });
            }
            Item::Record((op::METADATA, body)) => body.extend([9, 9]),
            Item::Record(_) => {}
        }
    }
    assert_eq!(verdict(&forge::put_together(&parts, Layout::Zstd)), "same: 60 steps, 6 bodies");
}

/// Returns the records with the messages in the order of `key`, which gets channel and time, and `size` messages in each
/// chunk.
fn reordered<K: Ord>(parts: &[Item], size: usize, key: impl Fn(u16, u64) -> K) -> Vec<Item> {
    let (mut definitions, mut messages, mut others) = (Vec::new(), Vec::new(), Vec::new());
    for item in parts {
        match item {
            Item::Chunk(records) => records.iter().for_each(|record| match record.0 {
                op::MESSAGE => messages.push(record.clone()),
                _ => definitions.push(Item::Record(record.clone())),
            }),
            Item::Record(record) => others.push(Item::Record(record.clone())),
        }
    }
    messages.sort_by_key(|(_, body)| {
        let channel = u16::from_le_bytes(body[..2].try_into().unwrap());
        key(channel, u64::from_le_bytes(body[6..14].try_into().unwrap()))
    });
    let chunks = messages.chunks(size).map(|records| Item::Chunk(records.to_vec()));
    let end = others.pop();
    others.into_iter().chain(definitions).chain(chunks).chain(end).collect()
}

#[test]
fn messages_are_read_in_order_of_time_wherever_they_are_stored() {
    let (workplace, file) = recorded();
    let parts = forge::take_apart(&file);
    let [states, energy] = ["states", "energy"].map(|table| format!("--table {table} -o -"));
    let tables = |name: &str| [&states, &energy].map(|table| workplace.done(&format!("export {name} {table}")).output);
    let expected = tables("run.mcap");
    let expected_items = items(&file);
    let backwards = |channel, time: u64| (std::cmp::Reverse(time / 1_000_000_000), channel, time);
    let scattered = |channel, time: u64| ((time / 50_000_000).wrapping_mul(0x9e37_79b9) % 97, channel, time);
    for layout in [Layout::Zstd, Layout::Lz4, Layout::Unchunked] {
        for size in [7, 100_000] {
            let orders = [
                ("by topic", reordered(&parts, size, |channel, time| (channel, time))),
                ("by topic, backwards", reordered(&parts, size, |channel, time| (u16::MAX - channel, time))),
                ("backwards by seconds", reordered(&parts, size, backwards)),
                ("scattered", reordered(&parts, size, scattered)),
            ];
            for (order, reordered) in orders {
                let file = forge::put_together(&reordered, layout);
                let case = format!("{order}, {size} in a chunk, {layout:?}");
                assert_eq!(verdict(&file), "same: 60 steps, 6 bodies", "{case}");
                assert!(items(&file) == expected_items, "{case}");
                std::fs::write(workplace.path("reordered.mcap"), &file).unwrap();
                let seek = workplace.done("replay reordered.mcap --from 45 --to 55").output;
                assert_eq!(seek, "same: 10 steps, 6 bodies\n", "{case}");
                assert!(workplace.done("info reordered.mcap").output.contains("\nhealth: whole\n"), "{case}");
                assert_eq!(tables("reordered.mcap"), expected, "{case}");
            }
        }
    }
}

#[test]
fn damage_of_messages_that_are_not_stored_in_order_of_time_is_reported() {
    let (workplace, file) = recorded();
    let file = forge::put_together(
        &reordered(&forge::take_apart(&file), 20, |channel, time| (channel, time)),
        Layout::Uncompressed,
    );
    for index in (0..file.len()).step_by(file.len() / 150) {
        let mut broken = file.clone();
        broken[index] ^= 1 << (index % 8);
        let found = verdict(&broken);
        assert!(!found.starts_with("same: "), "byte {index}: {found}");
    }
    for end in (0..file.len()).step_by(file.len() / 60) {
        let found = verdict(&file[..end]);
        assert!(["incomplete: ", "error: ", "corrupt "].iter().any(|word| found.starts_with(word)), "{end}: {found}");
    }
    std::fs::write(workplace.path("cut.mcap"), &file[..file.len() * 9 / 10]).unwrap();
    workplace.rebond("recover cut.mcap -o fixed.mcap");
    let fixed = workplace.rebond("replay fixed.mcap");
    assert!(fixed.code == 4 && fixed.output.starts_with("incomplete: recovered"), "{fixed:?}");
}

/// Other programs store metadata at once, but messages when a chunk is full.
#[test]
fn the_end_record_may_be_stored_before_the_messages() {
    let (workplace, file) = recorded();
    let parts = forge::take_apart(&file);
    let expected_items = items(&file);
    let is_end = |item: &Item| matches!(item, Item::Record((op::METADATA, body)) if forge::parse_metadata(body).0 == "rebond_end");
    let end = parts.iter().position(is_end).unwrap();
    let chunks: Vec<usize> = (0..parts.len()).filter(|place| matches!(parts[*place], Item::Chunk(_))).collect();
    for place in chunks {
        for layout in [Layout::Lz4, Layout::Unchunked] {
            let mut moved = parts.clone();
            let record = moved.remove(end);
            moved.insert(place, record);
            let moved = forge::put_together(&moved, layout);
            assert_eq!(verdict(&moved), "same: 60 steps, 6 bodies", "before item {place}, {layout:?}");
            assert!(items(&moved) == expected_items, "before item {place}, {layout:?}");
            std::fs::write(workplace.path("moved.mcap"), &moved).unwrap();
            let seek = workplace.done("replay moved.mcap --from 45").output;
            assert_eq!(seek, "same: 15 steps, 6 bodies\n", "before item {place}, {layout:?}");
            let cut = verdict(&moved[..moved.len() / 2]);
            assert!(cut.starts_with("incomplete: truncated after step "), "before item {place}, {layout:?}: {cut}");
        }
    }
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
    }
    let without_settings: Vec<Item> = parts.into_iter().filter(|item| !is_metadata(item, "rebond")).collect();
    let altered = forge::put_together(&without_settings, Layout::Zstd);
    let found = verdict(&altered);
    assert!(found.starts_with("corrupt ") && found.contains("the metadata record \"rebond\" is missing"), "{found}");
    std::fs::write(workplace.path("altered.mcap"), altered).unwrap();
    workplace.done("recover altered.mcap -o fixed.mcap");
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

fn is_metadata(item: &Item, name: &str) -> bool {
    matches!(item, Item::Record((op::METADATA, body)) if forge::parse_metadata(body).0 == name)
}

/// Other programs may store metadata and attachments in any order, before or after the messages.
#[test]
fn the_records_outside_of_chunks_may_be_stored_in_any_order() {
    let (workplace, file) = recorded();
    let mut chunks = Vec::new();
    let mut others = Vec::new();
    for item in forge::take_apart(&file) {
        match item {
            Item::Record((op::METADATA | op::ATTACHMENT, _)) => others.push(item),
            _ => chunks.push(item),
        }
    }
    assert_eq!(others.len(), 3);
    let first = chunks.iter().position(|item| matches!(item, Item::Chunk(_))).unwrap();
    for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        for before in 0..=3 {
            let (front, back) = order.split_at(before);
            let mut moved = chunks.clone();
            moved.extend(back.iter().map(|index| others[*index].clone()));
            moved.splice(first..first, front.iter().map(|index| others[*index].clone()));
            let moved = forge::put_together(&moved, Layout::Zstd);
            assert_eq!(verdict(&moved), "same: 60 steps, 6 bodies", "{order:?}, {before} before the messages");
            std::fs::write(workplace.path("moved.mcap"), &moved).unwrap();
            let seek = workplace.done("replay moved.mcap --from 45").output;
            assert_eq!(seek, "same: 15 steps, 6 bodies\n", "{order:?}, {before} before the messages");
        }
    }
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
        let expected = "recovered 60 states up to step 60\nlost step 30: 1 state, 0.05 s\nfirst damage: ";
        assert!(recovered.code == 4 && recovered.output.starts_with(expected), "{step}: {recovered:?}");
        assert!(has_time || recovered.output.contains(&format!("a state of step {step} ")), "{step}: {recovered:?}");
        assert_eq!(workplace.rebond("replay fixed.mcap").code, 4, "{step}");
        let states = workplace.rebond("export fixed.mcap -o -").output;
        assert!(states.lines().last().is_some_and(|line| line.starts_with("60,")), "{step}: {states}");
    }
}

/// Returns a folder of damaged recordings: with a flipped bit in the chunk of the steps 20 to 39, and recovered from that
/// (gap.mcap), also without saying so (other-gap.mcap); without that chunk (hole.mcap); cut, and cut in the index; with
/// bytes before the start and after the end; with another top speed; without its scene; without keyframes, or with another name of their topic; with a bit flipped in
/// the index, or other statistics.
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

/// Gives a topic another name.
fn renamed(parts: &[Item], from: &str, to: &str) -> Vec<u8> {
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
fn without_topic(parts: &[Item], channel: u16) -> Vec<u8> {
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

/// The kinds that show one collision show no part of a run.
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
    ];
    for command in figures.chain(others.map(str::to_owned)) {
        for file in ["gap.mcap", "flip.mcap", "hole.mcap"] {
            let done = workplace.rebond(&command.replace("FILE", file));
            let is_named = done.errors.contains("there is no state ") && done.errors.contains("20 to 39 are missing");
            assert!(done.code == 4 && is_named, "{command} {file}: {done:?}");
            assert_eq!(workplace.names(), before, "{command} {file}");
        }
    }
    for command in ["replay FILE --from 59", "render FILE --at 59 -o out.png", "render FILE --from 59 -o out.gif"]
        .into_iter()
        .chain(["figure energy FILE --from 59 -o out.svg", "figure strobe FILE --from 59 -o out.svg"])
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

/// The summary repeats the schemas and channels of the file.
#[test]
fn an_altered_schema_or_channel_in_the_summary_is_reported_and_not_used() {
    let (workplace, file) = recorded();
    let summary = u64::from_le_bytes(file[file.len() - 28..file.len() - 20].try_into().unwrap()) as usize;
    let mut place = summary;
    let mut seen = 0;
    while file[place] != 0x02 {
        let end = place + 9 + u64::from_le_bytes(file[place + 1..place + 9].try_into().unwrap()) as usize;
        let (what, offset) = match file[place] {
            op::SCHEMA => ("schema", end - 1),
            // The last letter of the topic, which no other text but the encoding and no metadata follow.
            op::CHANNEL => {
                let topic = u32::from_le_bytes(file[place + 13..place + 17].try_into().unwrap()) as usize;
                ("channel", place + 16 + topic)
            }
            _ => {
                place = end;
                continue;
            }
        };
        let mut altered = file.clone();
        altered[offset] ^= 1;
        let footer = altered.len() - 8;
        altered[footer - 4..footer].fill(0); // No checksum of the summary.
        std::fs::write(workplace.path("altered.mcap"), &altered).unwrap();
        let found = verdict(&altered);
        let named = format!("the summary has another {what} ");
        assert!(found.starts_with("corrupt ") && found.contains(&named), "byte {offset}: {found}");
        let info = workplace.rebond("info altered.mcap");
        assert!(info.code == 4 && info.output.contains(&named), "byte {offset}: {info:?}");
        assert!(workplace.rebond("export altered.mcap -o -").output.ends_with('\n'));
        (seen, place) = (seen + 1, end);
    }
    assert_eq!(seen, 8, "four topics");
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
