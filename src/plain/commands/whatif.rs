//! `whatif …`: re-simulates with other decisions (docs/interfaces/plain-mode.md#what-if).

use std::path::Path;

use serde_json::{Value, json};

use super::super::grammar::{Argument, ParseError};
use super::super::response::CommandResponse;
use super::{Interpreter, Phase, argument_error, optional_count};
use novamind_database::text::align_columns;
use novamind_insight::{
    BranchComparison, BranchFigures, DecisionEdit, Futures, RecordedDecision, WhatIf, cause_analysis_folder,
    continue_unless_stopped, create_branch_with_decisions, record_what_if_inspection, related_runs,
};
use novamind_record::trajectory::record::DetachCause;
use novamind_report::whatif::{
    DecisionNotation, branch_line, branch_name, comparison_table, describe_bankruptcies, describe_decisions,
    difference_line, futures_heading, futures_table, heading, related_run_line,
};
use novamind_rules::calls_for_waiting_threads;
use novamind_session::{Interface, Session};
use novamind_tools::Rejection;

/// Default number of simulated futures.
const DEFAULT_FUTURES: u32 = 20;
/// Maximum number of simulated futures.
const MAX_FUTURES: u32 = 200;
/// Maximum size in bytes of a file that contains a what-if question.
const MAX_FILE_BYTES: u64 = 64 << 10;
/// Example command, which is appended to error messages.
const USAGE: &str = "for example: whatif from 2: set_prices * 0.9";

/// A parsed what-if question.
#[derive(Debug, Clone, PartialEq)]
struct WhatIfQuestion {
    from: u32,
    until: Option<u32>,
    futures: Option<u32>,
    alternatives: Vec<Vec<DecisionEdit>>,
}

impl Interpreter {
    /// Executes `whatif WEEK`, `whatif [adopt] from WEEK [until WEEK] [futures [N]]: EDIT; EDIT | EDIT`, and `whatif
    /// file PATH`.
    pub(super) fn execute_what_if(
        &mut self,
        words: &str,
        column: usize,
    ) -> Result<CommandResponse, ParseError> {
        // Check the permission before parsing the question.
        if let Err(rejection) = cause_analysis_folder(&self.session) {
            return Ok(CommandResponse::rejected("whatif", rejection));
        }
        if let Ok(week) = words.parse() {
            return Ok(self.list_decisions(week));
        }
        if let Some(path) = words.strip_prefix("file ") {
            let problem = |text: String| ParseError { text, column: column + "file ".len() };
            let text = self.read_question_file(Path::new(path.trim()));
            let text = text.map_err(|why| problem(format!("{} cannot be read: {why}", path.trim())))?;
            return parse_question(&convert_question_file(&text), 0)
                .map(|question| self.compare_alternatives(&question))
                .map_err(|wrong| problem(wrong.text));
        }
        match words.strip_prefix("adopt ") {
            Some(rest) if rest.trim_start().starts_with("from") => {
                parse_question(rest, column + "adopt ".len())
                    .and_then(|question| self.adopt_alternative(&question, column))
            }
            _ => parse_question(words, column).map(|question| self.compare_alternatives(&question)),
        }
    }

    /// Reads a what-if question from a small regular file. Participants of a study may not use files.
    fn read_question_file(&self, path: &Path) -> Result<String, String> {
        if self.is_participant {
            return Err("in a session of a study, type the question instead".to_owned());
        }
        let found = std::fs::metadata(path).map_err(|error| error.to_string())?;
        if !found.is_file() || found.len() > MAX_FILE_BYTES {
            return Err(format!("the file is not a text file of at most {} KiB", MAX_FILE_BYTES >> 10));
        }
        std::fs::read_to_string(path).map_err(|error| error.to_string())
    }

    fn prepare_what_if(&mut self) -> Result<&mut WhatIf, Rejection> {
        let folder = cause_analysis_folder(&self.session)?;
        self.cached_branches.get_or_open(folder)
    }

