//! Threads that work on one thing: jobs handed out in order, results taken in order.

use std::{
    io,
    sync::{Condvar, Mutex, MutexGuard, PoisonError},
};

use rayon::{ThreadPool, ThreadPoolBuilder};

/// The calling thread and its helpers.
#[derive(Default)]
pub struct Team {
    /// The helpers; none where the calling thread is alone.
    helpers: Option<ThreadPool>,
}

impl Team {
    /// A team of `threads`, the calling one among them; at least that.
    ///
    /// # Errors
    /// A thread cannot be started.
    pub fn new(threads: usize) -> io::Result<Self> {
        let pool = |n| ThreadPoolBuilder::new().num_threads(n).build().map_err(io::Error::other);
        Ok(Team { helpers: (threads > 1).then(|| pool(threads - 1)).transpose()? })
    }

    /// Threads in all.
    pub fn threads(&self) -> usize {
        1 + self.helpers.as_ref().map_or(0, ThreadPool::current_num_threads)
    }

    /// Desks that [`Team::in_order`] makes use of: a result that waits for its turn keeps its desk.
    pub fn desks(&self) -> usize {
        if self.threads() == 1 { 1 } else { 2 * self.threads() }
    }

    /// Does all jobs, each at one of the `desks` (at least one), and calls `take` with the desk and the result, one
    /// at a time and in the order of the jobs, whatever thread did them: so sums have the same bits on any number of threads.
    ///
    /// # Panics
    /// Where `work` or `take` does.
    pub fn in_order<D: Send, J, R: Send>(
        &self,
        desks: &mut [D],
        jobs: impl Iterator<Item = J> + Send,
        work: impl Fn(&mut D, J) -> R + Sync,
        mut take: impl FnMut(&mut D, R) + Send,
    ) {
        let Some(helpers) = &self.helpers else {
            let Some(desk) = desks.first_mut() else { return };
            for job in jobs {
                let result = work(desk, job);
                take(desk, result);
            }
            return;
        };
        let line = Line {
            free: desks.iter_mut().collect(),
            jobs: jobs.enumerate(),
            waiting: Vec::new(),
            taken: 0,
            broken: false,
            take,
        };
        let (line, freed) = (Mutex::new(line), Condvar::new());
        let serve = || {
            let _alarm = Alarm(|| {
                lock(&line).broken = true;
                freed.notify_all();
            });
            while let Some((desk, k, job)) = next(&line, &freed) {
                let result = work(desk, job);
                lock(&line).hand_in(k, desk, result);
                freed.notify_all();
            }
        };
        helpers.in_place_scope(|scope| {
            (0..helpers.current_num_threads()).for_each(|_| scope.spawn(|_| serve()));
            serve();
        });
    }
}

/// The desks that are free, the jobs to come and the results whose turn has not come.
struct Line<'d, D, J, R, T> {
    free: Vec<&'d mut D>,
    jobs: J,
    waiting: Vec<(usize, &'d mut D, R)>,
    /// Results taken so far.
    taken: usize,
    /// Whether a thread has panicked: its result will not come, and nobody may wait for it.
    broken: bool,
    take: T,
}

impl<'d, D, J, R, T: FnMut(&mut D, R)> Line<'d, D, J, R, T> {
    /// Takes all results whose turn it is.
    fn hand_in(&mut self, k: usize, desk: &'d mut D, result: R) {
        self.waiting.push((k, desk, result));
        while let Some(at) = self.waiting.iter().position(|(k, ..)| *k == self.taken) {
            let (_, desk, result) = self.waiting.swap_remove(at);
            (self.take)(desk, result);
            self.taken += 1;
            self.free.push(desk);
        }
    }
}

/// Is called where its thread unwinds.
struct Alarm<F: Fn()>(F);

impl<F: Fn()> Drop for Alarm<F> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            (self.0)();
        }
    }
}

/// A desk and the next job; `None` when there is no job left, or a thread has panicked. The job whose turn is next always has a desk: jobs are
/// handed out in order.
fn next<'d, D, J, R, T>(
    line: &Mutex<Line<'d, D, impl Iterator<Item = (usize, J)>, R, T>>,
    freed: &Condvar,
) -> Option<(&'d mut D, usize, J)> {
    let mut line = lock(line);
    loop {
        if line.broken {
            return None;
        }
        if let Some(desk) = line.free.pop() {
            let job = line.jobs.next();
            return job.map(|(k, job)| (desk, k, job));
        }
        line = freed.wait(line).unwrap_or_else(PoisonError::into_inner);
    }
}

/// A panic of another thread ends the scope anyway.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_taken_in_order_on_any_number_of_threads() {
        for threads in [1, 2, 5] {
            let team = Team::new(threads).unwrap();
            assert_eq!(team.threads(), threads);
            let mut desks = vec![0u64; team.desks()];
            let mut taken = Vec::new();
            let slow = |desk: &mut u64, k: u64| {
                // late jobs are quick
                *desk = (0..(200 - k) * 200).fold(k, |a, b| std::hint::black_box(a ^ b));
                k * k
            };
            team.in_order(&mut desks, 0..200u64, slow, |_, r| taken.push(r));
            assert_eq!(taken, (0..200u64).map(|k| k * k).collect::<Vec<_>>());
        }
    }

    #[test]
    fn a_panic_comes_through() {
        let team = Team::new(2).unwrap();
        let work = |(): &mut (), k: u32| assert!(k != 7, "seven");
        let run = || team.in_order(&mut [(), (), (), ()], 0..20u32, work, |(), ()| {});
        assert!(std::panic::catch_unwind(std::panic::AssertUnwindSafe(run)).is_err());
    }
}
