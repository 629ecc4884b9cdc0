//! Random fields: the covariances that generators imply, and those of samples.

use super::{Effort, Files, Problem, Reference, Report, measure::largest};
use crate::{
    case,
    field::{
        correlation::{Correlation, Family},
        generator::Scratch,
        implied::{self, Columns},
        las::{self, Las},
        model::{Draw, Model},
        normals::Normals,
        squash::Squash,
        table::{Lattice, Table},
    },
    scene::Fields,
};

/// Errors of a correlation below which two generators are compared by their samples, whose standard errors are 0.013 and more.
const NEAR: f64 = 0.004;

/// Fields on the box of the slope.
pub(super) struct Field;

impl Problem for Field {
    fn name(&self) -> &'static str {
        "field"
    }

    fn files(&self) -> Files {
        Files {
            case: include_str!("../../../validation/field/case.toml"),
            reference: include_str!("../../../validation/field/reference.toml"),
        }
    }

    fn fill(&self, _effort: Effort, reference: &Reference, report: &mut Report) -> Result<(), String> {
        for key in ["near", "middle", "far"] {
            let theta = reference.given(key)?;
            self.compare(theta, reference, report)?;
        }
        subdivision(reference, report)
    }
}

/// The box of the slope in cells of 0.25 m.
const BOX: Lattice = Lattice { cell: [0.25, 0.25], cells: [100, 20] };

/// Plain subdivision on its own: the errors that an independent program found, and what a stage owes the next.
fn subdivision(reference: &Reference, report: &mut Report) -> Result<(), String> {
    for (key, limit, setup) in [
        ("las_half_metre", 1024, "theta_h = 1 m, stage 0 of 0.5 m"),
        ("las_one_metre", 256, "theta_h = 1 m, stage 0 of 1 m"),
    ] {
        let (las, table) = plain(1.0, limit)?;
        let found = implied::accuracy(&las, &table, &BOX, usize::MAX);
        report.row_of(reference, key, setup, None, found.correlation_error)?;
    }
    let (las, table) = plain(48.0, 256)?;
    report.row_of(reference, "las_two_metres", "theta_h = 48 m", None, over_two_metres(&las, table.at(0, 0)))?;
    report.row_of(reference, "las_upward", "theta_h = 48 m", None, upward()?)
}

fn plain(theta: f64, limit: usize) -> Result<(Squash, Table), String> {
    let correlation = Correlation { family: Family::Markov, theta: [theta, 1.0] };
    let las = Squash::new(&correlation, &BOX, [1, 1], limit).ok_or("a covariance has no factor")?;
    Ok((las, Table::new(&correlation, BOX.cell, BOX.cells)))
}

/// Mean correlation of all pairs of cells 2 m apart along x.
fn over_two_metres(map: &Squash, variance: f64) -> f64 {
    let mut columns = Columns::new(map);
    let pairs: Vec<usize> = (0..BOX.len()).filter(|c| c % BOX.cells[0] + 8 < BOX.cells[0]).collect();
    pairs.iter().map(|&c| columns.covariances(c)[c + 8] / variance).sum::<f64>() / pairs.len() as f64
}

/// Largest difference between a cell of the last stage but one and the mean of its four children.
fn upward() -> Result<f64, String> {
    let correlation = Correlation { family: Family::Markov, theta: [48.0, 1.0] };
    let lags = las::lags(&las::plan(BOX.cells, 256));
    let table = Table::new(&correlation, BOX.cell, lags);
    let las = Las::new(&table, BOX.cells, 256).ok_or("a covariance has no factor")?;
    let (mut coarse, mut fine) = (Vec::new(), vec![0.0; BOX.len()]);
    las.sample_pair(&mut Normals::new(1, 0, "upward", false), &mut Scratch::default(), &mut coarse, &mut fine);
    let [nx, half] = [BOX.cells[0], BOX.cells[0] / 2];
    let mean = |k: usize| {
        let first = 2 * (k / half) * nx + 2 * (k % half);
        0.25 * (fine[first] + fine[first + 1] + fine[first + nx] + fine[first + nx + 1])
    };
    Ok(largest(coarse.iter().enumerate().map(|(k, z)| (z - mean(k)).abs())))
}

impl Field {
    /// The rows of one horizontal scale of fluctuation (m).
    fn compare(&self, theta: f64, reference: &Reference, report: &mut Report) -> Result<(), String> {
        let setup = format!("theta_h = {theta} m");
        let mut row = |key: &str, ours: f64| report.row_of(reference, key, &setup, None, ours);
        let chosen = Made::new(self.files().case, theta, &[])?;
        let accuracy = chosen.accuracy()?;
        row("correlation", accuracy[0])?;
        row("variance", accuracy[1])?;
        // a bound that any generator keeps
        let las = Made::new(self.files().case, theta, &["generator=las", "correlation_error=1", "variance_error=1"])?;
        row("las_correlation", las.accuracy()?[0])?;
        row("las_lag", las.lowest([8, 0])?)?;
        let embedding = Made::new(self.files().case, theta, &["generator=embedding"])?;
        row("embedding", largest(embedding.accuracy()?))?;
        let fields = reference.given("fields")? as u64;
        let [a, b] = [chosen.sample("chosen", fields)?, embedding.sample("embedding", fields)?];
        row("sampled", a.deviation())?;
        row("sampled_embedding", b.deviation())?;
        // what differs by more than a third of a standard error would show
        if accuracy[0] < NEAR {
            row("apart", a.apart(&b))?;
        }
        report.note(format!("{setup}: {}", chosen.choice()?));
        Ok(())
    }
}

