use nalgebra::{DMatrix, DVector};
use nalgebra_sparse::CscMatrix;
use proptest::prelude::*;

use super::*;
use crate::math::sparse::offset_bit;

/// Nodes of a full grid that couple with all their neighbours as far as `reach`.
fn grid(row: u32, lines: u32, reach: i32) -> Pattern {
    let near = (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| offset_bit(dx, dy)));
    let mask = near.fold(0, |m, bit| m | 1 << bit);
    let ids: Vec<u32> = (0..row * lines).collect();
    let mut pattern = Pattern::default();
    pattern.adopt(row, &ids, &vec![mask; ids.len()], false);
    pattern
}

/// Numbers in -1..1, the same in every run (xorshift).
fn noise(seed: u64, n: usize) -> Vec<f64> {
    let mut state = 0x9e37_79b9_7f4a_7c15 ^ (seed + 1);
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        2.0 * (state >> 11) as f64 / (1u64 << 53) as f64 - 1.0
    };
    (0..n).map(|_| next()).collect()
}

/// Sets every value to `f(row, column, value)`.
fn map(pattern: &Pattern, values: &mut [f64], f: impl Fn(usize, usize, f64) -> f64) {
    for column in 0..pattern.dim() {
        for k in pattern.col_ptr()[column] as usize..pattern.col_ptr()[column + 1] as usize {
            values[k] = f(pattern.row_idx()[k] as usize, column, values[k]);
        }
    }
}

/// Random and symmetric, with `shift` on the diagonal: positive definite if it outweighs the rest.
fn symmetric(pattern: &Pattern, seed: u64, shift: impl Fn(usize) -> f64) -> Vec<f64> {
    let random = noise(seed, pattern.len());
    let mut values = vec![0.0; pattern.len()];
    pattern.symmetric_part(&random, &mut values);
    map(pattern, &mut values, |r, c, v| if r == c { v + shift(r) } else { v });
    values
}

fn dense(pattern: &Pattern, values: &[f64]) -> DMatrix<f64> {
    let [ptr, rows] = [pattern.col_ptr(), pattern.row_idx()].map(|s| s.iter().map(|&i| i as usize).collect());
    DMatrix::from(&CscMatrix::try_from_csc_data(pattern.dim(), pattern.dim(), ptr, rows, values.to_vec()).unwrap())
}

/// Symmetric systems are factored: with the heavy diagonals of these tests conjugate gradients would do.
fn solver(unsymmetric: Unsymmetric) -> Solver {
    Solver::new(Options { unsymmetric, symmetric: Symmetric::Direct, ..Options::default() })
}

struct Solved {
    x: Vec<f64>,
    said: Solution,
    work: Work,
}

fn solve(
    solver: &mut Solver,
    pattern: &Pattern,
    values: &[f64],
    symmetric: bool,
    rhs: &[f64],
) -> Result<Solved, Fault> {
    let (mut x, mut work) = (vec![f64::NAN; rhs.len()], Work::default());
    let said = solver.solve(pattern, values, symmetric, rhs, &mut x, &mut work)?;
    Ok(Solved { x, said, work })
}

/// Largest difference to the dense solution, relative to its largest component and its condition.
fn off(pattern: &Pattern, values: &[f64], rhs: &[f64], x: &[f64]) -> f64 {
    let matrix = dense(pattern, values);
    let exact = matrix.lu().solve(&DVector::from_column_slice(rhs)).unwrap();
    (DVector::from_column_slice(x) - &exact).amax() / exact.amax()
}

