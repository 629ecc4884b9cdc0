//! The case file of a random scene. A new word of a key is one entry in its list.

use std::fmt::Write;

use super::{
    draw::Draw,
    outline::{Polygon, Room, outlines},
};

const SHAPES: &[&str] = &["linear", "gimp", "gimp_wide", "bspline"];
const TRANSFERS: &[&str] = &["flip", "flip", "flip", "apic", "xpic"];
const UPDATES: &[&str] = &["musl", "usl"];
const EXPLICIT_KINEMATICS: &[&str] = &["hencky", "rate"];
const IMPLICIT_KINEMATICS: &[&str] = &["hencky", "hencky", "small"];
const EXPLICIT_LOCKING: &[&str] = &["none", "none", "b_bar"];
const IMPLICIT_LOCKING: &[&str] = &["none", "b_bar"];
const REGIMES: &[&str] = &["auto", "quasi_static", "newmark", "hht", "backward_euler"];
const INERTIA: &[&str] = &["newmark", "hht", "backward_euler"];
const LAYOUTS: &[&str] = &["gauss", "even"];
const CUT_CELLS: &[&str] = &["full", "inside", "scaled"];
const SYMMETRIC: &[&str] = &["auto", "direct", "pcg"];
const UNSYMMETRIC: &[&str] = &["auto", "lu", "gmres"];
const ORDERINGS: &[&str] = &["auto", "amd", "nested_dissection"];
const REGULARISATIONS: &[&str] = &["none", "none", "fracture_energy", "nonlocal"];
const MEASURES: &[&str] = &["cauchy", "kirchhoff"];
const CORRELATIONS: &[&str] = &["markov", "markov_separable", "gaussian", "spherical"];
const GENERATORS: &[&str] = &["auto", "las", "exact", "embedding"];
const DISTRIBUTIONS: &[&str] = &[
    "\"lognormal\"",
    "\"normal\"\nlow_values = \"floor\"",
    "\"normal\"\nlow_values = \"resample\"",
    "\"normal\"\nlow_values = \"none\"",
];
/// Parameters of a field, together or alone; those of every law, and those of von Mises.
const ELASTIC_PARAMETERS: &[&str] = &["\"unit_weight\"", "\"young_modulus\"", "\"poisson_ratio\""];
const STRENGTH_PARAMETERS: &[&str] =
    &["\"cohesion\"", "\"cohesion\", \"residual_cohesion\"", "\"cohesion\", \"young_modulus\"", "\"yield_constant\""];
const RATIOS: &[f64] = &[-0.4, 0.0, 0.2, 0.3, 0.45, 0.49, 0.499];

/// Longest steps, in sensible ones.
const LONGEST: f64 = 20.0;

/// A soil, and what the rest of a scene must know of it.
struct Soil {
    name: String,
    text: String,
    /// Speed of compression waves (m/s).
    wave: f64,
    strong: bool,
}

/// Sizes that go through a whole scene.
struct Frame {
    explicit: bool,
    h: f64,
    size: [f64; 2],
    /// Speed of the fastest wave (m/s), step and length of the run (s).
    wave: f64,
    step: f64,
    time: f64,
}

/// The case file of scene `number` of a seed.
pub(super) fn scene(seed: u64, number: u64) -> String {
    let draw = &mut Draw::new(seed, number);
    let gravity = draw.pick(&[9.81, 9.81, 1.0, 98.1]);
    let (explicit, h, cells) = grid(draw);
    // a soil has three cells of width at least, on the mean
    let soils: Vec<Soil> = (0..draw.whole(1, (cells[0] / 3).clamp(1, 3))).map(|k| soil(draw, k, gravity, h)).collect();
    let wave = soils.iter().map(|s| s.wave).fold(0.0, f64::max);
    let f = frame(draw, explicit, h, cells, wave);
    let mut s = format!("title = \"Random scene {number} of seed {seed}\"\nseed = {}\n", draw.whole(1, 1000));
    let room = Room { low: [0.0; 2], high: f.size.map(|l| l - 0.3 * f.h), h: f.h };
    let regions = outlines(draw, room, soils.len() as u32);
    s += &format!("\n[grid]\ncell = {:?}\nsize = {:?}\n", f.h, f.size);
    s += &points(draw);
    s += &solver(draw, &f);
    s += &format!("\n[gravity]\nacceleration = {gravity:?}\n{}", schedule(draw, &f));
    s += &initial_stress(draw);
    s += &damping(draw);
    s += &format!("\n[end]\ntime = {:?}\nat_rest = {}\n", f.time, draw.chance(0.1));
    s += &format!("\n[output]\nhistory = {:?}\n", f.time / 20.0);
    s += &boundary(draw);
    s += &if draw.chance(0.2) { loads(draw, &f) } else { String::new() };
    s += &if draw.chance(0.2) { drive(draw, &f) } else { String::new() };
    soils.iter().for_each(|soil| s += &soil.text);
    for (soil, polygon) in soils.iter().zip(&regions) {
        s += &region(draw, &f, soil, polygon);
    }
    for soil in &soils {
        s += &if draw.chance(0.4) { field(draw, &f, soil) } else { String::new() };
    }
    s
}

