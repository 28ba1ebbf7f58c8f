//! `break`, `run`, `since`, `find` and `who`: breakpoints, conditions over time, and what changed a figure (docs/debugging.md).

use serde_json::{Value, json};

use super::super::answers::Answer;
use super::super::grammar::Problem;
use super::Interpreter;
use novamind_base::notation::json_number;
use novamind_insight::{
    Breakpoint, Condition, ConditionProblem, Inspect, Judged, LookBack, WhoWrites, Write, WrittenBy,
};
use novamind_report::xray::{
    AskedWords, breakpoints_in_words, look_back_in_words, stop_in_words, written_by,
};
use novamind_session::ReputationCause;

impl Interpreter {
    /// `break`, `break CONDITION`, `break clear N|all`. `column` is where the rest begins.
    pub(super) fn breakpoint(&mut self, rest: &str, column: usize) -> Result<Answer, Problem> {
        if let Err(refusal) = self.session.refuse_to_look_inside() {
            return Ok(Answer::refused("break", refusal));
        }
        let rest = without_comment(rest);
        let shown = match rest.split_once(char::is_whitespace).unwrap_or((rest, "")) {
            ("", _) => self.session.inspect().breakpoints().map(|set| {
                let data = json!({ "breakpoints": as_list(&set) });
                Answer::done("break", breakpoints_in_words(&set).join("\n"), data)
            }),
            ("clear", which) => {
                let removed =
                    self.session.inspect().clear_breakpoints(number_or_all(which.trim(), column + 6)?);
                removed.map(|removed| {
                    let lines: Vec<String> = removed
                        .iter()
                        .map(|own| format!("removed {}  {}", own.number, own.condition))
                        .collect();
                    let text =
                        if lines.is_empty() { "no breakpoint was set".to_owned() } else { lines.join("\n") };
                    Answer::done("break", text, json!({ "removed": as_list(&removed) }))
                })
            }
            _ => {
                let set = self.session.inspect().set_breakpoint(condition(rest, column)?);
                set.map(|own| {
                    let next = match self.session.ended() {
                        None => "run DAYS stops there".to_owned(),
                        Some(_) => format!("since {} shows since when it is true or false", own.number),
                    };
                    let text = format!("breakpoint {}: {}; {next}", own.number, own.condition);
                    Answer::done("break", text, as_data(&own))
                })
            }
        };
        Ok(shown.unwrap_or_else(|refusal| Answer::refused("break", refusal)))
    }

    /// `run DAYS`, `run DAYS until CONDITION`, which sets the condition as `break` does.
    pub(super) fn run_days(&mut self, rest: &str, column: usize) -> Result<Answer, Problem> {
        if let Err(refusal) = self.session.refuse_to_look_inside() {
            return Ok(Answer::refused("run", refusal));
        }
        let (number, until) =
            without_comment(rest).split_once("until").unwrap_or((without_comment(rest), ""));
        let days = number.trim().parse().ok().filter(|days| *days > 0).ok_or_else(|| Problem {
            text: "run needs a number of days, for example run 28".to_owned(),
            column,
        })?;
        if number.len() < without_comment(rest).len() {
            let begins = column + number.chars().count() + "until".len();
            let condition = condition(until, begins)?;
            if let Err(refusal) = self.session.inspect().set_breakpoint(condition) {
                return Ok(Answer::refused("run", refusal));
            }
        }
        let set = self.session.inspect().breakpoints().map_or(0, |set| set.len());
        let run = self.session.inspect().run_until_breakpoint(days, &mut |_| {});
        Ok(match run {
            Ok(run) => {
                let day = self.session.day();
                let mut data = run.week.as_json();
                data["from"] = run.from.into();
                let hit = |condition: &Condition, number: u32, judged: &Judged| {
                    let mut hit = judged_as_data(judged);
                    hit["number"] = number.into();
                    hit["condition"] = condition.to_string().into();
                    hit
                };
                let hits = run
                    .hits
                    .iter()
                    .map(|own| hit(&own.breakpoint.condition, own.breakpoint.number, &own.judged));
                data["stopped_by"] = hits.collect();
                let told = super::next::report("run", &self.session, &run.week).as_text();
                let text = format!("{told}{}", stop_in_words(&run, day, set).join("\n"));
                Answer::done("run", text, data)
            }
            Err(refusal) => Answer::refused("run", refusal),
        })
    }