proptest! {
    // a diagonal of 60 outweighs the 49 neighbours with two unknowns each of size 1/2 on average:
    // the condition is below 100, and 1e-12 a thousand times rounding times that
    #[test]
    fn positive_definite_systems_agree_with_the_dense_solution(
        row in 1u32..9, lines in 1u32..9, reach in 0..4, seed in 0u64..1000, amd: bool,
    ) {
        let pattern = grid(row, lines, reach);
        let values = symmetric(&pattern, seed, |_| 60.0);
        let rhs = noise(seed + 1, pattern.dim());
        let ordering = if amd { Ordering::Amd } else { Ordering::NestedDissection };
        let mut solver = Solver::new(Options { ordering, symmetric: Symmetric::Direct, ..Options::default() });
        let solved = solve(&mut solver, &pattern, &values, true, &rhs).unwrap();
        prop_assert_eq!((solved.said.method, solved.said.positive), (Method::Llt, Some(true)));
        prop_assert!(off(&pattern, &values, &rhs, &solved.x) < 1e-12);
        let again = solve(&mut solver, &pattern, &values, true, &rhs).unwrap();
        prop_assert_eq!(solved.x, again.x);
        prop_assert_eq!((solved.work.symbolic_factorisations, again.work.symbolic_factorisations), (1, 0));
    }

    #[test]
    fn unsymmetric_systems_agree_with_the_dense_solution(
        row in 1u32..9, lines in 1u32..9, reach in 0..3, seed in 0u64..1000, lu: bool,
    ) {
        let pattern = grid(row, lines, reach);
        let mut values = noise(seed, pattern.len());
        map(&pattern, &mut values, |r, c, v| if r == c { v + 60.0 } else { v });
        let rhs = noise(seed + 1, pattern.dim());
        let mut solver = solver(if lu { Unsymmetric::Lu } else { Unsymmetric::Gmres });
        let solved = solve(&mut solver, &pattern, &values, false, &rhs).unwrap();
        prop_assert_eq!(solved.said.method, if lu { Method::Lu } else { Method::Gmres });
        prop_assert_eq!(solved.said.positive, None);
        // GMRES ends at a residual of 1e-10, times the condition
        let allowed = if lu { 1e-12 } else { 1e-8 };
        prop_assert!(off(&pattern, &values, &rhs, &solved.x) < allowed);
    }

    #[test]
    fn indefinite_systems_agree_with_the_dense_solution(row in 2u32..9, lines in 2u32..9, seed in 0u64..1000) {
        let pattern = grid(row, lines, 1);
        // about half of the eigenvalues are negative, and none is near 0
        let values = symmetric(&pattern, seed, |r| if r % 3 == 0 { -60.0 } else { 60.0 });
        let rhs = noise(seed + 1, pattern.dim());
        let solved = solve(&mut solver(Unsymmetric::Auto), &pattern, &values, true, &rhs).unwrap();
        prop_assert_eq!((solved.said.method, solved.said.positive), (Method::Ldlt, Some(false)));
        prop_assert!(solved.said.fallback && solved.work.fallback_solves == 1);
        prop_assert!(off(&pattern, &values, &rhs, &solved.x) < 1e-12);
    }
}

#[test]
fn pivots_of_zero_are_no_obstacle() {
    // [[0, 1], [1, 0]] at every node: L B L^T needs its blocks of two rows
    let pattern = grid(4, 3, 0);
    let mut values = vec![0.0; pattern.len()];
    map(&pattern, &mut values, |r, c, _| if r == c { 0.0 } else { 1.0 });
    let rhs = noise(3, pattern.dim());
    let solved = solve(&mut solver(Unsymmetric::Auto), &pattern, &values, true, &rhs).unwrap();
    assert_eq!(solved.said.method, Method::Ldlt);
    assert!(off(&pattern, &values, &rhs, &solved.x) < 1e-14);
}

/// The blocks of two rows of one factor are not those of the next. Left in place they made wrong factors,
/// and a panic where the next structure has a supernode's end in such a block.
#[test]
fn pivots_of_the_last_factor_are_forgotten() {
    let pattern = grid(4, 3, 0);
    let mut solver = solver(Unsymmetric::Auto);
    let mut values = vec![0.0; pattern.len()];
    let rhs = noise(3, pattern.dim());
    map(&pattern, &mut values, |r, c, _| if r == c { 0.0 } else { 1.0 });
    solve(&mut solver, &pattern, &values, true, &rhs).unwrap();
    map(&pattern, &mut values, |r, c, _| if r == c { 2.0 - 4.0 * (r % 2) as f64 } else { 0.0 });
    let solved = solve(&mut solver, &pattern, &values, true, &rhs).unwrap();
    assert_eq!(solved.said.method, Method::Ldlt);
    assert!(off(&pattern, &values, &rhs, &solved.x) < 1e-15);
}

