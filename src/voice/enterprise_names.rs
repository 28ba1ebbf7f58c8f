//! Names of enterprises, computed for display from the run's seed and the customer number
//! (docs/mechanics/market/social/texts.md#names-of-enterprises). Names are never stored, and a name reveals nothing
//! about its enterprise.

use std::fmt;
use std::sync::{Arc, OnceLock};

use serde::Deserialize;

use super::address::company_word;
use novamind_world::params::EmailParts;

/// Words of enterprise names, from `assets/voice/companies.toml`.
#[derive(Debug, Deserialize)]
struct NameWords {
    heads: Vec<String>,
    tails: Vec<String>,
}

impl NameWords {
    fn bundled() -> &'static NameWords {
        static WORDS: OnceLock<NameWords> = OnceLock::new();
        let text = include_str!("../../assets/voice/companies.toml");
        WORDS.get_or_init(|| toml::from_str(text).expect("the bundled words are valid"))
    }
}

/// Legal forms that can follow the company word in an address.
const LEGAL_FORMS: [&str; 4] = ["group", "works", "hq", "co"];

/// A generator for the names of a run's enterprises.
#[derive(Clone)]
pub struct EnterpriseNames {
    seed: u64,
    email: Arc<EmailParts>,
}

impl fmt::Debug for EnterpriseNames {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "EnterpriseNames({})", self.seed)
    }
}

impl EnterpriseNames {
    /// Creates the generator of a run from the run's seed and address words.
    pub fn new(seed: u64, email: &EmailParts) -> EnterpriseNames {
        EnterpriseNames { seed, email: Arc::new(email.clone()) }
    }

    /// Returns the name of an enterprise, which consists of the company word of its address and sometimes another word.
    pub fn name(&self, customer: u32) -> String {
        let first = name_from_address_word(company_word(customer, &self.email));
        let mut draw =
            HashSequence(mix_bits(self.seed ^ u64::from(customer).wrapping_mul(0x9E37_79B9_7F4A_7C15)));
        let words = NameWords::bundled();
        let second = format!("{}{}", draw.pick(&words.heads), draw.pick(&words.tails));
        match draw.next_below(3) {
            0 => format!("{first} {second}"),
            1 => format!("{first} & {second}"),
            _ => format!("{second} & {first}"),
        }
    }

    /// Returns the name of an enterprise, followed by the customer number that tool calls and SQL use, for example
    /// `Northgate Ashwick #16064`.
    pub fn name_with_number(&self, customer: u32) -> String {
        format!("{} #{customer}", self.name(customer))
    }

    /// Replaces `customer 16064` in a recorded text with the name and the number of the enterprise.
    pub fn insert_names(&self, text: &str) -> String {
        const CUSTOMER_WORD: &str = "ustomer ";
        let mut output = String::with_capacity(text.len() + 16);
        let mut rest = text;
        while let Some(at) = rest.find(CUSTOMER_WORD) {
            let after = &rest[at + CUSTOMER_WORD.len()..];
            let digits = after.len() - after.trim_start_matches(|sign: char| sign.is_ascii_digit()).len();
            let begins = rest[..at].ends_with(['C', 'c']);
            match after[..digits].parse() {
                Ok(customer) if begins => {
                    output += &rest[..at - 1];
                    output += &self.name_with_number(customer);
                    rest = &after[digits..];
                }
                _ => {
                    output += &rest[..at + CUSTOMER_WORD.len()];
                    rest = after;
                }
            }
        }
        output + rest
    }
}

/// Returns the company word of an address in title case, without a legal form.
fn name_from_address_word(word: &str) -> String {
    let short = LEGAL_FORMS.iter().find_map(|form| word.strip_suffix(form).filter(|rest| rest.len() > 3));
    let mut letters = short.unwrap_or(word).chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().collect::<String>() + letters.as_str())
}

struct HashSequence(u64);

