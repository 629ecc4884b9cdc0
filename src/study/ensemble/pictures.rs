//! The pictures of an ensemble: histogram, exceedance, how mean and standard deviation settle.

use std::{io, path::Path};

use super::{
    measures::SLIDING_DISTANCE,
    results::Results,
    slide::{censoring, resolution},
};
use crate::{
    math::stats::{Binning, CONFIDENCE, CensoredFit, Censoring, Exceedance, Histogram, NormalFit, running},
    output::plot::{self, FittedNormal, HistogramGroup, Marker, Part, Quantity},
};

/// Their files.
pub const FILES: [&str; 3] = ["histogram.png", "exceedance.png", "convergence.png"];

/// What is drawn: r, or the run-out where there is no crest.
struct Sample {
    name: &'static str,
    values: Vec<f64>,
    /// Of the run with everything random at its mean.
    at_mean: Option<f64>,
    censoring: Censoring,
    resolution: f64,
}

impl Sample {
    fn of(results: &Results) -> Self {
        let (measure, name) = match results.case.slide {
            Some(_) => (SLIDING_DISTANCE, "sliding distance r"),
            None => ("runout_m", "run-out"),
        };
        let slide = results.case.slide.as_ref();
        Sample {
            name,
            values: results.values(measure),
            at_mean: results.mean.as_ref().and_then(|done| done.row.measure(measure)),
            censoring: slide.map_or_else(Censoring::default, censoring),
            resolution: slide.map_or(0.0, |_| resolution(&results.case)),
        }
    }

    fn quantity(&self) -> Quantity<'_> {
        Quantity { name: self.name, unit: "m" }
    }

    /// The run at the mean, and the wall where values have reached it.
    fn markers(&self) -> Vec<Marker> {
        let high = self.censoring.high.filter(|high| self.values.iter().any(|v| v >= high));
        let wall = high.map(|high| (high, format!("wall {high} m")));
        let mean = self.at_mean.map(|v| (v, format!("at the mean {v:.2} m")));
        let marker = |(value, label)| Marker { value, label, vertical: true };
        mean.into_iter().chain(wall).map(marker).collect()
    }

    fn fits(&self) -> Vec<FittedNormal> {
        let fit = |name: &str, mean, sd, dashed| FittedNormal {
            name: format!("{name}: {mean:.2} m, sd {sd:.2} m"),
            mean,
            sd,
            dashed,
        };
        let plain = NormalFit::of(&self.values).filter(|f| f.sd > 0.0);
        let bounded = CensoredFit::of(&self.values, &self.censoring).ok().filter(|f| f.below + f.above > 0);
        let plain = plain.map(|f| fit("normal", f.mean, f.sd, false));
        plain.into_iter().chain(bounded.map(|f| fit("with the limits as bounds", f.mean, f.sd, true))).collect()
    }
}

/// Draws all; nothing where fewer than two realisations have a value.
///
/// # Errors
/// Those of the file system.
pub fn draw(folder: &Path, results: &Results) -> io::Result<()> {
    let sample = Sample::of(results);
    if sample.values.len() < 2 {
        return Ok(());
    }
    let binning = Binning::of(&[&sample.values], sample.censoring, sample.resolution);
    if let Some(histogram) = Histogram::of(&sample.values, &binning) {
        let group = HistogramGroup { name: "realisations".to_owned(), histogram: &histogram, fits: sample.fits() };
        plot::series(&folder.join(FILES[0]), &plot::histograms(sample.quantity(), &[group], sample.markers()))?;
    }
    if let Some(curve) = Exceedance::of(&sample.values, sample.censoring.high, CONFIDENCE) {
        plot::series(&folder.join(FILES[1]), &plot::exceedance(sample.quantity(), &curve, sample.markers()))?;
    }
    let [mean, sd] = plot::settling(sample.quantity(), &running(&sample.values));
    plot::sheet(&folder.join(FILES[2]), &[vec![Part::Series(&mean)], vec![Part::Series(&sd)]])
}
