//! When Newton's iteration has converged, and when it is not worth going on.

/// What is asked of the iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerances {
    /// |r| <= `relative` x scale, the scale being that of the forces in balance.
    pub relative: f64,
    /// |r| <= `absolute` (same unit as r) is enough whatever the scale.
    pub absolute: f64,
    /// Most iterations.
    pub max_iterations: u32,
}

/// What to do after an iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    Converged,
    Continue,
    /// No better for several iterations, but only for rounding: the residual is small, and the last
    /// correction has done no work to speak of.
    AtRounding,
    /// Not a number, far worse than at the start, or no better for several iterations.
    GiveUp,
}

/// Iterations without a new best residual after which there is no hope.
const PATIENCE: usize = 5;
/// Growth of the residual over its first value that counts as divergence.
const BLOWN_UP: f64 = 1e6;

/// Residual, over the scale of the forces, below which rounding may be what is left.
const SMALL: f64 = 1e-7;
/// Energy of a correction over the largest one, below which it is rounding.
const NO_WORK: f64 = 1e-18;

/// The residuals of one step.
#[derive(Clone, Debug)]
pub struct Convergence {
    tolerances: Tolerances,
    history: Vec<f64>,
    /// Largest scale of the step.
    scale: f64,
    best: (usize, f64),
    /// |delta . r| of the last correction, and the largest (kJ/m).
    energy: (f64, f64),
}

impl Convergence {
    /// For steps with these tolerances.
    pub fn new(tolerances: Tolerances) -> Self {
        let history = Vec::with_capacity(tolerances.max_iterations as usize + 2);
        Convergence { tolerances, history, scale: 0.0, best: (0, f64::INFINITY), energy: (f64::INFINITY, 0.0) }
    }

    /// Forgets the last step.
    pub fn begin(&mut self) {
        self.history.clear();
        self.scale = 0.0;
        self.best = (0, f64::INFINITY);
        self.energy = (f64::INFINITY, 0.0);
    }

    /// Notes a residual and the scale of the forces that should balance.
    pub fn note(&mut self, residual: f64, scale: f64) -> Verdict {
        let k = self.history.len();
        self.history.push(residual);
        self.scale = self.scale.max(scale);
        if residual <= (self.tolerances.relative * scale).max(self.tolerances.absolute) {
            return Verdict::Converged;
        }
        if residual < self.best.1 {
            self.best = (k, residual);
        }
        let first = self.history[0].max(scale);
        let hopeless = !residual.is_finite() || residual > BLOWN_UP * first || k - self.best.0 >= PATIENCE;
        let idle = self.energy.0 <= NO_WORK * self.energy.1 && residual <= SMALL * scale;
        if idle && k > self.best.0 {
            return Verdict::AtRounding;
        }
        if hopeless || self.is_spent() { Verdict::GiveUp } else { Verdict::Continue }
    }

    /// Notes the energy norm of a correction, |delta . r| (kJ/m).
    pub fn note_energy(&mut self, energy: f64) {
        self.energy = (energy, self.energy.1.max(energy));
    }

    /// Energy norm of the last correction over the largest of the step; `None` before one.
    pub fn energy_ratio(&self) -> Option<f64> {
        (self.energy.1 > 0.0).then(|| self.energy.0 / self.energy.1)
    }

    /// The equations have changed, as a contact has: residuals before and after do not compare.
    pub fn change_equations(&mut self) {
        self.best = (self.history.len(), f64::INFINITY);
    }

    /// Whether the iterations allowed are used up.
    pub fn is_spent(&self) -> bool {
        self.iterations() >= self.tolerances.max_iterations
    }

    /// Iterations done: residuals noted after the first.
    pub fn iterations(&self) -> u32 {
        self.history.len().saturating_sub(1) as u32
    }

    /// The last residual.
    pub fn residual(&self) -> f64 {
        self.history.last().copied().unwrap_or(0.0)
    }

    /// Order of convergence ln(r2 / r1) / ln(r1 / r0) from the last three residuals above
    /// `floor` x scale; `None` with fewer.
    pub fn order(&self, floor: f64) -> Option<f64> {
        observed_order(&self.history, floor * self.scale)
    }
}

/// As [`Convergence::order`], for any sequence and `floor` itself.
pub fn observed_order(residuals: &[f64], floor: f64) -> Option<f64> {
    let above = residuals.iter().take_while(|r| **r > floor).count();
    let [a, b, c] = residuals.get(above.checked_sub(3)?..above)? else { return None };
    (b < a && c < b).then(|| (c / b).ln() / (b / a).ln())
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOLERANCES: Tolerances = Tolerances { relative: 1e-9, absolute: 0.0, max_iterations: 12 };

    #[test]
    fn quadratic_convergence_is_seen() {
        let mut c = Convergence::new(TOLERANCES);
        let verdicts: Vec<_> = [1.0, 1e-2, 1e-4, 1e-8, 1e-16].map(|r| c.note(r, 1.0)).to_vec();
        assert_eq!(verdicts.last(), Some(&Verdict::Converged));
        assert_eq!(c.iterations(), 4);
        assert!((c.order(1e-12).unwrap() - 2.0).abs() < 1e-12);
    }

    #[test]
    fn rounding_is_not_divergence() {
        let verdicts = |energies: [f64; 4]| {
            let mut c = Convergence::new(TOLERANCES);
            let residuals = [1.0, 1e-4, 4e-9, 5e-9];
            let note = |(r, e)| {
                let verdict = c.note(r, 1.0);
                c.note_energy(e);
                verdict
            };
            residuals.into_iter().zip(energies).map(note).last()
        };
        assert_eq!(verdicts([1.0, 1e-8, 1e-19, 1e-19]), Some(Verdict::AtRounding));
        assert_eq!(verdicts([1.0, 1e-8, 1e-12, 1e-12]), Some(Verdict::Continue));
    }

    #[test]
    fn hopeless_iterations_end_early() {
        let run = |f: &dyn Fn(usize) -> f64| {
            let mut c = Convergence::new(Tolerances { max_iterations: 50, ..TOLERANCES });
            (0..60).find(|&k| c.note(f(k), 1.0) == Verdict::GiveUp)
        };
        assert_eq!(run(&|k| if k < 3 { 1.0 / (k + 1) as f64 } else { 0.5 }), Some(7));
        assert_eq!(run(&|k| if k == 2 { f64::NAN } else { 0.5 }), Some(2));
        assert_eq!(run(&|k| 0.9f64.powi(k as i32)), Some(50));
    }
}
