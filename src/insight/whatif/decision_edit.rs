//! Edits of decisions in a what-if, and their syntax.

use std::fmt::{self, Display, Formatter};
use std::str::FromStr;

use serde_json::{Map, Value, json};

use crate::counterfactual::edits::{AddedCall, AddedSetting, Edits, UsageBasedCapacity};
use crate::counterfactual::recorded_steps::{RecordedCall, RecordedStep};
use novamind_base::formatting::json_number;
use novamind_record::mode::Mode;
use novamind_session::engine::{
    UsageCapacityRule, json_to_value, require_debug_mode, unknown_parameter_rejection,
};
use novamind_tools::{
    ArgumentKind, Arguments, ParameterNumbers, Rejection, ToolId, ToolKind, ToolSpec, catalogue, find, limits,
};
use novamind_world::params::Params;
use novamind_world::settings::Settings;

/// Maximum factor of [`DecisionEdit::Scale`].
pub const MAX_FACTOR: f64 = 1000.0;

/// An edit of the decisions at and after the start of a week.
#[derive(Debug, Clone, PartialEq)]
pub enum DecisionEdit {
    /// Multiplies the current and later settings of a tool by a factor from 0 to 1,000.
    Scale {
        /// Tool whose settings are multiplied.
        tool: ToolId,
        /// Factor from 0 to 1,000.
        factor: f64,
    },
    /// Omits all calls of a tool and keeps its current settings.
    Keep(ToolId),
    /// Omits the call or parameter change in the given line.
    Drop(u64),
    /// Changes the arguments of the call in the given line.
    Change {
        /// Line of the edited call in the record of the run.
        seq: u64,
        /// New arguments of the call.
        args: Value,
    },
    /// Adds a call after the recorded calls of its day.
    Add {
        /// Week, counted from 1, at the start of which the call is executed; `None` for the first week of the what-if.
        week: Option<u32>,
        /// Tool of the added call.
        tool: ToolId,
        /// Arguments of the added call.
        args: Value,
    },
    /// Sets a parameter after the calls of the day. Only debug runs allow this edit.
    Set {
        /// Week, counted from 1, at the start of which the parameter is set; `None` for the first week of the what-if.
        week: Option<u32>,
        /// Full key of the parameter, for example `demand_surge.probability`.
        key: String,
        /// New value of the parameter.
        value: Value,
    },
    /// Ignores calls that set the capacity. At the start of every week, sets the smallest tier that covers the busiest
    /// day of the previous week.
    CapacityFollowsUsage,
}

/// Converts decision edits to edits of recorded steps.
///
/// # Errors
/// `line_unknown`, `week_unknown` or `parameter_unknown` for an unknown name, `parameter_not_allowed`,
/// `not_in_this_mode` if a parameter is set outside a debug run, `no_effect` for a dropped line that was rejected,
/// `edited_twice`, and the rejections of the arguments of a changed or added call.
pub(super) fn build_edits(
    decided: &[DecisionEdit],
    opening: &BranchStart<'_>,
    moves: &[RecordedStep],
    until: u32,
) -> Result<Edits, Rejection> {
    let mut edits = Edits::default();
    for (at, edit) in decided.iter().enumerate() {
        edit.check_line_is_new(&decided[..at])?;
        edit.add_to(&mut edits, opening, moves, until).map_err(|refusal| edit.name_in(refusal))?;
    }
    Ok(edits)
}

/// Returns, for each edit, the rejection with which [`build_edits`] would reject it, or `None` if the edit is valid.
pub(super) fn rejected_edits(
    decided: &[DecisionEdit],
    opening: &BranchStart<'_>,
    moves: &[RecordedStep],
    until: u32,
) -> Vec<Option<Rejection>> {
    let check = |(at, edit): (usize, &DecisionEdit)| {
        edit.check_line_is_new(&decided[..at])?;
        edit.add_to(&mut Edits::default(), opening, moves, until)
    };
    decided.iter().enumerate().map(|edit| check(edit).err()).collect()
}

