//! Words close to a mistyped one.

/// Words of a list in running text: "a, b or c".
pub(super) fn list<'a>(words: impl IntoIterator<Item = &'a str>) -> String {
    let words: Vec<_> = words.into_iter().collect();
    match words.split_last() {
        Some((last, [])) => (*last).to_owned(),
        Some((last, rest)) => format!("{} or {last}", rest.join(", ")),
        None => "none".to_owned(),
    }
}

/// "did you mean `word`?" for the closest of the known words, if one is close.
pub(super) fn did_you_mean<'a>(typed: &str, known: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let typed = typed.get(..64).unwrap_or(typed).to_lowercase();
    let scored = known.into_iter().map(|word| (closeness(&typed, word), word));
    let best = scored.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|&(score, _)| score > 0.6);
    best.map(|(_, word)| format!("did you mean `{word}`?"))
}

/// 1 for the same word, 0 for nothing in common; the start of a longer word counts as close.
fn closeness(typed: &str, word: &str) -> f64 {
    let starts = typed.len() >= 3 && (word.starts_with(typed) || typed.starts_with(word));
    let edits = strsim::normalized_damerau_levenshtein(typed, word);
    if starts { edits.max(0.7) } else { edits }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn close_words_are_suggested_and_far_ones_are_not() {
        let known = ["cohesion", "unit_weight"];
        assert_eq!(did_you_mean("cohesin", known).as_deref(), Some("did you mean `cohesion`?"));
        assert_eq!(did_you_mean("temperature", known), None);
    }

    #[test]
    fn lists_read_as_text() {
        assert_eq!(list(["a", "b", "c"]), "a, b or c");
        assert_eq!(list(["a"]), "a");
    }
}
