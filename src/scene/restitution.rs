use std::{collections::BTreeMap, ops::Range};

use super::{
    Fault, action,
    refusal::Refusal,
    tree::{Entry, Key, Node, Table, Value, unknown_key},
};
use crate::physics::{Restitution, RestitutionPair};

/// How many pairs a table may name: it is square in the number of materials.
const MOST_PAIRS: usize = 1000;

const COEFFICIENT: &str = "a coefficient of restitution from 0 (all is absorbed) to 1 (nothing is)";
const DEFAULT: Key = Key { name: "default", accepts: COEFFICIENT };
const PAIR: Key = Key { name: "\"a/b\" for two materials a and b", accepts: COEFFICIENT };

/// The scene's `[restitution]`.
pub fn read(node: &Node) -> Result<Restitution, Refusal> {
    let table = Table::of_any_keys("restitution", node)?;
    let default = table.optional(DEFAULT, coefficient)?.unwrap_or(1.0);
    let mut pairs = Vec::new();
    let mut places = BTreeMap::new();
    for entry in table.entries().iter().filter(|entry| entry.key != DEFAULT.name) {
        let pair = read_pair(&table, entry)?;
        if places.len() == MOST_PAIRS {
            let fault = Fault::TooMany { what: "pairs of materials", limit: MOST_PAIRS as u64 };
            return Err(Refusal::new(fault, entry.span.clone()));
        }
        remember(&mut places, &pair, entry)?;
        pairs.push(pair);
    }
    Ok(Restitution::new(default, &pairs))
}

fn read_pair(table: &Table, entry: &Entry) -> Result<RestitutionPair, Refusal> {
    let side = |text: &str| {
        let node = Node { span: entry.span.clone(), value: Value::Text(text.into()) };
        action::material(&node).map(String::from).ok()
    };
    let sides = entry.key.split_once('/').map(|(a, b)| (side(a), side(b)));
    let Some((Some(a), Some(b))) = sides else {
        return Err(unknown_key(table.name, entry, &[DEFAULT, PAIR]));
    };
    let restitution = table.field(entry, COEFFICIENT).read(coefficient)?;
    Ok(RestitutionPair { materials: [a, b], restitution })
}

/// Refuses the pair if it stands in `places`, either way round.
fn remember(
    places: &mut BTreeMap<[String; 2], Range<usize>>,
    pair: &RestitutionPair,
    entry: &Entry,
) -> Result<(), Refusal> {
    let mut sorted = pair.materials.clone();
    sorted.sort();
    match places.insert(sorted, entry.span.clone()) {
        Some(earlier) => {
            let fault = Fault::DuplicatePair { pair: entry.key.clone() };
            Err(Refusal::new(fault, entry.span.clone()).after(earlier))
        }
        None => Ok(()),
    }
}

fn coefficient(node: &Node) -> Result<f64, &Node> {
    node.number_where(|e| (0.0..=1.0).contains(&e))
}
