//! A bar that is pulled to three times its length: where points leave a cell between them it parts.

use super::{
    super::{measure::mean, remedy::Bench},
    played::Played,
};

const BAR: &str = include_str!("../../../../validation/hard-cases/bar.toml");

/// Place of the grip at the start (m), and up to where the bar is looked at: the cells next to the grip
/// are pulled by nodes that it holds.
const GRIP: f64 = 10.0;
const FREE: f64 = 8.0;

/// Shapes that average over a domain.
const SHAPES: [&str; 3] = ["gimp", "gimp_wide", "bspline"];

/// Schemes, with their keys.
const SCHEMES: [(&str, &str, &str); 3] = [
    ("implicit", "quasi_static", "implicit.regime=quasi_static"),
    ("implicit", "backward_euler", "implicit.regime=backward_euler"),
    ("explicit", "", "solver.scheme=explicit"),
];

/// What is read at the end.
struct Pulled {
    /// Of the grip.
    reached: f64,
    /// Mean of the points away from the grip.
    stretch: f64,
    pieces: f64,
}

pub(super) fn play(bench: &mut Bench<'_>) -> Result<(), String> {
    for scheme in SCHEMES {
        let plain = pull(bench, scheme, "linear", 2)?;
        for shape in SHAPES {
            let ours = pull(bench, scheme, shape, 2)?;
            lines(bench, scheme, shape, &plain, &ours);
        }
        let shapes = if bench.is_full() { &["linear", "gimp", "gimp_wide", "bspline"][..] } else { &["linear"] };
        for shape in shapes {
            let ours = pull(bench, scheme, shape, 4)?;
            lines(bench, scheme, &format!("{shape}, 4 x 4 points"), &plain, &ours);
        }
    }
    bench.report.note("numerical fracture: no law here lets soil tear. A run whose body ends in more pieces than it had warns of it (`parted` in the record)");
    Ok(())
}

fn lines(bench: &mut Bench<'_>, (scheme, regime, _): (&str, &str, &str), remedy: &str, plain: &Pulled, ours: &Pulled) {
    let mut line = |figure: &str, without, with| {
        let figure = if regime.is_empty() { figure.to_owned() } else { format!("{figure}, {regime}") };
        bench.line(["numerical fracture", remedy, scheme, &figure], without, with);
    };
    line("stretch reached, of 3", plain.reached, ours.reached);
    line("mean stretch of the points", plain.stretch, ours.stretch);
    line("pieces", plain.pieces, ours.pieces);
}

fn pull(
    bench: &mut Bench<'_>,
    (scheme, regime, key): (&str, &str, &str),
    shape: &str,
    points: u32,
) -> Result<Pulled, String> {
    let set = [key.to_owned(), format!("solver.shape={shape}"), format!("points.per_axis={points}")];
    let end = Played::of(BAR, &set)?;
    let name = if regime.is_empty() { scheme } else { regime };
    let name = format!("bar to 3 l, {name}, {shape}, {points} x {points} points");
    end.rows(&name, bench)?;
    let free = (0..end.state.len()).filter(|&i| end.state.reference[i][0] < FREE);
    let found = Pulled {
        reached: 1.0 + end.outcome.time / GRIP,
        // nu = 0: J is the stretch along the bar
        stretch: mean(free.map(|i| end.state.jacobian[i])),
        pieces: end.outcome.measures.pieces[1] as f64,
    };
    bench.judge("stretch", &name, found.reached)?;
    bench.judge("points", &name, found.stretch)?;
    Ok(found)
}
