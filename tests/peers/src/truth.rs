//! What mechanics says comes of a scene, in closed form and without any engine.

/// What is known of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Truth {
    /// A box falls 4 m on a floor, e = 1.
    Bounce,
    /// A box between two walls, e = 1.
    BetweenWalls,
    /// A bullet comes back from a plate that nothing moves.
    ShotAtFixed,
    /// A bullet comes back from a plate of three times its mass, which moves off.
    ShotAtFree,
    /// Five boxes of which the first hits the second, and the last moves off.
    Cradle {
        /// Between the four that rest, m.
        gap: f64,
    },
    /// A block and a wall with a small box between them count the digits of π.
    Galperin {
        /// After the first; the block has 100 to this power times the mass of the small box.
        digits: u32,
    },
    /// Nothing moves, e = 0.
    Rest,
    /// Energy is kept, e = 1.
    Gas,
    /// Energy never rises, and in the end nothing moves, e = 0.3.
    Fall,
    /// Energy never rises, but since nothing rubs some go on sliding, e = 0.3.
    Slide,
}

/// What a body has to be like: x and y in m, vx and vy in m/s.
pub type State = [f64; 4];

const GRAVITY: f64 = 9.81;

impl Truth {
    /// Of every pair.
    pub fn restitution(self) -> f64 {
        match self {
            Truth::Rest => 0.0,
            Truth::Fall | Truth::Slide => 0.3,
            Truth::Bounce | Truth::BetweenWalls | Truth::ShotAtFixed | Truth::ShotAtFree => 1.0,
            Truth::Cradle { .. } | Truth::Galperin { .. } | Truth::Gas => 1.0,
        }
    }

    /// Whether something may go further in a step than it is wide, and meets what moves.
    pub fn is_fast(self) -> bool {
        match self {
            Truth::ShotAtFixed | Truth::ShotAtFree | Truth::Cradle { .. } | Truth::Galperin { .. } => true,
            Truth::Bounce | Truth::BetweenWalls | Truth::Rest | Truth::Gas | Truth::Fall | Truth::Slide => false,
        }
    }

    /// The state at `time` of the bodies that can move, in creation order, where it has a closed
    /// form; `start` is how they began.
    pub fn states(self, time: f64, start: &[State]) -> Option<Vec<State>> {
        match self {
            Truth::Bounce => Some(vec![bounce(time, start[0])]),
            Truth::BetweenWalls => Some(vec![between_walls(time, start[0])]),
            Truth::ShotAtFixed => Some(vec![impact(time, [start[0], [170.3, 0.0, 0.0, 0.0]], [-7000.0, 0.0])[0]]),
            Truth::ShotAtFree => Some(impact(time, [start[0], start[1]], [-3500.0, 3500.0]).to_vec()),
            Truth::Cradle { gap } => Some(cradle(time, start, gap)),
            Truth::Rest => Some(start.to_vec()),
            Truth::Galperin { .. } | Truth::Gas | Truth::Fall | Truth::Slide => None,
        }
    }

    /// Whether positions are compared at all samples; else at the end, since a position in the
    /// step of the hit depends on when in the step it is.
    pub fn always(self) -> bool {
        match self {
            Truth::Bounce | Truth::BetweenWalls | Truth::Rest => true,
            Truth::ShotAtFixed | Truth::ShotAtFree | Truth::Cradle { .. } => false,
            Truth::Galperin { .. } | Truth::Gas | Truth::Fall | Truth::Slide => false,
        }
    }

    /// How many collisions there are: the digits of π, by G. Galperin, "Playing pool with π" (2003).
    pub fn collisions(self) -> Option<u64> {
        match self {
            Truth::Galperin { digits } => Some((std::f64::consts::PI * 10_f64.powi(digits as i32)) as u64),
            Truth::Cradle { .. } => Some(4),
            Truth::ShotAtFixed | Truth::ShotAtFree => Some(1),
            Truth::Bounce | Truth::BetweenWalls | Truth::Rest | Truth::Gas | Truth::Fall | Truth::Slide => None,
        }
    }

