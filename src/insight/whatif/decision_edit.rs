//! What is decided otherwise in a what-if, and how that is written.

use std::fmt::{self, Display, Formatter};
use std::str::FromStr;

use serde_json::{Map, Value, json};

use crate::counterfactual::edits::{AddedCall, AddedSetting, Edits, FollowedUsage};
use crate::counterfactual::kept_state::KeptState;
use crate::counterfactual::script::{Move, PastCall};
use novamind_base::notation::json_number;
use novamind_record::mode::Mode;
use novamind_session::engine::{UsageRule, refuse_outside_debug, unknown, value_of_json};
use novamind_tools::{ArgumentKind, Kind, Refusal, ToolId, catalogue, find};
use novamind_world::params::Params;
use novamind_world::settings::Settings;

/// Largest factor of settings.
const MOST_FACTOR: f64 = 1000.0;

/// Something that is decided otherwise from a week on.
#[derive(Debug, Clone, PartialEq)]
pub enum DecisionEdit {
    /// The settings of a tool, those in force and those that are set later, times a factor from 0 to 1,000.
    Scale {
        /// The tool.
        tool: ToolId,
        /// The factor.
        factor: f64,
    },
    /// No call of a tool is made: what it set stays as it is.
    Keep(ToolId),
    /// A single call is not made, or a parameter is not set.
    Drop(u64),
    /// A single call is made with other arguments.
    Change {
        /// Its line.
        seq: u64,
        /// The arguments.
        args: Value,
    },
    /// A call is made besides, after those of its day.
    Add {
        /// Week at whose start it is made, counted from 1; the first of the what-if if none is named.
        week: Option<u32>,
        /// The tool.
        tool: ToolId,
        /// The arguments.
        args: Value,
    },
    /// A parameter has another value from then on, after the calls of the day; in debug runs.
    Set {
        /// Week from whose start on, counted from 1; the first of the what-if if none is named.
        week: Option<u32>,
        /// Full key.
        key: String,
        /// The value.
        value: Value,
    },
    /// No call sets the capacity; at the start of every week it is the smallest tier that covers the busiest day of the week
    /// before.
    CapacityFollowsUsage,
}

/// What a what-if changes in days of a run that follow a moment.
///
/// # Errors
/// `line_unknown`, `week_unknown`, `parameter_unknown`: it names what is not there; `parameter_not_allowed`; and
/// `not_in_this_mode` where a parameter is set and the run is no debug run.
pub(super) fn edits(
    decided: &[DecisionEdit],
    opening: &Opening<'_>,
    moves: &[Move],
    until: u32,
) -> Result<Edits, Refusal> {
    let mut edits = Edits::default();
    for edit in decided {
        edit.add_to(&mut edits, opening, moves, until)?;
    }
    Ok(edits)
}

/// The company at the start of the week that a what-if begins with.
pub(super) struct Opening<'a> {
    pub day: u32,
    pub settings: &'a Settings,
    /// Parameters in force.
    pub params: &'a Params,
    /// What the run is.
    pub mode: Mode,
}

impl Opening<'_> {
    pub(super) fn of(start: &KeptState, mode: Mode) -> Opening<'_> {
        let KeptState { world, params, .. } = start;
        Opening { day: world.day, settings: &world.settings, params, mode }
    }

    /// The day on which a week begins, in which something is decided besides.
    fn day_of(&self, week: Option<u32>, until: u32) -> Result<u32, Refusal> {
        let (from, days) = (self.day, self.params.run.days_per_week);
        let day = week.map_or(from, |week| week.saturating_sub(1).saturating_mul(days));
        if (from..until).contains(&day) {
            return Ok(day);
        }
        let (first, last) = (from / days + 1, until.div_ceil(days));
        let message = format!("a decision can be added in weeks {first} to {last} of this what-if");
        Err(Refusal::at("week", "week_unknown", message))
    }

    /// Refuses a parameter that cannot be set.
    fn check_parameter(&self, key: &str, value: &Value) -> Result<(), Refusal> {
        refuse_outside_debug(self.mode)?;
        let in_force = self.params.value(key).map_err(unknown)?;
        let not_allowed = |problem| Refusal::at(key, "parameter_not_allowed", problem);
        if let (Value::String(word), false) = (value, in_force.is_str()) {
            return Err(not_allowed(format!("{word} is no value of {key}, which is {in_force} now")));
        }
        let value =
            value_of_json(value).ok_or_else(|| not_allowed(format!("{key} cannot be null, nor hold it")))?;
        self.params.with(key, value).map(drop).map_err(|error| not_allowed(error.problem))
    }
}

