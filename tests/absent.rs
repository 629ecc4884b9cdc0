//! A scene pays only for what it calls for: exact counters of the work.

mod support;

use rmpm::space::stencil::LANES;
use support::{SLOPE, advance, bits, simulation};

/// Overrides that take an effect away or bring one in, and the calls a step they leave.
///
/// Gravity and a damping are called for their force and for their account (2). A support is called in
/// both passes of MUSL (2), once under USL; so are a frictional side and a drive, and for their account
/// (1). A side that may open also surveys the points (1). A load is called for its forces and for its
/// account (2).
const CALLS: [(&[&str], u64); 16] = [
    // gravity 2, roller on the left 2, friction with separation on the base 4
    (&[], 8),
    (&["gravity.schedule=none"], 6),
    (&["boundary.left=free"], 6),
    (&["boundary.base=free"], 4),
    (&["boundary.base.separation=false"], 7),
    (&["gravity.schedule=none", "boundary.left=free", "boundary.base=free"], 0),
    (&["damping.local=0.05"], 10),
    (&["damping.viscous=0.1"], 10),
    (&["damping.local=0.05", "damping.viscous=0.1", "boundary.right=fixed"], 14),
    // one call of each constraint less
    (&["explicit.stress_update=usl"], 6),
    (&["boundary.right=roller", "boundary.top=roller"], 12),
    (&["load=[{box=[[0, 4], [9, 5]], force=[0, -1]}]"], 10),
    (&["drive=[{box=[[0, 0], [1, 1]], velocity_x=0}]"], 11),
    (&["drive=[{box=[[0, 0], [1, 1]], velocity_x=0}]", "explicit.stress_update=usl"], 8),
    // one average a step; a fracture energy is no call
    (&NONLOCAL, 9),
    (&["material.clay.regularisation=fracture_energy", "material.clay.reference_length=1"], 8),
];

const NONLOCAL: [&str; 2] = ["material.clay.regularisation=nonlocal", "material.clay.reference_length=1"];

#[test]
fn effects_are_called_as_often_as_the_scene_says() {
    for (keys, calls) in CALLS {
        let mut sim = simulation(SLOPE, &[&["grid.cell=0.5"], keys].concat());
        advance(&mut sim, 30);
        assert_eq!(sim.work.effect_calls, 30 * calls, "{keys:?}");
        assert_eq!(sim.work.steps, 30);
        assert_eq!(sim.work.rejected_steps, 0);
    }
}

/// 8 bytes a point for each component of the forces, and nothing without a load.
#[test]
fn forces_on_points_are_stored_where_there_are_loads() {
    let build = |keys: &[&str]| {
        let mut sim = simulation(SLOPE, &[&["grid.cell=0.5"], keys].concat());
        advance(&mut sim, 2);
        (sim.bytes(), sim.body.len())
    };
    let ((with, n), (without, _)) = (build(&["load=[{box=[[0, 4], [9, 5]], force=[0, -1]}]"]), build(&[]));
    assert_eq!(with - without, 2 * 8 * n);
}

#[test]
fn the_law_sees_each_block_once_a_step() {
    for (keys, points) in [(&["grid.cell=0.5"][..], 4 * 455), (&["grid.cell=0.25"], 7240)] {
        let mut sim = simulation(SLOPE, keys);
        assert_eq!(sim.body.len(), points, "{keys:?}");
        advance(&mut sim, 25);
        assert_eq!(sim.work.law_blocks, 25 * points.div_ceil(LANES) as u64);
        assert_eq!(sim.work.particle_steps, 25 * points as u64);
    }
}

#[test]
fn blocks_do_not_mix_materials() {
    let layered = include_str!("../cases/layered.toml");
    let mut sim = simulation(layered, &[]);
    let blocks: usize = sim.body.groups.iter().map(|g| g.range.len().div_ceil(LANES)).sum();
    assert!(sim.body.groups.len() > 1);
    advance(&mut sim, 10);
    assert_eq!(sim.work.law_blocks, 10 * blocks as u64);
}

#[test]
fn an_effect_set_to_nothing_is_the_effect_left_out() {
    let text = without_tables(SLOPE, &["[damping]", "[jitter]"]);
    assert!(!text.contains("local = 0.0") && text.contains("[gravity]"));
    let off = ["grid.cell=0.5", "damping.local=0", "damping.viscous=0", "jitter.strength=0"];
    let (mut with, mut without) = (simulation(SLOPE, &off), simulation(&text, &off[..1]));
    advance(&mut with, 400);
    advance(&mut without, 400);
    assert!(bits(&with) == bits(&without));
    assert_eq!(with.work, without.work);
}

