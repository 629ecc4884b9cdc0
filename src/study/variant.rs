//! Variants of a case: the case as it is, and with some keys changed.

/// A case with changes.
#[derive(Clone, Debug, PartialEq)]
pub struct Variant {
    pub label: String,
    /// `KEY=VALUE`, as for `--set`.
    pub overrides: Vec<String>,
}

impl Variant {
    /// The case as it is.
    pub fn base() -> Self {
        Variant { label: "as it is".to_owned(), overrides: Vec::new() }
    }

    /// One key changed.
    pub fn of(key: &str, value: &str) -> Self {
        let short = key.rsplit('.').next().unwrap_or(key);
        Variant { label: format!("{short} = {value}"), overrides: vec![format!("{key}={value}")] }
    }
}

/// `KEY=V1,V2,...` into one variant a value. A comma inside brackets or quotes does not separate.
pub fn parse(text: &str) -> Result<Vec<Variant>, String> {
    let (key, values) = text
        .split_once('=')
        .ok_or_else(|| format!("'{text}': write KEY=VALUE,VALUE,..., e.g. boundary.base.coefficient=0.2,0.5"))?;
    let values = split(values);
    if key.trim().is_empty() || values.iter().any(|v| v.is_empty()) {
        return Err(format!("'{text}': a key and at least one value are needed"));
    }
    Ok(values.iter().map(|v| Variant::of(key.trim(), v)).collect())
}

fn split(text: &str) -> Vec<String> {
    let (mut parts, mut depth, mut quoted) = (vec![String::new()], 0i32, false);
    for c in text.chars() {
        match c {
            '"' => quoted = !quoted,
            '[' | '{' => depth += 1,
            ']' | '}' => depth -= 1,
            ',' if depth == 0 && !quoted => {
                parts.push(String::new());
                continue;
            }
            _ => {}
        }
        if let Some(last) = parts.last_mut() {
            last.push(c);
        }
    }
    parts.iter().map(|p| p.trim().to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_split_outside_brackets_and_quotes() {
        let v = parse("grid.size=[60,7],[80,7]").unwrap();
        assert_eq!(v.len(), 2);
        assert_eq!(v[1].overrides, vec!["grid.size=[80,7]"]);
        assert_eq!(parse("boundary.base.coefficient=0.2,0.5").unwrap()[0].label, "coefficient = 0.2");
        assert!(parse("nothing").is_err() && parse("key=").is_err() && parse("=3").is_err());
    }
}
