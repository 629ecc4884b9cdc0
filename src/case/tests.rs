//! Defaults, overrides and round trips.

use super::*;

const SMALL: &str = r#"
[grid]
cell = 0.5
size = [10.0, 4.0]

[end]
time = 1.0

[material.clay]
law = "von_mises"
unit_weight = 18.0
young_modulus = 1e3
poisson_ratio = 0.3
cohesion = 20.0

[[region]]
material = "clay"
polygon = [[0, 0], [6, 0], [4, 2], [0, 2]]
"#;

fn with(overrides: &[&str]) -> Result<Case, String> {
    let overrides: Vec<_> = overrides.iter().map(|text| (*text).to_owned()).collect();
    read("small.toml", SMALL, &overrides).map(|(case, _)| case).map_err(|e| e.render(false))
}

fn errors(text: &str, overrides: &[&str]) -> Vec<String> {
    let overrides: Vec<_> = overrides.iter().map(|text| (*text).to_owned()).collect();
    let found = read("case.toml", text, &overrides).expect_err("the case has errors");
    found.errors().iter().map(|e| format!("{}:{}: {}", e.line, e.column, e.message)).collect()
}

#[test]
fn keys_left_out_have_the_documented_defaults() {
    let case = with(&[]).expect("a valid case");
    assert_eq!((case.title.as_str(), case.seed), ("untitled", 1));
    assert_eq!(case.grid.origin, [0.0, 0.0]);
    let points = Points { layout: Layout::Gauss, per_axis: 2, cut_cells: CutCells::Full };
    assert_eq!(case.points, points);
    assert_eq!(case.solver.kinematics, Kinematics::Hencky);
    let explicit = Explicit {
        stress_update: StressUpdate::Musl,
        pic_rate: Some(0.5),
        courant: 0.25,
        time_step: None,
        mass_floor: 0.0,
    };
    assert_eq!(case.explicit, explicit);
    let solver = Solver {
        scheme: Scheme::Explicit,
        kinematics: Kinematics::Hencky,
        locking: Locking::None,
        shape: ShapeFunctions::Linear,
        transfer: Transfer::Flip,
    };
    assert_eq!((case.solver, case.load, case.drive), (solver, vec![], vec![]));
    assert_eq!(case.gravity.schedule, GravitySchedule::Ramp { ramp_time: 5.0 });
    assert_eq!(case.output, Output { history: 0.05, frames: 0.25, pictures: vec![] });
    assert_eq!((case.end.at_rest, case.end.rest_energy, case.end.rest_hold), (true, 1e-3, 4.0));
    assert_eq!((case.boundary.left, case.slide), (Side::Free, None));
    let Some(Material::VonMises { strength, .. }) = case.material.get("clay") else {
        panic!("clay is a von Mises soil");
    };
    assert_eq!((strength.residual_cohesion, strength.yield_constant), (20.0, 3f64.sqrt()));
    assert_eq!(case.region[0].name, "region 1");
}

#[test]
fn the_implicit_keys_have_the_documented_defaults() {
    let implicit = Implicit {
        regime: Regime::Auto { inertia: Inertia::Newmark },
        time_step: 0.02,
        min_time_step: 0.02 / 1024.0,
        max_time_step: 0.02,
        tolerance: None,
        residual: 1e-9,
        absolute_residual: None,
        max_iterations: 12,
        line_search: true,
        pic_rate: Some(0.5),
        ordering: Ordering::Auto,
        symmetric: Symmetric::Auto,
        unsymmetric: Unsymmetric::Auto,
        ghost_stiffness: 0.0,
        ghost_mass: 0.0,
    };
    assert_eq!(with(&[]).expect("a valid case").implicit, implicit);
}

#[test]
fn the_bounds_of_the_implicit_step_follow_it() {
    let steps = |keys: &[&str]| with(keys).map(|c| (c.implicit.min_time_step, c.implicit.max_time_step));
    assert_eq!(steps(&["implicit.time_step=0.1"]), Ok((0.1 / 1024.0, 0.1)));
    let keys = ["implicit.time_step=0.1", "implicit.min_time_step=0.1", "implicit.max_time_step=1"];
    assert_eq!(steps(&keys), Ok((0.1, 1.0)));
    let long = steps(&["implicit.max_time_step=0.01"]).expect_err("shorter than the first step");
    assert!(long.contains("must be at least 0.02 s"), "{long}");
}

