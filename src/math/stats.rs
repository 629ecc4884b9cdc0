//! Statistics of small samples.
