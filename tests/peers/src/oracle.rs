//! The correct results of the scenes, in closed form and without any engine.

/// The kind of a scene, which determines its known results.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Oracle {
    /// A box falls 4 m onto a floor, e = 1.
    Bounce,
    /// A box between two walls, e = 1.
    BetweenWalls,
    /// A bullet rebounds from a plate of infinite mass.
    ShotAtFixed,
    /// A bullet rebounds from a plate of three times its mass, which then moves.
    ShotAtFree,
    /// Five equal boxes: the first hits the second, and finally only the last moves.
    Cradle {
        /// The gaps between the four boxes at rest, m.
        gap: f64,
    },
    /// Galperin's billiard: the collisions of a small box between a wall and a block count digits of π.
    Galperin {
        /// The number of digits after the first: the block has 100 to this power times the mass of the small box.
        digits: u32,
    },
    /// Nothing moves, e = 0.
    Rest,
    /// The energy is conserved, e = 1.
    Gas,
    /// The energy never increases, and finally nothing moves, e = 0.3.
    Fall,
    /// The energy never increases, but without friction some boxes keep sliding, e = 0.3.
    Slide,
    /// A row of touching boxes hits a wall.
    Row {
        /// The coefficient of restitution.
        restitution: f64,
    },
    /// A box slides at constant speed over flush tiles.
    Seams {
        /// The coefficient of restitution.
        restitution: f64,
    },
    /// Two boxes at rest are pressed together by forces at their corners, e = 0.
    Corners,
}

/// The state of a body: x and y, m; vx and vy, m/s.
pub type State = [f64; 4];

const GRAVITY: f64 = 9.81;

impl Oracle {
    /// The coefficient of restitution of every pair.
    pub fn restitution(self) -> f64 {
        match self {
            Oracle::Rest | Oracle::Corners => 0.0,
            Oracle::Row { restitution } | Oracle::Seams { restitution } => restitution,
            Oracle::Fall | Oracle::Slide => 0.3,
            Oracle::Bounce | Oracle::BetweenWalls | Oracle::ShotAtFixed | Oracle::ShotAtFree => 1.0,
            Oracle::Cradle { .. } | Oracle::Galperin { .. } | Oracle::Gas => 1.0,
        }
    }

    /// True if a body can move further in a step than its width and collides with moving bodies.
    pub fn is_fast(self) -> bool {
        match self {
            Oracle::ShotAtFixed | Oracle::ShotAtFree | Oracle::Cradle { .. } | Oracle::Galperin { .. } => true,
            Oracle::Bounce | Oracle::BetweenWalls | Oracle::Rest | Oracle::Gas | Oracle::Fall | Oracle::Slide => false,
            Oracle::Row { .. } | Oracle::Seams { .. } | Oracle::Corners => false,
        }
    }

    /// The states at `time` of the bodies of finite mass, in creation order, if they have a closed form;
    /// `start` are their initial states.
    pub fn states(self, time: f64, start: &[State]) -> Option<Vec<State>> {
        match self {
            Oracle::Bounce => Some(vec![bounce(time, start[0])]),
            Oracle::BetweenWalls => Some(vec![between_walls(time, start[0])]),
            Oracle::ShotAtFixed => Some(vec![impact(time, [start[0], [170.3, 0.0, 0.0, 0.0]], [-7000.0, 0.0])[0]]),
            Oracle::ShotAtFree => Some(impact(time, [start[0], start[1]], [-3500.0, 3500.0]).to_vec()),
            Oracle::Cradle { gap } => Some(cradle(time, start, gap)),
            Oracle::Rest => Some(start.to_vec()),
            Oracle::Row { restitution } => Some(row(time, start, restitution)),
            Oracle::Seams { .. } => Some(start.iter().map(|&[x, y, vx, _]| [x + vx * time, y, vx, 0.0]).collect()),
            Oracle::Corners => Some(corners(time, start)),
            Oracle::Galperin { .. } | Oracle::Gas | Oracle::Fall | Oracle::Slide => None,
        }
    }

