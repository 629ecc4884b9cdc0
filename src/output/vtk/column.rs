//! The arrays of a frame: one line each.

use crate::snapshot::Snapshot;

/// One array of the file. It has one tuple per point, or one in all for [`Section::Field`].
pub struct Column {
    pub section: Section,
    /// Name of the array in VTK.
    pub name: &'static str,
    /// VTK's name of the number type.
    pub number: &'static str,
    /// Bytes of one number.
    pub bytes: u64,
    /// Numbers in a tuple.
    pub components: u64,
    /// Names of the components; empty where x, y, z is meant.
    pub component_names: &'static [&'static str],
    /// Appends the tuple of point `i`.
    pub put: fn(&Snapshot, usize, &mut Vec<u8>),
}

/// The part of the file an array stands in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Section {
    Field,
    Points,
    Verts,
    PointData,
}

impl Column {
    /// Tuples in the array for a body of `points` points.
    pub fn tuples(&self, points: u64) -> u64 {
        if self.section == Section::Field { 1 } else { points }
    }
}

/// All arrays, in the order of the file.
pub const COLUMNS: &[Column] = &[
    scalar(Section::Field, "TimeValue", "Float64", 8, |s, _, o| f64s(o, &[s.time])),
    scalar(Section::Field, "step", "UInt64", 8, |s, _, o| o.extend(s.step.to_le_bytes())),
    vector(Section::Points, "Points", |s, i, o| plane(o, s.position[i])),
    scalar(Section::Verts, "connectivity", "Int64", 8, |_, i, o| o.extend((i as i64).to_le_bytes())),
    scalar(Section::Verts, "offsets", "Int64", 8, |_, i, o| o.extend((i as i64 + 1).to_le_bytes())),
    vector(Section::PointData, "displacement", |s, i, o| plane(o, s.displacement(i))),
    vector(Section::PointData, "velocity", |s, i, o| plane(o, s.velocity[i])),
    Column {
        section: Section::PointData,
        name: "stress",
        number: "Float64",
        bytes: 8,
        components: 4,
        component_names: &["xx", "yy", "zz", "xy"],
        put: |s, i, o| f64s(o, &[s.stress[i].xx, s.stress[i].yy, s.stress[i].zz, s.stress[i].xy]),
    },
    real("plastic_strain", |s, i, o| f64s(o, &[s.plastic_strain[i]])),
    real("strength", |s, i, o| f64s(o, &[s.strength[i]])),
    real("peak_strength", |s, i, o| f64s(o, &[s.peak_strength[i]])),
    scalar(Section::PointData, "stage", "UInt8", 1, |s, i, o| o.push(s.stage[i] as u8)),
    scalar(Section::PointData, "material", "UInt16", 2, |s, i, o| o.extend(s.material[i].to_le_bytes())),
    real("jacobian", |s, i, o| f64s(o, &[s.jacobian[i]])),
    real("mass", |s, i, o| f64s(o, &[s.mass[i]])),
    real("initial_volume", |s, i, o| f64s(o, &[s.initial_volume[i]])),
    real("strain_energy", |s, i, o| f64s(o, &[s.strain_energy[i]])),
    vector(Section::PointData, "reference", |s, i, o| plane(o, s.reference[i])),
];

type Put = fn(&Snapshot, usize, &mut Vec<u8>);

const fn scalar(section: Section, name: &'static str, number: &'static str, bytes: u64, put: Put) -> Column {
    Column { section, name, number, bytes, components: 1, component_names: &[], put }
}

const fn real(name: &'static str, put: Put) -> Column {
    scalar(Section::PointData, name, "Float64", 8, put)
}

const fn vector(section: Section, name: &'static str, put: Put) -> Column {
    Column { section, name, number: "Float64", bytes: 8, components: 3, component_names: &[], put }
}

fn f64s(out: &mut Vec<u8>, values: &[f64]) {
    for value in values {
        out.extend_from_slice(&value.to_le_bytes());
    }
}

fn plane(out: &mut Vec<u8>, v: [f64; 2]) {
    f64s(out, &[v[0], v[1], 0.0]);
}
