//! Seeds as people name them.

/// A seed or a range of seeds, both ends included.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Seeds {
    /// First seed.
    pub first: u64,
    /// Last seed.
    pub last: u64,
}

/// Reads `7` or `1..24`.
///
/// # Errors
/// It is neither, or the range holds no seed.
pub fn parse_seeds(text: &str) -> Result<Seeds, String> {
    let number = |text: &str| text.trim().parse::<u64>().map_err(|_| format!("{text} is not a seed"));
    let seeds = match text.split_once("..") {
        Some((first, last)) => Seeds { first: number(first)?, last: number(last)? },
        None => number(text).map(|seed| Seeds { first: seed, last: seed })?,
    };
    if seeds.first > seeds.last {
        return Err(format!("{}..{} holds no seed; put the smaller number first", seeds.first, seeds.last));
    }
    Ok(seeds)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_are_one_or_a_range_with_both_ends() {
        assert_eq!(parse_seeds("7"), Ok(Seeds { first: 7, last: 7 }));
        assert_eq!(parse_seeds("1..24"), Ok(Seeds { first: 1, last: 24 }));
        assert!(parse_seeds("5..4").is_err() && parse_seeds("x").is_err() && parse_seeds("1..").is_err());
    }
}
