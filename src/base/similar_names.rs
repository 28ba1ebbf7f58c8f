//! Suggestions for a mistyped name.

/// Returns up to three known names that are similar to `name`, most similar first.
pub fn similar_names<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let name = name.to_lowercase();
    let length = name.chars().count();
    // Skip names of a very different length, because comparing long names is slow.
    let may_be_near =
        |candidate: &&str| length.abs_diff(candidate.chars().count()) <= candidate.len().max(name.len()) / 2;
    let mut scored: Vec<(usize, &str)> = known
        .filter(may_be_near)
        .map(|candidate| (strsim::damerau_levenshtein(&name, &candidate.to_lowercase()), candidate))
        .collect();
    scored.retain(|(distance, candidate)| *distance <= candidate.len().max(name.len()) / 2);
    scored.sort_by_key(|(distance, _)| *distance);
    scored.into_iter().take(3).map(|(_, candidate)| candidate).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn similar_names_rejects_very_long_input_quickly() {
        let known = ["set_prices", "set_promotion"];
        assert_eq!(
            similar_names(&"9".repeat(1_000_000), known.into_iter().cycle().take(10_000)),
            Vec::<&str>::new()
        );
        assert_eq!(similar_names("set_price", known.into_iter()), ["set_prices", "set_promotion"]);
    }
}
