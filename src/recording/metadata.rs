//! The two metadata records, `rebond` at the start and `rebond_end` at the end.
//!
//! Every value is text. A float stands there twice, as the shortest decimal that reads
//! back to it and as its bits: `0.95 0x3fee666666666666`; the bits count. Each record has a
//! checksum of its own, as MCAP gives metadata none. `checksum` and `format_version` mean
//! the same in every format to come, so that an older program knows a newer recording.

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt::Display,
    str::FromStr,
};

use xxhash_rust::xxh3::Xxh3;

use crate::physics::{Restitution, RestitutionPair, Settings, SolverKind, Vector};

use super::{
    End, Extremes, FORMAT_VERSION, Gap, Header, Reach, SceneText, Versions,
    fields::{Fields, Malformed},
    limits,
};

/// The name of the record at the start.
pub const START: &str = "rebond";

/// The name of the record at the end.
pub const END: &str = "rebond_end";

/// What the file says it was written by.
pub const LIBRARY: &str = concat!("rebond/", env!("CARGO_PKG_VERSION"));

/// Keys and values of one record.
pub type Map = BTreeMap<String, String>;

/// Name, keys and values of a metadata record.
pub fn parse(body: &[u8]) -> Result<(&str, Map), Malformed> {
    let mut fields = Fields::new(body);
    let named = (fields.text()?, fields.map()?);
    fields.end()?;
    Ok(named)
}

/// The record at the start.
pub fn of_header(header: &Header) -> Map {
    let mut map = of_settings(header);
    put(&mut map, "steps", header.steps);
    put(&mut map, "every", header.every);
    put(&mut map, "library", LIBRARY);
    sealed(map)
}

/// What of the record at the start decides about the course of the run.
pub fn of_settings(header: &Header) -> Map {
    let Header { versions, settings, .. } = header;
    let mut map = Map::new();
    put(&mut map, "format_version", versions.format);
    put(&mut map, "semantics_version", versions.semantics);
    put(&mut map, "solver", settings.solver.name());
    put(&mut map, "rate", float(settings.rate));
    put(&mut map, "events_per_step", settings.events_per_step);
    if let Some(gravity) = settings.gravity {
        put(&mut map, "gravity_x", float(gravity.x));
        put(&mut map, "gravity_y", float(gravity.y));
    }
    put(&mut map, "restitution", float(settings.restitution.default_restitution()));
    for RestitutionPair { materials, restitution } in settings.restitution.pairs() {
        put(&mut map, &pair_key(&materials), float(restitution));
    }
    if !header.gaps.is_empty() {
        put(&mut map, "gaps", header.gaps.iter().map(Gap::to_string).collect::<Vec<_>>().join(" "));
    }
    map
}

/// The record at the end: how the run ended, and the header again in case its own record
/// is damaged.
pub fn of_end(header: &Header, end: &End) -> Map {
    let mut map = of_header(header);
    put(&mut map, "steps_taken", end.steps);
    put(&mut map, "bodies", end.bodies);
    put(&mut map, "events", end.events);
    put(&mut map, "identity", end.identity);
    if let Some(collisions) = end.collisions {
        put(&mut map, "collisions", collisions);
    }
    if let Some(error) = &end.error {
        put(&mut map, "error", error);
    }
    if end.recovered {
        put(&mut map, "recovered", "yes");
    }
    if let Some(extremes) = &end.extremes {
        put_extremes(&mut map, extremes);
    }
    sealed(map)
}

/// The header that either record tells, without the scene, which stands elsewhere.
///
/// # Errors
/// If it is newer than this program or not as it was written.
pub fn header(map: &Map) -> Result<Header, Refusal> {
    unsealed(map)?;
    let format = value(map, "format_version")?;
    if format > FORMAT_VERSION {
        return Err(Refusal::Newer { format });
    }
    Ok(header_fields(map, format)?)
}

/// Why a record does not tell a header.
#[derive(Debug, PartialEq, Eq)]
pub enum Refusal {
    /// Its format is newer than this program.
    Newer {
        /// The version.
        format: u32,
    },
    /// It is not as it was written; in words.
    Damaged(String),
}

