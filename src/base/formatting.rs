//! Number formats and the argument parser that all screens, reports and messages share.
//!
//! All functions round half to even, on the exact binary value.

pub mod arguments;

use std::borrow::Cow;

use serde_json::{Number, Value, json};

/// Largest number that is written without an exponent. No tool accepts a larger amount.
const MAX_WITHOUT_EXPONENT: f64 = 1e15;

/// Number of decimals of a quality. Screens and reports show the same number of decimals, so that qualities can be
/// compared.
pub const QUALITY_DECIMALS: usize = 3;

/// Formats a number with thousands separators and a fixed number of decimals, for example `1,234,567.5`. Numbers above
/// 1e15 have an exponent: `1.5e15`. Zero has no sign.
pub fn grouped_number(value: f64, decimals: usize) -> String {
    if value.abs() > MAX_WITHOUT_EXPONENT && value.is_finite() {
        return exponent_notation(value);
    }
    let text = format!("{value:.decimals$}");
    let is_zero = text.chars().all(|letter| matches!(letter, '-' | '0' | '.'));
    insert_thousands_separators(if is_zero { text.trim_start_matches('-') } else { &text })
}

/// Rounds a value to a number of decimals, half to even on the exact binary value.
pub fn round_to(value: f64, decimals: u32) -> f64 {
    format!("{value:.*}", decimals as usize).parse().expect("a formatted number parses")
}

