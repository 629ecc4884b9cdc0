//! Round numbers for axes and how they are written.

/// The step 1, 2 or 5 times a power of ten that cuts `span` into at most about `target` parts.
pub fn nice_step(span: f64, target: usize) -> f64 {
    let raw = span / target.max(1) as f64;
    let power = 10_f64.powf(raw.log10().floor());
    let step = match raw / power {
        x if x <= 1.0 + 1e-9 => power,
        x if x <= 2.0 + 1e-9 => 2.0 * power,
        x if x <= 5.0 + 1e-9 => 5.0 * power,
        _ => 10.0 * power,
    };
    if step.is_finite() && step > 0.0 { step } else { span.max(f64::MIN_POSITIVE) }
}

/// Multiples of a nice step in `lo..=hi`, and the step.
pub fn linear(lo: f64, hi: f64, target: usize) -> (Vec<f64>, f64) {
    let step = nice_step(hi - lo, target);
    let first = (lo / step - 1e-6).ceil();
    let count = ((hi / step + 1e-6).floor() - first + 1.0).clamp(0.0, 100.0) as usize;
    // Adding 0 turns -0 into 0.
    ((0..count).map(|i| (first + i as f64) * step + 0.0).collect(), step)
}

/// Powers of ten in `lo..=hi` (every n-th if there are many), with 2 and 5 times them where
/// the range is short.
pub fn logarithmic(lo: f64, hi: f64, target: usize) -> Vec<f64> {
    let (first, last) = (lo.log10() - 1e-9, hi.log10() + 1e-9);
    let decades = first.ceil() as i32..=last.floor() as i32;
    let count = decades.clone().count();
    if count >= 3 || (count == 2 && last - first > 1.8) {
        let every = count.div_ceil(target.max(2));
        return decades.step_by(every).map(|k| 10_f64.powi(k)).collect();
    }
    let factors =
        if last - first < 0.5 { &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0][..] } else { &[1.0, 2.0, 5.0] };
    let all =
        (first.floor() as i32..=last.floor() as i32).flat_map(|k| factors.iter().map(move |f| f * 10_f64.powi(k)));
    all.filter(|v| (first..=last).contains(&v.log10())).collect()
}

/// 2, 3 .. 9 times the powers of ten in `lo..=hi`.
pub fn logarithmic_minor(lo: f64, hi: f64) -> Vec<f64> {
    let (first, last) = (lo.log10(), hi.log10());
    if last - first > 12.0 {
        return Vec::new();
    }
    let all =
        (first.floor() as i32..=last.floor() as i32).flat_map(|k| (2..10).map(move |f| f64::from(f) * 10_f64.powi(k)));
    all.filter(|v| (first..=last).contains(&v.log10())).collect()
}

/// A range that can be drawn: finite, in order and wider than rounding.
pub fn sane_range(lo: f64, hi: f64) -> (f64, f64) {
    const MOST: f64 = 1e300;
    let (lo, hi) = match (lo.is_nan(), hi.is_nan()) {
        (true, true) => (0.0, 1.0),
        (true, false) => (hi, hi),
        (false, true) => (lo, lo),
        (false, false) => (lo.min(hi), lo.max(hi)),
    };
    let (lo, hi) = (lo.clamp(-MOST, MOST), hi.clamp(-MOST, MOST));
    let size = lo.abs().max(hi.abs());
    if hi - lo > (1e-9 * size).max(1e-290) {
        return (lo, hi);
    }
    let pad = if size < 1e-280 { 1.0 } else { 0.05 * size };
    (lo - pad, hi + pad)
}

/// The same for a logarithmic axis: both ends above zero, at most 280 decades.
pub fn sane_log_range(lo: f64, hi: f64) -> (f64, f64) {
    let usable = |x: f64| x.is_finite() && x > 0.0;
    let (lo, hi) = match (usable(lo), usable(hi)) {
        (true, true) => (lo.min(hi), lo.max(hi)),
        (true, false) => (lo, lo),
        (false, true) => (hi, hi),
        (false, false) => (1.0, 1.0),
    };
    let (lo, hi) = (lo.clamp(1e-140, 1e140), hi.clamp(1e-140, 1e140));
    if hi / lo > 1.01 { (lo, hi) } else { (lo / 2.0, hi * 2.0) }
}

/// Labels of ticks that are `step` apart: as many decimals as the step needs, powers of ten for
/// very large and very small numbers.
pub fn labels(values: &[f64], step: f64) -> Vec<String> {
    let size = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let exponent = size.max(step).log10().floor();
    let digits = (step.log10() + 1e-9).floor();
    if (-4.0..6.0).contains(&exponent) {
        let decimals = (-digits).clamp(0.0, 12.0) as usize;
        return values.iter().map(|v| minus(format!("{v:.decimals$}"))).collect();
    }
    let decimals = (exponent - digits).clamp(0.0, 9.0) as usize;
    values.iter().map(|v| if *v == 0.0 { "0".into() } else { scientific(*v, exponent as i32, decimals) }).collect()
}

/// Labels of ticks on a logarithmic axis: powers of ten unless all numbers are short.
pub fn log_labels(values: &[f64]) -> Vec<String> {
    let short = values.iter().all(|v| (0.999e-3..1e4).contains(v));
    values.iter().map(|v| if short { number(*v) } else { power(*v) }).collect()
}

fn power(value: f64) -> String {
    let exponent = (value.log10() + 1e-9).floor() as i32;
    let mantissa = value / 10_f64.powi(exponent);
    if (mantissa - 1.0).abs() < 1e-6 {
        format!("10{}", superscript(exponent))
    } else {
        scientific(value, exponent, usize::from(mantissa.fract() > 1e-6))
    }
}

/// A number with three digits, for text.
pub fn number(value: f64) -> String {
    if !value.is_finite() {
        return format!("{value}");
    }
    let exponent = if value == 0.0 { 0.0 } else { value.abs().log10().floor() };
    if !(-4.0..6.0).contains(&exponent) {
        return scientific(value, exponent as i32, 2);
    }
    let decimals = (2.0 - exponent).clamp(0.0, 8.0) as usize;
    let text = format!("{value:.decimals$}");
    let short = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    minus(short.to_owned())
}

fn scientific(value: f64, exponent: i32, decimals: usize) -> String {
    // Two factors, for a power below the smallest float.
    let half = exponent / 2;
    let mantissa = value / 10_f64.powi(half) / 10_f64.powi(exponent - half);
    minus(format!("{mantissa:.decimals$}×10{}", superscript(exponent)))
}

fn superscript(number: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raise = |c: char| c.to_digit(10).map_or('⁻', |d| DIGITS[d as usize % 10]);
    number.to_string().chars().map(raise).collect()
}

/// With the true minus sign; "-0.0" loses it.
fn minus(text: String) -> String {
    let negative = text.starts_with('-') && text.chars().any(|c| ('1'..='9').contains(&c));
    if negative { text.replacen('-', "\u{2212}", 1) } else { text.trim_start_matches('-').to_owned() }
}