    /// True if positions are compared at all samples, otherwise only at the last one, because the position in
    /// the step of an impact depends on the instant of the impact within the step.
    pub fn compares_all_samples(self) -> bool {
        match self {
            Oracle::Bounce | Oracle::BetweenWalls | Oracle::Rest | Oracle::Seams { .. } | Oracle::Corners => true,
            Oracle::Row { .. } => false,
            Oracle::ShotAtFixed | Oracle::ShotAtFree | Oracle::Cradle { .. } => false,
            Oracle::Galperin { .. } | Oracle::Gas | Oracle::Fall | Oracle::Slide => false,
        }
    }

    /// The correct number of collisions; for the billiard see G. Galperin, "Playing pool with π" (2003).
    pub fn collisions(self) -> Option<u64> {
        match self {
            Oracle::Galperin { digits } => Some((std::f64::consts::PI * 10_f64.powi(digits as i32)) as u64),
            Oracle::Cradle { .. } => Some(4),
            Oracle::ShotAtFixed | Oracle::ShotAtFree => Some(1),
            Oracle::Seams { .. } | Oracle::Corners => Some(0),
            Oracle::Row { restitution } => Some(burst(ROW, restitution).1),
            Oracle::Bounce | Oracle::BetweenWalls | Oracle::Rest | Oracle::Gas | Oracle::Fall | Oracle::Slide => None,
        }
    }

    /// The final velocities, m/s, if positions have no closed form.
    pub fn final_velocities(self) -> Option<Vec<f64>> {
        match self {
            Oracle::Galperin { digits } => Some(galperin(100_f64.powi(digits as i32)).to_vec()),
            Oracle::Bounce | Oracle::BetweenWalls | Oracle::ShotAtFixed | Oracle::ShotAtFree => None,
            Oracle::Cradle { .. } | Oracle::Rest | Oracle::Gas | Oracle::Fall | Oracle::Slide => None,
            Oracle::Row { .. } | Oracle::Seams { .. } | Oracle::Corners => None,
        }
    }
}

/// The number of boxes in the row that hits a wall.
pub const ROW: usize = 16;

/// The velocities of a row of boxes after it has hit a wall at 1 m/s, the nearest box first, and the number of impacts:
/// the lowest of the pairs that approach collides, until none does. With e = 0 this ends only in the limit, at rest.
fn burst(boxes: usize, restitution: f64) -> (Vec<f64>, u64) {
    let mut velocities = vec![if restitution > 0.0 { -1.0 } else { 0.0 }; boxes];
    let (mut pair, mut impacts) = (0, 0);
    while pair < boxes {
        let velocity = velocities[pair];
        match pair.checked_sub(1).map(|nearer| velocities[nearer]) {
            None if velocity < 0.0 => velocities[0] = -restitution * velocity,
            Some(nearer) if nearer > velocity => {
                let (mean, half) = ((nearer + velocity) / 2.0, restitution * (nearer - velocity) / 2.0);
                (velocities[pair - 1], velocities[pair]) = (mean - half, mean + half);
            }
            None | Some(_) => {
                pair += 1;
                continue;
            }
        }
        impacts += 1;
        pair = pair.saturating_sub(1);
    }
    (velocities, impacts)
}

/// The row reaches the wall after a second.
fn row(time: f64, start: &[State], restitution: f64) -> Vec<State> {
    let since = time - 1.0;
    let after = burst(start.len(), restitution).0;
    let state = |(&[x, y, vx, _], velocity): (&State, f64)| if since > 0.0 { [x - 1.0 + velocity * since, y, velocity, 0.0] } else { [x - time, y, vx, 0.0] };
    start.iter().zip(after).map(state).collect()
}

/// Each box yields on the axis on which they are pressed together less, x: until they have passed each other, both
/// accelerate at (6 + 3)/2 m/s² to the right, at 10 m/s² down and at 15 m/s² up.
fn corners(time: f64, start: &[State]) -> Vec<State> {
    // Their faces have passed each other after 2 m at 25 m/s². From then on the forces act on each box alone.
    let passed = (2.0_f64 * 2.0 / 25.0).sqrt();
    let alone = if time > passed { time - passed } else { 0.0 };
    let state = |(&[x, y, ..], [ax, ay]): (&State, [f64; 2])| {
        let (own, common) = (ax - 4.5, 4.5);
        [
            x + 0.5 * (common * time * time + own * alone * alone),
            y + 0.5 * ay * time * time,
            common * time + own * alone,
            ay * time,
        ]
    };
    start.iter().zip([[6.0, 10.0], [3.0, -15.0]]).map(state).collect()
}

