use super::{
    Blueprint, Diagnostic, DiagnosticKind, SpawnRequest,
    action::{self, Request},
    diagnostic::{ErrorReported, Reporter},
    lifetimes::Effect,
    tree::{Key, Node, Table},
};
use crate::paint::Paint;
use crate::physics::{Rect, Vector, smaller};
use crate::recording::limits;
use std::ops::Range;

/// The `[[scatter]]` table of a scene: many bodies from the seed of a random number generator.
///
/// For each body in turn, the generator draws width, height, mass, vx and vy, each uniform over its
/// range, then x and y, uniform over the positions at which the body lies in the region. If it must
/// not overlap and does, x and y are drawn again. Only + − × ÷ are used, so that a seed gives the same
/// bodies on every machine.
pub struct Scatter {
    /// The number of bodies.
    pub count: u64,
    /// The location of the count.
    pub count_span: Range<usize>,
    seed: u64,
    region: Rect,
    /// The ranges of width and height.
    size: [[f64; 2]; 2],
    mass: [f64; 2],
    /// The ranges of vx and vy.
    velocity: [[f64; 2]; 2],
    overlap: bool,
    force: Vector,
    material: String,
    paint: Paint,
}

/// The number of random positions tried for a body before the scatter is refused.
const MAX_TRIES: u64 = 1000;

/// The largest number of scattered bodies in a scene.
pub const MAX_SCATTERED: u64 = limits::BODIES as u64;

const COUNT: Key = Key { name: "count", accepts: "a whole number of bodies from 1 to 1000000" };
const SEED: Key = Key { name: "seed", accepts: "a whole number, 0 or more" };
const REGION: Key = Key {
    name: "region",
    accepts: "x, y, width and height, m: four finite numbers, the last two positive and no smaller than the largest body",
};
const SIZE: Key = Key {
    name: "size",
    accepts: "[[width, height], [width, height]]: positive extents, m, the smallest, then the largest",
};
const MASS: Key = Key { name: "mass", accepts: "[from, to]: positive numbers of kg, the smallest, then the largest" };
const VELOCITY: Key =
    Key { name: "velocity", accepts: "[[vx, vy], [vx, vy]]: finite numbers, m/s, the lowest, then the highest" };
const OVERLAP: Key =
    Key { name: "overlap", accepts: "true or false; if true, bodies may overlap when they are spawned" };

/// The keys of `[[scatter]]`.
pub const KEYS: &[Key] = &[
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
    action::IMAGE,
];

/// Reads `[[scatter]]`.
pub fn read(table: &Table) -> Request<Scatter> {
    let count = table
        .require(COUNT)
        .and_then(|field| Ok((field.read(|node| node.count_in(1..=MAX_SCATTERED))?, field.node.span.clone())));
    let seed = table.optional(SEED, Node::count);
    let size = table.required(SIZE, |node| ordered(node, node.each(Node::size))).map(ranges);
    // If the largest body is not known, any positive region is accepted.
    let largest = size.map_or([f64::MIN_POSITIVE; 2], |size| size.map(|[_, largest]| largest));
    let region = table.required(REGION, |node| read_region(node, largest));
    let mass = table.required(MASS, mass_range);
    let velocity = table.optional(VELOCITY, velocity_ranges);
    let overlap = table.optional(OVERLAP, Node::boolean);
    let lightest = mass.map_or(f64::INFINITY, |[from, _]| from);
    let force = action::read_force(table, lightest);
    let material = table.optional(action::MATERIAL, action::material);
    let color = table.optional(action::COLOR, action::color);
    let image = table.optional(action::IMAGE, action::image);
    let effect = Effect::Scatter {
        count: count.as_ref().ok().map(|(count, _)| *count),
        is_infinite: mass.is_ok_and(|[from, _]| from == f64::INFINITY),
    };
    let scatter = || {
        let (count, count_span) = count?;
        Ok(Scatter {
            count,
            count_span,
            seed: seed?.unwrap_or(0),
            region: region?,
            size: size?,
            mass: mass?,
            velocity: velocity?.unwrap_or_default(),
            overlap: overlap?.unwrap_or(false),
            force: force?,
            material: material?.unwrap_or_default().into(),
            paint: Paint::new(color?, image?),
        })
    };
    Request { step: action::read_step(table), event: scatter(), effect, span: table.span.clone() }
}

