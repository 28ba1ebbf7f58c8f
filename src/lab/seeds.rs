//! Seeds as people name them.

use crate::notation::grouped;

/// Most seeds that a range holds: more of them is a mistake of typing.
const MOST_SEEDS: u64 = 1_000_000;

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
/// It is neither, or the range holds no seed, or more than `MOST_SEEDS`.
pub fn parse_seeds(text: &str) -> Result<Seeds, String> {
    let number = |text: &str| text.trim().parse::<u64>().map_err(|_| format!("{text} is not a seed"));
    let seeds = match text.split_once("..") {
        Some((first, last)) => Seeds { first: number(first)?, last: number(last)? },
        None => number(text).map(|seed| Seeds { first: seed, last: seed })?,
    };
    if seeds.first > seeds.last {
        return Err(format!("{}..{} holds no seed; put the smaller number first", seeds.first, seeds.last));
    }
    // The whole range of numbers holds one more than a number can say.
    match (seeds.last - seeds.first).checked_add(1) {
        Some(count) if count <= MOST_SEEDS => Ok(seeds),
        count => {
            let holds = count.map_or("too many".to_owned(), |count| grouped(count as f64, 0));
            let most = grouped(MOST_SEEDS as f64, 0);
            Err(format!("{}..{} holds {holds} seeds; at most {most} are played", seeds.first, seeds.last))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_are_one_or_a_range_with_both_ends() {
        assert_eq!(parse_seeds("7"), Ok(Seeds { first: 7, last: 7 }));
        assert_eq!(parse_seeds("1..24"), Ok(Seeds { first: 1, last: 24 }));
        assert!(parse_seeds("1..1000000").is_ok());
        let many = parse_seeds("1..1000000000").expect_err("too many");
        assert_eq!(many, "1..1000000000 holds 1,000,000,000 seeds; at most 1,000,000 are played");
        assert!(parse_seeds("0..18446744073709551615").is_err());
        assert!(parse_seeds("5..4").is_err() && parse_seeds("x").is_err() && parse_seeds("1..").is_err());
    }
}
