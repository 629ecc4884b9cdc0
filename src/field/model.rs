//! A random field of a parameter: generator and marginal, and a realisation of both.

use std::fmt;

use super::{
    generator::{Generator, Scratch},
    marginal::{Low, Marginal},
    normals::Normals,
    table::Lattice,
};

/// Most times that a field is drawn again.
const MOST_TRIES: u64 = 1000;

/// A field that can be drawn; made once, shared by all realisations.
pub struct Model {
    pub name: String,
    /// Lower left corner of the lattice (m).
    pub origin: [f64; 2],
    pub lattice: Lattice,
    pub marginal: Marginal,
    /// `None` where nothing varies (V = 0).
    pub generator: Option<Generator>,
}

/// Which realisation of which master seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Draw {
    pub master: u64,
    pub realisation: u64,
    /// Realisations 2k and 2k + 1 take opposite normals.
    pub antithetic: bool,
}

impl Draw {
    /// The normals of a field.
    pub fn normals(&self, field: &str) -> Normals {
        match self.antithetic {
            true => Normals::new(self.master, self.realisation / 2, field, self.realisation % 2 == 1),
            false => Normals::new(self.master, self.realisation, field, false),
        }
    }
}

/// Why a realisation cannot be drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum DrawError {
    /// Every try had values below the floor, a share of the mean.
    AlwaysLow { field: String, floor: f64, tries: u64 },
    /// Values that are not positive, and no rule for them.
    NotPositive { field: String, cells: usize },
}

impl fmt::Display for DrawError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            DrawError::AlwaysLow { field, floor, tries } => write!(
                f,
                "{tries} realisations of field `{field}` all had values below {floor} of the mean; use low_values = \"floor\", a lower floor or a lognormal distribution"
            ),
            DrawError::NotPositive { field, cells } => write!(
                f,
                "{cells} cells of field `{field}` have values that are not positive; use low_values = \"floor\" or a lognormal distribution"
            ),
        }
    }
}

impl std::error::Error for DrawError {}

/// What was done to values of a realisation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Counts {
    pub cells: u64,
    /// Cells raised to the floor.
    pub floored: u64,
    /// Fields thrown away because a value was below the floor.
    pub redrawn: u64,
}

/// A realisation: a factor on the mean for each cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawn {
    pub origin: [f64; 2],
    pub lattice: Lattice,
    /// Row by row from the lowest, x running fastest.
    pub factors: Vec<f64>,
    pub counts: Counts,
}

impl Drawn {
    /// The factor of the cell that holds a place (m); beyond the lattice that of the nearest cell.
    pub fn at(&self, x: [f64; 2]) -> f64 {
        let index = |a: usize| {
            let cell = ((x[a] - self.origin[a]) / self.lattice.cell[a]).floor();
            cell.clamp(0.0, (self.lattice.cells[a] - 1) as f64) as usize
        };
        self.factors[index(1) * self.lattice.cells[0] + index(0)]
    }
}

impl Model {
    /// Draws a realisation: a pure function of the model and `draw`.
    ///
    /// # Errors
    /// A field that cannot be drawn free of values below the floor, or that has values that are not
    /// positive and no rule for them.
    pub fn draw(&self, draw: Draw) -> Result<Drawn, DrawError> {
        let cells = self.lattice.cells[0] * self.lattice.cells[1];
        let mut factors = vec![1.0; cells];
        let mut counts = Counts { cells: cells as u64, ..Counts::default() };
        if let Some(generator) = &self.generator {
            let (mut normals, mut scratch) = (draw.normals(&self.name), Scratch::default());
            loop {
                generator.sample(&mut normals, &mut scratch, &mut factors);
                factors.iter_mut().for_each(|z| *z = self.marginal.factor(*z));
                if self.settle(&mut factors, &mut counts)? {
                    break;
                }
            }
        }
        Ok(Drawn { origin: self.origin, lattice: self.lattice, factors, counts })
    }

    /// Applies the rule for low values; false where the field has to be drawn again.
    fn settle(&self, factors: &mut [f64], counts: &mut Counts) -> Result<bool, DrawError> {
        match self.marginal.low() {
            Low::Floor(floor) => {
                for factor in factors.iter_mut().filter(|f| **f < floor) {
                    *factor = floor;
                    counts.floored += 1;
                }
            }
            Low::Resample(floor) if factors.iter().any(|f| *f < floor) => {
                counts.redrawn += 1;
                if counts.redrawn == MOST_TRIES {
                    return Err(DrawError::AlwaysLow { field: self.name.clone(), floor, tries: MOST_TRIES });
                }
                return Ok(false);
            }
            _ => {}
        }
        let bad = factors.iter().filter(|f| !(**f > 0.0 && f.is_finite())).count();
        if bad > 0 {
            return Err(DrawError::NotPositive { field: self.name.clone(), cells: bad });
        }
        Ok(true)
    }
}
