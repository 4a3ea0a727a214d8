//! Random scenes by kind.

use super::{
    lattice::{Cell, Lattice, Motion, moving, still},
    scene::Scene,
};
use crate::world_builder::INFINITE;

/// Fills a lattice with the boxes of a kind.
type Fill = fn(&mut Lattice);

/// The kinds of scenes, by name.
const KINDS: [(&str, Fill); 14] = [
    ("grid", grid),
    ("tower", tower),
    ("row", row),
    ("column", column),
    ("blocks", blocks),
    ("seams", seams),
    ("platform", platform),
    ("heap", heap),
    ("corner", corner),
    ("pressed", pressed),
    ("squeeze", squeeze),
    ("churn", churn),
    ("graze", graze),
    ("gas", gas),
];

/// The random scene of a seed; consecutive seeds go through all kinds.
pub fn random_scene(seed: u64) -> Scene {
    let (kind, fill) = KINDS[(seed % KINDS.len() as u64) as usize];
    let mut lattice = Lattice::new(kind, seed);
    fill(&mut lattice);
    lattice.finish()
}

/// A random scene of the kind `gas`: boxes in general position at e = 1, of which nothing coincides.
pub fn random_gas(seed: u64) -> Scene {
    let mut lattice = Lattice::new("gas", seed);
    gas(&mut lattice);
    lattice.finish()
}

/// A random scene of the kinds whose bodies touch at the start.
pub fn random_touching_scene(seed: u64) -> Scene {
    let (kind, fill) = KINDS[[9, 1, 9, 0, 3, 9, 8][(seed % 7) as usize]];
    let mut lattice = Lattice::new(kind, seed);
    fill(&mut lattice);
    lattice.finish()
}
/// Boxes at random places of a small lattice, some touching, some moving, some with forces.
fn grid(b: &mut Lattice) {
    b.gravity(50, 15);
    if b.random.chance(60) {
        b.add([-2, 8], [14, 1], still().infinite());
    }
    if b.random.chance(30) {
        b.add([-3, -2], [1, 10], still().infinite());
    }
    let forces = b.random.pick(&[0, 0, 30, 60]);
    let percent_moving = b.random.pick(&[20, 50, 100]);
    let infinite = b.random.pick(&[0, 0, 15]);
    for _ in 0..b.random.whole(3, 10) {
        let r = &mut b.random;
        let velocity = if r.chance(percent_moving) { [r.whole(-3, 3), r.whole(-3, 3)] } else { [0, 0] };
        let at = [r.whole(0, 8), r.whole(0, 6)];
        let size = [r.whole(1, 3), r.whole(1, 2)];
        let force = b.some_force(forces);
        let motion = if b.random.chance(infinite) { still().infinite() } else { moving(velocity[0], velocity[1]) };
        b.add(at, size, motion.pushed(force));
    }
}

/// A tower on several supports, with blocks thrown at it or dropped on it.
fn tower(b: &mut Lattice) {
    b.gravity(100, 10);
    b.add([-8, 12], [32, 1], still().infinite());
    let forces = b.random.pick(&[0, 0, 20]);
    let (mut level, mut left, mut right) = (12, 0, b.random.whole(3, 8));
    for _ in 0..b.random.whole(1, 3) {
        let height = b.random.whole(1, 2);
        if b.random.chance(60) && right - left >= 3 {
            for _ in 0..b.random.whole(2, 3) {
                let (place, force) = (b.random.whole(left, right - 1), b.some_force(forces));
                b.add([place, level - height], [1, height], still().pushed(force));
            }
            level -= height + 1;
            let (over, under, force) = (b.random.whole(0, 1), b.random.whole(0, 1), b.some_force(forces));
            b.add([left - over, level], [right - left + over + under, 1], still().pushed(force));
        } else {
            let wide = b.random.whole(1, right - left);
            let (at, force) = (b.random.whole(left, right - wide), b.some_force(forces));
            level -= height;
            b.add([at, level], [wide, height], still().pushed(force));
            (left, right) = (at, at + wide);
        }
    }
    for _ in 0..b.random.whole(0, 2) {
        let r = &mut b.random;
        if r.chance(50) {
            let (at, size) = ([r.whole(-7, -3), r.whole(level - 1, 10)], [r.whole(1, 2), r.whole(1, 2)]);
            let speed = r.whole(1, 12);
            b.add(at, size, moving(speed, 0));
        } else {
            let (at, size) = ([r.whole(-1, 7), r.whole(level - 6, level - 2)], [r.whole(1, 3), 1]);
            let speed = r.whole(0, 4);
            b.add(at, size, moving(0, speed));
        }
    }
}