#[test]
fn hht_alpha_belongs_to_hht() {
    let regime = |keys: &[&str]| with(keys).map(|c| c.implicit.regime);
    assert_eq!(regime(&["implicit.regime=hht"]), Ok(Regime::Hht { hht_alpha: 0.1 }));
    let inertia = Inertia::Hht { hht_alpha: 0.2 };
    assert_eq!(regime(&["implicit.inertia=hht", "implicit.hht_alpha=0.2"]), Ok(Regime::Auto { inertia }));
    assert!(regime(&["implicit.hht_alpha=0.2"]).expect_err("newmark").contains("a key of inertia \"hht\""));
    let still = regime(&["implicit.regime=quasi_static", "implicit.inertia=newmark"]);
    assert!(still.expect_err("no inertia").contains("has no meaning with regime = \"quasi_static\""));
    assert!(
        regime(&["implicit.regime=hht", "implicit.hht_alpha=0.4"]).expect_err("too large").contains("out of range")
    );
    // of the file it lapses where an override chooses another integrator
    let text = format!("{SMALL}[implicit]\nregime = \"hht\"\nhht_alpha = 0.2\n");
    for set in ["implicit.regime=auto", "implicit.regime=newmark"] {
        let (case, _) = read("case.toml", &text, &[set.to_owned()]).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(case.implicit.regime.inertia(), Some(Inertia::Newmark));
    }
}

#[test]
fn strain_measures_go_with_their_schemes() {
    let kinematics = |keys: &[&str]| with(keys).map(|c| c.solver.kinematics);
    let implicit = "solver.scheme=implicit";
    assert_eq!(kinematics(&[implicit, "solver.kinematics=small"]), Ok(Kinematics::Small));
    assert!(kinematics(&[implicit, "solver.kinematics=rate"]).expect_err("rate").contains("explicit only"));
    assert!(kinematics(&["solver.kinematics=small"]).expect_err("small").contains("implicit only"));
}

#[test]
fn loads_and_drives_go_by_name_or_number() {
    let text = format!(
        "{SMALL}[[load]]\nbox = [[0, 1], [2, 2]]\nforce = [0, -5]\n\
         [[drive]]\nname = \"footing\"\nbox = [[0, 2], [1, 2]]\nvelocity_y = -0.1\n"
    );
    let sets = ["load.load 1.ramp_time=2", "drive.footing.until=3", "load.0.force=[1, 0]"].map(str::to_owned);
    let (case, _) = read("case.toml", &text, &sets).unwrap_or_else(|e| panic!("{e}"));
    let load = Load { name: "load 1".into(), area: [[0.0, 1.0], [2.0, 2.0]], force: [1.0, 0.0], ramp_time: 2.0 };
    let drive = Drive {
        name: "footing".into(),
        area: [[0.0, 2.0], [1.0, 2.0]],
        velocity_x: None,
        velocity_y: Some(-0.1),
        moving: true,
        until: Some(3.0),
    };
    assert_eq!((&case.load[..], &case.drive[..]), (&[load][..], &[drive][..]));
    let (again, _) = read("again", &case.to_toml(), &[]).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(case, again);
}

#[test]
fn probes_lie_in_the_soil_and_go_by_name() {
    let text = format!("{SMALL}[[probe]]\nname = \"crest\"\nat = [4, 2]\nquantity = \"displacement_x\"\n");
    let sets = ["probe.crest.exact=0.5", "probe.crest.source='by hand'"].map(str::to_owned);
    let (case, _) = read("case.toml", &text, &sets).unwrap_or_else(|e| panic!("{e}"));
    let quantity = ProbeQuantity::DisplacementX;
    let probe =
        Probe { name: "crest".into(), at: [4.0, 2.0], quantity, exact: Some(0.5), source: Some("by hand".into()) };
    assert_eq!(case.probe, [probe]);
    let (again, _) = read("again", &case.to_toml(), &[]).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(case, again);
    for quantity in ProbeQuantity::ALL {
        let set = [format!("probe.0.quantity={}", quantity.word())];
        assert_eq!(read("case.toml", &text, &set).map(|(case, _)| case.probe[0].quantity).ok(), Some(quantity));
    }
}