/// The company at the start of the first week of a what-if.
pub(super) struct BranchStart<'a> {
    pub day: u32,
    pub settings: &'a Settings,
    /// Parameters in force at the start of the branches.
    pub params: &'a Params,
    /// Mode of the run.
    pub mode: Mode,
    /// Checks the arguments of a call that changes a setting.
    pub check_setting: &'a dyn Fn(ToolId, &Arguments) -> Result<(), Rejection>,
}

impl BranchStart<'_> {
    /// Checks the arguments of a changed or added call. Only rejections that do not depend on the branch are returned,
    /// because the simulation reports all others.
    fn check_call(&self, tool: ToolId, args: &Value, day: u32) -> Result<(), Rejection> {
        let spec = tool.spec();
        let arguments = Arguments::parse(spec, args, || ParameterNumbers::from_params(self.params).into())?;
        limits::check_arguments(spec, &arguments)?;
        if spec.kind != ToolKind::Setting {
            return check_number_ranges(spec, &arguments);
        }
        match (self.check_setting)(tool, &arguments) {
            // The group can be discovered after the start of the branches.
            Err(refusal) if refusal.code == "unknown_group" && day > self.day => Ok(()),
            checked => checked,
        }
    }

    /// Returns the decision day of an added decision: the day on which its week starts.
    fn decision_day(&self, week: Option<u32>, until: u32) -> Result<u32, Rejection> {
        let (from, days) = (self.day, self.params.run.days_per_week);
        let day = week.map_or(from, |week| week.saturating_sub(1).saturating_mul(days));
        if (from..until).contains(&day) {
            return Ok(day);
        }
        let (first, last) = (from / days + 1, until.div_ceil(days));
        let message = format!("a decision can be added in weeks {first} to {last} of this what-if");
        Err(Rejection::for_field("week", "week_unknown", message))
    }

    /// Rejects a parameter that cannot be set, or that cannot have the given value.
    fn check_parameter(&self, key: &str, value: &Value) -> Result<(), Rejection> {
        require_debug_mode(self.mode)?;
        let in_force = self.params.value(key).map_err(unknown_parameter_rejection)?;
        let not_allowed = |problem| Rejection::for_field(key, "parameter_not_allowed", problem);
        if let (Value::String(word), false) = (value, in_force.is_str()) {
            return Err(not_allowed(format!(
                "{word} is not a valid value of {key}; its current value is {in_force}"
            )));
        }
        let value =
            json_to_value(value).ok_or_else(|| not_allowed(format!("{key} cannot be or contain null")))?;
        self.params.with(key, value).map(drop).map_err(|error| not_allowed(error.problem))
    }
}

impl DecisionEdit {
    fn add_to(
        &self,
        edits: &mut Edits,
        opening: &BranchStart<'_>,
        moves: &[RecordedStep],
        until: u32,
    ) -> Result<(), Rejection> {
        match self {
            DecisionEdit::Scale { tool, factor } => scale_settings(*tool, *factor, edits, opening, moves),
            DecisionEdit::Keep(tool) => drop_calls_of_tool(*tool, edits, moves),
            DecisionEdit::Drop(seq) => {
                check_can_be_dropped(*seq, moves)?;
                edits.dropped_lines.insert(*seq);
            }
            DecisionEdit::Change { seq, args } => {
                let call = find_call(*seq, moves)?;
                opening.check_call(call.tool, args, call.day)?;
                edits.changed_arguments.insert(*seq, args.clone());
            }
            DecisionEdit::Add { week, tool, args } => {
                let day = opening.decision_day(*week, until)?;
                opening.check_call(*tool, args, day)?;
                edits.added_calls.push(AddedCall { day, tool: *tool, args: args.clone() });
            }
            DecisionEdit::Set { week, key, value } => {
                opening.check_parameter(key, value)?;
                let day = opening.decision_day(*week, until)?;
                edits.added_settings.push(AddedSetting { day, key: key.clone(), value: value.clone() });
            }
            DecisionEdit::CapacityFollowsUsage => {
                let followed =
                    UsageBasedCapacity { rule: UsageCapacityRule::BusiestDay, from_day: opening.day };
                add_usage_based_capacity(followed, edits, moves);
            }
        }
        Ok(())
    }