#[test]
fn a_singular_matrix_is_a_fault_with_its_residual() {
    let pattern = grid(5, 4, 1);
    // the Laplacian of the graph of all unknowns: rows sum to 0, and the right side does not
    let mut laplacian = vec![-1.0; pattern.len()];
    let degree: Vec<f64> = (0..pattern.dim()).map(|r| pattern.stride(r / 2) as f64).collect();
    map(&pattern, &mut laplacian, |r, c, v| if r == c { degree[r] + v } else { v });
    let empty = vec![0.0; pattern.len()];
    let rhs = vec![1.0; pattern.dim()];
    for values in [&laplacian, &empty] {
        for (symmetric, way) in [(true, Unsymmetric::Auto), (false, Unsymmetric::Lu), (false, Unsymmetric::Gmres)] {
            let fault = solve(&mut solver(way), &pattern, values, symmetric, &rhs).err().expect("a fault");
            assert_eq!(fault.kind, FaultKind::Singular);
            assert!(fault.values.iter().any(|(name, r)| name == "residual" && (*r > 1e-8 || !r.is_finite())));
        }
    }
}

#[test]
fn what_is_no_number_is_reported() {
    let pattern = grid(5, 4, 1);
    let mut values = symmetric(&pattern, 1, |_| 60.0);
    let mut rhs = noise(2, pattern.dim());
    rhs[3] = f64::INFINITY;
    let mut solver = solver(Unsymmetric::Auto);
    let fault = solve(&mut solver, &pattern, &values, true, &rhs).err().expect("a fault");
    assert_eq!((fault.kind, fault.values[1].1), (FaultKind::NonFinite, 1.0));
    values[7] = f64::NAN;
    rhs[3] = 0.0;
    let fault = solve(&mut solver, &pattern, &values, false, &rhs).err().expect("a fault");
    assert_eq!((fault.kind, fault.values[0].1), (FaultKind::NonFinite, 1.0));
}

#[test]
fn lengths_that_do_not_fit_are_reported() {
    let pattern = grid(3, 3, 1);
    let (mut x, mut work) = (vec![0.0; 18], Work::default());
    let solved = solver(Unsymmetric::Auto).solve(&pattern, &[1.0], true, &[1.0; 18], &mut x, &mut work);
    assert_eq!(solved.unwrap_err().kind, FaultKind::Singular);
}

#[test]
fn nothing_is_solved_for_nothing() {
    let pattern = grid(3, 3, 1);
    let mut solver = solver(Unsymmetric::Auto);
    let none = solve(&mut solver, &pattern, &vec![1.0; pattern.len()], true, &[0.0; 18]).unwrap();
    assert_eq!((none.x, none.work.factorisations), (vec![0.0; 18], 0));
    let empty = solve(&mut solver, &Pattern::default(), &[], true, &[]).unwrap();
    assert_eq!(empty.said.residual, 0.0);
}

