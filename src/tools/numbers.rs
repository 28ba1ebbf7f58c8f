//! Numbers in documentation: placeholders in braces name a parameter and are replaced by the value in force.
//!
//! `{table.key}` is a value; `{info_level.2.cost}` is that of a list entry, named by its level, tier or id, or else by its
//! index from 0. A colon introduces the format:
//!
//! * `%` percentage, `100` percentage without the sign,
//! * `$` dollars, `,` thousands separators, `-` absolute value, `+1` value plus one,
//! * `word` as a word, `tenths` ten times the value as a capitalized word.

use std::collections::BTreeMap;

use serde_json::Value;

use novamind_base::notation::{capital, grouped};
use novamind_world::params::Params;

/// All numbers of the parameters, by key.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Numbers(BTreeMap<String, f64>);

impl Numbers {
    /// Returns the numbers of the bundled parameters.
    pub fn shipped() -> Numbers {
        Numbers::of(&Params::shipped())
    }

    /// Returns the numbers of parameters.
    pub fn of(params: &Params) -> Numbers {
        let mut numbers = Numbers::default();
        numbers.take("", &serde_json::to_value(params).unwrap_or(Value::Null));
        numbers
    }

    fn take(&mut self, path: &str, part: &Value) {
        let below = |name: &str| if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
        match part {
            Value::Object(table) => table.iter().for_each(|(key, value)| self.take(&below(key), value)),
            Value::Array(list) => {
                for (at, entry) in list.iter().enumerate() {
                    self.take(&below(&name_of(entry).unwrap_or(at.to_string())), entry);
                }
            }
            _ => {
                if let Some(number) = part.as_f64() {
                    self.0.insert(path.to_owned(), number);
                }
            }
        }
    }

    /// Returns a number by the key of its parameter, or `None` if the parameter does not exist.
    pub fn value(&self, key: &str) -> Option<f64> {
        self.0.get(key).copied()
    }

    /// Replaces the placeholders of a text. Unknown names stay unchanged.
    pub fn fill(&self, text: &str) -> String {
        let mut filled = String::new();
        let mut rest = text;
        while let Some((before, after)) = rest.split_once('{') {
            filled.push_str(before);
            let value = after.split_once('}').and_then(|(name, after)| Some((self.written(name)?, after)));
            match value {
                Some((value, after)) => {
                    filled.push_str(&value);
                    rest = after;
                }
                None => {
                    filled.push('{');
                    rest = after;
                }
            }
        }
        filled + rest
    }

    fn written(&self, name: &str) -> Option<String> {
        let (key, form) = name.split_once(':').unwrap_or((name, ""));
        let value = *self.0.get(key)?;
        Some(match form {
            "%" => format!("{} %", plain(value * 100.0)),
            "100" => plain(value * 100.0),
            "+1" => plain(value + 1.0),
            "," => grouped(value, if value.fract() == 0.0 { 0 } else { 2 }),
            "word" => word(value),
            "tenths" => capital(&word(value * 10.0)),
            "$" => format!("${}", grouped(value, if value.fract() == 0.0 { 0 } else { 2 })),
            "-" => plain(value.abs()),
            _ => plain(value),
        })
    }
}

/// Returns the name of an entry of a list of tables.
fn name_of(entry: &Value) -> Option<String> {
    let own = ["level", "tier", "id"].into_iter().find_map(|key| entry.get(key))?;
    Some(own.as_str().map_or_else(|| own.to_string(), str::to_owned))
}

/// Formats a small whole number as a word, others in digits.
fn word(value: f64) -> String {
    const WORDS: [&str; 13] = [
        "zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven",
        "twelve",
    ];
    let digits = plain(value);
    digits.parse::<usize>().ok().and_then(|whole| WORDS.get(whole)).map_or(digits, |word| (*word).to_owned())
}

