use std::num::NonZero;

/// The threads to work on: as many as asked for, or one for each processor.
pub fn threads(asked: Option<NonZero<usize>>) -> NonZero<usize> {
    asked.or(std::thread::available_parallelism().ok()).unwrap_or(NonZero::<usize>::MIN)
}