fn soil(draw: &mut Draw, number: u32, gravity: f64, h: f64) -> Soil {
    let (weight, young, ratio) = (draw.spread(1.0, 40.0), draw.spread(10.0, 1e6), draw.pick(RATIOS));
    let mut text = format!(
        "\n[material.soil{number}]\nunit_weight = {weight:?}\nyoung_modulus = {young:?}\npoisson_ratio = {ratio:?}\n"
    );
    let strong = draw.chance(0.3);
    text += &if strong { "law = \"elastic\"\n".to_owned() } else { strength(draw, young / (2.0 * (1.0 + ratio)), h) };
    let modulus = young * (1.0 - ratio) / ((1.0 + ratio) * (1.0 - 2.0 * ratio));
    Soil { name: format!("soil{number}"), text, wave: (modulus * gravity / weight).sqrt(), strong }
}

/// Strengths from nothing to more than anything, that soften, harden or stay.
fn strength(draw: &mut Draw, shear: f64, h: f64) -> String {
    let cohesion = draw.spread(1e-6, 100.0);
    let slope: f64 = draw.pick(&[-1.0, -1.0, 0.0, 1.0]);
    let residual =
        cohesion * if slope < 0.0 { draw.spread(1e-3, 1.0) } else { 1.0 + slope.abs() * draw.between(0.0, 2.0) };
    let length = match draw.pick(REGULARISATIONS) {
        "none" => String::new(),
        with => format!("regularisation = \"{with}\"\nreference_length = {:?}\n", h * draw.spread(0.3, 10.0)),
    };
    length
        + &format!(
            "law = \"von_mises\"\ncohesion = {cohesion:?}\nresidual_cohesion = {residual:?}\nsoftening_modulus = {:?}\nyield_constant = {}\nstrength_measure = \"{}\"\n",
            slope * shear * draw.spread(1e-4, 0.9),
            draw.pick(&["\"sqrt(3)\"", "1.0", "2.0"]),
            draw.pick(MEASURES)
        )
}

/// Whether the scheme is explicit, the side of the cells (m) and their numbers along x and y.
fn grid(draw: &mut Draw) -> (bool, f64, [u32; 2]) {
    let explicit = draw.chance(0.6);
    // systems of equations cost more
    let most = if explicit { 16 } else { 8 };
    let least = if draw.chance(0.1) { 1 } else { 4 };
    (explicit, draw.spread(0.05, 4.0), [draw.whole(least, most), draw.whole(least, most)])
}

fn frame(draw: &mut Draw, explicit: bool, h: f64, cells: [u32; 2], wave: f64) -> Frame {
    let size = cells.map(|n| f64::from(n) * h);
    let sensible = if explicit { 0.25 * h / wave } else { 2.0 * h / wave };
    let step = sensible * if draw.chance(0.4) { 1.0 } else { draw.spread(0.1, LONGEST) };
    let steps = if explicit { draw.whole(30, 300) } else { draw.whole(3, 25) };
    Frame { explicit, h, size, wave, step, time: step * f64::from(steps) }
}

fn points(draw: &mut Draw) -> String {
    let (layout, cut, per_axis) = (draw.pick(LAYOUTS), draw.pick(CUT_CELLS), draw.pick(&[1, 2, 2, 2, 3, 4]));
    format!("\n[points]\nlayout = \"{layout}\"\ncut_cells = \"{cut}\"\nper_axis = {per_axis}\n")
}