/// A row of boxes and a wall, touching, with gaps of the lattice or of nanometres; in some scenes with a heavy box, a
/// second wall or gravity.
fn row(b: &mut Lattice) {
    let r = &mut b.random;
    let (count, gaps) = (r.whole(2, 9), r.below(5));
    let (nanometre_gaps, lattice_gaps) = (if gaps >= 3 && b.scene.is_dyadic { gaps } else { 0 }, gaps == 2);
    let speed = -r.whole(1, 4);
    match r.below(100) {
        0..70 => {
            let drift = r.pick(&[0, 0, 0, 1, -1]);
            b.add([-3, -2], [2, 5], moving(drift, 0).infinite());
        }
        70..85 => {
            let mass = r.pick(&[1000.0, 100.0, 1e6]);
            b.add([-3, -1], [2, 3], still().heavy(mass));
        }
        _ => {}
    }
    if b.random.chance(30) {
        b.add([-4, 2], [40, 1], still().infinite());
        b.gravity(100, 0);
    }
    let (mut x, mut nanometres) = (b.random.pick(&[-1, 0, 1, 2]), 0.0);
    for index in 0..count {
        let r = &mut b.random;
        let width = if r.chance(80) { 1 } else { 2 };
        let (y, height) = if r.chance(70) { (0, 2) } else { (1, 1) };
        let is_heavy = index == count - 1 && r.chance(40);
        let velocity = if is_heavy || r.chance(85) { speed } else { r.whole(-3, 2) };
        let heavy = r.pick(&[100.0, 1e4, 7.0]);
        let motion = moving(velocity, 0);
        if b.add([x, y], [width, height], if is_heavy { motion.heavy(heavy) } else { motion }) {
            b.cells.last_mut().expect("the box just added").nanometres = nanometres;
        }
        x += width + if lattice_gaps { b.random.pick(&[0, 0, 1]) } else { 0 };
        if nanometre_gaps == 3 || nanometre_gaps == 4 && b.random.chance(50) {
            nanometres += 1.0;
        }
    }
    if b.random.chance(25) {
        let gap = b.random.whole(2, 4);
        b.add([x + gap, -2], [2, 5], still().infinite());
    }
    b.scene.is_dyadic &= nanometres == 0.0;
}

/// A column of boxes that falls on a floor, touching or with gaps; some rest at the start.
fn column(b: &mut Lattice) {
    b.gravity(85, 0);
    let falls = b.scene.gravity[1] != 0.0;
    let drift = b.random.pick(&[0, 0, 0, 0, -1, 1]);
    b.add([-3, 10], [10, 1], moving(0, drift).infinite());
    let r = &mut b.random;
    let mut y = if r.chance(30) { 10 } else { 10 - r.whole(1, 3) };
    let speed = if falls { r.whole(0, 3) } else { r.whole(1, 3) };
    for _ in 0..r.whole(2, 8) {
        let r = &mut b.random;
        let (x, width, height) = (r.pick(&[0, 0, 1]), r.pick(&[2, 2, 3]), r.whole(1, 2));
        let velocity = [r.pick(&[0, 0, 0, 1]), if r.chance(80) { speed } else { 0 }];
        let gap = r.pick(&[0, 0, 0, 1]);
        b.add([x, y - height], [width, height], moving(velocity[0], velocity[1]));
        y -= height + gap;
    }
    if b.random.chance(30) {
        let r = &mut b.random;
        let (x, speed, mass) = (r.pick(&[-1, 0, 1]), r.whole(0, 4), r.pick(&[1.0, 100.0, 1e4]));
        b.add([x, y - 6], [2, 1], moving(0, speed).heavy(mass));
    }
}