#[test]
fn a_superset_with_unit_diagonals_has_the_same_solution() {
    let whole = grid(6, 6, 1);
    let mask = whole.mask(14);
    let ids: Vec<u32> = (0..36).filter(|id| id % 5 != 0).collect();
    let masks = vec![mask; ids.len()];
    let mut small = Pattern::default();
    small.adopt(6, &ids, &masks, false);
    let mut large = whole.clone();
    large.adopt(6, &ids, &masks, true);
    assert_eq!(large.fingerprint(), whole.fingerprint());
    assert_eq!((large.nodes(), large.unused().count()), (36, 36 - ids.len()));

    // the same blocks in both: a function of the two grid numbers
    let entry = |i: u32, j: u32, a: usize, b: usize| {
        let mix = ((i + j) as f64 + (a + b) as f64 * 0.3 + (i * j) as f64 * 0.07).sin();
        if i == j && a == b { 60.0 + mix } else { mix }
    };
    let fill = |p: &Pattern, used: &dyn Fn(u32) -> bool| {
        let id = |k: usize| p.place(k / 2)[0] + 6 * p.place(k / 2)[1];
        let mut values = vec![0.0; p.len()];
        map(p, &mut values, |r, c, _| match used(id(r)) && used(id(c)) {
            true => entry(id(r), id(c), r % 2, c % 2),
            false => f64::from(r == c),
        });
        values
    };
    let used = |id: u32| !id.is_multiple_of(5);
    let load = |p: &Pattern| -> Vec<f64> {
        let id = |k: usize| p.place(k / 2)[0] + 6 * p.place(k / 2)[1];
        (0..p.dim()).map(|k| if used(id(k)) { (id(k) + k as u32 % 2) as f64 } else { 0.0 }).collect()
    };
    for symmetric in [true, false] {
        let [a, b] = [&small, &large].map(|p| {
            let mut solver = solver(Unsymmetric::Auto);
            solve(&mut solver, p, &fill(p, &used), symmetric, &load(p)).unwrap().x
        });
        for slot in 0..ids.len() {
            for component in 0..2 {
                let [u, v] = [a[2 * small.rank(slot) + component], b[2 * large.rank(slot) + component]];
                assert!((u - v).abs() < 1e-13, "{u} {v}");
            }
        }
        assert!(large.unused().all(|rank| b[2 * rank] == 0.0 && b[2 * rank + 1] == 0.0));
    }
}

#[test]
fn a_new_structure_is_noticed() {
    let mut solver = solver(Unsymmetric::Auto);
    // equal sizes and numbers of values, different shapes
    for (row, lines) in [(3, 5), (5, 3), (3, 5)] {
        let pattern = grid(row, lines, 1);
        let values = symmetric(&pattern, 5, |_| 60.0);
        let rhs = noise(6, pattern.dim());
        let solved = solve(&mut solver, &pattern, &values, true, &rhs).unwrap();
        assert_eq!(solved.work.symbolic_factorisations, 1);
        assert!(off(&pattern, &values, &rhs, &solved.x) < 1e-12);
    }
}

#[test]
fn equal_systems_give_equal_bits_whatever_went_before() {
    let pattern = grid(30, 20, 1);
    let rhs = noise(2, pattern.dim());
    for (way, is_symmetric) in [(Unsymmetric::Auto, true), (Unsymmetric::Lu, false), (Unsymmetric::Gmres, false)] {
        let values = symmetric(&pattern, 1, |_| 30.0);
        let fresh = solve(&mut solver(way), &pattern, &values, is_symmetric, &rhs).unwrap();
        let mut used = solver(way);
        let other = symmetric(&pattern, 9, |r| if r % 2 == 0 { 40.0 } else { -40.0 });
        solve(&mut used, &pattern, &other, is_symmetric, &rhs).unwrap();
        let small = grid(4, 4, 2);
        solve(&mut used, &small, &symmetric(&small, 1, |_| 90.0), is_symmetric, &noise(1, small.dim())).unwrap();
        let later = solve(&mut used, &pattern, &values, is_symmetric, &rhs).unwrap();
        assert_eq!(fresh.x, later.x);
        assert_eq!(fresh.said, later.said);
    }
}

#[test]
fn a_friction_row_is_solved_by_both_ways() {
    let pattern = grid(20, 8, 1);
    let mut values = symmetric(&pattern, 4, |_| 40.0);
    let clean = dense(&pattern, &values);
    // row_t += 0.3 row_n along the base, which are the first 20 nodes
    map(&pattern, &mut values, |r, c, v| if r < 40 && r % 2 == 0 { v + 0.3 * clean[(r + 1, c)] } else { v });
    let rhs = noise(8, pattern.dim());
    for (way, method) in [(Unsymmetric::Lu, Method::Lu), (Unsymmetric::Gmres, Method::Gmres)] {
        let solved = solve(&mut solver(way), &pattern, &values, false, &rhs).unwrap();
        assert_eq!(solved.said.method, method);
        assert!(solved.said.residual <= 1e-10 * 1.001 && off(&pattern, &values, &rhs, &solved.x) < 1e-9);
        assert_eq!(solved.work.lu_factorisations, u64::from(method == Method::Lu));
    }
}

