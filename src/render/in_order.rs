use std::num::NonZero;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::Builder;

/// Tasks that wait for one worker at most.
const WAITING: usize = 2;

/// Does `work` on every input, on `threads` threads, and hands the results to `output` in the
/// order of the inputs.
///
/// `worker` makes what each thread works with. The n-th input always goes to the same one, and
/// a few results wait for each at most: memory does not grow with the number of inputs.
///
/// # Errors
/// The first error of `inputs` or `output`.
pub fn in_order<T: Send, R: Send, E, W: FnMut(T) -> R>(
    inputs: impl Iterator<Item = Result<T, E>>,
    threads: NonZero<usize>,
    worker: impl Fn() -> W + Sync,
    mut output: impl FnMut(R) -> Result<(), E>,
) -> Result<(), E> {
    std::thread::scope(|scope| {
        let others = if threads.get() == 1 { 0 } else { threads.get() };
        // Where the system has fewer threads to give, or none as WebAssembly, it only takes longer.
        let lanes: Vec<Lane<T, R>> = (0..others)
            .map_while(|_| {
                let (lane, tasks, results) = Lane::new();
                Builder::new().spawn_scoped(scope, || serve(worker(), tasks, results)).ok().map(|_| lane)
            })
            .collect();
        if lanes.is_empty() {
            let mut work = worker();
            return inputs.into_iter().try_for_each(|input| output(work(input?)));
        }
        deal(inputs, &lanes, &mut output)
    })
}

/// The way to one worker and back.
struct Lane<T, R> {
    tasks: SyncSender<T>,
    results: Receiver<R>,
}

impl<T, R> Lane<T, R> {
    fn new() -> (Lane<T, R>, Receiver<T>, SyncSender<R>) {
        let (tasks, to_do) = sync_channel(WAITING);
        let (done, results) = sync_channel(WAITING);
        (Lane { tasks, results }, to_do, done)
    }
}

fn serve<T, R>(mut work: impl FnMut(T) -> R, tasks: Receiver<T>, results: SyncSender<R>) {
    for task in tasks {
        if results.send(work(task)).is_err() {
            return;
        }
    }
}

fn deal<T, R, E>(
    inputs: impl Iterator<Item = Result<T, E>>,
    lanes: &[Lane<T, R>],
    output: &mut impl FnMut(R) -> Result<(), E>,
) -> Result<(), E> {
    let (mut sent, mut received) = (0, 0);
    let mut receive = |received: &mut usize| {
        let result = lanes[*received % lanes.len()].results.recv().expect(DEAD_WORKER);
        *received += 1;
        output(result)
    };
    for input in inputs {
        if sent - received == WAITING * lanes.len() {
            receive(&mut received)?;
        }
        lanes[sent % lanes.len()].tasks.send(input?).expect(DEAD_WORKER);
        sent += 1;
    }
    while received < sent {
        receive(&mut received)?;
    }
    Ok(())
}

const DEAD_WORKER: &str = "a worker ends before its tasks only by a panic, which goes on here";

#[cfg(test)]
mod tests {
    use super::*;

    fn squares(threads: usize, inputs: impl Iterator<Item = Result<u64, String>>) -> (Vec<u64>, Result<(), String>) {
        let mut seen = Vec::new();
        let threads = NonZero::new(threads).unwrap();
        let end = in_order(
            inputs,
            threads,
            || |input| input * input,
            |square| {
                seen.push(square);
                Ok(())
            },
        );
        (seen, end)
    }

    #[test]
    fn results_come_in_the_order_of_the_inputs_for_any_number_of_threads() {
        let expected: Vec<u64> = (0..100).map(|input| input * input).collect();
        for threads in [1, 2, 3, 7] {
            assert_eq!(squares(threads, (0..100).map(Ok)), (expected.clone(), Ok(())));
        }
    }

    #[test]
    fn the_first_error_of_the_inputs_ends_the_work() {
        for threads in [1, 2] {
            let inputs = (0..100).map(|input| if input == 50 { Err("50".to_owned()) } else { Ok(input) });
            let (seen, end) = squares(threads, inputs);
            assert_eq!(end, Err("50".to_owned()));
            assert!(seen.len() <= 50);
        }
    }

    #[test]
    fn an_error_of_the_output_ends_the_work() {
        for threads in [1, 2] {
            let threads = NonZero::new(threads).unwrap();
            let end = in_order(
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
