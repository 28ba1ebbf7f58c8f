//! Tokenization and word matching for posts.

/// A normalized text with its tokens, against which patterns are matched.
#[derive(Debug, Clone)]
pub struct TokenizedText {
    /// The text in lowercase, with ASCII quotes and dashes.
    normalized: String,
    /// Words and numbers of the text, in order.
    tokens: Vec<String>,
}

/// A pattern in a word list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum WordPattern {
    /// Matches tokens with this prefix.
    Prefix(String),
    /// Matches this token only.
    Word(String),
    /// Matches a phrase anywhere in the text. The patterns of the phrase's words determine the tokens that it covers.
    Phrase(String, Vec<WordPattern>),
}

impl WordPattern {
    /// Parses a pattern in the notation of the word lists: `word`, `prefix*` or a phrase.
    pub fn parse(text: &str) -> WordPattern {
        if text.contains(' ') || text.starts_with(['/', '%', '#']) || text.ends_with('%') {
            return WordPattern::phrase(text);
        }
        match text.strip_suffix('*') {
            Some(start) => WordPattern::Prefix(start.to_owned()),
            None => WordPattern::Word(text.to_owned()),
        }
    }

    /// Creates a pattern that matches anywhere in a text.
    pub fn phrase(text: &str) -> WordPattern {
        let words = text.split(|c: char| !(c.is_ascii_alphanumeric() || "'-*".contains(c)));
        let words = words.filter(|word| !word.is_empty());
        let entry = |word: &str| match word.strip_suffix('*') {
            Some(start) => WordPattern::Prefix(start.to_owned()),
            None => WordPattern::Word(word.to_owned()),
        };
        WordPattern::Phrase(text.trim_end_matches('*').to_owned(), words.map(entry).collect())
    }

    /// Returns whether the pattern matches a token. Ignores a leading `#` in the token.
    fn matches_token(&self, token: &str) -> bool {
        let token = token.trim_start_matches('#');
        match self {
            WordPattern::Prefix(start) => token.starts_with(start.as_str()),
            WordPattern::Word(word) => token == word,
            WordPattern::Phrase(..) => false,
        }
    }

    /// Returns whether the pattern occurs in a text.
    pub fn occurs_in(&self, reading: &TokenizedText) -> bool {
        match self {
            WordPattern::Phrase(text, _) => reading.normalized.contains(text.as_str()),
            _ => reading.tokens.iter().any(|token| self.matches_token(token)),
        }
    }

    /// Returns the pattern as it is written in a word list, without the final star.
    #[cfg(test)]
    pub fn text(&self) -> &str {
        match self {
            WordPattern::Prefix(text) | WordPattern::Word(text) | WordPattern::Phrase(text, _) => text,
        }
    }
}

impl TokenizedText {
    /// Tokenizes and normalizes a text.
    pub fn new(text: &str) -> TokenizedText {
        let plain = |character: char| match character {
            '\u{2018}' | '\u{2019}' | '\u{201b}' | '\u{2032}' => '\'',
            '\u{201c}' | '\u{201d}' | '\u{201e}' => '"',
            '\u{2010}'..='\u{2015}' | '\u{2212}' => '-',
            other => other,
        };
        let normal: String = text.chars().map(plain).flat_map(char::to_lowercase).collect();
        let tokens = tokenize(&normal);
        TokenizedText { normalized: normal, tokens }
    }

    /// Returns the words and numbers of the text, in order.
    pub fn tokens(&self) -> &[String] {
        &self.tokens
    }

    /// Returns the text in lowercase, with ASCII quotes and dashes.
    pub fn normalized(&self) -> &str {
        &self.normalized
    }

    /// Returns the number of patterns in a list that occur in the text.
    pub fn count_matches(&self, list: &[WordPattern]) -> u32 {
        list.iter().filter(|entry| entry.occurs_in(self)).count() as u32
    }

    /// Returns whether any pattern of a list occurs in the text.
    pub fn contains_any(&self, list: &[WordPattern]) -> bool {
        list.iter().any(|entry| entry.occurs_in(self))
    }

    /// Counts the tokens that are numbers or amounts of money.
    pub fn count_numbers(&self) -> u32 {
        let number = |token: &&String| token.starts_with(|c: char| c.is_ascii_digit() || c == '$');
        self.tokens.iter().filter(number).count() as u32
    }

    /// Returns whether a token that matches one list is within `positions` tokens of a different token that matches
    /// the other list.
    pub fn are_near(&self, one: &[WordPattern], other: &[WordPattern], positions: usize) -> bool {
        let places = |list: &[WordPattern]| -> Vec<usize> {
            let of_list = |token: &String| list.iter().any(|entry| entry.matches_token(token));
            (0..self.tokens.len()).filter(|at| of_list(&self.tokens[*at])).collect()
        };
        let (first, second) = (places(one), places(other));
        first.iter().any(|a| second.iter().any(|b| a != b && a.abs_diff(*b) <= positions))
    }

