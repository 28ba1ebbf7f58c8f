//! Which name was meant: the known ones that look most like one that does not exist.

/// Up to three of the known names that look most like a name that does not exist, best first.
pub fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let name = name.to_lowercase();
    let mut scored: Vec<(usize, &str)> = known
        .map(|candidate| (strsim::damerau_levenshtein(&name, &candidate.to_lowercase()), candidate))
        .collect();
    scored.retain(|(distance, candidate)| *distance <= candidate.len().max(name.len()) / 2);
    scored.sort_by_key(|(distance, _)| *distance);
    scored.into_iter().take(3).map(|(_, candidate)| candidate).collect()
}
