//! The threads of a solver.

use std::num::NonZero;
use std::sync::{Mutex, PoisonError};
use std::thread::{Builder, available_parallelism, scope};

/// The number of threads that share the work of a step whose order does not matter. It influences no result.
#[derive(Clone, Copy, Debug)]
pub struct Threads(usize);

impl Threads {
    /// The thread of the caller alone.
    pub const ONE: Threads = Threads(1);

    /// The given number of threads; without one, as many as the system runs at the same time.
    pub fn new(count: Option<NonZero<u32>>) -> Threads {
        let available = || available_parallelism().map_or(1, NonZero::get);
        Threads(count.map_or_else(available, |count| count.get() as usize))
    }

    /// The number of threads.
    pub fn count(self) -> usize {
        self.0
    }

    /// Calls `work` with each of the parts, in any order; with more than one part, on several threads.
    ///
    /// Starting a thread and waiting for it takes about 25 µs. If the system provides fewer threads, or none as on
    /// WebAssembly, the work only takes longer.
    pub fn share<P: Send>(self, parts: impl ExactSizeIterator<Item = P> + Send, work: impl Fn(P) + Sync) {
        let helpers = self.count().min(parts.len()).saturating_sub(1);
        if helpers == 0 {
            return parts.for_each(work);
        }
        let parts = Mutex::new(parts);
        let next = || parts.lock().unwrap_or_else(PoisonError::into_inner).next();
        let take_parts = || std::iter::from_fn(next).for_each(&work);
        scope(|scope| {
            for _ in 0..helpers {
                if Builder::new().spawn_scoped(scope, take_parts).is_err() {
                    break;
                }
            }
            take_parts();
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_part_is_worked_on_once_with_any_number_of_threads() {
        for threads in [1, 2, 7] {
            for count in [0, 1, 2, 100] {
                let mut numbers = vec![1; count];
                let parts = numbers.chunks_mut(3).enumerate();
                Threads::new(NonZero::new(threads)).share(parts, |(index, part): (usize, &mut [usize])| {
                    part.iter_mut().for_each(|number| *number += index);
                });
                assert_eq!(numbers, Vec::from_iter((0..count).map(|index| 1 + index / 3)));
            }
        }
    }
}
