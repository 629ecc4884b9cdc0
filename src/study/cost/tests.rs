//! The judgement of a study on made-up runs: rates, references, answers.

use super::{
    reference::{Point, ladders, reference},
    setting::{Setting, settings},
    *,
};

fn plan(vary: &[(&str, &[&str])]) -> Plan {
    let axis = |(key, values): &(&str, &[&str])| Axis {
        key: (*key).to_owned(),
        values: values.iter().map(|v| (*v).to_owned()).collect(),
    };
    Plan {
        name: "bar".to_owned(),
        text: case::template("bar").unwrap().to_owned(),
        overrides: vec!["grid.cell=1".to_owned()],
        vary: vary.iter().map(axis).collect(),
        levels: 3,
        quantity: None,
        runs: 1,
        jitter: 0.0,
        budget_s: 1e9,
        max_memory: u64::MAX,
        threads: 1,
        limits: Limits::NONE,
    }
}

fn all(plan: &Plan) -> Vec<Setting> {
    let (case, _) = case::read(&plan.name, &plan.text, &plan.overrides).unwrap();
    settings(plan, &case).unwrap().0
}

/// Rows with a value and a time for each setting.
fn rows(plan: &Plan, run: impl Fn(&Setting) -> (f64, f64)) -> Vec<Row> {
    let measured = |s: &Setting| {
        let (value, cpu_s) = run(s);
        let (value, cpu_s) = (Some(value), Some(cpu_s));
        Measured { status: Status::EndTime, fault: None, value, runs: None, cpu_s, repeats: 1, work: Work::default() }
    };
    all(plan).into_iter().map(|s| row(s.clone(), measured(&s))).collect()
}

fn judged(rows: &mut [Row], value: f64) -> Vec<Answer> {
    rows.iter_mut().for_each(|r| r.error = r.value.map(|v| (v - value).abs() / value));
    answer::answers(rows, "tip", Some(0.0))
}

fn refused(plan: &Plan) -> String {
    let (case, _) = case::read(&plan.name, &plan.text, &plan.overrides).unwrap();
    settings(plan, &case).unwrap_err()
}

#[test]
fn usual_settings_are_those_that_the_case_allows() {
    // 3 meshes x 2 shapes x (2 Courant numbers, 3 time steps)
    assert_eq!(all(&plan(&[])).len(), 3 * (ShapeFunctions::ALL.len() - 1) * (2 + 3));
    let mut small = plan(&[("solver.shape", &["linear"]), ("points.per_axis", &["2", "3"])]);
    small.text += "[solver]\nscheme = \"implicit\"\nkinematics = \"small\"\n";
    let (case, _) = case::read(&small.name, &small.text, &small.overrides).unwrap();
    let (settings, refused) = settings(&small, &case).unwrap();
    assert_eq!((settings.len(), refused.len()), (3 * 2 * 3, 3 * 2 * 2));
    assert!(refused[0].why.contains("kinematics"), "{}", refused[0].why);
    assert_eq!(settings[0].label(), "implicit, linear, h = 1, dt = 0.08, per_axis = 2");
}

#[test]
fn an_override_of_scheme_or_shape_holds_for_all_settings() {
    let mut plan = plan(&[]);
    plan.overrides.extend(["solver.scheme=implicit", "solver.shape=linear"].map(str::to_owned));
    // 3 meshes x 3 time steps
    let settings = all(&plan);
    assert_eq!(settings.len(), 3 * 3);
    assert!(settings.iter().all(|s| s.family() == "implicit, linear"), "{}", settings[0].label());
    plan.overrides.push("solver={scheme='explicit'}".to_owned());
    assert!(all(&plan).iter().all(|s| s.case.solver.scheme == Scheme::Explicit));
}

