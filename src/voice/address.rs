//! Email addresses of enterprises, computed from the customer number
//! (docs/mechanics/market/social/texts.md#addresses).

use md5::{Digest, Md5};

use novamind_world::params::EmailParts;

/// Returns an index for each word list (first name, last name, company, suffix) and for the form of the local part.
fn word_indexes(customer: u32) -> [u32; 5] {
    let digest = Md5::digest(format!("email_{customer}"));
    let h = u32::from_be_bytes([digest[0], digest[1], digest[2], digest[3]]);
    [h % 48, h / 48 % 48, h / 2_304 % 20, h / 46_080 % 6, h / 1_000 % 4]
}

/// Returns the company word in the address of an enterprise.
pub(super) fn company_word(customer: u32, parts: &EmailParts) -> &str {
    let [_, _, company, ..] = word_indexes(customer);
    let words = &parts.company_domains;
    words.get(company as usize % words.len().max(1)).map_or("", String::as_str)
}

/// Returns the email address of an enterprise.
pub fn enterprise_address(customer: u32, parts: &EmailParts) -> String {
    let [first, last, company, suffix, form] = word_indexes(customer);
    let word = |list: &[String], at: u32| list[at as usize % list.len()].to_lowercase();
    let (first, last) = (word(&parts.first_names, first), word(&parts.last_names, last));
    let initial = |name: &str| name.chars().next().map(String::from).unwrap_or_default();
    let local = match form {
        0 => format!("{first}.{last}"),
        1 => format!("{}{last}", initial(&first)),
        2 => format!("{first}{}", initial(&last)),
        _ => format!("{first}_{last}"),
    };
    format!("{local}@{}.{}", word(&parts.company_domains, company), word(&parts.domain_suffixes, suffix))
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_world::params::Params;

    #[test]
    fn word_indexes_follow_the_customer_number_digest() {
        for (customer, expected) in [
            (1, [28, 43, 10, 0, 3]),
            (2, [28, 41, 0, 5, 0]),
            (3, [7, 25, 17, 4, 1]),
            (88, [31, 19, 11, 2, 0]),
            (312, [27, 37, 2, 1, 1]),
            (1000, [15, 9, 1, 4, 2]),
        ] {
            assert_eq!(word_indexes(customer), expected, "customer {customer}");
        }
    }

    #[test]
    fn addresses_are_lowercase_in_four_forms() {
        let parts = Params::bundled().personas.email;
        let local = format!("{}.{}", parts.first_names[28], parts.last_names[41]).to_lowercase();
        assert_eq!(enterprise_address(2, &parts), format!("{local}@{}.biz", parts.company_domains[0]));
        assert!(
            (1..500)
                .map(|customer| enterprise_address(customer, &parts))
                .all(|a| a == a.to_lowercase() && a.contains('@'))
        );
    }
}
