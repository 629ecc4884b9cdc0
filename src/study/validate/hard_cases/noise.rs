//! Velocities of the points that the nodes do not see, and what it costs to take them out.

use super::super::{
    long_run::{Kept, LongRun, Setting, TRANSFERS, spun},
    remedy::Bench,
};

/// A transfer: its name, and its keys.
type Transfer = (&'static str, &'static [&'static str]);

pub(super) fn play(bench: &mut Bench<'_>) -> Result<(), String> {
    let [flip, remedies @ ..] = &TRANSFERS;
    for scheme in ["explicit", "implicit"] {
        bar(bench, scheme, *flip, remedies)?;
    }
    disc(bench, *flip, remedies)?;
    bench.report.note("noise of FLIP: no remedy is free. The share that nodes do not see is part of the motion too, where cells do not resolve it; energy is the sum of kinetic and elastic energy");
    Ok(())
}

fn periods(bench: &Bench<'_>) -> f64 {
    if bench.is_full() { 100.0 } else { 10.0 }
}

fn setting(scheme: &str, transfer: Transfer) -> Setting {
    if scheme == "explicit" { Setting::explicit(("linear", "musl"), transfer) } else { Setting::newmark(transfer) }
}

fn bar(bench: &mut Bench<'_>, scheme: &str, flip: Transfer, remedies: &[Transfer]) -> Result<(), String> {
    let n = periods(bench);
    let mut kept = |transfer: Transfer| {
        let setting = setting(scheme, transfer);
        let found = bench.aside(&LongRun, |reference, report| LongRun.bar_kept(&setting, n, reference, report));
        ended(bench, &format!("bar, {}, {scheme}", transfer.0), found)
    };
    let bare = kept(flip);
    let found: Vec<_> = remedies.iter().map(|t| kept(*t)).collect();
    let figures = [format!("bar: energy kept over {n} periods"), "bar: kinetic energy that nodes do not see".into()];
    for ((name, _), ours) in remedies.iter().zip(found) {
        for (k, figure) in figures.iter().enumerate() {
            bench.line(["noise of FLIP", name, scheme, figure], bare.map(|b| b[k]), ours.map(|o| o[k]));
        }
        if let Some([energy, _]) = ours {
            bench.judge("made", &format!("bar, {name}, {scheme}"), energy)?;
        }
    }
    Ok(())
}

/// The explicit scheme alone: implicit steps over so many turns take minutes.
fn disc(bench: &mut Bench<'_>, flip: Transfer, remedies: &[Transfer]) -> Result<(), String> {
    let n = periods(bench);
    let mut kept = |transfer: Transfer| {
        let found = bench.aside(&LongRun, |_, report| spun(&setting("explicit", transfer), n, report));
        ended(bench, &format!("disc, {}", transfer.0), found)
    };
    let bare = kept(flip);
    let found: Vec<_> = remedies.iter().map(|t| kept(*t)).collect();
    for ((name, _), ours) in remedies.iter().zip(found) {
        let mut line = |figure: &str, read: fn(Kept) -> f64| {
            bench.line(["noise of FLIP", name, "explicit", figure], bare.map(read), ours.map(read));
        };
        line(&format!("disc: energy kept over {n} turns"), |kept| kept.energy);
        line(&format!("disc: angular momentum kept over {n} turns"), |kept| kept.momentum);
        line("disc: kinetic energy that nodes do not see", |kept| kept.unseen);
        if let Some(kept) = ours {
            bench.judge("made", &format!("disc, {name}"), kept.momentum)?;
        }
    }
    Ok(())
}

/// What a run has shown; a note where it was not stable.
fn ended<T>(bench: &mut Bench<'_>, name: &str, found: Result<T, String>) -> Option<T> {
    found.inspect_err(|why| bench.report.note(format!("{name}: not stable, {why}"))).ok()
}
