use super::*;

fn rotate_in_steps<K: Kinematics>(e: Voigt, steps: usize) -> Voigt {
    let angle = std::f64::consts::FRAC_PI_2 / steps as f64;
    let (s, c) = angle.sin_cos();
    let du = Gradient { xx: c - 1.0, xy: -s, yx: s, yy: c - 1.0 };
    (0..steps).fold(e, |e, _| K::trial_exact(e, du).strain)
}

fn quarter_turn_error<K: Kinematics>(steps: usize) -> f64 {
    let e = Voigt::new(0.01, -0.02, 0.0, 0.005);
    let turned = rotate_in_steps::<K>(e, steps);
    let gap = turned - Voigt::new(e.yy, e.xx, 0.0, -e.xy);
    gap.dot(gap).sqrt()
}

#[test]
fn hencky_is_objective_for_any_step() {
    assert!(quarter_turn_error::<Hencky>(1) < 1e-15);
    assert!(quarter_turn_error::<Hencky>(7) < 1e-15);
}

#[test]
fn rate_is_objective_to_first_order() {
    // sym(grad du) of a finite rotation is O(dt^2) a step, so O(dt) in all
    let (coarse, fine) = (quarter_turn_error::<Rate>(1000), quarter_turn_error::<Rate>(2000));
    let order = (coarse / fine).log2();
    assert!((order - 1.0).abs() < 0.05, "order {order}");
}

#[test]
fn both_agree_with_small_strain() {
    let e = Voigt::new(1e-4, -2e-4, 1e-4, 3e-4);
    let du = Gradient { xx: 1e-8, xy: 2e-8, yx: -1e-8, yy: 3e-8 };
    let gap = Hencky::trial(e, du).strain - Rate::trial(e, du).strain;
    // they differ by strain x step
    assert!(gap.dot(gap).sqrt() < 1e-4 * 5e-8);
}

/// d strain / d l by central differences: F -> (I + l) F.
fn rate_by_differences<K: Kinematics>(e: Voigt, du: Gradient) -> StrainRate {
    let h = 1e-6;
    let f = deformation::<K>(du);
    let moved = |k: usize, by: f64| {
        let mut l = [0.0; 4];
        l[k] = by;
        let [a, b, c, d] = l;
        Gradient {
            xx: du.xx + a * f.xx + b * f.yx,
            xy: du.xy + a * f.xy + b * f.yy,
            yx: du.yx + c * f.xx + d * f.yx,
            yy: du.yy + c * f.xy + d * f.yy,
        }
    };
    let mut out = StrainRate::zeros();
    for k in 0..4 {
        let gap = K::trial_exact(e, moved(k, h)).strain - K::trial_exact(e, moved(k, -h)).strain;
        let column = (gap * (0.5 / h)).to_array();
        for row in 0..4 {
            out[(row, k)] = if row == 3 { 2.0 * column[3] } else { column[row] };
        }
    }
    out
}

fn strain_rate_is_the_derivative<K: Kinematics>() {
    for (e, du) in [
        (Voigt::default(), Gradient::default()),
        (Voigt::new(0.02, -0.03, 0.01, 0.015), Gradient { xx: 0.01, xy: -0.02, yx: 0.03, yy: -0.015 }),
        (Voigt::new(0.4, -0.5, 0.1, 0.3), Gradient { xx: 0.2, xy: -0.3, yx: 0.25, yy: -0.1 }),
        (Voigt::new(0.1, 0.1, 0.0, 0.0), Gradient { xx: 0.1, xy: 0.0, yx: 0.0, yy: 0.1 }),
    ] {
        let rate = K::strain_rate(e, K::trial_exact(e, du).strain, du);
        let gap = (rate - rate_by_differences::<K>(e, du)).amax();
        assert!(gap < 1e-9 * rate.amax().max(1.0), "{}: {gap:e} at {e:?} {du:?}", K::NAME);
    }
}

#[test]
fn strain_rates_are_derivatives() {
    strain_rate_is_the_derivative::<Hencky>();
    strain_rate_is_the_derivative::<Rate>();
    strain_rate_is_the_derivative::<Small>();
}

fn dilate_changes_the_trace_alone<K: Kinematics>() {
    let e = Voigt::new(0.02, -0.03, 0.01, 0.015);
    let du = Gradient { xx: 0.01, xy: -0.02, yx: 0.03, yy: -0.015 };
    let (before, after) = (K::trial_exact(e, du).strain, K::trial_exact(e, K::dilate(du, 0.04)).strain);
    let gap = after - before - Voigt::new(0.02, 0.02, 0.0, 0.0);
    assert!(gap.dot(gap).sqrt() < 1e-15);
    let theta = K::dilatation(K::dilate(du, 0.04)) - K::dilatation(du);
    assert!((theta - 0.04).abs() < 1e-15);
}

#[test]
fn dilatation_is_a_part_of_the_strain() {
    dilate_changes_the_trace_alone::<Hencky>();
    dilate_changes_the_trace_alone::<Small>();
}

#[test]
fn small_strain_adds_up_and_keeps_the_volume() {
    let du = Gradient { xx: 0.5, xy: 0.25, yx: -0.125, yy: 0.0 };
    let once = Small::trial(Voigt::default(), du);
    assert_eq!(once.strain, Voigt::new(0.5, 0.0, 0.0, 0.0625));
    assert_eq!(Small::trial(once.strain, du).strain, once.strain + once.strain);
    assert_eq!(once.jacobian, 1.0);
}
