//! The two metadata records, `rebond` at the start and `rebond_end` at the end.
//!
//! All values are text. A float is stored twice, as the shortest decimal that parses to it and as
//! bits: `0.95 0x3fee666666666666`; both must agree. Each record has a checksum of its own,
//! because MCAP has none for metadata. `checksum` and `format_version` keep their meaning in all
//! future formats, so that an older program recognises a newer recording.

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt::Display,
    str::FromStr,
};

use xxhash_rust::xxh3::{Xxh3, xxh3_64};

use crate::physics::{Accuracy, EngineConfig, Restitution, RestitutionPair, SolverKind, Vector};

use super::{
    Bounds, FORMAT_VERSION, Gap, Header, RecordedError, SceneImage, SceneText, StateBounds, Trailer, Versions, limits,
    record_reader::{FieldReader, Malformed},
};

/// The name of the header record at the start.
pub const HEADER: &str = "rebond";

/// The name of the end record.
pub const TRAILER: &str = "rebond_end";

/// The library field of the file: the program and version that wrote it.
pub const LIBRARY: &str = concat!("rebond/", env!("CARGO_PKG_VERSION"));

/// The keys and values of one record.
pub type Map = BTreeMap<String, String>;

/// Parses a metadata record to its name, keys and values.
pub fn parse(body: &[u8]) -> Result<(&str, Map), Malformed> {
    let mut fields = FieldReader::new(body);
    Ok((fields.text()?, fields.map()?))
}

/// Returns true if a metadata record is an end record.
pub fn is_trailer(body: &[u8]) -> bool {
    parse(body).is_ok_and(|(name, _)| name == TRAILER)
}

/// Parses a metadata record, if it is a readable end record.
pub fn trailer_of(body: &[u8]) -> Option<Trailer> {
    let (name, map) = parse(body).ok()?;
    (name == TRAILER).then(|| parse_trailer(&map).ok()).flatten()
}

/// Returns the header record.
pub fn header_map(header: &Header) -> Map {
    let mut map = settings_map(header);
    insert(&mut map, "steps", header.steps);
    insert(&mut map, "every", header.every);
    insert(&mut map, "library", LIBRARY);
    if let Some(SceneText { file_name, text }) = &header.scene
        && describes_scene(header)
    {
        map.extend(scene_entries(file_name, text));
    }
    if header.estimates_accuracy {
        insert(&mut map, "accuracy", "estimated");
    }
    with_checksum(map)
}

/// The first format version whose metadata describes the scene.
const FIRST_FORMAT_WITH_SCENE: u32 = 3;

/// File name, length in bytes and XXH3-64 of the scene.
const SCENE_KEYS: [&str; 3] = ["scene_name", "scene_bytes", "scene_digest"];

fn scene_entries(file_name: &str, text: &str) -> impl Iterator<Item = (String, String)> {
    let digest = format!("{:016x}", xxh3_64(text.as_bytes()));
    SCENE_KEYS.map(String::from).into_iter().zip([file_name.into(), text.len().to_string(), digest])
}

/// Returns true if the metadata of a recording describes its scene.
pub fn describes_scene(header: &Header) -> bool {
    header.versions.format >= FIRST_FORMAT_WITH_SCENE
}

/// Returns true if an attachment with TOML can be the scene of a recording: its metadata describes it, or none as
/// before format 3.
pub fn may_describe(map: &Map, SceneText { file_name, text }: &SceneText) -> bool {
    scene_entries(file_name, text).all(|(key, value)| map.get(&key).is_none_or(|described| *described == value))
}

/// Returns the part of the header record that determines the run.
pub fn settings_map(header: &Header) -> Map {
    let Header { versions, config, .. } = header;
    let mut map = Map::new();
    insert(&mut map, "format_version", versions.format);
    insert(&mut map, "semantics_version", versions.semantics);
    insert(&mut map, "solver", config.solver.name());
    insert(&mut map, "rate", format_float(config.rate));
    insert(&mut map, "events_per_step", config.events_per_step);
    if let Some(gravity) = config.gravity {
        insert(&mut map, "gravity_x", format_float(gravity.x));
        insert(&mut map, "gravity_y", format_float(gravity.y));
    }
    insert(&mut map, "restitution", format_float(config.restitution.default_restitution()));
    for RestitutionPair { materials, restitution } in config.restitution.pairs() {
        insert(&mut map, &pair_key(&materials), format_float(restitution));
    }
    if !header.overrides.is_empty() {
        insert(&mut map, "set", serde_json::json!(header.overrides));
    }
    if !header.images.is_empty() {
        let image = |image: &SceneImage| (image.name.clone(), image.bytes, format!("{:016x}", image.digest));
        insert(&mut map, "images", serde_json::json!(header.images.iter().map(image).collect::<Vec<_>>()));
    }
    if header.has_live_events {
        insert(&mut map, "live_events", "yes");
    }
    if !header.gaps.is_empty() {
        insert(&mut map, "gaps", header.gaps.iter().map(Gap::to_string).collect::<Vec<_>>().join(" "));
    }
    map
}

