//! The time loop of a run: steps, samples, frames, and when it is over.

mod guard;
mod rest;
mod slide;

use std::{
    sync::atomic::{AtomicBool, Ordering},
    time::{Duration, Instant},
};

use serde::{Deserialize, Serialize};

use guard::Guard;
pub use guard::{Drift, least_supply};
use rest::Rest;
use slide::SlideWatch;

use crate::{
    case::{self, Case},
    fault::Fault,
    measure::{
        pieces,
        probe::Reading,
        summary::{Measures, measures},
    },
    scene::{Scene, softening},
    sim::{Energies, Simulation},
    snapshot::Snapshot,
};

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    AtRest,
    EndTime,
    /// The soil has moved, since the onset of failure, as far as `end.after_failure` asks for.
    SlopeFailed,
    Failed,
    Interrupted,
    ResourceCap,
}

impl Status {
    /// Whether the run came to an end of its own: neither failed nor cut short.
    pub fn is_sound(self) -> bool {
        matches!(self, Status::AtRest | Status::EndTime | Status::SlopeFailed)
    }

    /// Whether something from outside ended it.
    pub fn is_cut_short(self) -> bool {
        matches!(self, Status::Interrupted | Status::ResourceCap)
    }
}

/// The end of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    pub status: Status,
    /// Simulated time (s).
    pub time: f64,
    pub message: String,
    pub fault: Option<Fault>,
    pub dt: StepRange,
    pub measures: Measures,
    /// The first and the worst drift of the energy above `guard.warning`.
    pub drift: Option<[Drift; 2]>,
}

/// Shortest, mean and longest step (s).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StepRange {
    pub min: f64,
    pub mean: f64,
    pub max: f64,
}

/// One row of the history.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    pub time: f64,
    pub dt: f64,
    pub energies: Energies,
    /// r (m), where the case has a crest.
    pub sliding_distance: Option<f64>,
    /// Material points moved so far.
    pub particle_steps: u64,
    /// Newton iterations of the last step (0 in the explicit scheme).
    pub newton_iterations: u32,
    /// Out-of-balance force at the end of the last step (kN/m), where the scheme seeks balance.
    pub residual: Option<f64>,
}

/// Watches a run. Every method has an empty default.
pub trait Observer {
    /// A row of the history.
    fn sample(&mut self, _sample: &Sample) -> std::io::Result<()> {
        Ok(())
    }

    /// A frame. Times rise, but that of the onset of failure comes when the onset is known to be one.
    fn frame(&mut self, _snapshot: &Snapshot) -> std::io::Result<()> {
        Ok(())
    }

    /// Whether frames are wanted at all; without them no snapshot is taken.
    fn wants_frames(&self) -> bool {
        false
    }
}

/// An observer that looks away.
pub struct Blind;

impl Observer for Blind {}

/// What may end a run from outside.
#[derive(Clone, Copy, Debug)]
pub struct Limits<'a> {
    /// Set by an interrupt.
    pub interrupt: Option<&'a AtomicBool>,
    /// Wall time allowed.
    pub time_limit: Option<Duration>,
}

impl Limits<'_> {
    /// No limit.
    pub const NONE: Limits<'static> = Limits { interrupt: None, time_limit: None };

    /// Whether an interrupt has come.
    pub fn interrupted(&self) -> bool {
        self.interrupt.is_some_and(|flag| flag.load(Ordering::Relaxed))
    }
}

/// Explicit steps between two looks at the clock, the interrupt and the state of rest; an implicit
/// step takes long enough to look after each.
const LOOK: u64 = 16;

/// Most explicit steps between two looks at the energies, which take a walk over the points; an instability that doubles
/// in ten steps is still told before its numbers overflow.
const GUARD: u64 = 256;

/// Whether the energies are looked at after this explicit step: from each of the first 16 to each 256th from 4096 on, so
/// that short runs are watched as closely as long ones.
fn is_watched(step: u64) -> bool {
    step.is_multiple_of((step / 16).max(1).next_power_of_two().min(GUARD))
}

struct Loop<'a> {
    case: &'a Case,
    slide: Option<SlideWatch<'a>>,
    /// What an onset looked like that may still turn out to be a wave.
    onset: Option<Snapshot>,
    rest: Rest,
    guard: Guard,
    dt: StepRange,
    next_sample: f64,
    next_frame: f64,
}

