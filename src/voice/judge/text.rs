//! Tokenization and word matching for posts.

/// A text in the forms that patterns are matched with.
#[derive(Debug, Clone)]
pub struct Reading {
    /// Lowercase text with plain quotes and dashes.
    normal: String,
    /// Words and numbers in order.
    tokens: Vec<String>,
}

/// A pattern of a word list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Entry {
    /// Tokens with this prefix.
    Prefix(String),
    /// A token equal to it.
    Word(String),
    /// Matches anywhere in the text; its words determine which tokens it covers.
    Phrase(String, Vec<Entry>),
}

impl Entry {
    /// Parses a pattern of a list.
    pub fn read(text: &str) -> Entry {
        if text.contains(' ') || text.starts_with(['/', '%', '#']) || text.ends_with('%') {
            return Entry::anywhere(text);
        }
        match text.strip_suffix('*') {
            Some(start) => Entry::Prefix(start.to_owned()),
            None => Entry::Word(text.to_owned()),
        }
    }

    /// Creates a pattern that matches anywhere in a text.
    pub fn anywhere(text: &str) -> Entry {
        let words = text.split(|c: char| !(c.is_ascii_alphanumeric() || "'-*".contains(c)));
        let words = words.filter(|word| !word.is_empty());
        let entry = |word: &str| match word.strip_suffix('*') {
            Some(start) => Entry::Prefix(start.to_owned()),
            None => Entry::Word(word.to_owned()),
        };
        Entry::Phrase(text.trim_end_matches('*').to_owned(), words.map(entry).collect())
    }

    /// Returns whether the pattern matches a token, ignoring a leading #.
    fn is_token(&self, token: &str) -> bool {
        let token = token.trim_start_matches('#');
        match self {
            Entry::Prefix(start) => token.starts_with(start.as_str()),
            Entry::Word(word) => token == word,
            Entry::Phrase(..) => false,
        }
    }

    /// Returns whether the pattern occurs in a text.
    pub fn occurs(&self, reading: &Reading) -> bool {
        match self {
            Entry::Phrase(text, _) => reading.normal.contains(text.as_str()),
            _ => reading.tokens.iter().any(|token| self.is_token(token)),
        }
    }

    /// Returns the pattern as written in a list, without its star.
    #[cfg(test)]
    pub fn text(&self) -> &str {
        match self {
            Entry::Prefix(text) | Entry::Word(text) | Entry::Phrase(text, _) => text,
        }
    }
}

impl Reading {
    /// Tokenizes a text.
    pub fn of(text: &str) -> Reading {
        let plain = |character: char| match character {
            '\u{2018}' | '\u{2019}' | '\u{201b}' | '\u{2032}' => '\'',
            '\u{201c}' | '\u{201d}' | '\u{201e}' => '"',
            '\u{2010}'..='\u{2015}' | '\u{2212}' => '-',
            other => other,
        };
        let normal: String = text.chars().map(plain).flat_map(char::to_lowercase).collect();
        let tokens = tokens(&normal);
        Reading { normal, tokens }
    }

    /// Returns words and numbers in order.
    pub fn tokens(&self) -> &[String] {
        &self.tokens
    }

    /// Returns the lowercase text with plain quotes and dashes.
    pub fn normal(&self) -> &str {
        &self.normal
    }

    /// Returns how many different patterns of a list occur.
    pub fn count(&self, list: &[Entry]) -> u32 {
        list.iter().filter(|entry| entry.occurs(self)).count() as u32
    }

    /// Returns whether any pattern of a list occurs.
    pub fn any(&self, list: &[Entry]) -> bool {
        list.iter().any(|entry| entry.occurs(self))
    }

    /// Returns the number of tokens that are numbers or amounts of money.
    pub fn numbers(&self) -> u32 {
        let number = |token: &&String| token.starts_with(|c: char| c.is_ascii_digit() || c == '$');
        self.tokens.iter().filter(number).count() as u32
    }

    /// Returns whether a token of one list is close to a different token of another list.
    pub fn near(&self, one: &[Entry], other: &[Entry], positions: usize) -> bool {
        let places = |list: &[Entry]| -> Vec<usize> {
            let of_list = |token: &String| list.iter().any(|entry| entry.is_token(token));
            (0..self.tokens.len()).filter(|at| of_list(&self.tokens[*at])).collect()
        };
        let (first, second) = (places(one), places(other));
        first.iter().any(|a| second.iter().any(|b| a != b && a.abs_diff(*b) <= positions))
    }

    /// Returns which tokens a list covers: single words, and all words of a phrase that occurs.
    pub fn covered(&self, list: &[Entry]) -> Vec<bool> {
        let mut covered = vec![false; self.tokens.len()];
        for entry in list {
            let Entry::Phrase(text, words) = entry else {
                for (own, token) in covered.iter_mut().zip(&self.tokens) {
                    *own |= entry.is_token(token);
                }
                continue;
            };
            if words.is_empty() || !self.normal.contains(text.as_str()) {
                continue;
            }
            for start in 0..(self.tokens.len() + 1).saturating_sub(words.len()) {
                let here = &self.tokens[start..start + words.len()];
                if words.iter().zip(here).all(|(word, token)| word.is_token(token)) {
                    covered[start..start + words.len()].fill(true);
                }
            }
        }
        covered
    }
}

/// Returns words (`#?[a-z0-9][a-z0-9'-]*%?`) and amounts of money (`$[0-9][0-9.,]*`).
fn tokens(normal: &str) -> Vec<String> {
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

/// Returns the share of adjacent token pairs that two texts have in common, 0..=1.
pub fn pair_overlap(one: &Reading, other: &Reading) -> f64 {
    let pairs = |reading: &Reading| -> std::collections::BTreeSet<(String, String)> {
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
        let reading = Reading::of(
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
        assert_eq!(reading.numbers(), 3);
        assert!(Entry::read("student*").occurs(&reading) && Entry::read("% off").occurs(&reading));
        assert!(!Entry::read("pa").occurs(&reading) && Entry::read("don't").occurs(&reading));
    }

    #[test]
    fn nearness_counts_positions_between_different_tokens() {
        let list = |words: &[&str]| words.iter().map(|word| Entry::read(word)).collect::<Vec<_>>();
        let reading = Reading::of("cut one two three four five price");
        assert!(reading.near(&list(&["cut"]), &list(&["price*"]), 6));
        assert!(!reading.near(&list(&["cut"]), &list(&["price*"]), 5));
        assert!(!reading.near(&list(&["price"]), &list(&["price*"]), 6));
    }

    #[test]
    fn phrases_cover_their_words() {
        let reading = Reading::of("response times fell, this time for all");
        let list = [Entry::read("response time*")];
        assert_eq!(reading.covered(&list), [true, true, false, false, false, false, false]);
    }

    #[test]
    fn overlap_is_that_of_pairs() {
        let overlap = |one, other| pair_overlap(&Reading::of(one), &Reading::of(other));
        assert_eq!(overlap("a b c", "a b c"), 1.0);
        assert_eq!(overlap("a b c", "b c d"), 1.0 / 3.0);
        assert_eq!(overlap("a", ""), 0.0);
    }
}
