//! The counters of a run: what was done, independent of any clock.

use serde::{Deserialize, Serialize};

/// Exact counters of the work a run has done. They are deterministic and go to `record.json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Work {
    /// Material points in the body.
    pub points: u64,
    /// Grid cells that held at least one point at the start.
    pub cells: u64,
    /// Accepted time steps.
    pub steps: u64,
    /// Steps that were refused and left the body untouched.
    pub rejected_steps: u64,
    /// Material points moved, summed over the accepted steps.
    pub particle_steps: u64,
    /// Newton iterations (implicit scheme; 0 in the explicit scheme).
    pub newton_iterations: u64,
    /// Steps accepted at the floor of rounding, with a residual above the one asked for.
    pub rounding_accepts: u64,
    /// Contacts that changed state too often in a step and were left as they were, summed over the steps.
    pub frozen_contacts: u64,
    /// Evaluations by which a line search shortened an iteration.
    pub line_searches: u64,
    /// Times the structure of the equations was made anew.
    pub patterns: u64,
    /// Times a structure was kept that holds more than the step needs.
    pub patterns_reused: u64,
    /// Numeric factorisations of a sparse matrix.
    pub factorisations: u64,
    /// Of these, unsymmetric ones (LU).
    pub lu_factorisations: u64,
    /// Symbolic factorisations of a sparse matrix.
    pub symbolic_factorisations: u64,
    /// Systems of equations that were to be solved.
    pub solves: u64,
    /// Iterations of GMRES, each with one solve by a factor.
    pub gmres_iterations: u64,
    /// Iterations of conjugate gradients.
    pub pcg_iterations: u64,
    /// Linear solves that needed a fallback.
    pub fallback_solves: u64,
    /// Largest relative residual of any linear solve (0 in the explicit scheme, which solves none).
    pub max_solve_residual: f64,
    /// Blocks of points sent through the constitutive law.
    pub law_blocks: u64,
    /// Calls of a nodal effect, summed over effects and passes.
    pub effect_calls: u64,
    /// Times the points were put back in cell order.
    pub sorts: u64,
    /// Largest number of active nodes in any step.
    pub max_active_nodes: u64,
    /// Most points at one time with a domain longer than the shape functions take, which was
    /// therefore cut; looked at every 20 steps (0 with `linear`, which has no domains).
    pub domain_clamps: u64,
    /// Times the nodal arrays grew, i.e. the active nodes passed their high-water mark.
    pub node_growths: u64,
}