/// Runs a scene to its end. The outcome holds the faults of the numerics; `Err` is a failure to
/// write.
pub fn run(case: &Case, scene: &mut Scene, limits: Limits, observer: &mut dyn Observer) -> std::io::Result<Outcome> {
    let started = Instant::now();
    let mut state = Loop::new(case, scene);
    let explicit = case.solver.scheme == case::Scheme::Explicit;
    let look = if explicit { LOOK } else { 1 };
    let sim = &mut scene.simulation;
    state.look(sim, observer, true)?;
    let (status, fault) = loop {
        if let Some(status) = state.finished(sim) {
            break match state.guard.look(sim) {
                Ok(()) => (status, None),
                Err(fault) => (Status::Failed, Some(fault)),
            };
        }
        if sim.work.steps.is_multiple_of(look) {
            if limits.interrupted() {
                break (Status::Interrupted, None);
            }
            state.survey(sim, observer)?;
            if limits.time_limit.is_some_and(|t| started.elapsed() > t) {
                break (Status::ResourceCap, None);
            }
        }
        if let Err(fault) = sim.step(state.limit(sim)) {
            // energy that was made may be why: then the record tells both
            let _ = state.guard.look(sim);
            break (Status::Failed, Some(fault));
        }
        state.note_step(sim, observer)?;
        state.look(sim, observer, false)?;
        if (!explicit || is_watched(sim.work.steps))
            && let Err(fault) = state.guard.look(sim)
        {
            break (Status::Failed, Some(fault));
        }
    };
    state.last_look(sim, observer)?;
    Ok(state.outcome(sim, status, fault))
}

impl<'a> Loop<'a> {
    fn new(case: &'a Case, scene: &Scene) -> Self {
        Loop {
            case,
            slide: case.slide.as_ref().map(|keys| SlideWatch::new(case, keys, scene)),
            onset: None,
            rest: Rest::new(case.end.rest_energy, case.end.rest_hold, case.grid.cell, case.loading_end()),
            guard: Guard::new(case, scene.simulation.initial_mass),
            dt: StepRange { min: f64::INFINITY, mean: 0.0, max: 0.0 },
            next_sample: 0.0,
            next_frame: 0.0,
        }
    }

    /// The longest step that does not pass the end of the run.
    fn limit(&self, sim: &Simulation) -> f64 {
        (self.case.end.time - sim.time).max(0.0)
    }

    fn note_step(&mut self, sim: &Simulation, observer: &mut dyn Observer) -> std::io::Result<()> {
        self.dt.min = self.dt.min.min(sim.dt);
        self.dt.max = self.dt.max.max(sim.dt);
        let begun = self.slide.as_mut().is_some_and(|slide| slide.note_event(sim.events()));
        self.show_onset(begun, sim, observer)
    }

    /// Takes the samples and frames that are due.
    fn look(&mut self, sim: &Simulation, observer: &mut dyn Observer, forced: bool) -> std::io::Result<()> {
        if forced || sim.time >= self.next_sample {
            let sample = self.sample(sim);
            observer.sample(&sample)?;
            self.next_sample = next_due(sim.time, self.case.output.history);
        }
        if observer.wants_frames() && (forced || sim.time >= self.next_frame) {
            observer.frame(&sim.snapshot())?;
            self.next_frame = next_due(sim.time, self.case.output.frames);
        }
        Ok(())
    }

    fn sample(&mut self, sim: &Simulation) -> Sample {
        let energies = sim.energies();
        let sliding_distance = self.slide.as_mut().map(|slide| slide.sample(sim));
        let report = sim.report();
        let implicit = self.case.solver.scheme == case::Scheme::Implicit;
        Sample {
            time: sim.time,
            dt: sim.dt,
            energies,
            sliding_distance,
            particle_steps: sim.work.particle_steps,
            newton_iterations: report.iterations,
            residual: (implicit && sim.work.steps > 0).then_some(report.residual),
        }
    }