/// Blocks of touching boxes thrown at walls and at each other.
fn blocks(b: &mut Lattice) {
    b.gravity(30, 15);
    b.add([-6, -6], [1, 16], still().infinite());
    b.add([-5, 9], [22, 1], still().infinite());
    if b.random.chance(50) {
        b.add([16, -6], [1, 15], still().infinite());
    }
    let mut left = 8;
    for _ in 0..b.random.whole(1, 3) {
        let r = &mut b.random;
        let corner = [r.whole(-5, 12), r.whole(-4, 6)];
        let [x, y] = r.pick(&[[-2, 0], [2, 0], [0, 2], [-2, 2], [2, 1], [-1, 1], [0, 0], [-3, -3]]);
        for i in 0..r.whole(1, 3) {
            for j in 0..b.random.whole(1, 2) {
                let is_there = left > 0 && b.random.chance(90);
                left -= i64::from(is_there && b.add([corner[0] + i, corner[1] + j], [1, 1], moving(x, y)));
            }
        }
    }
}

/// Boxes that slide over flush tiles of many widths, with starts and ends of contact at seams.
fn seams(b: &mut Lattice) {
    let is_pulled = b.random.chance(75);
    b.gravity(if is_pulled { 100 } else { 0 }, 10);
    let widths: &[i64] = match b.random.below(6) {
        0 => &[1],
        1 => &[2],
        2 => &[1, 2],
        3 => &[1, 2, 3],
        4 => &[3, 4],
        _ => &[1, 5],
    };
    let (mut end, mut edges, mut tiles) = (0, vec![0], Vec::new());
    for _ in 0..b.random.whole(2, 6) {
        let width = b.random.pick(widths);
        tiles.push((end, width));
        end += width;
        edges.push(end);
    }
    let is_floating = b.random.chance(10);
    let ceiling = b.random.chance(15).then(|| b.random.pick(&[4, 5]));
    for (x, width) in tiles {
        let height = b.random.pick(&[1, 1, 2]);
        b.add([x, 8], [width, height], still().heavy(if is_floating { 1e6 } else { INFINITE }));
        if let Some(y) = ceiling {
            b.add([x, y], [width, 1], still().infinite());
        }
    }
    if is_floating {
        b.add([-2, 10], [end + 4, 1], still().infinite());
    }
    if b.random.chance(30) {
        let at = [b.random.pick(&[-1, end]), b.random.pick(&[6, 7])];
        b.add(at, [1, 2], still().infinite());
    }
    for _ in 0..b.random.whole(1, 3) {
        let r = &mut b.random;
        let edge = r.pick(&edges[1..]);
        let width = [1, 2, 3, edge, r.pick(widths)][r.below(5) as usize];
        let (height, above) = (r.whole(1, 2), r.pick(&[0, 0, 0, 1, 2]));
        let force = [r.pick(&[0.0, 0.0, 0.0, 1.0, -1.0, 2.0]), if is_pulled { 0.0 } else { 8.0 }];
        let x = if r.chance(80) { r.pick(&edges) } else { r.whole(-1, end) };
        let speed = r.pick(&[1, 2, -1, -2, 4, 0, 3]);
        b.add([x, 8 - height - above], [if width > 6 { 6 } else { width }, height], moving(speed, 0).pushed(force));
    }
    if b.random.chance(30) {
        let r = &mut b.random;
        let (at, size, speed) = ([r.whole(0, end), r.whole(2, 5)], [r.whole(1, 2), 1], r.whole(-2, 2));
        b.add(at, size, moving(speed, 0));
    }
}

