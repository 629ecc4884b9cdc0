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
        Some(k) => (case.ensemble.realisation, case.jitter.realisation) = (k, k),
        None => {
            case.jitter.strength = 0.0;
            case.field.values_mut().for_each(|field| field.variation = 0.0);
        }
    }
    case
}

/// Whether realisations of the case differ at all.
pub fn is_random(case: &Case) -> bool {
    case.jitter.strength > 0.0 || case.field.values().any(|field| field.variation > 0.0)
}

/// The realisation whose fields are made of the same normals with opposite signs, if there is one.
pub fn partner(case: &Case, realisation: u64) -> Option<u64> {
    (case.ensemble.antithetic && !case.field.is_empty()).then_some(realisation ^ 1)
}

/// The case file of an ensemble: that of its realisation 0.
pub fn resolved(case: &Case, realisations: u64) -> String {
    let mut case = realise(case, Some(0));
    case.ensemble.realisations = realisations;
    case.to_toml()
}

/// SHA-256 of the resolved case without what tells realisations apart or how many there are.
pub fn case_hash(case: &Case) -> String {
    let mut case = case.clone();
    case.ensemble.until = None;
    sha256(resolved(&case, 0).as_bytes())
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
        for same in ["ensemble.realisation=7", "ensemble.realisations=7", "ensemble.until.standard_error=1"] {
            assert_eq!(base, case_hash(&read(&["jitter.strength=0.0005", same])), "{same}");
        }
        assert_eq!(base, case_hash(&read(&["jitter.strength=0.0005", "jitter.realisation=7"])));
        assert_ne!(base, case_hash(&read(&["jitter.strength=0.0004"])));
        assert_ne!(base, case_hash(&read(&["jitter.strength=0.0005", "seed=2"])));
        assert!(is_random(&read(&["jitter.strength=0.0005"])) && !is_random(&read(&[])));
    }

    #[test]
    fn a_field_is_random_and_has_a_mean() {
        let text = format!("{}\n{FIELD}", include_str!("../../../cases/clay-slope.toml"));
        let (case, _) = crate::case::read("slope", &text, &[]).unwrap_or_else(|e| panic!("{e}"));
        assert!(is_random(&case) && !is_random(&realise(&case, None)));
        assert_eq!((partner(&case, 6), partner(&case, 7)), (Some(7), Some(6)));
        assert_ne!(realise(&case, Some(1)), realise(&case, Some(2)));
    }

    const FIELD: &str = r#"
[ensemble]
antithetic = true
[field.strength]
material = "clay"
parameters = ["cohesion", "residual_cohesion"]
variation = 0.25
theta_h = 6.0
theta_v = 1.0
"#;
}