    /// Looks whether failure has begun, and whether the body has come to rest. Not tied to the output, which
    /// must not change the answer.
    fn survey(&mut self, sim: &Simulation, observer: &mut dyn Observer) -> std::io::Result<()> {
        let r = self.slide.as_mut().map_or(0.0, |slide| slide.sliding_distance(sim));
        self.rest.note(sim.time, sim.nodal_kinetic_energy(), r, sim.settling());
        let begun = self.slide.as_mut().is_some_and(|slide| slide.note_motion(sim));
        self.show_onset(begun, sim, observer)
    }

    /// Hands on the frame of the onset, once it stands.
    fn show_onset(&mut self, begun: bool, sim: &Simulation, observer: &mut dyn Observer) -> std::io::Result<()> {
        if begun && observer.wants_frames() {
            self.onset = Some(sim.snapshot());
        }
        let stands = self.slide.as_ref().is_some_and(SlideWatch::onset_stands);
        self.onset.take_if(|_| stands).map_or(Ok(()), |snapshot| observer.frame(&snapshot))
    }

    /// The last row and frame, and the levels that the last steps have reached.
    fn last_look(&mut self, sim: &Simulation, observer: &mut dyn Observer) -> std::io::Result<()> {
        self.look(sim, observer, true)?;
        if let Some(slide) = &mut self.slide {
            slide.note_motion(sim);
        }
        Ok(())
    }

    fn finished(&self, sim: &Simulation) -> Option<Status> {
        let end = &self.case.end;
        if end.at_rest && !sim.settling() && self.rest.reached(sim.time) {
            return Some(Status::AtRest);
        }
        if end.after_failure.zip(self.slide.as_ref()).is_some_and(|(most, slide)| slide.moved() >= most) {
            return Some(Status::SlopeFailed);
        }
        // a remainder below rounding is no step
        (sim.time >= end.time * (1.0 - 1e-12)).then_some(Status::EndTime)
    }

    fn outcome(self, sim: &Simulation, status: Status, fault: Option<Fault>) -> Outcome {
        let snapshot = sim.snapshot();
        let residual = residual_strain(self.case);
        let counted = self.slide.as_ref().map(SlideWatch::counted).unwrap_or_default();
        let slid = self.slide.as_ref().map(|slide| slide.slid(&counted));
        let mut m = measures(&snapshot, sim.energies(), slid.as_ref(), residual);
        if let Some(slide) = &self.slide {
            slide.add_onset(&mut m, &snapshot);
        }
        m.probes = self.case.probe.iter().map(|probe| Reading::of(probe, &snapshot)).collect();
        m.pieces = pieces(self.case, &snapshot.reference, &snapshot.position);
        m.mass_error = sim.mass_error();
        m.momentum_error = sim.momentum_error();
        let steps = sim.work.steps;
        let dt = StepRange { mean: if steps > 0 { sim.time / steps as f64 } else { 0.0 }, ..self.dt };
        let dt = if steps > 0 { dt } else { StepRange { min: 0.0, mean: 0.0, max: 0.0 } };
        let message = message(self.case, status, fault.as_ref(), sim.time);
        let drift = self.guard.spoken();
        Outcome { status, time: sim.time, message, fault, dt, measures: m, drift }
    }
}

fn next_due(time: f64, interval: f64) -> f64 {
    ((time / interval).floor() + 1.0) * interval
}

/// Plastic strain at which the last softening material is residual; `None` if none softens.
pub fn residual_strain(case: &Case) -> Option<f64> {
    let strains = case.material.values().filter_map(|m| softening::residual_strain(case, m));
    strains.reduce(f64::max)
}

fn message(case: &Case, status: Status, fault: Option<&Fault>, time: f64) -> String {
    match (status, fault) {
        (Status::AtRest, _) => format!("at rest after {time:.2} s"),
        (Status::EndTime, _) => format!("reached the end time {time:.2} s"),
        (Status::SlopeFailed, _) => {
            let moved = case.end.after_failure.unwrap_or(f64::NAN);
            format!("the slope has failed: {moved} m since the onset were reached at {time:.2} s")
        }
        (Status::Failed, Some(fault)) => format!("{fault}; try: {}", fault.advice(case.step_keys())),
        (Status::Failed, None) => "the solver gave up".to_owned(),
        (Status::Interrupted, _) => format!("interrupted at {time:.2} s; what was done is kept"),
        (Status::ResourceCap, _) => format!("the time limit was reached at {time:.2} s; what was done is kept"),
    }
}
