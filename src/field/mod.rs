//! Random fields. So far: the streams of random numbers that fields will draw from.

pub mod stream;
