//! What each transfer keeps over many periods: a bar in its first axial mode, and a disc that spins.
//!
//! All explicit runs take the program's own step. The angular momentum is the one that the grid sees,
//! `sum x_i cross p_i` after the map: shapes reproduce linear fields, so it is that of the points with the
//! affine part of APIC.

use std::f64::consts::{PI, TAU};

use super::{
    Effort, Files, Problem, Report,
    measure::mean,
    reference::Reference,
    rigid::{Rigid, stress_as_spinning},
    setup::Run,
};
use crate::{
    assembly::{Scatter, Scratch},
    case::ShapeFunctions,
    math::simd::FpPath,
    nodes::Nodes,
    space::{BSpline, Gimp, GimpWide, Linear, Shape},
};

/// See the module.
pub struct LongRun;

/// Transfers, and the keys that choose them in either scheme.
const TRANSFERS: [(&str, &[&str]); 5] = [
    ("FLIP", &["explicit.pic_rate=0", "implicit.pic_rate=0"]),
    ("FLIP with 0.5/s of PIC", &["explicit.pic_rate=0.5", "implicit.pic_rate=0.5"]),
    ("APIC", &["solver.transfer=apic"]),
    ("XPIC(2)", &["solver.transfer=xpic", "solver.xpic_order=2"]),
    ("XPIC(5)", &["solver.transfer=xpic", "solver.xpic_order=5"]),
];

/// Shapes and stress updates of the explicit runs.
const WAYS: [(&str, &str); 6] =
    [("linear", "musl"), ("gimp", "musl"), ("bspline", "musl"), ("linear", "usl"), ("gimp", "usl"), ("bspline", "usl")];

/// A scheme with a transfer.
struct Setting {
    name: String,
    keys: Vec<String>,
    implicit: bool,
    /// Linear FLIP with MUSL: its energy is judged.
    plain: bool,
}

impl Setting {
    fn explicit((shape, update): (&str, &str), (name, keys): (&str, &[&str])) -> Self {
        let set = [format!("solver.shape={shape}"), format!("explicit.stress_update={update}")];
        Setting {
            name: format!("{shape} {} {name}", update.to_uppercase()),
            keys: set.into_iter().chain(keys.iter().map(|k| (*k).to_owned())).collect(),
            implicit: false,
            plain: (shape, update, name) == ("linear", "musl", "FLIP"),
        }
    }

    fn newmark((name, keys): (&str, &[&str])) -> Self {
        let set = ["solver.scheme=implicit", "implicit.regime=newmark"];
        let keys = set.iter().chain(keys).map(|k| (*k).to_owned()).collect();
        Setting { name: format!("linear Newmark {name}"), keys, implicit: true, plain: false }
    }

    /// Those of the table; the short form leaves out most of USL.
    fn all(effort: Effort) -> Vec<Setting> {
        let explicit = WAYS.iter().flat_map(|way| TRANSFERS.iter().map(|t| Setting::explicit(*way, *t)));
        let kept = explicit
            .filter(|s| effort == Effort::Full || s.name.contains("MUSL") || s.name.contains("bspline USL APIC"));
        kept.chain(TRANSFERS.iter().map(|t| Setting::newmark(*t))).collect()
    }
}

impl Problem for LongRun {
    fn name(&self) -> &'static str {
        "long-run"
    }

    fn files(&self) -> Files {
        Files {
            case: include_str!("../../../validation/long-run/case.toml"),
            reference: include_str!("../../../validation/long-run/reference.toml"),
        }
    }

    fn fill(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let periods = reference.given(if effort == Effort::Full { "periods" } else { "short_periods" })?;
        let settings = Setting::all(effort);
        for setting in &settings {
            self.bar(setting, periods, reference, report)?;
        }
        // implicit steps over so many turns take minutes each: in full only
        for setting in settings.iter().filter(|s| !s.implicit || effort == Effort::Full) {
            self.disc(setting, periods, reference, report)?;
        }
        for update in ["musl", "usl"] {
            self.promise(update, reference, report)?;
        }
        Ok(())
    }
}

impl LongRun {
    fn bar(&self, setting: &Setting, periods: f64, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let omega = reference.given("omega")?;
        let mut run = Run::new(self.files().case, &setting.keys)?;
        let mut swing = Swing { energy: vec![(0.0, run.energy())], velocity: vec![(0.0, mean_velocity(&run))] };
        let mass = run.sim.initial_mass;
        let end = run.until(periods * TAU / omega, |sim| {
            let e = sim.energies();
            swing.energy.push((sim.time, e.kinetic + e.strain));
            swing.velocity.push((sim.time, sim.body.momentum()[0] / mass));
        });
        report.count(&run.sim);
        if let (Err(why), false) = (&end, setting.plain) {
            report.note(format!("bar, {}: not stable, {why}", setting.name));
            return Ok(());
        }
        end?;
        let (period, name) = (TAU / omega, setting.name.as_str());
        let frequency = swing.frequency() / omega;
        if setting.plain {
            report.row(reference, "flip_drift", swing.energy_kept(period) - 1.0)?;
            report.row(reference, "flip_frequency", frequency)?;
        }
        report.row_of(reference, "bar_energy", name, None, swing.energy_kept(period))?;
        report.row_of(reference, "bar_amplitude", name, None, swing.amplitude_kept(period))?;
        report.row_of(reference, "bar_frequency", name, None, frequency)
    }