/// Formats a number with at most six decimals, without trailing zeros.
fn plain(value: f64) -> String {
    let text = format!("{value:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Returns the placeholders of a text.
#[cfg(test)]
pub fn names_in(text: &str) -> Vec<String> {
    let pieces = text.split('{').skip(1).filter_map(|piece| piece.split_once('}'));
    pieces.map(|(name, _)| name.to_owned()).filter(|name| name.contains('.') && !name.contains(' ')).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CATALOGUE, Spec};

    #[test]
    fn names_become_the_values_in_force() {
        let mut params = Params::shipped();
        params.operations.base_outage_prob = 0.045;
        let numbers = Numbers::of(&params);
        assert_eq!(
            numbers.fill(
                "{operations.base_outage_prob:%} of {\"A\": 1} {leads.lead_acquisition_cost:$} {x.y} {"
            ),
            "4.5 % of {\"A\": 1} $0.50 {x.y} {"
        );
        assert_eq!(numbers.fill("{enterprise.late_reply_relationship_delta_per_day:-}"), "0.02");
    }

    fn texts(spec: &'static Spec) -> impl Iterator<Item = &'static str> {
        let arguments = spec.arguments.iter().map(|argument| argument.doc);
        let returns = spec.returns.iter().flat_map(|output| [output.kind, output.doc]);
        [spec.summary, spec.effect, spec.cost].into_iter().chain(arguments).chain(returns)
    }

    #[test]
    fn every_number_of_a_tool_is_a_parameter() {
        let numbers = Numbers::shipped();
        for spec in CATALOGUE.iter().map(|tool| tool.spec()) {
            for name in texts(spec).flat_map(names_in) {
                assert!(numbers.written(&name).is_some(), "{}: {name}", spec.name());
            }
            assert!(names_in(spec.summary).is_empty(), "{}: lists show summaries as they are", spec.name());
        }
    }

    /// Digits that texts may contain: labels, limits that the tool itself defines, and parts of formulas. Values of parameters
    /// must be placeholders.
    const TYPED: [(&str, &[&str]); 13] = [
        ("set_ads_strength", &["0 to 1", "(1 + "]),
        ("set_targeted_dev_spend", &["ln(1 + spend"]),
        ("set_daily_spend", &["ln(1 + spend"]),
        ("set_usage_quotas", &["a quota of 0"]),
        ("get_social_posts", &["0 for none", "S1"]),
        ("start_research_project", &["1 to 20"]),
        ("research_market", &["level 1"]),
        (
            "research_group",
            &["S1", "Level 2 takes", "3 takes", "4 takes", "5 takes", "level 2", "for 3", "for 4", "for 5"],
        ),
        ("get_group_insights", &["S1", "study level, 1", "0 to 1"]),
        ("set_capacity_tier", &["0 to 7"]),
        ("python_exec", &["600 if left out", "0: the", "first 5,000", "first 2,000"]),
        ("run_script", &["0: the", "first 5,000", "first 2,000"]),
        ("query", &["19 visible tables"]),
    ];

    #[test]
    fn no_text_types_the_value_of_a_parameter() {
        let also = [
            ("list_all_tables", &["tables, 19"][..]),
            ("post_social_media", &["the text, 1 to"]),
            ("next_week", &["95 times out of 100"]),
            ("register_script", &["At most 100", "200 bytes", "262,144", "4,194,304"]),
            ("register_daily_calculation", &["At most 100", "200 bytes", "262,144", "4,194,304"]),
        ];
        for spec in CATALOGUE.iter().map(|tool| tool.spec()) {
            let known = TYPED.iter().chain(&also).filter(|(name, _)| *name == spec.name());
            let known: Vec<&str> = known.flat_map(|(_, known)| known.iter().copied()).collect();
            for text in texts(spec) {
                let mut bare =
                    names_in(text).iter().fold(text.to_owned(), |bare, name| bare.replace(name, ""));
                known.iter().for_each(|typed| bare = bare.replace(typed, ""));
                assert!(!bare.contains(|letter: char| letter.is_ascii_digit()), "{}: {bare}", spec.name());
            }
            for typed in known {
                assert!(texts(spec).any(|text| text.contains(typed)), "{}: {typed} is gone", spec.name());
            }
        }
    }

    #[test]
    fn texts_say_what_they_said_and_follow_their_parameters() {
        let spec = |tool: &str| crate::find(tool).expect("a tool").spec();
        let (study, find, post, week) =
            (spec("research_group"), spec("research_market"), spec("post_social_media"), spec("next_week"));
        let shipped = Numbers::shipped();
        assert_eq!(
            shipped.fill(study.cost),
            "$60,000 for level 2, $175,000 for 3, $350,000 for 4, $700,000 for 5, at once"
        );
        assert!(shipped.fill(study.effect).contains(
            "Level 2 takes 3 days, 3 takes 5, 4 takes 7, 5 takes 10; the errors are at most 40, 25, 15 and 5 %."
        ));
        assert!(shipped.fill(study.arguments[1].doc).starts_with("level 2 to 5; if left out"));
        assert_eq!(shipped.fill(find.cost), "$25,000 per attempt, at once");
        assert!(shipped.fill(find.effect).starts_with("Three attempts in ten find"));
        assert_eq!(shipped.fill(post.arguments[0].doc), "the text, 1 to 280 characters");
        assert!(shipped.fill(post.effect).contains("half as many every three days"));
        assert!(shipped.fill(week.arguments[1].doc).starts_with("cash in 7, 28, 84 and 182 days"));
        let overview = spec("get_market_overview");
        assert!(shipped.fill(overview.returns[2].doc).ends_with("null before day 31"));
        assert!(shipped.fill(spec("set_ads_strength").effect).contains("log10(1 + 9 s)"));
        assert!(shipped.fill(spec("query").returns[1].doc).ends_with("5,000"));
        assert!(
            shipped.fill(spec("send_enterprise_deal").arguments[0].doc).contains("one to three offerings")
        );

        let mut params = Params::shipped();
        params.info_level[2].cost = 1_000.0;
        params.info_level[4].noise = 0.02;
        params.market_research.market_research_discover_prob = 0.25;
        params.ceo_posts.multiplier_half_life_days = 4.0;
        params.limits.prediction_horizons_days[1] = 35;
        let changed = Numbers::of(&params);
        assert!(changed.fill(study.cost).contains("$1,000 for 3"));
        assert!(changed.fill(study.effect).contains("15 and 2 %."));
        assert!(changed.fill(find.effect).starts_with("2.5 attempts in ten find"));
        assert!(changed.fill(post.effect).contains("half as many every four days"));
        assert!(changed.fill(week.arguments[1].doc).starts_with("cash in 7, 35, 84"));
    }
}
