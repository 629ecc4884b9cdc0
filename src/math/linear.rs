//! Systems of equations over a [`Pattern`]: the choice of method, the checks, the fallbacks.
//!
//! A symmetric system in which inertia prevails goes to conjugate gradients first (`inertia.rs`); else it is tried by L L^T, by L B L^T if that meets a pivot that is not positive, and
//! by LU. An unsymmetric one goes to LU at once, or first to GMRES with the L L^T of its symmetric
//! part as preconditioner, if that is asked for and the part has such a factor. Every solution is checked; what is
//! off is refined once, and what stays off goes to the next method. All is done by one thread in a fixed order: equal
//! systems give equal bits.

mod choices;
mod condition;
mod fronts;
mod gmres;
mod gradients;
mod incomplete;
mod indefinite;
mod inertia;
mod lu;
mod memory;
#[cfg(test)]
mod tests;
mod vector;

use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};

pub use self::choices::{Method, Options, Ordering, Solution, Symmetric, Unsymmetric};
use self::{
    fronts::Fronts,
    gmres::Gmres,
    gradients::Gradients,
    incomplete::Incomplete,
    indefinite::Indefinite,
    lu::Lu,
    vector::{add_multiple, finite, norm},
};
use super::{ordering, sparse::Pattern};
use crate::{
    fault::{Fault, FaultKind},
    work::Work,
};

/// Relative residual above which a solution is refined once.
const REFINE: f64 = 1e-10;

/// Most iterations of conjugate gradients where they are asked for: about what L L^T costs with 130,000 cells, ten times.
const MOST: usize = 200;

/// Neighbouring supernodes become one if they have at most so many columns together, of which at
/// most this part is zeros. Wider than the default: 5 to 10 % faster from 1,800 to 32,000 cells.
const RELAX: &[(usize, f64)] = &[(8, 1.0), (24, 0.8), (64, 0.2), (usize::MAX, 0.05)];

/// A system on its way through the methods.
#[derive(Clone, Copy)]
struct System<'a> {
    pattern: &'a Pattern,
    values: &'a [f64],
    rhs: &'a [f64],
}

/// What the methods have found so far.
struct Trial {
    /// Whether what was factored has positive pivots: the matrix, or its symmetric part.
    positive: Option<bool>,
    iterations: u32,
    /// Smallest residual of those that were not accepted.
    residual: f64,
}

/// Solves systems; keeps symbolic factors while the structure stays, and all buffers.
#[derive(Default)]
pub struct Solver {
    options: Options,
    /// Structure that the symbolic factors are of.
    structure: Option<(u64, SymbolicSparseColMat<u32>)>,
    positive: Fronts,
    indefinite: Indefinite,
    lu: Lu,
    gmres: Gmres,
    incomplete: Incomplete,
    gradients: Gradients,
    /// Values of (A + A^T) / 2 or of A^T.
    other: Vec<f64>,
    residual: Vec<f64>,
    correction: Vec<f64>,
    /// Whether symmetric systems are to be factored in any case.
    pivots: bool,
    /// Factor that was made last.
    last: Option<Method>,
}

impl Solver {
    /// A solver without factors.
    pub fn new(options: Options) -> Self {
        Solver { options, ..Solver::default() }
    }

    /// Whether the sign of the pivots is wanted: then a symmetric system is factored, whatever the options say.
    pub fn want_pivots(&mut self, wanted: bool) {
        self.pivots = wanted;
    }

    /// Symbolic factors are made anew when next needed. A changed structure is noticed without this.
    pub fn forget(&mut self) {
        self.structure = None;
        self.last = None;
        self.positive.forget();
        self.indefinite.forget();
        self.incomplete.forget();
        self.lu.forget();
    }