    /// Adds the edit to the message of a rejection, because a branch can have several edits.
    fn name_in(&self, refusal: Rejection) -> Rejection {
        match self {
            DecisionEdit::Change { .. } | DecisionEdit::Add { .. } if refusal.code != "line_unknown" => {
                Rejection { message: format!("{self}: {}", refusal.message), ..refusal }
            }
            _ => refusal,
        }
    }

    /// Returns the line that the edit changes or omits, or `None` if the edit is not limited to one line.
    fn line(&self) -> Option<u64> {
        match self {
            DecisionEdit::Drop(seq) | DecisionEdit::Change { seq, .. } => Some(*seq),
            _ => None,
        }
    }

    /// Rejects an edit of a line that an earlier edit of the same branch already changes or omits.
    fn check_line_is_new(&self, earlier: &[DecisionEdit]) -> Result<(), Rejection> {
        let Some(line) = self.line() else { return Ok(()) };
        match earlier.iter().any(|edit| edit.line() == Some(line)) {
            false => Ok(()),
            true => {
                let message = format!("line {line} is edited twice; give one edit for each line");
                Err(Rejection::for_field("line", "edited_twice", message))
            }
        }
    }
}

fn recorded_calls(moves: &[RecordedStep]) -> impl Iterator<Item = &RecordedCall> {
    moves.iter().filter_map(|step| match step {
        RecordedStep::Call(call) => Some(call),
        RecordedStep::Parameter(_) | RecordedStep::Days(_) => None,
    })
}

/// Adds a rule that adjusts the capacity to usage, and omits calls that set the capacity.
pub(super) fn add_usage_based_capacity(
    followed: UsageBasedCapacity,
    edits: &mut Edits,
    moves: &[RecordedStep],
) {
    drop_calls_of_tool(ToolId::SetCapacityTier, edits, moves);
    edits.capacity_rule = Some(followed);
}

fn drop_calls_of_tool(tool: ToolId, edits: &mut Edits, moves: &[RecordedStep]) {
    edits.dropped_lines.extend(recorded_calls(moves).filter(|call| call.tool == tool).map(|call| call.seq));
}

/// Returns the call that a line of the trajectory records.
fn find_call(seq: u64, moves: &[RecordedStep]) -> Result<&RecordedCall, Rejection> {
    if let Some(call) = recorded_calls(moves).find(|call| call.seq == seq) {
        return Ok(call);
    }
    let message = match is_parameter_line(seq, moves) {
        true => format!(
            "line {seq} sets a parameter and has no arguments to change; to remove it, type \"drop {seq}\"; to set another value, also type \"set KEY VALUE\""
        ),
        false => format!(
            "line {seq} is not a decision in the weeks of this what-if; to list the decisions, type: whatif WEEK"
        ),
    };
    Err(Rejection::for_field("line", "line_unknown", message))
}

fn is_parameter_line(seq: u64, moves: &[RecordedStep]) -> bool {
    moves.iter().any(|step| matches!(step, RecordedStep::Parameter(setting) if setting.change.seq == seq))
}

/// Rejects a line that is not a recorded decision, or that had no effect.
fn check_can_be_dropped(seq: u64, moves: &[RecordedStep]) -> Result<(), Rejection> {
    if is_parameter_line(seq, moves) || find_call(seq, moves)?.accepted {
        return Ok(());
    }
    let message = format!(
        "the call in line {seq} was rejected in the run, so omitting it has no effect; change its arguments instead"
    );
    Err(Rejection::for_field("line", "no_effect", message))
}