fn solver(draw: &mut Draw, f: &Frame) -> String {
    let (scheme, kinematics, locking) = if f.explicit {
        ("explicit", draw.pick(EXPLICIT_KINEMATICS), draw.pick(EXPLICIT_LOCKING))
    } else {
        ("implicit", draw.pick(IMPLICIT_KINEMATICS), draw.pick(IMPLICIT_LOCKING))
    };
    let (shape, transfer) = (draw.pick(SHAPES), draw.pick(TRANSFERS));
    let mut solver = format!(
        "\n[solver]\nscheme = \"{scheme}\"\nkinematics = \"{kinematics}\"\nlocking = \"{locking}\"\nshape = \"{shape}\"\ntransfer = \"{transfer}\"\n"
    );
    if transfer == "xpic" {
        let _ = writeln!(solver, "xpic_order = {}", draw.whole(1, 10));
    }
    // a rate of PIC is a key of FLIP
    let pic = if transfer == "flip" { format!("pic_rate = {:?}\n", pic_rate(draw)) } else { String::new() };
    solver + &if f.explicit { explicit(draw, f, &pic) } else { implicit(draw, f, &pic) }
}

fn pic_rate(draw: &mut Draw) -> f64 {
    if draw.chance(0.5) { 0.5 } else { draw.pick(&[0.0, 50.0, 1e6]) }
}

fn explicit(draw: &mut Draw, f: &Frame, pic: &str) -> String {
    let mut s = format!("\n[explicit]\nstress_update = \"{}\"\n{pic}", draw.pick(UPDATES));
    if draw.chance(0.6) {
        let _ = writeln!(s, "time_step = {:?}", f.step);
    } else {
        let _ = writeln!(s, "courant = {:?}", draw.between(0.1, 1.0));
    }
    if draw.chance(0.1) {
        let _ = writeln!(s, "mass_floor = {:?}", draw.spread(1e-6, 1.0));
    }
    s
}

/// Steps are cut to 1/16 at most, which bounds the work.
fn implicit(draw: &mut Draw, f: &Frame, pic: &str) -> String {
    let regime = draw.pick(REGIMES);
    let mut s = format!("\n[implicit]\nregime = \"{regime}\"\n{pic}");
    if regime == "auto" {
        let _ = writeln!(s, "inertia = \"{}\"", draw.pick(INERTIA));
    }
    let (ordering, symmetric) = (draw.pick(ORDERINGS), draw.pick(SYMMETRIC));
    let unsymmetric = draw.pick(UNSYMMETRIC);
    let _ = writeln!(s, "time_step = {:?}\nmin_time_step = {:?}", f.step, f.step / 16.0);
    let _ = writeln!(
        s,
        "ordering = \"{ordering}\"\nsymmetric = \"{symmetric}\"\nunsymmetric = \"{unsymmetric}\"\nline_search = {}",
        draw.chance(0.8)
    );
    if draw.chance(0.2) {
        let _ = writeln!(s, "tolerance = {:?}", draw.spread(1e-6, 1e-1));
    }
    if draw.chance(0.2) {
        let _ =
            writeln!(s, "ghost_stiffness = {:?}\nghost_mass = {:?}", draw.spread(1e-4, 1.0), draw.spread(1e-4, 1.0));
    }
    s
}

fn schedule(draw: &mut Draw, f: &Frame) -> String {
    let part = |draw: &mut Draw| draw.between(0.05, 0.6) * f.time;
    let tilt = if draw.chance(0.3) { draw.between(-60.0, 60.0) } else { 0.0 };
    let schedule = match draw.whole(0, 5) {
        0 => "\"none\"".to_owned(),
        1 | 2 => "\"at_once\"".to_owned(),
        3 => format!("\"ramp\"\nramp_time = {:?}", part(draw)),
        4 => format!(
            "\"normal_first\"\nramp_time = {:?}\nsettle_time = {:?}\nsettle_damping = {:?}\ntangential_time = {:?}",
            part(draw),
            part(draw),
            draw.between(0.0, 1.0),
            part(draw)
        ),
        _ => format!(
            "\"elastic_first\"\nramp_time = {:?}\nsettle_time = {:?}\nsettle_damping = {:?}",
            part(draw),
            part(draw),
            draw.between(0.0, 1.0)
        ),
    };
    format!("tilt = {tilt:?}\nschedule = {schedule}\n")
}

fn initial_stress(draw: &mut Draw) -> String {
    let mut stress = || draw.pick(&[-1.0, 1.0]) * draw.spread(1e-3, 100.0);
    let given = [stress(), stress(), stress(), stress()];
    match draw.whole(0, 19) {
        0 | 1 => format!(
            "\n[initial_stress]\nkind = \"given\"\nxx = {:?}\nyy = {:?}\nzz = {:?}\nxy = {:?}\n",
            given[0], given[1], given[2], given[3]
        ),
        2 => format!("\n[initial_stress]\nkind = \"k0\"\nk0 = {:?}\n", draw.between(0.0, 2.0)),
        _ => String::new(),
    }
}

