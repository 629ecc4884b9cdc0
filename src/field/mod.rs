//! Random fields: streams of random numbers, correlations, and generators of local averages.

pub mod correlation;
pub mod normals;
mod quadrature;
pub mod stream;
pub mod table;