#[test]
fn loading_ends_when_nothing_grows_or_moves_any_more() {
    let end = |sets: &[&str]| with(sets).expect("valid").loading_end();
    let load = "load=[{box=[[0, 0], [1, 1]], force=[0, -1], ramp_time=7}]";
    let drive = "drive=[{box=[[0, 0], [1, 1]], velocity_y=-0.1}]";
    assert_eq!((end(&[]), end(&[load]), end(&[drive])), (5.0, 7.0, f64::INFINITY));
    assert_eq!(end(&[load, drive, "drive.0.until=9"]), 9.0);
    assert_eq!(end(&[drive, "drive.0.velocity_y=0"]), 5.0);
}

#[test]
fn shape_functions_come_back_from_the_resolved_text() {
    assert_eq!(with(&[]).expect("a valid case").solver.shape, ShapeFunctions::Linear);
    let shapes =
        [("gimp", ShapeFunctions::Gimp), ("gimp_wide", ShapeFunctions::GimpWide), ("bspline", ShapeFunctions::Bspline)];
    for (word, shape) in shapes {
        let case = with(&[&format!("solver.shape={word}")]).expect("a valid case");
        assert_eq!(case.solver.shape, shape);
        assert_eq!(read("case.toml", &case.to_toml(), &[]).map(|(c, _)| c).ok(), Some(case));
    }
    assert!(with(&["solver.shape=spline"]).expect_err("not there").contains("gimp_wide"));
}

#[test]
fn transfers_come_back_from_the_resolved_text_with_the_keys_that_are_theirs() {
    let of = |keys: &[&str]| with(keys).expect("a valid case");
    assert_eq!(of(&["solver.transfer=xpic"]).solver.transfer, Transfer::Xpic { xpic_order: 5 });
    for keys in [&["solver.transfer=apic"][..], &["solver.transfer=xpic", "solver.xpic_order=2"]] {
        let case = of(keys);
        assert_eq!((case.explicit.pic_rate, case.implicit.pic_rate), (None, None));
        assert!(!case.to_toml().contains("pic_rate"));
        assert_eq!(read("case.toml", &case.to_toml(), &[]).map(|(c, _)| c).ok(), Some(case));
    }
    assert_eq!(of(&["solver.transfer=apic"]).explicit.mass_floor, 1e-2);
    let grown = of(&["solver.transfer=apic"]).memory_estimate_bytes() - of(&[]).memory_estimate_bytes();
    assert!(grown > 0, "the columns of APIC are counted");
    let slope = include_str!("../../cases/clay-slope.toml");
    let lapsed = read("slope", slope, &["solver.transfer=apic".to_owned()]).expect("the rate of the file lapses").0;
    assert_eq!(lapsed.explicit.pic_rate, None);
    for wrong in [&["solver.transfer=apic", "explicit.pic_rate=0.5"][..], &["solver.xpic_order=3"]] {
        assert!(with(wrong).expect_err("of another transfer").contains("has no meaning with"), "{wrong:?}");
    }
}

#[test]
fn the_mass_floor_follows_the_stress_update() {
    let case = with(&["explicit.stress_update=usl"]).expect("a valid case");
    assert_eq!(case.explicit.mass_floor, 1e-3);
}

#[test]
fn slide_is_measured_on_the_soil() {
    let case = with(&["slide={}"]).expect("a valid case");
    let slide = case.slide.expect("a slide");
    assert_eq!((slide.crest, slide.threshold, slide.censored_above), ([4.0, 2.0], 0.1, 3.6));
    assert_eq!(slide.also, [0.2]);
}

#[test]
fn every_template_reads_without_warning_and_comes_back_from_its_resolved_text() {
    for name in TEMPLATES {
        let text = template(name).expect("a template");
        let (case, warnings) = read(name, text, &[]).unwrap_or_else(|e| panic!("{e}"));
        assert!(warnings.is_empty(), "{}", warnings[0].render(false));
        let (again, _) = read(name, &case.to_toml(), &[]).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(case, again);
    }
}

