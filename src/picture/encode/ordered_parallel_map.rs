//! A map of an iterator on several threads, whose results are in the order of the inputs.
//!
//! `par_bridge` of the crate rayon gives results in any order, and its indexed iterators collect all of them:
//! an animation of any length would be in memory before its first frame is written.

use std::num::NonZero;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::Builder;

/// The largest number of tasks queued for one worker.
const QUEUE_LENGTH: usize = 2;

/// Maps every input on `threads` threads and passes the results to `output` in the order of the inputs.
///
/// `worker` creates the function that one thread maps with. Inputs are distributed round-robin, and only
/// a few results are queued per thread, so memory use does not depend on the number of inputs.
///
/// # Errors
/// The first error of `inputs` or `output`.
pub fn ordered_parallel_map<T: Send, R: Send, E, W: FnMut(T) -> R>(
    inputs: impl Iterator<Item = Result<T, E>>,
    threads: NonZero<usize>,
    worker: impl Fn() -> W + Sync,
    mut output: impl FnMut(R) -> Result<(), E>,
) -> Result<(), E> {
    std::thread::scope(|scope| {
        let spawned = if threads.get() == 1 { 0 } else { threads.get() };
        // If the system provides fewer threads, or none as on WebAssembly, the work only takes longer.
        let workers: Vec<Worker<T, R>> = (0..spawned)
            .map_while(|_| {
                let (handle, tasks, results) = Worker::new();
                Builder::new().spawn_scoped(scope, || run_worker(worker(), tasks, results)).ok().map(|_| handle)
            })
            .collect();
        if workers.is_empty() {
            let mut map = worker();
            return inputs.into_iter().try_for_each(|input| output(map(input?)));
        }
        distribute(inputs, &workers, &mut output)
    })
}

/// The channels to and from one worker thread.
struct Worker<T, R> {
    tasks: SyncSender<T>,
    results: Receiver<R>,
}

impl<T, R> Worker<T, R> {
    /// Creates the channels; the second and third value are the worker's ends.
    fn new() -> (Worker<T, R>, Receiver<T>, SyncSender<R>) {
        let (tasks, worker_tasks) = sync_channel(QUEUE_LENGTH);
        let (worker_results, results) = sync_channel(QUEUE_LENGTH);
        (Worker { tasks, results }, worker_tasks, worker_results)
    }
}

fn run_worker<T, R>(mut map: impl FnMut(T) -> R, tasks: Receiver<T>, results: SyncSender<R>) {
    for task in tasks {
        if results.send(map(task)).is_err() {
            return;
        }
    }
}

fn distribute<T, R, E>(
    inputs: impl Iterator<Item = Result<T, E>>,
    workers: &[Worker<T, R>],
    output: &mut impl FnMut(R) -> Result<(), E>,
) -> Result<(), E> {
    let (mut sent, mut received) = (0, 0);
    let mut receive = |received: &mut usize| {
        let result = workers[*received % workers.len()].results.recv().expect(WORKER_ENDED);
        *received += 1;
        output(result)
    };
    for input in inputs {
        if sent - received == QUEUE_LENGTH * workers.len() {
            receive(&mut received)?;
        }
        workers[sent % workers.len()].tasks.send(input?).expect(WORKER_ENDED);
        sent += 1;
    }
    while received < sent {
        receive(&mut received)?;
    }
    Ok(())
}

const WORKER_ENDED: &str = "a worker ends before its queue only by a panic, which is propagated here";

#[cfg(test)]
mod tests {
    use super::*;

    fn squares(threads: usize, inputs: impl Iterator<Item = Result<u64, String>>) -> (Vec<u64>, Result<(), String>) {
        let mut squares = Vec::new();
        let threads = NonZero::new(threads).unwrap();
        let end = ordered_parallel_map(
            inputs,
            threads,
            || |input| input * input,
            |square| {
                squares.push(square);
                Ok(())
            },
        );
        (squares, end)
    }

    #[test]
    fn results_have_the_order_of_the_inputs_for_any_number_of_threads() {
        let expected: Vec<u64> = (0..100).map(|input| input * input).collect();
        for threads in [1, 2, 3, 7] {
            assert_eq!(squares(threads, (0..100).map(Ok)), (expected.clone(), Ok(())));
        }
    }

    #[test]
    fn the_first_error_of_the_inputs_stops_the_map() {
        for threads in [1, 2] {
            let inputs = (0..100).map(|input| if input == 50 { Err("50".to_owned()) } else { Ok(input) });
            let (squares, end) = squares(threads, inputs);
            assert_eq!(end, Err("50".to_owned()));
            assert!(squares.len() <= 50);
        }
    }

    #[test]
    fn an_error_of_the_output_stops_the_map() {
        for threads in [1, 2] {
            let threads = NonZero::new(threads).unwrap();
            let end = ordered_parallel_map(
                (0..u64::MAX).map(Ok),
                threads,
                || |input| input,
                |result| {
                    if result == 20 { Err("full") } else { Ok(()) }
                },
            );
            assert_eq!(end, Err("full"));
        }
    }
}
