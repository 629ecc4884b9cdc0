//! Columns of numbers that do not get in each other's way in the cache.

use std::ops::{Deref, DerefMut};

/// Numbers by which the starts of neighbouring strips are apart: three cache lines.
const STEP: usize = 24;
/// Strips after which the shifts start again; `STEP * TURN` numbers are just below one page.
const TURN: usize = 21;

/// A column of `f64` whose start is shifted within its page.
///
/// Long vectors all start at the same place of a page. A loop that walks two dozen of them in step
/// would then use a single set of the first-level cache (12 ways) and keep evicting its own lines;
/// strips with different shifts use them all.
#[derive(Clone, Debug, Default)]
pub struct Strip {
    data: Vec<f64>,
    start: usize,
}

impl Strip {
    /// `n` times `value`; columns that are walked together take different `number`s.
    pub fn new(n: usize, value: f64, number: usize) -> Self {
        let start = STEP * (number % TURN);
        Strip { data: vec![value; start + n], start }
    }
}

impl Deref for Strip {
    type Target = [f64];

    #[inline(always)]
    fn deref(&self) -> &[f64] {
        // invariant: `start <= data.len()`, from `new` and `default`; the data never changes length
        self.data.get(self.start..).unwrap_or_default()
    }
}

impl DerefMut for Strip {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [f64] {
        self.data.get_mut(self.start..).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_strip_is_its_numbers() {
        let mut s = Strip::new(3, 1.0, 5);
        s[1] = 2.0;
        assert_eq!(&*s, &[1.0, 2.0, 1.0]);
        assert!(Strip::default().is_empty());
    }
}
