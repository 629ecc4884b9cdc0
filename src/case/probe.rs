//! Types of `[[probe]]`: a place of the soil that is looked at when a run is over.

use serde::Serialize;

/// One number of a finished run: a quantity of the soil that started at a place.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Probe {
    /// Default: "probe" with its number from 1.
    pub name: String,
    /// Where the soil was at the start (m): inside a region, or on its outline.
    pub at: [f64; 2],
    pub quantity: ProbeQuantity,
    /// The value that it should have at the end of the run, in the unit of the quantity. Default none: not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exact: Option<f64>,
    /// Where `exact` comes from; needed with it, as a number without a source cannot be checked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
}

/// What a probe reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ProbeQuantity {
    /// Since the start, or since the end of an in-situ phase (m).
    DisplacementX,
    DisplacementY,
    /// m/s.
    VelocityX,
    VelocityY,
    /// Cauchy stress (kPa, tension positive).
    StressXx,
    StressYy,
    StressXy,
    StressZz,
    /// Accumulated plastic shear strain invariant.
    PlasticStrain,
}

impl ProbeQuantity {
    pub const ALL: [ProbeQuantity; 9] = [
        ProbeQuantity::DisplacementX,
        ProbeQuantity::DisplacementY,
        ProbeQuantity::VelocityX,
        ProbeQuantity::VelocityY,
        ProbeQuantity::StressXx,
        ProbeQuantity::StressYy,
        ProbeQuantity::StressXy,
        ProbeQuantity::StressZz,
        ProbeQuantity::PlasticStrain,
    ];

    /// The word of the case file.
    pub fn word(self) -> &'static str {
        match self {
            ProbeQuantity::DisplacementX => "displacement_x",
            ProbeQuantity::DisplacementY => "displacement_y",
            ProbeQuantity::VelocityX => "velocity_x",
            ProbeQuantity::VelocityY => "velocity_y",
            ProbeQuantity::StressXx => "stress_xx",
            ProbeQuantity::StressYy => "stress_yy",
            ProbeQuantity::StressXy => "stress_xy",
            ProbeQuantity::StressZz => "stress_zz",
            ProbeQuantity::PlasticStrain => "plastic_strain",
        }
    }

    /// Unit; empty for a pure number.
    pub fn unit(self) -> &'static str {
        match self {
            ProbeQuantity::DisplacementX | ProbeQuantity::DisplacementY => "m",
            ProbeQuantity::VelocityX | ProbeQuantity::VelocityY => "m/s",
            ProbeQuantity::PlasticStrain => "",
            _ => "kPa",
        }
    }
}
