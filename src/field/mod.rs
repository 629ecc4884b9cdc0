//! Random fields: streams of random numbers, correlations, generators of local averages, and parameters
//! made of them.

pub mod correlation;
pub mod generator;
pub mod marginal;
pub mod model;
pub mod normals;
mod quadrature;
pub mod stream;
pub mod table;
