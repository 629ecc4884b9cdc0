//! `[field.NAME]`.

use std::collections::BTreeMap;

use crate::case::Material;
use crate::case::check::{Materials, PlacedRegion};
use crate::case::cursor::Cursor;
use crate::case::keys::{Keys, Variant};
use crate::case::limits::{COORDINATE, FRACTION, between, figure, positive, rounded, signed};
use crate::case::log::Problem;
use crate::case::outline::Extent;
use crate::case::random::{CorrelationFamily, Field, FieldGenerator, LowValues, Marginal, Parameter};
use crate::case::suggest;

const DISTRIBUTIONS: &[Variant] =
    &[Variant { word: "normal", keys: &["low_values", "floor"] }, Variant { word: "lognormal", keys: &[] }];

/// Lowest value of a normal field, as a share of the mean. A strength of nothing has no meaning.
const FLOOR: f64 = 0.05;

/// Most cells of a field.
const MOST_CELLS: f64 = 16e6;

/// Reads `[field]`.
pub(super) fn fields(
    root: &mut Keys<'_>,
    materials: Option<&Materials>,
    regions: Option<&[PlacedRegion]>,
) -> Option<BTreeMap<String, Field>> {
    root.or("field", BTreeMap::new(), |c| {
        let keys = c.table()?;
        let cursors = keys.names().filter_map(|name| Some((name, keys.named(name)?)));
        // every field is read, so that every error is found
        let read: Vec<_> = cursors.map(|(name, c)| (name.clone(), field(&c, materials, regions), c)).collect();
        one_field_each(&read)?;
        read.into_iter().map(|(name, field, _)| Some((name, field?))).collect()
    })
}

