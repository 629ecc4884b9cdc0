//! Body and integrator behind one virtual call a step.

pub mod snapshot;
