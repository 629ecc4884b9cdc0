//! The guard on the balance of energy: a run that makes energy, or loses it without a known cause, says so.

use crate::{
    case::{Case, GravitySchedule},
    fault::{Fault, FaultKind},
    sim::{Energies, Simulation},
};

/// Height, in cells, through which the weight of the body falls for the least energy that the drift is compared
/// with: about that at which the first points cross a cell face. A drift of 1 % of it is worth a fall through 1/400 of a
/// cell: nobody would see it, and in the first instants of a run, when hardly anything has been supplied yet, it means
/// nothing.
const FALL: f64 = 0.25;

/// What the books cannot explain, at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    pub step: u64,
    pub time_s: f64,
    /// The larger of |unexplained| and the energy that the scheme has made in all, over the energy supplied.
    pub share: f64,
}

/// Compares the drift with the largest supply so far.
#[derive(Clone, Debug)]
pub struct Guard {
    levels: crate::case::Guard,
    /// Largest supply so far (kJ/m); no less than [`FALL`] asks for.
    supply: f64,
    first: Option<Drift>,
    worst: Option<Drift>,
}

impl Guard {
    /// The guard of a case, on a body of this mass (t/m).
    pub fn new(case: &Case, mass: f64) -> Self {
        Guard { levels: case.guard, supply: least_supply(case, mass), first: None, worst: None }
    }

    /// Whether anything is watched.
    pub fn is_on(&self) -> bool {
        self.levels.warning.is_some() || self.levels.fault.is_some()
    }

    /// Looks at the energies after a step.
    ///
    /// # Errors
    /// The drift is above the level of a fault, or no number.
    pub fn look(&mut self, sim: &Simulation) -> Result<(), Fault> {
        if !self.is_on() || sim.work.steps == 0 {
            return Ok(());
        }
        self.note(&sim.energies(), sim.work.steps, sim.time)
    }

    fn note(&mut self, e: &Energies, step: u64, time_s: f64) -> Result<(), Fault> {
        self.supply = self.supply.max(e.external.abs());
        let drift = Drift { step, time_s, share: share(e, self.supply) };
        let fault = |kind| Fault { step, time_s, ..numbers(Fault::new(kind), e, &drift) };
        if !drift.share.is_finite() {
            return Err(fault(FaultKind::NonFinite));
        }
        if self.levels.warning.is_some_and(|level| drift.share > level) {
            self.first.get_or_insert(drift);
            self.worst = self.worst.filter(|worst| worst.share >= drift.share).or(Some(drift));
        }
        // Where nothing moves the balance is no measure of stability: each step ends in equilibrium, and what is left over is
        // how well the mean of two forces stands for those between them in a long step.
        let moves = e.kinetic > 0.0;
        match self.levels.fault {
            Some(level) if drift.share > level && moves => Err(fault(FaultKind::EnergyDrift)),
            _ => Ok(()),
        }
    }

    /// The first drift above the level of a warning, and the worst.
    pub fn spoken(&self) -> Option<[Drift; 2]> {
        self.first.zip(self.worst).map(|(first, worst)| [first, worst])
    }
}

/// The least energy (kJ/m) that the drift of a body of this mass (t/m) is compared with: see `FALL`.
pub fn least_supply(case: &Case, mass: f64) -> f64 {
    let pull = if case.gravity.schedule == GravitySchedule::None { 0.0 } else { case.gravity.acceleration };
    FALL * case.grid.cell * mass * pull
}

/// Energy that the maps, impacts and the known damping take is explained; energy made is never, wherever it appears.
/// Without any supply rounding is compared with what moves.
fn share(e: &Energies, supply: f64) -> f64 {
    let (made, unexplained) = (-e.numerical, e.unexplained.abs());
    // `max` would pass over a NaN
    let drift = if unexplained.is_nan() || unexplained > made { unexplained } else { made };
    let scale = supply.max(1e-9 * (e.kinetic + e.strain + e.dissipated.abs()));
    if drift <= 0.0 { 0.0 } else { drift / scale }
}

fn numbers(fault: Fault, e: &Energies, drift: &Drift) -> Fault {
    let share = if drift.share.is_finite() { drift.share } else { f64::NAN };
    fault
        .with("share", share)
        .with("unexplained_kj_per_m", e.unexplained)
        .with("numerical_kj_per_m", e.numerical)
        .with("external_kj_per_m", e.external)
        .with("kinetic_kj_per_m", e.kinetic)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn guard() -> Guard {
        let levels = crate::case::Guard { warning: Some(0.01), fault: Some(0.1) };
        Guard { levels, supply: 10.0, first: None, worst: None }
    }

    fn energies(unexplained: f64, numerical: f64) -> Energies {
        Energies { external: 5.0, kinetic: 1.0, unexplained, numerical, ..Energies::default() }
    }

    #[test]
    fn losses_with_a_cause_pass_and_energy_made_does_not() {
        let mut g = guard();
        // 3 of 5 kJ/m lost, all but 0.05 with a cause
        assert_eq!((g.note(&energies(0.05, 3.0), 1, 0.1), g.spoken()), (Ok(()), None));
        assert_eq!(g.note(&energies(0.05, -0.2), 2, 0.2), Ok(()));
        assert_eq!(g.note(&energies(-0.5, 1.0), 3, 0.3), Ok(()));
        let drift = |step, time_s, share| Drift { step, time_s, share };
        assert_eq!(g.spoken(), Some([drift(2, 0.2, 0.02), drift(3, 0.3, 0.05)]));
        let fault = g.note(&energies(0.0, -1.5), 4, 0.4).expect_err("15 %");
        assert_eq!((fault.kind, fault.step, fault.time_s), (FaultKind::EnergyDrift, 4, 0.4));
    }

    #[test]
    fn a_body_that_does_not_move_is_warned_of_only() {
        let mut g = guard();
        assert_eq!(g.note(&Energies { kinetic: 0.0, ..energies(5.0, 5.0) }, 1, 0.1), Ok(()));
        assert!(g.spoken().is_some());
    }

    #[test]
    fn what_is_no_number_is_a_fault() {
        for e in [energies(f64::NAN, 0.0), energies(0.0, f64::NAN), energies(f64::INFINITY, 0.0)] {
            assert_eq!(guard().note(&e, 1, 0.1).map_err(|f| f.kind), Err(FaultKind::NonFinite), "{e:?}");
        }
    }

    #[test]
    fn a_body_without_energy_has_no_drift() {
        assert_eq!(share(&Energies::default(), 0.0), 0.0);
    }
}
