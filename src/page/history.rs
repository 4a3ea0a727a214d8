use rebond::internals::picture::EnergySample;
use rebond::internals::replay::RunSnapshot;
use std::collections::BTreeMap;

/// Snapshots of a run under a budget of bytes. When they exceed it, every other one is dropped, so that the distance
/// between them, and with it the time to go back, grows with the length of the session.
#[derive(Debug)]
pub struct History {
    snapshots: BTreeMap<u64, RunSnapshot>,
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

    /// Keeps a snapshot.
    pub fn keep(&mut self, snapshot: RunSnapshot) {
        self.bytes += snapshot.bytes();
        self.snapshots.insert(snapshot.step(), snapshot);
        while self.bytes > self.budget && self.snapshots.len() > 1 {
            self.stride *= 2;
            self.snapshots.retain(|step, _| step.is_multiple_of(self.stride));
            self.count();
        }
    }

    /// The last snapshot at or before `step`.
    pub fn nearest(&self, step: u64) -> Option<&RunSnapshot> {
        self.snapshots.range(..=step).next_back().map(|(_, snapshot)| snapshot)
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
        self.bytes = self.snapshots.values().map(RunSnapshot::bytes).sum();
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
