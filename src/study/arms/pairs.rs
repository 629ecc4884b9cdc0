//! RMPM and RFEM on the same fields, realisation by realisation.

use serde::Serialize;

use crate::{
    math::stats::{CONFIDENCE, Correlation, Paired, Share},
    study::ensemble::{Ended, SLIDE_VOLUME, SLIDING_DISTANCE, first_slide},
};

/// One realisation by both methods.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Pair {
    pub realisation: u64,
    /// r (m).
    pub rmpm_m: f64,
    pub rfem_m: f64,
    /// Of the first slide in RMPM (m).
    pub rmpm_first_m: Option<f64>,
    /// Slide volume (m3/m).
    pub rmpm_volume: Option<f64>,
    pub rfem_volume: Option<f64>,
}

/// All realisations that neither method failed in.
#[derive(Clone, Debug, Serialize)]
pub struct Pairs {
    #[serde(skip)]
    pub pairs: Vec<Pair>,
    /// r of RMPM less r of RFEM (m).
    pub difference_m: Option<Paired>,
    /// Volume of RMPM less that of RFEM (m3/m).
    pub difference_volume: Option<Paired>,
    /// Share in which RFEM gives the shorter r, by more than a cell: r within one is taken as unchanged.
    pub rfem_shorter: Option<Share>,
    /// Mean r of RFEM over mean r of RMPM.
    pub ratio_of_means: Option<f64>,
    pub correlation: Option<Correlation>,
    /// RFEM against the first slide of RMPM: first slide less RFEM (m).
    pub first_slide_difference_m: Option<Paired>,
}

impl Pairs {
    /// Pairs up two ensembles of the same fields.
    pub fn of(rmpm: &Ended, rfem: &Ended) -> Self {
        let cell = rmpm.results.case.grid.cell;
        let first = first_slide(&rmpm.results.case);
        let pairs: Vec<Pair> = rmpm
            .results
            .rows
            .iter()
            .filter_map(|(k, a)| {
                let (a, b) = (&a.row, &rfem.results.rows.get(k)?.row);
                Some(Pair {
                    realisation: *k,
                    rmpm_m: a.measure(SLIDING_DISTANCE)?,
                    rfem_m: b.measure(SLIDING_DISTANCE)?,
                    rmpm_first_m: first.as_ref().and_then(|name| a.measure(name)),
                    rmpm_volume: a.measure(SLIDE_VOLUME),
                    rfem_volume: b.measure(SLIDE_VOLUME),
                })
            })
            .collect();
        Pairs::from(pairs, cell)
    }

    fn from(pairs: Vec<Pair>, cell: f64) -> Self {
        let (a, b): (Vec<f64>, Vec<f64>) = pairs.iter().map(|p| (p.rmpm_m, p.rfem_m)).unzip();
        let (va, vb): (Vec<f64>, Vec<f64>) = pairs.iter().filter_map(|p| p.rmpm_volume.zip(p.rfem_volume)).unzip();
        let (first, small): (Vec<f64>, Vec<f64>) =
            pairs.iter().filter_map(|p| Some((p.rmpm_first_m?, p.rfem_m))).unzip();
        let shorter = pairs.iter().filter(|p| p.rfem_m < p.rmpm_m - cell).count();
        let (sum_a, sum_b) = (a.iter().sum::<f64>(), b.iter().sum::<f64>());
        Pairs {
            difference_m: Paired::of(&b, &a),
            difference_volume: Paired::of(&vb, &va),
            rfem_shorter: Share::wilson(shorter, pairs.len(), CONFIDENCE),
            ratio_of_means: (sum_a > 0.0).then_some(sum_b / sum_a),
            correlation: Correlation::of(&a, &b, CONFIDENCE),
            first_slide_difference_m: Paired::of(&small, &first),
            pairs,
        }
    }

    /// `pairs.csv`.
    pub fn csv(&self) -> String {
        let mut text =
            "realisation,rmpm_r_m,rfem_r_m,rmpm_first_r_m,rmpm_volume_m3_per_m,rfem_volume_m3_per_m\n".to_owned();
        let or_empty = |v: Option<f64>| v.map_or(String::new(), |v| v.to_string());
        for p in &self.pairs {
            text += &format!(
                "{},{},{},{},{},{}\n",
                p.realisation,
                p.rmpm_m,
                p.rfem_m,
                or_empty(p.rmpm_first_m),
                or_empty(p.rmpm_volume),
                or_empty(p.rfem_volume)
            );
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(realisation: u64, rmpm_m: f64, rfem_m: f64) -> Pair {
        Pair { realisation, rmpm_m, rfem_m, rmpm_first_m: Some(rfem_m), rmpm_volume: None, rfem_volume: None }
    }

    #[test]
    fn a_cell_more_or_less_is_no_difference() {
        let pairs =
            Pairs::from(vec![pair(0, 8.0, 3.0), pair(1, 3.0, 3.0), pair(2, 3.25, 3.0), pair(3, 0.0, 3.0)], 0.25);
        assert_eq!(pairs.rfem_shorter.map(|s| s.count), Some(1));
        assert_eq!(pairs.difference_m.map(|d| d.mean), Some(2.25 / 4.0));
        assert_eq!(pairs.csv().lines().count(), 5);
    }
}
