//! The scenes in the format of rebond. All engines get the bodies that rebond spawns from them.

use crate::oracle::{Oracle, ROW};
use std::fmt::Write;

/// A scene at one rate.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The name in the table.
    pub name: String,
    /// Steps per second.
    pub rate: u64,
    /// The number of steps of each phase; phases are timed separately.
    pub phases: Vec<u64>,
    /// True if bodies may sleep.
    pub sleep: bool,
    /// The scene as TOML.
    pub toml: String,
    /// The correct result.
    pub oracle: Oracle,
}

const RATES: [u64; 3] = [60, 240, 960];

/// All scenes at all their rates; with `quick` only at 60 Hz and without the largest.
pub fn all(quick: bool) -> Vec<Scene> {
    let mut scenes = Vec::new();
    for rate in RATES {
        scenes.extend([bounce(rate), between_walls(rate), shot_at_fixed(rate), shot_at_free(rate)]);
        scenes.extend([cradle(rate, 0.0), cradle(rate, 1e-3)]);
        scenes.extend((0..=4).map(|digits| galperin(rate, digits)));
        scenes.extend([10, 50].map(|height| stack(rate, &format!("stack of {height}"), &vec![1.0; height])));
        let doubling: Vec<f64> = (0..10).map(|power| f64::from(1 << power)).collect();
        scenes.push(stack(rate, "stack of masses 2⁰ to 2⁹", &doubling));
        scenes.push(stack(rate, "1000 kg on 1 kg", &[1.0, 1000.0]));
        scenes.push(gas(rate, 100));
        scenes.extend([1.0, 0.99, 0.0].map(|restitution| row(rate, restitution)));
        scenes.extend([0.5, 1.0, 1.6, 2.0, 3.0].map(|ratio| seams(rate, ratio, 0.0)));
        scenes.extend([seams(rate, 1.0, 1.0), corners(rate)]);
    }
    scenes.extend([gas(60, 1000), gas(240, 1000), gas(60, 10_000)]);
    scenes.extend([60, 240].map(|rate| columns(rate, 40, 25)));
    scenes.push(columns(60, 125, 80));
    scenes.extend([heap(60, 1000), heap(60, 10_000)]);
    scenes.retain(|scene| !quick || (scene.rate == 60 && !scene.name.contains("10⁴")));
    // All rates of a scene follow each other.
    let names: Vec<String> = scenes.iter().map(|scene| scene.name.clone()).collect();
    scenes.sort_by_key(|scene| (names.iter().position(|name| *name == scene.name), scene.rate));
    scenes
}

fn scene(name: &str, rate: u64, seconds: u64, world: &str, bodies: &str, oracle: Oracle) -> Scene {
    scene_of_steps(name, rate, vec![rate * seconds], world, bodies, oracle)
}

fn scene_of_steps(name: &str, rate: u64, phases: Vec<u64>, world: &str, bodies: &str, oracle: Oracle) -> Scene {
    let steps: u64 = phases.iter().sum();
    let toml = format!(
        "[world]\n{world}\n[run]\nrate = {rate}\nsteps = {steps}\nsolver = \"event-driven\"\n\
         [restitution]\ndefault = {:?}\n{bodies}",
        oracle.restitution()
    );
    Scene { name: name.to_owned(), rate, phases, sleep: false, toml, oracle }
}

fn spawn(at: [f64; 2], size: [f64; 2], mass: f64, velocity: [f64; 2]) -> String {
    format!("[[spawn]]\nat = {at:?}\nsize = {size:?}\nmass = {mass:?}\nvelocity = {velocity:?}\n")
}

const GRAVITY: &str = "gravity = [0.0, 9.81]";

fn bounce(rate: u64) -> Scene {
    let bodies = spawn([0.0, 10.0], [16.0, 1.0], f64::INFINITY, [0.0; 2]) + &spawn([4.0, 5.0], [1.0; 2], 1.0, [0.0; 2]);
    scene("bounce for a minute", rate, 60, &format!("size = [16.0, 10.0]\n{GRAVITY}"), &bodies, Oracle::Bounce)
}