impl DecisionEdit {
    fn add_to(
        &self,
        edits: &mut Edits,
        opening: &Opening<'_>,
        moves: &[Move],
        until: u32,
    ) -> Result<(), Refusal> {
        match self {
            DecisionEdit::Scale { tool, factor } => scale(*tool, *factor, edits, opening, moves),
            DecisionEdit::Keep(tool) => drop_all(*tool, edits, moves),
            DecisionEdit::Drop(seq) => {
                move_of(*seq, moves)?;
                edits.dropped.insert(*seq);
            }
            DecisionEdit::Change { seq, args } => {
                call_of(*seq, moves)?;
                edits.changed.insert(*seq, args.clone());
            }
            DecisionEdit::Add { week, tool, args } => {
                let day = opening.day_of(*week, until)?;
                edits.added.push(AddedCall { day, tool: *tool, args: args.clone() });
            }
            DecisionEdit::Set { week, key, value } => {
                opening.check_parameter(key, value)?;
                let day = opening.day_of(*week, until)?;
                edits.set.push(AddedSetting { day, key: key.clone(), value: value.clone() });
            }
            DecisionEdit::CapacityFollowsUsage => {
                let followed = FollowedUsage { rule: UsageRule::BusiestDay, from: opening.day };
                let_capacity_follow(followed, edits, moves);
            }
        }
        Ok(())
    }
}

fn calls(moves: &[Move]) -> impl Iterator<Item = &PastCall> {
    moves.iter().filter_map(|step| match step {
        Move::Call(call) => Some(call),
        Move::Parameter(_) | Move::Days(_) => None,
    })
}

/// Lets the capacity follow usage, and makes no call that sets it.
pub(super) fn let_capacity_follow(followed: FollowedUsage, edits: &mut Edits, moves: &[Move]) {
    drop_all(ToolId::SetCapacityTier, edits, moves);
    edits.capacity = Some(followed);
}

fn drop_all(tool: ToolId, edits: &mut Edits, moves: &[Move]) {
    edits.dropped.extend(calls(moves).filter(|call| call.tool == tool).map(|call| call.seq));
}

fn call_of(seq: u64, moves: &[Move]) -> Result<(), Refusal> {
    let is_there = calls(moves).any(|call| call.seq == seq);
    is_there.then_some(()).ok_or_else(|| no_line(seq))
}

/// A call, or a parameter that was set.
fn move_of(seq: u64, moves: &[Move]) -> Result<(), Refusal> {
    let is_it = |step: &Move| matches!(step, Move::Parameter(setting) if setting.change.seq == seq);
    if moves.iter().any(is_it) { Ok(()) } else { call_of(seq, moves) }
}

fn no_line(seq: u64) -> Refusal {
    let message = format!("line {seq} is no decision of the weeks of this what-if; whatif WEEK lists them");
    Refusal::at("line", "line_unknown", message)
}