impl From<String> for Refusal {
    fn from(what: String) -> Refusal {
        Refusal::Damaged(what)
    }
}

/// The end that a record at the end tells.
///
/// # Errors
/// In words, if it is not as it was written.
pub fn end(map: &Map) -> Result<End, String> {
    unsealed(map)?;
    Ok(End {
        steps: value(map, "steps_taken")?,
        collisions: map.get("collisions").map(|_| value(map, "collisions")).transpose()?,
        bodies: value(map, "bodies")?,
        events: value(map, "events")?,
        error: map.get("error").cloned(),
        recovered: map.contains_key("recovered"),
        extremes: extremes(map)?,
        identity: value(map, "identity")?,
    })
}

/// Left out where a number is not finite: then whoever needs them looks at the states.
fn put_extremes(map: &mut Map, Extremes { top_speed, reach }: &Extremes) {
    if !top_speed.is_finite() {
        return;
    }
    put(map, "top_speed", float(*top_speed));
    if let Some(Reach { near, far }) = reach {
        for (key, number) in REACH.into_iter().zip([near.x, near.y, far.x, far.y]) {
            put(map, key, float(number));
        }
    }
}

const REACH: [&str; 4] = ["reach_left", "reach_top", "reach_right", "reach_bottom"];

fn extremes(map: &Map) -> Result<Option<Extremes>, String> {
    if !map.contains_key("top_speed") {
        return Ok(None);
    }
    let top_speed = finite(map, "top_speed")?;
    if !map.contains_key(REACH[0]) {
        return Ok(Some(Extremes { top_speed, reach: None }));
    }
    let [left, top, right, bottom] = REACH.map(|key| finite(map, key));
    let reach = Reach { near: Vector::new(left?, top?), far: Vector::new(right?, bottom?) };
    Ok(Some(Extremes { top_speed, reach: Some(reach) }))
}

fn header_fields(map: &Map, format: u32) -> Result<Header, String> {
    let solver: String = value(map, "solver")?;
    let gravity = match map.contains_key("gravity_x") {
        true => Some(Vector::new(finite(map, "gravity_x")?, finite(map, "gravity_y")?)),
        false => None,
    };
    let rate = finite(map, "rate")?;
    let every = value(map, "every")?;
    if rate <= 0.0 || every == 0 {
        return Err("the rate or the thinning is not positive".into());
    }
    let settings = Settings {
        solver: SolverKind::named(&solver).ok_or_else(|| format!("the solver {solver:?} is unknown"))?,
        rate,
        gravity,
        restitution: restitution(map)?,
        events_per_step: value(map, "events_per_step")?,
    };
    let versions = Versions { format, semantics: value(map, "semantics_version")? };
    let scene = SceneText::default();
    Ok(Header { versions, settings, steps: value(map, "steps")?, every, scene, gaps: gaps(map)? })
}

fn gaps(map: &Map) -> Result<Vec<Gap>, String> {
    map.get("gaps").map_or("", String::as_str).split_whitespace().map(str::parse).collect()
}

fn restitution(map: &Map) -> Result<Restitution, String> {
    let mut pairs = Vec::new();
    for key in map.keys().filter(|key| key.starts_with(PAIR)) {
        let materials = serde_json::from_str(&key[PAIR.len()..]).map_err(|_| format!("the pair {key:?} is damaged"))?;
        pairs.push(RestitutionPair { materials, restitution: finite(map, key)? });
    }
    let names: BTreeSet<&String> = pairs.iter().flat_map(|pair: &RestitutionPair| &pair.materials).collect();
    if names.len() > limits::MATERIALS {
        return Err(format!("the restitution table names {} materials", names.len()));
    }
    let default = finite(map, "restitution")?;
    let all = pairs.iter().map(|pair| pair.restitution).chain([default]);
    match all.into_iter().all(|e| (0.0..=1.0).contains(&e)) {
        true => Ok(Restitution::new(default, &pairs)),
        false => Err("a restitution lies outside of 0 to 1".into()),
    }
}

