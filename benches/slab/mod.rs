//! Stiffness of a slab of square bilinear cells in plane strain, without and with what makes it
//! unsymmetric.

use rmpm::math::sparse::{Pattern, offset_bit};

const YOUNG: f64 = 1e4;
const POISSON: f64 = 0.3;
/// tan of the friction angle of the base.
const FRICTION: f64 = 0.36;

/// What the slab is.
#[derive(Clone, Copy, PartialEq)]
pub enum Kind {
    /// Elastic on a base that holds it.
    Elastic,
    /// Elastic on a base along which every node slips: row_t += mu row_n.
    Slipping,
    /// A part of the cells yields: flow without dilation, pressure-dependent strength of this slope.
    Plastic { part: f64, slope: f64 },
}

/// A system of equations.
pub struct Slab {
    pub pattern: Pattern,
    pub values: Vec<f64>,
    pub rhs: Vec<f64>,
}

type Moduli = [[f64; 3]; 3];

impl Slab {
    /// `cells` along and up, loaded by its weight.
    pub fn new(cells: [u32; 2], kind: Kind) -> Self {
        let row = cells[0] + 1;
        let ids: Vec<u32> = (0..row * (cells[1] + 1)).collect();
        let near = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| offset_bit(dx, dy)));
        let mask = near.fold(0, |m, bit| m | 1 << bit);
        let mut pattern = Pattern::default();
        pattern.adopt(row, &ids, &vec![mask; ids.len()], false);
        let mut slab = Slab { values: vec![0.0; pattern.len()], rhs: vec![0.0; pattern.dim()], pattern };
        slab.assemble(cells, kind);
        slab.hold(cells, kind);
        slab
    }

    fn assemble(&mut self, cells: [u32; 2], kind: Kind) {
        let mut random = Random(7);
        let elastic = stiffness(&elasticity());
        for cell in 0..cells[0] * cells[1] {
            let (x, y) = (cell % cells[0], cell / cells[0]);
            let stiffness = match kind {
                Kind::Plastic { part, slope } if random.next() < part => stiffness(&plasticity(slope, &mut random)),
                _ => elastic,
            };
            self.add([x, y], cells[0] + 1, &stiffness);
        }
    }

    fn add(&mut self, [x, y]: [u32; 2], row: u32, stiffness: &[[f64; 8]; 8]) {
        let corner = |a: usize| [(a % 2) as u32, (a / 2) as u32];
        for b in 0..4 {
            let [bx, by] = corner(b);
            let j = (x + bx + (y + by) * row) as usize;
            self.rhs[2 * j + 1] -= 20.0 / 4.0;
            for a in 0..4 {
                let [ax, ay] = corner(a);
                let bit = offset_bit(ax as i32 - bx as i32, ay as i32 - by as i32);
                let (at, stride) = (self.pattern.block(j, bit), self.pattern.stride(j));
                for c in 0..4 {
                    self.values[at + c % 2 + c / 2 * stride] += stiffness[2 * a + c % 2][2 * b + c / 2];
                }
            }
        }
    }

    /// The left side is smooth, the base holds or slips.
    fn hold(&mut self, cells: [u32; 2], kind: Kind) {
        let mut held = vec![false; self.pattern.dim()];
        for j in 0..self.pattern.nodes() {
            let [x, y] = self.pattern.place(j);
            held[2 * j] |= x == 0 || y == 0 && kind != Kind::Slipping;
            held[2 * j + 1] |= y == 0;
            if y == 0 && kind == Kind::Slipping {
                // the tangential equation takes the friction of the reaction
                self.rhs[2 * j] += FRICTION * self.rhs[2 * j + 1];
            }
        }
        let base = if kind == Kind::Slipping { cells[0] as usize + 1 } else { 0 };
        let [pointers, rows] = [self.pattern.col_ptr(), self.pattern.row_idx()];
        for column in 0..self.pattern.dim() {
            let range = pointers[column] as usize..pointers[column + 1] as usize;
            for (k, &row) in range.clone().zip(&rows[range]) {
                let row = row as usize;
                if row.is_multiple_of(2) && row / 2 < base {
                    self.values[k] += FRICTION * self.values[k + 1];
                }
                if held[row] || held[column] {
                    self.values[k] = if row == column { YOUNG } else { 0.0 };
                }
            }
        }
        self.rhs.iter_mut().zip(&held).filter(|(_, held)| **held).for_each(|(b, _)| *b = 0.0);
    }
}

fn elasticity() -> Moduli {
    let shear = YOUNG / (2.0 * (1.0 + POISSON));
    let lame = YOUNG * POISSON / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON));
    [[lame + 2.0 * shear, lame, 0.0], [lame, lame + 2.0 * shear, 0.0], [0.0, 0.0, shear]]
}

/// D - D m n^T D / (n^T D m + H), with the direction of flow m and the normal n of the yield surface.
fn plasticity(slope: f64, random: &mut Random) -> Moduli {
    let d = elasticity();
    let (s, c) = (std::f64::consts::TAU * random.next()).sin_cos();
    let flow = [0.5 * c, -0.5 * c, s];
    let normal = [flow[0] + slope, flow[1] + slope, flow[2]];
    let times = |v: [f64; 3]| d.map(|row| (0..3).map(|k| row[k] * v[k]).sum::<f64>());
    let (stress, weight) = (times(flow), times(normal));
    let softness = (0..3).map(|k| normal[k] * stress[k]).sum::<f64>() + 0.05 * d[2][2];
    std::array::from_fn(|i| std::array::from_fn(|j| d[i][j] - stress[i] * weight[j] / softness))
}

/// Integral of B^T D B over a unit cell, 2 x 2 Gauss points.
fn stiffness(d: &Moduli) -> [[f64; 8]; 8] {
    let mut k = [[0.0; 8]; 8];
    let g = 0.5 / 3f64.sqrt();
    for point in 0..4 {
        let at = [0.5 + if point % 2 == 0 { -g } else { g }, 0.5 + if point / 2 == 0 { -g } else { g }];
        let b = strain(at);
        for (row, first) in k.iter_mut().zip(&b) {
            for (entry, second) in row.iter_mut().zip(&b) {
                *entry += 0.25 * (0..9).map(|m| first[m / 3] * d[m / 3][m % 3] * second[m % 3]).sum::<f64>();
            }
        }
    }
    k
}

/// Strain (xx, yy, xy) by each of the 8 displacements.
fn strain([x, y]: [f64; 2]) -> [[f64; 3]; 8] {
    let slope = [[y - 1.0, x - 1.0], [1.0 - y, -x], [-y, 1.0 - x], [y, x]];
    std::array::from_fn(|i| {
        let [gx, gy] = slope[i / 2];
        if i % 2 == 0 { [gx, 0.0, gy] } else { [0.0, gy, gx] }
    })
}

/// Numbers in 0..1, the same in every run (xorshift).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}