impl Header {
    /// Returns a description of the first setting that determines the run and differs from that of `expected`, if any.
    pub fn settings_difference(&self, expected: &Header) -> Option<String> {
        difference(&settings_map(self), &settings_map(expected), None)
    }
}

/// Returns the end record: how the run ended, and a copy of the header in case its own record is
/// damaged.
pub fn trailer_map(header: &Header, trailer: &Trailer) -> Map {
    let mut map = header_map(header);
    insert(&mut map, "steps_taken", trailer.steps);
    insert(&mut map, "bodies", trailer.bodies);
    insert(&mut map, "events", trailer.events);
    insert(&mut map, "identity", trailer.identity);
    if let Some(collisions) = trailer.collisions {
        insert(&mut map, "collisions", collisions);
    }
    if let Some(error) = &trailer.error {
        insert(&mut map, "error", error.stored(header.versions.format));
    }
    if let Some(accuracy) = &trailer.accuracy {
        insert(&mut map, "accurate_until", accuracy.until.map_or("throughout".into(), |step| step.to_string()));
    }
    if trailer.recovered {
        insert(&mut map, "recovered", "yes");
    }
    if let Some(state_bounds) = &trailer.state_bounds {
        put_state_bounds(&mut map, state_bounds);
    }
    with_checksum(map)
}

/// Parses the header from either record, without the scene, which is an attachment.
///
/// # Errors
/// Returns an error if the format is newer than this program or the record is damaged.
pub fn parse_header(map: &Map) -> Result<Header, HeaderError> {
    verify_checksum(map)?;
    let format = parse_value(map, "format_version")?;
    if format > FORMAT_VERSION {
        return Err(HeaderError::Newer { format });
    }
    Ok(parse_header_fields(map, format)?)
}

/// The reason why a header cannot be parsed.
#[derive(Debug, PartialEq, Eq)]
pub enum HeaderError {
    /// The format is newer than this program.
    Newer {
        /// The format version of the recording.
        format: u32,
    },
    /// The record is damaged; holds a description.
    Damaged(String),
}

impl From<String> for HeaderError {
    fn from(reason: String) -> HeaderError {
        HeaderError::Damaged(reason)
    }
}

/// Parses the end record.
///
/// # Errors
/// Returns a description of the damage.
pub fn parse_trailer(map: &Map) -> Result<Trailer, String> {
    verify_checksum(map)?;
    Ok(Trailer {
        steps: parse_step(map, "steps_taken")?,
        collisions: map.get("collisions").map(|_| parse_value(map, "collisions")).transpose()?,
        bodies: parse_value(map, "bodies")?,
        events: parse_value(map, "events")?,
        error: map.get("error").map(|text| RecordedError::parse(text)),
        accuracy: match map.get("accurate_until").map(String::as_str) {
            None => None,
            Some("throughout") => Some(Accuracy { until: None }),
            Some(_) => Some(Accuracy { until: Some(parse_step(map, "accurate_until")?) }),
        },
        recovered: map.contains_key("recovered"),
        state_bounds: parse_state_bounds(map)?,
        identity: parse_value(map, "identity")?,
    })
}

/// Adds the state bounds, unless the top speed is not finite. Without them, readers compute the bounds
/// from the states.
fn put_state_bounds(map: &mut Map, StateBounds { top_speed, bounds }: &StateBounds) {
    if !top_speed.is_finite() {
        return;
    }
    insert(map, "top_speed", format_float(*top_speed));
    if let Some(Bounds { near, far }) = bounds {
        for (key, number) in BOUNDS_KEYS.into_iter().zip([near.x, near.y, far.x, far.y]) {
            insert(map, key, format_float(number));
        }
    }
}

const BOUNDS_KEYS: [&str; 4] = ["reach_left", "reach_top", "reach_right", "reach_bottom"];

