//! What can be chosen of a solver, and what it says of a solution.

/// How the unknowns of a symmetric matrix are ordered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ordering {
    /// Nested dissection: factor and solve took 0.81 to 1.04 times as long as by minimum degree for 1,800
    /// to 130,000 cells, the symbolic part 0.64 to 0.89 times (`benches/README.md`).
    #[default]
    Auto,
    /// Approximate minimum degree.
    Amd,
    /// Nested dissection along grid lines.
    NestedDissection,
}

/// How a symmetric system is solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Symmetric {
    /// Conjugate gradients where inertia outweighs stiffness so far that they are expected to take few iterations, L L^T
    /// else (`linear::inertia`).
    #[default]
    Auto,
    /// L L^T.
    Direct,
    /// Conjugate gradients, then L L^T.
    Pcg,
}

/// How an unsymmetric system is solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Unsymmetric {
    /// LU. Where all nodes of a base slip, the symmetric part is not positive definite and GMRES is of
    /// no use; with yielding cells it took 0.9 to 1.8 times as long (`benches/README.md`).
    #[default]
    Auto,
    /// LU only.
    Lu,
    /// GMRES, then LU.
    Gmres,
}

/// Choices of a solver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Order of elimination for symmetric factors.
    pub ordering: Ordering,
    /// Method for symmetric systems.
    pub symmetric: Symmetric,
    /// Method for unsymmetric systems.
    pub unsymmetric: Unsymmetric,
    /// Largest |b - A x| / |b| (Euclidean) of a solution that is accepted.
    pub max_residual: f64,
}

impl Default for Options {
    fn default() -> Self {
        let (symmetric, unsymmetric) = (Symmetric::Auto, Unsymmetric::Auto);
        Options { ordering: Ordering::Auto, symmetric, unsymmetric, max_residual: 1e-8 }
    }
}

/// A way to solve a system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// L L^T, for symmetric positive definite matrices.
    Llt,
    /// L B L^T, for symmetric indefinite ones.
    Ldlt,
    /// P A Q = L U.
    Lu,
    /// GMRES with the L L^T of (A + A^T) / 2 as preconditioner.
    Gmres,
    /// Conjugate gradients with an incomplete L L^T as preconditioner.
    Pcg,
}

/// What is said of a solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution {
    /// The method that gave it.
    pub method: Method,
    /// |b - A x| / |b| (Euclidean).
    pub residual: f64,
    /// Whether a symmetric matrix is positive definite; `None` for an unsymmetric one, or where it was not tried: conjugate
    /// gradients that converge have met no direction along which it is not, which is no proof.
    /// An unsymmetric tangent may lose its symmetric part's definiteness long before it becomes singular, so
    /// that part is no sign of lost stability, whichever method solves.
    pub positive: Option<bool>,
    /// Iterations of GMRES or of conjugate gradients.
    pub iterations: u32,
    /// Whether a method failed before this one.
    pub fallback: bool,
}
