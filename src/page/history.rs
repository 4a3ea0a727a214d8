use rebond::internals::picture::EnergySample;
use rebond::internals::replay::RunSnapshot;
use rebond::{BodyId, Collision, Vector};
use std::collections::BTreeMap;

/// The collisions that the table shows.
pub const MAX_RECENT: usize = 200;

/// A collision in the table.
#[derive(Clone, Debug)]
pub struct Row {
    /// The step in which it happened.
    pub step: u64,
    /// The seconds since step 0.
    pub instant: f64,
    /// The bodies c and b.
    pub bodies: [BodyId; 2],
    /// The normal on c.
    pub normal: Vector,
    /// The coefficient of restitution.
    pub e: f64,
    /// The normal velocity before and after, m/s.
    pub vn: [f64; 2],
    /// The impulse, N·s.
    pub impulse: f64,
}

impl Row {
    /// The row of a collision.
    pub fn of(collision: &Collision) -> Row {
        let Collision { step, instant, bodies, normal, restitution: e, normal_velocity: vn, impulse, .. } = *collision;
        Row { step, instant, bodies, normal, e, vn, impulse }
    }
}

/// Drops all but the last `count` rows.
pub fn keep_last(rows: &mut Vec<Row>, count: usize) {
    rows.drain(..rows.len().saturating_sub(count));
}

/// A snapshot and the last collisions since the one before it.
#[derive(Debug)]
struct Kept {
    snapshot: RunSnapshot,
    rows: Vec<Row>,
}

impl Kept {
    fn bytes(&self) -> usize {
        self.snapshot.bytes() + self.rows.len() * size_of::<Row>()
    }
}

/// Snapshots of a run under a budget of bytes. When they exceed it, every other one is dropped, so that the distance
/// between them, and with it the time to go back, grows with the length of the session.
#[derive(Debug)]
pub struct History {
    snapshots: BTreeMap<u64, Kept>,
    bytes: usize,
    budget: usize,
    /// Steps from one snapshot to the next.
    stride: u64,
}

impl History {
    /// A history of at most `budget` bytes.
    pub fn new(budget: usize) -> History {
        History { snapshots: BTreeMap::new(), bytes: 0, budget, stride: 16 }
    }

    /// True if a snapshot of `step` is to be kept.
    pub fn wants(&self, step: u64) -> bool {
        step.is_multiple_of(self.stride) && !self.snapshots.contains_key(&step)
    }

    /// Keeps a snapshot, and of the last collisions before it those since the one before.
    pub fn keep(&mut self, snapshot: RunSnapshot, recent: &[Row]) {
        let step = snapshot.step();
        let before = self.snapshots.range(..step).next_back().map_or(0, |(before, _)| *before);
        let rows = recent[recent.partition_point(|row| row.step < before)..].to_vec();
        let kept = Kept { snapshot, rows };
        self.bytes += kept.bytes();
        self.snapshots.insert(step, kept);
        while self.bytes > self.budget && self.snapshots.len() > 1 {
            self.stride *= 2;
            self.thin_out();
            self.count();
        }
    }

    /// Drops the snapshots that are not at a multiple of the stride; their collisions stay.
    fn thin_out(&mut self) {
        let mut rows = Vec::new();
        for (step, mut kept) in std::mem::take(&mut self.snapshots) {
            rows.append(&mut kept.rows);
            keep_last(&mut rows, MAX_RECENT);
            if step.is_multiple_of(self.stride) {
                self.snapshots.insert(step, Kept { rows: std::mem::take(&mut rows), ..kept });
            }
        }
    }

    /// The last snapshot at or before `step`.
    pub fn nearest(&self, step: u64) -> Option<&RunSnapshot> {
        self.snapshots.range(..=step).next_back().map(|(_, kept)| &kept.snapshot)
    }

    /// The last collisions before that snapshot.
    pub fn recent(&self, step: u64) -> Vec<Row> {
        let latest_first = self.snapshots.range(..=step).rev().flat_map(|(_, kept)| kept.rows.iter().rev());
        let mut rows: Vec<Row> = latest_first.take(MAX_RECENT).cloned().collect();
        rows.reverse();
        rows
    }

    /// Forgets the snapshots at and after `step`.
    pub fn forget_from(&mut self, step: u64) {
        self.snapshots.split_off(&step);
        self.count();
    }

    /// The memory in use, bytes.
    pub fn bytes(&self) -> usize {
        self.bytes
    }

    fn count(&mut self) {
        self.bytes = self.snapshots.values().map(Kept::bytes).sum();
    }
}

/// Energy and momentum over the session, at most [`EnergyStrip::MAX`] samples: when there are more, every other one is
/// dropped.
#[derive(Debug)]
pub struct EnergyStrip {
    /// Step, kinetic and potential energy (J), and momentum (kg·m/s), one sample after the other.
    pub numbers: Vec<f64>,
    stride: u64,
}

impl EnergyStrip {
    /// Numbers of a sample.
    pub const WIDTH: usize = 5;

    /// The largest number of samples.
    pub const MAX: usize = 2048;

    /// An empty strip.
    pub fn new() -> EnergyStrip {
        EnergyStrip { numbers: Vec::new(), stride: 1 }
    }

    /// True if a sample of `step` is to be kept: it comes after the others.
    pub fn wants(&self, step: u64) -> bool {
        let last = self.numbers.chunks_exact(EnergyStrip::WIDTH).next_back().map(|sample| sample[0]);
        step.is_multiple_of(self.stride) && last.is_none_or(|last| (step as f64) > last)
    }

    /// Keeps a sample.
    pub fn keep(&mut self, step: u64, sample: &EnergySample) {
        let EnergySample { kinetic, potential, momentum, .. } = sample;
        self.numbers.extend([step as f64, *kinetic, *potential, momentum.x, momentum.y]);
        if self.numbers.len() > EnergyStrip::MAX * EnergyStrip::WIDTH {
            self.stride *= 2;
            let stride = self.stride as f64;
            self.retain(|step| step % stride == 0.0);
        }
    }

    /// Forgets the samples at and after `step`.
    pub fn forget_from(&mut self, step: u64) {
        self.retain(|sampled| sampled < step as f64);
    }

    fn retain(&mut self, keeps: impl Fn(f64) -> bool) {
        let samples = self.numbers.chunks_exact(EnergyStrip::WIDTH).filter(|sample| keeps(sample[0]));
        self.numbers = samples.flatten().copied().collect();
    }
}

impl Default for EnergyStrip {
    fn default() -> EnergyStrip {
        EnergyStrip::new()
    }
}
