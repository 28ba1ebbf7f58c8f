//! Four words for the state of a chain: what an experimenter writes on a sheet where no share can be a witness.

use std::sync::OnceLock;

use crate::session::trajectory::Line;

/// Words of a code.
const WORDS: usize = 4;
/// Bits of a hash that a word stands for.
const BITS: u32 = 11;
/// Letters that tell every word of the list from all others.
const TELLING: usize = 4;

/// The words, in alphabetical order.
fn list() -> &'static [&'static str] {
    static LIST: OnceLock<Vec<&str>> = OnceLock::new();
    LIST.get_or_init(|| include_str!("../../../assets/words/codes.txt").lines().collect())
}

/// The code of a line's hash: four words for its first 44 bits. Two different histories have the same one once in
/// eighteen million million. Empty for what is no hash.
pub fn code_words(hash: &str) -> String {
    let digits = (WORDS as u32 * BITS / 4) as usize;
    let Some(bits) = hash.get(..digits).and_then(|digits| u64::from_str_radix(digits, 16).ok()) else {
        return String::new();
    };
    let word = |place: u32| list()[(bits >> (place * BITS)) as usize % list().len()];
    (0..WORDS as u32).rev().map(word).collect::<Vec<_>>().join("-")
}

/// The first line that has a code; none if no line has it. Words may be written with hyphens or spaces, in capitals, and
/// with their first four letters only.
///
/// # Errors
/// It is no code: how many words it has, or the word that is not in the list.
pub fn line_of_code<'a>(lines: &'a [Line], code: &str) -> Result<Option<&'a Line>, String> {
    let code = written_out(code)?;
    Ok(lines.iter().find(|line| code_words(&line.hash) == code))
}

/// A code with its words in full.
fn written_out(code: &str) -> Result<String, String> {
    let given: Vec<String> = code
        .split(|letter: char| !letter.is_alphanumeric())
        .filter(|word| !word.is_empty())
        .map(str::to_lowercase)
        .collect();
    if given.len() != WORDS {
        return Err(format!("a code has {WORDS} words, this one has {}", given.len()));
    }
    let words: Result<Vec<&str>, String> = given
        .iter()
        .map(|word| {
            let fits = |known: &&&str| {
                **known == word || (word.len() == TELLING && known.starts_with(word.as_str()))
            };
            list()
                .iter()
                .find(fits)
                .copied()
                .ok_or_else(|| format!("{word:?} is no word of a code: is it misspelt?"))
        })
        .collect();
    Ok(words?.join("-"))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::session::trajectory::Record;
    use crate::session::trajectory::record::Memo;

    #[test]
    fn words_are_short_and_told_apart_by_their_first_letters() {
        let words = list();
        assert_eq!(words.len(), 1 << BITS);
        assert!(words.is_sorted());
        for word in words {
            assert!(
                (4..=7).contains(&word.len()) && word.bytes().all(|letter| letter.is_ascii_lowercase()),
                "{word}"
            );
        }
        let beginnings: BTreeSet<&str> = words.iter().map(|word| &word[..TELLING]).collect();
        assert_eq!(beginnings.len(), words.len());
    }

    #[test]
    fn a_code_stands_for_the_first_bits_of_a_hash() {
        let (first, last) = (list()[0], list()[2047]);
        let hash = |start: &str| format!("{start}{}", "5".repeat(64 - start.len()));
        assert_eq!(code_words(&hash("00000000000")), [first; 4].join("-"));
        assert_eq!(code_words(&hash("fffffffffff")), [last; 4].join("-"));
        // Eleven bits each: 0b00000000001 0b00000000010 0b00000000100 0b00000001000.
        let bits = 1u64 << 33 | 2 << 22 | 4 << 11 | 8;
        let words = [1, 2, 4, 8].map(|at| list()[at]);
        assert_eq!(code_words(&hash(&format!("{bits:011x}"))), words.join("-"));
        assert_eq!(code_words(&hash("00000000000").replace('5', "6")), code_words(&hash("00000000000")));
        for none in ["", "12", "no hash at all"] {
            assert_eq!(code_words(none), "");
        }
    }

    #[test]
    fn the_line_of_a_code_is_found_however_it_is_written() {
        let memo = |seq: u64| Record::Memo(Memo { digest: format!("{seq}"), length: seq });
        let lines: Vec<Line> =
            (0..50).map(|seq| Line::alone(seq, 0, "2026-11-24T10:00:00Z", memo(seq))).collect();
        for line in &lines {
            let code = code_words(&line.hash);
            let short: Vec<String> = code.split('-').map(|word| word[..TELLING].to_uppercase()).collect();
            for written in [code.clone(), code.replace('-', "  "), short.join(" "), format!(" {code}, ")] {
                assert_eq!(
                    line_of_code(&lines, &written).expect("a code").map(|line| line.seq),
                    Some(line.seq)
                );
            }
        }
        let other = code_words(&blake3::hash(b"another run").to_hex());
        assert_eq!(line_of_code(&lines, &other), Ok(None));
        let words = line_of_code(&lines, "amber lake").expect_err("too few");
        assert!(words.contains("4 words") && words.contains("has 2"), "{words}");
        let words = line_of_code(&lines, "amber amber xyzzy amber").expect_err("no word");
        assert!(words.contains("xyzzy"), "{words}");
    }
}
