//! Why each effect is on or off, and what it costs.

use serde::Serialize;

use super::{
    Scene,
    effects::{has_ghost, has_local_damping, sides},
    softening,
};
use crate::{
    body::Column,
    case::{self, Case, GravitySchedule, Regularisation},
    sim::Simulation,
};

/// One effect in the record.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EffectNote {
    pub name: String,
    pub on: bool,
    /// The key, or the fact of the scene, that decided it.
    pub why: String,
    /// Bytes moved for it, a point and step; 0 where it is off.
    #[serde(skip)]
    pub bytes_per_point: f64,
}

/// All effects of a case. `simulation` is read for what is stored.
pub fn list(case: &Case, simulation: &Simulation) -> Vec<EffectNote> {
    // nodal columns count per node; a slope has about one active node for its points per cell
    let node = 1.0 / (case.points.per_axis * case.points.per_axis) as f64;
    vec![
        inertia(case, node),
        finite_strain(case),
        plasticity(case),
        softening(case),
        regularisation(case),
        gravity(case, node),
        load(case),
        support(case),
        drive(case),
        friction(case),
        local_damping(case, node),
        viscous_damping(case, node),
        random_strength(case, simulation),
        contact_separation(case),
        note(
            "output",
            true,
            format!(
                "output.history = {} s, output.frames = {} s: samples between steps",
                case.output.history, case.output.frames
            ),
            0.0,
        ),
        note("f_bar", false, "the cure for volumetric locking is solver.locking = \"b_bar\"".into(), 0.0),
        b_bar(case),
        ghost_penalty(case),
        shape(case),
        transfer(case, node),
        guard(case),
        probe(case),
    ]
}

fn note(name: &str, on: bool, why: String, bytes: f64) -> EffectNote {
    EffectNote { name: name.to_owned(), on, why, bytes_per_point: if on { bytes } else { 0.0 } }
}

fn inertia(case: &Case, node: f64) -> EffectNote {
    let regime = case.implicit.regime;
    match case.solver.scheme {
        case::Scheme::Explicit => {
            note("inertia", true, "solver.scheme = \"explicit\" integrates the equation of motion".into(), 80.0 * node)
        }
        case::Scheme::Implicit => {
            let why = format!("implicit.regime = \"{}\"", regime.word());
            note("inertia", regime.inertia().is_some(), why, 80.0 * node)
        }
    }
}

fn b_bar(case: &Case) -> EffectNote {
    match case.solver.locking {
        case::Locking::None => note("b_bar", false, "solver.locking = \"none\"".into(), 0.0),
        case::Locking::BBar => {
            note("b_bar", true, "solver.locking = \"b_bar\": mean dilatation over each cell".into(), 32.0)
        }
    }
}

/// Half-lengths and stretches of the domains are columns of both states.
fn shape(case: &Case) -> EffectNote {
    let shape = case.solver.shape;
    let bytes = if matches!(shape, case::ShapeFunctions::Gimp | case::ShapeFunctions::GimpWide) { 64.0 } else { 0.0 };
    let why = format!("solver.shape = \"{}\"", shape.word());
    note("wider_shape", shape != case::ShapeFunctions::Linear, why, bytes)
}

fn transfer(case: &Case, node: f64) -> EffectNote {
    match case.solver.transfer {
        case::Transfer::Flip => note("transfer", false, "solver.transfer = \"flip\": velocities alone".into(), 0.0),
        case::Transfer::Apic => {
            note("transfer", true, "solver.transfer = \"apic\": points carry a velocity gradient".into(), 64.0)
        }
        case::Transfer::Xpic { xpic_order } => {
            let why = format!("solver.transfer = \"xpic\": {} maps more a step", xpic_order - 1);
            note("transfer", xpic_order > 1, why, 32.0 * node * f64::from(xpic_order - 1))
        }
    }
}

fn guard(case: &Case) -> EffectNote {
    let level = |level: Option<f64>| level.map_or("false".to_owned(), |v| v.to_string());
    let g = &case.guard;
    let why = format!("guard.warning = {}, guard.fault = {}", level(g.warning), level(g.fault));
    note("guard", g.warning.or(g.fault).is_some(), why, 0.0)
}

fn probe(case: &Case) -> EffectNote {
    match case.probe.len() {
        0 => note("probe", false, "there is no [[probe]]".into(), 0.0),
        n => note("probe", true, format!("{n} read at the end"), 0.0),
    }
}

