//! `break`, `run`, `since`, `find` and `who`: breakpoints, conditions over time, and the mechanisms that changed a
//! figure (docs/debugging.md).

use serde_json::{Value, json};

use super::super::grammar::ParseError;
use super::super::response::CommandResponse;
use super::Interpreter;
use novamind_base::formatting::json_number;
use novamind_insight::{
    Breakpoint, Condition, ConditionHistory, ConditionParseError, ConditionState, FigureWrite, FigureWrites,
    Inspect, WriteSource,
};
use novamind_record::mode::Mode;
use novamind_report::inspection::{
    InspectionCommand, describe_breakpoints, describe_condition_history, describe_source, describe_stop,
};
use novamind_session::ReputationCause;
use novamind_tools::Rejection;

impl Interpreter {
    /// Executes `break`, `break CONDITION` and `break clear N|all`. `column` is the column at which `rest`
    /// begins in the line.
    pub(super) fn breakpoint_command(
        &mut self,
        rest: &str,
        column: usize,
    ) -> Result<CommandResponse, ParseError> {
        if let Err(rejection) = self.session.check_inspection() {
            return Ok(CommandResponse::rejected("break", rejection));
        }
        let rest = strip_comment(rest);
        let shown = match rest.split_once(char::is_whitespace).unwrap_or((rest, "")) {
            ("", _) => self.session.inspect().breakpoints().map(|set| {
                let data = json!({ "breakpoints": breakpoints_to_json(&set) });
                CommandResponse::success("break", describe_breakpoints(&set).join("\n"), data)
            }),
            ("clear", which) => {
                let removed =
                    self.session.inspect().clear_breakpoints(parse_number_or_all(which.trim(), column + 6)?);
                removed.map(|removed| {
                    let lines: Vec<String> = removed
                        .iter()
                        .map(|removed| format!("removed {}  {}", removed.number, removed.condition))
                        .collect();
                    let text =
                        if lines.is_empty() { "no breakpoint was set".to_owned() } else { lines.join("\n") };
                    CommandResponse::success(
                        "break",
                        text,
                        json!({ "removed": breakpoints_to_json(&removed) }),
                    )
                })
            }
            _ => {
                let set = self.session.inspect().set_breakpoint(parse_condition(rest, column)?);
                set.map(|breakpoint| {
                    let next = match self.session.ended() {
                        None => "to simulate until then, type: run DAYS".to_owned(),
                        Some(_) => {
                            format!(
                                "to see since when the condition is true or false, type: since {}",
                                breakpoint.number
                            )
                        }
                    };
                    let text = format!("breakpoint {}: {}; {next}", breakpoint.number, breakpoint.condition);
                    CommandResponse::success("break", text, breakpoint_to_json(&breakpoint))
                })
            }
        };
        Ok(shown.unwrap_or_else(|rejection| CommandResponse::rejected("break", rejection)))
    }

    /// Executes `run DAYS` and `run DAYS until CONDITION`. The condition becomes a breakpoint, as with `break`.
    pub(super) fn run_days(&mut self, rest: &str, column: usize) -> Result<CommandResponse, ParseError> {
        if self.session.manifest().mode != Mode::Debug {
            let rejection =
                Rejection::new("not_in_this_mode", "run simulates single days in debug runs only");
            return Ok(CommandResponse::rejected("run", rejection));
        }
        let (number, until) = strip_comment(rest).split_once("until").unwrap_or((strip_comment(rest), ""));
        let days = number.trim().parse().ok().filter(|days| *days > 0).ok_or_else(|| ParseError {
            text: "run needs a number of days, for example run 28".to_owned(),
            column,
        })?;
        if number.len() < strip_comment(rest).len() {
            let begins = column + number.chars().count() + "until".len();
            let condition = parse_condition(until, begins)?;
            if let Err(rejection) = self.session.inspect().set_breakpoint(condition) {
                return Ok(CommandResponse::rejected("run", rejection));
            }
        }
        let set = self.session.inspect().breakpoints().map_or(0, |set| set.len());
        let run = self.session.inspect().run_until_breakpoint(days, &mut |_| {});
        Ok(match run {
            Ok(run) => {
                let day = self.session.day();
                let mut data = run.week.to_json();
                data["from"] = run.from.into();
                let hit = |condition: &Condition, number: u32, judged: &ConditionState| {
                    let mut hit = condition_state_to_json(judged);
                    hit["number"] = number.into();
                    hit["condition"] = condition.to_string().into();
                    hit
                };
                let hits = run.hits.iter().map(|breakpoint_hit| {
                    hit(
                        &breakpoint_hit.breakpoint.condition,
                        breakpoint_hit.breakpoint.number,
                        &breakpoint_hit.state,
                    )
                });
                data["stopped_by"] = hits.collect();
                let week_text = super::advance::week_response("run", &self.session, &run.week).to_text();
                let text = format!("{week_text}{}", describe_stop(&run, day, set).join("\n"));
                CommandResponse::success("run", text, data)
            }
            Err(rejection) => CommandResponse::rejected("run", rejection),
        })
    }