impl HashSequence {
    fn next_below(&mut self, count: usize) -> usize {
        self.0 = mix_bits(self.0.wrapping_add(0x9E37_79B9_7F4A_7C15));
        (self.0 % count.max(1) as u64) as usize
    }

    fn pick<'a>(&mut self, words: &'a [String]) -> &'a str {
        let at = self.next_below(words.len());
        words.get(at).map_or("", String::as_str)
    }
}

/// Mixes the bits of a number so that each output bit depends on every input bit.
fn mix_bits(number: u64) -> u64 {
    let number = (number ^ (number >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let number = (number ^ (number >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    number ^ (number >> 31)
}

#[cfg(test)]
mod tests {
    use std::collections::{BTreeMap, BTreeSet};

    use super::*;
    use crate::enterprise_address;
    use novamind_world::params::Params;

    fn names(seed: u64) -> EnterpriseNames {
        EnterpriseNames::new(seed, &Params::bundled().personas.email)
    }

    #[test]
    fn enterprise_name_is_stable() {
        assert_eq!(names(42).name(16_064), names(42).name(16_064));
        let names_in_run = |seed: u64| {
            let names = names(seed);
            (1..200).map(|customer| names.name(customer)).collect::<Vec<_>>()
        };
        let same =
            names_in_run(42).iter().zip(names_in_run(7)).filter(|(one, other)| **one == *other).count();
        assert!(same < 5, "{same} of 199 have the same name in two runs");
        assert_eq!(names(42).name_with_number(16_064), format!("{} #16064", names(42).name(16_064)));
        // Users recognize enterprises by their names, and a change to the word lists would rename all enterprises.
        assert_eq!(names(42).name(1), "Westhaven Wolgrove");
    }

    #[test]
    fn name_contains_the_word_of_the_address() {
        let email = Params::bundled().personas.email;
        let names = names(42);
        for customer in 1..2_000 {
            let domain = enterprise_address(customer, &email);
            let domain = domain.split(['@', '.']).nth_back(1).expect("a domain").to_owned();
            let name = names.name(customer).to_lowercase();
            assert!(
                name.split(' ').any(|word| word.len() > 3 && domain.starts_with(word)),
                "{name}: {domain}"
            );
        }
    }

    #[test]
    fn enterprise_names_are_short_and_rarely_equal() {
        let mut count: BTreeMap<String, u32> = BTreeMap::new();
        let names = names(42);
        for customer in (10_000..45_000).step_by(10) {
            *count.entry(names.name(customer)).or_default() += 1;
        }
        let shared: u32 = count.values().filter(|count| **count > 1).sum();
        assert!(shared < 70, "{shared} of 3,500 share their name with another");
        assert!(count.keys().all(|name| name.chars().count() <= 26 && !name.contains("  ")));
        let second: BTreeSet<&str> = count.keys().flat_map(|name| name.split(' ')).collect();
        assert!(second.len() > 1_500);
        let taken = ["Harbor Freight Desk", "Castell & Byrne", "Meridian Group", "Aurelia Holdings"];
        assert!(taken.iter().all(|name| !count.contains_key(*name)));
    }

    #[test]
    fn insert_names_replaces_customer_numbers() {
        let names = names(42);
        let (one, other) = (names.name_with_number(4_711), names.name_with_number(12));
        for (text, expected) in [
            ("Customer 4711 (E2, 1,094 seats) accepts.", format!("{one} (E2, 1,094 seats) accepts.")),
            ("Deal closed with customer 12: plan A", format!("Deal closed with {other}: plan A")),
            ("customer 12, Customer 4711", format!("{other}, {one}")),
            ("A customer asks; customers 12", "A customer asks; customers 12".to_owned()),
            ("customer ", "customer ".to_owned()),
            ("ustomer 12 customer 99999999999", "ustomer 12 customer 99999999999".to_owned()),
        ] {
            assert_eq!(names.insert_names(text), expected);
        }
    }
}
