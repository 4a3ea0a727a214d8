use super::{
    Diagnostic, DiagnosticKind, action,
    diagnostics::{Reported, Reporter},
    tree::{Entry, Key, Node, Table, Value, unknown_key},
};
use crate::physics::{Restitution, RestitutionPair};
use std::{collections::BTreeMap, ops::Range};

/// The largest number of pairs: the table of a run is square in the number of materials.
const MAX_PAIRS: usize = 1000;

/// The coefficient of restitution of a scene that gives none.
pub const DEFAULT_RESTITUTION: f64 = 1.0;

const COEFFICIENT: &str = "a coefficient of restitution from 0 (perfectly inelastic) to 1 (elastic)";
const DEFAULT: Key = Key { name: "default", accepts: COEFFICIENT };
const PAIR: Key = Key { name: "\"a/b\" for two materials a and b", accepts: COEFFICIENT };

/// The keys of `[restitution]`; a pair stands for the names of any two materials.
pub const KEYS: &[Key] = &[DEFAULT, PAIR];

/// Reads `[restitution]`.
pub fn read(node: &Node, reporter: &Reporter) -> Result<Restitution, Reported> {
    let table = Table::with_any_keys("restitution", node, reporter)?;
    let default = table.optional(DEFAULT, coefficient);
    let mut pairs = Vec::new();
    let mut refused = None;
    let mut seen = BTreeMap::new();
    for entry in table.entries().iter().filter(|entry| entry.key != DEFAULT.name) {
        if seen.len() == MAX_PAIRS {
            let kind = DiagnosticKind::TooMany { what: "pairs of materials", limit: MAX_PAIRS as u64 };
            return Err(reporter.report(Diagnostic::new(kind, entry.span.clone())));
        }
        match read_pair(&table, entry, &mut seen, reporter) {
            Ok(pair) => pairs.push(pair),
            Err(reported) => refused = Some(reported),
        }
    }
    match refused {
        Some(reported) => Err(reported),
        None => Ok(Restitution::new(default?.unwrap_or(DEFAULT_RESTITUTION), &pairs)),
    }
}

/// Reads one pair; `seen` has the locations of the pairs before it.
fn read_pair(
    table: &Table,
    entry: &Entry,
    seen: &mut BTreeMap<[String; 2], Range<usize>>,
    reporter: &Reporter,
) -> Result<RestitutionPair, Reported> {
    let side = |text: &str| {
        let node = Node { span: entry.span.clone(), value: Value::Text(text.into()) };
        action::material(&node).map(String::from).ok()
    };
    let sides = entry.key.split_once('/').map(|(a, b)| (side(a), side(b)));
    let Some((Some(a), Some(b))) = sides else {
        return Err(reporter.report(unknown_key(table.name, entry, KEYS)));
    };
    let restitution = table.field(entry, COEFFICIENT).read(coefficient);
    let materials = [a, b];
    let mut sorted = materials.clone();
    sorted.sort();
    if let Some(earlier) = seen.insert(sorted, entry.span.clone()) {
        let kind = DiagnosticKind::DuplicatePair { pair: entry.key.clone() };
        return Err(reporter.report(Diagnostic::new(kind, entry.span.clone()).conflicting_with(earlier)));
    }
    Ok(RestitutionPair { materials, restitution: restitution? })
}

fn coefficient(node: &Node) -> Result<f64, &Node> {
    node.number_where(|e| (0.0..=1.0).contains(&e))
}
