//! `rmpm`: slope failure with the random material point method.
//!
//! A case is read and checked, a scene is built from it, and the scene is run:
//!
//! ```
//! use rmpm::{case, run, scene};
//!
//! // the paper's slope in coarse cells, up to its first block
//! let text = case::template("slope").ok_or("no such template")?;
//! let overrides = ["grid.cell=0.5".to_owned(), "end.time=8".to_owned()];
//! let (case, _warnings) = case::read("slope.toml", text, &overrides).map_err(|e| e.render(false))?;
//!
//! let mut scene = scene::build(&case, 1 << 30)?; // at most 1 GiB
//! let outcome = run::run(&case, &mut scene, run::Limits::NONE, &mut run::Blind)?;
//!
//! assert_eq!(outcome.status, run::Status::EndTime);
//! assert!(outcome.measures.sliding_distance_m > Some(2.0)); // m
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! In place of [`run::Blind`] stands any [`run::Observer`]: it is handed every row of the history
//! and every frame. The modules are listed from the ground up: each uses only those above it in
//! `lib.rs`. ARCHITECTURE.md says what each is for.

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

pub mod domain;

pub mod nodes;

pub mod seed;

pub mod system;

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
