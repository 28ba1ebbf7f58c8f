//! Numbers in documentation: each placeholder in braces names a parameter and is replaced with the current value.
//!
//! `{table.key}` is a parameter. `{info_level.2.cost}` is a parameter in a list of tables. An entry of the list is
//! named by its level, tier or ID, or by its index from 0 if it has none of these. A colon introduces the format:
//!
//! * `%` percentage, `100` percentage without the sign,
//! * `$` dollars, `,` thousands separators, `-` absolute value, `+1` value plus one,
//! * `word` as a word, `tenths` ten times the value as a capitalized word.

use std::collections::BTreeMap;

use serde_json::Value;

use novamind_base::formatting::{capitalize, grouped_number};
use novamind_world::params::{Interface, Params};

/// All numeric parameters, by key, and the release whose interface is documented.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ParameterNumbers {
    numbers: BTreeMap<String, f64>,
    interface: Interface,
}

impl ParameterNumbers {
    /// Returns the numbers in the bundled parameters.
    pub fn bundled() -> ParameterNumbers {
        ParameterNumbers::from_params(&Params::bundled())
    }

    /// Collects the numbers in `params`.
    pub fn from_params(params: &Params) -> ParameterNumbers {
        let interface = params.fidelity.interface;
        let mut numbers = ParameterNumbers { interface, ..ParameterNumbers::default() };
        numbers.collect_numbers("", &serde_json::to_value(params).unwrap_or(Value::Null));
        numbers
    }

    fn collect_numbers(&mut self, path: &str, part: &Value) {
        let child_path =
            |name: &str| if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
        match part {
            Value::Object(table) => {
                table.iter().for_each(|(key, value)| self.collect_numbers(&child_path(key), value))
            }
            Value::Array(list) => {
                for (at, entry) in list.iter().enumerate() {
                    self.collect_numbers(&child_path(&entry_name(entry).unwrap_or(at.to_string())), entry);
                }
            }
            _ => {
                if let Some(number) = part.as_f64() {
                    self.numbers.insert(path.to_owned(), number);
                }
            }
        }
    }

    /// Returns the release whose tables and results are documented.
    pub fn interface(&self) -> Interface {
        self.interface
    }

    /// Returns the value of a parameter, or `None` if there is no numeric parameter with this key.
    pub fn value(&self, key: &str) -> Option<f64> {
        self.numbers.get(key).copied()
    }