impl Scatter {
    /// Creates the bodies, which overlap neither each other nor `others` unless overlap is allowed.
    pub fn expand<'a>(
        &self,
        others: impl Iterator<Item = &'a Rect>,
        reporter: &Reporter,
    ) -> Result<Vec<SpawnRequest>, ErrorReported> {
        let mut random = Random::new(self.seed);
        let mut occupied = OccupancyGrid::new(self.region, self.size.map(|[_, largest]| largest), self.count);
        if !self.overlap {
            others.for_each(|rect| occupied.insert(*rect));
        }
        let mut requests = Vec::new();
        for fitted in 0..self.count {
            let blueprint = self.draw_blueprint(&mut random);
            let Some(origin) = self.find_position(blueprint.size, &occupied, &mut random) else {
                let kind = DiagnosticKind::NoRoom { fitted, count: self.count, tries: MAX_TRIES };
                return Err(reporter.report(Diagnostic::new(kind, self.count_span.clone())));
            };
            let request = blueprint.placed_at(origin);
            if !self.overlap {
                occupied.insert(request.rect());
            }
            requests.push(request);
        }
        Ok(requests)
    }

    /// Draws all properties of the next body except its position.
    fn draw_blueprint(&self, random: &mut Random) -> Blueprint {
        let size = self.size.map(|range| random.between(range));
        let mass = random.between(self.mass);
        let [vx, vy] = self.velocity.map(|range| random.between(range));
        Blueprint {
            name: None,
            size,
            mass,
            velocity: action::canonical_velocity(mass, Vector::new(vx, vy)),
            force: self.force,
            material: self.material.clone(),
            paint: self.paint.clone(),
        }
    }

    /// Draws a position for the body in the region at which it overlaps no occupied rectangle.
    fn find_position(
        &self,
        [width, height]: [f64; 2],
        occupied: &OccupancyGrid,
        random: &mut Random,
    ) -> Option<Vector> {
        let (near, far) = (self.region.origin, self.region.far_corner());
        let slack = [self.region.width() - width, self.region.height() - height];
        (0..MAX_TRIES).find_map(|_| {
            let x = near.x + slack[0] * random.fraction();
            let y = near.y + slack[1] * random.fraction();
            let rect = Rect::new(Vector::new(x, y), width, height);
            // Rounding can move a body past the border of a tight region by one ulp.
            let is_inside = rect.far_corner().x <= far.x && rect.far_corner().y <= far.y;
            (is_inside && (self.overlap || occupied.is_free(&rect))).then_some(rect.origin)
        })
    }
}

/// Reads a region that can hold a body of the given width and height.
fn read_region(node: &Node, largest: [f64; 2]) -> Result<Rect, &Node> {
    let [x, y, width, height] = node.each(Node::number)?;
    let region = Rect::new(Vector::new(x, y), width, height);
    let is_accepted = width >= largest[0] && height >= largest[1] && region.far_corner().is_finite();
    if is_accepted { Ok(region) } else { Err(node) }
}

fn mass_range(node: &Node) -> Result<[f64; 2], &Node> {
    let [from, to] = node.each(Node::mass)?;
    // There is no uniform distribution between a finite and an infinite mass.
    if from == to || (from < to && to.is_finite()) { Ok([from, to]) } else { Err(node) }
}

fn velocity_ranges(node: &Node) -> Result<[[f64; 2]; 2], &Node> {
    ordered(node, node.each(|node| node.each(Node::number))).map(ranges)
}

/// Returns an error unless each range is ascending and of finite length.
fn ordered<'a>(node: &'a Node, corners: Result<[[f64; 2]; 2], &'a Node>) -> Result<[[f64; 2]; 2], &'a Node> {
    let [from, to] = corners?;
    let is_ascending = (0..2).all(|axis| from[axis] <= to[axis] && (to[axis] - from[axis]).is_finite());
    if is_ascending { Ok([from, to]) } else { Err(node) }
}

/// The range of each axis, from the lowest and the highest corner.
fn ranges([from, to]: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    [[from[0], to[0]], [from[1], to[1]]]
}

/// A pseudorandom number generator, `SplitMix64`, with the same output on every machine.
///
/// The state advances by the odd constant 0x9e3779b97f4a7c15; each output is the state mixed by
/// two shift-multiply rounds. From G. L. Steele, D. Lea and C. H. Flood, "Fast splittable
/// pseudorandom number generators", OOPSLA 2014, in S. Vigna's public-domain version.
#[derive(Clone, Debug)]
pub struct Random {
    state: u64,
}