fn parse_state_bounds(map: &Map) -> Result<Option<StateBounds>, String> {
    if !map.contains_key("top_speed") {
        return Ok(None);
    }
    let top_speed = parse_finite(map, "top_speed")?;
    if !map.contains_key(BOUNDS_KEYS[0]) {
        return Ok(Some(StateBounds { top_speed, bounds: None }));
    }
    let [left, top, right, bottom] = BOUNDS_KEYS.map(|key| parse_finite(map, key));
    let bounds = Bounds { near: Vector::new(left?, top?), far: Vector::new(right?, bottom?) };
    Ok(Some(StateBounds { top_speed, bounds: Some(bounds) }))
}

fn parse_header_fields(map: &Map, format: u32) -> Result<Header, String> {
    let solver: String = parse_value(map, "solver")?;
    let gravity = if map.contains_key("gravity_x") {
        Some(Vector::new(parse_finite(map, "gravity_x")?, parse_finite(map, "gravity_y")?))
    } else {
        None
    };
    let rate = parse_finite(map, "rate")?;
    let every = parse_step(map, "every")?;
    if rate <= 0.0 || every == 0 {
        return Err("the rate or the value of \"every\" is not positive".into());
    }
    let config = EngineConfig {
        solver: SolverKind::from_name(&solver)
            .ok_or_else(|| format!("the solver {:?} is unknown", shortened(&solver)))?,
        rate,
        gravity,
        restitution: parse_restitution(map)?,
        events_per_step: parse_value(map, "events_per_step")?,
    };
    let versions = Versions { format, semantics: parse_value(map, "semantics_version")? };
    let estimates_accuracy = map.contains_key("accuracy");
    if estimates_accuracy && config.solver == SolverKind::Handout {
        return Err("the metadata announce an accuracy, but the handout solver has none".into());
    }
    Ok(Header {
        versions,
        config,
        steps: parse_step(map, "steps")?,
        every,
        estimates_accuracy,
        scene: None,
        images: parse_images(map)?,
        overrides: parse_overrides(map)?,
        has_live_events: map.contains_key("live_events"),
        gaps: parse_gaps(map)?,
    })
}

fn parse_overrides(map: &Map) -> Result<Vec<[String; 2]>, String> {
    let Some(text) = map.get("set") else { return Ok(Vec::new()) };
    let damaged = |_| format!("the metadata has the invalid value \"set\" = {:?}", shortened(text));
    serde_json::from_str(text).map_err(damaged)
}

/// Parses names, lengths and digests of the images, which are attachments.
fn parse_images(map: &Map) -> Result<Vec<SceneImage>, String> {
    let Some(text) = map.get("images") else { return Ok(Vec::new()) };
    let damaged = || format!("the metadata has the invalid value \"images\" = {:?}", shortened(text));
    let images: Vec<(String, u64, String)> = serde_json::from_str(text).map_err(|_| damaged())?;
    let is_ordered = images.windows(2).all(|pair| pair[0].0 < pair[1].0);
    let total: u64 = images.iter().map(|(_, bytes, _)| (*bytes).min(limits::RECORD_BYTES as u64)).sum();
    if !is_ordered || images.len() > limits::IMAGES || total > limits::IMAGES_BYTES as u64 {
        return Err(damaged());
    }
    let image = |(name, bytes, digest): (String, u64, String)| {
        let digest = u64::from_str_radix(&digest, 16).map_err(|_| damaged())?;
        Ok(SceneImage { name, bytes, digest, png: None })
    };
    images.into_iter().map(image).collect()
}

fn parse_gaps(map: &Map) -> Result<Vec<Gap>, String> {
    let gaps = map.get("gaps").map_or("", String::as_str).split_whitespace().take(limits::GAPS + 1);
    let gaps: Vec<Gap> = gaps.map(str::parse).collect::<Result<_, String>>()?;
    if gaps.len() > limits::GAPS {
        return Err(format!("the metadata declares more than {} gaps", limits::GAPS));
    }
    let end = |gap: &Gap| gap.after.unwrap_or(0);
    let is_ordered =
        gaps.iter().all(|gap| gap.before <= limits::STEPS && gap.after.is_none_or(|after| after < gap.before))
            && gaps.windows(2).all(|pair| pair[0].before <= end(&pair[1]));
    if is_ordered { Ok(gaps) } else { Err("the gaps in the metadata are not in ascending order".into()) }
}

