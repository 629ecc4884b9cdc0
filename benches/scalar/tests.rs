use super::law::{atanhc, hencky_trial, hencky_trial_exact, log1p, tanhc};
use super::*;

struct Draw(u64);

impl Draw {
    /// Uniform in [-a, a].
    fn within(&mut self, a: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        a * ((self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0)
    }

    fn tensor(&mut self, a: f64) -> [f64; 4] {
        std::array::from_fn(|_| self.within(a))
    }
}

type Matrix = [[f64; 2]; 2];

fn product(a: Matrix, b: Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j]))
}

/// f of a symmetric matrix by its eigenvalues and eigenvectors.
fn spectral(s: Matrix, f: fn(f64) -> f64) -> Matrix {
    let angle = 0.5 * (2.0 * s[0][1]).atan2(s[0][0] - s[1][1]);
    let (sin, cos) = angle.sin_cos();
    let (mean, radius) = (0.5 * (s[0][0] + s[1][1]), (0.5 * (s[0][0] - s[1][1])).hypot(s[0][1]));
    let (one, two) = (f(mean + radius), f(mean - radius));
    let xy = (one - two) * sin * cos;
    [[one * cos * cos + two * sin * sin, xy], [xy, one * sin * sin + two * cos * cos]]
}

/// 1/2 ln(F exp(2e) F^T) word for word.
fn trial_by_eigenvalues(e: [f64; 4], l: [f64; 4]) -> [f64; 4] {
    let b = spectral([[2.0 * e[0], 2.0 * e[3]], [2.0 * e[3], 2.0 * e[1]]], f64::exp);
    let f = [[1.0 + l[0], l[1]], [l[2], 1.0 + l[3]]];
    let transposed = [[f[0][0], f[1][0]], [f[0][1], f[1][1]]];
    let log = spectral(product(product(f, b), transposed), f64::ln);
    [0.5 * log[0][0], 0.5 * log[1][1], e[2], 0.5 * log[0][1]]
}

fn largest_gap(a: [f64; 4], b: [f64; 4]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn polynomials_match_the_functions_inside_their_bounds() {
    for i in 1..=2000 {
        let x = 0.0196 * i as f64 / 2000.0;
        assert!((tanhc(x) * x.sqrt() / x.sqrt().tanh() - 1.0).abs() < 1e-15, "tanhc({x})");
        let y = 0.0256 * i as f64 / 2000.0;
        assert!((atanhc(y) * y.sqrt() / y.sqrt().atanh() - 1.0).abs() < 1e-15, "atanhc({y})");
        for z in [1e-5 * i as f64, -1e-5 * i as f64] {
            assert!((log1p(z) / z.ln_1p() - 1.0).abs() < 1e-15, "log1p({z})");
        }
    }
    assert_eq!((tanhc(0.0), atanhc(0.0), log1p(0.0)), (1.0, 1.0, 0.0));
}

/// |dev 2e| stays below 0.14: the polynomials are taken.
#[test]
fn trial_strain_is_the_exact_one_inside_the_bounds() {
    let mut draw = Draw(1);
    for _ in 0..200_000 {
        let (e, l) = (draw.tensor(0.035), draw.tensor(0.004));
        let (trial, det) = hencky_trial(e, l);
        assert!(largest_gap(trial, hencky_trial_exact(e, l).0) < 2e-16);
        assert!(largest_gap(trial, trial_by_eigenvalues(e, l)) < 2e-15);
        assert!((det - ((1.0 + l[0]) * (1.0 + l[3]) - l[1] * l[2])).abs() < 1e-15);
    }
}

#[test]
fn trial_strain_is_the_exact_one_outside_the_bounds() {
    let mut draw = Draw(2);
    for _ in 0..50_000 {
        let (e, l) = (draw.tensor(0.5), draw.tensor(0.3));
        assert!(largest_gap(hencky_trial(e, l).0, trial_by_eigenvalues(e, l)) < 2e-14);
    }
}

#[test]
fn rotation_leaves_the_stretches_alone() {
    let e = [0.02, -0.01, 0.003, 0.015];
    let (sin, cos) = 0.01f64.sin_cos();
    let (trial, _) = hencky_trial(e, [cos - 1.0, -sin, sin, cos - 1.0]);
    let stretch = |e: [f64; 4]| (e[0] + e[1], (0.5 * (e[0] - e[1])).hypot(e[3]));
    assert!((stretch(e).0 - stretch(trial).0).abs() < 1e-16);
    assert!((stretch(e).1 - stretch(trial).1).abs() < 1e-16);
}

/// Kirchhoff zz stress of a state, which the plane does not need.
type OutOfPlane = fn(&Soil, &State) -> f64;

fn zz_of_hencky(soil: &Soil, state: &State) -> f64 {
    let [xx, yy, zz, _] = state.tensor;
    soil.lame * (xx + yy + zz) + 2.0 * soil.shear * zz
}

fn zz_of_rate(_: &Soil, state: &State) -> f64 {
    state.jacobian * state.tensor[2]
}

/// q over its bound sqrt(3) c, both of the Kirchhoff or both of the Cauchy stress.
fn strength_ratio<L: Law>(soil: &Soil, state: &State, zz: OutOfPlane, kirchhoff: bool) -> f64 {
    let ([xx, yy, xy], zz) = (L::resultant(soil, 1.0, state), zz(soil, state));
    let mean = (xx + yy + zz) / 3.0;
    let d = [xx - mean, yy - mean, zz - mean];
    let q = (1.5 * (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] + 2.0 * xy * xy)).sqrt();
    let c = (20.0 - 50.0 * state.plastic).max(4.0);
    let measure = if kirchhoff { 1.0 } else { state.jacobian };
    q / (3f64.sqrt() * c * measure)
}