    /// Replaces the placeholders in a text with parameter values. Placeholders with unknown names do not change.
    pub fn substitute(&self, text: &str) -> String {
        let mut filled = String::new();
        let mut rest = text;
        while let Some((before, after)) = rest.split_once('{') {
            filled.push_str(before);
            let value =
                after.split_once('}').and_then(|(name, after)| Some((self.format_placeholder(name)?, after)));
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

    fn format_placeholder(&self, name: &str) -> Option<String> {
        let (key, form) = name.split_once(':').unwrap_or((name, ""));
        let value = *self.numbers.get(key)?;
        Some(match form {
            "%" => format!("{} %", format_decimal(value * 100.0)),
            "100" => format_decimal(value * 100.0),
            "+1" => format_decimal(value + 1.0),
            "," => grouped_number(value, if value.fract() == 0.0 { 0 } else { 2 }),
            "word" => number_word(value),
            "tenths" => capitalize(&number_word(value * 10.0)),
            "$" => format!("${}", grouped_number(value, if value.fract() == 0.0 { 0 } else { 2 })),
            "-" => format_decimal(value.abs()),
            _ => format_decimal(value),
        })
    }
}

/// Returns the name by which a placeholder selects an entry in a list of tables.
fn entry_name(entry: &Value) -> Option<String> {
    let value = ["level", "tier", "id"].into_iter().find_map(|key| entry.get(key))?;
    Some(value.as_str().map_or_else(|| value.to_string(), str::to_owned))
}

/// Formats a small whole number as a word, and any other number in digits.
fn number_word(value: f64) -> String {
    const NUMBER_WORDS: [&str; 13] = [
        "zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven",
        "twelve",
    ];
    let digits = format_decimal(value);
    digits
        .parse::<usize>()
        .ok()
        .and_then(|whole| NUMBER_WORDS.get(whole))
        .map_or(digits, |word| (*word).to_owned())
}

/// Formats a number with at most six decimals, without trailing zeros.
fn format_decimal(value: f64) -> String {
    let text = format!("{value:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Returns the names of the placeholders in a text.
#[cfg(test)]
pub fn placeholder_names(text: &str) -> Vec<String> {
    let pieces = text.split('{').skip(1).filter_map(|piece| piece.split_once('}'));
    pieces.map(|(name, _)| name.to_owned()).filter(|name| name.contains('.') && !name.contains(' ')).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CATALOGUE, ToolSpec};

    #[test]
    fn placeholders_are_replaced_by_parameter_values() {
        let mut params = Params::bundled();
        params.operations.base_outage_prob = 0.045;
        let numbers = ParameterNumbers::from_params(&params);
        assert_eq!(
            numbers.substitute(
                "{operations.base_outage_prob:%} of {\"A\": 1} {leads.lead_acquisition_cost:$} {x.y} {"
            ),
            "4.5 % of {\"A\": 1} $0.50 {x.y} {"
        );
        assert_eq!(numbers.substitute("{enterprise.late_reply_relationship_delta_per_day:-}"), "0.02");
    }

    fn tool_texts(spec: &'static ToolSpec) -> impl Iterator<Item = &'static str> {
        let arguments = spec.arguments.iter().map(|argument| argument.description);
        let returns = spec.result_fields.iter().flat_map(|output| [output.kind, output.description]);
        [spec.summary, spec.effect, spec.cost].into_iter().chain(arguments).chain(returns)
    }

    #[test]
    fn every_placeholder_names_a_parameter() {
        let numbers = ParameterNumbers::bundled();
        for spec in CATALOGUE.iter().map(|tool| tool.spec()) {
            for name in tool_texts(spec).flat_map(placeholder_names) {
                assert!(numbers.format_placeholder(&name).is_some(), "{}: {name}", spec.name());
            }
            assert!(
                placeholder_names(spec.summary).is_empty(),
                "{}: lists show summaries as they are",
                spec.name()
            );
        }
    }

    /// Numbers that texts may contain as digits: labels, limits that the tool defines, and constants of formulas.
    /// Parameter values must be placeholders.
    const ALLOWED_LITERALS: [(&str, &[&str]); 13] = [
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
    fn tool_texts_contain_no_parameter_values_as_digits() {
        let also = [
            ("list_all_tables", &["tables, 19"][..]),
            ("post_social_media", &["the text, 1 to"]),
            ("next_week", &["95 times out of 100"]),
            ("register_script", &["At most 100", "200 bytes", "262,144", "4,194,304"]),
            ("register_daily_calculation", &["At most 100", "200 bytes", "262,144", "4,194,304"]),
        ];
        for spec in CATALOGUE.iter().map(|tool| tool.spec()) {
            let known = ALLOWED_LITERALS.iter().chain(&also).filter(|(name, _)| *name == spec.name());
            let known: Vec<&str> = known.flat_map(|(_, known)| known.iter().copied()).collect();
            for text in tool_texts(spec) {
                let mut bare =
                    placeholder_names(text).iter().fold(text.to_owned(), |bare, name| bare.replace(name, ""));
                known.iter().for_each(|typed| bare = bare.replace(typed, ""));
                assert!(!bare.contains(|letter: char| letter.is_ascii_digit()), "{}: {bare}", spec.name());
            }
            for typed in known {
                assert!(
                    tool_texts(spec).any(|text| text.contains(typed)),
                    "{}: {typed} is gone",
                    spec.name()
                );
            }
        }
    }

    #[test]
    fn tool_texts_follow_their_parameters() {
        let spec = |tool: &str| crate::find(tool).expect("a tool").spec();
        let (study, find, post, week) =
            (spec("research_group"), spec("research_market"), spec("post_social_media"), spec("next_week"));
        let bundled = ParameterNumbers::bundled();
        assert_eq!(
            bundled.substitute(study.cost),
            "$60,000 for level 2, $175,000 for 3, $350,000 for 4, $700,000 for 5, at once"
        );
        assert!(bundled.substitute(study.effect).contains(
            "Level 2 takes 3 days, 3 takes 5, 4 takes 7, 5 takes 10; the errors are at most 40, 25, 15 and 5 %."
        ));
        assert!(bundled.substitute(study.arguments[1].description).starts_with("level 2 to 5; if left out"));
        assert_eq!(bundled.substitute(find.cost), "$25,000 per attempt, at once");
        assert!(bundled.substitute(find.effect).starts_with("Three attempts in ten find"));
        assert_eq!(bundled.substitute(post.arguments[0].description), "the text, 1 to 280 characters");
        assert!(bundled.substitute(post.effect).contains("half as many every three days"));
        assert!(
            bundled.substitute(week.arguments[1].description).starts_with("cash in 7, 28, 84 and 182 days")
        );
        let overview = spec("get_market_overview");
        assert!(bundled.substitute(overview.result_fields[2].description).ends_with("null before day 31"));
        assert!(bundled.substitute(spec("set_ads_strength").effect).contains("log10(1 + 9 s)"));
        assert!(bundled.substitute(spec("query").result_fields[1].description).ends_with("5,000"));
        assert!(
            bundled
                .substitute(spec("send_enterprise_deal").arguments[0].description)
                .contains("one to three offerings")
        );

        let mut params = Params::bundled();
        params.info_level[2].cost = 1_000.0;
        params.info_level[4].noise = 0.02;
        params.market_research.market_research_discover_prob = 0.25;
        params.ceo_posts.multiplier_half_life_days = 4.0;
        params.limits.prediction_horizons_days[1] = 35;
        let changed = ParameterNumbers::from_params(&params);
        assert!(changed.substitute(study.cost).contains("$1,000 for 3"));
        assert!(changed.substitute(study.effect).contains("15 and 2 %."));
        assert!(changed.substitute(find.effect).starts_with("2.5 attempts in ten find"));
        assert!(changed.substitute(post.effect).contains("half as many every four days"));
        assert!(changed.substitute(week.arguments[1].description).starts_with("cash in 7, 35, 84"));
    }
}
