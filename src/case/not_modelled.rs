//! What the program leaves out, by the words people use for it: refused clearly, not as a typing
//! error.

use super::log::Problem;

/// One thing left out.
struct Absent {
    words: &'static [&'static str],
    why: &'static str,
    instead: &'static str,
}

const ABSENT: &[Absent] = &[
    Absent {
        words: &[
            "water",
            "water_table",
            "water_level",
            "groundwater",
            "phreatic",
            "phreatic_line",
            "phreatic_surface",
            "pore_pressure",
            "pore_water_pressure",
            "pressure_head",
            "permeability",
            "hydraulic_conductivity",
            "seepage",
            "saturation",
            "suction",
            "porosity",
            "consolidation",
        ],
        why: "rmpm is a total-stress program: no pore pressure, no flow of water",
        instead: "give undrained strengths and total unit weights",
    },
    Absent {
        words: &["surcharge", "traction", "pressure", "line_load"],
        why: "rmpm has no pressure on a surface: a load is a force on the soil of a box",
        instead: "a surcharge can be a region of soil with its weight, or a `[[load]]` on the points below the surface",
    },
    Absent {
        words: &["loads", "point_load", "force", "forces"],
        why: "a force acts on the points that start in a box, shared by their volumes",
        instead: "write [[load]] with `box` and `force`",
    },
    Absent {
        words: &["footing", "plate", "drives", "displacement", "prescribed_displacement", "prescribed_velocity"],
        why: "what moves the soil is a box whose grid nodes have a given velocity",
        instead: "write [[drive]] with `box`, `velocity_x` and `velocity_y`",
    },
    Absent {
        words: &[
            "friction_angle",
            "phi",
            "dilation_angle",
            "dilatancy",
            "dilatancy_angle",
            "psi",
            "effective_cohesion",
            "mohr_coulomb",
            "drucker_prager",
            "cam_clay",
            "modified_cam_clay",
            "hoek_brown",
            "tresca",
        ],
        why: "rmpm is a total-stress program: its strength is an undrained cohesion",
        instead: "the laws are elastic and von_mises; the key of the strength is `cohesion`",
    },
    Absent {
        words: &["earthquake", "seismic", "accelerogram", "ground_motion", "kh", "kv"],
        why: "rmpm has no earthquakes: gravity is constant once it is on",
        instead: "a steady sideways pull can be given as `gravity.tilt`",
    },
    Absent {
        words: &["anchor", "anchors", "nail", "nails", "geotextile", "pile", "piles", "beam"],
        why: "rmpm has no structural elements",
        instead: "a stiff part can be a region with an elastic material",
    },
    Absent {
        words: &["viscosity", "creep", "strain_rate", "rate_exponent"],
        why: "rmpm has no strength that depends on the rate of strain",
        instead: "`damping.viscous` damps the motion as a whole",
    },
    Absent {
        words: &["random_field", "fields"],
        why: "a random field is a table with a name of your own",
        instead: "write [field.strength] with `material`, `parameters`, `variation`, `theta_h` and `theta_v`",
    },
    Absent {
        words: &["correlation_length", "scale_of_fluctuation", "coefficient_of_variation"],
        why: "a field has scales of fluctuation `theta_h` and `theta_v`, and V = `variation`",
        instead: "the scale of an exponential correlation is twice its correlation length",
    },
    Absent {
        words: &["thickness", "depth", "z"],
        why: "rmpm works in plane strain: all is per metre of width",
        instead: "leave the key out",
    },
];

/// The refusal for a word that names something left out.
pub(super) fn problem(word: &str) -> Option<Problem> {
    let word = word.to_lowercase();
    let absent = ABSENT.iter().find(|absent| absent.words.contains(&word.as_str()))?;
    Some(Problem::new(format!("`{word}` is not modelled"), absent.why).help(absent.instead))
}
