//! Symmetric tensors in plane strain.

/// Components (xx, yy, zz, xy) of a symmetric tensor in plane strain; xy is the tensor
/// component, not the engineering shear.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Voigt {
    pub xx: f64,
    pub yy: f64,
    pub zz: f64,
    pub xy: f64,
}