/// Rejects numbers outside the ranges in the specification of a tool.
fn check_number_ranges(spec: &ToolSpec, arguments: &Arguments) -> Result<(), Rejection> {
    for argument in spec.arguments {
        let (ArgumentKind::Number(range) | ArgumentKind::Integer(range)) = argument.kind else { continue };
        let is_outside = |value: &Value| value.as_f64().is_some_and(|number| !range.contains(number));
        if arguments.get(argument.name).is_some_and(is_outside) {
            let message = format!("{} must be a number in the range {}", argument.name, range.describe());
            return Err(Rejection::for_field(argument.name, "out_of_range", message));
        }
    }
    Ok(())
}

/// Scales the current settings by adding calls that precede all others, and scales the numbers in recorded calls.
fn scale_settings(
    tool: ToolId,
    factor: f64,
    edits: &mut Edits,
    opening: &BranchStart<'_>,
    moves: &[RecordedStep],
) {
    let mut in_force = tool.tool().current_arguments(opening.settings);
    if tool == ToolId::SetPrices {
        // A plan without a price stays without a price.
        in_force.retain(|_, price| price.as_f64() != Some(0.0));
    }
    // If a call of the run on the first day sets all values, only this call is scaled.
    let is_set_completely = recorded_calls(moves)
        .filter(|call| call.tool == tool && call.day == opening.day)
        .any(|call| call.accepted && in_force.keys().all(|name| call.args.get(name).is_some()));
    if !in_force.is_empty() && !is_set_completely {
        edits.initial_calls.push((tool, scale_numbers(&Value::Object(in_force), factor)));
    }
    for call in recorded_calls(moves).filter(|call| call.tool == tool) {
        let args = edits.changed_arguments.get(&call.seq).unwrap_or(&call.args);
        let args = scale_numbers(args, factor);
        edits.changed_arguments.insert(call.seq, args);
    }
}

/// Multiplies every number in a JSON value by a factor.
pub fn scale_numbers(value: &Value, factor: f64) -> Value {
    match value {
        Value::Number(number) => {
            number.as_f64().map_or(Value::Null, |number| json_number(round_to_12_digits(number * factor)))
        }
        Value::Object(fields) => {
            fields.iter().map(|(name, value)| (name.clone(), scale_numbers(value, factor))).collect()
        }
        Value::Array(items) => items.iter().map(|item| scale_numbers(item, factor)).collect(),
        other => other.clone(),
    }
}

/// Rounds to twelve significant digits, which removes binary rounding errors.
fn round_to_12_digits(value: f64) -> f64 {
    format!("{value:.11e}").parse().unwrap_or(value)
}

/// Returns whether the tool's arguments are amounts that can be multiplied by a factor.
pub fn is_scalable(tool: ToolId) -> bool {
    let spec = tool.spec();
    let is_amount = |kind: &ArgumentKind| {
        matches!(kind, ArgumentKind::Number(_) | ArgumentKind::Map(..) | ArgumentKind::Matrix(..))
    };
    spec.kind == ToolKind::Setting && spec.arguments.iter().all(|argument| is_amount(&argument.kind))
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

/// Examples of edits for help texts and error messages.
pub const EDIT_SYNTAX: [&str; 7] = [
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
            "" => Err(format!("an edit is missing; for example {}", EDIT_SYNTAX.join(" or "))),
            "keep" => parse_state_changing_tool(rest).map(DecisionEdit::Keep),
            "drop" => parse_line_number(rest).map(DecisionEdit::Drop),
            "change" => {
                let (seq, args) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
                Ok(DecisionEdit::Change {
                    seq: parse_line_number(seq)?,
                    args: parse_arguments(args, None, None)?,
                })
            }
            "in" => {
                let rest = rest.strip_prefix("week ").map_or(rest, str::trim_start);
                let (week, call) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
                let number = week.parse().map_err(|_| format!("{week} is not the number of a week"))?;
                parse_set_or_call(Some(number), call.trim())
            }
            "capacity" if rest == "follows usage" || rest == "follows use" => {
                Ok(DecisionEdit::CapacityFollowsUsage)
            }
            "set" => parse_set_or_call(None, text),
            _ => parse_scale_or_call(text),
        }
    }
}

