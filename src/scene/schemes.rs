//! Settings of the integrators.

use crate::{
    body::Body,
    case::{self, Case},
    effect::TimeScheme,
    math::{
        linear::{Options, Ordering, Symmetric, Unsymmetric},
        newton::Tolerances,
    },
    step::{
        control::{Control, Pace},
        explicit::{self, StressUpdate},
        implicit::{self, Regime},
    },
    transfer::Transfer,
};

/// Of the explicit scheme.
pub fn explicit(case: &Case) -> explicit::Settings {
    let e = &case.explicit;
    explicit::Settings {
        stress_update: match e.stress_update {
            case::StressUpdate::Musl => StressUpdate::Musl,
            case::StressUpdate::Usl => StressUpdate::Usl,
        },
        transfer: transfer(case, e.pic_rate),
        courant: e.courant,
        mass_floor: e.mass_floor,
        smooth: case.solver.locking == case::Locking::BBar,
    }
}

/// The transfer, with the rate of PIC of the scheme (1/s): 0 where the case has none.
fn transfer(case: &Case, pic_rate: Option<f64>) -> Transfer {
    match case.solver.transfer {
        case::Transfer::Flip => Transfer::Flip { pic_rate: pic_rate.unwrap_or(0.0) },
        case::Transfer::Apic => Transfer::Apic,
        case::Transfer::Xpic { xpic_order } => Transfer::Xpic { order: xpic_order },
    }
}

/// Share of the weight of the body below which nothing is out of balance.
const NOTHING: f64 = 1e-13;

/// Of the implicit scheme.
pub fn implicit(case: &Case, body: &Body) -> implicit::Settings {
    let i = &case.implicit;
    let weight = body.total_mass() * case.gravity.acceleration;
    implicit::Settings {
        regime: regime(i.regime),
        tolerances: Tolerances {
            relative: i.residual,
            absolute: i.absolute_residual.unwrap_or(NOTHING * weight),
            max_iterations: i.max_iterations as u32,
        },
        line_search: i.line_search,
        min_time_step: i.min_time_step,
        smooth: case.solver.locking == case::Locking::BBar,
        tolerance: i.tolerance,
        transfer: transfer(case, i.pic_rate),
        solver: Options {
            ordering: match i.ordering {
                case::Ordering::Auto => Ordering::Auto,
                case::Ordering::Amd => Ordering::Amd,
                case::Ordering::NestedDissection => Ordering::NestedDissection,
            },
            symmetric: match i.symmetric {
                case::Symmetric::Auto => Symmetric::Auto,
                case::Symmetric::Direct => Symmetric::Direct,
                case::Symmetric::Pcg => Symmetric::Pcg,
            },
            unsymmetric: match i.unsymmetric {
                case::Unsymmetric::Auto => Unsymmetric::Auto,
                case::Unsymmetric::Lu => Unsymmetric::Lu,
                case::Unsymmetric::Gmres => Unsymmetric::Gmres,
            },
            ..Options::default()
        },
    }
}

fn regime(regime: case::Regime) -> Regime {
    match regime {
        case::Regime::Auto { inertia } => Regime::Auto(time_scheme(inertia)),
        case::Regime::QuasiStatic => Regime::QuasiStatic,
        case::Regime::Newmark => Regime::Dynamic(TimeScheme::Newmark),
        case::Regime::Hht { hht_alpha: alpha } => Regime::Dynamic(TimeScheme::Hht { alpha }),
        case::Regime::BackwardEuler => Regime::Dynamic(TimeScheme::BackwardEuler),
    }
}

fn time_scheme(inertia: case::Inertia) -> TimeScheme {
    match inertia {
        case::Inertia::Newmark => TimeScheme::Newmark,
        case::Inertia::BackwardEuler => TimeScheme::BackwardEuler,
        case::Inertia::Hht { hht_alpha: alpha } => TimeScheme::Hht { alpha },
    }
}

/// Steps of the implicit scheme.
pub fn control(i: &case::Implicit) -> Control {
    Control::with_pace(Pace { first: i.time_step, min: i.min_time_step, max: i.max_time_step })
}