/// A smooth side that cannot open does what a roller does, and costs as much.
#[test]
fn a_smooth_closed_side_is_a_roller() {
    let smooth = "boundary.base={kind=\"friction\",coefficient=0.0,separation=false}";
    let (mut a, mut b) =
        (simulation(SLOPE, &["grid.cell=0.5", smooth]), simulation(SLOPE, &["grid.cell=0.5", "boundary.base=roller"]));
    advance(&mut a, 100);
    advance(&mut b, 100);
    assert!(bits(&a) == bits(&b));
    assert_eq!(a.work, b.work);
}

#[test]
fn only_plastic_soil_stores_plastic_strain() {
    let bar = include_str!("../cases/bar.toml");
    let elastic = simulation(bar, &[]);
    let plastic = simulation(SLOPE, &["grid.cell=0.5"]);
    assert_eq!(elastic.body.committed.history.len(), 0);
    assert_eq!(plastic.body.committed.history.len(), 1);
    // one column in the committed and one in the trial state
    assert_eq!(plastic.body.bytes_per_point() - elastic.body.bytes_per_point(), 16.0);
}

/// kappa in the committed and the trial state, and three columns over the grid's nodes.
#[test]
fn only_nonlocal_soil_stores_averages() {
    let build = |keys: &[&str]| simulation(SLOPE, &[&["grid.cell=0.5"], keys].concat());
    let (with, without) = (build(&NONLOCAL), build(&[]));
    assert_eq!((with.body.committed.history.len(), without.body.committed.history.len()), (2, 1));
    assert_eq!(with.body.bytes_per_point() - without.body.bytes_per_point(), 16.0);
    assert_eq!(with.bytes() - without.bytes(), 16 * with.body.len() + 24 * 121 * 15);
}

/// On cells of the reference length a fracture energy is the softening modulus as it stands.
#[test]
fn a_fracture_energy_costs_nothing_and_changes_nothing_on_its_own_cells() {
    let energy = ["material.clay.regularisation=fracture_energy", "material.clay.reference_length=0.5"];
    let [mut with, mut without] =
        [&energy[..], &[]].map(|keys| simulation(SLOPE, &[&["grid.cell=0.5"], keys].concat()));
    advance(&mut with, 400);
    advance(&mut without, 400);
    assert!(bits(&with) == bits(&without));
    assert_eq!(with.work, without.work);
}

#[test]
fn only_shapes_with_domains_store_the_deformation() {
    let [linear, gimp] =
        ["linear", "gimp"].map(|s| simulation(SLOPE, &["grid.cell=0.5", &format!("solver.shape={s}")]));
    assert_eq!(linear.body.committed.deformation.len() + linear.body.trial.deformation.len(), 0);
    // four columns in the committed and four in the trial state
    assert_eq!(gimp.body.bytes_per_point() - linear.body.bytes_per_point(), 64.0);
    assert_eq!(linear.work.domain_clamps, 0);
    let spline = simulation(SLOPE, &["grid.cell=0.5", "solver.shape=bspline"]);
    assert_eq!(spline.body.bytes_per_point(), linear.body.bytes_per_point());
}

#[test]
fn only_apic_stores_the_gradient_of_the_velocity() {
    let bytes = |key: &str| {
        let mut sim = simulation(SLOPE, &["grid.cell=0.5", &format!("solver.transfer={key}")]);
        advance(&mut sim, 2);
        (sim.body.bytes_per_point(), sim.bytes())
    };
    let (flip, apic, xpic) = (bytes("flip"), bytes("apic"), bytes("xpic"));
    // four columns in the committed and four in the trial state
    assert_eq!((apic.0 - flip.0, xpic.0 - flip.0), (64.0, 0.0));
    assert!(xpic.1 > flip.1, "the columns of the filter are counted");
}

#[test]
fn uniform_strength_is_not_stored_and_jittered_strength_is() {
    let uniform = simulation(SLOPE, &["grid.cell=0.5"]);
    let jittered = simulation(SLOPE, &["grid.cell=0.5", "jitter.strength=0.0005"]);
    // c0 and c_r of each point
    assert_eq!(jittered.body.bytes_per_point() - uniform.body.bytes_per_point(), 16.0);
}

/// The text without some of its tables.
fn without_tables(text: &str, headers: &[&str]) -> String {
    let mut keep = true;
    let lines = text.lines().filter(|line| {
        if line.starts_with('[') {
            keep = !headers.iter().any(|h| line.starts_with(h));
        }
        keep
    });
    lines.collect::<Vec<_>>().join("\n")
}