/// Adds thousands separators to formatted digits.
fn insert_thousands_separators(text: &str) -> String {
    let (sign, digits) = text.strip_prefix('-').map_or(("", text), |digits| ("-", digits));
    let (whole, fraction) =
        digits.split_once('.').map_or((digits, None), |(whole, rest)| (whole, Some(rest)));
    let mut grouped = String::with_capacity(text.len() + whole.len() / 3);
    for (at, digit) in whole.chars().enumerate() {
        if at > 0 && (whole.len() - at).is_multiple_of(3) {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    match fraction {
        Some(fraction) => format!("{sign}{grouped}.{fraction}"),
        None => format!("{sign}{grouped}"),
    }
}

/// Formats a number with at most four digits and an exponent: `1.234e15`.
fn exponent_notation(value: f64) -> String {
    let text = format!("{value:.3e}");
    match text.split_once('e') {
        Some((digits, power)) => {
            format!("{}e{power}", digits.trim_end_matches('0').trim_end_matches('.'))
        }
        None => text,
    }
}

/// Formats a count with its noun: `1 week`, `3 weeks`.
pub fn pluralize(number: u32, noun: &str) -> String {
    let plural = match noun.strip_suffix("ny") {
        _ if number == 1 => noun.to_owned(),
        Some(stem) => format!("{stem}nies"),
        None => format!("{noun}s"),
    };
    format!("{} {plural}", grouped_number(f64::from(number), 0))
}

/// Formats dollars without cents: `$1,234,568`, `-$1,234`.
pub fn dollars(value: f64) -> String {
    dollars_with_decimals(value, 0)
}

/// Formats dollars with cents: `$1,234.50`, `-$0.50`.
pub fn dollars_and_cents(value: f64) -> String {
    dollars_with_decimals(value, 2)
}

/// Formats a price with all its decimals: `$12`, `$22.50`, `$0.125`.
pub fn price(value: f64) -> String {
    let has_only_cents = (value * 100.0).round() / 100.0 == value;
    match value.fract() == 0.0 {
        true => dollars(value),
        false if has_only_cents => dollars_and_cents(value),
        false => format!("${value}"),
    }
}

/// Formats a price rounded to the cent: `$12`, `$22.50`.
pub fn price_to_cents(value: f64) -> String {
    if value.fract() == 0.0 { dollars(value) } else { dollars_and_cents(value) }
}

/// Formats dollars with a minus sign before the dollar sign if the amount is negative. Amounts that round to zero have
/// no sign.
fn dollars_with_decimals(value: f64, decimals: usize) -> String {
    let text = grouped_number(value.abs(), decimals);
    let rounds_to_zero = text.chars().all(|letter| matches!(letter, '0' | '.'));
    let sign = if value < 0.0 && !rounds_to_zero { "-" } else { "" };
    format!("{sign}${text}")
}

/// Formats dollars like the weekly dashboard of the released simulator: a minus sign after the dollar sign
/// (`$-1,234`), no exponents, and a sign for negative zero.
pub fn released_dollars(value: f64) -> String {
    format!("${}", insert_thousands_separators(&format!("{value:.0}")))
}

/// Formats a change in dollars with its sign: `+$45,210`, `-$45,210`.
pub fn signed_dollars(value: f64) -> String {
    let sign = if value < 0.0 { '-' } else { '+' };
    format!("{sign}${}", grouped_number(value.abs(), 0))
}

/// Formats a share as a percentage: `0.1234` with one decimal is `12.3%`.
pub fn percent(share: f64, decimals: usize) -> String {
    // Percentages have no thousands separators.
    format!("{}%", grouped_number(share * 100.0, decimals).replace(',', ""))
}

/// Formats a quality between 0 and 1, or a difference between qualities: `0.348`.
pub fn quality(value: f64) -> String {
    grouped_number(value, QUALITY_DECIMALS)
}

/// Formats a gain or loss of quality with its sign: `+0.012`.
pub fn quality_change(value: f64) -> String {
    let sign = if value < 0.0 { '-' } else { '+' };
    format!("{sign}{}", quality(value.abs()))
}

/// Formats a number with three significant digits and a suffix: `1.23M`, `45.6k`, `789`.
pub fn compact_number(value: f64) -> String {
    // Adding 0.0 removes the sign of a negative zero.
    let value = value + 0.0;
    let size = value.abs();
    if size > MAX_WITHOUT_EXPONENT && value.is_finite() {
        return exponent_notation(value);
    }
    let (scaled, suffix) = match size {
        _ if size >= 999_500_000.0 => (value / 1e9, "B"),
        _ if size >= 999_500.0 => (value / 1e6, "M"),
        _ if size >= 999.5 => (value / 1e3, "k"),
        _ => (value, ""),
    };
    let decimals = match scaled.abs() {
        _ if suffix.is_empty() && scaled.fract() == 0.0 => 0,
        tens if tens >= 99.95 => 0,
        tens if tens >= 9.995 => 1,
        _ => 2,
    };
    format!("{scaled:.decimals$}{suffix}")
}

/// Formats dollars in at most seven characters: `$1.23M`, `-$45.2k`, `$87`.
pub fn short_dollars(value: f64) -> String {
    let sign = if value < 0.0 { "-" } else { "" };
    format!("{sign}${}", compact_number(value.abs()))
}

/// Parses a number as users type it: `1,200`, `$3.5k`, `2M`, `1_000`.
pub fn parse_number(text: &str) -> Option<f64> {
    let cleaned: String =
        text.trim().chars().filter(|letter| !matches!(letter, ',' | '_' | '$' | ' ')).collect();
    let (digits, factor) = match cleaned.chars().last()? {
        'k' | 'K' => (&cleaned[..cleaned.len() - 1], 1e3),
        'm' | 'M' => (&cleaned[..cleaned.len() - 1], 1e6),
        _ => (cleaned.as_str(), 1.0),
    };
    if digits.is_empty()
        || !digits
            .chars()
            .all(|letter| letter.is_ascii_digit() || matches!(letter, '.' | '-' | '+' | 'e' | 'E'))
    {
        return None;
    }
    digits.parse::<f64>().ok().map(|number| number * factor).filter(|number| number.is_finite())
}

/// Converts a number to JSON. Whole numbers have no decimal point; other numbers are in their shortest exact form.
pub fn json_number(value: f64) -> Value {
    const MAX_EXACT_INTEGER: f64 = 9_007_199_254_740_992.0;
    if value.fract() == 0.0 && value.abs() < MAX_EXACT_INTEGER {
        Value::from(value as i64)
    } else {
        Number::from_f64(value).map_or(Value::Null, Value::Number)
    }
}

/// Formats a number with a decimal point or an exponent, as in the cells of JSON tables: `4.0`, `0.25`, `1e+16`.
pub fn decimal_literal(value: f64) -> String {
    let text = format!("{value:?}");
    match text.split_once('e') {
        None => text,
        Some((digits, exponent)) => {
            let (sign, exponent) = exponent.strip_prefix('-').map_or(('+', exponent), |rest| ('-', rest));
            format!("{digits}e{sign}{exponent:0>2}")
        }
    }
}

/// Formats JSON on one line with a space after every colon and comma. Numbers are formatted by [`decimal_literal`].
pub fn spaced_json(value: &Value) -> String {
    let list = |parts: Vec<String>| parts.join(", ");
    match value {
        Value::Array(values) => format!("[{}]", list(values.iter().map(spaced_json).collect())),
        Value::Object(map) => {
            let entry = |(key, value): (&String, &Value)| format!("{}: {}", json!(key), spaced_json(value));
            format!("{{{}}}", list(map.iter().map(entry).collect()))
        }
        Value::Number(number) if number.is_f64() => number.as_f64().map_or_else(String::new, decimal_literal),
        other => other.to_string(),
    }
}

/// Rewrites all numbers of a JSON value in the form of [`json_number`].
pub fn normalize_json_numbers(value: Value) -> Value {
    match value {
        Value::Number(number) if number.is_f64() => number.as_f64().map_or(Value::Null, json_number),
        Value::Array(values) => values.into_iter().map(normalize_json_numbers).collect(),
        Value::Object(map) => {
            map.into_iter().map(|(key, value)| (key, normalize_json_numbers(value))).collect()
        }
        other => other,
    }
}

/// Returns whether printing a character could move the cursor, change colors or reverse the text direction. Returns
/// `false` for line breaks and tabs.
pub fn is_control_or_bidi(letter: char) -> bool {
    (letter.is_control() && !['\n', '\t'].contains(&letter))
        || matches!(letter, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}' | '\u{2029}' | '\u{feff}')
        || ('\u{202a}'..='\u{202e}').contains(&letter)
        || ('\u{2066}'..='\u{2069}').contains(&letter)
}

/// Escapes text for HTML content and attributes, and removes characters that XML forbids.
pub fn escape_html(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            '\n' | '\t' => safe.push(' '),
            letter if is_control_or_bidi(letter) => {}
            letter => safe.push(letter),
        }
    }
    safe
}