/// Values in force are set anew before anything else; calls that set some are made with other numbers.
fn scale(tool: ToolId, factor: f64, edits: &mut Edits, opening: &Opening<'_>, moves: &[Move]) {
    let mut in_force = tool.tool().current(opening.settings);
    if tool == ToolId::SetPrices {
        // A plan without a price stays without.
        in_force.retain(|_, price| price.as_f64() != Some(0.0));
    }
    // What the run sets anew on that day anyway is scaled there.
    let is_set_anew = calls(moves)
        .filter(|call| call.tool == tool && call.day == opening.day)
        .any(|call| call.accepted && in_force.keys().all(|name| call.args.get(name).is_some()));
    if !in_force.is_empty() && !is_set_anew {
        edits.opening.push((tool, scaled(&Value::Object(in_force), factor)));
    }
    for call in calls(moves).filter(|call| call.tool == tool) {
        let args = edits.changed.get(&call.seq).unwrap_or(&call.args);
        let args = scaled(args, factor);
        edits.changed.insert(call.seq, args);
    }
}

/// Every number times a factor.
fn scaled(value: &Value, factor: f64) -> Value {
    match value {
        Value::Number(number) => {
            number.as_f64().map_or(Value::Null, |own| json_number(rounded(own * factor)))
        }
        Value::Object(fields) => {
            fields.iter().map(|(name, value)| (name.clone(), scaled(value, factor))).collect()
        }
        Value::Array(items) => items.iter().map(|item| scaled(item, factor)).collect(),
        other => other.clone(),
    }
}

/// Without the noise of binary fractions: to twelve digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.11e}").parse().unwrap_or(value)
}

/// Whether the arguments of a tool are amounts: numbers of which a multiple makes sense.
pub fn sets_amounts(tool: ToolId) -> bool {
    let spec = tool.spec();
    let is_amount = |kind: &ArgumentKind| {
        matches!(kind, ArgumentKind::Number(_) | ArgumentKind::Map(..) | ArgumentKind::Matrix(..))
    };
    spec.kind == Kind::Setting && spec.arguments.iter().all(|own| is_amount(&own.kind))
}

impl Display for DecisionEdit {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        match self {
            DecisionEdit::Scale { tool, factor } => {
                write!(formatter, "{} * {}", tool.name(), json_number(*factor))
            }
            DecisionEdit::Keep(tool) => write!(formatter, "keep {}", tool.name()),
            DecisionEdit::Drop(seq) => write!(formatter, "drop {seq}"),
            DecisionEdit::Change { seq, args } => write!(formatter, "change {seq} {args}"),
            DecisionEdit::Add { week: None, tool, args } => write!(formatter, "{} {args}", tool.name()),
            DecisionEdit::Add { week: Some(week), tool, args } => {
                write!(formatter, "in {week} {} {args}", tool.name())
            }
            DecisionEdit::Set { week: None, key, value } => write!(formatter, "set {key} {value}"),
            DecisionEdit::Set { week: Some(week), key, value } => {
                write!(formatter, "in {week} set {key} {value}")
            }
            DecisionEdit::CapacityFollowsUsage => formatter.write_str("capacity follows usage"),
        }
    }
}

/// Forms of an edit, as help shows them.
pub const FORMS: [&str; 7] = [
    "set_prices * 0.9",
    "keep set_daily_spend",
    "drop 57",
    "change 57 {\"B\": 30}",
    "in 24 set_prices B=30",
    "capacity follows usage",
    "in 24 set group.S1.c_max_mean 60",
];

impl FromStr for DecisionEdit {
    type Err = String;

