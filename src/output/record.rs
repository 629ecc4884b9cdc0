//! `record.json`, which is deterministic, and `timing.json`, which holds what is not.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use crate::{
    case::{self, Case, Diagnostic},
    fault::Fault,
    math::simd::FpPath,
    measure::summary::Measures,
    run::{Outcome, Status},
    scene::{EffectNote, FieldNote, Scene, Warning},
    step::Event,
    work::Work,
};

/// Version of the names in the record. Names are only added; renaming one raises it.
pub const SCHEMA_VERSION: u32 = 1;

/// Everything a run came to.
#[derive(Clone, Debug, Serialize)]
pub struct Record {
    pub schema_version: u32,
    pub build: Build,
    pub units: &'static str,
    /// SHA-256 of the resolved case.
    pub case_hash: String,
    pub inputs: Vec<Input>,
    /// The `--set` values of the command line.
    pub overrides: Vec<String>,
    pub title: String,
    pub scheme: case::Scheme,
    /// With or without inertia, in the implicit scheme.
    pub regime: Option<&'static str>,
    pub kinematics: case::Kinematics,
    pub shape: case::ShapeFunctions,
    pub seed: u64,
    pub realisation: u64,
    /// The random fields of this realisation.
    pub fields: Vec<FieldNote>,
    pub effects: Vec<EffectNote>,
    pub dt_s: Value,
    pub outcome: Ending,
    pub fault: Option<Value>,
    /// What happened once, such as the loss of stability.
    pub events: Vec<Event>,
    pub warnings: Vec<Warning>,
    pub measures: Measures,
    /// The search for the factor of safety, where the case asks for one; the rest of the record is then that of
    /// the last run that failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strength_reduction: Option<Value>,
    pub work: Work,
}

/// The program that ran.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Build {
    pub version: String,
    pub commit: String,
    pub rustc: String,
    pub fp_path: String,
}

impl Build {
    /// Of this program.
    pub fn current() -> Self {
        Build {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            commit: env!("RMPM_COMMIT").to_owned(),
            rustc: env!("RMPM_RUSTC").to_owned(),
            fp_path: FpPath::NAME.to_owned(),
        }
    }
}

/// A file that the run read.
#[derive(Clone, Debug, Serialize)]
pub struct Input {
    pub path: String,
    pub sha256: String,
}

/// How it ended.
#[derive(Clone, Debug, Serialize)]
pub struct Ending {
    pub status: Status,
    pub time_s: f64,
    pub message: String,
}

/// Where a case came from.
#[derive(Clone, Debug)]
pub struct Source {
    /// Path as it was typed.
    pub path: String,
    pub text: String,
    pub overrides: Vec<String>,
    pub warnings: Vec<Diagnostic>,
}

/// The record of a finished run.
pub fn record(case: &Case, source: &Source, scene: &Scene, outcome: &Outcome) -> Record {
    let mut warnings: Vec<Warning> =
        source.warnings.iter().map(|d| Warning::new("case", &d.key, d.message.clone())).collect();
    warnings.extend(scene.warnings.iter().cloned());
    warnings.extend(about(case, outcome));
    warnings.extend(cut_domains(case, &scene.simulation.work));
    Record {
        schema_version: SCHEMA_VERSION,
        build: Build::current(),
        units: "kN, m, s, t",
        case_hash: sha256(case.to_toml().as_bytes()),
        inputs: vec![Input { path: source.path.clone(), sha256: sha256(source.text.as_bytes()) }],
        overrides: source.overrides.clone(),
        title: case.title.clone(),
        scheme: case.solver.scheme,
        regime: (case.solver.scheme == case::Scheme::Implicit).then(|| case.implicit.regime.word()),
        kinematics: case.solver.kinematics,
        shape: case.solver.shape,
        seed: case.seed,
        realisation: case.ensemble.realisation,
        fields: scene.fields.clone(),
        effects: scene.effects.clone(),
        dt_s: json!({ "min": outcome.dt.min, "mean": outcome.dt.mean, "max": outcome.dt.max }),
        outcome: Ending { status: outcome.status, time_s: outcome.time, message: outcome.message.clone() },
        fault: outcome.fault.as_ref().map(fault_value),
        events: scene.simulation.events().to_vec(),
        warnings,
        measures: outcome.measures.clone(),
        strength_reduction: None,
        work: scene.simulation.work.clone(),
    }
}

fn fault_value(fault: &Fault) -> Value {
    let values: Map<String, Value> = fault.values.iter().map(|(k, v)| (k.clone(), json!(v))).collect();
    json!({
        "kind": fault.kind, "step": fault.step, "time_s": fault.time_s, "point": fault.point,
        "node": fault.node, "x_m": fault.x_m, "values": values,
    })
}

/// SHA-256 in hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    use sha2::{Digest, Sha256};
    Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect()
}