/// Boxes on, above and below infinite masses that move.
fn platform(b: &mut Lattice) {
    b.gravity(80, 0);
    for _ in 0..b.random.whole(1, 3) {
        let r = &mut b.random;
        let drift = r.pick(&[[0, -1], [0, 1], [1, 0], [-1, 0], [0, -3], [2, -1], [0, 0], [1, 1]]);
        let (x, y) = (r.whole(-2, 6), if r.chance(60) { 8 } else { r.whole(4, 9) });
        let width = r.whole(3, 8);
        if !b.add([x, y], [width, 1], moving(drift[0], drift[1]).infinite()) {
            continue;
        }
        for _ in 0..b.random.whole(1, 3) {
            let r = &mut b.random;
            let (width, height) = (r.whole(1, 3), r.whole(1, 2));
            let (above, beside) = (r.pick(&[0, 0, 0, 1, 2]), r.whole(-1, 6));
            let falls = if r.chance(50) { r.whole(-2, 2) } else { drift[1] };
            let velocity = if r.chance(50) { drift } else { [r.whole(-2, 2), falls] };
            let force = b.some_force(15);
            let at = [x + beside, y - height - above];
            b.add(at, [width, height], moving(velocity[0], velocity[1]).pushed(force));
        }
    }
    for _ in 0..b.random.whole(0, 2) {
        let r = &mut b.random;
        let (at, size) = ([r.whole(-3, 8), r.whole(0, 3)], [r.whole(1, 2), 1]);
        let velocity = [r.whole(-2, 2), r.whole(0, 2)];
        b.add(at, size, moving(velocity[0], velocity[1]));
    }
}

/// Boxes that fall into a pit.
fn heap(b: &mut Lattice) {
    b.gravity(100, 20);
    let width = b.random.whole(4, 9);
    b.add([-1, 10], [width + 2, 1], still().infinite());
    b.add([-1, -8], [1, 18], still().infinite());
    b.add([width, -8], [1, 18], still().infinite());
    for _ in 0..b.random.whole(3, 8) {
        let r = &mut b.random;
        let size = [r.whole(1, 3), if r.chance(90) { r.whole(1, 2) } else { 3 }];
        let at = [r.whole(0, width - size[0]), r.whole(-4, 9)];
        let velocity = if r.chance(60) { [r.whole(-2, 2), r.whole(-1, 2)] } else { [0, 0] };
        let force = b.some_force(8);
        b.add(at, size, moving(velocity[0], velocity[1]).pushed(force));
    }
}

/// Boxes whose corners meet exactly, with equal and unequal approaches, and neighbours that touch.
fn corner(b: &mut Lattice) {
    b.gravity(20, 15);
    for _ in 0..b.random.whole(1, 3) {
        let r = &mut b.random;
        let (x, y, width, height) = (r.whole(-6, 12), r.whole(-6, 8), r.whole(1, 2), r.whole(1, 2));
        let velocity = r.pick(&[[1, 1], [1, 2], [2, 1], [3, 1], [2, 2], [1, 3]]);
        let (time, sign, other) = (r.whole(0, 2), [r.pick(&[-1, 1]), r.pick(&[-1, 1])], [r.whole(1, 2), r.whole(1, 2)]);
        let is_infinite = r.chance(30);
        if !b.add([x, y], [width, height], if is_infinite { still().infinite() } else { still() }) {
            continue;
        }
        let far = [x + width, y + height];
        let at = [0, 1]
            .map(|k| if sign[k] > 0 { far[k] + velocity[k] * time } else { [x, y][k] - other[k] - velocity[k] * time });
        let approach = moving(-sign[0] * velocity[0], -sign[1] * velocity[1]);
        let force = b.some_force(10);
        b.add(at, other, approach.pushed(force));
        if b.random.chance(40) {
            let offset = b.random.pick(&[-1, 0, 1]);
            let is_infinite = is_infinite && b.random.chance(50);
            b.add([x + width, y + offset], [1, height], if is_infinite { still().infinite() } else { still() });
        }
        if b.random.chance(40) {
            b.add([at[0], if sign[1] > 0 { at[1] - 1 } else { at[1] + other[1] }], [other[0], 1], approach);
        }
    }
    for _ in 0..b.random.whole(0, 2) {
        let r = &mut b.random;
        let (at, velocity) = ([r.whole(-6, 12), r.whole(-6, 8)], [r.whole(-2, 2), r.whole(-2, 2)]);
        b.add(at, [1, 1], moving(velocity[0], velocity[1]));
    }
}