fn parse_restitution(map: &Map) -> Result<Restitution, String> {
    let mut pairs = Vec::new();
    for key in map.keys().filter(|key| key.starts_with(PAIR_PREFIX)) {
        let materials = serde_json::from_str(&key[PAIR_PREFIX.len()..])
            .map_err(|_| format!("the key {:?} is damaged", shortened(key)))?;
        pairs.push(RestitutionPair { materials, restitution: parse_finite(map, key)? });
    }
    let names: BTreeSet<&String> = pairs.iter().flat_map(|pair: &RestitutionPair| &pair.materials).collect();
    if names.len() > limits::MATERIALS {
        return Err(format!(
            "the restitution table has {} materials, but at most {} are allowed",
            names.len(),
            limits::MATERIALS,
        ));
    }
    let default = parse_finite(map, "restitution")?;
    let all = pairs.iter().map(|pair| pair.restitution).chain([default]);
    if all.into_iter().all(|e| (0.0..=1.0).contains(&e)) {
        Ok(Restitution::new(default, &pairs))
    } else {
        Err("a restitution coefficient is not between 0 and 1".into())
    }
}

const PAIR_PREFIX: &str = "restitution ";

fn pair_key(materials: &[String; 2]) -> String {
    format!("{PAIR_PREFIX}{}", serde_json::json!(materials))
}

fn insert(map: &mut Map, key: &str, value: impl Display) {
    map.insert(key.into(), value.to_string());
}

fn parse_value<T: FromStr>(map: &Map, key: &str) -> Result<T, String> {
    let text = map.get(key).ok_or_else(|| format!("the metadata has no key {key:?}"))?;
    text.parse().map_err(|_| format!("the metadata has the invalid value {key:?} = {:?}", shortened(text)))
}

/// Parses a step or a number of steps.
fn parse_step(map: &Map, key: &str) -> Result<u64, String> {
    let step = parse_value(map, key)?;
    if step <= limits::STEPS {
        Ok(step)
    } else {
        Err(format!("the metadata has {key:?} = {step}, but steps go up to {}", limits::STEPS))
    }
}

fn format_float(number: f64) -> String {
    format!("{number:?} 0x{:016x}", number.to_bits())
}

fn parse_finite(map: &Map, key: &str) -> Result<f64, String> {
    let text: String = parse_value(map, key)?;
    parse_float(&text)
        .filter(|number| number.is_finite())
        .ok_or_else(|| format!("the metadata has the invalid value {key:?} = {:?}", shortened(&text)))
}

/// Parses a float, whose decimal and bits must agree.
fn parse_float(text: &str) -> Option<f64> {
    let (decimal, bits) = text.split_once(" 0x")?;
    let number = f64::from_bits(u64::from_str_radix(bits, 16).ok()?);
    let is_same = decimal.parse::<f64>().is_ok_and(|decimal| decimal.to_bits() == number.to_bits());
    is_same.then_some(number)
}

/// Compares a record with the one that its contents give, and returns the first key with another value, if any. The
/// record of the scene is compared only if the scene is known.
pub fn difference(found: &Map, expected: &Map, scene: Option<&SceneText>) -> Option<String> {
    let is_ignored = |key: &str| ["library", CHECKSUM].contains(&key) || scene.is_none() && SCENE_KEYS.contains(&key);
    let is_same = |a: &String, b: &String| {
        a == b
            || parse_float(a)
                .is_some_and(|number| parse_float(b).is_some_and(|other| other.to_bits() == number.to_bits()))
    };
    let keys: BTreeSet<&String> = found.keys().chain(expected.keys()).filter(|key| !is_ignored(key)).collect();
    keys.into_iter().find_map(|key| match (found.get(key), expected.get(key)) {
        (Some(found), Some(expected)) if is_same(found, expected) => None,
        (Some(found), Some(expected)) => Some(format!(
            "the metadata has {key:?} = {:?}, but {:?} is expected",
            shortened(found),
            shortened(expected)
        )),
        (Some(_), None) => Some(format!("the metadata has the unexpected key {:?}", shortened(key))),
        (None, _) => Some(format!("the metadata has no key {:?}", shortened(key))),
    })
}

/// Returns the start of a text that may be long, for messages.
pub fn shortened(text: &str) -> String {
    const CHARACTERS: usize = 200;
    match text.char_indices().nth(CHARACTERS) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.into(),
    }
}

const CHECKSUM: &str = "checksum";