    /// Solves A x = rhs, where A has `values` in the order of `pattern`, and counts what it did in `work`.
    ///
    /// `symmetric` promises that A is; only its lower triangle is factored then. The bits of `x` depend
    /// on the options and the system alone.
    ///
    /// # Errors
    /// `NonFinite` if a value is not a number, `Singular` if no method came to `max_residual`, or if
    /// the lengths do not fit; `x` is not to be used then.
    pub fn solve(
        &mut self,
        pattern: &Pattern,
        values: &[f64],
        symmetric: bool,
        rhs: &[f64],
        x: &mut [f64],
        work: &mut Work,
    ) -> Result<Solution, Fault> {
        let system = System { pattern, values, rhs };
        check(system, x.len())?;
        work.solves += 1;
        let methods = self.methods(system, symmetric);
        if rhs.iter().all(|b| *b == 0.0) {
            x.fill(0.0);
            return Ok(Solution { method: methods[0], residual: 0.0, positive: None, iterations: 0, fallback: false });
        }
        self.adopt(pattern);
        let mut trial = Trial { positive: None, iterations: 0, residual: f64::INFINITY };
        for (turn, &method) in methods.iter().enumerate() {
            let Some(residual) = self.attempt(method, system, x, &mut trial, work) else { continue };
            if residual <= self.options.max_residual {
                work.fallback_solves += u64::from(turn > 0);
                work.max_solve_residual = work.max_solve_residual.max(residual);
                let Trial { positive, iterations, .. } = trial;
                // the symmetric part of an unsymmetric matrix is a help to GMRES, and says nothing of the matrix
                let positive = positive.filter(|_| symmetric);
                return Ok(Solution { method, residual, positive, iterations, fallback: turn > 0 });
            }
            trial.residual = trial.residual.min(residual);
        }
        Err(Fault::new(FaultKind::Singular)
            .with("residual", trial.residual)
            .with("allowed", self.options.max_residual)
            .with("unknowns", x.len() as f64))
    }

    /// Solves A x = rhs for another right side with the factor that was made last, and returns the
    /// relative residual. After GMRES that is the factor of the symmetric part. `None` without a factor, as after
    /// conjugate gradients.
    pub fn solve_again(&mut self, pattern: &Pattern, values: &[f64], rhs: &[f64], x: &mut [f64]) -> Option<f64> {
        let system = System { pattern, values, rhs };
        check(system, x.len()).ok()?;
        if !self.knows(pattern) {
            return None;
        }
        x.copy_from_slice(rhs);
        self.apply(x, false)?;
        Some(self.refined(system, x))
    }

