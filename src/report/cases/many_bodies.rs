//! Many boxes: elastic gases, and piles that come to rest.

use super::case_spec::{CaseSpec, GRAVITY};
use crate::report::{Case, Oracle};

/// Gases of 100 to 100,000 boxes; piles of 1000 and 10,000, while they fall and later.
pub fn cases(full: bool) -> Vec<Case> {
    let mut specs = vec![gas(100, 300), gas(1000, 30), gas(10_000, 60), gas(100_000, 30)];
    let piles: &[u64] = if full { &[1000, 10_000] } else { &[1000] };
    specs.extend(piles.iter().flat_map(|&bodies| [pile(bodies), settled(bodies)]));
    specs.into_iter().map(CaseSpec::build).collect()
}

/// Unit boxes between walls that fill a fifth of the area, with up to 5 m/s along each axis.
pub fn gas(bodies: u64, steps: u64) -> CaseSpec {
    let side = (bodies as f64 * 5.0).sqrt();
    let scatter = format!(
        "[[scatter]]\ncount = {bodies}\nseed = 1\nregion = [0.0, 0.0, {side:?}, {side:?}]\n\
         size = [[1.0, 1.0], [1.0, 1.0]]\nmass = [1.0, 1.0]\nvelocity = [[-5.0, -5.0], [5.0, 5.0]]\n"
    );
    let oracle = match bodies {
        0..=1000 => Oracle::Simulation,
        _ => Oracle::Unknown("too many bodies for 77 decimals".into()),
    };
    let world = [side; 2];
    let factors: &[u64] = if bodies > 10_000 { &[1, 2] } else { super::case_spec::RATES };
    CaseSpec {
        world,
        walls: true,
        steps,
        factors,
        oracle,
        ..CaseSpec::new("gas", &format!("gas of {bodies}"), scatter)
    }
}

/// Boxes of sides 0.6 to 1.4 m fall into a bin, e = 0.3.
fn pile(bodies: u64) -> CaseSpec {
    let width = (bodies as f64 * 3.6).sqrt();
    let height = width * 0.8;
    let scatter = format!(
        "[[scatter]]\ncount = {bodies}\nseed = 1\nregion = [0.0, 0.0, {width:?}, {height:?}]\n\
         size = [[0.6, 0.6], [1.4, 1.4]]\nmass = [1.0, 1.0]\nvelocity = [[-3.0, 0.0], [3.0, 0.0]]\n"
    );
    let oracle = Oracle::Unknown("resting contacts are not simulated with 77 decimals".into());
    CaseSpec {
        world: [width, height],
        walls: true,
        gravity: GRAVITY,
        restitution: 0.3,
        factors: &[1, 2],
        oracle,
        ..CaseSpec::new("pile", &format!("pile of {bodies}"), scatter)
    }
}

/// The same pile 30 s later. Without friction, boxes keep sliding over and off each other.
fn settled(bodies: u64) -> CaseSpec {
    let name = format!("pile of {bodies} after 30 s");
    CaseSpec { family: "settled pile", name, steps: 1950, from: 1800, ..pile(bodies) }
}
