//! The background grid and the shape functions on it.

pub mod bspline;
pub mod gauss;
pub mod gimp;
pub mod grid;
pub mod shape;
pub mod stencil;

pub use bspline::BSpline;
pub use gimp::{Gimp, GimpWide};
pub use grid::Grid;
pub use shape::{Linear, Shape};
pub use stencil::Stencil;
