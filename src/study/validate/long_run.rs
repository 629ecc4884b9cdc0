//! What each transfer keeps over many periods: a bar in its first axial mode, and a disc that spins.
//!
//! All explicit runs take the program's own step. The angular momentum is the one that the grid sees,
//! `sum x_i cross p_i` after the map: shapes reproduce linear fields, so it is that of the points with the
//! affine part of APIC.

use std::f64::consts::{PI, TAU};

use super::{
    Effort, Files, Problem, Report,
    measure::{largest, mean},
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
pub(super) const TRANSFERS: [(&str, &[&str]); 5] = [
    ("FLIP", &["explicit.pic_rate=0", "implicit.pic_rate=0"]),
    ("FLIP with 0.5/s of PIC", &["explicit.pic_rate=0.5", "implicit.pic_rate=0.5"]),
    ("APIC", &["solver.transfer=apic"]),
    ("XPIC(2)", &["solver.transfer=xpic", "solver.xpic_order=2"]),
    ("XPIC(5)", &["solver.transfer=xpic", "solver.xpic_order=5"]),
];

/// Shapes and stress updates of the explicit runs.
const WAYS: [(&str, &str); 6] =
    [("linear", "musl"), ("gimp", "musl"), ("bspline", "musl"), ("linear", "usl"), ("gimp", "usl"), ("bspline", "usl")];

/// Transfers whose disc runs in the short form too.
const SPUN: [&str; 3] = ["FLIP", "APIC", "XPIC(5)"];

/// A scheme with a transfer.
pub(super) struct Setting {
    name: String,
    keys: Vec<String>,
    /// Whether the bar and the disc run in the short form too.
    short: [bool; 2],
    /// Linear FLIP with MUSL: its energy is judged.
    plain: bool,
}

impl Setting {
    pub(super) fn explicit((shape, update): (&str, &str), (name, keys): (&str, &[&str])) -> Self {
        let set = [format!("solver.shape={shape}"), format!("explicit.stress_update={update}")];
        Setting {
            name: format!("{shape} {} {name}", update.to_uppercase()),
            keys: set.into_iter().chain(keys.iter().map(|k| (*k).to_owned())).collect(),
            short: [update == "musl", update == "musl" && shape != "gimp" && SPUN.contains(&name)],
            plain: (shape, update, name) == ("linear", "musl", "FLIP"),
        }
    }

    pub(super) fn newmark((name, keys): (&str, &[&str])) -> Self {
        let set = ["solver.scheme=implicit", "implicit.regime=newmark"];
        let keys = set.iter().chain(keys).map(|k| (*k).to_owned()).collect();
        Setting { name: format!("linear Newmark {name}"), keys, short: [true, false], plain: false }
    }

    /// Those of the table.
    fn all() -> Vec<Setting> {
        let explicit = WAYS.iter().flat_map(|way| TRANSFERS.iter().map(|t| Setting::explicit(*way, *t)));
        explicit.chain(TRANSFERS.iter().map(|t| Setting::newmark(*t))).collect()
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
        let (settings, full) = (Setting::all(), effort == Effort::Full);
        for setting in settings.iter().filter(|s| full || s.short[0]) {
            self.bar(setting, periods, reference, report)?;
        }
        for setting in settings.iter().filter(|s| full || s.short[1]) {
            self.disc(setting, periods, reference, report)?;
        }
        for update in ["musl", "usl"] {
            self.promise(update, reference, report)?;
        }
        TRANSFERS.iter().try_for_each(|(transfer, _)| self.tell(transfer, reference, report))
    }
}

impl LongRun {
    fn bar(&self, setting: &Setting, periods: f64, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let (swing, _) = match self.swung(setting, periods, reference, report) {
            Ok(found) => found,
            Err(why) if !setting.plain => {
                report.note(format!("bar, {}: not stable, {why}", setting.name));
                return Ok(());
            }
            Err(why) => return Err(why),
        };
        let omega = reference.given("omega")?;
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

    /// Energy kept by the bar, and the share of the kinetic energy at the end that the nodes do not see.
    pub(super) fn bar_kept(
        &self,
        setting: &Setting,
        periods: f64,
        reference: &Reference,
        report: &mut Report,
    ) -> Result<[f64; 2], String> {
        let (swing, run) = self.swung(setting, periods, reference, report)?;
        Ok([swing.energy_kept(TAU / reference.given("omega")?), unseen(&run)])
    }

    /// The bar over so many periods.
    fn swung(
        &self,
        setting: &Setting,
        periods: f64,
        reference: &Reference,
        report: &mut Report,
    ) -> Result<(Swing, Run), String> {
        let mut run = Run::new(self.files().case, &setting.keys)?;
        let mut swing = Swing { energy: vec![(0.0, run.energy())], velocity: vec![(0.0, mean_velocity(&run))] };
        let mass = run.sim.initial_mass;
        let end = run.until(periods * TAU / reference.given("omega")?, |sim| {
            let e = sim.energies();
            swing.energy.push((sim.time, e.kinetic + e.strain));
            swing.velocity.push((sim.time, sim.body.momentum()[0] / mass));
        });
        report.count(&run.sim);
        end.map(|()| (swing, run))
    }

    /// A note on what a transfer has kept, from the rows of all its runs.
    fn tell(&self, transfer: &str, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let mut parts = Vec::new();
        for (key, what) in [
            ("bar_energy", "energy of the bar"),
            ("disc_energy", "energy of the disc"),
            ("disc_momentum", "its angular momentum"),
        ] {
            let (quantity, end) = (&reference.answer(key)?.quantity, format!(" {transfer}"));
            let rows = report.rows.iter().filter(|r| r.quantity.starts_with(quantity) && r.quantity.ends_with(&end));
            let kept: Vec<f64> = rows.map(|r| r.ours).collect();
            if !kept.is_empty() {
                let (least, most) = (-largest(kept.iter().map(|v| -v)), largest(kept.iter().copied()));
                parts.push(format!("{what} {least:.3} to {most:.3}"));
            }
        }
        report.note(format!("{transfer} keeps, in parts of the start: {}", parts.join(", ")));
        Ok(())
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
        match spun(setting, turns, report) {
            Err(why) => report.note(format!("disc, {}: not stable, {why}", setting.name)),
            Ok(kept) => {
                report.row_of(reference, "disc_energy", &setting.name, None, kept.energy)?;
                report.row_of(reference, "disc_momentum", &setting.name, None, kept.momentum)?;
            }
        }
        Ok(())
    }
}

/// What a disc has kept after some turns.
#[derive(Clone, Copy)]
pub(super) struct Kept {
    /// Energy over that at the start.
    pub energy: f64,
    /// Angular momentum over that at the start.
    pub momentum: f64,
    /// Share of the kinetic energy of the points that the nodes do not see.
    pub unseen: f64,
}

/// The disc, spun.
pub(super) fn spun(setting: &Setting, turns: f64, report: &mut Report) -> Result<Kept, String> {
    let mut run = spinning(&setting.keys)?;
    let (energy, momentum) = (run.energy(), angular_momentum(&run));
    let end = run.until(turns * TAU, |_| ());
    report.count(&run.sim);
    end?;
    let (energy, momentum) = (run.energy() / energy, angular_momentum(&run) / momentum);
    Ok(Kept { energy, momentum, unseen: unseen(&run) })
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
    let nodes = mapped(run);
    let of = |s: usize| {
        let x = run.grid.node_position(nodes.id[s]);
        x[0] * nodes.momentum[1][s] - x[1] * nodes.momentum[0][s]
    };
    (0..nodes.count).map(of).sum()
}

/// 1 - sum p_i^2 / (2 m_i) over the kinetic energy of the points: what lies in the null space of the map, and what
/// the map smooths.
fn unseen(run: &Run) -> f64 {
    let nodes = mapped(run);
    let square = |s: usize| nodes.momentum[0][s].powi(2) + nodes.momentum[1][s].powi(2);
    let of = |s: usize| if nodes.mass[s] > 0.0 { 0.5 * square(s) / nodes.mass[s] } else { 0.0 };
    1.0 - (0..nodes.count).map(of).sum::<f64>() / run.sim.energies().kinetic
}

/// The nodes as the points map to them.
fn mapped(run: &Run) -> Nodes {
    match run.case.solver.shape {
        ShapeFunctions::Linear => mapped_by(run, Linear),
        ShapeFunctions::Gimp => mapped_by(run, Gimp),
        ShapeFunctions::GimpWide => mapped_by(run, GimpWide),
        ShapeFunctions::Bspline => mapped_by(run, BSpline),
    }
}

fn mapped_by<S: Shape<N>, const N: usize>(run: &Run, shape: S) -> Nodes {
    let (mut nodes, mut scratch) = (Nodes::new(run.grid), Box::<Scratch<N>>::default());
    let (body, stretch) = (&run.sim.body, 0..run.sim.body.len());
    FpPath::best().run(Scatter { scratch: &mut scratch, body, nodes: &mut nodes, cells: None, stretch, shape });
    nodes
}