/// Parses a multiplication, for example `set_prices * 0.9`, or a call.
fn parse_scale_or_call(text: &str) -> Result<DecisionEdit, String> {
    let name = text.split(|letter: char| letter.is_whitespace() || letter == '*').next().unwrap_or_default();
    let Some(factor) = text[name.len()..].trim_start().strip_prefix('*') else {
        return parse_added_call(None, text);
    };
    let tool = parse_state_changing_tool(name)?;
    if !is_scalable(tool) {
        let amounts: Vec<&str> =
            ToolId::all().filter(|tool_id| is_scalable(*tool_id)).map(ToolId::name).collect();
        return Err(format!("{name} has no amounts; a factor applies only to {}", amounts.join(", ")));
    }
    let factor = factor.trim();
    let number = factor.parse().ok().filter(|number: &f64| (0.0..=MAX_FACTOR).contains(number));
    number.map(|factor| DecisionEdit::Scale { tool, factor }).ok_or_else(|| {
        format!("{factor} is not a factor; enter a number from 0 to {MAX_FACTOR}, for example 0.9")
    })
}

/// Parses a parameter change, `set KEY VALUE`, or a call.
fn parse_set_or_call(week: Option<u32>, text: &str) -> Result<DecisionEdit, String> {
    let Some(rest) = text.strip_prefix("set").filter(|rest| rest.starts_with(char::is_whitespace)) else {
        return parse_added_call(week, text);
    };
    let (key, value) = rest.trim().split_once(char::is_whitespace).unwrap_or((rest.trim(), ""));
    match value.trim() {
        "" => {
            Err("\"set\" needs a parameter and a value, for example: set group.S1.c_max_mean 60".to_owned())
        }
        value if value.contains(" from ") => Err(format!(
            "a what-if sets a value at the start of a week: write \"in 24 set {key} VALUE\" instead of \"{value}\""
        )),
        value => {
            let value = serde_json::from_str(value).unwrap_or_else(|_| Value::String(value.to_owned()));
            Ok(DecisionEdit::Set { week, key: key.to_owned(), value })
        }
    }
}

fn parse_added_call(week: Option<u32>, call: &str) -> Result<DecisionEdit, String> {
    let (name, rest) = call.split_once(char::is_whitespace).unwrap_or((call, ""));
    let tool = parse_state_changing_tool(name)?;
    let spec = tool.spec();
    let args = parse_arguments(rest, spec.unnamed_argument, spec.positional_argument())?;
    Ok(DecisionEdit::Add { week, tool, args })
}

/// Parses a tool name. Rejects tools that cannot change the company.
fn parse_state_changing_tool(name: &str) -> Result<ToolId, String> {
    let Some(tool) = find(name) else {
        let near = catalogue::similar_tools(name);
        let help = match near.is_empty() {
            true => format!("an edit has one of the forms {}", EDIT_SYNTAX.join(" or ")),
            false => format!("did you mean {}?", near.join(" or ")),
        };
        return Err(format!("there is no tool {name}; {help}"));
    };
    let spec = tool.spec();
    match spec.kind.changes_company() && spec.kind != ToolKind::Time {
        true => Ok(spec.id),
        false => Err(format!("{name} does not change the company")),
    }
}

fn parse_line_number(number: &str) -> Result<u64, String> {
    let number = number.trim();
    number.parse().map_err(|_| format!("{number} is not a line number; for example: drop 57"))
}

