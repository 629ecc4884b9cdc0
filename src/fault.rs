//! Numeric faults: what went wrong in a step, with its numbers.

use std::fmt;

use serde::Serialize;

/// What went wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FaultKind {
    /// det F of a step is not positive: a point was turned inside out.
    Inverted,
    /// A point reached a side of the grid.
    LeftGrid,
    /// A stress, velocity or position is not a number.
    NonFinite,
    /// A point would have moved by more than half a cell in one step.
    StepTooLong,
    /// A system of equations has no solution that can be trusted.
    Singular,
    /// Newton's iteration did not converge.
    NewtonDiverged,
    /// Equilibrium without inertia is not stable.
    Unstable,
    /// The local error of a step is far above what is allowed.
    Inaccurate,
    /// Energy has been made, or lost without a known cause.
    EnergyDrift,
}

impl FaultKind {
    /// Whether a body without equilibrium shows itself in this way: iterations that lead nowhere, far away, or
    /// through a point turned inside out.
    pub fn is_loss_of_balance(self) -> bool {
        use FaultKind::{Inverted, NewtonDiverged, Singular, StepTooLong};
        matches!(self, NewtonDiverged | Singular | StepTooLong | Inverted)
    }

    /// What went wrong, in words.
    pub fn what(self) -> &'static str {
        match self {
            FaultKind::Inverted => "a material point was turned inside out (det F <= 0)",
            FaultKind::LeftGrid => "a material point left the grid",
            FaultKind::NonFinite => "a quantity is no longer a finite number",
            FaultKind::StepTooLong => "a material point would move by more than half a cell in one step",
            FaultKind::Singular => "a system of equations has no solution that can be trusted (singular matrix)",
            FaultKind::NewtonDiverged => "Newton's iteration did not converge",
            FaultKind::Inaccurate => "the error of a step is larger than allowed",
            FaultKind::EnergyDrift => "the balance of energy does not hold",
            FaultKind::Unstable => "the body is in no stable equilibrium without inertia",
        }
    }
}

/// A fault in one step. The body is as it was before the step.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fault {
    pub kind: FaultKind,
    /// Step in which it appeared (the first step is 1).
    pub step: u64,
    /// Simulated time at the start of that step (s).
    pub time_s: f64,
    /// Identity of the material point, if one is to blame.
    pub point: Option<u32>,
    /// Grid node, if one is to blame.
    pub node: Option<u32>,
    /// Where the point was (m).
    pub x_m: Option<[f64; 2]>,
    /// The numbers that gave it away, by name. What is not finite is `null` in the record.
    pub values: Vec<(String, f64)>,
}

impl Fault {
    /// A fault of `kind` with no place yet; the integrator fills the rest in.
    pub fn new(kind: FaultKind) -> Self {
        Fault { kind, step: 0, time_s: 0.0, point: None, node: None, x_m: None, values: Vec::new() }
    }

    /// Adds a named number.
    pub fn with(mut self, name: &str, value: f64) -> Self {
        self.values.push((name.to_owned(), value));
        self
    }

    /// Names the point and its place.
    pub fn at(mut self, point: u32, x: [f64; 2]) -> Self {
        self.point = Some(point);
        self.x_m = Some(x);
        self
    }

    /// Whether a smaller step may cure it.
    pub fn curable(&self) -> bool {
        !matches!(self.kind, FaultKind::LeftGrid)
    }

    /// What the user can do, naming the key of the case file; `step_keys` are those that set the
    /// length of a step in the scheme that ran.
    pub fn advice(&self, step_keys: &str) -> String {
        let text = match self.kind {
            FaultKind::Inverted | FaultKind::NonFinite | FaultKind::StepTooLong => {
                return format!("lower {step_keys}, or bring the load on more slowly (`gravity.ramp_time`)");
            }
            FaultKind::LeftGrid => {
                return format!(
                    "enlarge `grid.size`, or put a support on that side (`boundary`); where a support stands already, the step is too long: lower {step_keys}"
                );
            }
            FaultKind::Singular => {
                "hold the body against every motion without strain (`boundary`), or bring the load on more slowly (`gravity.ramp_time`)"
            }
            FaultKind::NewtonDiverged => {
                "bring the load on in shorter steps (`implicit.time_step`, `implicit.min_time_step`); without inertia a body that fails has no equilibrium: `implicit.regime = \"auto\"` lets it move"
            }
            FaultKind::Inaccurate => {
                "allow a larger error (`implicit.tolerance`) or shorter steps (`implicit.min_time_step`)"
            }
            FaultKind::EnergyDrift => {
                return format!(
                    "lower {step_keys}; `solver.shape = \"gimp\"` spares the noise of points that cross cell faces, `explicit.stress_update = \"musl\"` that of light nodes; an initial stress must be one that the strength bears; `guard.fault` is the level"
                );
            }
            FaultKind::Unstable => "let the body move: `implicit.regime = \"auto\"`",
        };
        text.to_owned()
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let what = self.kind.what();
        write!(f, "{what}, in step {} at t = {:.4} s", self.step, self.time_s)?;
        if let Some(p) = self.point {
            write!(f, ", point {p}")?;
        }
        if let Some(x) = self.x_m {
            write!(f, " at ({:.3}, {:.3}) m", x[0], x[1])?;
        }
        for (name, value) in &self.values {
            write!(f, ", {name} = {value:.4e}")?;
        }
        Ok(())
    }
}

impl std::error::Error for Fault {}
