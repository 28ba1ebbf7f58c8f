//! Validation that all language model responses share: a JSON array, and printable texts.

use serde_json::Value;
use unicode_width::UnicodeWidthChar;

use novamind_base::notation::printable;

/// Maximum zero-width characters, such as accents of decomposed text.
const MOST_MARKS: usize = 20;

/// Parses a response that is a JSON array. A code fence around it is allowed, because models often add one.
pub(super) fn array(answer: &str) -> Result<Vec<Value>, String> {
    match serde_json::from_str(without_fence(answer.trim())) {
        Ok(Value::Array(values)) => Ok(values),
        Ok(_) | Err(_) => Err("it is not a JSON array".to_owned()),
    }
}

fn without_fence(answer: &str) -> &str {
    let inner = answer.strip_prefix("```").and_then(|rest| rest.strip_suffix("```"));
    let inner = inner.and_then(|rest| rest.split_once('\n'));
    inner.map_or(answer, |(_, rest)| rest.trim())
}

/// Checks that a text can be shown in one line: not empty, no control characters, at most `most_letters` characters.
pub(super) fn check_text(text: &str, most_letters: usize) -> Result<(), String> {
    if text.trim().is_empty() {
        return Err("a text is empty".to_owned());
    }
    if text.chars().any(char::is_control) || printable(text) != text {
        return Err("a text contains control characters or line breaks".to_owned());
    }
    // Stacked combining marks overlap adjacent lines.
    if text.chars().filter(|letter| letter.width() == Some(0)).count() > MOST_MARKS {
        return Err(format!("a text has more than {MOST_MARKS} zero-width characters"));
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
    fn marks_that_pile_up_are_refused_and_accents_are_not() {
        assert!(check_text("Cafe\u{301}, 12 euros", 100).is_ok());
        let piled = format!("Up{} 12", "\u{301}".repeat(MOST_MARKS + 1));
        assert!(check_text(&piled, 100).expect_err("piled").contains("zero-width"));
    }

    #[test]
    fn an_array_may_stand_in_a_block_of_code_and_nowhere_else() {
        for answer in ["[1, 2]", " [1,2]\n", "```json\n[1, 2]\n```", "```\n[1, 2]```"] {
            assert_eq!(array(answer).expect(answer).len(), 2);
        }
        for answer in ["", "{}", "Here it is: [1]", "[1", "```json [1] ```", "``````"] {
            assert!(array(answer).is_err(), "{answer}");
        }
    }

    #[test]
    fn texts_that_cannot_be_shown_are_refused() {
        assert_eq!(check_text("Größer, für 5 $.", 20), Ok(()));
        for text in ["", "  ", "a\nb", "a\tb", "\u{1b}[31m", "a\u{202e}b", "123456789012345678901"] {
            assert!(check_text(text, 20).is_err(), "{text:?}");
        }
    }
}