fn between_walls(rate: u64) -> Scene {
    let wall = |x| spawn([x, 0.0], [1.0, 4.0], f64::INFINITY, [0.0; 2]);
    let bodies = wall(0.0) + &wall(11.0) + &spawn([5.0, 1.5], [1.0; 2], 1.0, [3.7, 0.0]);
    scene("between walls for a minute", rate, 60, "size = [12.0, 4.0]", &bodies, Oracle::BetweenWalls)
}

/// A tenth of a second; at 60 Hz the impact is in the second of six steps.
fn shot(name: &str, rate: u64, mass: f64, oracle: Oracle) -> Scene {
    let bullet = spawn([0.0, 0.45], [0.1; 2], 1.0, [7000.0, 0.0]);
    let plate = spawn([170.3, 0.0], [0.001, 1.0], mass, [0.0; 2]);
    scene_of_steps(name, rate, vec![rate / 10], "size = [400.0, 1.0]", &(bullet + &plate), oracle)
}

fn shot_at_fixed(rate: u64) -> Scene {
    shot("7 km/s at a fixed 1 mm plate", rate, f64::INFINITY, Oracle::ShotAtFixed)
}

fn shot_at_free(rate: u64) -> Scene {
    shot("7 km/s at a free 1 mm plate", rate, 3.0, Oracle::ShotAtFree)
}

fn cradle(rate: u64, gap: f64) -> Scene {
    let mut bodies = spawn([0.0; 2], [1.0; 2], 1.0, [2.0, 0.0]);
    for number in 0..4 {
        bodies += &spawn([3.1 + f64::from(number) * (1.0 + gap), 0.0], [1.0; 2], 1.0, [0.0; 2]);
    }
    let name = if gap == 0.0 { "cradle, touching".to_owned() } else { format!("cradle, gaps of {gap} m") };
    scene(&name, rate, 3, "size = [16.0, 1.0]", &bodies, Oracle::Cradle { gap })
}

/// The boxes start so close to the wall that the last collision is before 8 s.
fn galperin(rate: u64, digits: u32) -> Scene {
    let mass = 100_f64.powi(digits as i32);
    let bodies = spawn([0.0; 2], [1.0, 9.0], f64::INFINITY, [0.0; 2])
        + &spawn([2.0, 8.0], [1.0; 2], 1.0, [0.0; 2])
        + &spawn([4.0, 7.0], [2.0; 2], mass, [-1.0, 0.0]);
    scene(&format!("Galperin {digits}"), rate, 10, "size = [16.0, 9.0]", &bodies, Oracle::Galperin { digits })
}

fn stack(rate: u64, name: &str, masses: &[f64]) -> Scene {
    let height = masses.len() as f64;
    let mut bodies = spawn([0.0, height], [16.0, 1.0], f64::INFINITY, [0.0; 2]);
    for (number, mass) in masses.iter().enumerate() {
        bodies += &spawn([7.5, height - 1.0 - number as f64], [1.0; 2], *mass, [0.0; 2]);
    }
    scene(name, rate, 10, &format!("size = [16.0, {height:?}]\n{GRAVITY}"), &bodies, Oracle::Rest)
}

/// Touching boxes slide into a wall at 1 m/s.
fn row(rate: u64, restitution: f64) -> Scene {
    let mut bodies = spawn([-1.0, 0.0], [1.0; 2], f64::INFINITY, [0.0; 2]);
    for number in 0..ROW {
        bodies += &spawn([1.0 + number as f64, 0.0], [1.0; 2], 1.0, [-1.0, 0.0]);
    }
    let name = format!("row of {ROW} at a wall, e = {restitution}");
    scene(&name, rate, 2, "size = [20.0, 9.0]", &bodies, Oracle::Row { restitution })
}