    /// The velocities after the last collision, m/s, where positions are not known.
    pub fn last_velocities(self) -> Option<Vec<f64>> {
        match self {
            Truth::Galperin { digits } => Some(galperin(100_f64.powi(digits as i32)).to_vec()),
            Truth::Bounce | Truth::BetweenWalls | Truth::ShotAtFixed | Truth::ShotAtFree => None,
            Truth::Cradle { .. } | Truth::Rest | Truth::Gas | Truth::Fall | Truth::Slide => None,
        }
    }
}

/// Falls from rest, up and down again in twice the time √(2h/g).
fn bounce(time: f64, [x, y, ..]: State) -> State {
    let height = 10.0 - 1.0 - y;
    let fall = (2.0 * height / GRAVITY).sqrt();
    let phase = time % (2.0 * fall);
    let since_top = if phase <= fall { phase } else { phase - 2.0 * fall };
    [x, y + 0.5 * GRAVITY * since_top * since_top, 0.0, GRAVITY * since_top]
}

/// To and fro on the 9 m between the walls.
fn between_walls(time: f64, [x, y, vx, _]: State) -> State {
    let way = (x - 1.0 + vx * time) % 18.0;
    if way <= 9.0 { [1.0 + way, y, vx, 0.0] } else { [1.0 + 18.0 - way, y, -vx, 0.0] }
}

/// One hit of a bullet of 0.1 m, and the velocities after it.
fn impact(time: f64, [bullet, plate]: [State; 2], after: [f64; 2]) -> [State; 2] {
    let hit = (plate[0] - 0.1 - bullet[0]) / bullet[2];
    if time <= hit {
        return [[bullet[0] + bullet[2] * time, bullet[1], bullet[2], 0.0], plate];
    }
    let x = plate[0] - 0.1 + after[0] * (time - hit);
    [[x, bullet[1], after[0], 0.0], [plate[0] + after[1] * (time - hit), plate[1], after[1], 0.0]]
}

/// Equal masses hand the velocity on: each stops where the next one was.
fn cradle(time: f64, start: &[State], gap: f64) -> Vec<State> {
    let speed = start[0][2];
    let last = start.len() - 1;
    let mut arrival = 0.0;
    let way = |place: usize| if place == 0 { start[1][0] - start[0][0] - 1.0 } else { gap };
    start
        .iter()
        .enumerate()
        .map(|(place, &[x, y, ..])| {
            let from = arrival;
            arrival += way(place) / speed;
            match () {
                () if time < from => [x, y, 0.0, 0.0],
                () if place == last || time < arrival => [x + speed * (time - from), y, speed, 0.0],
                () => [x + way(place), y, 0.0, 0.0],
            }
        })
        .collect()
}

/// Velocities of the small box and of a block of that mass when they meet no more: the laws of
/// momentum and energy, applied as often as they approach.
fn galperin(mass: f64) -> [f64; 2] {
    let [mut small, mut block] = [0.0, -1.0];
    loop {
        if block < small {
            let common = 2.0 * (mass * block + small) / (mass + 1.0);
            [small, block] = [common - small, common - block];
        } else if small < 0.0 {
            small = -small;
        } else {
            return [small, block];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn galperins_last_velocities_keep_energy_and_part_the_boxes() {
        for digits in 0..=4 {
            let mass = 100_f64.powi(digits);
            let [small, block] = galperin(mass);
            assert!(small >= 0.0 && block >= small, "{small} {block}");
            assert!((small * small / mass + block * block - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn the_bounce_is_at_its_height_again_after_a_whole_period() {
        let start = [4.0, 5.0, 0.0, 0.0];
        let period = 2.0 * (8.0 / GRAVITY).sqrt();
        assert!((bounce(10.0 * period, start)[1] - 5.0).abs() < 1e-12);
        assert!((bounce(10.5 * period, start)[1] - 9.0).abs() < 1e-12);
    }

    #[test]
    fn the_cradle_ends_with_each_box_where_the_next_one_was() {
        let start = [[0.0, 0.0, 2.0, 0.0], [3.0, 0.0, 0.0, 0.0], [4.5, 0.0, 0.0, 0.0]];
        let end = cradle(2.25, &start, 0.5);
        assert_eq!(end, [[2.0, 0.0, 0.0, 0.0], [3.5, 0.0, 0.0, 0.0], [6.5, 0.0, 2.0, 0.0]]);
    }
}