#[test]
fn values_of_one_key_come_together_and_each_once() {
    let twice = [("solver.shape", &["linear", "gimp"][..]), ("points.per_axis", &["2", "2"][..])];
    let mut plan = plan(&[twice[0], ("solver.shape", &["bspline", "linear"]), twice[1]]);
    let shapes = |plan: &Plan| {
        let mut words: Vec<&str> = all(plan).iter().map(|s| s.case.solver.shape.word()).collect();
        words.dedup();
        (words, all(plan).len())
    };
    let (words, count) = shapes(&plan);
    assert_eq!(words, ["linear", "gimp", "bspline", "linear", "gimp", "bspline"]);
    assert_eq!(count, 3 * 3 * (2 + 3));
    // 0.9 is the largest usual Courant number: there is one
    plan.overrides.push("explicit.courant=0.9".to_owned());
    assert_eq!(shapes(&plan).1, 3 * 3 * (1 + 3));
}

#[test]
fn a_wish_that_no_setting_can_have_is_told_as_by_the_reader() {
    let told = refused(&plan(&[("foo.bar", &["1", "2"])]));
    assert!(told.contains("unknown key `foo`") && told.contains("--set:1:1") && !told.contains("foo.bar=2"), "{told}");
    let told = refused(&plan(&[("solver.shape", &["linear", "cubic"])]));
    assert!(told.contains("solver.shape=cubic") && told.contains("--set:1:14"), "{told}");
    let told = refused(&plan(&[("solver.scheme", &["implicit"]), ("explicit.courant", &["0.5"])]));
    assert!(told.contains("no setting has explicit.courant"), "{told}");
    let told = cost(&Plan { jitter: -1.0, ..plan(&[]) }, &|_, _| {}).unwrap_err();
    assert!(told.contains("jitter.strength=-1.0") && told.contains("0.5"), "{told}");
}

#[test]
fn a_setting_refines_another_by_one_key() {
    let plan = plan(&[("solver.shape", &["gimp"]), ("points.per_axis", &["2", "3"])]);
    let all = all(&plan);
    let named = |words: &str| all.iter().find(|s| s.label() == words).unwrap();
    let coarse = named("implicit, gimp, h = 1, dt = 0.08, per_axis = 2");
    assert!(named("implicit, gimp, h = 0.5, dt = 0.08, per_axis = 2").refines(coarse));
    assert!(named("implicit, gimp, h = 1, dt = 0.005, per_axis = 2").refines(coarse));
    assert!(named("implicit, gimp, h = 1, dt = 0.08, per_axis = 3").refines(coarse));
    assert!(!coarse.refines(coarse) && !coarse.refines(named("implicit, gimp, h = 0.5, dt = 0.08, per_axis = 2")));
    assert!(!named("implicit, gimp, h = 0.5, dt = 0.005, per_axis = 2").refines(coarse));
}

/// value = 2 + 0.3 h^2 has order 2 and the limit 2, up to rounding of the differences.
#[test]
fn a_clean_ladder_gives_its_order_and_limit() {
    let all = all(&plan(&[("solver.shape", &["gimp"])]));
    let value = |s: &Setting| 2.0 + 0.3 * s.case.grid.cell.powi(2);
    let points: Vec<Point<'_>> = all.iter().map(|s| Point { setting: s, value: value(s), steps: 1 }).collect();
    let ladders = ladders(&points);
    assert_eq!(ladders.len(), 2 + 3);
    assert!(ladders.iter().all(|l| (l.order.unwrap() - 2.0).abs() < 1e-12 && (l.limit.unwrap() - 2.0).abs() < 1e-12));
    assert_eq!(ladders.iter().filter(|l| l.finest_step).count(), 2);
    let found = reference(None, &ladders, &points).unwrap();
    assert_eq!(found.basis, Basis::Richardson);
    assert!((found.value - 2.0).abs() < 1e-12 && found.floor().unwrap() < 1e-12);
    let exact = reference(Some((2.5, "a book".to_owned())), &ladders, &points).unwrap();
    assert_eq!((exact.basis, exact.value), (Basis::Exact, 2.5));
}