    /// Lists the recorded decisions from a week on, with their line numbers in the trajectory.
    fn list_decisions(&mut self, week: u32) -> CommandResponse {
        let calls = self
            .prepare_what_if()
            .and_then(|what_if| Ok((what_if.decisions(week)?, what_if.days_per_week())));
        let (calls, days) = match calls {
            Ok(calls) => calls,
            Err(rejection) => return CommandResponse::rejected("whatif", rejection),
        };
        self.record_view("whatif", &[]);
        let rows = decision_rows(&calls, days);
        let headers = ["line", "week", "decision", "arguments", ""].map(str::to_owned);
        let text = match rows.is_empty() {
            true => format!("no decisions from week {week} on; {USAGE}"),
            false => format!("{}{USAGE}", align_columns(&headers, &rows)),
        };
        let (mut made, mut set) = (Vec::new(), Vec::new());
        for decision in &calls {
            let week = decision.day() / days + 1;
            match decision {
                RecordedDecision::Call(call) => made.push(json!({
                    "line": call.seq, "week": week, "day": call.day, "tool": call.tool.name(), "args": call.args,
                    "ok": call.accepted,
                })),
                RecordedDecision::Parameter { seq, day, key, value, from_day } => set.push(json!({
                    "line": seq, "week": week, "day": day, "key": key, "value": value, "from_day": from_day,
                })),
            }
        }
        CommandResponse::success("whatif", text, json!({ "calls": made, "parameters": set }))
    }

    fn compare_alternatives(&mut self, question: &WhatIfQuestion) -> CommandResponse {
        let stop = self.watch.enter_simulation();
        let go_on = |_, _| continue_unless_stopped(&stop);
        let WhatIfQuestion { from, until, futures, alternatives } = question;
        let is_recorded = record_what_if_inspection(&mut self.session, *from);
        let answer = self.prepare_what_if().and_then(|what_if| {
            what_if.set_shows_hidden(is_recorded);
            let found = what_if.compare_with_futures((*from, *until), alternatives, *futures, &go_on)?;
            Ok(found.map(|(comparison, drawn)| (comparison, drawn, what_if.days_per_week())))
        });
        self.watch.set_phase(Phase::Working);
        self.record_view("whatif", &[]);
        match answer {
            Ok(Some((comparison, futures, days))) => {
                let text = comparison_to_text(&comparison, futures.as_ref(), days);
                CommandResponse::success(
                    "whatif",
                    text,
                    comparison_to_json(&comparison, futures.as_ref(), days),
                )
            }
            Ok(None) => CommandResponse::rejected(
                "whatif",
                Rejection::new("stopped", "stopped before the answer was found"),
            ),
            Err(rejection) => CommandResponse::rejected("whatif", rejection),
        }
    }

    /// Plays the only alternative of a question in a new branch, and continues in this branch.
    fn adopt_alternative(
        &mut self,
        question: &WhatIfQuestion,
        column: usize,
    ) -> Result<CommandResponse, ParseError> {
        if question.futures.is_some() || question.until.is_some() {
            let text =
                "adopt cannot be combined with until or futures, because the branch is always played to the current day of this run"
                    .to_owned();
            return Err(ParseError { text, column });
        }
        let decided = match &question.alternatives[..] {
            [] => Vec::new(),
            [only] => only.clone(),
            _ => {
                let text = "adopt takes one alternative; give only the edits of that alternative".to_owned();
                return Err(ParseError { text, column });
            }
        };
        Ok(self.branch_keeping_decisions(question.from, &decided))
    }

    /// Executes `branch WEEK [keep]`.
    pub(super) fn create_branch(&mut self, arguments: &[Argument]) -> Result<CommandResponse, ParseError> {
        let (last, first) =
            arguments.split_last().map_or((None, arguments), |(last, first)| (Some(last), first));
        let keeps = last.is_some_and(|last| last.key.is_none() && last.value == "keep");
        let week = optional_count(if keeps { first } else { arguments })?.ok_or_else(|| {
            argument_error(arguments, "branch needs the number of a week, for example branch 4")
        })?;
        if keeps {
            return Ok(self.branch_keeping_decisions(week, &[]));
        }
        let mode = self.session.manifest().mode.branch_mode();
        Ok(match self.session.branch(week, mode) {
            Ok(branch) => {
                let (run, day) = self.switch_to_run(branch);
                let text = format!("run {run} continues from day {day} · {mode}");
                CommandResponse::success("branch", text, json!({ "run": run, "day": day, "mode": mode }))
            }
            Err(rejection) => CommandResponse::rejected("branch", rejection),
        })
    }