/// Boxes that touch at faces and corners, most of them at rest, and are pressed by forces.
fn pressed(b: &mut Lattice) {
    b.gravity(25, 30);
    let pattern = b.random.pick(&["chess", "random", "random", "steps"]);
    let (forces, infinite) = (b.random.pick(&[40, 80, 100]), b.random.pick(&[0, 15, 30]));
    let is_moving = b.random.chance(30);
    let mut places: Vec<[i64; 2]> = (0..16).map(|n| [n / 4, n % 4]).collect();
    places.retain(|[x, y]| match pattern {
        "chess" => (x + y) % 2 == 0 || b.random.chance(15),
        "steps" => x == y || (x - y).abs() == 1 && b.random.chance(20),
        _ => true,
    });
    b.random.shuffle(&mut places);
    places.truncate(b.random.whole(2, 9) as usize);
    for at in places {
        let r = &mut b.random;
        let size = if pattern != "random" || r.chance(60) { [1, 1] } else { [r.whole(1, 2), r.whole(1, 2)] };
        let velocity = if is_moving && r.chance(30) { [r.whole(-1, 1), r.whole(-1, 1)] } else { [0, 0] };
        let force = b.some_force(forces);
        let is_infinite = b.random.chance(infinite);
        let motion = if is_infinite { still().infinite() } else { moving(velocity[0], velocity[1]) };
        b.add(at, size, motion.pushed(force));
    }
}

/// Infinite or heavy masses that approach each other, and light boxes between them.
fn squeeze(b: &mut Lattice) {
    b.gravity(20, 0);
    let (length, is_moving) = (b.random.whole(3, 9), b.random.chance(60));
    let heavy = b.random.pick(&[50.0, 1000.0, 1e4]);
    for (x, sign) in [(-2, 1), (length, -1)] {
        let speed = if is_moving { sign * b.random.whole(0, 2) } else { 0 };
        if b.random.chance(70) {
            b.add([x, 0], [2, 4], moving(speed, 0).infinite());
        } else {
            b.add([x, 0], [2, 4], moving(if speed == 0 { sign } else { speed }, 0).heavy(heavy));
        }
    }
    for _ in 0..b.random.whole(1, 6) {
        let r = &mut b.random;
        let width = r.whole(1, 2);
        let at = [r.whole(0, length - width), r.pick(&[0, 1, 2, 3, -1])];
        let (height, speed) = (r.pick(&[1, 1, 2]), r.pick(&[0, 0, 1, -1]));
        b.add(at, [width, height], moving(speed, 0));
    }
    if b.random.chance(40) {
        b.add([-4, 4], [length + 8, 1], still().infinite());
        b.gravity(50, 0);
    }
}

/// Towers, heaps, grids and seams with spawns and deletes in motion.
fn churn(b: &mut Lattice) {
    b.random.pick::<fn(&mut Lattice)>(&[tower, heap, grid, seams])(b);
    for _ in 0..b.random.whole(1, 3) {
        let (index, step) = (b.random.below(b.cells.len() as u64) as usize, b.some_step());
        b.cells[index].delete = Some(step);
    }
    for _ in 0..b.random.whole(0, 2) {
        let step = b.some_step();
        let r = &mut b.random;
        let y = [-14, -12, r.whole(-10, 9)][r.below(3) as usize];
        let (at, size, velocity) = ([r.whole(-2, 8), y], [r.whole(1, 3), 1], [r.whole(-1, 1), r.whole(-1, 3)]);
        b.add(at, size, Motion { step, ..moving(velocity[0], velocity[1]) });
    }
}

