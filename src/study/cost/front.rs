//! The Pareto front: settings that no other beats in both cost and error.

/// Indices of the points (cost, error) on the front, from the cheapest on: each has a smaller error than all that
/// cost as much or less. Points that are not finite are on no front.
pub fn front(points: &[(f64, f64)]) -> Vec<usize> {
    let finite = |k: &usize| points[*k].0.is_finite() && points[*k].1.is_finite();
    let mut order: Vec<usize> = (0..points.len()).filter(finite).collect();
    order.sort_by(|&a, &b| points[a].0.total_cmp(&points[b].0).then(points[a].1.total_cmp(&points[b].1)));
    let mut least = f64::INFINITY;
    order.retain(|&k| {
        let better = points[k].1 < least;
        least = least.min(points[k].1);
        better
    });
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_falls_from_the_cheapest_on() {
        let points = [(4.0, 0.1), (1.0, 1.0), (2.0, 2.0), (3.0, 0.5), (3.0, 0.4), (5.0, 0.1), (f64::NAN, 0.0)];
        assert_eq!(front(&points), [1, 4, 0]);
        assert!(front(&[]).is_empty());
    }

    #[test]
    fn nothing_off_the_front_is_beaten_by_nothing() {
        let points: Vec<_> = (0..200).map(|k| ((k * 37 % 101) as f64, (k * 53 % 97) as f64)).collect();
        let on = front(&points);
        for (k, p) in points.iter().enumerate() {
            let beaten = points.iter().any(|q| q.0 <= p.0 && q.1 <= p.1 && q != p);
            let twin = on.iter().any(|i| points[*i] == *p);
            assert!(beaten != twin, "{k}");
        }
    }
}
