//! Pictures (PNG): the shape of a slope coloured by a field, line plots, intervals, ensembles.
//!
//! Every picture is white, has its text in one embedded font, and is written whole or not at all.

mod annotate;
mod axes;
mod canvas;
mod cells;
mod clip;
mod colour;
mod ensemble;
mod field;
mod font;
mod intervals;
mod kind;
mod layout;
mod legend;
mod look;
mod place;
mod points;
mod series;
mod sheet;
mod text;
mod ticks;
mod view;

pub use axes::{AxisSpec, Scale};
pub use cells::{CellsOptions, cells, range};
pub use colour::{ColourMap, PALETTE, Rgb};
pub use ensemble::{
    FittedNormal, HistogramGroup, Quantity, densities, exceedance, histograms, limits, pairs, settling,
};
pub use field::{Dimension, FieldOptions, field, field_png};
pub use intervals::{Interval, IntervalPlot, intervals, intervals_png};
pub use kind::FieldKind;
pub use series::{Area, Band, Bar, Bars, Curve, Fill, Marker, SeriesPlot, Style, series, series_png, share_axes};
pub use sheet::{Part, sheet};
pub use view::View;

#[cfg(test)]
mod tests;
