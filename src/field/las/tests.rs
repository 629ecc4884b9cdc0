use proptest::prelude::*;

use super::*;
use crate::field::{
    correlation::{Correlation, Family},
    implied::Columns,
    normals::{Given, Normals},
};

fn las(family: Family, theta: [f64; 2], cells: [usize; 2], limit: usize) -> (Las, Table) {
    let table = Table::new(&Correlation { family, theta }, [0.25, 0.25], lags(&plan(cells, limit)));
    (Las::new(&table, cells, limit).unwrap(), table)
}

/// Numbers that are no pattern.
fn numbers(n: usize, name: &str) -> Vec<f64> {
    let mut out = vec![0.0; n];
    Normals::new(1, 1, name, false).fill(&mut out);
    out
}

#[test]
fn stages_are_the_smallest_that_cover() {
    assert_eq!(plan([100, 20], FENTON), [[25, 5], [50, 10], [100, 20]]);
    assert_eq!(plan([9, 1], 4), [[3, 1], [5, 1], [9, 1]]);
    assert_eq!(plan([3, 3], 9), [[3, 3]]);
    assert_eq!(lags(&plan([100, 20], FENTON)), [100, 20]);
}

/// Stage 0 of all cells is exact; 1e-12 is the rounding of 48 cells.
#[test]
fn a_single_stage_is_exact() {
    let (las, table) = las(Family::Markov, [1.0, 2.0], [8, 6], 48);
    let mut columns = Columns::new(&las);
    for (cell, value) in columns.covariances(0).iter().enumerate() {
        assert!((value - table.at(cell % 8, cell / 8)).abs() < 1e-12);
    }
}

/// With one stage of splitting the parents are exact, and so is the covariance among the children of
/// one parent.
#[test]
fn children_of_one_parent_are_exact() {
    for cells in [[16, 8], [15, 7], [12, 1], [1, 9]] {
        let (las, table) = las(Family::Spherical, [3.0, 1.0], cells, 32usize.min(cells[0] * cells[1] / 2 + 1));
        assert_eq!(las.stages.len(), 1);
        let mut columns = Columns::new(&las);
        for cell in 0..cells[0] * cells[1] {
            let [x, z] = [cell % cells[0], cell / cells[0]];
            let [x2, z2] = [(x ^ 1).min(cells[0] - 1), (z ^ 1).min(cells[1] - 1)];
            let value = columns.covariances(cell)[z2 * cells[0] + x2];
            // weights come of a pseudo-inverse with eigenvalues down to 1e-12
            assert!((value - table.at(x.abs_diff(x2), z.abs_diff(z2))).abs() < 1e-9, "{cells:?} {x} {z}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// On any lattice: finite numbers, whole parents that are the mean of their children to 1e-12, and an adjoint.
    #[test]
    fn any_lattice(nx in 1usize..40, nz in 1usize..40, limit in 1usize..80, x in 0.05..50.0f64, z in 0.05..50.0f64, k in 0usize..4) {
        let family = [Family::Markov, Family::MarkovSeparable, Family::Gaussian, Family::Spherical][k];
        let (las, _) = las(family, [x, z], [nx, nz], limit);
        let (u, mut fine, mut coarse) = (numbers(las.normals(), "u"), vec![f64::NAN; nx * nz], Vec::new());
        let mut scratch = Scratch::default();
        las.sample_pair(&mut Given(&u), &mut scratch, &mut coarse, &mut fine);
        prop_assert!(fine.iter().all(|v| v.is_finite()));
        if !coarse.is_empty() {
            for j in 0..nz / 2 {
                for i in 0..nx / 2 {
                    let at = 2 * j * nx + 2 * i;
                    let mean = (fine[at] + fine[at + 1] + fine[at + nx] + fine[at + nx + 1]) / 4.0;
                    prop_assert!((mean - coarse[j * nx.div_ceil(2) + i]).abs() < 1e-12);
                }
            }
        }
        let (w, mut back) = (numbers(nx * nz, "w"), vec![f64::NAN; las.normals()]);
        las.adjoint(&w, &mut scratch, &mut back);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let size = dot(&u, &u).sqrt() * dot(&back, &back).sqrt();
        prop_assert!((dot(&fine, &w) - dot(&u, &back)).abs() < 1e-12 * size.max(1.0));
    }
}
