//! Random fields: streams of random numbers, correlations, generators of local averages, and parameters
//! made of them.

mod choose;
pub mod correlation;
pub mod embedding;
pub mod exact;
pub mod generator;
pub mod implied;
pub mod las;
pub mod map;
pub mod marginal;
pub mod model;
pub mod normals;
mod quadrature;
pub mod squash;
pub mod stream;
pub mod table;
