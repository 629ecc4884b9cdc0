//! Points just past a node: accelerations, stability, momentum.

use super::{
    Effort, Files, Problem, Report,
    measure::largest,
    reference::Reference,
    setup::{Run, keys},
};

/// See the module.
pub struct LightNode;

impl Problem for LightNode {
    fn name(&self) -> &'static str {
        "light-node"
    }

    fn files(&self) -> Files {
        Files {
            case: include_str!("../../../validation/light-node/case.toml"),
            reference: include_str!("../../../validation/light-node/reference.toml"),
        }
    }

    fn fill(&self, effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let places: &[f64] = match effort {
            Effort::Short => &[1e-6, 1e-3],
            Effort::Full => &[1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1],
        };
        let far = reference.given("far")?;
        for update in ["musl", "usl"] {
            let at_far = self.block(update, far)?.acceleration()?;
            for &past in places {
                let name = format!("{}, {past:e} h", update.to_uppercase());
                let ours = self.block(update, past)?.acceleration()?;
                report.row_of(reference, "acceleration", &name, None, ours / at_far)?;
                self.long_run(update, past, &name, reference, report)?;
            }
        }
        for &past in places {
            let most = self.growth("usl", false, past, reference, report)?;
            report.row_of(reference, "no_floor", &format!("{past:e} h"), None, most)?;
        }
        Ok(())
    }
}

impl LightNode {
    fn block(&self, update: &'static str, past: f64) -> Result<Block, String> {
        Block::new(self.files().case, update, past, &[])
    }

    /// Largest energy over the first; infinite after a fault.
    pub(super) fn growth(
        &self,
        update: &'static str,
        floor: bool,
        past: f64,
        reference: &Reference,
        report: &mut Report,
    ) -> Result<f64, String> {
        let block = self.block(update, past)?;
        let mut block = if floor { block } else { block.without_floor()? };
        Ok(block.watch(reference.given("steps")? as usize, report).energy)
    }

    fn long_run(
        &self,
        update: &'static str,
        past: f64,
        name: &str,
        reference: &Reference,
        report: &mut Report,
    ) -> Result<(), String> {
        let mut block = self.block(update, past)?;
        let most = block.watch(reference.given("steps")? as usize, report);
        report.row_of(reference, "energy", name, None, most.energy)?;
        if update == "musl" {
            return report.row_of(reference, "momentum", name, None, most.momentum);
        }
        report.row_of(reference, "floor_momentum", name, None, most.unbooked)?;
        report.row_of(reference, "floor_share", name, None, most.momentum)
    }
}

/// A block whose last points lie `past` cells past a node, along both axes.
struct Block {
    run: Run,
    text: &'static str,
    past: f64,
}

/// The largest values over a run; infinite after a fault.
struct Most {
    /// Kinetic and elastic energy over that at the start.
    energy: f64,
    /// |P| over mass x largest speed.
    momentum: f64,
    /// The same of P less the booked impulses.
    unbooked: f64,
}

impl Block {
    fn new(text: &'static str, update: &str, past: f64, more: &[(&str, String)]) -> Result<Self, String> {
        let mut set = vec![("explicit.stress_update", update.to_owned())];
        set.extend_from_slice(more);
        let mut run = Run::new(text, &keys(&set))?;
        let by = (0.25 + past) * run.grid.h;
        run.shift([by, by]);
        Ok(Block { run, text, past })
    }

    fn without_floor(self) -> Result<Self, String> {
        // the step of the run with the floor: what the user would have taken
        let mut with = self;
        with.run.step()?;
        let step = format!("{:?}", with.run.sim.dt);
        Block::new(with.text, "usl", with.past, &[("explicit.mass_floor", "0.0".into()), ("explicit.time_step", step)])
    }

    /// Largest acceleration of a point in the first step (m/s2).
    fn acceleration(mut self) -> Result<f64, String> {
        self.run.step()?;
        let [x, y] = &self.run.sim.body.committed.v;
        Ok(largest(x.iter().zip(y.iter()).map(|(x, y)| x.hypot(*y))) / self.run.sim.dt)
    }

    fn watch(&mut self, steps: usize, report: &mut Report) -> Most {
        let first = self.run.energy();
        let mut most = Most { energy: 1.0, momentum: 0.0, unbooked: 0.0 };
        let mut speed: f64 = 0.0;
        let (mut momentum, mut unbooked): (f64, f64) = (0.0, 0.0);
        for _ in 0..steps {
            if self.run.step().is_err() {
                most.energy = f64::INFINITY;
                break;
            }
            let sim = &self.run.sim;
            let (p, booked) = (sim.body.momentum(), sim.books().effects.impulse);
            let [vx, vy] = &sim.body.committed.v;
            speed = largest(vx.iter().zip(vy.iter()).map(|(x, y)| x.hypot(*y)).chain([speed]));
            momentum = momentum.max(p[0].hypot(p[1]));
            unbooked = unbooked.max((p[0] - booked[0]).hypot(p[1] - booked[1]));
            most.energy = largest([most.energy, self.run.energy() / first]);
        }
        report.count(&self.run.sim);
        let scale = self.run.sim.initial_mass * speed;
        Most { momentum: momentum / scale, unbooked: unbooked / scale, ..most }
    }
}