fn ghost_penalty(case: &Case) -> EffectNote {
    let i = &case.implicit;
    match case.solver.scheme {
        case::Scheme::Explicit => {
            note("ghost_penalty", false, "a remedy of the implicit scheme; MUSL needs none".into(), 0.0)
        }
        case::Scheme::Implicit => {
            let why =
                format!("implicit.ghost_stiffness = {}, implicit.ghost_mass = {}", i.ghost_stiffness, i.ghost_mass);
            note("ghost_penalty", has_ghost(case), why, 0.0)
        }
    }
}

fn finite_strain(case: &Case) -> EffectNote {
    match case.solver.kinematics {
        case::Kinematics::Hencky => {
            note("finite_strain", true, "solver.kinematics = \"hencky\": logarithmic strain".into(), 16.0)
        }
        case::Kinematics::Rate => {
            note("finite_strain", true, "solver.kinematics = \"rate\": Jaumann rate of the Cauchy stress".into(), 16.0)
        }
        case::Kinematics::Small => note("finite_strain", false, "solver.kinematics = \"small\"".into(), 0.0),
    }
}

fn strong(case: &Case) -> Vec<(&String, &case::Strength)> {
    case.material
        .iter()
        .filter_map(|(name, m)| match m {
            case::Material::VonMises { strength, .. } => Some((name, strength)),
            case::Material::Elastic { .. } => None,
        })
        .collect()
}

fn plasticity(case: &Case) -> EffectNote {
    match strong(case).first() {
        Some((name, _)) => note("plasticity", true, format!("material.{name}.law = \"von_mises\""), 16.0),
        None => note("plasticity", false, "every material is elastic".into(), 0.0),
    }
}

fn softening(case: &Case) -> EffectNote {
    match strong(case).iter().find(|(_, s)| s.softening_modulus != 0.0) {
        Some((name, s)) => {
            note("softening", true, format!("material.{name}.softening_modulus = {}", s.softening_modulus), 0.0)
        }
        None => note("softening", false, "no material softens".into(), 0.0),
    }
}

fn regularisation(case: &Case) -> EffectNote {
    let soft = strong(case).into_iter().filter(|(_, s)| s.softening_modulus != 0.0);
    let regular = soft.clone().find(|(_, s)| s.regularisation != Regularisation::None);
    let Some((name, s)) = regular else {
        let why = if soft.count() == 0 { "no material softens" } else { "no material has a `regularisation`" };
        return note("regularisation", false, why.into(), 0.0);
    };
    match s.regularisation {
        Regularisation::FractureEnergy { reference_length: l } => {
            let modulus = softening::factor(case, s) * s.softening_modulus;
            let why = format!(
                "material.{name}.regularisation = \"fracture_energy\": H = {modulus:.4} kPa for cells of {} m and reference_length = {l} m",
                case.grid.cell
            );
            note("regularisation", true, why, 0.0)
        }
        Regularisation::Nonlocal { reference_length: l, nonlocal_weight: m } => {
            let why = format!(
                "material.{name}.regularisation = \"nonlocal\": softening follows an average over reference_length = {l} m with m = {m}"
            );
            // kappa in both states, strain and volume twice a step, and the columns of the nodes
            note("regularisation", true, why, 48.0)
        }
        Regularisation::None => note("regularisation", false, String::new(), 0.0),
    }
}

fn gravity(case: &Case, node: f64) -> EffectNote {
    let why = match case.gravity.schedule {
        GravitySchedule::None => return note("gravity", false, "gravity.schedule = \"none\"".into(), 0.0),
        GravitySchedule::AtOnce => "gravity.schedule = \"at_once\"",
        GravitySchedule::Ramp { .. } => "gravity.schedule = \"ramp\"",
        GravitySchedule::NormalFirst { .. } => "gravity.schedule = \"normal_first\"",
        GravitySchedule::ElasticFirst { .. } => "gravity.schedule = \"elastic_first\"",
    };
    note("gravity", true, why.into(), 88.0 * node)
}

fn load(case: &Case) -> EffectNote {
    let each = |l: &case::Load| format!("load.{}.force = [{}, {}]", l.name, l.force[0], l.force[1]);
    let why: Vec<String> = case.load.iter().map(each).collect();
    match why.is_empty() {
        true => note("load", false, "there is no [[load]]".into(), 0.0),
        // a share and a force of two components, written and read, and the positions at both ends
        false => note("load", true, why.join(", "), 80.0),
    }
}

