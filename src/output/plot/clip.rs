//! Lines cut at a rectangle.

/// A polyline in pixels.
pub type Line = Vec<(f64, f64)>;

/// The parts of a polyline inside `lo..hi`. A vertex that is not finite cuts the line.
pub fn polyline(points: &[(f64, f64)], lo: (f64, f64), hi: (f64, f64)) -> Vec<Line> {
    let mut parts: Vec<Line> = Vec::new();
    for pair in points.windows(2) {
        let Some((a, b)) = segment(pair[0], pair[1], lo, hi) else {
            continue;
        };
        match parts.last_mut() {
            Some(part) if part.last() == Some(&a) => part.push(b),
            _ => parts.push(vec![a, b]),
        }
    }
    parts
}

/// The part of a segment inside a rectangle (Liang and Barsky).
fn segment(a: (f64, f64), b: (f64, f64), lo: (f64, f64), hi: (f64, f64)) -> Option<((f64, f64), (f64, f64))> {
    let d = (b.0 - a.0, b.1 - a.1);
    if !(d.0.is_finite() && d.1.is_finite()) {
        return None;
    }
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for (p, q) in [(-d.0, a.0 - lo.0), (d.0, hi.0 - a.0), (-d.1, a.1 - lo.1), (d.1, hi.1 - a.1)] {
        if p == 0.0 && q < 0.0 {
            return None;
        }
        if p < 0.0 {
            from = from.max(q / p);
        } else if p > 0.0 {
            to = to.min(q / p);
        }
    }
    let at = |t: f64| (a.0 + t * d.0, a.1 + t * d.1);
    // The untouched ends are kept exactly, so that neighbours join.
    (from <= to).then(|| (if from == 0.0 { a } else { at(from) }, if to == 1.0 { b } else { at(to) }))
}

/// Fewer vertices for the same picture: of a line's neighbouring vertices in one pixel column only
/// the first, lowest, highest and last are kept.
pub fn thin(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    if points.len() < 8192 {
        return points;
    }
    let mut kept = Vec::new();
    for column in points.chunk_by(|a, b| a.0.floor() == b.0.floor()) {
        keep_extremes(column, &mut kept);
    }
    kept
}

fn keep_extremes(column: &[(f64, f64)], kept: &mut Vec<(f64, f64)>) {
    if column.len() <= 4 {
        kept.extend_from_slice(column);
        return;
    }
    let order = |i: &usize, j: &usize| column[*i].1.total_cmp(&column[*j].1);
    let lowest = (0..column.len()).min_by(order).unwrap_or(0);
    let highest = (0..column.len()).max_by(order).unwrap_or(0);
    let mut picked = [0, lowest.min(highest), lowest.max(highest), column.len() - 1].to_vec();
    picked.dedup();
    kept.extend(picked.into_iter().map(|i| column[i]));
}
