//! Corrects articles, spaces and capitals in expanded text.

/// Inserts the correct articles, removes extra spaces, and capitalizes sentences.
pub fn polish(text: &str) -> String {
    fix_capitals(&fix_spaces(&fix_articles(text)))
}

/// Replaces `a/an` and `A/an` with the correct article for the next word.
fn fix_articles(text: &str) -> String {
    let mut polished = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find("a/an ").or_else(|| rest.find("A/an ")) {
        let (before, found) = rest.split_at(at);
        let (article, after) = found.split_at("a/an".len());
        polished.push_str(before);
        polished.push_str(&article[..1]);
        if starts_with_vowel_sound(after.trim_start()) {
            polished.push('n');
        }
        rest = after;
    }
    polished.push_str(rest);
    polished
}

/// Returns whether a word starts with a vowel sound. For abbreviations that are spelled out, the pronunciation of the
/// first letter decides.
fn starts_with_vowel_sound(word: &str) -> bool {
    let word: String = word.chars().take_while(|c| c.is_alphanumeric()).collect();
    let spelt = word.len() >= 2 && word.chars().take(2).all(|c| c.is_ascii_uppercase());
    let first = word.chars().next().unwrap_or(' ').to_ascii_lowercase();
    let lower = word.to_ascii_lowercase();
    if spelt && !["NASA", "NGO"].contains(&word.as_str()) {
        return "aefhilmnorsx".contains(first);
    }
    match lower.as_str() {
        _ if ["hour", "honest"].iter().any(|start| lower.starts_with(start)) => true,
        _ if ["uni", "use", "usu", "uti", "one", "once", "euro", "ux"]
            .iter()
            .any(|start| lower.starts_with(start)) =>
        {
            lower.starts_with("unin") || lower.starts_with("unim")
        }
        _ if word.starts_with("8") || word.starts_with("11") || word.starts_with("18") => true,
        "ngo" => true,
        _ => "aeiou".contains(first),
    }
}

fn fix_spaces(text: &str) -> String {
    let mut polished = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            ' ' if polished.is_empty() || polished.ends_with([' ', '\n']) => {}
            '.' | ',' | '!' | '?' | ';' | ':' | ')' if polished.ends_with(' ') => {
                polished.pop();
                polished.push(character);
            }
            _ => polished.push(character),
        }
    }
    polished.trim_end().to_owned()
}

fn fix_capitals(text: &str) -> String {
    let mut polished = String::with_capacity(text.len());
    let mut is_sentence_start = true;
    let mut follows_end_mark = false;
    for character in text.chars() {
        if is_sentence_start && character.is_alphabetic() {
            polished.extend(character.to_uppercase());
            is_sentence_start = false;
        } else {
            // A sentence that starts with a digit, `@` or `#` is not capitalized.
            is_sentence_start &= !character.is_alphanumeric() && !matches!(character, '@' | '#');
            polished.push(character);
        }
        match character {
            '.' | '!' | '?' => follows_end_mark = true,
            ' ' | '\n' if follows_end_mark => (is_sentence_start, follows_end_mark) = (true, false),
            '"' | ')' | '\'' => {}
            _ => follows_end_mark = false,
        }
    }
    polished
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn articles_match_the_sound_of_the_next_word() {
        for (word, article) in [
            ("editor", "an"),
            ("user", "a"),
            ("unhappy user", "an"),
            ("API", "an"),
            ("UX-designer", "a"),
            ("SQL query", "an"),
            ("hour", "an"),
            ("CTO", "a"),
            ("MVNO", "an"),
            ("one-off", "a"),
            ("university", "a"),
            ("uninspired tool", "an"),
            ("8-person team", "an"),
            ("Operations Manager", "an"),
        ] {
            assert_eq!(polish(&format!("it is a/an {word}")), format!("It is {article} {word}"));
        }
    }

    #[test]
    fn polish_fixes_capitals_and_spaces() {
        assert_eq!(polish(" well ,  it works .  fine! 3 weeks in. "), "Well, it works. Fine! 3 weeks in.");
        assert_eq!(polish("v2.5 is out. #tools rock"), "V2.5 is out. #tools rock");
        assert_eq!(polish("\"great\" they said. ok"), "\"Great\" they said. Ok");
    }
}
