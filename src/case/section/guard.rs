//! `[guard]`.

use crate::case::Guard;
use crate::case::cursor::Cursor;
use crate::case::keys::Keys;
use crate::case::limits::between;
use crate::case::log::Problem;
use crate::case::tree::Value;

/// Shares of the energy supplied: 2 % is beyond what sound cases leave (1.5 %); see [`Guard`].
const WARNING: f64 = 0.02;
const FAULT: f64 = 0.1;

/// Reads `[guard]`.
pub(super) fn guard(root: &mut Keys<'_>) -> Option<Guard> {
    let mut keys = root.section("guard")?;
    let warning = keys.or("warning", Some(WARNING), level);
    let fault = keys.or("fault", Some(FAULT), level);
    if let (Some(Some(warning)), Some(Some(fault))) = (warning, fault)
        && fault < warning
    {
        let problem =
            Problem::new(format!("a fault at {fault} comes before the warning at {warning}"), "below `warning`");
        keys.header_error::<()>("fault", problem.help("lower `guard.warning`, or set it to false"));
    }
    keys.finish();
    Some(Guard { warning: warning?, fault: fault? })
}

/// A share, or `false`.
fn level(cursor: &Cursor<'_>) -> Option<Option<f64>> {
    match cursor.node.value {
        Value::Flag(false) => Some(None),
        Value::Integer(_) | Value::Number(_) => cursor.number(between(1e-9, 1e9, "")).map(Some),
        _ => cursor.wrong_type("a share of the energy supplied, or false"),
    }
}
