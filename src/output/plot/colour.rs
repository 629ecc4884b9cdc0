//! Colours and colour maps.

use std::sync::LazyLock;

/// An sRGB colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rgb(pub u8, pub u8, pub u8);

impl Rgb {
    /// A share `t` in 0..1 of the way to white.
    pub fn paler(self, t: f64) -> Rgb {
        let mix = |c: u8| (f64::from(c) + t.clamp(0.0, 1.0) * (255.0 - f64::from(c))).round() as u8;
        Rgb(mix(self.0), mix(self.1), mix(self.2))
    }
}

pub const BLACK: Rgb = Rgb(25, 25, 25);
pub const WHITE: Rgb = Rgb(255, 255, 255);
pub const GRID: Rgb = Rgb(226, 226, 226);
/// Where a point has no value.
pub const NO_VALUE: Rgb = Rgb(176, 176, 176);
/// Blue, light blue, orange, red: elastic, unloading, softening, residual.
pub const STAGES: [Rgb; 4] = [Rgb(36, 84, 164), Rgb(142, 199, 235), Rgb(245, 155, 35), Rgb(200, 37, 44)];

/// Colours of curves and of materials, one after the other.
pub const PALETTE: [Rgb; 8] = [
    Rgb(31, 97, 168),
    Rgb(214, 84, 30),
    Rgb(42, 145, 80),
    Rgb(146, 72, 160),
    Rgb(200, 150, 20),
    Rgb(20, 150, 165),
    Rgb(190, 50, 95),
    Rgb(105, 105, 105),
];

/// A map from 0..1 to colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColourMap {
    /// Dark violet over green to yellow; lightness grows evenly.
    Sequential,
    /// Blue (low) over pale yellow to red (high).
    Diverging,
}

/// Knots of a map: lightness, chroma and hue (degrees) in OKLCh.
type Knots = [[f64; 3]; 5];

const SEQUENTIAL: Knots =
    [[0.28, 0.115, 308.0], [0.44, 0.115, 268.0], [0.60, 0.110, 200.0], [0.76, 0.165, 148.0], [0.92, 0.185, 106.0]];

const DIVERGING: Knots =
    [[0.45, 0.170, 262.0], [0.72, 0.105, 238.0], [0.965, 0.065, 102.0], [0.76, 0.145, 58.0], [0.48, 0.195, 27.0]];

const STEPS: usize = 256;

impl ColourMap {
    /// Colour at `t` in 0..1; values beyond the ends take the end's colour, NaN is grey.
    pub fn at(self, t: f64) -> Rgb {
        if t.is_nan() {
            return NO_VALUE;
        }
        let step = (t.clamp(0.0, 1.0) * (STEPS - 1) as f64).round() as usize;
        self.table()[step.min(STEPS - 1)]
    }

    fn table(self) -> &'static [Rgb; STEPS] {
        static TABLES: LazyLock<[[Rgb; STEPS]; 2]> =
            LazyLock::new(|| [table(&SEQUENTIAL, true), table(&DIVERGING, false)]);
        &TABLES[self as usize]
    }
}

/// A map of even steps. Around the hue circle (`polar`) or straight through the OKLab space.
fn table(knots: &Knots, polar: bool) -> [Rgb; STEPS] {
    std::array::from_fn(|i| {
        let t = i as f64 / (STEPS - 1) as f64 * (knots.len() - 1) as f64;
        let k = (t as usize).min(knots.len() - 2);
        let (a, b, s) = (knots[k], knots[k + 1], t - k as f64);
        if polar { oklab_to_rgb(oklab(mix(a, b, s))) } else { oklab_to_rgb(mix(oklab(a), oklab(b), s)) }
    })
}

fn mix(a: [f64; 3], b: [f64; 3], s: f64) -> [f64; 3] {
    std::array::from_fn(|i| a[i] + s * (b[i] - a[i]))
}

fn oklab([l, c, h]: [f64; 3]) -> [f64; 3] {
    let h = h.to_radians();
    [l, c * h.cos(), c * h.sin()]
}

/// OKLab to sRGB (B. Ottosson, "A perceptual color space for image processing", 2020). A colour
/// outside sRGB loses chroma, never lightness.
fn oklab_to_rgb(lab: [f64; 3]) -> Rgb {
    let inside = |rgb: &[f64; 3]| rgb.iter().all(|x| (-1e-4..=1.0001).contains(x));
    let faded =
        |k: i32| linear_rgb([lab[0], lab[1] * (1.0 - 0.02 * f64::from(k)), lab[2] * (1.0 - 0.02 * f64::from(k))]);
    let rgb = (0..=50).map(faded).find(inside).unwrap_or([lab[0]; 3]);
    let [r, g, b] = rgb.map(|x| (gamma(x.clamp(0.0, 1.0)) * 255.0).round() as u8);
    Rgb(r, g, b)
}

fn linear_rgb([l, a, b]: [f64; 3]) -> [f64; 3] {
    let p = (l + 0.396_337_777_4 * a + 0.215_803_757_3 * b).powi(3);
    let q = (l - 0.105_561_345_8 * a - 0.063_854_172_8 * b).powi(3);
    let r = (l - 0.089_484_177_5 * a - 1.291_485_548_0 * b).powi(3);
    [
        4.076_741_662_1 * p - 3.307_711_591_3 * q + 0.230_969_929_2 * r,
        -1.268_438_004_6 * p + 2.609_757_401_1 * q - 0.341_319_396_5 * r,
        -0.004_196_086_3 * p - 0.703_418_614_7 * q + 1.707_614_701_0 * r,
    ]
}

fn gamma(x: f64) -> f64 {
    if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 }
}