/// Falls from rest in the time √(2h/g), then rises and falls in twice that time.
fn bounce(time: f64, [x, y, ..]: State) -> State {
    let height = 10.0 - 1.0 - y;
    let fall = (2.0 * height / GRAVITY).sqrt();
    let phase = time % (2.0 * fall);
    let since_top = if phase <= fall { phase } else { phase - 2.0 * fall };
    [x, y + 0.5 * GRAVITY * since_top * since_top, 0.0, GRAVITY * since_top]
}

/// Moves back and forth on the 9 m between the walls.
fn between_walls(time: f64, [x, y, vx, _]: State) -> State {
    let distance = (x - 1.0 + vx * time) % 18.0;
    if distance <= 9.0 { [1.0 + distance, y, vx, 0.0] } else { [1.0 + 18.0 - distance, y, -vx, 0.0] }
}

/// One impact of a bullet of 0.1 m; `after` are the velocities after it.
fn impact(time: f64, [bullet, plate]: [State; 2], after: [f64; 2]) -> [State; 2] {
    let instant = (plate[0] - 0.1 - bullet[0]) / bullet[2];
    if time <= instant {
        return [[bullet[0] + bullet[2] * time, bullet[1], bullet[2], 0.0], plate];
    }
    let x = plate[0] - 0.1 + after[0] * (time - instant);
    [[x, bullet[1], after[0], 0.0], [plate[0] + after[1] * (time - instant), plate[1], after[1], 0.0]]
}

/// Equal masses exchange their velocities: each stops at the face of the next one.
fn cradle(time: f64, start: &[State], gap: f64) -> Vec<State> {
    let speed = start[0][2];
    let last = start.len() - 1;
    let mut arrival = 0.0;
    let distance = |index: usize| if index == 0 { start[1][0] - start[0][0] - 1.0 } else { gap };
    start
        .iter()
        .enumerate()
        .map(|(index, &[x, y, ..])| {
            let departure = arrival;
            arrival += distance(index) / speed;
            match () {
                () if time < departure => [x, y, 0.0, 0.0],
                () if index == last || time < arrival => [x + speed * (time - departure), y, speed, 0.0],
                () => [x + distance(index), y, 0.0, 0.0],
            }
        })
        .collect()
}

/// The final velocities of the small box and of a block of that mass: conservation of momentum and energy,
/// applied as long as they approach.
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
    fn final_velocities_of_galperins_billiard_conserve_energy_and_separate_the_boxes() {
        for digits in 0..=4 {
            let mass = 100_f64.powi(digits);
            let [small, block] = galperin(mass);
            assert!(small >= 0.0 && block >= small, "{small} {block}");
            assert!((small * small / mass + block * block - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_row_separates_after_the_burst() {
        for (restitution, impacts) in [(0.99, 396), (1.0, 136), (0.0, 0)] {
            let (velocities, found) = burst(ROW, restitution);
            assert_eq!(found, impacts);
            assert!(velocities.is_sorted() && velocities[0] >= 0.0);
        }
    }

    #[test]
    fn a_bounce_returns_to_its_height_after_each_period() {
        let start = [4.0, 5.0, 0.0, 0.0];
        let period = 2.0 * (8.0 / GRAVITY).sqrt();
        assert!((bounce(10.0 * period, start)[1] - 5.0).abs() < 1e-12);
        assert!((bounce(10.5 * period, start)[1] - 9.0).abs() < 1e-12);
    }

    #[test]
    fn each_box_of_the_cradle_stops_at_the_face_of_the_next_one() {
        let start = [[0.0, 0.0, 2.0, 0.0], [3.0, 0.0, 0.0, 0.0], [4.5, 0.0, 0.0, 0.0]];
        let end = cradle(2.25, &start, 0.5);
        assert_eq!(end, [[2.0, 0.0, 0.0, 0.0], [3.5, 0.0, 0.0, 0.0], [6.5, 0.0, 2.0, 0.0]]);
    }
}