#[test]
fn gmres_that_does_not_get_on_leaves_it_to_lu() {
    let pattern = grid(12, 12, 1);
    let mut values = noise(3, pattern.len());
    // a skew part that is 30 times the symmetric one
    map(&pattern, &mut values, |r, c, v| if r == c { 1.0 } else { 0.01 * v + 0.3 * f64::from((r > c) as i8 * 2 - 1) });
    let solved = solve(&mut solver(Unsymmetric::Gmres), &pattern, &values, false, &noise(4, pattern.dim())).unwrap();
    assert_eq!((solved.said.method, solved.said.positive), (Method::Lu, None));
    assert!(solved.said.fallback && solved.said.iterations > 0 && solved.work.fallback_solves == 1);
}

/// [2 5; -5 -1] has the determinant 23, and a symmetric part with a negative pivot: a sound system that LU alone solves,
/// and no word on whether it is positive.
#[test]
fn a_symmetric_part_that_is_not_positive_leaves_it_to_lu() {
    let pattern = grid(8, 8, 1);
    let mut values = noise(3, pattern.len());
    let node = |r: usize, c: usize| r / 2 == c / 2;
    map(&pattern, &mut values, |r, c, v| match (r % 2, c % 2) {
        (0, 0) if node(r, c) => 2.0,
        (1, 1) if node(r, c) => -1.0,
        (0, 1) if node(r, c) => 5.0,
        (1, 0) if node(r, c) => -5.0,
        _ => 0.01 * v,
    });
    let rhs = noise(4, pattern.dim());
    let [lu, gmres] = [Unsymmetric::Lu, Unsymmetric::Gmres]
        .map(|way| solve(&mut solver(way), &pattern, &values, false, &rhs).unwrap());
    assert_eq!((gmres.said.method, gmres.said.positive, lu.said.positive), (Method::Lu, None, None));
    assert!(gmres.said.fallback && gmres.work.fallback_solves == 1 && !lu.said.fallback);
    assert_eq!(gmres.x, lu.x);
}

#[test]
fn the_last_factor_solves_again() {
    let pattern = grid(9, 9, 1);
    let values = symmetric(&pattern, 4, |_| 40.0);
    let mut solver = solver(Unsymmetric::Auto);
    let [first, second] = [5, 6].map(|seed| noise(seed, pattern.dim()));
    let mut x = vec![0.0; pattern.dim()];
    assert!(solver.solve_again(&pattern, &values, &second, &mut x).is_none(), "there is no factor yet");
    solve(&mut solver, &pattern, &values, true, &first).unwrap();
    assert!(solver.solve_again(&pattern, &values, &second, &mut x).unwrap() < 1e-14);
    assert!(off(&pattern, &values, &second, &x) < 1e-12);
}

/// The estimate is a lower bound, and within a factor of 3 of the condition for all but contrived matrices
/// (Higham 1988).
#[test]
fn the_condition_is_estimated_within_a_factor_of_three() {
    let pattern = grid(6, 5, 1);
    let norm = |m: &DMatrix<f64>| m.column_iter().map(|c| c.lp_norm(1)).fold(0.0, f64::max);
    for (seed, is_symmetric) in [(1, true), (2, true), (3, false), (4, false)] {
        let mut values = symmetric(&pattern, seed, |r| if r == 7 { 12.0 } else { 30.0 });
        if !is_symmetric {
            map(&pattern, &mut values, |r, c, v| if r > c { 0.5 * v } else { v });
        }
        let mut solver = solver(Unsymmetric::Auto);
        assert_eq!(solver.condition(&pattern, &values), f64::INFINITY, "no factor");
        solve(&mut solver, &pattern, &values, is_symmetric, &noise(seed, pattern.dim())).unwrap();
        let matrix = dense(&pattern, &values);
        let exact = norm(&matrix) * norm(&matrix.clone().try_inverse().unwrap());
        let estimate = solver.condition(&pattern, &values);
        assert!(estimate <= exact * (1.0 + 1e-12) && estimate > exact / 3.0, "{estimate} {exact}");
    }
}

