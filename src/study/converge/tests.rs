//! The judgement of made-up ladders: clean, noisy, with differences of two signs.

use super::{
    axis,
    judge::{Judgement, Samples, Verdict, judge},
    *,
};

fn single(sizes: &[f64], values: &[f64]) -> Judgement {
    judge(&Samples { sizes: sizes.to_vec(), values: values.iter().map(|v| vec![*v]).collect(), paired: false })
}

/// Levels of v(h) with a noise of `sd` that is the same in all runs of the tests.
fn noisy(sizes: &[f64], runs: usize, sd: f64, v: impl Fn(f64) -> f64) -> Samples {
    // points of a low-discrepancy sequence as a smooth, bounded, symmetric noise
    let noise = |level: usize, k: usize| {
        let u = ((level * 101 + k + 1) as f64 * 0.618_033_988_749_895).fract();
        sd * (12.0_f64).sqrt() * (u - 0.5)
    };
    let level = |(l, h): (usize, &f64)| (0..runs).map(|k| v(*h) + noise(l, k)).collect();
    Samples { sizes: sizes.to_vec(), values: sizes.iter().enumerate().map(level).collect(), paired: false }
}

const H: [f64; 4] = [1.0, 0.5, 0.25, 0.125];

/// 2 + 0.3 h^2 + 0.01 h^3: the rates of three levels in a row come near 2 from above, and the fit lies between them.
#[test]
fn a_clean_ladder_has_rate_limit_and_bounds() {
    let told = single(&H, &H.map(|h| 2.0 + 0.3 * h * h + 0.01 * h.powi(3)));
    let Verdict::Clean { rate, limit, uncertainty } = told.verdict else { panic!("{:?}", told.verdict) };
    let [low, high] = rate.interval.unwrap();
    assert!(2.0 < low && low <= rate.value && rate.value <= high && high < 2.05, "{rate:?}");
    assert!((limit - 2.0).abs() <= uncertainty && uncertainty < 1e-3, "{limit} {uncertainty}");
    assert!(told.differences.iter().all(|d| d.interval.is_none()));
    // three levels of uneven ratios: exact, but with no interval of its own
    let h = [0.5, 0.25, 5.0 / 29.0];
    let Verdict::Clean { rate, limit, .. } = single(&h, &h.map(|h| 2.0 - h)).verdict else { panic!() };
    assert!((rate.value - 1.0).abs() < 1e-10 && rate.interval.is_none() && (limit - 2.0).abs() < 1e-10);
}

#[test]
fn what_does_not_converge_is_told() {
    let told = |values: &[f64]| single(&H[..values.len()], values).verdict;
    assert_eq!(told(&[1.0, 4.1, 3.3]), Verdict::SignChange);
    assert!(matches!(told(&[1.0, 2.0, 4.0]), Verdict::NoDecay { rate: Some(p) } if (p + 1.0).abs() < 1e-9));
    assert!(matches!(told(&[1.0, 2.0, 2.9]), Verdict::OddRate { rate } if rate.value > 0.0 && rate.value < 0.5));
    assert!(matches!(told(&[1.0, 2.0, 2.01]), Verdict::OddRate { rate } if rate.value > 4.5));
    // falls at first, and then no more
    assert!(matches!(told(&[1.0, 2.0, 2.5, 3.1]), Verdict::NoDecay { .. }));
    assert_eq!(
        (told(&[1.0, 2.0]), told(&[1.0]), told(&[])),
        (Verdict::TwoLevels, Verdict::NoValues, Verdict::NoValues)
    );
    assert_eq!(told(&[3.0, 3.0, 3.0 + 1e-15]), Verdict::Same);
}

/// Noise of 0.002 beside differences down to 0.028: the interval holds the rate, the limit is within four times what
/// is known of it (two would fail one seed in twenty).
#[test]
fn scatter_gives_rate_and_limit_intervals() {
    let told = judge(&noisy(&H, 20, 0.002, |h| 2.0 + 0.6 * h * h));
    let Verdict::Clean { rate, limit, uncertainty } = told.verdict else { panic!("{:?}", told.verdict) };
    let [low, high] = rate.interval.unwrap();
    assert!(low < rate.value && rate.value < high && high - low < 0.5, "{rate:?}");
    assert!((rate.value - 2.0).abs() < 2.0 * (high - low), "{rate:?}");
    assert!((limit - 2.0).abs() < 4.0 * uncertainty && uncertainty < 0.01, "{limit} {uncertainty}");
}

#[test]
fn noise_is_no_rate() {
    // the last difference, 0.009 h-wise, drowns
    let drowned = judge(&noisy(&H, 10, 0.5, |h| 2.0 + 0.1 * h * h));
    assert!(matches!(drowned.verdict, Verdict::Unresolved { bound, .. } if bound < 2.0), "{:?}", drowned.verdict);
    // the last difference, 0.19, is resolved; the first, 0.75, has a standard error of about 0.3, and so a rate from
    // below 0 to 3
    let mut vague = noisy(&H[..3], 12, 0.9, |h| 2.0 + h * h);
    vague.values[1..].iter_mut().zip([2.25, 2.0625]).for_each(|(level, v)| level.fill(v));
    let vague = judge(&vague);
    assert!(matches!(vague.verdict, Verdict::Uncertain { .. }), "{:?}", vague.verdict);
}

