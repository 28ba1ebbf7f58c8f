//! Colloquial wording of numbers and customer profiles.

use novamind_base::formatting::{dollars, dollars_and_cents};
use novamind_world::events::PostAuthor;
use novamind_world::identifiers::Group;
use novamind_world::params::Params;

/// The style in which the members of a group write.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpeechRegister {
    /// Casual style, as among friends.
    Casual,
    /// Plain style.
    Plain,
    /// Precise professional style.
    Expert,
    /// Technical style, as among engineers.
    Technical,
    /// Corporate style, on behalf of an enterprise.
    Corporate,
}

impl SpeechRegister {
    /// Returns the register of a group, or `Plain` for authors without a group.
    pub fn for_group(group: Option<Group>) -> SpeechRegister {
        let Some(group) = group else { return SpeechRegister::Plain };
        match group.id() {
            "S1" | "D_S01" | "D_S05" | "D_S08" | "D_S10" => SpeechRegister::Casual,
            "S2" | "D_S02" => SpeechRegister::Expert,
            "S3" | "D_S07" => SpeechRegister::Technical,
            _ if group.is_enterprise() => SpeechRegister::Corporate,
            _ => SpeechRegister::Plain,
        }
    }

    /// Returns the name of the register in the grammars.
    pub fn id(self) -> &'static str {
        match self {
            SpeechRegister::Casual => "casual",
            SpeechRegister::Plain => "plain",
            SpeechRegister::Expert => "expert",
            SpeechRegister::Technical => "technical",
            SpeechRegister::Corporate => "corporate",
        }
    }
}

const NUMBERS: [&str; 14] = [
    "no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve",
    "thirteen",
];

fn count_in_words(count: u32, unit: &str) -> String {
    let number = NUMBERS.get(count as usize).map_or_else(|| count.to_string(), |word| (*word).to_owned());
    let plural = if count == 1 { "" } else { "s" };
    format!("{number} {unit}{plural}")
}

/// Returns a time span in colloquial words, in days, weeks or months: `three weeks`.
pub fn time_span(days: u32) -> String {
    match days {
        0 | 1 => "one day".to_owned(),
        2..=13 => count_in_words(days, "day"),
        14..=59 => count_in_words(days / 7, "week"),
        60..=364 => count_in_words(days / 30, "month"),
        _ => "more than a year".to_owned(),
    }
}

/// Returns the duration of an outage in colloquial words, or `None` for 0 minutes.
pub fn outage_span(minutes: u32) -> Option<String> {
    match minutes {
        0 => None,
        30 => Some("half an hour".to_owned()),
        60 => Some("an hour".to_owned()),
        90 => Some("an hour and a half".to_owned()),
        _ => Some(count_in_words(minutes, "minute")),
    }
}

/// Returns an approximate number of seats in words, because enterprises do not publish the exact number.
pub fn approximate_seats(seats: u32) -> &'static str {
    match seats {
        0..60 => "a few dozen seats",
        60..150 => "around a hundred seats",
        150..350 => "a few hundred seats",
        350..800 => "several hundred seats",
        800..1300 => "about a thousand seats",
        _ => "well over a thousand seats",
    }
}

/// Formats a price without unnecessary cents. Returns `None` for 0.
pub fn price(amount: f64) -> Option<String> {
    match amount {
        _ if amount < 0.005 => None,
        _ if amount.fract() == 0.0 => Some(dollars(amount)),
        _ => Some(dollars_and_cents(amount)),
    }
}

/// Returns the job role of an author in words.
pub fn role(author: &PostAuthor, params: &Params) -> String {
    label_words(&params.personas.group[author.group.index()].role, author.persona.0[1])
}

/// Returns the industry of an author in words.
pub fn industry(author: &PostAuthor, params: &Params) -> String {
    label_words(&params.personas.group[author.group.index()].industry, author.persona.0[0])
}

/// Returns whether an author's profile states a high technical skill.
pub fn is_skilled(author: &PostAuthor, params: &Params) -> bool {
    let axis = if author.group.is_enterprise() {
        (&params.personas.enterprise.tech_savvy, author.persona.0[2])
    } else {
        (&params.personas.individual.tech_savvy, author.persona.0[4])
    };
    ["advanced", "expert"].contains(&label_words(axis.0, axis.1).as_str())
}

/// Returns whether an individual's profile states long work experience. Always `false` for enterprises.
pub fn is_senior(author: &PostAuthor, params: &Params) -> bool {
    let levels = &params.personas.individual.experience_levels;
    !author.group.is_enterprise()
        && ["experienced", "veteran"].contains(&label_words(levels, author.persona.0[2]).as_str())
}

fn label_words(labels: &[String], at: u8) -> String {
    labels.get(usize::from(at)).map_or(String::new(), |label| label.replace('-', " "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_spans_are_rounded_to_words() {
        for (days, words) in [
            (0, "one day"),
            (9, "nine days"),
            (20, "two weeks"),
            (59, "eight weeks"),
            (75, "two months"),
            (500, "more than a year"),
        ] {
            assert_eq!(time_span(days), words);
        }
        assert_eq!(outage_span(0), None);
        assert_eq!(outage_span(10).as_deref(), Some("ten minutes"));
        assert_eq!(outage_span(90).as_deref(), Some("an hour and a half"));
        assert_eq!((price(12.0), price(9.5), price(0.0)), (Some("$12".into()), Some("$9.50".into()), None));
        assert_eq!(approximate_seats(120), "around a hundred seats");
    }
}