/// Boxes that are pressed or supported, and turn exactly at an edge or reach it with no speed to spare.
fn graze(b: &mut Lattice) {
    b.unit = if b.scene.is_dyadic { [1, 4] } else { [1, 5] };
    b.speed = [1, 2];
    let r = &mut b.random;
    let (speed, distance) = (r.whole(1, 4), r.pick(&[1, 2, 4]));
    // v²/2a is the distance to the turning point.
    let (v, metres) = (speed as f64 / 2.0, (distance * b.unit[0]) as f64 / b.unit[1] as f64);
    let strength = v * v / (2.0 * metres);
    let overlap = r.pick(&[distance, distance, distance, distance + 1]);
    if r.chance(50) {
        b.gravity(100, 0);
        b.add([0, 4], [4, 2], still().infinite());
        if b.random.chance(40) {
            b.add([-4, 4], [4, 2], still().infinite());
        }
        let slides = moving(speed, 0).heavy(1.0).pushed([-strength, 0.0]);
        b.add([4 - overlap, 0], [4, 4], slides);
        if b.random.chance(40) {
            let width = b.random.pick(&[2, 4]);
            b.add([4 - overlap, -2], [width, 2], slides);
        }
    } else {
        b.scene.gravity = [0.0, strength];
        b.add([0, 4], [2, 4], still().infinite());
        let (press, next) = (b.random.pick(&[0.0, 1.0, 1.0, 3.0]), b.random.pick(&[0.0, 1.0]));
        b.add([2, overlap], [2, 4], moving(0, -speed).heavy(1.0).pushed([-press, 0.0]));
        if b.random.chance(30) {
            let height = b.random.pick(&[2, 4]);
            b.add([4, overlap], [2, height], moving(0, -speed).heavy(1.0).pushed([-next, 0.0]));
        }
    }
    for _ in 0..b.random.whole(0, 3) {
        let r = &mut b.random;
        let (at, size) = ([r.whole(-6, 10), r.whole(-6, 10)], [r.whole(1, 3), r.whole(1, 3)]);
        let motion = if r.chance(40) { still().infinite() } else { still() };
        b.add(at, size, motion);
    }
}

/// A few boxes in a room, in general position at e = 1.
fn gas(b: &mut Lattice) {
    (b.unit, b.speed) = ([1, 1], [1, 1]);
    (b.scene.restitution, b.scene.pairs) = (1.0, Vec::new());
    for (at, size) in [([-1, -1], [10, 1]), ([-1, 6], [10, 1]), ([-1, 0], [1, 6]), ([8, 0], [1, 6])] {
        b.add(at, size, still().infinite());
    }
    let walls: Vec<_> = b.cells.iter().map(|cell| (cell.at.map(|n| n as f64), cell.size.map(|n| n as f64))).collect();
    walls.iter().zip(&mut b.cells).for_each(|((at, size), cell)| cell.exact = Some([*at, *size, [0.0; 2]]));
    if b.random.chance(50) {
        b.scene.gravity = [b.random.between(-2.0, 2.0), b.random.between(0.0, 9.0)];
    }
    for _ in 0..b.random.whole(2, 6) {
        let r = &mut b.random;
        let size = [r.between(0.3, 1.5), r.between(0.3, 1.5)];
        let at = [r.between(0.1, 7.9 - size[0]), r.between(0.1, 5.9 - size[1])];
        let exact = Some([at, size, [r.between(-3.0, 3.0), r.between(-3.0, 3.0)]]);
        let force = if r.chance(30) { [r.between(-3.0, 3.0), r.between(-3.0, 3.0)] } else { [0.0; 2] };
        let mass = r.pick(&[1.0, 1.0, 0.3, 5.0]);
        let overlaps = |other: &Cell| {
            let [corner, extent, _] = other.exact.expect("all boxes of a gas are in general position");
            (0..2).all(|k| at[k] < corner[k] + extent[k] && corner[k] < at[k] + size[k])
        };
        if !b.cells.iter().any(overlaps) {
            let cell = [0; 2];
            b.cells.push(Cell {
                at: cell,
                size: cell,
                mass,
                velocity: cell,
                force,
                step: 0,
                delete: None,
                nanometres: 0.0,
                material: "",
                exact,
            });
        }
    }
}
