//! Tasks shared out to threads, each of which keeps its own state from task to task.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A thread takes at most this part of what is left for each.
const SHARES: usize = 4;

/// Runs `run(worker, i)` for every `i` below `tasks` and returns the results that are some, in the order of `i`,
/// whatever the number of threads.
///
/// A thread takes `grain` neighbours at a time, fewer towards the end, so that all threads end together.
///
/// Every thread of the current pool that gets work makes one worker. A thread that `run` tells to stop, by
/// an error, stops all others; the error of the lowest task among those that failed is returned.
pub(crate) fn run_tasks<W, T: Send, E: Send>(
    tasks: usize,
    grain: usize,
    make_worker: impl Fn() -> W + Sync,
    run: impl Fn(&mut W, usize) -> Result<Option<T>, E> + Sync,
) -> Result<Vec<T>, E> {
    let next = AtomicUsize::new(0);
    let shares = Mutex::new(Vec::new());
    let failure: Mutex<Option<(usize, E)>> = Mutex::new(None);
    let threads = rayon::current_num_threads().min(tasks.div_ceil(grain));
    let work = || {
        let mut worker = None;
        let mut done = Vec::new();
        loop {
            let share = |first: usize| (tasks.saturating_sub(first) / (SHARES * threads)).clamp(1, grain);
            let taken = next.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |first| {
                (first < tasks).then(|| first + share(first))
            });
            let Ok(first) = taken else { break };
            let worker = worker.get_or_insert_with(&make_worker);
            for task in first..first + share(first) {
                match run(worker, task) {
                    Ok(Some(result)) => done.push((task, result)),
                    Ok(None) => {}
                    Err(error) => {
                        next.store(tasks, Ordering::Relaxed);
                        let mut failure = failure.lock().expect("no worker panics while holding it");
                        if failure.as_ref().is_none_or(|(earlier, _)| task < *earlier) {
                            *failure = Some((task, error));
                        }
                        return;
                    }
                }
            }
        }
        shares.lock().expect("no worker panics while holding it").push(done);
    };
    if threads <= 1 {
        work();
    } else {
        rayon::scope(|scope| (0..threads).for_each(|_| scope.spawn(|_| work())));
    }
    if let Some((_, error)) = failure.into_inner().expect("all workers have ended") {
        return Err(error);
    }
    let mut all: Vec<(usize, T)> =
        shares.into_inner().expect("all workers have ended").into_iter().flatten().collect();
    all.sort_unstable_by_key(|(task, _)| *task);
    Ok(all.into_iter().map(|(_, result)| result).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_order_from_any_number_of_threads() {
        for threads in [1, 2, 5] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            let odd = |_: &mut (), i: usize| Ok::<_, ()>((i % 2 == 1).then_some(i));
            let result = pool.install(|| run_tasks(1001, 7, || (), odd)).expect("no task fails");
            assert!(result.iter().copied().eq((0..1001).filter(|i| i % 2 == 1)));
        }
    }

    #[test]
    fn no_tasks_have_no_results() {
        let result = run_tasks(0, 8, || (), |(), i| Ok::<_, ()>(Some(i)));
        assert_eq!(result, Ok(Vec::new()));
    }

    #[test]
    fn an_error_ends_the_work() {
        let result = run_tasks(100, 1, || (), |(), i| if i == 40 { Err(i) } else { Ok(Some(())) });
        assert_eq!(result.expect_err("task 40 fails"), 40);
    }
}