/// Parses arguments as JSON, as `NAME=VALUE` pairs separated by spaces, or as a single value of the argument
/// `positional`.
fn parse_arguments(text: &str, whole: Option<&str>, positional: Option<&str>) -> Result<Value, String> {
    let text = text.trim();
    if text.starts_with('{') {
        let given: Map<String, Value> =
            serde_json::from_str(text).map_err(|error| format!("the arguments are not JSON: {error}"))?;
        return Ok(match whole.filter(|name| !given.contains_key(*name)) {
            Some(name) => json!({ name: given }),
            None => Value::Object(given),
        });
    }
    let parse_value =
        |value: &str| serde_json::from_str(value).unwrap_or_else(|_| Value::String(value.to_owned()));
    let is_one_word =
        !text.is_empty() && !text.contains(|letter: char| letter.is_whitespace() || letter == '=');
    if let Some(name) = positional.filter(|_| is_one_word) {
        return Ok(json!({ name: parse_value(text) }));
    }
    let pair = |word: &str| {
        let (name, value) =
            word.split_once('=').ok_or_else(|| format!("{word} is not an argument; write NAME=VALUE"))?;
        Ok((name.to_owned(), parse_value(value)))
    };
    text.split_whitespace().map(pair).collect::<Result<Map<_, _>, String>>().map(Value::Object)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edits_round_trip_through_text() {
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
        assert!(EDIT_SYNTAX.iter().all(|form| form.parse::<DecisionEdit>().is_ok()));
        let call = |text: &str| text.parse::<DecisionEdit>().expect(text).to_string();
        assert_eq!(call("set_prices*2"), "set_prices * 2");
        assert_eq!(call("set_prices * 1e-300"), "set_prices * 1e-300");
        assert_eq!(call("in week 3 set_prices A=16"), "in 3 set_prices {\"A\":16}");
        assert_eq!(call("in 3 set_prices A=16 B=34.5"), "in 3 set_prices {\"A\":16,\"B\":34.5}");
        assert_eq!(call("set_capacity_tier 1"), "set_capacity_tier {\"tier\":1}");
        assert_eq!(call("in 3 set_capacity_tier 1"), "in 3 set_capacity_tier {\"tier\":1}");
        assert_eq!(
            call("set_targeted_ad_spend {\"linkedin\": {\"S1\": 5}}"),
            "set_targeted_ad_spend {\"targeted_spend\":{\"linkedin\":{\"S1\":5}}}"
        );
    }

    #[test]
    fn invalid_edit_is_rejected_with_the_syntax() {
        let message = |text: &str| text.parse::<DecisionEdit>().expect_err(text);
        assert!(message("").starts_with("an edit is missing"));
        assert_eq!(
            message("set_price * 2"),
            "there is no tool set_price; did you mean set_prices or set_promotion?"
        );
        assert!(
            message("set_capacity_tier * 2")
                .starts_with("set_capacity_tier has no amounts; a factor applies")
        );
        assert!(message("set_prices * much").starts_with("much is not a factor"));
        assert!(message("set_prices * -1").starts_with("-1 is not a factor"));
        assert!(message("set_prices * inf").starts_with("inf is not a factor"));
        assert!(message("set_prices * 1e308").starts_with("1e308 is not a factor"));
        assert_eq!(message("keep get_vars"), "get_vars does not change the company");
        assert_eq!(message("next_week"), "next_week does not change the company");
        assert!(message("drop it").starts_with("it is not a line number"));
        assert_eq!(message("in x set_prices B=3"), "x is not the number of a week");
        assert!(message("set group.S1.c_max_mean").starts_with("\"set\" needs a parameter and a value"));
        assert!(message("set quality.base_product_quality 5 from 300").contains("in 24 set"));
        assert!(message("in 3 set").starts_with("there is no tool set"));
        assert_eq!(message("set_prices B"), "B is not an argument; write NAME=VALUE");
        assert!(message("set_prices {B}").starts_with("the arguments are not JSON"));
    }

    #[test]
    fn scaling_changes_numbers_and_keeps_names() {
        let args = json!({"targeted_spend": {"linkedin": {"S1": 50.0}}, "name": "7"});
        assert_eq!(
            scale_numbers(&args, 0.5),
            json!({"targeted_spend": {"linkedin": {"S1": 25}}, "name": "7"})
        );
        assert_eq!(scale_numbers(&json!({"A": 12}), 1.1), json!({"A": 13.2}));
        assert!(is_scalable(ToolId::SetPrices) && is_scalable(ToolId::SetTargetedAdSpend));
        assert!(!is_scalable(ToolId::SetModelTiers) && !is_scalable(ToolId::PostSocialMedia));
    }
}