/// Realisations that differ by 10 while the levels differ by 0.3: pairs tell the rate, medians of strangers do not.
#[test]
fn pairs_resolve_what_strangers_do_not() {
    let value =
        |k: usize, h: f64| 10.0 * (k as f64 * 0.618_033_988_749_895).fract() + (0.3 + 0.01 * (k % 3) as f64) * h;
    let values: Vec<Vec<f64>> = H.iter().map(|h| (0..12).map(|k| value(k, *h)).collect()).collect();
    let samples = |paired| Samples { sizes: H.to_vec(), values: values.clone(), paired };
    let Verdict::Clean { rate, .. } = judge(&samples(true)).verdict else { panic!() };
    assert!((rate.value - 1.0).abs() < 1e-6, "{rate:?}");
    assert!(matches!(judge(&samples(false)).verdict, Verdict::Unresolved { .. }));
}

fn bar(sets: &[&str]) -> (Plan, Case) {
    let overrides: Vec<String> = sets.iter().map(|s| (*s).to_owned()).collect();
    let text = case::template("bar").unwrap().to_owned();
    let (case, _) = case::read("bar", &text, &overrides).unwrap();
    let plan = Plan {
        name: "bar".to_owned(),
        text,
        overrides,
        variants: Vec::new(),
        ladders: Vec::new(),
        quantities: Vec::new(),
        draws: Draws::Single,
        max_memory: u64::MAX,
        threads: 2,
        limits: Limits::NONE,
    };
    (plan, case)
}

#[test]
fn usual_ladders_start_from_the_case() {
    let (mut plan, case) = bar(&["grid.cell=1", "end.time=1"]);
    plan.ladders = axis::paper(&case).into_iter().chain(Axis::TimeStep.usual(&case)).collect();
    let scheme = scheme(&plan).unwrap();
    // the case as it is stands in all three, and is run once
    assert_eq!(scheme.variants.len(), 1 + 1 + 1 + 2);
    assert!(scheme.ladders.iter().all(|(_, levels)| levels.contains(&0)));
    let sizes = |k: usize| -> Vec<f64> {
        let (axis, levels) = &scheme.ladders[k];
        levels.iter().map(|l| axis.size(&scheme.variants[*l].1)).collect()
    };
    assert_eq!((sizes(0), sizes(1), sizes(2)), (vec![1.0, 20.0 / 29.0], vec![0.5, 0.25], vec![0.5, 0.25, 0.125]));
}

#[test]
fn implicit_steps_take_their_bounds_along() {
    let (plan, case) = bar(&["solver.scheme=implicit", "implicit.time_step=0.1", "implicit.max_time_step=0.4"]);
    let steps = Axis::TimeStep.usual(&case).unwrap();
    let (finest, _) = prepare(&plan, &steps.levels[2], &[]).unwrap();
    assert_eq!((finest.implicit.time_step, finest.implicit.max_time_step), (0.025, 0.1));
    assert_eq!(finest.implicit.min_time_step, 0.25 * case.implicit.min_time_step);
    let (_, chosen) = bar(&["solver.scheme=implicit", "implicit.tolerance=0.01"]);
    assert!(Axis::TimeStep.usual(&chosen).unwrap_err().contains("tolerance"));
}

#[test]
fn realisations_need_a_random_field() {
    let (mut plan, case) = bar(&[]);
    plan.ladders = axis::paper(&case).to_vec();
    plan.draws = Draws::Realisations { runs: 2 };
    assert!(converge(&plan, &|_, _| {}).unwrap_err().contains("[field.NAME]"));
    plan.draws = Draws::Single;
    plan.quantities = vec!["depth".to_owned()];
    assert!(converge(&plan, &|_, _| {}).unwrap_err().contains("max_displacement"));
}

#[test]
fn few_runs_that_scatter_give_no_rate() {
    let told = |runs| judge(&noisy(&H, runs, 0.002, |h| 2.0 + 0.6 * h * h)).verdict;
    assert_eq!(told(4), Verdict::FewRuns { runs: 4 });
    assert!(matches!(told(5), Verdict::Clean { .. } | Verdict::Uncertain { .. }));
}

/// Runs that an interrupt ends count in no figure.
#[test]
fn runs_that_were_cut_short_are_not_values() {
    static STOP: std::sync::atomic::AtomicBool = std::sync::atomic::AtomicBool::new(true);
    let text = crate::case::template("slope").expect("a template").to_owned();
    let (case, _) = crate::case::read("slope", &text, &[]).unwrap_or_else(|e| panic!("{e}"));
    let coarse = "grid.cell=1".to_owned();
    let plan = Plan {
        name: "slope".to_owned(),
        text,
        overrides: vec![coarse],
        variants: Vec::new(),
        ladders: vec![Axis::TimeStep.usual(&case).unwrap()],
        quantities: Vec::new(),
        draws: Draws::Single,
        max_memory: u64::MAX,
        threads: 1,
        limits: Limits { interrupt: Some(&STOP), time_limit: None },
    };
    let study = converge(&plan, &|_, _| ()).unwrap();
    assert!(study.rows.iter().all(|r| (r.failed, r.cut_short, r.not_at_rest) == (0, 1, 0)));
    assert!(study.ladders.iter().all(|l| l.verdict == Verdict::NoValues));
}