#[test]
fn a_matrix_that_is_hard_to_solve_says_so() {
    let pattern = grid(4, 4, 1);
    let mut values = symmetric(&pattern, 1, |_| 30.0);
    map(&pattern, &mut values, |r, c, v| if r == 5 || c == 5 { if r == c { 1e-9 } else { 0.0 } } else { v });
    let mut solver = solver(Unsymmetric::Auto);
    solve(&mut solver, &pattern, &values, true, &noise(2, pattern.dim())).unwrap();
    assert!(solver.condition(&pattern, &values) > 1e10);
    assert!(solver.bytes() > 8 * solver.fill());
}

/// A slab of stiffness 1 between neighbours, with this much inertia at each unknown.
fn with_inertia(pattern: &Pattern, inertia: f64) -> Vec<f64> {
    let mut values = vec![0.0; pattern.len()];
    map(pattern, &mut values, |r, c, _| if r != c && r % 2 == c % 2 { -1.0 } else { 0.0 });
    for j in 0..pattern.nodes() {
        let (at, near) = (pattern.block(j, offset_bit(0, 0)), pattern.mask(j).count_ones() as f64 - 1.0);
        (0..2).for_each(|axis| values[at + axis * (pattern.stride(j) + 1)] = near + inertia);
    }
    values
}

/// Where a step is short, few iterations do; where stiffness prevails, a factor is made.
#[test]
fn conjugate_gradients_take_over_where_inertia_prevails() {
    let pattern = grid(40, 20, 1);
    let rhs = noise(3, pattern.dim());
    for (inertia, wanted) in [(8.0, Method::Pcg), (0.01, Method::Llt)] {
        let values = with_inertia(&pattern, inertia);
        let solved = solve(&mut Solver::default(), &pattern, &values, true, &rhs).unwrap();
        assert_eq!((solved.said.method, solved.said.fallback), (wanted, false));
        assert_eq!(solved.work.factorisations, u64::from(wanted == Method::Llt));
        // the residual asked for is 1e-10, the condition at most 2 * 16 / inertia
        assert!(off(&pattern, &values, &rhs, &solved.x) < 1e-10 * (1.0 + 32.0 / inertia));
    }
}

/// What is not positive definite goes on to a factor, and so does everything where the pivots are wanted.
#[test]
fn conjugate_gradients_give_way() {
    let pattern = grid(40, 20, 1);
    let rhs = noise(4, pattern.dim());
    let asked = || Solver::new(Options { symmetric: Symmetric::Pcg, ..Options::default() });
    let indefinite = symmetric(&pattern, 5, |r| if r % 2 == 0 { 20.0 } else { -20.0 });
    let solved = solve(&mut asked(), &pattern, &indefinite, true, &rhs).unwrap();
    assert_eq!((solved.said.method, solved.said.positive), (Method::Ldlt, Some(false)));
    assert_eq!(solved.work.fallback_solves, 1);

    let easy = with_inertia(&pattern, 8.0);
    let mut wanting = asked();
    wanting.want_pivots(true);
    let solved = solve(&mut wanting, &pattern, &easy, true, &rhs).unwrap();
    assert_eq!((solved.said.method, solved.said.positive), (Method::Llt, Some(true)));
}

/// Without fill to drop, i.e. for a chain, the incomplete factor is the factor: one iteration.
#[test]
fn an_incomplete_factor_of_a_chain_is_complete() {
    let pattern = grid(60, 1, 1);
    let values = symmetric(&pattern, 6, |_| 8.0);
    let rhs = noise(7, pattern.dim());
    let mut chain = Solver::new(Options { symmetric: Symmetric::Pcg, ..Options::default() });
    let solved = solve(&mut chain, &pattern, &values, true, &rhs).unwrap();
    assert_eq!((solved.said.method, solved.said.iterations), (Method::Pcg, 1));
}
