//! Recordings as other programs may rewrite them: with other chunks, in another order and with more records.

use crate::altered_recordings::{items, recorded};
use crate::forge::{self, Item, Layout, op, verdict};

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

/// Only the attachment that the metadata describe is the scene.
#[test]
fn other_programs_may_attach_other_toml() {
    let (workplace, file) = recorded();
    let items = forge::take_apart(&file);
    let place_of = |code| items.iter().position(|item| matches!(item, Item::Record((found, _)) if *found == code));
    let (scene, metadata) = (place_of(op::ATTACHMENT).unwrap(), place_of(op::METADATA).unwrap());
    let export = workplace.done("export run.mcap").output;
    for time in [0, 1_700_000_000_000_000_000] {
        let other = forge::attachment("notes.toml", "application/toml", time, b"[run]\nsteps = 1\n");
        for place in [metadata, scene, scene + 1, items.len()] {
            let mut more = items.clone();
            more.insert(place, Item::Record(other.clone()));
            let more = forge::put_together(&more, Layout::Zstd);
            assert_eq!(verdict(&more), "same: 60 steps, 6 bodies", "at {place}, time {time}");
            std::fs::write(workplace.path("more.mcap"), &more).unwrap();
            assert_eq!(workplace.done("export more.mcap").output, export, "at {place}, time {time}");
            let recovered = workplace.done("recover more.mcap -o fixed.mcap --force");
            assert!(workplace.read("fixed.mcap") == file, "at {place}, time {time}: {recovered:?}");
        }
    }
}
