use rmpm::case::*;
use std::collections::BTreeMap;
fn main() {
    let h: f64 = std::env::args().nth(1).map(|s| s.parse().unwrap()).unwrap_or(0.25);
    let tend: f64 = std::env::args().nth(2).map(|s| s.parse().unwrap()).unwrap_or(18.0);
    let dt: f64 = std::env::args().nth(3).map(|s| s.parse().unwrap()).unwrap_or(0.002);
    let pic: f64 = std::env::args().nth(4).map(|s| s.parse().unwrap()).unwrap_or(0.5);
    let rate = std::env::args().nth(5).is_some_and(|s| s == "rate");
    let mut material = BTreeMap::new();
    material.insert("clay".to_string(), Material::VonMises {
        elastic: Elastic { unit_weight: 20.0, young_modulus: 1000.0, poisson_ratio: 0.33 },
        strength: Strength { cohesion: 20.0, residual_cohesion: 4.0, softening_modulus: -50.0, yield_constant: 3f64.sqrt(), strength_measure: StrengthMeasure::Cauchy },
    });
    let case = Case {
        title: "t".into(), seed: 1, grid: Grid { cell: h, origin: [0.0; 2], size: [60.0, 7.0] },
        points: Points { layout: Layout::Gauss, per_axis: 2, cut_cells: CutCells::Full },
        solver: Solver { scheme: Scheme::Explicit, kinematics: if rate {Kinematics::Rate} else {Kinematics::Hencky} },
        explicit: Explicit { stress_update: StressUpdate::Musl, pic_rate: pic, courant: 0.25, time_step: if dt > 0.0 {Some(dt)} else {None}, mass_floor: 0.0 },
        gravity: Gravity { acceleration: 9.81, tilt: 0.0, schedule: GravitySchedule::Ramp { ramp_time: 5.0 } },
        initial_stress: InitialStress::None, damping: Damping { local: 0.0, viscous: 0.0 }, jitter: Jitter { strength: 0.0, realisation: 0 },
        end: End { time: 40.0, at_rest: true, rest_energy: 1e-3, rest_hold: 4.0 }, output: Output { history: 0.02, frames: 0.25, pictures: vec![] },
        slide: None,
        boundary: Boundary { left: Side::Roller, right: Side::Free, base: Side::Friction { coefficient: 0.3, separation: true }, top: Side::Free },
        material, region: vec![Region { name: "s".into(), material: "clay".into(), shape: RegionShape::Polygon(vec![[0.,0.],[25.,0.],[20.,5.],[0.,5.]]), velocity: [0.0;2], spin: None, wave: None }],
    };
    let scene = rmpm::scene::build(&case, u64::MAX).unwrap();
    println!("{}", rmpm::scene::explain(&scene));
    let mut sim = scene.simulation;
    let top: Vec<u32> = (0..sim.body.len() as u32).collect();
    let _ = top;
    println!("bytes/pt {}", sim.body.bytes_per_point());
    let t0 = std::time::Instant::now();
    let mut next = 0.0;
    let s0 = sim.snapshot();
    let ytop = s0.reference.iter().map(|x| x[1]).fold(0.0, f64::max);
    let mut probe: Vec<usize> = (0..s0.len()).filter(|&i| s0.reference[i][1] > ytop - 1e-9 && s0.reference[i][0] < 20.0).collect();
    probe.sort_by(|&a, &b| s0.reference[a][0].total_cmp(&s0.reference[b][0]));
    let mut steptime = 0.0;
    while sim.time < tend {
        let ts = std::time::Instant::now();
        if let Err(f) = sim.step(1.0) { println!("{f}"); break; }
        steptime += ts.elapsed().as_secs_f64();
        if sim.time >= next { next += 1.0;
            let s = sim.snapshot();
            let r = probe.iter().find(|&&i| s.displacement(i)[0] > 0.25).map_or(0.0, |&i| 20.0 - s.reference[i][0]);
            let e = sim.energies();
            println!("t {:.2} dt {:.5} r {:.2} kin {:.3} nod {:.4} strain {:.2} ext {:.2} pl {:.2} fr {:.2} num {:.3} mom {:?} runs sorts {} act {}", sim.time, sim.dt, r, e.kinetic, e.nodal_kinetic, e.strain, e.external, e.plastic, e.friction, e.numerical, sim.momentum_error(), sim.work.sorts, sim.work.max_active_nodes);
        }
    }
    println!("{:.1} M/s  steps {} wall {:.2}", sim.work.particle_steps as f64 / steptime / 1e6, sim.work.steps, t0.elapsed().as_secs_f64());
}
