use std::num::NonZero;

/// The number of threads to use: as requested, or one per processor.
pub fn thread_count(requested: Option<NonZero<usize>>) -> NonZero<usize> {
    requested.or(std::thread::available_parallelism().ok()).unwrap_or(NonZero::<usize>::MIN)
}