/// value = 2 + 0.3 h^2 + dt: steps of 0.005 s on the coarsest mesh alone give no limit in place of that with 0.02 s.
#[test]
fn finer_steps_on_coarse_meshes_alone_hide_no_limit() {
    let all = all(&plan(&[("solver.shape", &["gimp"]), ("solver.scheme", &["implicit"])]));
    let step = |s: &Setting| s.case.implicit.time_step;
    let ran = all.iter().filter(|s| step(s) > 0.01 || s.case.grid.cell == 1.0);
    let value = |s: &Setting| 2.0 + 0.3 * s.case.grid.cell.powi(2) + step(s);
    let points: Vec<Point<'_>> = ran.map(|s| Point { setting: s, value: value(s), steps: 1 }).collect();
    assert_eq!(points.len(), 3 + 3 + 1);
    let found = reference(None, &ladders(&points), &points).unwrap();
    assert_eq!(found.basis, Basis::Richardson);
    assert!((found.value - 2.02).abs() < 1e-12, "{}", found.value);
}

/// Steps of 0.02 s have the limit 2.02, those of 0.005 s none; the finest run, of these, gives 2.5.
#[test]
fn a_finest_run_is_doubted_by_the_limits_beside_it() {
    let all = all(&plan(&[("solver.shape", &["gimp"]), ("solver.scheme", &["implicit"])]));
    let value = |s: &Setting| {
        let (h, dt) = (s.case.grid.cell, s.case.implicit.time_step);
        let wild = if !(0.3..=0.7).contains(&h) { 2.5 } else { 1.0 };
        if dt < 0.01 { wild } else { 2.0 + 0.3 * h * h + dt }
    };
    let points: Vec<Point<'_>> = all
        .iter()
        .map(|s| Point { setting: s, value: value(s), steps: (1.0 / s.case.implicit.time_step) as u64 })
        .collect();
    let ladders = ladders(&points);
    let found = reference(None, &ladders, &points).unwrap();
    assert_eq!(found.basis, Basis::FinestRun);
    // the limit with steps of 0.02 s lies 0.48 below, that with 0.08 s 0.42
    assert!((found.uncertainty.unwrap() - 0.48).abs() < 1e-12, "{:?}", found.uncertainty);
}

#[test]
fn without_a_clean_rate_the_finest_run_is_the_reference() {
    let all = all(&plan(&[("solver.shape", &["gimp"])]));
    let value = |s: &Setting| 2.0 + (9.0 * s.case.grid.cell).sin();
    let points: Vec<Point<'_>> =
        all.iter().zip(0..).map(|(s, k)| Point { setting: s, value: value(s), steps: k }).collect();
    let found = reference(None, &ladders(&points), &points).unwrap();
    assert_eq!(found.basis, Basis::FinestRun);
    assert_eq!(found.setting, Some("implicit, gimp, h = 0.25, dt = 0.005".to_owned()));
    // the next finest run has the same mesh and value; h = 0.5 tells more
    assert!((found.uncertainty.unwrap() - (4.5f64.sin() - 2.25f64.sin()).abs()).abs() < 1e-12);
    let alone = reference(None, &[], &points[..1]).unwrap();
    assert_eq!((alone.uncertainty, alone.floor()), (None, None));
}

#[test]
fn answers_name_the_cheapest_setting_and_the_ratio() {
    let vary: [(&str, &[&str]); 3] =
        [("solver.shape", &["gimp"]), ("explicit.courant", &["0.25"]), ("implicit.time_step", &["0.02"])];
    let plan = Plan { levels: 4, ..plan(&vary) };
    // both err by 0.08 h^2; explicit 1 / h^3 s, implicit 0.2 / h^2 s
    let mut rows = rows(&plan, |s| {
        let h = s.case.grid.cell;
        let cost = if s.case.solver.scheme == Scheme::Explicit { h.powi(-3) } else { 0.2 * h.powi(-2) };
        (1.0 + 0.08 * h * h, cost)
    });
    let answers = judged(&mut rows, 1.0);
    assert_eq!(
        answers[0].text,
        "for 10 % in tip: implicit, gimp, h = 1, dt = 0.02: 0.2 s; \
         the cheapest explicit setting takes 1 s (5 times): explicit, gimp, h = 1, courant = 0.25"
    );
    assert_eq!(answers[1].picks[0].setting, "implicit, gimp, h = 0.25, dt = 0.02");
    assert!((answers[1].ratio.unwrap() - 20.0).abs() < 1e-12);
    assert!(answers[2].picks.is_empty() && answers[2].text.contains("no setting that was run gets there"));
}

