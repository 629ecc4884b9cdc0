//! The realisations of a case: the one place that knows what in a case is random.

use serde::{Deserialize, Serialize};

use crate::{case::Case, output::record::sha256};

/// A draw of the random part: a realisation by its index, or `None`, the case with everything
/// random at its mean.
pub type Draw = Option<u64>;

/// The case of one draw.
pub fn realise(case: &Case, draw: Draw) -> Case {
    let mut case = case.clone();
    match draw {
        Some(k) => case.jitter.realisation = k,
        None => case.jitter.strength = 0.0,
    }
    case
}

/// Whether realisations of the case differ at all.
pub fn is_random(case: &Case) -> bool {
    case.jitter.strength > 0.0
}

/// The realisation that is made of the same numbers with opposite signs, if there is one.
pub fn partner(_case: &Case, _realisation: u64) -> Option<u64> {
    None
}

/// SHA-256 of the resolved case without what tells realisations apart or how many there are.
pub fn case_hash(case: &Case) -> String {
    sha256(realise(case, Some(0)).to_toml().as_bytes())
}

/// Part `index` of `of`, counted from 1: the realisations k with k mod `of` = `index` - 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Shard {
    pub index: u64,
    pub of: u64,
}

impl Shard {
    /// All of it.
    pub const WHOLE: Shard = Shard { index: 1, of: 1 };

    /// Whether it does this draw; that at the mean goes with the first shard.
    pub fn has(self, draw: Draw) -> bool {
        draw.unwrap_or(0) % self.of.max(1) == self.index.saturating_sub(1)
    }
}

impl std::fmt::Display for Shard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}", self.index, self.of)
    }
}

impl std::str::FromStr for Shard {
    type Err = String;

    /// `i/n` with 1 <= i <= n.
    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("'{text}': write i/n with 1 <= i <= n, e.g. 2/7");
        let (index, of) = text.split_once('/').ok_or_else(wrong)?;
        let number = |t: &str| t.trim().parse::<u64>().map_err(|_| wrong());
        let shard = Shard { index: number(index)?, of: number(of)? };
        if (1..=shard.of).contains(&shard.index) { Ok(shard) } else { Err(wrong()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_draw_belongs_to_one_shard() {
        for of in 1..8 {
            for draw in std::iter::once(None).chain((0..20).map(Some)) {
                assert_eq!((1..=of).filter(|&index| Shard { index, of }.has(draw)).count(), 1);
            }
        }
    }

    #[test]
    fn shards_are_read_and_refused() {
        assert_eq!("2/7".parse(), Ok(Shard { index: 2, of: 7 }));
        for wrong in ["0/3", "4/3", "1", "a/2", "1/0", "1/-2", ""] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn the_hash_is_that_of_the_case_and_not_of_a_realisation() {
        let read = |set: &[&str]| {
            let set: Vec<String> = set.iter().map(|s| (*s).to_owned()).collect();
            let text = include_str!("../../../cases/clay-slope.toml");
            crate::case::read("slope", text, &set).unwrap_or_else(|e| panic!("{e}")).0
        };
        let base = case_hash(&read(&["jitter.strength=0.0005"]));
        assert_eq!(base, case_hash(&read(&["jitter.strength=0.0005", "jitter.realisation=7"])));
        assert_ne!(base, case_hash(&read(&["jitter.strength=0.0004"])));
        assert_ne!(base, case_hash(&read(&["jitter.strength=0.0005", "seed=2"])));
        assert!(is_random(&read(&["jitter.strength=0.0005"])) && !is_random(&read(&[])));
    }
}