impl Random {
    /// A generator with the initial state `seed`.
    pub fn new(seed: u64) -> Random {
        Random { state: seed }
    }

    /// Returns the next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns the next u with 0 ≤ u < 1: the upper 53 of the next 64 bits divided by 2⁵³, which is exact.
    pub fn fraction(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Returns the next number of a range, from + (to − from)·u, clamped to `to` because rounding may exceed it.
    ///
    /// A range of one number, which may be infinite, returns that number and also consumes one u.
    pub fn between(&mut self, [from, to]: [f64; 2]) -> f64 {
        let u = self.fraction();
        if from == to {
            return from;
        }
        let number = from + (to - from) * u;
        smaller(to, number)
    }
}

/// The rectangles in a region, in a uniform grid: each cell lists the rectangles that intersect it.
struct OccupancyGrid {
    region: Rect,
    columns: usize,
    rows: usize,
    /// The rectangles of each cell, in row-major order.
    cells: Vec<Vec<Rect>>,
    /// The rectangles that intersect more than [`MAX_CELLS`] cells.
    oversized: Vec<Rect>,
}

/// A rectangle that intersects more cells is kept in one list and tested directly.
const MAX_CELLS: usize = 64;

impl OccupancyGrid {
    /// An empty grid for about `count` rectangles up to the given extents, m.
    ///
    /// A cell is no smaller than the largest rectangle, and there are not many more cells than rectangles.
    fn new(region: Rect, [width, height]: [f64; 2], count: u64) -> OccupancyGrid {
        let max_cells = count.isqrt() as usize + 1;
        let columns = ((region.width() / width) as usize).clamp(1, max_cells);
        let rows = ((region.height() / height) as usize).clamp(1, max_cells);
        OccupancyGrid { region, columns, rows, cells: vec![Vec::new(); columns * rows], oversized: Vec::new() }
    }

    /// Adds a rectangle, which may overlap others.
    fn insert(&mut self, rect: Rect) {
        let cells: Vec<usize> = self.cells_of(&rect).take(MAX_CELLS + 1).collect();
        if cells.len() > MAX_CELLS {
            self.oversized.push(rect);
            return;
        }
        for cell in cells {
            self.cells[cell].push(rect);
        }
    }

    /// Returns true if the rectangle overlaps none in the grid; touching is not overlapping.
    fn is_free(&self, rect: &Rect) -> bool {
        let candidates = self.cells_of(rect).flat_map(|cell| &self.cells[cell]);
        !candidates.chain(&self.oversized).any(|other| rect.overlaps(other))
    }

