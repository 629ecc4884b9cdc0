use proptest::prelude::*;

use super::*;
use crate::math::{ordering::nested_dissection, sparse::offset_bit};

/// A pattern of some nodes of a grid that couple as far as `reach`, and a matrix that its diagonal makes positive
/// definite.
fn system(row: u32, ids: &[u32], reach: i32) -> (Pattern, Vec<f64>, Vec<f64>) {
    let near = (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| offset_bit(dx, dy)));
    let mut pattern = Pattern::default();
    pattern.adopt(row, ids, &vec![near.fold(0, |m, bit| m | 1 << bit); ids.len()], false);
    let random: Vec<f64> = (0..pattern.len()).map(|k| (0.7 * k as f64).sin()).collect();
    let mut values = vec![0.0; pattern.len()];
    pattern.symmetric_part(&random, &mut values);
    for j in 0..pattern.nodes() {
        let at = pattern.block(j, offset_bit(0, 0));
        let most = 2.0 * pattern.mask(j).count_ones() as f64;
        (0..2).for_each(|axis| values[at + axis * (pattern.stride(j) + 1)] += most);
    }
    let rhs = (0..pattern.dim()).map(|k| (1.3 * k as f64).cos()).collect();
    (pattern, values, rhs)
}

fn factored(pattern: &Pattern, values: &[f64], rhs: &[f64]) -> Option<Fronts> {
    let mut fronts = Fronts::default();
    fronts.prepare(pattern, &nested_dissection(pattern));
    fronts.factor(values, rhs)?;
    Some(fronts)
}

/// max |b - A x|
fn off(pattern: &Pattern, values: &[f64], rhs: &[f64], x: &[f64]) -> f64 {
    let mut y = vec![0.0; x.len()];
    pattern.multiply(values, x, &mut y);
    y.iter().zip(rhs).map(|(y, b)| (y - b).abs()).fold(0.0, f64::max)
}

fn some_nodes() -> impl Strategy<Value = (u32, Vec<u32>)> {
    (1u32..30, 1u32..20).prop_flat_map(|(row, lines)| {
        let all: Vec<u32> = (0..row * lines).collect();
        (Just(row), proptest::sample::subsequence(all, 1..=(row * lines) as usize))
    })
}

proptest! {
    /// Rows sum to at most 4 times the diagonal, so |x| <= 1 and the residual is rounding: some hundred terms of 1e-16
    /// times entries of up to 200.
    #[test]
    fn equations_are_solved((row, ids) in some_nodes(), reach in 0..4) {
        let (pattern, values, rhs) = system(row, &ids, reach);
        let mut fronts = factored(&pattern, &values, &rhs).expect("positive definite");
        let mut x = vec![f64::NAN; rhs.len()];
        fronts.finish(&mut x).unwrap();
        prop_assert!(off(&pattern, &values, &rhs, &x) < 1e-12);
        let mut again = rhs.clone();
        fronts.solve(&mut again).unwrap();
        prop_assert!(off(&pattern, &values, &rhs, &again) < 1e-12);
    }

    /// Every node has one place, children come first, and updates that live at the same time do not overlap.
    #[test]
    fn a_plan_is_one((row, ids) in some_nodes(), reach in 0..4) {
        let (pattern, ..) = system(row, &ids, reach);
        let plan = Plan::new(&pattern, &nested_dissection(&pattern));
        let mut order = plan.order.clone();
        order.sort_unstable();
        prop_assert!(order.iter().copied().eq(0..pattern.nodes() as u32));
        let mut waiting: Vec<&Front> = Vec::new();
        for front in &plan.fronts {
            let (start, end) = (front.update, front.update + front.update_len());
            prop_assert!(end <= plan.workspace);
            prop_assert!(waiting.iter().all(|f| end <= f.update || f.update + f.update_len() <= start));
            for &c in &plan.children[front.children.clone()] {
                let child = &plan.fronts[c as usize];
                prop_assert!(waiting.iter().any(|f| f.first == child.first));
                waiting.retain(|f| f.first != child.first);
            }
            waiting.push(front);
        }
        prop_assert!(waiting.iter().all(|f| f.below() == 0), "what is left goes nowhere");
    }
}

#[test]
fn what_is_not_positive_definite_has_no_factor() {
    let (pattern, mut values, rhs) = system(20, &(0..200).collect::<Vec<_>>(), 1);
    let at = pattern.block(130, offset_bit(0, 0));
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        values[at] = bad;
        assert!(factored(&pattern, &values, &rhs).is_none(), "{bad}");
    }
}

/// Fused or not, in blocks of four or eight: the same up to rounding.
#[test]
fn all_instruction_sets_agree() {
    let (pattern, values, rhs) = system(60, &(0..1800).collect::<Vec<_>>(), 1);
    let mut fronts = factored(&pattern, &values, &rhs).unwrap();
    let mut best = vec![0.0; rhs.len()];
    fronts.finish(&mut best).unwrap();
    let Fronts { plan: Some(plan), values: panels, updates, local, sorted, .. } = &mut fronts else { unreachable!() };
    assert!(Fused::BASELINE.run(Factor { plan, values: &values, rhs: &rhs, panels, updates }));
    sorted.fill(0.0);
    for (place, &node) in plan.order.iter().enumerate() {
        sorted[2 * place..][..2].copy_from_slice(&rhs[2 * node as usize..][..2]);
    }
    Fused::BASELINE.run(Forward { plan, panels, local, sorted });
    Fused::BASELINE.run(Backward { plan, panels, local, sorted });
    let mut plain = vec![0.0; rhs.len()];
    scatter(plan, sorted, &mut plain);
    assert!(best.iter().zip(&plain).all(|(a, b)| (a - b).abs() < 1e-13), "|x| <= 1");
    assert!(off(&pattern, &values, &rhs, &plain) < 1e-12);
}
