//! How a cell of one stage is split into 2 x 2 cells of the next (Fenton and Vanmarcke 1990).

use nalgebra::{DMatrix, DVector, Matrix3, SymmetricEigen};

use crate::field::table::Table;

/// Neighbours of a parent, itself included: 3 x 3, along x fastest.
pub const NEIGHBOURS: usize = 9;
/// The parent among them.
pub const SELF: usize = 4;
/// Children that are drawn; the fourth is what the mean leaves.
pub const DRAWN: usize = 3;

/// Eigenvalues of the covariance of the parents, against the largest, below which a direction is left
/// out: 1e-12 of the variance is lost and weights stay moderate where a smooth field makes R singular.
const SINGULAR: f64 = 1e-12;
/// Share of the variance of a child below which what is left of it is rounding.
const ROUNDING: f64 = 1e-13;

/// Weights of one kind of parent: children k = 0, 1, 2 are sum a[k][q] parent[q] + sum c[k][l] u[l], and
/// child 3 is 4 parent - the others. Children are counted along x fastest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Split {
    /// A^T = S^T R^-1; 0 for neighbours outside the lattice.
    pub a: [[f64; NEIGHBOURS]; DRAWN],
    /// Lower triangle C with C C^T = B - S^T A.
    pub c: [[f64; DRAWN]; DRAWN],
}

/// Which neighbours there are along one axis: the one before, the one after.
pub type Sides = [bool; 2];

impl Split {
    /// For parents with covariances `coarse` and children with `fine`; `None` if the eigenvalues of R are
    /// not found.
    pub fn new(coarse: &Table, fine: &Table, sides: [Sides; 2]) -> Option<Split> {
        let parents: Vec<usize> =
            (0..NEIGHBOURS).filter(|&q| exists(q % 3, sides[0]) && exists(q / 3, sides[1])).collect();
        let r = DMatrix::from_fn(parents.len(), parents.len(), |p, q| between_parents(coarse, parents[p], parents[q]));
        let s = DMatrix::from_fn(parents.len(), DRAWN, |p, k| parent_and_child(fine, parents[p], k));
        let weights = pseudo_inverse(r)? * &s;
        let explained = s.transpose() * &weights;
        let left = Matrix3::from_fn(|k, l| {
            let b = fine.at((k % 2).abs_diff(l % 2), (k / 2).abs_diff(l / 2));
            b - 0.5 * (explained[(k, l)] + explained[(l, k)])
        });
        let mut a = [[0.0; NEIGHBOURS]; DRAWN];
        for (p, &q) in parents.iter().enumerate() {
            (0..DRAWN).for_each(|k| a[k][q] = weights[(p, k)]);
        }
        Some(Split { a, c: root(&left, ROUNDING * fine.at(0, 0)) })
    }
}

/// Whether the neighbour at place 0, 1, 2 of an axis is there.
fn exists(place: usize, [before, after]: Sides) -> bool {
    [before, true, after][place]
}

fn between_parents(coarse: &Table, p: usize, q: usize) -> f64 {
    coarse.at((p % 3).abs_diff(q % 3), (p / 3).abs_diff(q / 3))
}

/// The parent is the mean of its own four children. The children of the parent in the middle are at 2 and 3.
fn parent_and_child(fine: &Table, p: usize, k: usize) -> f64 {
    let at = |own: usize| {
        let (x, z) = (2 * (p % 3) + own % 2, 2 * (p / 3) + own / 2);
        fine.at(x.abs_diff(2 + k % 2), z.abs_diff(2 + k / 2))
    };
    (at(0) + at(1) + at(2) + at(3)) / 4.0
}

fn pseudo_inverse(r: DMatrix<f64>) -> Option<DMatrix<f64>> {
    let eigen = SymmetricEigen::try_new(r, f64::EPSILON, 1000)?;
    let least = SINGULAR * eigen.eigenvalues.max();
    let inverse: DVector<f64> = eigen.eigenvalues.map(|l| if l > least { 1.0 / l } else { 0.0 });
    let v = eigen.eigenvectors;
    Some(&v * DMatrix::from_diagonal(&inverse) * v.transpose())
}

/// Cholesky factor of a matrix that may be semi-definite: a column whose pivot is at most `least` is 0.
fn root(m: &Matrix3<f64>, least: f64) -> [[f64; DRAWN]; DRAWN] {
    let mut c = [[0.0; DRAWN]; DRAWN];
    for j in 0..DRAWN {
        let rest = |i: usize, c: &[[f64; DRAWN]; DRAWN]| m[(i, j)] - (0..j).map(|l| c[i][l] * c[j][l]).sum::<f64>();
        let pivot = rest(j, &c);
        if pivot > least {
            for i in j..DRAWN {
                c[i][j] = rest(i, &c) / pivot.sqrt();
            }
        }
    }
    c
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::correlation::{Correlation, Family};

    fn tables(family: Family, theta: [f64; 2]) -> [Table; 2] {
        let fine = Table::new(&Correlation { family, theta }, [0.25, 0.25], [6, 6]);
        [fine.coarser(), fine]
    }

    /// The mean of the children is the parent, so the weights of all four children sum to 4 at the parent and to 0
    /// elsewhere by construction; by symmetry each child is the mirror image of the next.
    #[test]
    fn children_of_an_inner_parent_are_mirror_images() {
        let [coarse, fine] = tables(Family::Markov, [1.0, 3.0]);
        let split = Split::new(&coarse, &fine, [[true; 2]; 2]).unwrap();
        for q in 0..NEIGHBOURS {
            let mirrored = 3 * (q / 3) + 2 - q % 3;
            assert!((split.a[0][q] - split.a[1][mirrored]).abs() < 1e-12);
        }
    }

    /// B = S^T R^-1 S + C C^T: the children have the covariance of the table.
    #[test]
    fn children_have_their_covariance() {
        for sides in [[[true; 2]; 2], [[false, true], [true, true]], [[false; 2], [true, false]]] {
            let [coarse, fine] = tables(Family::Spherical, [2.0, 1.0]);
            let split = Split::new(&coarse, &fine, sides).unwrap();
            for k in 0..DRAWN {
                for l in 0..DRAWN {
                    let explained: f64 = (0..NEIGHBOURS).map(|p| split.a[k][p] * parent_and_child(&fine, p, l)).sum();
                    let drawn: f64 = (0..DRAWN).map(|m| split.c[k][m] * split.c[l][m]).sum();
                    let b = fine.at((k % 2).abs_diff(l % 2), (k / 2).abs_diff(l / 2));
                    assert!((explained + drawn - b).abs() < 1e-12, "{sides:?} {k} {l}");
                }
            }
        }
    }

    #[test]
    fn a_constant_field_is_copied() {
        let [coarse, fine] = tables(Family::Gaussian, [f64::INFINITY; 2]);
        let split = Split::new(&coarse, &fine, [[true; 2]; 2]).unwrap();
        for k in 0..DRAWN {
            assert!((split.a[k].iter().sum::<f64>() - 1.0).abs() < 1e-12);
            assert_eq!(split.c[k], [0.0; 3]);
        }
    }
}