fn with_checksum(mut map: Map) -> Map {
    let sum = checksum(&map);
    insert(&mut map, CHECKSUM, sum);
    map
}

fn verify_checksum(map: &Map) -> Result<(), String> {
    if map.get(CHECKSUM) == Some(&checksum(map)) {
        Ok(())
    } else {
        Err("the metadata does not match its checksum".into())
    }
}

/// Returns the XXH3 of all keys and values except the checksum, each preceded by its length.
fn checksum(map: &Map) -> String {
    let mut hash = Xxh3::new();
    for text in map.iter().filter(|(key, _)| *key != CHECKSUM).flat_map(|(key, value)| [key, value]) {
        hash.update(&(text.len() as u64).to_le_bytes());
        hash.update(text.as_bytes());
    }
    format!("{:016x}", hash.digest())
}

#[cfg(test)]
mod tests {
    use proptest::{collection::vec, prelude::*};

    use super::*;
    use crate::recording::Identity;

    fn pair() -> impl Strategy<Value = RestitutionPair> {
        ((".*", ".*"), 0.0..=1.0).prop_map(|((a, b), restitution)| RestitutionPair { materials: [a, b], restitution })
    }

    fn finite() -> impl Strategy<Value = f64> {
        prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO
    }

    fn state_bounds() -> impl Strategy<Value = Option<StateBounds>> {
        let corner = || (finite(), finite()).prop_map(|(x, y)| Vector::new(x, y));
        let bounds = prop::option::of((corner(), corner()).prop_map(|(near, far)| Bounds { near, far }));
        prop::option::of((finite(), bounds).prop_map(|(top_speed, bounds)| StateBounds { top_speed, bounds }))
    }

    fn gravity() -> impl Strategy<Value = Option<Vector>> {
        prop::option::of((finite(), finite()).prop_map(|(x, y)| Vector::new(x, y)))
    }

    proptest! {
        #[test]
        fn parsing_inverts_writing_of_headers_and_trailers(
            rate in prop::num::f64::NORMAL.prop_map(f64::abs),
            gravity in gravity(),
            default in 0.0..=1.0,
            pairs in vec(pair(), 0..4),
            events_per_step in any::<u64>(),
            (steps, every) in (0..=limits::STEPS, 1..=limits::STEPS),
            (collisions, error, recovered) in any::<(Option<u64>, Option<String>, bool)>(),
            accuracy in prop::option::of(prop::option::of(0..=limits::STEPS)),
            state_bounds in state_bounds(),
            title in ".*",
        ) {
            let restitution = Restitution::new(default, &pairs);
            let config = EngineConfig { solver: SolverKind::EventDriven, rate, gravity, restitution, events_per_step };
            let gaps = vec![Gap { after: None, before: 7 }, Gap { after: Some(9), before: 12 }];
            let (versions, scene) = (Versions::CURRENT, None);
            let error = error.map(RecordedError::Text);
            let estimates_accuracy = accuracy.is_some();
            let accuracy = accuracy.map(|until| Accuracy { until });
            let overrides = vec![[title, "\"a\"".to_owned()], ["restitution.default".into(), "0.5".into()]];
            let has_live_events = recovered;
            let images = vec![SceneImage { name: "img/a \"b\".png".into(), bytes: 3, digest: 7, png: None }];
            let expected = Header {
                versions, config, steps, every, estimates_accuracy, scene, images, overrides, has_live_events, gaps,
            };
            let identity = Identity(5);
            let trailer = Trailer { steps, collisions, bodies: 3, events: 4, error, accuracy, recovered, state_bounds, identity };
            for map in [header_map(&expected), trailer_map(&expected, &trailer)] {
                let found = parse_header(&map).unwrap();
                prop_assert_eq!(format!("{found:?}"), format!("{expected:?}"), "compares the text, which distinguishes -0.0 from 0.0");
            }
            prop_assert_eq!(super::parse_trailer(&trailer_map(&expected, &trailer)).unwrap(), trailer);
        }
    }

    #[test]
    fn a_changed_value_does_not_match_the_checksum() {
        let mut map = with_checksum(Map::from([("a".into(), "1".into()), ("b".into(), "2".into())]));
        assert_eq!(verify_checksum(&map), Ok(()));
        map.insert("a".into(), "12".into());
        assert!(verify_checksum(&map).is_err());
        map.insert("a".into(), "1".into());
        map.insert("b1".into(), String::new());
        assert!(verify_checksum(&map).is_err());
    }
}