    /// Creates a branch in which the decisions of this run are replayed with edits, and continues in this
    /// branch.
    fn branch_keeping_decisions(&mut self, week: u32, decided: &[DecisionEdit]) -> CommandResponse {
        let mode = self.session.manifest().mode.branch_mode();
        let stop = self.watch.enter_simulation();
        let mut go_on = |_| continue_unless_stopped(&stop);
        let adopted = create_branch_with_decisions(&self.session, week, decided, mode, &mut go_on);
        self.watch.set_phase(Phase::Working);
        let adopted = match adopted {
            Ok(adopted) => adopted,
            Err(rejection) => return CommandResponse::rejected("branch", rejection),
        };
        let (run, day) = self.switch_to_run(adopted.session);
        let refused: Vec<Value> = adopted
            .rejected
            .iter()
            .map(|(day, what, rejection)| json!({ "day": day, "what": what, "error": rejection }))
            .collect();
        let rejection_lines = adopted
            .rejected
            .iter()
            .map(|(day, what, rejection)| format!("\nday {day}: {what} was rejected: {}", rejection.message));
        let run_state = match self.session.ended() {
            Some(ended) => format!("run {run} ended on day {day}: {}, ", ended.id()),
            None => format!("run {run} is on day {day} "),
        };
        let text = format!(
            "{run_state}with the decisions of its parent · {mode} · {}{}",
            branch_name(decided),
            rejection_lines.collect::<String>()
        );
        CommandResponse::success(
            "branch",
            text,
            json!({ "run": run, "day": day, "mode": mode, "refused": refused }),
        )
    }

    /// Switches the interpreter to another run. Returns the id and the day of the other run.
    pub(super) fn switch_to_run(&mut self, other: Session) -> (String, u32) {
        self.session.activity().detach(DetachCause::Quit);
        let _ = self.session.save();
        self.session = other;
        self.session.set_rule_evaluator(calls_for_waiting_threads);
        self.session.activity().attach(Interface { name: "plain", window: None });
        (self.session.manifest().id.clone(), self.session.day())
    }

    /// Executes `branches`: shows the tree of branches that contains the run.
    pub(super) fn show_branches(&self) -> CommandResponse {
        let id = &self.session.manifest().id;
        let Some(runs) = self.session.folder().and_then(Path::parent) else {
            return CommandResponse::rejected(
                "branches",
                Rejection::new("not_possible", "a run in memory has no branches"),
            );
        };
        let tree = related_runs(runs, id);
        let lines: Vec<String> = tree.iter().map(|related_run| related_run_line(related_run, id)).collect();
        let one = |related: &novamind_insight::RelatedRun| {
            json!({
                "run": related.run.id, "depth": related.depth, "left_in_week": related.branched_in_week,
                "first_change": related.first_change,
                "day": related.run.day, "cash": related.run.cash, "ended": related.run.ended,
            })
        };
        let data: Vec<Value> = tree.iter().map(one).collect();
        CommandResponse::success("branches", lines.join("\n"), json!({ "runs": data }))
    }
}

/// Returns a row for each decision, with line, week, tool or key, arguments or value, and status.
fn decision_rows(decisions: &[RecordedDecision], days: u32) -> Vec<Vec<String>> {
    let row = |recorded_decision: &RecordedDecision| {
        let (what, arguments) = match recorded_decision {
            RecordedDecision::Call(call) => (call.tool.name().to_owned(), call.args.to_string()),
            RecordedDecision::Parameter { key, value, .. } => (format!("set {key}"), value.to_string()),
        };
        vec![
            recorded_decision.seq().to_string(),
            (recorded_decision.day() / days + 1).to_string(),
            what,
            arguments,
            recorded_decision.describe_status(),
        ]
    };
    decisions.iter().map(row).collect()
}

