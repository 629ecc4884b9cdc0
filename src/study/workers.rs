//! Workers: jobs handed out in order to threads, results handed back to one place as they come.

use std::{
    io,
    ops::ControlFlow,
    sync::{
        atomic::{AtomicBool, AtomicUsize, Ordering},
        mpsc::{self, Sender},
    },
    thread,
};

/// What the workers share: the jobs, how far they are handed out, and whether to go on.
struct Queue<'a, J, R> {
    jobs: &'a [J],
    next: AtomicUsize,
    ended: AtomicBool,
    stop: &'a (dyn Fn() -> bool + Sync),
    work: &'a (dyn Fn(usize, &J) -> R + Sync),
}

/// Hands `jobs` out in order to `threads` workers (0: one a core), until none is left, `stop` says
/// so or `take` breaks. `work` is given the number of the worker and the job; `take` gets the number
/// of the job and its result, on the calling thread and in the order in which they come, also of
/// the jobs that were under way when it broke.
///
/// # Errors
/// A thread cannot be started.
///
/// # Panics
/// Where `work` or `take` does.
pub fn hand_out<J: Sync, R: Send>(
    threads: usize,
    jobs: &[J],
    stop: &(dyn Fn() -> bool + Sync),
    work: &(dyn Fn(usize, &J) -> R + Sync),
    take: &mut dyn FnMut(usize, R) -> ControlFlow<()>,
) -> io::Result<()> {
    let queue = Queue { jobs, next: AtomicUsize::new(0), ended: AtomicBool::new(false), stop, work };
    let count = count(threads).min(jobs.len()).max(1);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().map_err(io::Error::other)?;
    let (sender, results) = mpsc::channel();
    pool.in_place_scope(|scope| {
        let queue = &queue;
        for worker in 0..count {
            let sender = sender.clone();
            scope.spawn(move |_| queue.serve(worker, &sender));
        }
        // the channel ends with the last worker
        drop(sender);
        for (k, result) in results {
            if take(k, result).is_break() {
                queue.ended.store(true, Ordering::Relaxed);
            }
        }
    });
    Ok(())
}

impl<J, R> Queue<'_, J, R> {
    fn serve(&self, worker: usize, sender: &Sender<(usize, R)>) {
        while !(self.ended.load(Ordering::Relaxed) || (self.stop)()) {
            let k = self.next.fetch_add(1, Ordering::Relaxed);
            let Some(job) = self.jobs.get(k) else { break };
            if sender.send((k, (self.work)(worker, job))).is_err() {
                break;
            }
        }
    }
}

/// How many threads a wish comes to: 0 is one a core.
pub fn count(threads: usize) -> usize {
    if threads > 0 { threads } else { thread::available_parallelism().map_or(1, usize::from) }
}

/// Does all jobs and gives their results in the order of the jobs. `progress` is told how many of how
/// many are done.
///
/// # Errors
/// The first problem in the order of the jobs; later jobs are then left undone.
pub fn all<J: Sync, R: Send>(
    threads: usize,
    jobs: &[J],
    progress: &dyn Fn(usize, usize),
    work: &(dyn Fn(&J) -> Result<R, String> + Sync),
) -> Result<Vec<R>, String> {
    let mut results: Vec<Option<Result<R, String>>> = jobs.iter().map(|_| None).collect();
    let (failed, mut done) = (AtomicBool::new(false), 0);
    let stop = || failed.load(Ordering::Relaxed);
    let watched = |_: usize, job: &J| {
        let result = work(job);
        if result.is_err() {
            failed.store(true, Ordering::Relaxed);
        }
        result
    };
    hand_out(threads, jobs, &stop, &watched, &mut |k, result| {
        results[k] = Some(result);
        done += 1;
        progress(done, jobs.len());
        ControlFlow::Continue(())
    })
    .map_err(|e| format!("a thread cannot be started: {e}"))?;
    results.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_stand_in_the_order_of_the_jobs() {
        let jobs: Vec<u64> = (0..100).collect();
        for threads in [0, 1, 3, 200] {
            assert_eq!(all(threads, &jobs, &|_, _| {}, &|k| Ok(k * k)).unwrap()[99], 99 * 99);
        }
        assert!(all(2, &[0u8; 0], &|_, _| {}, &|k| Ok(*k)).unwrap().is_empty());
    }

    #[test]
    fn the_first_problem_in_order_is_told_and_the_rest_left() {
        let jobs: Vec<usize> = (0..1000).collect();
        let seen = AtomicUsize::new(0);
        let work = |k: &usize| {
            seen.fetch_add(1, Ordering::Relaxed);
            if *k >= 7 { Err(format!("job {k}")) } else { Ok(()) }
        };
        assert_eq!(all(3, &jobs, &|_, _| {}, &work).unwrap_err(), "job 7");
        // 7 that went well, and one that did not for each worker
        assert!(seen.load(Ordering::Relaxed) <= 10);
    }

    #[test]
    fn what_is_under_way_when_taking_breaks_is_taken_too() {
        let (jobs, begun) = ([(); 50], AtomicUsize::new(0));
        let mut taken = 0;
        let work = |_: usize, (): &()| begun.fetch_add(1, Ordering::Relaxed);
        let mut take = |_: usize, _: usize| {
            taken += 1;
            ControlFlow::Break(())
        };
        hand_out(2, &jobs, &|| false, &work, &mut take).unwrap();
        assert_eq!(taken, begun.load(Ordering::Relaxed));
    }
}