/// Makes text safe for a terminal: escapes control characters and bidirectional formatting characters. Line breaks and
/// tabs are kept.
pub fn escape_control_characters(text: &str) -> Cow<'_, str> {
    if !text.contains(is_control_or_bidi) {
        return Cow::Borrowed(text);
    }
    let written = |letter: char| {
        if is_control_or_bidi(letter) { letter.escape_unicode().to_string() } else { letter.to_string() }
    };
    Cow::Owned(text.chars().map(written).collect())
}

/// Capitalizes the first letter of a text.
pub fn capitalize(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Makes text safe for a CSV cell: escapes unprintable characters, and adds `'` before text that a spreadsheet would
/// treat as a formula. Numbers are unchanged.
pub fn escape_csv_cell(text: &str) -> Cow<'_, str> {
    let text = escape_control_characters(text);
    // Spreadsheets ignore whitespace before a formula.
    let first = text.chars().find(|letter| !letter.is_whitespace());
    let is_number = text.bytes().all(|byte| byte.is_ascii_digit() || b"+-.eE".contains(&byte))
        && text.parse::<f64>().is_ok();
    let starts_formula = |letter: char| {
        matches!(letter, '=' | '+' | '-' | '@' | '\u{ff1d}' | '\u{ff0b}' | '\u{ff0d}' | '\u{ff20}')
    };
    if is_number || !first.is_some_and(starts_formula) && !text.starts_with(['\t', '\n']) {
        return text;
    }
    Cow::Owned(format!("'{text}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_is_half_to_even_on_the_binary_value() {
        assert_eq!(round_to(0.25, 1), 0.2);
        assert_eq!(round_to(0.35, 1), 0.3);
        assert_eq!(round_to(-0.049, 1), -0.0);
    }

    #[test]
    fn formatted_zero_has_no_sign_and_huge_numbers_use_exponents() {
        assert_eq!(
            [grouped_number(-0.0, 0), grouped_number(-0.004, 2), grouped_number(-0.3, 0)],
            ["0", "0.00", "0"]
        );
        assert_eq!([percent(-0.0001, 1), percent(-0.12, 0), percent(12.0, 0)], ["0.0%", "-12%", "1200%"]);
        assert_eq!(
            [grouped_number(1e308, 0), grouped_number(-1.5e15, 2), grouped_number(999e12, 0)],
            ["1e308", "-1.5e15", "999,000,000,000,000"]
        );
        assert_eq!(
            [compact_number(1e308), short_dollars(1e20), dollars(1e308)],
            ["1e308", "$1e20", "$1e308"]
        );
    }

    #[test]
    fn compact_zero_has_no_sign() {
        assert_eq!(
            (compact_number(-0.0), compact_number(0.0), compact_number(-12.0)),
            ("0".to_owned(), "0".to_owned(), "-12".to_owned())
        );
    }

    #[test]
    fn control_characters_are_escaped() {
        assert_eq!(escape_control_characters("a\u{1b}[2J\u{202e}b\r"), "a\\u{1b}[2J\\u{202e}b\\u{d}");
        assert_eq!(escape_control_characters("größer\t€\n😀"), "größer\t€\n😀");
    }

    #[test]
    fn csv_cells_escape_formulas_and_keep_numbers() {
        for (text, cell) in [
            ("=1+1", "'=1+1"),
            ("+cmd|' /C calc'!A0", "'+cmd|' /C calc'!A0"),
            ("-2+3", "'-2+3"),
            ("@SUM(A1)", "'@SUM(A1)"),
            ("  =1", "'  =1"),
            ("\t=1", "'\t=1"),
            ("\n=1", "'\n=1"),
            ("\u{ff1d}1", "'\u{ff1d}1"),
            ("\u{1b}]0;x\u{7}=1", "\\u{1b}]0;x\\u{7}=1"),
            ("\u{202e}=1", "\\u{202e}=1"),
            ("-5", "-5"),
            ("-1.5e-7", "-1.5e-7"),
            ("+4", "+4"),
            ("-inf", "'-inf"),
            ("a = b", "a = b"),
            ("", ""),
        ] {
            assert_eq!(escape_csv_cell(text), cell);
        }
    }

    #[test]
    fn numbers_round_half_to_even_with_sign() {
        for (value, text) in [(9.5, "10"), (8.5, "8"), (10.5, "10"), (0.5, "0"), (1.5, "2"), (250.5, "250")] {
            assert_eq!(grouped_number(value, 0), text);
        }
        for (value, text) in [
            (1_234_567.5, "$1,234,568"),
            (1_234_568.5, "$1,234,568"),
            (-1234.5, "$-1,234"),
            (-0.4, "$-0"),
            (-2095.0, "$-2,095"),
        ] {
            assert_eq!(released_dollars(value), text);
        }
        assert_eq!(
            [dollars(-2095.0), dollars(-0.4), dollars_and_cents(-0.5), dollars_and_cents(-0.001)],
            ["-$2,095", "$0", "-$0.50", "$0.00"]
        );
        assert_eq!([12.0, 22.5, 0.4, 0.125].map(price), ["$12", "$22.50", "$0.40", "$0.125"]);
        assert_eq!([quality(0.3), quality(0.14706)], ["0.300", "0.147"]);
        assert_eq!([quality_change(0.0031), quality_change(-0.012)], ["+0.003", "-0.012"]);
        assert_eq!(percent(0.12345, 1), "12.3%");
        assert_eq!(percent(0.012345, 2), "1.23%");
        assert_eq!(percent(0.00474, 2), "0.47%");
    }

    #[test]
    fn compact_numbers_have_three_digits() {
        for (value, text) in [
            (0.0, "0"),
            (789.0, "789"),
            (999.6, "1.00k"),
            (45_640.0, "45.6k"),
            (999_600.0, "1.00M"),
            (1_234_567.0, "1.23M"),
            (-12_345_678.0, "-12.3M"),
            (2.5e9, "2.50B"),
            (1.5, "1.50"),
        ] {
            assert_eq!(compact_number(value), text);
        }
    }

    #[test]
    fn json_whole_numbers_have_no_decimal_point() {
        let value = serde_json::json!({"a": 12.0, "b": [0.5, 3.0], "c": "4.0"});
        assert_eq!(normalize_json_numbers(value).to_string(), r#"{"a":12,"b":[0.5,3],"c":"4.0"}"#);
    }

    #[test]
    fn spaced_json_keeps_decimal_points() {
        let value = serde_json::json!({"global": 0.0, "by_group": {"S2": 4.0, "E\"1": 0.25}, "list": [1, 2.5, "a"], "no": {}});
        let text =
            r#"{"global": 0.0, "by_group": {"S2": 4.0, "E\"1": 0.25}, "list": [1, 2.5, "a"], "no": {}}"#;
        assert_eq!(spaced_json(&value), text);
        for (number, text) in [
            (1e15, "1000000000000000.0"),
            (1e16, "1e+16"),
            (1e-5, "1e-05"),
            (1e-4, "0.0001"),
            (1.5e300, "1.5e+300"),
        ] {
            assert_eq!(decimal_literal(number), text);
        }
    }

    #[test]
    fn signed_dollars_shows_plus_and_minus() {
        assert_eq!(signed_dollars(45_210.4), "+$45,210");
        assert_eq!(signed_dollars(-3.0), "-$3");
    }
}