    /// The cells that a rectangle intersects. Positions outside the region belong to the nearest border
    /// cells, so that overlapping rectangles always share a cell.
    fn cells_of(&self, rect: &Rect) -> impl Iterator<Item = usize> + use<> {
        let (near, far) = (rect.origin, rect.far_corner());
        let column = |x: f64| cell(x - self.region.origin.x, self.region.width(), self.columns);
        let row = |y: f64| cell(y - self.region.origin.y, self.region.height(), self.rows);
        let (columns, stride) = (column(near.x)..=column(far.x), self.columns);
        (row(near.y)..=row(far.y)).flat_map(move |row| columns.clone().map(move |column| row * stride + column))
    }
}

/// The index of the cell that contains the offset, among `count` cells along an extent; monotone in the offset.
fn cell(offset: f64, extent: f64, count: usize) -> usize {
    // The cast saturates: negative offsets give 0.
    ((offset / (extent / count as f64)) as usize).min(count - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::tree::{Value, parse_toml};
    use proptest::prelude::*;

    fn scatter(keys: &str) -> Scatter {
        let root = parse_toml(&format!("[[scatter]]\n{keys}")).unwrap();
        let Value::Table(entries) = &root.value else { panic!("a document is a table") };
        let reporter = Reporter::default();
        let table = Table::open("scatter", &entries[0].node.nodes().unwrap()[0], KEYS, &reporter).unwrap();
        read(&table).event.unwrap()
    }

    fn bodies<'a>(scatter: &Scatter, others: impl Iterator<Item = &'a Rect>) -> Vec<SpawnRequest> {
        scatter.expand(others, &Reporter::default()).unwrap()
    }

    fn sparse(seed: u64, count: u64) -> Scatter {
        scatter(&format!(
            "count = {count}\nseed = {seed}\nregion = [0.5, -2.5, 15.0, 4.0]\nsize = [[0.1, 0.1], [0.3, 0.4]]\n\
             mass = [1.0, 3.0]\nvelocity = [[-1.0, 0.0], [1.0, 0.0]]"
        ))
    }

    proptest! {
        #[test]
        fn scattered_bodies_lie_in_the_region_and_overlap_nothing(seed: u64, count in 1_u64..150) {
            let wall = Rect::new(Vector::new(4.0, -10.0), 1.0, 100.0);
            let scatter = sparse(seed >> 1, count);
            let rects: Vec<Rect> = bodies(&scatter, [&wall].into_iter()).iter().map(SpawnRequest::rect).collect();
            prop_assert_eq!(rects.len() as u64, count);
            for (index, rect) in rects.iter().enumerate() {
                let far = rect.far_corner();
                prop_assert!(0.5 <= rect.origin.x && far.x <= 15.5 && -2.5 <= rect.origin.y && far.y <= 1.5);
                prop_assert!((0.1..=0.3).contains(&rect.width()) && (0.1..=0.4).contains(&rect.height()));
                prop_assert!(!rect.overlaps(&wall));
                prop_assert!(!rects[..index].iter().any(|other| rect.overlaps(other)));
            }
        }

        #[test]
        fn a_seed_always_gives_the_same_bodies(seed: u64) {
            let seed = seed >> 1;
            let scattered = |seed| bodies(&sparse(seed, 5), [].iter());
            prop_assert_eq!(scattered(seed), scattered(seed));
            prop_assert_ne!(scattered(seed), scattered(seed + 1));
        }
    }

    /// The expected numbers were computed with the same formulas in Python.
    #[test]
    fn seed_7_gives_the_expected_body() {
        let [body] = bodies(&sparse(7, 1), [].iter()).try_into().unwrap();
        let numbers =
            [body.origin.x, body.origin.y, body.blueprint.size[0], body.blueprint.size[1], body.blueprint.mass];
        let expected =
            [4.1970825164984085, -0.6773401233888623, 0.1779659496782543, 0.10503648835844684, 2.8015213612137666];
        assert_eq!(numbers, expected);
    }

    #[test]
    fn a_region_of_the_size_of_the_body_is_filled() {
        let scatter =
            scatter("count = 1\nregion = [0.1, 0.2, 1.0, 1.0]\nsize = [[1.0, 1.0], [1.0, 1.0]]\nmass = [inf, inf]");
        let [body] = bodies(&scatter, [].iter()).try_into().unwrap();
        assert_eq!((body.origin, body.blueprint.mass), (Vector::new(0.1, 0.2), f64::INFINITY));
    }

    #[test]
    fn the_output_is_the_published_test_vector() {
        let mut random = Random::new(1_234_567);
        let expected = [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423];
        assert_eq!([random.bits(), random.bits(), random.bits()], expected);
    }

    #[test]
    fn fractions_are_below_one_and_numbers_stay_within_their_range() {
        let mut random = Random::new(7);
        for _ in 0..10_000 {
            let u = random.fraction();
            assert!((0.0..1.0).contains(&u));
            assert!((0.1..=0.3).contains(&random.between([0.1, 0.3])));
        }
        assert_eq!(random.between([f64::INFINITY; 2]), f64::INFINITY);
    }

    use crate::physics::Vector;

    fn rect(x: f64, y: f64, width: f64, height: f64) -> Rect {
        Rect::new(Vector::new(x, y), width, height)
    }

    #[test]
    fn touching_is_free_and_overlapping_is_not() {
        let mut grid = OccupancyGrid::new(rect(0.0, 0.0, 16.0, 9.0), [1.0, 1.0], 100);
        grid.insert(rect(4.0, 4.0, 1.0, 1.0));
        assert!(grid.is_free(&rect(5.0, 4.0, 1.0, 1.0)), "side by side");
        assert!(grid.is_free(&rect(5.0, 5.0, 1.0, 1.0)), "corner to corner");
        assert!(!grid.is_free(&rect(4.9, 4.9, 1.0, 1.0)));
    }

    #[test]
    fn a_wall_along_the_border_is_found_along_all_of_it() {
        let mut grid = OccupancyGrid::new(rect(0.0, 0.0, 1000.0, 1000.0), [0.1, 0.1], 1_000_000);
        grid.insert(rect(-1.0, -1.0, 1002.0, 1.05));
        assert!(!grid.is_free(&rect(700.0, 0.0, 0.1, 0.1)));
        assert!(grid.is_free(&rect(700.0, 0.06, 0.1, 0.1)));
    }
}