#[test]
fn every_variant_comes_back_from_its_resolved_text() {
    let variants: &[&[&str]] = &[
        &["gravity.schedule=none", "grid.cell=5/29", "seed=9223372036854775807"],
        &["gravity.schedule=at_once", "initial_stress={kind=\"k0\", k0=0.5}"],
        &["gravity.schedule=normal_first", "gravity.tilt=30", "gravity.tangential_time=0.1"],
        &["gravity.schedule=elastic_first", "output.pictures=[1, 2.5]", "explicit.time_step=1e-3"],
        &["initial_stress={kind=\"given\", xx=-1, yy=-2, zz=-1}", "solver.kinematics=rate"],
        &["region.0.circle={center=[2,2], radius=1.5}", "region.0.spin={rate=1, center=[2,2]}"],
        &["boundary.base={kind=\"friction\", coefficient=0.3}", "boundary.left=roller"],
        &["region.0.name=\"a \\\"quoted\\\" name\"", "title='# [x]'", "slide.crest=[4, 2]"],
        &["solver={scheme=\"implicit\", kinematics=\"small\", locking=\"b_bar\"}", "implicit.regime=quasi_static"],
        &["implicit={inertia=\"hht\", hht_alpha=0.05, tolerance=1e-3, absolute_residual=1e-6, ordering=\"amd\"}"],
        &["implicit={regime=\"hht\", time_step=0.1, max_time_step=1, unsymmetric=\"gmres\", ghost_stiffness=0.1}"],
        &[
            "implicit={regime=\"backward_euler\", line_search=false, symmetric=\"pcg\", ordering=\"nested_dissection\", ghost_mass=1}",
        ],
        &["material.clay.law=elastic", "material.clay.density=1.7", "material.clay.cohesion=1"],
    ];
    let last = variants.len() - 1;
    for overrides in &variants[..last] {
        let case = with(overrides).unwrap_or_else(|e| panic!("{e}"));
        let (again, _) = read("again", &case.to_toml(), &[]).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(case, again);
    }
    assert!(with(variants[last]).expect_err("no cohesion").contains("has no meaning"));
}

#[test]
fn keys_of_the_file_lapse_when_an_override_chooses_another_variant() {
    let case = with(&["material.clay.law=elastic", "material.clay.density=2"]).expect("valid");
    assert_eq!(case.material["clay"].elastic().unit_weight, 2.0 * 9.81);
    let case = with(&["region.0.circle={center=[2,2], radius=1}"]).expect("valid");
    assert!(matches!(case.region[0].shape, RegionShape::Circle { .. }));
}

#[test]
fn a_bare_side_takes_overrides_of_its_keys() {
    let text = format!("{SMALL}[boundary]\nbase = \"roller\"\n");
    let sets = ["boundary.base.kind=friction", "boundary.base.coefficient=0.2"].map(str::to_owned);
    let (case, _) = read("case.toml", &text, &sets).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(case.boundary.base, Side::Friction { coefficient: 0.2, separation: true });
}

#[test]
fn the_last_override_wins_and_regions_go_by_name_too() {
    let case = with(&["end.time=2", "end.time=3", "region.region 1.velocity=[1,0]"]).expect("valid");
    assert_eq!((case.end.time, case.region[0].velocity), (3.0, [1.0, 0.0]));
}

#[test]
fn errors_come_in_the_order_of_the_file() {
    let text = SMALL.replace("cell = 0.5", "cell = -1").replace("time = 1.0", "tme = 1.0");
    let found = errors(&text, &["seed=-1"]);
    assert_eq!(
        found,
        [
            "3:8: `grid.cell` = -1 is out of range",
            "6:1: `end.time` is missing",
            "7:1: unknown key `end.tme`",
            "1:6: `seed` = -1 is out of range",
        ]
    );
}

#[test]
fn warnings_do_not_stop_a_case() {
    let unused = "[material.spare]\nlaw = \"elastic\"\nunit_weight = 1\nyoung_modulus = 1\npoisson_ratio = 0\n";
    let text = format!("{SMALL}{unused}");
    let (_, warnings) = read("case.toml", &text, &[]).expect("a valid case");
    assert_eq!(warnings[0].message, "material `spare` is not used");
    assert_eq!(warnings[0].severity, Severity::Warning);
}