/// A parameter with two fields would have two values.
fn one_field_each(read: &[(String, Option<Field>, Cursor<'_>)]) -> Option<()> {
    let mut seen = BTreeMap::new();
    for (name, field, cursor) in read {
        let Some(field) = field else { continue };
        for parameter in &field.parameters {
            if let Some(first) = seen.insert((&field.material, *parameter), name) {
                let message = format!(
                    "`{}` of material `{}` has two fields, `{first}` and `{name}`",
                    parameter.word(),
                    field.material
                );
                cursor.key_error(Problem::new(message, "leave the parameter out of one of them"));
                return None;
            }
        }
    }
    Some(())
}

fn field(cursor: &Cursor<'_>, materials: Option<&Materials>, regions: Option<&[PlacedRegion]>) -> Option<Field> {
    let mut keys = cursor.table()?;
    let material = keys.required("material", |c| known(c, materials));
    let law = material.as_ref().zip(materials).and_then(|(name, m)| m.by_name.get(name)?.1.as_ref());
    let parameters = keys.required("parameters", |c| parameters(c, law));
    let variation = keys.required("variation", |c| c.number(between(0.0, 5.0, "")));
    let theta_h = keys.required("theta_h", |c| c.number(positive("m")));
    let theta_v = keys.required("theta_v", |c| c.number(positive("m")));
    let correlation = keys.or("correlation", CorrelationFamily::Markov, family);
    let marginal = marginal(&mut keys);
    let depth_gradient = keys.or("depth_gradient", 0.0, |c| c.number(signed("1/m")));
    let extent = material.as_ref().zip(regions).and_then(|(name, regions)| extent(name, regions));
    let datum = keys.optional("datum", |c| c.number(COORDINATE));
    let quarter = theta_h.zip(theta_v).map(|(h, v)| 0.25 * h.min(v));
    let cell = keys.optional("cell", |c| c.formula(positive("m")));
    let generator = keys.or("generator", FieldGenerator::Auto, generator);
    let correlation_error = keys.or("correlation_error", 0.05, |c| c.number(between(1e-12, 1.0, "")));
    let variance_error = keys.or("variance_error", 0.03, |c| c.number(between(1e-12, 1.0, "")));
    let (datum, cell) = (datum?, cell?);
    let size = extent.as_ref().zip(cell.or(quarter));
    let sound = size.is_none_or(|(soil, cell)| few_cells(&mut keys, soil, cell));
    let top = datum.or(extent.as_ref().map(|soil| soil.high[1]));
    let trend = extent.as_ref().zip(top).zip(depth_gradient);
    let rising = trend.is_none_or(|((soil, top), gradient)| stays_positive(&mut keys, soil, top, gradient));
    keys.finish();
    if !sound || !rising {
        return None;
    }
    Some(Field {
        material: material?,
        parameters: parameters?,
        variation: variation?,
        theta_h: theta_h?,
        theta_v: theta_v?,
        correlation: correlation?,
        marginal: marginal?,
        depth_gradient: depth_gradient?,
        // without a region there is no top, and nothing that the trend would act on
        datum: top.unwrap_or(0.0),
        cell: cell.or(quarter)?,
        generator: generator?,
        correlation_error: correlation_error?,
        variance_error: variance_error?,
    })
}

fn known(cursor: &Cursor<'_>, materials: Option<&Materials>) -> Option<String> {
    let name = cursor.text()?;
    let Some(materials) = materials else { return Some(name.to_owned()) };
    if materials.by_name.contains_key(name) {
        return Some(name.to_owned());
    }
    let names = || materials.by_name.keys().map(String::as_str);
    let label = format!("the materials are {}", suggest::list(names()));
    let problem = Problem::new(format!("unknown material `{name}`"), label);
    cursor.error(problem.help_if(suggest::did_you_mean(name, names())));
    None
}

fn parameters(cursor: &Cursor<'_>, law: Option<&Material>) -> Option<Vec<Parameter>> {
    let items = cursor.list()?;
    if items.is_empty() {
        cursor.error(Problem::new("this field scales nothing", "needs at least one parameter"));
        return None;
    }
    let found: Vec<_> = items.iter().map(|c| parameter(c, law)).collect();
    let found: Vec<Parameter> = found.into_iter().collect::<Option<_>>()?;
    for (k, (p, item)) in found.iter().zip(&items).enumerate() {
        if found[..k].contains(p) {
            item.error(Problem::new(format!("`{}` stands here twice", p.word()), "once is enough"));
            return None;
        }
    }
    Some(found)
}

fn parameter(cursor: &Cursor<'_>, law: Option<&Material>) -> Option<Parameter> {
    let word = cursor.word(&Parameter::ALL.map(Parameter::word))?;
    let found = Parameter::ALL.into_iter().find(|p| p.word() == word)?;
    let mean = law.map(|law| found.of(law));
    let problem = match mean {
        Some(None) => Problem::new(format!("this material has no `{word}`"), "must be a parameter of its law"),
        Some(Some(0.0)) => {
            Problem::new(format!("the mean of `{word}` is 0"), "a field scales the mean: nothing would vary")
        }
        _ => return Some(found),
    };
    cursor.error(problem);
    None
}

fn family(cursor: &Cursor<'_>) -> Option<CorrelationFamily> {
    match cursor.word(&["markov", "markov_separable", "gaussian", "spherical"])? {
        "markov_separable" => Some(CorrelationFamily::MarkovSeparable),
        "gaussian" => Some(CorrelationFamily::Gaussian),
        "spherical" => Some(CorrelationFamily::Spherical),
        _ => Some(CorrelationFamily::Markov),
    }
}

fn generator(cursor: &Cursor<'_>) -> Option<FieldGenerator> {
    match cursor.word(&["auto", "las", "exact", "embedding"])? {
        "las" => Some(FieldGenerator::Las),
        "exact" => Some(FieldGenerator::Exact),
        "embedding" => Some(FieldGenerator::Embedding),
        _ => Some(FieldGenerator::Auto),
    }
}

fn marginal(keys: &mut Keys<'_>) -> Option<Marginal> {
    match keys.tag("distribution", Some("normal"), DISTRIBUTIONS)? {
        "lognormal" => Some(Marginal::Lognormal),
        _ => Some(Marginal::Normal { low_values: low_values(keys)? }),
    }
}

fn low_values(keys: &mut Keys<'_>) -> Option<LowValues> {
    let word = keys.or("low_values", "floor", |c| c.word(&["floor", "resample", "none"]));
    let floor = keys.or("floor", FLOOR, |c| c.number(FRACTION));
    let (word, floor) = (word?, floor?);
    if word == "none" {
        no_floor(keys);
        return Some(LowValues::None);
    }
    if floor <= 0.0 {
        let problem = Problem::new("a floor of 0 leaves parameters of nothing", "must be greater than 0");
        keys.get("floor")?.error(problem.help("`low_values = \"none\"` leaves the values as they are"));
        return None;
    }
    Some(if word == "floor" { LowValues::Floor { floor } } else { LowValues::Resample { floor } })
}

/// `floor` belongs to floor and resample alone; one of the file lapses where an override chose.
fn no_floor(keys: &mut Keys<'_>) {
    let Some(floor) = keys.get("floor") else { return };
    let overridden = keys.named("low_values").is_some_and(|c| !c.node.span.in_file());
    if !(floor.key.in_file() && overridden) {
        let message = format!("`{}` has no meaning with low_values = \"none\"", floor.path);
        floor.key_error(Problem::new(message, "a key of low_values \"floor\" and \"resample\""));
    }
}

/// How far a material reaches; `None` where no region is made of it.
fn extent(material: &str, regions: &[PlacedRegion]) -> Option<Extent> {
    let own = regions.iter().filter_map(|r| r.value.as_ref()).filter(|r| r.material == material);
    Extent::of(&own.map(|r| &r.shape).collect::<Vec<_>>())
}

fn few_cells(keys: &mut Keys<'_>, soil: &Extent, cell: f64) -> bool {
    let cells: f64 = (0..2).map(|a| ((soil.high[a] - soil.low[a]) / cell).ceil()).product();
    if cells <= MOST_CELLS {
        return true;
    }
    let message = format!("the field has {} cells of {} m", rounded(cells), figure(cell));
    let problem = Problem::new(message, format!("at most {}", figure(MOST_CELLS))).help("set a larger `cell`");
    match keys.get("cell") {
        Some(cursor) => cursor.error(problem),
        None => drop(keys.header_error::<()>("cell", problem)),
    }
    false
}

/// The trend of the mean keeps its sign over the material.
fn stays_positive(keys: &mut Keys<'_>, soil: &Extent, datum: f64, gradient: f64) -> bool {
    let ends = [soil.low[1], soil.high[1]].map(|y| 1.0 + gradient * (datum - y));
    let least = ends[0].min(ends[1]);
    if least > 0.0 {
        return true;
    }
    let message = format!("the mean falls to {} of its value at the datum", rounded(least));
    let problem = Problem::new(message, "must stay positive over the material");
    match keys.get("depth_gradient") {
        Some(cursor) => cursor.error(problem),
        None => drop(keys.header_error::<()>("depth_gradient", problem)),
    }
    false
}