/// A box of `ratio` tiles slides over flush tiles of 0.8 m at 3 m/s.
fn seams(rate: u64, ratio: f64, restitution: f64) -> Scene {
    const WIDTH: f64 = 0.8;
    let side = WIDTH * ratio;
    let tiles = (0..30).map(|number| spawn([WIDTH * f64::from(number), 8.0], [WIDTH, 0.5], f64::INFINITY, [0.0; 2]));
    let bodies = tiles.collect::<String>() + &spawn([0.5, 8.0 - side], [side; 2], 1.0, [3.0, 0.0]);
    let world = format!("size = [24.0, 9.0]\n{GRAVITY}");
    let noun = if ratio == 1.0 { "tile" } else { "tiles" };
    scene(
        &format!("seams, box of {ratio} {noun}, e = {restitution}"),
        rate,
        6,
        &world,
        &bodies,
        Oracle::Seams { restitution },
    )
}

/// Two boxes at rest touch at their corners and are pressed together.
fn corners(rate: u64) -> Scene {
    let pushed = |at, force: [f64; 2]| spawn(at, [1.0; 2], 1.0, [0.0; 2]) + &format!("force = {force:?}\n");
    let bodies = pushed([2.0, 1.0], [6.0, 10.0]) + &pushed([3.0, 2.0], [3.0, -15.0]);
    scene("corners pressed together", rate, 1, "size = [16.0, 9.0]", &bodies, Oracle::Corners)
}

/// Unit boxes that fill a fifth of the area.
fn gas(rate: u64, count: u64) -> Scene {
    let side = (count as f64 * 5.0).sqrt();
    let bodies = format!(
        "[[scatter]]\ncount = {count}\nseed = 1\nregion = [0.0, 0.0, {side}, {side}]\nsize = [[1.0, 1.0], [1.0, 1.0]]\n\
         mass = [1.0, 1.0]\nvelocity = [[-5.0, -5.0], [5.0, 5.0]]\n"
    );
    let steps = if count == 10_000 { 1000 } else { 10 * rate };
    let world = format!("size = [{side}, {side}]\nwalls = true");
    scene_of_steps(&format!("gas of {}", power(count)), rate, vec![steps], &world, &bodies, Oracle::Gas)
}

/// Unit boxes that fall in loose columns for 10 s and then lie for 5 s.
fn columns(rate: u64, wide: u64, high: u64) -> Scene {
    let mut random = Random(7);
    let [width, height] = [wide as f64 * 1.5, high as f64 * 1.45 + 1.0];
    let mut bodies = String::new();
    for row in 0..high {
        for column in 0..wide {
            let x = column as f64 * 1.5 + 0.05 + 0.4 * random.unit();
            let y = height - 1.0 - 1.4 * row as f64 - 0.1 - 0.3 * random.unit();
            write!(bodies, "[[spawn]]\nat = [{x}, {y}]\nsize = [1.0, 1.0]\nmass = 1.0\n")
                .expect("writing to a string cannot fail");
        }
    }
    let world = format!("size = [{width:?}, {height:?}]\nwalls = true\n{GRAVITY}");
    let name = format!("columns of {}", power(wide * high));
    let phases = vec![10 * rate, 5 * rate];
    Scene { sleep: true, ..scene_of_steps(&name, rate, phases, &world, &bodies, Oracle::Fall) }
}

/// Boxes with sides of 0.6 to 1.4 m that are thrown sideways into a bin, where they keep sliding without friction.
fn heap(rate: u64, count: u64) -> Scene {
    let width = (count as f64 * 3.6).sqrt();
    let height = width * 0.8;
    let bodies = format!(
        "[[scatter]]\ncount = {count}\nseed = 1\nregion = [0.0, 0.0, {width}, {height}]\nsize = [[0.6, 0.6], [1.4, 1.4]]\n\
         mass = [1.0, 1.0]\nvelocity = [[-3.0, 0.0], [3.0, 0.0]]\n"
    );
    let world = format!("size = [{width}, {height}]\nwalls = true\n{GRAVITY}");
    Scene { sleep: true, ..scene(&format!("heap of {}", power(count)), rate, 10, &world, &bodies, Oracle::Slide) }
}

fn power(count: u64) -> &'static str {
    match count {
        100 => "10²",
        1000 => "10³",
        _ => "10⁴",
    }
}

/// SplitMix64, by Steele, Lea and Flood (2014).
struct Random(u64);

impl Random {
    /// A number uniformly distributed in [0, 1).
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((bits ^ (bits >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}