fn drive(case: &Case) -> EffectNote {
    let axis = |v: Option<f64>| v.map_or("free".to_owned(), |v| v.to_string());
    let each = |d: &case::Drive| format!("drive.{}: velocity {}, {}", d.name, axis(d.velocity_x), axis(d.velocity_y));
    let why: Vec<String> = case.drive.iter().map(each).collect();
    match why.is_empty() {
        true => note("drive", false, "there is no [[drive]]".into(), 0.0),
        false => note("drive", true, why.join(", "), 0.0),
    }
}

fn support(case: &Case) -> EffectNote {
    let held: Vec<_> = sides(case).filter(|(_, k)| matches!(k, case::Side::Roller | case::Side::Fixed)).collect();
    let names: Vec<String> = held.iter().map(|(s, _)| format!("boundary.{}", s.name())).collect();
    match names.is_empty() {
        true => note("support", false, "no side is a roller or fixed".into(), 0.0),
        false => note("support", true, names.join(", "), 0.0),
    }
}

fn friction(case: &Case) -> EffectNote {
    let side = sides(case).find_map(|(s, k)| match k {
        case::Side::Friction { coefficient, .. } => Some((s, coefficient)),
        _ => None,
    });
    match side {
        Some((s, c)) => note("friction", true, format!("boundary.{}.coefficient = {c}", s.name()), 0.0),
        None => note("friction", false, "no side is frictional".into(), 0.0),
    }
}

fn contact_separation(case: &Case) -> EffectNote {
    let open = sides(case).find(|(_, k)| matches!(k, case::Side::Friction { separation: true, .. }));
    match open {
        Some((s, _)) => note("contact_separation", true, format!("boundary.{}.separation = true", s.name()), 0.0),
        None => note("contact_separation", false, "no side lets the soil lift off".into(), 0.0),
    }
}

fn local_damping(case: &Case, node: f64) -> EffectNote {
    match (has_local_damping(case), case.damping.local > 0.0) {
        (true, true) => note("local_damping", true, format!("damping.local = {}", case.damping.local), 48.0 * node),
        (true, false) => {
            note("local_damping", true, "gravity.settle_damping, while the soil settles".into(), 48.0 * node)
        }
        _ if case.damping.local > 0.0 => note(
            "local_damping",
            false,
            "a remedy of the explicit scheme; the implicit one does not use it".into(),
            0.0,
        ),
        _ => note("local_damping", false, "damping.local = 0".into(), 0.0),
    }
}

fn viscous_damping(case: &Case, node: f64) -> EffectNote {
    let rate = case.damping.viscous;
    note("viscous_damping", rate > 0.0, format!("damping.viscous = {rate}"), 56.0 * node)
}

fn random_strength(case: &Case, simulation: &Simulation) -> EffectNote {
    let varying = simulation.body.groups.iter().flat_map(|g| &g.params);
    let columns = varying.filter(|c| matches!(c, Column::Varying(_))).count();
    let fields = case
        .field
        .iter()
        .filter(|(_, f)| f.variation > 0.0)
        .map(|(name, f)| format!("field.{name}.variation = {}", f.variation));
    let jitter = (case.jitter.strength > 0.0).then(|| format!("jitter.strength = {}", case.jitter.strength));
    let why: Vec<String> = fields.chain(jitter).collect();
    match why.is_empty() {
        true => note("random_strength", false, "no [field.NAME] varies and jitter.strength = 0".into(), 0.0),
        false => note("random_strength", true, why.join(", "), 8.0 * columns as f64),
    }
}

/// The table that `rmpm explain` prints.
pub fn explain(scene: &Scene) -> String {
    let total: f64 = scene.effects.iter().map(|e| e.bytes_per_point).sum();
    let mut text = String::from("effect              on   bytes/point/step  why\n");
    for e in &scene.effects {
        let cost = if e.on { format!("{:.1}", e.bytes_per_point) } else { "-".to_owned() };
        text += &format!("{:<18}  {:<3}  {:>16}  {}\n", e.name, if e.on { "yes" } else { "no" }, cost, e.why);
    }
    text + &format!(
        "\n{total:.0} bytes a point and step are moved for these effects, beside positions, velocities and stresses;\nan absent effect has no array and no call.\n"
    )
}
