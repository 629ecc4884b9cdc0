//! Standard normal numbers: one stream for each master seed, realisation and name of a field.

use super::stream::Stream;

/// Where a field takes its normals from: a stream, or numbers that were drawn before.
pub trait Source {
    /// The next numbers.
    fn fill(&mut self, out: &mut [f64]);
}

/// Standard normals of one realisation of one field.
///
/// They depend on the master seed, the realisation and the name alone, and not on what else has been
/// drawn. Mirrored ones are the same numbers with the other sign (antithetic).
pub struct Normals {
    stream: Stream,
    sign: f64,
}

impl Normals {
    /// The numbers of `realisation` of `field`.
    pub fn new(master: u64, realisation: u64, field: &str, mirrored: bool) -> Normals {
        let sign = if mirrored { -1.0 } else { 1.0 };
        Normals { stream: Stream::of_field(master, realisation, field), sign }
    }

    /// The next numbers.
    pub fn fill(&mut self, out: &mut [f64]) {
        out.iter_mut().for_each(|x| *x = self.next());
    }

    /// The next number.
    #[allow(clippy::should_implement_trait)] // it never ends
    #[inline]
    pub fn next(&mut self) -> f64 {
        self.sign * self.stream.normal()
    }
}

impl Source for Normals {
    fn fill(&mut self, out: &mut [f64]) {
        Normals::fill(self, out);
    }
}

/// Numbers drawn before, taken from the front; what is missing at the end is 0.
pub struct Given<'a>(pub &'a [f64]);

impl Source for Given<'_> {
    fn fill(&mut self, out: &mut [f64]) {
        let n = out.len().min(self.0.len());
        let (now, later) = self.0.split_at(n);
        let (head, tail) = out.split_at_mut(n);
        head.copy_from_slice(now);
        tail.fill(0.0);
        self.0 = later;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn draw(master: u64, realisation: u64, field: &str, mirrored: bool) -> Vec<f64> {
        let mut out = vec![0.0; 20_000];
        Normals::new(master, realisation, field, mirrored).fill(&mut out);
        out
    }

    fn correlation(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / a.len() as f64
    }

    /// Standard errors of n numbers: 1, sqrt(2), sqrt(96) over sqrt(n); four of them.
    #[test]
    fn moments_are_those_of_a_standard_normal() {
        let x = draw(3, 0, "cohesion", false);
        let moment = |p: i32| x.iter().map(|v| v.powi(p)).sum::<f64>() / x.len() as f64;
        let bound = 4.0 / (x.len() as f64).sqrt();
        assert!(moment(1).abs() < bound);
        assert!((moment(2) - 1.0).abs() < bound * 2f64.sqrt());
        assert!((moment(4) - 3.0).abs() < bound * 96f64.sqrt());
    }

    #[test]
    fn names_realisations_and_seeds_are_independent() {
        let x = draw(3, 0, "cohesion", false);
        assert_eq!(x, draw(3, 0, "cohesion", false));
        let bound = 4.0 / (x.len() as f64).sqrt();
        for y in [draw(3, 0, "residual", false), draw(3, 1, "cohesion", false), draw(4, 0, "cohesion", false)] {
            assert!(correlation(&x, &y).abs() < bound);
        }
    }

    #[test]
    fn mirrored_numbers_have_the_other_sign() {
        let (x, y) = (draw(3, 7, "cohesion", false), draw(3, 7, "cohesion", true));
        assert!(x.iter().zip(&y).all(|(x, y)| x + y == 0.0));
    }

    #[test]
    fn given_numbers_end_in_zeros() {
        let mut out = [9.0; 3];
        Given(&[1.0, 2.0]).fill(&mut out);
        assert_eq!(out, [1.0, 2.0, 0.0]);
    }
}