    /// Executes `since`, `since N` and `since CONDITION`.
    pub(super) fn run_since(
        &mut self,
        word: &str,
        rest: &str,
        column: usize,
    ) -> Result<CommandResponse, ParseError> {
        if let Err(rejection) = self.session.check_inspection() {
            return Ok(CommandResponse::rejected(word, rejection));
        }
        let rest = strip_comment(rest);
        let found = match (rest, rest.parse::<u32>()) {
            ("", _) => self.session.inspect().breakpoint_histories(None),
            (_, Ok(number)) => self.session.inspect().breakpoint_histories(Some(number)),
            _ => self
                .session
                .inspect()
                .condition_history(parse_condition(rest, column)?)
                .map(|condition_history| vec![condition_history]),
        };
        Ok(match found {
            Ok(found) if found.is_empty() => {
                return Err(ParseError {
                    text: "no breakpoint is set; give a condition, for example since churn(S1) > 0.05 over 7"
                        .to_owned(),
                    column,
                });
            }
            Ok(found) => {
                let lines: Vec<String> = found.iter().flat_map(describe_condition_history).collect();
                let data: Vec<Value> = found.iter().map(condition_history_to_json).collect();
                CommandResponse::success(word, lines.join("\n"), json!({ "conditions": data }))
            }
            Err(rejection) => CommandResponse::rejected(word, rejection),
        })
    }

    /// Executes `find CONDITION`.
    pub(super) fn run_find(&mut self, rest: &str, column: usize) -> Result<CommandResponse, ParseError> {
        self.run_debug_command("find", || InspectionCommand::parse_find(rest, column))
    }

    /// Executes `who FIGURE [DAY]`.
    pub(super) fn run_who(&mut self, rest: &str, column: usize) -> Result<CommandResponse, ParseError> {
        self.run_debug_command("who", || InspectionCommand::parse_who(rest, column))
    }
}

fn strip_comment(text: &str) -> &str {
    text.split('#').next().unwrap_or_default().trim()
}

fn parse_condition(text: &str, column: usize) -> Result<Condition, ParseError> {
    text.parse().map_err(|problem| to_line_error(problem, column))
}

/// Converts an error in the rest of a line that begins at `column` to an error with columns of the whole line.
fn to_line_error(problem: ConditionParseError, column: usize) -> ParseError {
    ParseError { text: problem.message, column: column + problem.column - 1 }
}

/// Parses the number of a breakpoint. Returns `None` for `all`.
fn parse_number_or_all(word: &str, column: usize) -> Result<Option<u32>, ParseError> {
    match (word, word.parse()) {
        ("all", _) => Ok(None),
        (_, Ok(number)) => Ok(Some(number)),
        _ => Err(ParseError {
            text: "break clear needs the number of a breakpoint, or all".to_owned(),
            column,
        }),
    }
}

fn breakpoints_to_json(set: &[Breakpoint]) -> Vec<Value> {
    set.iter().map(breakpoint_to_json).collect()
}

fn breakpoint_to_json(breakpoint: &Breakpoint) -> Value {
    json!({ "number": breakpoint.number, "condition": breakpoint.condition.to_string() })
}

pub(super) fn condition_state_to_json(condition_state: &ConditionState) -> Value {
    json!({
        "day": condition_state.day, "value": condition_state.value.map(json_number), "before": condition_state.before.map(json_number),
        "true": condition_state.is_true, "true_before": condition_state.was_true,
    })
}

fn condition_history_to_json(condition_history: &ConditionHistory) -> Value {
    json!({
        "condition": condition_history.condition.to_string(),
        "today": condition_state_to_json(&condition_history.today),
        "last_true": condition_history.last_true.as_ref().map(condition_state_to_json),
        "last_false": condition_history.last_false.as_ref().map(condition_state_to_json),
        "since": condition_history.unchanged_since(),
    })
}

pub(super) fn figure_writes_to_json(figure_writes: &FigureWrites) -> Value {
    let write = |write: &FigureWrite| {
        let mut data = json!({
            "by": describe_source(write), "amount": write.amount(), "before": write.before, "after": write.after,
            "asked": write.requested_change(), "count": write.changes.len(), "limited": write.is_limited(),
        });
        if let WriteSource::Reputation(ReputationCause::Spillover(spill)) = write.source {
            data["spill_over"] = json!({
                "source": spill.source.id(), "change": spill.change, "weight": spill.weight, "factor": spill.factor,
            });
        }
        data
    };
    json!({
        "figure": figure_writes.target.to_string(),
        "day": figure_writes.day,
        "first": figure_writes.opening_value,
        "last": figure_writes.closing_value,
        "change": figure_writes.closing_value - figure_writes.opening_value,
        "writes": figure_writes.writes.iter().map(write).collect::<Vec<Value>>(),
    })
}
