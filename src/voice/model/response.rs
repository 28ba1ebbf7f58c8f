//! Validation that every response of a language model must pass: a JSON array of printable texts.

use serde_json::Value;
use unicode_width::UnicodeWidthChar;

use novamind_base::formatting::escape_control_characters;

/// Maximum number of zero-width characters in a text, such as accents of decomposed letters.
const MAX_COMBINING_MARKS: usize = 20;

/// Parses a response that is a JSON array. A code fence around the array is allowed, because models often add a fence.
pub(super) fn parse_array(answer: &str) -> Result<Vec<Value>, String> {
    match serde_json::from_str(strip_code_fence(answer.trim())) {
        Ok(Value::Array(values)) => Ok(values),
        Ok(_) | Err(_) => Err("it is not a JSON array".to_owned()),
    }
}

fn strip_code_fence(answer: &str) -> &str {
    let inner = answer.strip_prefix("```").and_then(|rest| rest.strip_suffix("```"));
    let inner = inner.and_then(|rest| rest.split_once('\n'));
    inner.map_or(answer, |(_, rest)| rest.trim())
}

/// Checks that a text can be shown on one line: it is not empty, has no control characters, and has at most
/// `most_letters` characters.
pub(super) fn check_text(text: &str, most_letters: usize) -> Result<(), String> {
    if text.trim().is_empty() {
        return Err("a text is empty".to_owned());
    }
    if text.chars().any(char::is_control) || escape_control_characters(text) != text {
        return Err("a text contains control characters or line breaks".to_owned());
    }
    // Stacked combining marks overlap adjacent lines.
    if text.chars().filter(|letter| letter.width() == Some(0)).count() > MAX_COMBINING_MARKS {
        return Err(format!("a text has more than {MAX_COMBINING_MARKS} zero-width characters"));
    }
    match text.chars().count() {
        letters if letters > most_letters => {
            Err(format!("a text has {letters} characters; the maximum is {most_letters}"))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stacked_combining_marks_are_rejected() {
        assert!(check_text("Cafe\u{301}, 12 euros", 100).is_ok());
        let piled = format!("Up{} 12", "\u{301}".repeat(MAX_COMBINING_MARKS + 1));
        assert!(check_text(&piled, 100).expect_err("piled").contains("zero-width"));
    }

    #[test]
    fn parse_array_accepts_only_a_code_fence_around_it() {
        for answer in ["[1, 2]", " [1,2]\n", "```json\n[1, 2]\n```", "```\n[1, 2]```"] {
            assert_eq!(parse_array(answer).expect(answer).len(), 2);
        }
        for answer in ["", "{}", "Here it is: [1]", "[1", "```json [1] ```", "``````"] {
            assert!(parse_array(answer).is_err(), "{answer}");
        }
    }

    #[test]
    fn check_text_rejects_unprintable_texts() {
        assert_eq!(check_text("Größer, für 5 $.", 20), Ok(()));
        for text in ["", "  ", "a\nb", "a\tb", "\u{1b}[31m", "a\u{202e}b", "123456789012345678901"] {
            assert!(check_text(text, 20).is_err(), "{text:?}");
        }
    }
}