const PAIR: &str = "restitution ";

fn pair_key(materials: &[String; 2]) -> String {
    format!("{PAIR}{}", serde_json::json!(materials))
}

fn put(map: &mut Map, key: &str, value: impl Display) {
    map.insert(key.into(), value.to_string());
}

fn value<T: FromStr>(map: &Map, key: &str) -> Result<T, String> {
    let text = map.get(key).ok_or_else(|| format!("the metadata has no {key:?}"))?;
    text.parse().map_err(|_| format!("the metadata has {key:?} = {text:?}"))
}

fn float(number: f64) -> String {
    format!("{number:?} 0x{:016x}", number.to_bits())
}

fn finite(map: &Map, key: &str) -> Result<f64, String> {
    let text: String = value(map, key)?;
    text.split_once(" 0x")
        .and_then(|(_, bits)| u64::from_str_radix(bits, 16).ok())
        .map(f64::from_bits)
        .filter(|number| number.is_finite())
        .ok_or_else(|| format!("the metadata has {key:?} = {text:?}"))
}

const CHECKSUM: &str = "checksum";

fn sealed(mut map: Map) -> Map {
    let sum = checksum(&map);
    put(&mut map, CHECKSUM, sum);
    map
}

fn unsealed(map: &Map) -> Result<(), String> {
    match map.get(CHECKSUM) == Some(&checksum(map)) {
        true => Ok(()),
        false => Err("the metadata does not fit its checksum".into()),
    }
}

/// XXH3 over all keys and values but the checksum itself, each with its length.
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

    fn extremes() -> impl Strategy<Value = Option<Extremes>> {
        let corner = || (finite(), finite()).prop_map(|(x, y)| Vector::new(x, y));
        let reach = prop::option::of((corner(), corner()).prop_map(|(near, far)| Reach { near, far }));
        prop::option::of((finite(), reach).prop_map(|(top_speed, reach)| Extremes { top_speed, reach }))
    }

    fn gravity() -> impl Strategy<Value = Option<Vector>> {
        prop::option::of((finite(), finite()).prop_map(|(x, y)| Vector::new(x, y)))
    }

    proptest! {
        #[test]
        fn headers_and_ends_come_back(
            rate in prop::num::f64::NORMAL.prop_map(f64::abs),
            gravity in gravity(),
            default in 0.0..=1.0,
            pairs in vec(pair(), 0..4),
            (events_per_step, steps, every) in any::<(u64, u64, u64)>(),
            (collisions, error, recovered) in any::<(Option<u64>, Option<String>, bool)>(),
            extremes in extremes(),
        ) {
            let restitution = Restitution::new(default, &pairs);
            let settings = Settings { solver: SolverKind::EventDriven, rate, gravity, restitution, events_per_step };
            let gaps = vec![Gap { after: None, before: 7 }, Gap { after: Some(9), before: 12 }];
            let every = every.max(1);
            let (versions, scene) = (Versions::CURRENT, SceneText::default());
            let wanted = Header { versions, settings, steps, every, scene, gaps };
            let end = End { steps, collisions, bodies: 3, events: 4, error, recovered, extremes, identity: Identity(5) };
            for map in [of_header(&wanted), of_end(&wanted, &end)] {
                let found = header(&map).unwrap();
                prop_assert_eq!(format!("{found:?}"), format!("{wanted:?}"), "-0.0 counts, so compare the text");
            }
            prop_assert_eq!(super::end(&of_end(&wanted, &end)).unwrap(), end);
        }
    }

    #[test]
    fn a_changed_value_does_not_fit_the_checksum() {
        let mut map = sealed(Map::from([("a".into(), "1".into()), ("b".into(), "2".into())]));
        assert_eq!(unsealed(&map), Ok(()));
        map.insert("a".into(), "12".into());
        assert!(unsealed(&map).is_err());
        map.insert("a".into(), "1".into());
        map.insert("b1".into(), String::new());
        assert!(unsealed(&map).is_err());
    }
}