#[test]
fn unsound_soils_are_refused() {
    let soft = |key: &str| with(&[key]).expect_err(key);
    assert!(soft("material.clay.softening_modulus=-700").contains("-444.1 kPa"));
    let both = ["material.clay.residual_cohesion=30", "material.clay.softening_modulus=-1"];
    assert!(with(&both).expect_err("stronger").contains("softens: at most 20"));
    for poisson_ratio in ["0.5", "-1", "nan"] {
        let set = format!("material.clay.poisson_ratio={poisson_ratio}");
        assert!(soft(&set).contains("greater than -1 and less than 0.5"));
    }
    assert!(soft("material.clay.cohesion=0").contains("is out of range"));
}

#[test]
fn a_regularisation_needs_a_length_and_takes_it_along() {
    let found = |keys: &[&str]| {
        with(keys).map(|c| match c.material["clay"] {
            Material::VonMises { strength, .. } => strength.regularisation,
            Material::Elastic { .. } => panic!("clay has a strength"),
        })
    };
    let (energy, length) = ("material.clay.regularisation=fracture_energy", "material.clay.reference_length=0.25");
    assert_eq!(found(&[]), Ok(Regularisation::None));
    assert_eq!(found(&[energy, length]), Ok(Regularisation::FractureEnergy { reference_length: 0.25 }));
    assert!(found(&[energy]).expect_err("no length").contains("the width of the shear band"));
    assert!(found(&[length]).expect_err("no use").contains("has no meaning with regularisation = \"none\""));
    let (nonlocal, weight) = ("material.clay.regularisation=nonlocal", "material.clay.nonlocal_weight=3");
    let usual = Regularisation::Nonlocal { reference_length: 0.25, nonlocal_weight: 2.0 };
    assert_eq!(found(&[nonlocal, length]), Ok(usual));
    assert!(
        found(&[nonlocal, length, "material.clay.nonlocal_weight=1"]).expect_err("m").contains("between 1.2 and 5")
    );
    assert!(found(&[energy, length, weight]).expect_err("no use").contains("a key of regularisation \"nonlocal\""));
    // of the file it lapses where an override chooses
    let keys = "regularisation = \"fracture_energy\"\nreference_length = 0.25\n";
    let text = SMALL.replace("cohesion = 20.0\n", &format!("cohesion = 20.0\n{keys}"));
    let (case, _) = read("case.toml", &text, &[]).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(read("again", &case.to_toml(), &[]).unwrap_or_else(|e| panic!("{e}")).0, case);
    assert!(read("case.toml", &text, &["material.clay.regularisation=none".to_owned()]).is_ok());
}

#[test]
fn memory_grows_with_points_and_grid() {
    let small = with(&[]).expect("valid").memory_estimate_bytes();
    let points = (1.1 * 10.0 / 0.25 * 4.0 * 700.0) as u64;
    assert_eq!(small, points + 4 * 21 * 9);
}

#[test]
fn a_crest_needs_soil() {
    assert!(with(&["slide.crest=[9,3]"]).expect_err("air").contains("outside the soil"));
    let circle = ["region.0.circle={center=[2,2], radius=1}", "slide={}"];
    assert!(with(&circle).expect_err("no crest").contains("no crest can be found"));
}

#[test]
fn long_files_and_deep_keys_are_refused() {
    assert!(errors(&" ".repeat((1 << 20) + 1), &[])[0].contains("bytes"));
    assert!(errors(&"a.".repeat(100_000), &[])[0].contains("too many parts"));
    assert!(!errors(&"[".repeat(100_000), &[]).is_empty());
}

#[test]
fn many_errors_are_counted() {
    let corners = "[nan, 0], ".repeat(2000);
    let text = SMALL.replace("[[0, 0],", &format!("[{corners}"));
    let found = read("case.toml", &text, &[]).expect_err("many errors");
    assert_eq!(found.errors().len(), 1000);
    assert!(found.render(false).ends_with("... and 1980 more"));
}

#[test]
fn a_level_of_the_guard_is_a_share_or_false() {
    let off = with(&["guard.warning=false", "guard.fault=0.5"]).expect("a valid case");
    assert_eq!(off.guard, Guard { warning: None, fault: Some(0.5) });
    let (again, _) = read("again.toml", &off.to_toml(), &[]).expect("the resolved case");
    assert_eq!(again.guard, off.guard);
}