/// Converts the text of a question file to a question in one line. The first line of the file contains the
/// words before the colon, and each later line contains an alternative.
fn convert_question_file(text: &str) -> String {
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    let first = lines.next().unwrap_or_default().trim_end_matches(':');
    format!("{first}: {}", lines.collect::<Vec<_>>().join(" | "))
}

/// Parses a what-if question that begins at a column of the line.
fn parse_question(words: &str, column: usize) -> Result<WhatIfQuestion, ParseError> {
    let problem = |text: String, at: usize| ParseError { text, column: column + words[..at].chars().count() };
    let (head, rest) = words.split_once(':').unwrap_or((words, ""));
    let mut question = WhatIfQuestion { from: 0, until: None, futures: None, alternatives: Vec::new() };
    let mut named = head.split_whitespace().peekable();
    while let Some(word) = named.next() {
        let at = word.as_ptr() as usize - words.as_ptr() as usize;
        if matches!(word, "from" | "until") {
            named.next_if_eq(&"week");
        }
        let number = named.peek().and_then(|next| next.parse::<u32>().ok());
        match (word, number) {
            ("from", Some(week)) => question.from = week,
            ("until", Some(week)) => question.until = Some(week),
            ("futures", Some(count)) if (2..=MAX_FUTURES).contains(&count) => question.futures = Some(count),
            ("futures", Some(_)) => {
                return Err(problem(format!("the number of futures must be 2 to {MAX_FUTURES}"), at));
            }
            ("futures", None) => question.futures = Some(DEFAULT_FUTURES),
            ("from" | "until", None) => {
                return Err(problem(format!("{word} needs a week number; {USAGE}"), at));
            }
            ("adopt", _) => {
                let usage = "for example: whatif adopt from 20: set_prices * 0.9";
                return Err(problem(format!("adopt needs from and a week; {usage}"), at));
            }
            ("file", _) => return Err(problem("whatif file needs the path of a text file".to_owned(), at)),
            _ => return Err(problem(format!("{word} is not understood; {USAGE}"), at)),
        }
        if number.is_some() {
            named.next();
        }
    }
    if question.from == 0 {
        return Err(problem(format!("give the first week; {USAGE}"), 0));
    }
    for alternative in rest.split('|').filter(|alternative| !alternative.trim().is_empty()) {
        let at = alternative.as_ptr() as usize - words.as_ptr() as usize;
        let edits = alternative.split(';').map(str::trim).filter(|edit| !edit.is_empty());
        let edits = edits.map(str::parse).collect::<Result<Vec<DecisionEdit>, String>>();
        question.alternatives.push(edits.map_err(|text| problem(text, at + 1))?);
    }
    Ok(question)
}

fn comparison_to_text(comparison: &BranchComparison, futures: Option<&Futures>, days: u32) -> String {
    let mut text = heading(comparison, days);
    for (number, branch) in comparison.branches.iter().enumerate() {
        let name = branch_name(&branch.edits);
        text += &format!("\n{}", branch_line(comparison, number, &name, days));
        let decisions = describe_decisions(branch, days, DecisionNotation::Calls);
        text.extend(decisions.iter().map(|line| format!("\n     {line}")));
    }
    let (headers, rows) = comparison_table(comparison, days);
    text += &format!("\n\n{}", align_columns(&headers, &rows));
    let Some(futures) = futures else { return text };
    let (headers, rows) = futures_table(comparison, futures, days);
    text += &format!("\n{}\n{}", futures_heading(futures), align_columns(&headers, &rows));
    let early: Vec<String> =
        (0..comparison.branches.len()).filter_map(|at| describe_bankruptcies(futures, at)).collect();
    text += &early.join("\n");
    for number in 1..comparison.branches.len() {
        text += &format!(
            "\n{number}, at the end of week {}, compared with the original run, future by future:",
            comparison.until.div_ceil(days)
        );
        let lines = comparison
            .figures
            .iter()
            .filter_map(|branch_figure| difference_line(comparison, futures, number, *branch_figure));
        text.extend(lines.map(|line| format!("\n     {line}")));
    }
    text
}