/// The coarsest mesh hits the value by chance; the next one is off by 1.5 %, and the finest by 0.75 %.
#[test]
fn an_error_that_is_small_by_chance_is_no_answer() {
    let plan =
        plan(&[("solver.shape", &["gimp"]), ("solver.scheme", &["implicit"]), ("implicit.time_step", &["0.02"])]);
    let value = |h: f64| if h > 0.7 { 1.0 } else { 1.0 + 0.03 * h };
    let mut rows = rows(&plan, |s| (value(s.case.grid.cell), 1.0 / s.case.grid.cell));
    let answers = judged(&mut rows, 1.0);
    let pick = &answers[1].picks[0];
    assert!(pick.setting.contains("h = 0.25") && !pick.checked, "{}", answers[1].text);
    assert!(answers[1].text.contains("unchecked: no run refines it"), "{}", answers[1].text);
    assert!(answers[2].picks.is_empty());
    let unknown = answer::answers(&rows, "tip", None);
    let doubted: Vec<bool> = unknown.iter().map(|a| a.text.contains("not to be relied on")).collect();
    assert_eq!(doubted, [false, true, true]);
}

/// Errors of 2 %, 0.5 % and 0 with h = 1, 0.5, 0.25.
#[test]
fn neither_the_reference_nor_a_run_that_failed_checks_a_setting() {
    let plan =
        plan(&[("solver.shape", &["gimp"]), ("solver.scheme", &["implicit"]), ("implicit.time_step", &["0.02"])]);
    let error = |h: f64| if h < 0.3 { 0.0 } else { 0.02 * h * h };
    let mut rows = rows(&plan, |s| (1.0 + error(s.case.grid.cell), 1.0 / s.case.grid.cell));
    let first = |answers: &[Answer], k: usize| answers[k].picks.first().map(|p| (p.setting.clone(), p.checked));
    let named = |h: &str| format!("implicit, gimp, h = {h}, dt = 0.02");
    let answers = judged(&mut rows, 1.0);
    assert_eq!(first(&answers, 0), Some((named("1"), true)));
    assert_eq!(first(&answers, 1), Some((named("0.5"), true)));
    rows[2].is_reference = true;
    let answers = judged(&mut rows, 1.0);
    assert_eq!(first(&answers, 0), Some((named("1"), true)));
    assert_eq!(first(&answers, 1), Some((named("0.5"), false)));
    rows[1].fault = Some("a step is too long".to_owned());
    let answers = judged(&mut rows, 1.0);
    assert_eq!((first(&answers, 0), first(&answers, 1)), (None, None), "{}", answers[0].text);
}

/// No energy is lost to plasticity in an elastic bar.
#[test]
fn there_are_no_shares_of_a_reference_of_zero() {
    let mut plan = Plan { levels: 1, quantity: Some("plastic".to_owned()), ..plan(&[("solver.shape", &["linear"])]) };
    plan.overrides.push("end.time=0.1".to_owned());
    let study = cost(&plan, &|_, _| {}).unwrap();
    assert!(study.rows.iter().all(|r| r.error == Some(0.0)) && study.answers.is_empty());
    let text = table(&study);
    assert!(text.contains("the reference is 0: there are no shares") && !text.contains("error (%)"), "{text}");
}

#[test]
fn prices_learn_and_the_budget_ends() {
    let all = all(&plan(&[]));
    let mut prices = Prices::new(1.0);
    let guess = prices.predict(&all[0], 1);
    assert!(prices.reserve(0.6) && !prices.reserve(0.6));
    prices.pay(&all[0], 0.6, 0.2, 10.0 * guess);
    assert!((prices.predict(&all[0], 2) / guess - 20.0).abs() < 1e-9);
    assert!(prices.reserve(0.7) && !prices.reserve(0.2));
}
