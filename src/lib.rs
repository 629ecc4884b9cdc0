//! `rmpm`: slope failure with the random material point method.

// Loops over lanes index several columns at once; that is what the compiler vectorises.
#![allow(clippy::needless_range_loop)]

pub mod fault;
pub mod work;

pub mod math;

pub mod case;

pub mod material;

pub mod kinematics;

pub mod space;

pub mod field;

pub mod block;

pub mod snapshot;

pub mod body;

pub mod nodes;

pub mod seed;

pub mod assembly;

pub mod transfer;

pub mod effect;

pub mod step;

pub mod sim;

pub mod scene;

pub mod measure;

pub mod run;

pub mod output;

pub mod study;

pub mod cli;
