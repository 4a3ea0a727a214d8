use std::ops::Range;

use super::{
    Fault, SpawnRequest, action,
    random::Random,
    refusal::Refusal,
    room::Room,
    tree::{Field, Key, Node, Table},
};
use crate::physics::{Rect, Vector};

/// Many bodies from a seed: the scene's `[[scatter]]`.
///
/// Body for body, the stream of the seed gives width, height, mass, vx and vy, each
/// uniform over its range, then x and y, uniform over the places where the body lies in the
/// region. If it must not overlap and does, x and y are drawn again. Only + − × ÷ are used,
/// so that a seed means the same bodies on every machine.
pub struct Scatter {
    /// The step it names and where.
    pub step: Option<(u64, Range<usize>)>,
    /// How many bodies.
    pub count: u64,
    /// Where the count stands.
    pub count_span: Range<usize>,
    /// Where its table stands.
    pub place: Range<usize>,
    seed: u64,
    region: Rect,
    /// Of width and of height, from and to.
    size: [[f64; 2]; 2],
    mass: [f64; 2],
    /// Of vx and of vy, from and to.
    velocity: [[f64; 2]; 2],
    overlap: bool,
    force: Vector,
    material: String,
    color: Option<String>,
}

/// How often a place for a body is drawn before there is held to be no room.
const TRIES: u64 = 1000;

/// The most bodies one scene may scatter.
pub const MOST_SCATTERED: u64 = 1_000_000;

const COUNT: Key = Key { name: "count", accepts: "how many bodies: a whole number from 1 to 1000000" };
const SEED: Key = Key { name: "seed", accepts: "a whole number, 0 or more" };
const REGION: Key = Key {
    name: "region",
    accepts: "x, y, width and height, m: four finite numbers, the last two positive and large enough for the largest body",
};
const SIZE: Key =
    Key { name: "size", accepts: "[[w, h], [w, h]]: positive extents, m, the smallest, then the largest" };
const MASS: Key = Key { name: "mass", accepts: "[from, to]: positive numbers of kg, the smallest, then the largest" };
const VELOCITY: Key =
    Key { name: "velocity", accepts: "[[vx, vy], [vx, vy]]: finite numbers, m/s, the lowest, then the highest" };
const OVERLAP: Key = Key { name: "overlap", accepts: "true or false: whether bodies may be spawned inside each other" };

impl Scatter {
    /// The keys of `[[scatter]]`.
    pub fn read(node: &Node) -> Result<Scatter, Refusal> {
        let keys = [
            action::STEP,
            COUNT,
            SEED,
            REGION,
            SIZE,
            MASS,
            VELOCITY,
            OVERLAP,
            action::FORCE,
            action::MATERIAL,
            action::COLOR,
        ];
        let table = Table::open("scatter", node, &keys)?;
        let count = table.require(COUNT)?;
        let size = ranges(table.required(SIZE, |node| ordered(node, node.each(Node::size)))?);
        let region = table.require(REGION)?;
        Ok(Scatter {
            step: action::read_step(&table)?,
            count: count.read(|node| node.count_in(1..=MOST_SCATTERED))?,
            count_span: count.node.span.clone(),
            place: table.span.clone(),
            seed: table.optional(SEED, Node::count)?.unwrap_or(0),
            region: read_region(&region, size)?,
            size,
            mass: table.required(MASS, mass_range)?,
            velocity: table.optional(VELOCITY, velocity_ranges)?.unwrap_or_default(),
            overlap: table.optional(OVERLAP, Node::boolean)?.unwrap_or(false),
            force: table.optional(action::FORCE, Node::vector)?.unwrap_or_default(),
            material: table.optional(action::MATERIAL, action::material)?.unwrap_or_default().into(),
            color: table.optional(action::COLOR, action::color)?.map(String::from),
        })
    }

    /// The bodies, clear of each other and of `others` unless they may overlap.
    pub fn expand<'a>(&self, others: impl Iterator<Item = &'a Rect>) -> Result<Vec<SpawnRequest>, Refusal> {
        let mut random = Random::new(self.seed);
        let mut room = Room::new(self.region, self.size.map(|[_, largest]| largest), self.count);
        if !self.overlap {
            others.for_each(|rect| room.insert(*rect));
        }
        let mut requests = Vec::new();
        for fitted in 0..self.count {
            let mut request = self.body(&mut random);
            let Some(origin) = self.find_place(&request.rect, &room, &mut random) else {
                let fault = Fault::NoRoom { fitted, count: self.count, tries: TRIES };
                return Err(Refusal::new(fault, self.count_span.clone()));
            };
            request.rect.origin = origin;
            if !self.overlap {
                room.insert(request.rect);
            }
            requests.push(request);
        }
        Ok(requests)
    }

    /// The next body, all but its place.
    fn body(&self, random: &mut Random) -> SpawnRequest {
        let [width, height] = self.size.map(|range| random.between(range));
        let mass = random.between(self.mass);
        let [vx, vy] = self.velocity.map(|range| random.between(range));
        SpawnRequest {
            name: None,
            rect: Rect::new(self.region.origin, width, height),
            mass,
            velocity: action::canonical_velocity(mass, Vector::new(vx, vy)),
            force: self.force,
            material: self.material.clone(),
            color: self.color.clone(),
        }
    }

    /// A place for the body in the region, clear of what is in the room.
    fn find_place(&self, body: &Rect, room: &Room, random: &mut Random) -> Option<Vector> {
        let (near, far) = (self.region.origin, self.region.far_corner());
        let slack = [self.region.width() - body.width(), self.region.height() - body.height()];
        (0..TRIES).find_map(|_| {
            let x = near.x + slack[0] * random.fraction();
            let y = near.y + slack[1] * random.fraction();
            let rect = Rect::new(Vector::new(x, y), body.width(), body.height());
            // Rounding may carry a body in a tight region past the border by an ulp.
            let inside = rect.far_corner().x <= far.x && rect.far_corner().y <= far.y;
            (inside && (self.overlap || room.is_free(&rect))).then_some(rect.origin)
        })
    }
}