/// Where the model or the answer is to be taken with care.
fn about(case: &Case, outcome: &Outcome) -> Vec<Warning> {
    let m = &outcome.measures;
    let mut w = Vec::new();
    if case.material.values().any(case::Material::softens_without_length) {
        w.push(Warning::new(
            "mesh_dependent_softening",
            "material",
            "linear softening has no length scale: shear bands are one cell wide and r depends on grid.cell; compare meshes with `rmpm converge`, or give the soil a `regularisation`".into(),
        ));
    }
    if m.blocks.is_some_and(|b| b > 0) {
        w.push(Warning::new(
            "chance",
            "jitter.strength",
            "one run is one draw: strengths changed by 0.05 % move r by a column of points or by a whole block, as the mesh has it; give the median of jittered runs (`rmpm converge --runs`)".into(),
        ));
    }
    if m.sliding_distance_censored {
        w.push(Warning::new(
            "censored",
            "slide.censored_above",
            "the slide has reached the wall: r is a lower bound".into(),
        ));
    }
    w.extend(numerical_energy(case, outcome));
    w.extend(energy_drift(case, outcome));
    w.extend(parted(outcome));
    if outcome.status == Status::EndTime && case.end.at_rest && m.energy_kj_per_m.nodal_kinetic > 0.0 {
        w.push(Warning::new("not_at_rest", "end.time", "the run ended before the body came to rest".into()));
    }
    w
}

/// Energy that the scheme itself has taken or made, by its parts, and what to change.
fn numerical_energy(case: &Case, outcome: &Outcome) -> Option<Warning> {
    let e = &outcome.measures.energy_kj_per_m;
    let key = match case.solver.scheme {
        case::Scheme::Explicit => "explicit.courant",
        case::Scheme::Implicit => "implicit.time_step",
    };
    (e.numerical.abs() > 0.05 * e.external.abs().max(1e-9)).then(|| {
        let share = |part: f64| 100.0 * part / e.external;
        let text = format!(
            "{:.1} % of the energy supplied is numerical: {:.1} % taken by the maps between points and nodes (PIC, lumped mass, points that cross cell faces), {:.1} % by stops at supports and contacts, {:.1} % by the integration in time (damping; without inertia a load that comes on at once), {:.1} % unexplained",
            share(e.numerical), share(e.transfer), share(e.impact), share(e.integrator), share(e.unexplained)
        );
        Warning::new("numerical_energy", key, text)
    })
}

/// Where the guard on the energy has spoken.
fn energy_drift(case: &Case, outcome: &Outcome) -> Option<Warning> {
    let [first, worst] = outcome.drift?;
    let text = format!(
        "from step {} (t = {:.4} s) on more energy was made, or lost without a known cause, than `guard.warning` allows: up to {:.1} % of what was supplied (step {}); lower {}, or use solver.shape = \"gimp\"",
        first.step,
        first.time_s,
        100.0 * worst.share,
        worst.step,
        case.step_keys()
    );
    Some(Warning::new("energy_drift", "guard.warning", text))
}

/// A body in more pieces than at the start.
fn parted(outcome: &Outcome) -> Option<Warning> {
    let [first, last] = outcome.measures.pieces;
    (last > first).then(|| {
        let text = format!(
            "the body has parted: it was in {first} and is in {last} pieces that share no node, so that no stress passes between them. No law here lets soil tear: its points have come further apart than the shape functions reach; use more points a cell, or solver.shape = \"gimp_wide\""
        );
        Warning::new("parted", "solver.shape", text)
    })
}

/// Domains that have outgrown what the shape functions take.
fn cut_domains(case: &Case, work: &Work) -> Option<Warning> {
    let (reach, advice) = match case.solver.shape {
        case::ShapeFunctions::Gimp => ("h/2", "use solver.shape = \"gimp_wide\", or more points"),
        _ => ("h", "use more points"),
    };
    (work.domain_clamps > 0).then(|| {
        Warning::new(
            "domain_clamps",
            "solver.shape",
            format!(
                "up to {} of {} points at a time had domains longer than the shape functions take (half-lengths to {reach}): they were cut, and what stretches further may tear numerically; {advice}",
                work.domain_clamps, work.points
            ),
        )
    })
}

/// What depends on the machine and the hour.
#[derive(Clone, Debug, Serialize)]
pub struct Timing {
    pub wall_s: f64,
    pub cpu_s: Option<f64>,
    /// Seconds of wall time by part of the run.
    pub by_phase: std::collections::BTreeMap<String, f64>,
    pub threads: usize,
    pub peak_memory_bytes: Option<u64>,
    pub bytes_per_point: f64,
    pub particle_steps_per_cpu_s: Option<f64>,
    pub instruction_path: String,
}

/// CPU time of this process so far (s), where the system tells (Linux).
pub fn cpu_seconds() -> Option<f64> {
    // user and system time in clock ticks are fields 14 and 15, counted after the name in brackets
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    let mut fields = stat.rsplit(')').next()?.split_whitespace().skip(11);
    let ticks: f64 = fields.next()?.parse::<f64>().ok()? + fields.next()?.parse::<f64>().ok()?;
    Some(ticks / 100.0)
}

/// Largest resident memory of this process so far, where the system tells (Linux).
pub fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    line.split_whitespace().next()?.parse::<u64>().ok().map(|kib| kib * 1024)
}