    /// What APIC promises, over one turn: the mass floor, which withholds forces on light nodes one by one and
    /// so their moment, is off, and steps are short for it.
    fn promise(&self, update: &str, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let set = ["solver.shape=bspline", "solver.transfer=apic", "explicit.mass_floor=0"].map(str::to_owned);
        let keys: Vec<String> = set.into_iter().chain([format!("explicit.stress_update={update}")]).collect();
        let mut run = spinning(&keys)?;
        let momentum = angular_momentum(&run);
        run.until(TAU, |_| ())?;
        report.count(&run.sim);
        report.row_of(reference, "momentum_kept", &update.to_uppercase(), None, 1.0 - angular_momentum(&run) / momentum)
    }

    fn disc(&self, setting: &Setting, turns: f64, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let mut run = spinning(&setting.keys)?;
        let (energy, momentum) = (run.energy(), angular_momentum(&run));
        let end = run.until(turns * TAU, |_| ());
        report.count(&run.sim);
        if let Err(why) = end {
            report.note(format!("disc, {}: not stable, {why}", setting.name));
            return Ok(());
        }
        let kept = angular_momentum(&run) / momentum;
        report.row_of(reference, "disc_energy", &setting.name, None, run.energy() / energy)?;
        report.row_of(reference, "disc_momentum", &setting.name, None, kept)
    }
}

/// The disc at the start, with the stress that it has while it spins once in 2 pi seconds.
fn spinning(keys: &[String]) -> Result<Run, String> {
    let more = ["region.disc.spin={ rate = 1.0, center = [0.0, 0.0] }", "implicit.time_step=0.02"];
    let keys: Vec<String> = keys.iter().cloned().chain(more.map(str::to_owned)).collect();
    let mut run = Run::new(Rigid.files().case, &keys)?;
    stress_as_spinning(&mut run);
    Ok(run)
}

/// Energy (kJ/m) and mean velocity (m/s) over time.
struct Swing {
    energy: Vec<(f64, f64)>,
    velocity: Vec<(f64, f64)>,
}

impl Swing {
    /// Mean over the last period over that over the first.
    fn energy_kept(&self, period: f64) -> f64 {
        last_over_first(&self.energy, period, |e| e)
    }

    /// Root mean square over the last period over that over the first.
    fn amplitude_kept(&self, period: f64) -> f64 {
        last_over_first(&self.velocity, period, |v| v * v).sqrt()
    }

    /// Half turns between the first and the last zero of the velocity, over the time between (rad/s).
    fn frequency(&self) -> f64 {
        let crossing = |w: &[(f64, f64)]| match w {
            [(t, a), (u, b)] if a * b < 0.0 => Some(t + (u - t) * a / (a - b)),
            _ => None,
        };
        let zeros: Vec<f64> = self.velocity.windows(2).filter_map(crossing).collect();
        match (zeros.first(), zeros.last()) {
            (Some(first), Some(last)) if last > first => PI * (zeros.len() - 1) as f64 / (last - first),
            _ => f64::NAN,
        }
    }
}

fn last_over_first(series: &[(f64, f64)], period: f64, f: impl Fn(f64) -> f64) -> f64 {
    let end = series.last().map_or(f64::NAN, |(t, _)| *t);
    let between = |a: f64, b: f64| mean(series.iter().filter(|(t, _)| *t > a && *t <= b).map(|(_, v)| f(*v)));
    between(end - period, end) / between(0.0, period)
}

fn mean_velocity(run: &Run) -> f64 {
    run.sim.body.momentum()[0] / run.sim.initial_mass
}

/// sum x_i cross p_i over the nodes (kN m s/m).
fn angular_momentum(run: &Run) -> f64 {
    match run.case.solver.shape {
        ShapeFunctions::Linear => seen_by_the_grid(run, Linear),
        ShapeFunctions::Gimp => seen_by_the_grid(run, Gimp),
        ShapeFunctions::GimpWide => seen_by_the_grid(run, GimpWide),
        ShapeFunctions::Bspline => seen_by_the_grid(run, BSpline),
    }
}

fn seen_by_the_grid<S: Shape<N>, const N: usize>(run: &Run, shape: S) -> f64 {
    let (mut nodes, mut scratch) = (Nodes::new(run.grid), Box::<Scratch<N>>::default());
    FpPath::best().run(Scatter { scratch: &mut scratch, body: &run.sim.body, nodes: &mut nodes, cells: None, shape });
    let of = |s: usize| {
        let x = run.grid.node_position(nodes.id[s]);
        x[0] * nodes.momentum[1][s] - x[1] * nodes.momentum[0][s]
    };
    (0..nodes.count).map(of).sum()
}
