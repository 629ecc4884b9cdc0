//! The map from normals to a field: linear, and the same for every realisation.

use super::{embedding::Room, normals::Source};

/// Buffers of a realisation; they grow with the first and are kept.
#[derive(Default)]
pub struct Scratch {
    /// Normals drawn, or what is summed for them by an adjoint.
    pub(super) normals: Vec<f64>,
    /// The stage before and the one after.
    pub(super) stages: [Vec<f64>; 2],
    /// The field before rows or columns are averaged.
    pub(super) fine: Vec<f64>,
    /// A row of children that lies outside the lattice.
    pub(super) row: Vec<f64>,
    /// What a transform of a periodic plane works in.
    pub(super) plane: Room,
}

/// z = W u: a field of `cells` numbers from `normals` standard normals.
///
/// The covariance it implies is W W^T, so column i of that is W (W^T e_i): one adjoint, one map.
pub trait Map {
    /// Cells of the field.
    fn cells(&self) -> usize;

    /// Normals of a realisation.
    fn normals(&self) -> usize;

    /// z = W u, the u drawn from `source` in their order.
    fn apply(&self, source: &mut dyn Source, scratch: &mut Scratch, z: &mut [f64]);

    /// u = W^T z.
    fn adjoint(&self, z: &[f64], scratch: &mut Scratch, u: &mut [f64]);

    /// Along which axes the covariance stays the same if the lattice is mirrored.
    fn mirrors(&self) -> [bool; 2];
}

/// The first `n` numbers of a buffer, which grows to hold them.
pub(super) fn first(buffer: &mut Vec<f64>, n: usize) -> &mut [f64] {
    if buffer.len() < n {
        buffer.resize(n, 0.0);
    }
    &mut buffer[..n]
}