    fn methods(&self, system: System<'_>, symmetric: bool) -> &'static [Method] {
        const SYMMETRIC: &[Method] = &[Method::Pcg, Method::Llt, Method::Ldlt, Method::Lu];
        match (symmetric, self.options.unsymmetric) {
            (true, _) if self.iterations(system).is_some() => SYMMETRIC,
            (true, _) => &SYMMETRIC[1..],
            (false, Unsymmetric::Auto | Unsymmetric::Lu) => &[Method::Lu],
            (false, Unsymmetric::Gmres) => &[Method::Gmres, Method::Lu],
        }
    }

    /// Most iterations of conjugate gradients, if a symmetric system is to be solved by these.
    fn iterations(&self, system: System<'_>) -> Option<usize> {
        match self.options.symmetric {
            _ if self.pivots => None,
            Symmetric::Direct => None,
            Symmetric::Pcg => Some(MOST),
            Symmetric::Auto => inertia::iterations(system.pattern, system.values),
        }
    }

    /// Whether the symbolic factors are of this structure.
    fn knows(&self, pattern: &Pattern) -> bool {
        self.structure.as_ref().is_some_and(|(made_of, _)| *made_of == pattern.fingerprint())
    }

    /// Drops the symbolic factors of another structure.
    fn adopt(&mut self, pattern: &Pattern) {
        if self.knows(pattern) {
            return;
        }
        self.forget();
        let (n, pointers, rows) = (pattern.dim(), pattern.col_ptr().to_vec(), pattern.row_idx().to_vec());
        let structure = SymbolicSparseColMat::new_checked(n, n, pointers, None, rows);
        self.structure = Some((pattern.fingerprint(), structure));
        self.residual.resize(n, 0.0);
        self.correction.resize(n, 0.0);
    }

    /// One method: relative residual of its solution in `x`, or `None` where it has none.
    fn attempt(
        &mut self,
        method: Method,
        system: System<'_>,
        x: &mut [f64],
        trial: &mut Trial,
        work: &mut Work,
    ) -> Option<f64> {
        if method == Method::Pcg {
            return self.descend(system, x, trial, work);
        }
        // what is not positive definite has already been found out
        if method == Method::Ldlt && trial.positive == Some(true) {
            return None;
        }
        self.factor(method, system, trial, work)?;
        if method == Method::Gmres {
            return self.iterate(system, x, trial, work);
        }
        if method == Method::Llt {
            self.positive.finish(x)?;
        } else {
            x.copy_from_slice(system.rhs);
            self.apply(x, false)?;
        }
        Some(self.refined(system, x))
    }

    /// Numeric factor for a method, and the symbolic one if there is none yet.
    fn factor(&mut self, method: Method, system: System<'_>, trial: &mut Trial, work: &mut Work) -> Option<()> {
        self.last = None;
        let made = match method {
            Method::Pcg => None,
            Method::Lu => self.factor_unsymmetric(system, work).map(|()| Method::Lu),
            Method::Ldlt => self.factor_indefinite(system, work).map(|()| Method::Ldlt),
            Method::Llt | Method::Gmres => {
                let made = self.factor_positive(method, system, work);
                trial.positive = Some(made.is_some());
                made.map(|()| Method::Llt)
            }
        };
        self.last = made;
        made.map(|_| ())
    }

    fn factor_unsymmetric(&mut self, system: System<'_>, work: &mut Work) -> Option<()> {
        let System { pattern, values, .. } = system;
        let structure = self.structure.as_ref()?.1.as_ref();
        if !self.lu.is_prepared() {
            self.lu.prepare(structure, &ordering::column_dissection(pattern))?;
            work.symbolic_factorisations += 1;
        }
        work.factorisations += 1;
        work.lu_factorisations += 1;
        self.other.resize(values.len(), 0.0);
        pattern.transposed(values, &mut self.other);
        self.lu.factor(SparseColMatRef::new(structure, values), SparseColMatRef::new(structure, &self.other))
    }

    fn factor_indefinite(&mut self, system: System<'_>, work: &mut Work) -> Option<()> {
        let structure = self.structure.as_ref()?.1.as_ref();
        if !self.indefinite.is_prepared() {
            self.indefinite.prepare(structure, &order(self.options.ordering, system.pattern)?)?;
            work.symbolic_factorisations += 1;
        }
        work.factorisations += 1;
        self.indefinite.factor(SparseColMatRef::new(structure, system.values))
    }

    /// L L^T of the matrix, or for GMRES of its symmetric part.
    fn factor_positive(&mut self, method: Method, system: System<'_>, work: &mut Work) -> Option<()> {
        let System { pattern, values, rhs } = system;
        if !self.positive.is_prepared() {
            self.positive.prepare(pattern, &order(self.options.ordering, pattern)?);
            work.symbolic_factorisations += 1;
        }
        work.factorisations += 1;
        if method == Method::Gmres {
            self.other.resize(values.len(), 0.0);
            pattern.symmetric_part(values, &mut self.other);
            return self.positive.factor(&self.other, rhs);
        }
        self.positive.factor(values, rhs)
    }

    /// GMRES with the factor of the symmetric part.
    fn iterate(&mut self, system: System<'_>, x: &mut [f64], trial: &mut Trial, work: &mut Work) -> Option<f64> {
        let System { pattern, values, rhs } = system;
        let positive = &mut self.positive;
        let ended = self.gmres.solve(
            rhs,
            x,
            REFINE,
            |x, y| pattern.multiply(values, x, y),
            |x| {
                if positive.solve(x).is_none() {
                    x.fill(f64::NAN);
                }
            },
        );
        trial.iterations += ended.iterations;
        work.gmres_iterations += ended.iterations as u64;
        ended.converged.then(|| self.residual(system, x))
    }

    /// Conjugate gradients with an incomplete factor.
    fn descend(&mut self, system: System<'_>, x: &mut [f64], trial: &mut Trial, work: &mut Work) -> Option<f64> {
        let System { pattern, values, rhs } = system;
        let most = self.iterations(system)?;
        self.last = None;
        self.incomplete.factor(pattern, values)?;
        let Solver { incomplete, gradients, .. } = self;
        let multiply = |x: &[f64], y: &mut [f64]| pattern.multiply(values, x, y);
        let ended = gradients.solve(rhs, x, (REFINE, most), multiply, |x| incomplete.solve(x));
        trial.iterations += ended.iterations;
        work.pcg_iterations += u64::from(ended.iterations);
        self.last = ended.converged.then_some(Method::Pcg);
        ended.converged.then(|| self.residual(system, x))
    }

    /// Relative residual of `x`, after one step of refinement if that is called for and helps.
    fn refined(&mut self, system: System<'_>, x: &mut [f64]) -> f64 {
        let before = self.residual(system, x);
        if !before.is_finite() || before <= REFINE {
            return before;
        }
        let mut correction = std::mem::take(&mut self.correction);
        correction.copy_from_slice(&self.residual);
        let mut reached = before;
        if self.apply(&mut correction, false).is_some() {
            add_multiple(x, 1.0, &correction);
            reached = self.residual(system, x);
            if reached.is_nan() || reached > before {
                add_multiple(x, -1.0, &correction);
                reached = self.residual(system, x);
            }
        }
        self.correction = correction;
        reached
    }

    /// |b - A x| / |b|, with the residual left in its buffer. Not finite if `x` is not.
    fn residual(&mut self, system: System<'_>, x: &[f64]) -> f64 {
        system.pattern.multiply(system.values, x, &mut self.residual);
        self.residual.iter_mut().zip(system.rhs).for_each(|(r, b)| *r = b - *r);
        norm(&self.residual) / norm(system.rhs)
    }

    /// Overwrites `x` with A^-1 x, or A^-T x, by the last factor.
    fn apply(&mut self, x: &mut [f64], transposed: bool) -> Option<()> {
        match self.last? {
            Method::Lu => self.lu.solve(x, transposed),
            Method::Ldlt => self.indefinite.solve(x),
            Method::Llt | Method::Gmres => self.positive.solve(x),
            Method::Pcg => None,
        }
    }

    /// Cheap estimate of the condition number |A| |A^-1| in the 1-norm, from the last factor and at
    /// most a dozen solves; after GMRES, that of the symmetric part. Infinite without a factor.
    pub fn condition(&mut self, pattern: &Pattern, values: &[f64]) -> f64 {
        if !self.knows(pattern) || values.len() != pattern.len() {
            return f64::INFINITY;
        }
        if self.last == Some(Method::Pcg) {
            let (rhs, mut trial) = (vec![0.0; pattern.dim()], Trial { positive: None, iterations: 0, residual: 0.0 });
            self.factor(Method::Llt, System { pattern, values, rhs: &rhs }, &mut trial, &mut Work::default());
        }
        if self.last.is_none() {
            return f64::INFINITY;
        }
        let columns = pattern.col_ptr().windows(2).map(|c| &values[c[0] as usize..c[1] as usize]);
        let size = columns.map(vector::sum_abs).fold(0.0, f64::max);
        size * condition::inverse_norm(pattern.dim(), |x, transposed| self.apply(x, transposed))
    }

    /// Values that L L^T is stored in, with what pads its blocks.
    pub fn fill(&self) -> usize {
        self.positive.fill()
    }

    /// Bytes of the factors, their workspace and the buffers, without the numeric LU.
    pub fn bytes(&self) -> usize {
        let structure = self.structure.as_ref().map_or(0, |(_, s)| 4 * (s.col_ptr().len() + s.row_idx().len()));
        let buffers = [&self.other, &self.residual, &self.correction].map(Vec::capacity);
        let factors = self.positive.bytes() + self.indefinite.bytes() + self.lu.bytes();
        let iterations = self.gmres.bytes() + self.gradients.bytes() + self.incomplete.bytes();
        structure + 8 * buffers.iter().sum::<usize>() + factors + iterations
    }
}

/// Lengths fit and numbers are numbers.
fn check(system: System<'_>, unknowns: usize) -> Result<(), Fault> {
    let System { pattern, values, rhs } = system;
    let (n, len) = (pattern.dim(), pattern.len());
    if values.len() != len || rhs.len() != n || unknowns != n {
        let lengths = [("rows", n), ("values", values.len()), ("expected", len), ("rhs", rhs.len()), ("x", unknowns)];
        let fault = Fault::new(FaultKind::Singular);
        return Err(lengths.iter().fold(fault, |f, &(name, length)| f.with(name, length as f64)));
    }
    if finite(values) && finite(rhs) {
        return Ok(());
    }
    let bad = |a: &[f64]| a.iter().filter(|v| !v.is_finite()).count() as f64;
    Err(Fault::new(FaultKind::NonFinite).with("matrix_values", bad(values)).with("rhs_values", bad(rhs)))
}

/// Order of elimination of the nodes.
fn order(ordering: Ordering, pattern: &Pattern) -> Option<Vec<u32>> {
    if ordering == Ordering::Amd {
        ordering::minimum_degree(pattern)
    } else {
        Some(ordering::nested_dissection(pattern))
    }
}