    fn from_str(text: &str) -> Result<DecisionEdit, String> {
        let text = text.trim();
        let (first, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
        let rest = rest.trim();
        match first {
            "" => Err(format!("an edit is missing; for instance {}", FORMS.join(" or "))),
            "keep" => acting(rest).map(DecisionEdit::Keep),
            "drop" => line(rest).map(DecisionEdit::Drop),
            "change" => {
                let (seq, args) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
                Ok(DecisionEdit::Change { seq: line(seq)?, args: arguments(args, None)? })
            }
            "in" => {
                let rest = rest.strip_prefix("week ").map_or(rest, str::trim_start);
                let (week, call) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
                let number = week.parse().map_err(|_| format!("{week} is not the number of a week"))?;
                decided_besides(Some(number), call.trim())
            }
            "capacity" if rest == "follows usage" || rest == "follows use" => {
                Ok(DecisionEdit::CapacityFollowsUsage)
            }
            "set" => decided_besides(None, text),
            _ => scale_or_call(text),
        }
    }
}

/// `set_prices * 0.9`, or a call.
fn scale_or_call(text: &str) -> Result<DecisionEdit, String> {
    let name = text.split(|letter: char| letter.is_whitespace() || letter == '*').next().unwrap_or_default();
    let Some(factor) = text[name.len()..].trim_start().strip_prefix('*') else { return added(None, text) };
    let tool = acting(name)?;
    if !sets_amounts(tool) {
        let amounts: Vec<&str> = ToolId::all().filter(|own| sets_amounts(*own)).map(ToolId::name).collect();
        return Err(format!("{name} sets no amounts; a factor goes with {}", amounts.join(", ")));
    }
    let factor = factor.trim();
    let number = factor.parse().ok().filter(|number: &f64| (0.0..=MOST_FACTOR).contains(number));
    number.map(|factor| DecisionEdit::Scale { tool, factor }).ok_or_else(|| {
        format!("{factor} is not a factor; write a number from 0 to {MOST_FACTOR}, for instance 0.9")
    })
}

/// `set KEY VALUE`, or a call.
fn decided_besides(week: Option<u32>, text: &str) -> Result<DecisionEdit, String> {
    let Some(rest) = text.strip_prefix("set").filter(|rest| rest.starts_with(char::is_whitespace)) else {
        return added(week, text);
    };
    let (key, value) = rest.trim().split_once(char::is_whitespace).unwrap_or((rest.trim(), ""));
    match value.trim() {
        "" => Err("set needs a parameter and its value, for instance set group.S1.c_max_mean 60".to_owned()),
        value if value.contains(" from ") => Err(format!(
            "a what-if sets a value from the start of a week on: in 24 set {key} VALUE, not {value}"
        )),
        value => {
            let value = serde_json::from_str(value).unwrap_or_else(|_| Value::String(value.to_owned()));
            Ok(DecisionEdit::Set { week, key: key.to_owned(), value })
        }
    }
}

fn added(week: Option<u32>, call: &str) -> Result<DecisionEdit, String> {
    let (name, rest) = call.split_once(char::is_whitespace).unwrap_or((call, ""));
    let tool = acting(name)?;
    Ok(DecisionEdit::Add { week, tool, args: arguments(rest, tool.spec().whole)? })
}

/// The tool of a name, if it can change the company.
fn acting(name: &str) -> Result<ToolId, String> {
    let Some(tool) = find(name) else {
        let near = catalogue::nearest(name);
        let help = match near.is_empty() {
            true => format!("an edit reads {}", FORMS.join(" or ")),
            false => format!("did you mean {}?", near.join(" or ")),
        };
        return Err(format!("there is no tool {name}; {help}"));
    };
    let spec = tool.spec();
    match spec.kind.acts() && spec.kind != Kind::Time {
        true => Ok(spec.id),
        false => Err(format!("{name} changes nothing in the company")),
    }
}

fn line(number: &str) -> Result<u64, String> {
    let number = number.trim();
    number.parse().map_err(|_| format!("{number} is not the number of a line; for instance drop 57"))
}

/// Arguments as JSON, or as `NAME=VALUE` separated by blanks.
fn arguments(text: &str, whole: Option<&str>) -> Result<Value, String> {
    let text = text.trim();
    if text.starts_with('{') {
        let given: Map<String, Value> =
            serde_json::from_str(text).map_err(|error| format!("the arguments are not JSON: {error}"))?;
        return Ok(match whole.filter(|name| !given.contains_key(*name)) {
            Some(name) => json!({ name: given }),
            None => Value::Object(given),
        });
    }
    let pair = |word: &str| {
        let (name, value) =
            word.split_once('=').ok_or_else(|| format!("{word} is no argument; write NAME=VALUE"))?;
        let value = serde_json::from_str(value).unwrap_or_else(|_| Value::String(value.to_owned()));
        Ok((name.to_owned(), value))
    };
    text.split_whitespace().map(pair).collect::<Result<Map<_, _>, String>>().map(Value::Object)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edits_are_written_as_they_are_read() {
        for text in [
            "set_prices * 0.9",
            "keep set_daily_spend",
            "drop 57",
            "change 57 {\"B\":30}",
            "set_prices {\"B\":30}",
            "in 24 set_prices {\"B\":30}",
            "capacity follows usage",
            "set quality.base_product_quality 0.2",
            "in 24 set calendar.weekly [1,1,1,1,1,1,1]",
        ] {
            let edit: DecisionEdit = text.parse().expect(text);
            assert_eq!(edit.to_string(), text);
        }
        assert!(FORMS.iter().all(|form| form.parse::<DecisionEdit>().is_ok()));
        let call = |text: &str| text.parse::<DecisionEdit>().expect(text).to_string();
        assert_eq!(call("set_prices*2"), "set_prices * 2");
        assert_eq!(call("set_prices * 1e-300"), "set_prices * 1e-300");
        assert_eq!(call("in week 3 set_prices A=16"), "in 3 set_prices {\"A\":16}");
        assert_eq!(call("in 3 set_prices A=16 B=34.5"), "in 3 set_prices {\"A\":16,\"B\":34.5}");
        assert_eq!(
            call("set_targeted_ad_spend {\"linkedin\": {\"S1\": 5}}"),
            "set_targeted_ad_spend {\"targeted_spend\":{\"linkedin\":{\"S1\":5}}}"
        );
    }

    #[test]
    fn what_is_no_edit_is_refused_with_what_is_one() {
        let said = |text: &str| text.parse::<DecisionEdit>().expect_err(text);
        assert!(said("").starts_with("an edit is missing"));
        assert_eq!(
            said("set_price * 2"),
            "there is no tool set_price; did you mean set_prices or set_promotion?"
        );
        assert!(
            said("set_capacity_tier * 2").starts_with("set_capacity_tier sets no amounts; a factor goes")
        );
        assert!(said("set_prices * much").starts_with("much is not a factor"));
        assert!(said("set_prices * -1").starts_with("-1 is not a factor"));
        assert!(said("set_prices * inf").starts_with("inf is not a factor"));
        assert!(said("set_prices * 1e308").starts_with("1e308 is not a factor"));
        assert_eq!(said("keep get_vars"), "get_vars changes nothing in the company");
        assert_eq!(said("next_week"), "next_week changes nothing in the company");
        assert!(said("drop it").starts_with("it is not the number of a line"));
        assert_eq!(said("in x set_prices B=3"), "x is not the number of a week");
        assert!(said("set group.S1.c_max_mean").starts_with("set needs a parameter and its value"));
        assert!(said("set quality.base_product_quality 5 from 300").contains("in 24 set"));
        assert!(said("in 3 set").starts_with("there is no tool set"));
        assert_eq!(said("set_prices B"), "B is no argument; write NAME=VALUE");
        assert!(said("set_prices {B}").starts_with("the arguments are not JSON"));
    }

    #[test]
    fn every_number_of_a_call_is_scaled_and_no_name() {
        let args = json!({"targeted_spend": {"linkedin": {"S1": 50.0}}, "name": "7"});
        assert_eq!(scaled(&args, 0.5), json!({"targeted_spend": {"linkedin": {"S1": 25}}, "name": "7"}));
        assert_eq!(scaled(&json!({"A": 12}), 1.1), json!({"A": 13.2}));
        assert!(sets_amounts(ToolId::SetPrices) && sets_amounts(ToolId::SetTargetedAdSpend));
        assert!(!sets_amounts(ToolId::SetModelTiers) && !sets_amounts(ToolId::PostSocialMedia));
    }
}
