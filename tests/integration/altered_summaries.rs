//! Recordings whose summary was altered.

use crate::altered_recordings::recorded;
use crate::forge::{op, verdict};

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

/// The offset of the end record in the index may be one that no file has.
#[test]
fn a_flipped_bit_in_the_index_of_the_metadata_costs_no_state() {
    let (workplace, file) = recorded();
    let place = places_in_summary(&file).into_iter().rfind(|place| file[*place] == op::METADATA_INDEX).unwrap();
    for bit in [0, 12, 31, 63] {
        for has_checksum in [true, false] {
            let mut altered = file.clone();
            altered[place + 9 + bit / 8] ^= 1 << (bit % 8);
            if !has_checksum {
                let footer = altered.len() - 8;
                altered[footer - 4..footer].fill(0);
            }
            std::fs::write(workplace.path("altered.mcap"), &altered).unwrap();
            let case = format!("bit {bit}, {has_checksum}");
            let info = workplace.rebond("info altered.mcap");
            assert!(info.code == 4 && info.output.contains("health: corrupt: "), "{case}: {info:?}");
            let recovered = workplace.rebond("recover altered.mcap -o fixed.mcap --force");
            let is_complete = recovered.output.starts_with("recovered 61 states up to step 60");
            assert!(recovered.code == 4 && is_complete, "{case}: {recovered:?}");
            let seek = workplace.rebond("replay altered.mcap --from 45 --to 55");
            assert!(seek.code == 4 && seek.output.ends_with("; 10 steps same\n"), "{case}: {seek:?}");
        }
    }
}

#[test]
fn an_altered_offset_of_the_summary_is_reported() {
    let (workplace, file) = recorded();
    let places = places_in_summary(&file);
    let footer = *places.last().unwrap();
    let offsets = places.iter().filter(|place| file[**place] == op::SUMMARY_OFFSET);
    // The kind, start and length of a group, and the start of these records in the footer.
    let fields = offsets.flat_map(|place| [0, 1, 2, 9, 10].map(|field| place + 9 + field));
    let fields: Vec<usize> = fields.chain([footer + 17, footer + 18]).collect();
    assert!(fields.len() > 20, "{fields:?}");
    for (number, field) in fields.into_iter().enumerate() {
        let mut altered = file.clone();
        altered[field] ^= 1;
        altered[footer + 25..footer + 29].fill(0); // No checksum of the summary.
        let found = verdict(&altered);
        assert!(found.starts_with("corrupt ") && found.contains("summary"), "field {number}: {found}");
        std::fs::write(workplace.path("altered.mcap"), &altered).unwrap();
        assert_eq!(workplace.rebond("info altered.mcap").code, 4, "field {number}");
    }
}

/// Returns the offsets of the records of the summary.
fn places_in_summary(file: &[u8]) -> Vec<usize> {
    let number = |place: usize| u64::from_le_bytes(file[place..place + 8].try_into().unwrap()) as usize;
    let mut places = vec![number(file.len() - 28)];
    while let Some(place) = places.last().filter(|place| file[**place] != op::FOOTER) {
        places.push(place + 9 + number(place + 1));
    }
    places
}
