//! Normalizes numbers in text: zeros have no sign, and large numbers are written in powers of ten.

use novamind_base::formatting::grouped_number;

/// Minimum number of digits before the decimal point of a number that is written in powers of ten.
const MIN_SCIENTIFIC_DIGITS: usize = 16;

/// Normalizes the numbers in lines of text.
pub fn clean_up_numbers(lines: Vec<String>) -> Vec<String> {
    lines.into_iter().map(|line| clean_up_line(&line)).collect()
}

/// Normalizes the numbers in a line: removes the minus sign of zeros, and writes numbers above 1e15 in powers of ten.
pub fn clean_up_line(text: &str) -> String {
    let mut cleaned = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find(|letter: char| letter.is_ascii_digit()) {
        let (before, number) = rest.split_at(at);
        let end = number
            .find(|letter: char| !(letter.is_ascii_digit() || letter == '.' || letter == ','))
            .unwrap_or(number.len());
        let (number, behind) = number.split_at(end);
        let number_alone = number.trim_end_matches(['.', ',']);
        cleaned.push_str(before);
        let mut letters = cleaned.chars().rev();
        let (last, before_last) = (letters.next(), letters.next());
        let is_word = last.is_some_and(char::is_alphanumeric);
        let has_sign = last == Some('-') && before_last.is_none_or(|letter| !letter.is_alphanumeric());
        let is_zero = number_alone.chars().all(|letter| matches!(letter, '0' | '.'));
        let has_exponent = behind.starts_with(['e', 'E']);
        if is_zero && has_sign && !has_exponent {
            cleaned.pop();
        }
        match to_scientific(number_alone).filter(|_| !is_word && !has_exponent) {
            Some(short) => {
                cleaned.push_str(&short);
                cleaned.push_str(&number[number_alone.len()..]);
            }
            None => cleaned.push_str(number),
        }
        rest = behind;
    }
    cleaned + rest
}

/// Returns the number in powers of ten, or `None` if it is too short for this notation.
fn to_scientific(number: &str) -> Option<String> {
    let plain = number.replace(',', "");
    let digits = plain.split('.').next().map_or(0, str::len);
    let value: f64 = plain.parse().ok().filter(|_| digits >= MIN_SCIENTIFIC_DIGITS)?;
    Some(grouped_number(value, 0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clean_up_line_removes_signs_of_zeros_and_shortens_numbers() {
        for (text, expected) in [
            ("from S3 -0.0000, then", "from S3 0.0000, then"),
            ("-0 of S1→S2-0 -0.10 (-0.00)", "0 of S1→S2-0 -0.10 (0.00)"),
            ("day 0-0, +0.0000 of 20", "day 0-0, +0.0000 of 20"),
            ("budget 100,000,000,000,000,000.00 dollars", "budget 1e17 dollars"),
            ("below 999999999999999, not below", "below 999999999999999, not below"),
            ("-0e5 of -1,234.5", "-0e5 of -1,234.5"),
        ] {
            assert_eq!(clean_up_line(text), expected);
        }
        let long = clean_up_line(&format!("budget {:.2}, quality", 1e308));
        assert_eq!(long, "budget 1e308, quality");
    }
}
