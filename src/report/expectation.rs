use super::case::{Case, Trial, Truth, first_world};
use super::truth::{Number, Reference};
use crate::physics::SolverKind;

/// What a case is to come to, at every instant that is looked at.
#[derive(Clone, Debug, PartialEq)]
pub struct Expectation {
    /// For each look the positions of the finite masses in creation order, m.
    pub places: Option<Vec<Vec<[Number; 2]>>>,
    /// How many collisions there are up to the last look.
    pub collisions: Option<u64>,
    /// How that is known, or why not.
    pub source: String,
}

impl Expectation {
    /// What a case is to come to. Slow where there is no formula for it.
    pub fn of(case: &Case) -> Expectation {
        let known = |places: Option<_>, source: &str| Expectation {
            places,
            collisions: case.collisions,
            source: source.into(),
        };
        match &case.truth {
            Truth::ClosedForm(places) => known(Some(instants(case).map(|time| places(&time)).collect()), "closed form"),
            Truth::Rest => known(None, "nothing moves"),
            Truth::Crush => known(None, "an error"),
            Truth::Unknown(why) => known(None, why),
            Truth::Reference => by_reference(case).unwrap_or_else(|why| known(None, &why)),
        }
    }
}

/// The instants looked at, s.
fn instants(case: &Case) -> impl Iterator<Item = Number> {
    let rate = Number::from(case.rate);
    case.looks().map(move |step| &Number::from(step as f64) / &rate)
}

fn by_reference(case: &Case) -> Result<Expectation, String> {
    let trial = Trial { solver: SolverKind::EventDriven, factor: 1 };
    let scene = case.scene(trial).map_err(|error| error.to_string())?;
    if scene.inputs.iter().any(|input| input.step > 0) {
        return Err("bodies come or go, which 77 decimals do not follow".into());
    }
    let world = first_world(&scene).map_err(|error| error.to_string())?;
    let mut reference = Reference::new(&world, case.steps as f64 / case.rate).map_err(|why| why.to_string())?;
    let mut places = Vec::new();
    for time in instants(case) {
        reference.advance(&time).map_err(|why| why.to_string())?;
        places.push(reference.places(&time));
    }
    let collisions = Some(case.collisions.unwrap_or(reference.collisions));
    Ok(Expectation { places: Some(places), collisions, source: "77 decimals".into() })
}