/// Shears to the residual strength through the kink: q reaches the strength and never passes it.
fn shear_through_the_kink<L: Law>(zz: OutOfPlane, kirchhoff: bool) {
    let soil = Soil::new(1000.0, 0.33, -50.0);
    let mut state = State { tensor: [0.0; 4], jacobian: 1.0, plastic: 0.0 };
    for _ in 0..400 {
        state = L::update(&soil, [20.0, 4.0], state, [-1e-4, 3e-3, 0.0, -2e-5]);
        let ratio = strength_ratio::<L>(&soil, &state, zz, kirchhoff);
        assert!(ratio < 1.0 + 1e-12);
        assert!(state.plastic == 0.0 || ratio > 1.0 - 1e-12);
    }
    assert!(state.plastic > 0.32 && state.jacobian < 0.97);
}

#[test]
fn strength_bounds_the_stated_stress() {
    shear_through_the_kink::<Hencky<false>>(zz_of_hencky, false);
    shear_through_the_kink::<Hencky<true>>(zz_of_hencky, true);
    shear_through_the_kink::<Rate<false>>(zz_of_rate, false);
    shear_through_the_kink::<Rate<true>>(zz_of_rate, true);
}

#[test]
fn the_papers_slope_has_1810_cells() {
    let slope = Scalar::<Hencky>::paper_slope(0.25, 2);
    assert_eq!(slope.points(), 1810 * 4);
    let mass = 1810.0 * 0.0625 * 20.0 / 9.81;
    assert!((slope.mass() / mass - 1.0).abs() < 1e-12);
    assert_eq!(Scalar::<Hencky>::paper_slope(5.0 / 105.0, 2).points(), 198_660);
    assert_eq!(Scalar::<Rate>::paper_slope(0.25, 4).points(), 1810 * 16);
}

/// The base answers for its own row of nodes only in the first step: half a row of cells.
#[test]
fn vertical_momentum_follows_gravity_until_the_base_answers() {
    let mut slope = Scalar::<Hencky>::paper_slope(0.25, 2);
    slope.friction = 0.0;
    slope.step(1e-3);
    let [x, y] = slope.momentum();
    let base: f64 = slope.nodes.motion.iter().take(slope.nodes.stride as usize).map(|m| m[1]).sum();
    assert_eq!((x, base), (0.0, 0.0));
    let fall = slope.mass() * GRAVITY * (1e-3 / 5.0) * 1e-3;
    assert!(-y < fall && -y > 0.94 * fall, "{y} {fall}");
}

/// Two neighbours stay as close under the two laws as the strains are small.
#[test]
fn laws_agree_while_strains_are_small() {
    let mut a = Scalar::<Hencky>::paper_slope(0.5, 2);
    let mut b = Scalar::<Rate>::paper_slope(0.5, 2);
    for _ in 0..300 {
        a.step(0.002);
        b.step(0.002);
    }
    assert_eq!(a.max_plastic_strain(), 0.0);
    assert!((a.max_displacement() / b.max_displacement() - 1.0).abs() < 0.03);
}

#[test]
fn sorting_changes_the_order_and_nothing_else() {
    let mut slope = Scalar::<Hencky>::paper_slope(0.5, 2);
    for _ in 0..49 {
        slope.step(0.002);
    }
    let (mass, kinetic, displacement) = (slope.mass(), slope.kinetic(), slope.max_displacement());
    slope.points.at.reverse();
    slope.points.velocity.reverse();
    slope.points.mass.reverse();
    slope.points.id.reverse();
    slope.sort();
    let cells: Vec<u32> = slope.points.at.iter().map(|at| Place::of(*at, 2.0).node(slope.nodes.stride)).collect();
    assert!(cells.is_sorted());
    assert!((slope.mass() / mass - 1.0).abs() < 1e-12);
    assert!((slope.kinetic() / kinetic - 1.0).abs() < 1e-12);
    assert_eq!(slope.max_displacement(), displacement);
}

#[test]
fn friction_is_capped_and_sticks() {
    let mut motion = [1.0, -2.0, 0.25, -0.5];
    assert!(!rub(&mut motion, 0.3));
    assert!((motion[0] - 0.4).abs() < 1e-15 && motion[1] == 0.0);
    assert!((motion[2] + 0.35).abs() < 1e-15 && motion[3] == 1.5);
    let mut motion = [0.5, -2.0, 0.5, -2.0];
    assert!(rub(&mut motion, 0.3));
    assert_eq!(motion, [0.0; 4]);
    let mut motion = [0.5, 2.0, 0.5, 2.0];
    assert!(!rub(&mut motion, 0.3));
    assert_eq!(motion, [0.5, 2.0, 0.5, 2.0]);
}
