//! Parsing of seeds and seed ranges.

use novamind_base::formatting::grouped_number;

/// Maximum number of seeds in a range. Larger ranges are probably typing errors.
const MAX_SEEDS: u64 = 1_000_000;

/// A seed or an inclusive range of seeds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SeedRange {
    /// First seed of the range.
    pub first: u64,
    /// Last seed of the range, inclusive.
    pub last: u64,
}

/// Parses a seed or a range of seeds: `7` or `1..24`.
///
/// # Errors
/// Fails if the text is not a seed or a range, if a seed is above 2^63 - 1, or if the range is empty or longer than
/// `MAX_SEEDS`.
pub fn parse_seeds(text: &str) -> Result<SeedRange, String> {
    let number = |text: &str| text.trim().parse::<u64>().map_err(|_| format!("{text} is not a seed"));
    let seeds = match text.split_once("..") {
        Some((first, last)) => SeedRange { first: number(first)?, last: number(last)? },
        None => number(text).map(|seed| SeedRange { first: seed, last: seed })?,
    };
    if seeds.last > i64::MAX as u64 {
        return Err(format!("a seed must be at most {}, not {}", i64::MAX, seeds.last));
    }
    if seeds.first > seeds.last {
        return Err(format!("{}..{} is empty; put the smaller number first", seeds.first, seeds.last));
    }
    let count = seeds.last - seeds.first + 1;
    if count > MAX_SEEDS {
        let (holds, most) = (grouped_number(count as f64, 0), grouped_number(MAX_SEEDS as f64, 0));
        return Err(format!("{}..{} has {holds} seeds; the maximum is {most}", seeds.first, seeds.last));
    }
    Ok(seeds)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seed_range_includes_both_ends() {
        assert_eq!(parse_seeds("7"), Ok(SeedRange { first: 7, last: 7 }));
        assert_eq!(parse_seeds("1..24"), Ok(SeedRange { first: 1, last: 24 }));
        assert!(parse_seeds("1..1000000").is_ok());
        let many = parse_seeds("1..1000000000").expect_err("too many");
        assert_eq!(many, "1..1000000000 has 1,000,000,000 seeds; the maximum is 1,000,000");
        assert!(parse_seeds("9223372036854775807").is_ok());
        for above in ["9223372036854775808", "0..18446744073709551615"] {
            assert!(parse_seeds(above).expect_err(above).contains("a seed must be at most"));
        }
        assert!(parse_seeds("5..4").is_err() && parse_seeds("x").is_err() && parse_seeds("1..").is_err());
    }
}