/// The field of the case with some keys set.
struct Made {
    fields: Fields,
    seed: u64,
}

impl Made {
    fn new(text: &str, theta: f64, keys: &[&str]) -> Result<Self, String> {
        let keys = keys.iter().map(|key| (*key).to_owned()).chain([format!("theta_h={theta}")]);
        let keys: Vec<String> = keys.map(|key| format!("field.strength.{key}")).collect();
        let (case, _) = case::read("case.toml", text, &keys).map_err(|e| e.to_string())?;
        let made = Fields::of(&case).map_err(|e| e.to_string())?;
        Ok(Made { fields: made, seed: case.seed })
    }

    fn model(&self) -> Result<&Model, String> {
        self.fields.models().first().ok_or_else(|| "the case has no field".to_owned())
    }

    fn generator(&self) -> Result<&crate::field::generator::Generator, String> {
        self.model()?.generator.as_ref().ok_or_else(|| "the field does not vary".to_owned())
    }

    /// Errors of correlation and variance.
    fn accuracy(&self) -> Result<[f64; 2], String> {
        let accuracy = self.generator()?.accuracy();
        Ok([accuracy.correlation_error, accuracy.variance_error])
    }

    fn choice(&self) -> Result<&str, String> {
        Ok(self.generator()?.choice())
    }

    /// Lowest implied correlation at a lag (cells).
    fn lowest(&self, lag: [usize; 2]) -> Result<f64, String> {
        let found = self.generator()?.implied(&[lag]);
        found.first().map(|extremes| extremes[0]).ok_or_else(|| "no lag was asked for".to_owned())
    }

    /// Statistics of so many fields, of a stream of its own.
    fn sample(&self, stream: &str, fields: u64) -> Result<Sample, String> {
        let (model, generator) = (self.model()?, self.generator()?);
        let cells = model.lattice.cells;
        let first = [cells[0] / 3, cells[1] / 3];
        let implied = generator.covariances(first[1] * cells[0] + first[0]).ok_or("the lattice has no cell")?;
        let mut sample = Sample::new(first, cells, &implied);
        let (mut scratch, mut z) = (Scratch::default(), vec![0.0; model.lattice.len()]);
        for realisation in 0..fields {
            let draw = Draw { master: self.seed, realisation, antithetic: false };
            generator.sample(&mut draw.normals(stream), &mut scratch, &mut z);
            sample.add(&z);
        }
        Ok(sample)
    }
}

/// Sums over fields of the value of one cell and of its products with others; each with its squares.
struct Sample {
    fields: f64,
    first: usize,
    others: Vec<usize>,
    /// What each should come to: 0, and the implied covariances.
    exact: Vec<f64>,
    sums: Vec<[f64; 2]>,
}

impl Sample {
    /// The cell itself and those 1, 2, 4, ... cells farther along both axes.
    fn new(first: [usize; 2], cells: [usize; 2], implied: &[f64]) -> Self {
        let place = |x: usize, z: usize| z * cells[0] + x;
        let steps = |from: usize, to: usize| powers().map(move |n| from + n).take_while(move |n| *n < to);
        let along = steps(first[0], cells[0]).map(|x| place(x, first[1]));
        let up = steps(first[1], cells[1]).map(|z| place(first[0], z));
        let others: Vec<usize> = std::iter::once(place(first[0], first[1])).chain(along).chain(up).collect();
        let exact: Vec<f64> = std::iter::once(0.0).chain(others.iter().map(|&c| implied[c])).collect();
        let sums = vec![[0.0; 2]; exact.len()];
        Sample { fields: 0.0, first: place(first[0], first[1]), others, exact, sums }
    }

    fn add(&mut self, z: &[f64]) {
        let value = z[self.first];
        let values = std::iter::once(value).chain(self.others.iter().map(|&c| value * z[c]));
        for (sum, value) in self.sums.iter_mut().zip(values) {
            sum[0] += value;
            sum[1] += value * value;
        }
        self.fields += 1.0;
    }

    /// Mean and its standard error of each statistic.
    fn figures(&self) -> Vec<[f64; 2]> {
        let n = self.fields;
        self.sums.iter().map(|[a, b]| [a / n, ((b / n - (a / n).powi(2)) / (n - 1.0)).sqrt()]).collect()
    }

    /// Largest distance from what it should be, in standard errors.
    fn deviation(&self) -> f64 {
        largest(self.figures().iter().zip(&self.exact).map(|([mean, error], exact)| (mean - exact).abs() / error))
    }

    /// Largest distance from another sample, in standard errors of the difference.
    fn apart(&self, other: &Sample) -> f64 {
        let distance = |(a, b): (&[f64; 2], &[f64; 2])| (a[0] - b[0]).abs() / a[1].hypot(b[1]);
        largest(self.figures().iter().zip(&other.figures()).map(distance))
    }
}

fn powers() -> impl Iterator<Item = usize> {
    std::iter::successors(Some(1_usize), |n| n.checked_mul(2))
}
