//! `rmpm`: slope failure with the random material point method.

pub mod work;
pub mod math;
pub mod case;
pub mod sim;
pub mod output;