fn comparison_to_json(comparison: &BranchComparison, futures: Option<&Futures>, days: u32) -> Value {
    let number = |value: f64| if value.is_nan() { Value::Null } else { json!(value) };
    let branch = |branch_figures: &BranchFigures| {
        let curves = comparison.figures.iter().map(|figure| {
            let values: Vec<Value> =
                branch_figures.values_by_week(*figure).map(|(_, value)| number(value)).collect();
            (figure.id(), Value::Array(values))
        });
        let days_of: Vec<u32> = comparison
            .figures
            .first()
            .map_or(Vec::new(), |one| branch_figures.values_by_week(*one).map(|(day, _)| day).collect());
        json!({
            "name": branch_name(&branch_figures.edits),
            "differs_on": branch_figures.first_different_day,
            "decisions": describe_decisions(branch_figures, days, DecisionNotation::Calls),
            "days": days_of,
            "figures": Value::Object(curves.collect()),
        })
    };
    json!({
        "from": comparison.from,
        "until": comparison.until,
        "recorded_until": comparison.recorded_until,
        "branches": comparison.branches.iter().map(branch).collect::<Vec<_>>(),
        "futures": futures.map(|futures| futures_to_json(comparison, futures)),
    })
}

fn futures_to_json(comparison: &BranchComparison, futures: &Futures) -> Value {
    let branch = |at: usize| {
        let figures = comparison.figures.iter().map(|figure| {
            let bands: Vec<Value> = futures
                .intervals(at, *figure)
                .map(|(day, band)| json!({ "day": day, "low": band.low, "median": band.median, "high": band.high }))
                .collect();
            let difference = futures.difference(at, *figure, comparison.until).map(|paired_difference| {
                let interval = paired_difference.interval.map(|bounds| [bounds.low, bounds.high]);
                json!({ "mean": paired_difference.mean, "interval": interval, "more": paired_difference.first_greater, "of": paired_difference.pair_count })
            });
            (figure.id(), json!({ "bands": bands, "difference_at_the_end": difference }))
        });
        Value::Object(figures.collect())
    };
    json!({
        "count": futures.count,
        "redrawn_after": futures.redrawn_after,
        "branches": (0..comparison.branches.len()).map(branch).collect::<Vec<_>>(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parse_question_reads_weeks_futures_and_alternatives() {
        let edit = |text: &str| text.parse::<DecisionEdit>().expect(text);
        let asked = parse_question("from 20 until 40 futures: set_prices * 0.9; drop 7 | keep set_prices", 1);
        let expected = WhatIfQuestion {
            from: 20,
            until: Some(40),
            futures: Some(DEFAULT_FUTURES),
            alternatives: vec![vec![edit("set_prices * 0.9"), edit("drop 7")], vec![edit("keep set_prices")]],
        };
        assert_eq!(asked, Ok(expected.clone()));
        let file = "# cheaper\nfrom 20 until 40 futures:\nset_prices * 0.9; drop 7\n\nkeep set_prices\n";
        assert_eq!(parse_question(&convert_question_file(file), 1), Ok(expected));
        assert_eq!(parse_question("from 3", 1).map(|if_question| if_question.alternatives), Ok(Vec::new()));
    }

    #[test]
    fn parse_question_errors_name_the_column() {
        let parse_error = |words: &str| parse_question(words, 8).expect_err(words);
        assert_eq!(parse_error("").column, 8);
        assert!(parse_error("from: set_prices * 2").text.starts_with("from needs a week number"));
        let wrong = parse_error("from 20 to 30: drop 1");
        assert_eq!((wrong.column, wrong.text.starts_with("to is not understood")), (16, true));
        assert!(parse_error("adopt 5").text.starts_with("adopt needs from and a week"));
        assert!(parse_error("file").text.starts_with("whatif file needs the path"));
        assert_eq!(parse_question("from week 3", 1).map(|if_question| if_question.from), Ok(3));
        assert!(parse_error("from 20 futures 1: drop 1").text.starts_with("the number of futures"));
        let wrong = parse_error("from 20: set_price * 2");
        assert_eq!((wrong.column, wrong.text.contains("did you mean set_prices")), (17, true));
    }
}
