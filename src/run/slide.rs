//! The slide under way: r(t), the onset of failure, and what has moved since.

use crate::{
    case::{self, Case},
    measure::{
        InitialFailure, Measures, SlideProbe,
        onset::{initial_failure, largest},
        summary::{Slid, SlideHistory},
    },
    scene::Scene,
    sim::Simulation,
    snapshot::Snapshot,
    step::Event,
};

/// Watches the slide of a run.
///
/// **The onset** is where the integrator finds no stable equilibrium any more (the event `stability_lost` of
/// the implicit scheme). Where there is inertia from the start, it is where the nodal kinetic energy comes above
/// `slide.onset_energy` of the external work. The waves at the start of a ramp are above it too, since all work
/// is motion at first; so an onset is withdrawn when the energy falls back before the soil has moved by the lowest
/// level. Under gravity at once it is the first look.
pub(super) struct SlideWatch<'a> {
    keys: &'a case::Slide,
    probe: SlideProbe,
    /// Small strain: only what moved since the onset is a slide, the rest is settlement.
    small: bool,
    /// Whether there is inertia at some time.
    moves: bool,
    history: SlideHistory,
    /// Displacement at the last look, by identity (m).
    displacement: Vec<[f64; 2]>,
    onset: Option<Onset>,
    /// Displacement at the onset (m); anything where there is none.
    at_onset: Vec<[f64; 2]>,
    /// Largest displacement since the onset (m).
    moved: f64,
    /// At the levels reached so far.
    reached: Vec<InitialFailure>,
}

#[derive(Clone, Copy)]
struct Onset {
    time: f64,
    /// Whether it may still turn out to be a wave.
    open: bool,
}

impl<'a> SlideWatch<'a> {
    pub fn new(case: &Case, keys: &'a case::Slide, scene: &Scene) -> Self {
        let reference = scene.simulation.snapshot().reference;
        let still = case.solver.scheme == case::Scheme::Implicit && case.implicit.regime == case::Regime::QuasiStatic;
        SlideWatch {
            keys,
            probe: SlideProbe::new(&reference, keys.crest, scene.grid.h),
            small: case.solver.kinematics == case::Kinematics::Small,
            moves: !still,
            history: SlideHistory::default(),
            displacement: vec![[0.0; 2]; reference.len()],
            onset: None,
            at_onset: vec![[0.0; 2]; reference.len()],
            moved: 0.0,
            reached: Vec::with_capacity(keys.initial_levels.len()),
        }
    }

    /// r (m) at this time; in small strain that of what moved since the onset.
    pub fn sliding_distance(&mut self, sim: &Simulation) -> f64 {
        sim.body.displacements(&mut self.displacement);
        match (self.small, self.onset) {
            (false, _) => self.probe.by_displacement(&self.displacement, self.keys.threshold),
            (true, None) => 0.0,
            (true, Some(_)) => self.probe.distance(|id| {
                let at = |u: &[[f64; 2]]| u.get(id as usize).map_or(0.0, |u| u[0]);
                at(&self.displacement) - at(&self.at_onset) > self.keys.threshold
            }),
        }
    }

    /// A row of r(t).
    pub fn sample(&mut self, sim: &Simulation) -> f64 {
        let r = self.sliding_distance(sim);
        self.history.time.push(sim.time);
        self.history.distance.push(r);
        r
    }

    /// Looks for the loss of stability in the last step; the displacements are still those at its start. Whether
    /// it is the onset.
    pub fn note_event(&mut self, events: &[Event]) -> bool {
        let Some(event) = events.iter().find(|e| e.kind == "stability_lost") else { return false };
        if self.onset_stands() {
            return false;
        }
        self.begin(event.time_s, false);
        true
    }

    /// Whether there is an onset, and no wave.
    pub fn onset_stands(&self) -> bool {
        self.onset.is_some_and(|o| !o.open)
    }

    fn begin(&mut self, time: f64, open: bool) {
        self.onset = Some(Onset { time, open });
        self.at_onset.clone_from(&self.displacement);
        self.moved = 0.0;
    }

    /// Looks at energy and displacement, which are those of the last look. Whether this is an onset that stands
    /// or may come to stand.
    pub fn note_motion(&mut self, sim: &Simulation) -> bool {
        if sim.settling() || !self.moves {
            return false;
        }
        let lively = sim.nodal_kinetic_energy() > self.keys.onset_energy * sim.external_work().max(0.0);
        match self.onset {
            None if lively => {
                self.begin(sim.time, true);
                return true;
            }
            None => {}
            Some(Onset { open: true, .. }) if !lively => self.onset = None,
            Some(_) => self.note_levels(sim),
        }
        false
    }

    fn note_levels(&mut self, sim: &Simulation) {
        self.moved = largest(&self.at_onset, &self.displacement);
        let levels = &self.keys.initial_levels;
        // a NaN reaches no level
        let reached = levels.iter().take_while(|level| self.moved >= **level).count();
        let new = levels.iter().take(reached).skip(self.reached.len());
        if new.len() == 0 {
            return;
        }
        self.onset = self.onset.map(|o| Onset { open: false, ..o });
        let (snapshot, since) = (sim.snapshot(), self.since());
        self.reached.extend(new.map(|level| initial_failure(&snapshot, &self.probe, &since, *level)));
    }

    /// Displacement since the onset, by identity (m); 0 without one.
    fn since(&self) -> Vec<[f64; 2]> {
        let pairs = self.displacement.iter().zip(&self.at_onset);
        pairs.map(|(u, u0)| if self.onset.is_some() { [u[0] - u0[0], u[1] - u0[1]] } else { [0.0; 2] }).collect()
    }

    /// Largest displacement since the onset, at the last look (m).
    pub fn moved(&self) -> f64 {
        if self.onset.is_some() { self.moved } else { 0.0 }
    }

    /// What the measures of the end are read from; `counted` is the displacement that counts.
    pub fn slid<'b>(&'b self, counted: &'b [[f64; 2]]) -> Slid<'b> {
        Slid { keys: self.keys, probe: &self.probe, displacement: counted, history: &self.history }
    }

    /// Displacement that makes a slide, by identity (m).
    pub fn counted(&self) -> Vec<[f64; 2]> {
        if self.small { self.since() } else { self.displacement.clone() }
    }

    /// The onset and the initial failure. In small strain they are also the sliding distance and the volume of
    /// the run: the displacement as a whole is settlement, and there is no second slide.
    pub fn add_onset(&self, m: &mut Measures, end: &Snapshot) {
        let failed = !self.reached.is_empty();
        m.onset_time_s = self.onset.filter(|o| failed || !o.open).map(|o| o.time);
        m.slope_failed = self.moves.then_some(failed);
        m.initial_failure.clone_from(&self.reached);
        if self.small {
            let main = self.reached.iter().find(|f| f.level_m == self.keys.initial_level).copied();
            let at_end = || initial_failure(end, &self.probe, &self.since(), self.keys.initial_level);
            let found = main.or_else(|| failed.then(at_end)).unwrap_or_default().by_clusters;
            m.sliding_distance_m = Some(found.sliding_distance_m);
            m.sliding_distance_censored = found.sliding_distance_m > self.keys.censored_above;
            m.slide_volume_m3_per_m = Some(found.volume_m3_per_m);
        }
    }
}