/// The region, which has to hold the largest body.
fn read_region(field: &Field, size: [[f64; 2]; 2]) -> Result<Rect, Refusal> {
    field.read(|node| {
        let [x, y, width, height] = node.each(Node::number)?;
        let region = Rect::new(Vector::new(x, y), width, height);
        let holds = width >= size[0][1] && height >= size[1][1] && region.far_corner().is_finite();
        if holds { Ok(region) } else { Err(node) }
    })
}

fn mass_range(node: &Node) -> Result<[f64; 2], &Node> {
    let [from, to] = node.each(Node::mass)?;
    // Between a finite and an infinite mass nothing is uniform.
    if from == to || (from < to && to.is_finite()) { Ok([from, to]) } else { Err(node) }
}

fn velocity_ranges(node: &Node) -> Result<[[f64; 2]; 2], &Node> {
    ordered(node, node.each(|node| node.each(Node::number))).map(ranges)
}

/// Refuses the node unless each range goes upwards over a finite distance.
fn ordered<'a>(node: &'a Node, corners: Result<[[f64; 2]; 2], &'a Node>) -> Result<[[f64; 2]; 2], &'a Node> {
    let [from, to] = corners?;
    let upwards = (0..2).all(|axis| from[axis] <= to[axis] && (to[axis] - from[axis]).is_finite());
    if upwards { Ok([from, to]) } else { Err(node) }
}

/// From and to of each axis, out of one corner and the other.
fn ranges([from, to]: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    [[from[0], to[0]], [from[1], to[1]]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{room::overlap, tree::Value, tree::parse_toml};
    use proptest::prelude::*;

    fn scatter(keys: &str) -> Scatter {
        let root = parse_toml(&format!("[[scatter]]\n{keys}")).unwrap();
        let Value::Table(entries) = &root.value else { panic!("a document is a table") };
        Scatter::read(&entries[0].node.nodes().unwrap()[0]).unwrap()
    }

    fn sparse(seed: u64, count: u64) -> Scatter {
        scatter(&format!(
            "count = {count}\nseed = {seed}\nregion = [0.5, -2.5, 15.0, 4.0]\nsize = [[0.1, 0.1], [0.3, 0.4]]\n\
             mass = [1.0, 3.0]\nvelocity = [[-1.0, 0.0], [1.0, 0.0]]"
        ))
    }

    proptest! {
        #[test]
        fn boxes_lie_in_the_region_clear_of_each_other_and_of_what_was_there(seed: u64, count in 1_u64..150) {
            let wall = Rect::new(Vector::new(4.0, -10.0), 1.0, 100.0);
            let scatter = sparse(seed >> 1, count);
            let rects: Vec<Rect> = scatter.expand([&wall].into_iter()).unwrap().iter().map(|body| body.rect).collect();
            prop_assert_eq!(rects.len() as u64, count);
            for (place, rect) in rects.iter().enumerate() {
                let far = rect.far_corner();
                prop_assert!(0.5 <= rect.origin.x && far.x <= 15.5 && -2.5 <= rect.origin.y && far.y <= 1.5);
                prop_assert!((0.1..=0.3).contains(&rect.width()) && (0.1..=0.4).contains(&rect.height()));
                prop_assert!(!overlap(rect, &wall));
                prop_assert!(!rects[..place].iter().any(|other| overlap(rect, other)));
            }
        }

        #[test]
        fn a_seed_means_the_same_boxes(seed: u64) {
            let seed = seed >> 1;
            let boxes = |seed| sparse(seed, 5).expand([].iter()).unwrap();
            prop_assert_eq!(boxes(seed), boxes(seed));
            prop_assert_ne!(boxes(seed), boxes(seed + 1));
        }
    }

    /// These very bits on every machine: the numbers are those of the same formulas in Python.
    #[test]
    fn seed_7_means_these_boxes() {
        let [body] = sparse(7, 1).expand([].iter()).unwrap().try_into().unwrap();
        let numbers = [body.rect.origin.x, body.rect.origin.y, body.rect.width(), body.rect.height(), body.mass];
        let expected =
            [4.1970825164984085, -0.6773401233888623, 0.1779659496782543, 0.10503648835844684, 2.8015213612137666];
        assert_eq!(numbers, expected);
    }

    #[test]
    fn a_region_that_just_fits_is_filled() {
        let scatter =
            scatter("count = 1\nregion = [0.1, 0.2, 1.0, 1.0]\nsize = [[1.0, 1.0], [1.0, 1.0]]\nmass = [inf, inf]");
        let [body] = scatter.expand([].iter()).unwrap().try_into().unwrap();
        assert_eq!((body.rect.origin, body.mass), (Vector::new(0.1, 0.2), f64::INFINITY));
    }
}