    /// `since`, `since N`, `since CONDITION`
    pub(super) fn back(&mut self, word: &str, rest: &str, column: usize) -> Result<Answer, Problem> {
        if let Err(refusal) = self.session.refuse_to_look_inside() {
            return Ok(Answer::refused(word, refusal));
        }
        let rest = without_comment(rest);
        let found = match (rest, rest.parse::<u32>()) {
            ("", _) => self.session.inspect().look_back_from(None),
            (_, Ok(number)) => self.session.inspect().look_back_from(Some(number)),
            _ => self.session.inspect().look_back(condition(rest, column)?).map(|own| vec![own]),
        };
        Ok(match found {
            Ok(found) if found.is_empty() => {
                return Err(Problem {
                    text: "no breakpoint is set; give a condition, for example since churn(S1) > 0.05 over 7"
                        .to_owned(),
                    column,
                });
            }
            Ok(found) => {
                let lines: Vec<String> = found.iter().flat_map(look_back_in_words).collect();
                let data: Vec<Value> = found.iter().map(look_back_as_data).collect();
                Answer::done(word, lines.join("\n"), json!({ "conditions": data }))
            }
            Err(refusal) => Answer::refused(word, refusal),
        })
    }

    /// `find CONDITION`
    pub(super) fn find_days(&mut self, rest: &str, column: usize) -> Result<Answer, Problem> {
        self.ask_words("find", || AskedWords::find(rest, column))
    }

    /// `who FIGURE [DAY]`
    pub(super) fn who(&mut self, rest: &str, column: usize) -> Result<Answer, Problem> {
        self.ask_words("who", || AskedWords::who(rest, column))
    }
}

fn without_comment(text: &str) -> &str {
    text.split('#').next().unwrap_or_default().trim()
}

fn condition(text: &str, column: usize) -> Result<Condition, Problem> {
    text.parse().map_err(|problem| at(problem, column))
}

/// Shifts a problem in the rest of a line to the columns of the line.
fn at(problem: ConditionProblem, column: usize) -> Problem {
    Problem { text: problem.message, column: column + problem.column - 1 }
}

/// Parses the number of a breakpoint. Returns `None` for all of them.
fn number_or_all(word: &str, column: usize) -> Result<Option<u32>, Problem> {
    match (word, word.parse()) {
        ("all", _) => Ok(None),
        (_, Ok(number)) => Ok(Some(number)),
        _ => Err(Problem { text: "break clear needs the number of a breakpoint, or all".to_owned(), column }),
    }
}

fn as_list(set: &[Breakpoint]) -> Vec<Value> {
    set.iter().map(as_data).collect()
}

fn as_data(own: &Breakpoint) -> Value {
    json!({ "number": own.number, "condition": own.condition.to_string() })
}

pub(super) fn judged_as_data(own: &Judged) -> Value {
    json!({
        "day": own.day, "value": own.value.map(json_number), "before": own.before.map(json_number),
        "true": own.is_true, "true_before": own.was_true,
    })
}

fn look_back_as_data(own: &LookBack) -> Value {
    json!({
        "condition": own.condition.to_string(),
        "today": judged_as_data(&own.today),
        "last_true": own.last_true.as_ref().map(judged_as_data),
        "last_false": own.last_false.as_ref().map(judged_as_data),
        "since": own.since(),
    })
}

pub(super) fn writes_as_data(own: &WhoWrites) -> Value {
    let write = |write: &Write| {
        let mut data = json!({
            "by": written_by(write), "amount": write.amount(), "before": write.before, "after": write.after,
            "asked": write.asked(), "count": write.changes.len(), "limited": write.is_limited(),
        });
        if let WrittenBy::Reputation(ReputationCause::SpillOver(spill)) = write.by {
            data["spill_over"] = json!({
                "source": spill.source.id(), "change": spill.change, "weight": spill.weight, "factor": spill.factor,
            });
        }
        data
    };
    json!({
        "figure": own.target.to_string(),
        "day": own.day,
        "first": own.first,
        "last": own.last,
        "change": own.last - own.first,
        "writes": own.writes.iter().map(write).collect::<Vec<Value>>(),
    })
}