    /// Returns for each token whether a list covers it, as a single word or as part of a phrase that occurs in the
    /// text.
    pub fn covered_tokens(&self, list: &[WordPattern]) -> Vec<bool> {
        let mut covered = vec![false; self.tokens.len()];
        for entry in list {
            let WordPattern::Phrase(text, words) = entry else {
                for (is_covered, token) in covered.iter_mut().zip(&self.tokens) {
                    *is_covered |= entry.matches_token(token);
                }
                continue;
            };
            if words.is_empty() || !self.normalized.contains(text.as_str()) {
                continue;
            }
            for start in 0..(self.tokens.len() + 1).saturating_sub(words.len()) {
                let here = &self.tokens[start..start + words.len()];
                if words.iter().zip(here).all(|(word, token)| word.matches_token(token)) {
                    covered[start..start + words.len()].fill(true);
                }
            }
        }
        covered
    }
}

/// Splits a text into words (`#?[a-z0-9][a-z0-9'-]*%?`) and amounts of money (`$[0-9][0-9.,]*`).
fn tokenize(normal: &str) -> Vec<String> {
    let bytes = normal.as_bytes();
    let is_start = |at: usize| bytes.get(at).is_some_and(u8::is_ascii_alphanumeric);
    let mut tokens = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let (begin, first) = (at, bytes[at]);
        if first == b'$' && bytes.get(at + 1).is_some_and(u8::is_ascii_digit) {
            at += 1;
            while bytes.get(at).is_some_and(|b| b.is_ascii_digit() || b".,".contains(b)) {
                at += 1;
            }
        } else if is_start(at) || (first == b'#' && is_start(at + 1)) {
            at += 1;
            while bytes.get(at).is_some_and(|b| b.is_ascii_alphanumeric() || b"'-".contains(b)) {
                at += 1;
            }
            at += usize::from(bytes.get(at) == Some(&b'%'));
        } else {
            at += 1;
            continue;
        }
        tokens.push(normal[begin..at].to_owned());
    }
    tokens
}

/// Returns whether a character counts as an emoji.
pub fn is_emoji(character: char) -> bool {
    matches!(character, '\u{1F300}'..='\u{1FAFF}' | '\u{2600}'..='\u{27BF}')
}

/// Returns the share of adjacent token pairs that occur in both texts, 0..=1.
pub fn pair_overlap(one: &TokenizedText, other: &TokenizedText) -> f64 {
    let pairs = |reading: &TokenizedText| -> std::collections::BTreeSet<(String, String)> {
        reading.tokens.windows(2).map(|pair| (pair[0].clone(), pair[1].clone())).collect()
    };
    let (one, other) = (pairs(one), pairs(other));
    let union = one.union(&other).count();
    if union == 0 { 0.0 } else { one.intersection(&other).count() as f64 / union as f64 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_are_words_numbers_and_money() {
        let reading = TokenizedText::new(
            "Don\u{2019}t pay $9.50 \u{2014} 20% off for #Students, rate\u{2011}limits: 200k tokens/day! ü",
        );
        assert_eq!(
            reading.tokens(),
            [
                "don't",
                "pay",
                "$9.50",
                "20%",
                "off",
                "for",
                "#students",
                "rate-limits",
                "200k",
                "tokens",
                "day"
            ]
        );
        assert_eq!(reading.count_numbers(), 3);
        assert!(
            WordPattern::parse("student*").occurs_in(&reading)
                && WordPattern::parse("% off").occurs_in(&reading)
        );
        assert!(
            !WordPattern::parse("pa").occurs_in(&reading) && WordPattern::parse("don't").occurs_in(&reading)
        );
    }

    #[test]
    fn are_near_counts_positions_between_tokens() {
        let list = |words: &[&str]| words.iter().map(|word| WordPattern::parse(word)).collect::<Vec<_>>();
        let reading = TokenizedText::new("cut one two three four five price");
        assert!(reading.are_near(&list(&["cut"]), &list(&["price*"]), 6));
        assert!(!reading.are_near(&list(&["cut"]), &list(&["price*"]), 5));
        assert!(!reading.are_near(&list(&["price"]), &list(&["price*"]), 6));
    }

    #[test]
    fn phrases_cover_their_words() {
        let reading = TokenizedText::new("response times fell, this time for all");
        let list = [WordPattern::parse("response time*")];
        assert_eq!(reading.covered_tokens(&list), [true, true, false, false, false, false, false]);
    }

    #[test]
    fn pair_overlap_counts_token_pairs() {
        let overlap = |one, other| pair_overlap(&TokenizedText::new(one), &TokenizedText::new(other));
        assert_eq!(overlap("a b c", "a b c"), 1.0);
        assert_eq!(overlap("a b c", "b c d"), 1.0 / 3.0);
        assert_eq!(overlap("a", ""), 0.0);
    }
}
