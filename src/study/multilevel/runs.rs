//! The runs: which realisation of which term at which setting, done by workers, written as they come.

use std::{
    collections::BTreeMap,
    io::{self, Write},
    ops::ControlFlow,
};

use super::settings::{Ladder, Setting};
use crate::{
    run::Limits,
    scene::SceneError,
    study::{
        ensemble::{Done, Measure, Problem, Realiser, all_measures},
        workers,
    },
};

/// One run. Terms have realisations of their own, which stay the same however many there will be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Job {
    pub term: usize,
    pub sample: u64,
    /// Its place among the settings.
    pub setting: usize,
}

impl Job {
    /// The realisation it runs, of `terms` terms.
    pub fn realisation(self, terms: usize) -> u64 {
        self.sample * terms as u64 + self.term as u64
    }
}

/// All that is done, and how more is.
pub struct Runs<'a> {
    ladder: &'a Ladder,
    /// Levels, as many as terms.
    terms: usize,
    realisers: Vec<Realiser<'a>>,
    measures: Vec<Measure>,
    limits: Limits<'a>,
    threads: usize,
    done: BTreeMap<Job, Done>,
}

impl<'a> Runs<'a> {
    /// None yet. Every setting is built once, so that nothing is found wrong after hours.
    ///
    /// # Errors
    /// A setting that cannot be built.
    pub fn new(
        ladder: &'a Ladder,
        terms: usize,
        max_memory: u64,
        limits: Limits<'a>,
        threads: usize,
    ) -> Result<Self, Problem> {
        let realiser = |(setting, case): (&Setting, _)| {
            let cannot = |e: SceneError| {
                let text = format!("{}: {e}", setting.label);
                if e.too_large { Problem::TooLarge(text) } else { Problem::Refused(text) }
            };
            let realiser = Realiser::new(case, max_memory, limits).map_err(cannot)?;
            realiser.scene(Some(0)).map_err(cannot)?;
            Ok(realiser)
        };
        let realisers = ladder.settings.iter().zip(&ladder.cases).map(realiser).collect::<Result<_, Problem>>()?;
        let measures = ladder.cases.first().map(all_measures).unwrap_or_default();
        Ok(Runs { ladder, terms, realisers, measures, limits, threads, done: BTreeMap::new() })
    }

    /// Does the jobs; each row goes to `journal` as it comes. What an interrupt leaves undone is missing.
    ///
    /// # Errors
    /// Writing, or a thread that cannot be started.
    pub fn extend(&mut self, jobs: &[Job], journal: &mut dyn Write, progress: &dyn Fn(usize, usize)) -> io::Result<()> {
        let (mut came, mut written) = (Vec::new(), Ok(()));
        let stop = || self.limits.interrupted();
        let work =
            |worker: usize, job: &Job| self.realisers.get(job.setting)?.run(Some(job.realisation(self.terms)), worker);
        workers::hand_out(self.threads, jobs, &stop, &work, &mut |k, done| {
            let Some((job, done)) = jobs.get(k).zip(done) else { return ControlFlow::Continue(()) };
            written = self.write(&[(*job, &done)], journal, false);
            came.push((*job, done));
            progress(came.len(), jobs.len());
            if written.is_err() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })?;
        self.done.extend(came);
        written
    }

    /// All rows in order.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn csv(&self) -> io::Result<String> {
        let mut text = Vec::new();
        let rows: Vec<(Job, &Done)> = self.done.iter().map(|(job, done)| (*job, done)).collect();
        self.write(&rows, &mut text, true)?;
        String::from_utf8(text).map_err(io::Error::other)
    }

    /// The header alone, with which the rows as they come begin.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn header(&self, journal: &mut dyn Write) -> io::Result<()> {
        self.write(&[], journal, true)
    }

    fn write(&self, rows: &[(Job, &Done)], to: &mut dyn Write, header: bool) -> io::Result<()> {
        let mut writer = csv::Writer::from_writer(to);
        if header {
            let names = self.measures.iter().map(|m| m.name.as_str());
            let first = ["term", "sample", "realisation", "level", "setting", "status", "fault"];
            let last = ["particle_steps", "steps", "cpu_s"];
            writer.write_record(first.into_iter().chain(names).chain(last))?;
        }
        for (job, Done { row, cost }) in rows {
            let Some(setting) = self.ladder.settings.get(job.setting) else { continue };
            let numbers = self.measures.iter().map(|m| row.measure(&m.name));
            let work = ["particle_steps", "steps"].into_iter().map(|name| row.work.get(name).copied());
            let numbers: Vec<Option<f64>> = numbers.chain(work).chain([cost.cpu_s]).collect();
            let who = (job.term, job.sample, job.realisation(self.terms), setting.level, &setting.label);
            writer.serialize((who, row.status, &row.fault, numbers))?;
        }
        writer.flush()
    }

    /// The measures by name.
    pub fn names(&self) -> Vec<&str> {
        self.measures.iter().map(|m| m.name.as_str()).collect()
    }

    /// Whether an interrupt has come.
    pub fn interrupted(&self) -> bool {
        self.limits.interrupted()
    }

    /// Runs that failed.
    pub fn failed(&self) -> usize {
        self.done.values().filter(|d| d.row.fault.is_some()).count()
    }

    /// All runs of a setting.
    pub fn of_setting(&self, setting: usize) -> impl Iterator<Item = &Done> {
        self.done.iter().filter(move |(job, _)| job.setting == setting).map(|(_, done)| done)
    }

    /// A measure of the runs of a term at two settings, in the order of the realisations, where both have it;
    /// and how many have it at one alone or at none.
    pub fn both(&self, term: usize, [a, b]: [usize; 2], name: &str) -> (Vec<f64>, Vec<f64>, usize) {
        let value = |job: Job| self.done.get(&job).map(|d| d.row.measure(name));
        let (mut x, mut y, mut lacking) = (Vec::new(), Vec::new(), 0);
        for job in self.done.keys().filter(|job| job.term == term && job.setting == a) {
            match (value(*job), value(Job { setting: b, ..*job })) {
                (Some(Some(p)), Some(Some(q))) => {
                    x.push(p);
                    y.push(q);
                }
                (_, Some(_)) => lacking += 1,
                // the partner is not done
                (_, None) => {}
            }
        }
        (x, y, lacking)
    }
}