fn damping(draw: &mut Draw) -> String {
    if draw.chance(0.8) {
        return String::new();
    }
    format!("\n[damping]\nlocal = {:?}\nviscous = {:?}\n", draw.between(0.0, 1.0), draw.spread(1e-3, 1e3))
}

fn boundary(draw: &mut Draw) -> String {
    let mut s = "\n[boundary]\n".to_owned();
    for side in ["base", "left", "right", "top"] {
        // most bodies stand on something
        let kind = if side == "base" { draw.whole(1, 4) } else { draw.whole(0, 3) };
        let friction = format!(
            "{{ kind = \"friction\", coefficient = {:?}, separation = {} }}",
            draw.between(0.0, 2.0),
            draw.chance(0.7)
        );
        let kind = match kind {
            0 => "\"free\"",
            1 => "\"roller\"",
            2 => "\"fixed\"",
            _ => &friction,
        };
        let _ = writeln!(s, "{side} = {kind}");
    }
    s
}

/// A box in the grid (m).
fn area(draw: &mut Draw, f: &Frame) -> [[f64; 2]; 2] {
    let mut ends = |l: f64| {
        let low = draw.between(0.0, 0.8) * l;
        [low, low + draw.between(0.1, 1.0) * (l - low)]
    };
    let ([x0, x1], [y0, y1]) = (ends(f.size[0]), ends(f.size[1]));
    [[x0, y0], [x1, y1]]
}

fn loads(draw: &mut Draw, f: &Frame) -> String {
    let force = [draw.between(-1.0, 1.0), draw.between(-1.0, 0.3)];
    let size = draw.spread(1e-2, 100.0) * f.size[0] * f.size[1];
    let ramp = if draw.chance(0.5) { 0.0 } else { 0.5 * f.time };
    format!("\n[[load]]\nbox = {:?}\nforce = {:?}\nramp_time = {ramp:?}\n", area(draw, f), force.map(|v| v * size))
}

fn drive(draw: &mut Draw, f: &Frame) -> String {
    // up to a quarter of a cell a step, and up to 4 cells in all
    let fastest = (4.0 * f.h / f.time).min(0.25 * f.h / f.step);
    let mut s = format!("\n[[drive]]\nbox = {:?}\nmoving = {}\n", area(draw, f), draw.chance(0.7));
    for (axis, both) in [("x", 0.5), ("y", 1.0)] {
        if draw.chance(both) {
            let _ = writeln!(s, "velocity_{axis} = {:?}", draw.between(-1.0, 1.0) * fastest);
        }
    }
    if draw.chance(0.3) {
        let _ = writeln!(s, "until = {:?}", draw.between(0.1, 0.9) * f.time);
    }
    s
}

fn region(draw: &mut Draw, f: &Frame, soil: &Soil, polygon: &Polygon) -> String {
    let mut s = format!("\n[[region]]\nmaterial = \"{}\"\npolygon = {polygon:?}\n", soil.name);
    let mut speed = || draw.pick(&[-1.0, 1.0]) * f.wave * draw.spread(1e-5, 0.3);
    let (velocity, rate) = ([speed(), speed()], speed() / f.h);
    match draw.whole(0, 5) {
        0 | 1 => s += &format!("velocity = {velocity:?}\n"),
        2 => s += &format!("spin = {{ rate = {:?}, center = {:?} }}\n", 0.1 * rate, polygon[0]),
        3 => s += &format!("wave = {{ amplitude = {velocity:?}, wave_number = [{:?}, 0.0] }}\n", 1.0 / f.h),
        _ => {}
    }
    s
}

fn field(draw: &mut Draw, f: &Frame, soil: &Soil) -> String {
    let parameters = if soil.strong || draw.chance(0.3) { ELASTIC_PARAMETERS } else { STRENGTH_PARAMETERS };
    format!(
        "\n[field.of_{0}]\nmaterial = \"{0}\"\nparameters = [{1}]\nvariation = {2:?}\ntheta_h = {3:?}\ntheta_v = {4:?}\ncell = {5:?}\ncorrelation = \"{6}\"\ngenerator = \"{7}\"\ncorrelation_error = 0.2\nvariance_error = 0.2\ndistribution = {8}\n",
        soil.name,
        draw.pick(parameters),
        draw.between(0.0, 1.0),
        f.h * draw.spread(0.5, 100.0),
        f.h * draw.spread(0.5, 100.0),
        f.h * draw.between(0.5, 1.5),
        draw.pick(CORRELATIONS),
        draw.pick(GENERATORS),
        draw.pick(DISTRIBUTIONS)
    )
}
