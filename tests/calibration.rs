//! The scalar yardstick of the benchmarks is right before it is fast.

#[path = "../benches/scalar/mod.rs"]
mod scalar;
