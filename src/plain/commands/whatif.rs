//! `whatif …`: re-simulates with other decisions (docs/interfaces/plain-mode.md#what-if).

use std::path::Path;

use serde_json::{Value, json};

use super::super::answers::Answer;
use super::super::grammar::{Argument, Problem};
use super::{Interpreter, Phase, count, problem};
use novamind_database::text::aligned;
use novamind_insight::{
    BranchComparison, BranchFigures, DecisionEdit, Futures, PastDecision, WhatIf, branch_with_decisions,
    branches_of, folder_of_causes, look_at_what_if, unless_stopped,
};
use novamind_record::trajectory::record::LeavingCause;
use novamind_report::whatif::{
    bankrupt, branch_line, decisions, difference_line, futures_heading, futures_table, heading, kin_line,
    name, table,
};
use novamind_rules::answers_to_companies;
use novamind_session::{Interface, Session};
use novamind_tools::Refusal;

/// Default number of futures.
const FUTURES: u32 = 20;
/// Maximum number of futures.
const MOST_FUTURES: u32 = 200;
/// Maximum size of a file with a question, in bytes.
const LARGEST_FILE: u64 = 64 << 10;
/// Example in error messages.
const USAGE: &str = "for example: whatif from 2: set_prices * 0.9";

/// A parsed question.
#[derive(Debug, Clone, PartialEq)]
struct Question {
    from: u32,
    until: Option<u32>,
    futures: Option<u32>,
    alternatives: Vec<Vec<DecisionEdit>>,
}

impl Interpreter {
    /// `whatif WEEK`, `whatif [adopt] from WEEK [until WEEK] [futures [N]]: EDIT; EDIT | EDIT`, `whatif file PATH`.
    pub(super) fn what_if(&mut self, words: &str, column: usize) -> Result<Answer, Problem> {
        // Check the permission before parsing anything.
        if let Err(refusal) = folder_of_causes(&self.session) {
            return Ok(Answer::refused("whatif", refusal));
        }
        if let Ok(week) = words.parse() {
            return Ok(self.decisions_from(week));
        }
        if let Some(path) = words.strip_prefix("file ") {
            let problem = |text: String| Problem { text, column: column + "file ".len() };
            let text = self.question_in(Path::new(path.trim()));
            let text = text.map_err(|why| problem(format!("{} cannot be read: {why}", path.trim())))?;
            return read(&as_question(&text), 0)
                .map(|question| self.compare(&question))
                .map_err(|wrong| problem(wrong.text));
        }
        match words.strip_prefix("adopt ") {
            Some(rest) if rest.trim_start().starts_with("from") => {
                read(rest, column + "adopt ".len()).and_then(|question| self.adopt(&question, column))
            }
            _ => read(words, column).map(|question| self.compare(&question)),
        }
    }

    /// Reads a file with a question. Participants of a study may not use files; others need a small regular file.
    fn question_in(&self, path: &Path) -> Result<String, String> {
        if self.leads_participant {
            return Err("in a session of a study, type the question instead".to_owned());
        }
        let found = std::fs::metadata(path).map_err(|error| error.to_string())?;
        if !found.is_file() || found.len() > LARGEST_FILE {
            return Err(format!("it is not a text file of at most {} KiB", LARGEST_FILE >> 10));
        }
        std::fs::read_to_string(path).map_err(|error| error.to_string())
    }

    fn what_if_of_run(&mut self) -> Result<&mut WhatIf, Refusal> {
        let folder = folder_of_causes(&self.session)?;
        self.branches_kept.of(folder)
    }

    /// Lists the calls from a week on, with their line numbers.
    fn decisions_from(&mut self, week: u32) -> Answer {
        let calls = self.what_if_of_run().and_then(|own| Ok((own.decisions(week)?, own.days_per_week())));
        let (calls, days) = match calls {
            Ok(calls) => calls,
            Err(refusal) => return Answer::refused("whatif", refusal),
        };
        self.note_look("whatif", &[]);
        let rows = decision_rows(&calls, days);
        let headers = ["line", "week", "decision", "arguments", ""].map(str::to_owned);
        let text = match rows.is_empty() {
            true => format!("no decisions from week {week} on; {USAGE}"),
            false => format!("{}{USAGE}", aligned(&headers, &rows)),
        };
        let (mut made, mut set) = (Vec::new(), Vec::new());
        for decision in &calls {
            let week = decision.day() / days + 1;
            match decision {
                PastDecision::Call(call) => made.push(json!({
                    "line": call.seq, "week": week, "day": call.day, "tool": call.tool.name(), "args": call.args,
                    "ok": call.accepted,
                })),
                PastDecision::Parameter { seq, day, key, value, from_day } => set.push(json!({
                    "line": seq, "week": week, "day": day, "key": key, "value": value, "from_day": from_day,
                })),
            }
        }
        Answer::done("whatif", text, json!({ "calls": made, "parameters": set }))
    }

    fn compare(&mut self, question: &Question) -> Answer {
        let stop = self.watch.enter_stoppable();
        let go_on = |_, _| unless_stopped(&stop);
        let Question { from, until, futures, alternatives } = question;
        let is_recorded = look_at_what_if(&mut self.session, *from);
        let answer = self.what_if_of_run().and_then(|own| {
            own.tell_hidden(is_recorded);
            let found = own.answer((*from, *until), alternatives, *futures, &go_on)?;
            Ok(found.map(|(comparison, drawn)| (comparison, drawn, own.days_per_week())))
        });
        self.watch.enter(Phase::Working);
        self.note_look("whatif", &[]);
        match answer {
            Ok(Some((comparison, futures, days))) => {
                let text = as_text(&comparison, futures.as_ref(), days);
                Answer::done("whatif", text, as_data(&comparison, futures.as_ref(), days))
            }
            Ok(None) => {
                Answer::refused("whatif", Refusal::new("stopped", "stopped before the answer was found"))
            }
            Err(refusal) => Answer::refused("whatif", refusal),
        }
    }

    /// Plays the only alternative of a question in a new branch and continues in it.
    fn adopt(&mut self, question: &Question, column: usize) -> Result<Answer, Problem> {
        if question.futures.is_some() || question.until.is_some() {
            let text =
                "adopt cannot be combined with until or futures: the branch is played to the day of this run"
                    .to_owned();
            return Err(Problem { text, column });
        }
        let decided = match &question.alternatives[..] {
            [] => Vec::new(),
            [only] => only.clone(),
            _ => {
                let text = "adopt takes one alternative; give only its edits".to_owned();
                return Err(Problem { text, column });
            }
        };
        Ok(self.branch_keeping(question.from, &decided))
    }

    /// `branch WEEK [keep]`
    pub(super) fn branch(&mut self, arguments: &[Argument]) -> Result<Answer, Problem> {
        let (last, first) =
            arguments.split_last().map_or((None, arguments), |(last, first)| (Some(last), first));
        let keeps = last.is_some_and(|last| last.key.is_none() && last.value == "keep");
        let week = count(if keeps { first } else { arguments })?
            .ok_or_else(|| problem(arguments, "branch needs the number of a week, for example branch 4"))?;
        if keeps {
            return Ok(self.branch_keeping(week, &[]));
        }
        let mode = self.session.manifest().mode.of_branch();
        Ok(match self.session.branch(week, mode) {
            Ok(branch) => {
                let (run, day) = self.go_on_in(branch);
                let text = format!("run {run} continues from day {day} · {mode}");
                Answer::done("branch", text, json!({ "run": run, "day": day, "mode": mode }))
            }
            Err(refusal) => Answer::refused("branch", refusal),
        })
    }

    /// Continues in a branch with the decisions of this run and some edits.
    fn branch_keeping(&mut self, week: u32, decided: &[DecisionEdit]) -> Answer {
        let mode = self.session.manifest().mode.of_branch();
        let stop = self.watch.enter_stoppable();
        let mut go_on = |_| unless_stopped(&stop);
        let adopted = branch_with_decisions(&self.session, week, decided, mode, &mut go_on);
        self.watch.enter(Phase::Working);
        let adopted = match adopted {
            Ok(adopted) => adopted,
            Err(refusal) => return Answer::refused("branch", refusal),
        };
        let (run, day) = self.go_on_in(adopted.session);
        let refused: Vec<Value> = adopted
            .refused
            .iter()
            .map(|(day, what, refusal)| json!({ "day": day, "what": what, "error": refusal }))
            .collect();
        let told = adopted
            .refused
            .iter()
            .map(|(day, what, refusal)| format!("\nday {day}: {what} was rejected: {}", refusal.message));
        let stands = match self.session.ended() {
            Some(ended) => format!("run {run} ended on day {day}: {}, ", ended.id()),
            None => format!("run {run} is on day {day} "),
        };
        let text = format!(
            "{stands}with the decisions of its parent · {mode} · {}{}",
            name(decided),
            told.collect::<String>()
        );
        Answer::done("branch", text, json!({ "run": run, "day": day, "mode": mode, "refused": refused }))
    }

    /// Leaves this run for another one. Returns the id and the day of that run.
    pub(super) fn go_on_in(&mut self, other: Session) -> (String, u32) {
        self.session.activity().leave(LeavingCause::Quit);
        let _ = self.session.save();
        self.session = other;
        self.session.answer_companies_by(answers_to_companies);
        self.session.activity().take_up(Interface { name: "plain", window: None });
        (self.session.manifest().id.clone(), self.session.day())
    }

    /// `branches`: the tree of branches that contains the run.
    pub(super) fn branches(&self) -> Answer {
        let id = &self.session.manifest().id;
        let Some(runs) = self.session.folder().and_then(Path::parent) else {
            return Answer::refused(
                "branches",
                Refusal::new("not_possible", "a run in memory has no branches"),
            );
        };
        let tree = branches_of(runs, id);
        let lines: Vec<String> = tree.iter().map(|kin| kin_line(kin, id)).collect();
        let one = |kin: &novamind_insight::Kin| {
            json!({
                "run": kin.run.id, "depth": kin.depth, "left_in_week": kin.left_in_week,
                "first_change": kin.first_change,
                "day": kin.run.day, "cash": kin.run.cash, "ended": kin.run.ended,
            })
        };
        let data: Vec<Value> = tree.iter().map(one).collect();
        Answer::done("branches", lines.join("\n"), json!({ "runs": data }))
    }
}

/// Returns a row for each decision: line, week, tool or key, arguments or value, and whether it was rejected.
fn decision_rows(decisions: &[PastDecision], days: u32) -> Vec<Vec<String>> {
    let row = |own: &PastDecision| {
        let (what, arguments) = match own {
            PastDecision::Call(call) => (call.tool.name().to_owned(), call.args.to_string()),
            PastDecision::Parameter { key, value, .. } => (format!("set {key}"), value.to_string()),
        };
        vec![own.seq().to_string(), (own.day() / days + 1).to_string(), what, arguments, own.remark()]
    };
    decisions.iter().map(row).collect()
}

/// Converts a file, which holds the words before the colon in its first line and an alternative in each of the others.
fn as_question(text: &str) -> String {
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    let first = lines.next().unwrap_or_default().trim_end_matches(':');
    format!("{first}: {}", lines.collect::<Vec<_>>().join(" | "))
}

/// Parses a question that begins at a column.
fn read(words: &str, column: usize) -> Result<Question, Problem> {
    let problem = |text: String, at: usize| Problem { text, column: column + words[..at].chars().count() };
    let (head, rest) = words.split_once(':').unwrap_or((words, ""));
    let mut question = Question { from: 0, until: None, futures: None, alternatives: Vec::new() };
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
            ("futures", Some(count)) if (2..=MOST_FUTURES).contains(&count) => question.futures = Some(count),
            ("futures", Some(_)) => {
                return Err(problem(format!("the number of futures must be 2 to {MOST_FUTURES}"), at));
            }
            ("futures", None) => question.futures = Some(FUTURES),
            ("from" | "until", None) => {
                return Err(problem(format!("{word} needs a week number; {USAGE}"), at));
            }
            ("adopt", _) => {
                let usage = "for example: whatif adopt from 20: set_prices * 0.9";
                return Err(problem(format!("adopt needs from and a week; {usage}"), at));
            }
            ("file", _) => return Err(problem("file needs the path of a text file".to_owned(), at)),
            _ => return Err(problem(format!("{word} is not understood; {USAGE}"), at)),
        }
        if number.is_some() {
            named.next();
        }
    }
    if question.from == 0 {
        return Err(problem(format!("give the first week; {USAGE}"), 0));
    }
    for alternative in rest.split('|').filter(|own| !own.trim().is_empty()) {
        let at = alternative.as_ptr() as usize - words.as_ptr() as usize;
        let edits = alternative.split(';').map(str::trim).filter(|edit| !edit.is_empty());
        let edits = edits.map(str::parse).collect::<Result<Vec<DecisionEdit>, String>>();
        question.alternatives.push(edits.map_err(|text| problem(text, at + 1))?);
    }
    Ok(question)
}

fn as_text(comparison: &BranchComparison, futures: Option<&Futures>, days: u32) -> String {
    let mut text = heading(comparison, days);
    for (number, branch) in comparison.branches.iter().enumerate() {
        text += &format!("\n{}", branch_line(number, branch));
        text.extend(decisions(branch, days).iter().map(|line| format!("\n     {line}")));
    }
    let (headers, rows) = table(comparison, days);
    text += &format!("\n\n{}", aligned(&headers, &rows));
    let Some(futures) = futures else { return text };
    let (headers, rows) = futures_table(comparison, futures, days);
    text += &format!("\n{}\n{}", futures_heading(futures), aligned(&headers, &rows));
    let early: Vec<String> = (0..comparison.branches.len()).filter_map(|at| bankrupt(futures, at)).collect();
    text += &early.join("\n");
    for number in 1..comparison.branches.len() {
        text += &format!(
            "\n{number}, at the end of week {}, compared with the original run, future by future:",
            comparison.until.div_ceil(days)
        );
        let lines =
            comparison.figures.iter().filter_map(|own| difference_line(comparison, futures, number, *own));
        text.extend(lines.map(|line| format!("\n     {line}")));
    }
    text
}

fn as_data(comparison: &BranchComparison, futures: Option<&Futures>, days: u32) -> Value {
    let number = |value: f64| if value.is_nan() { Value::Null } else { json!(value) };
    let branch = |own: &BranchFigures| {
        let curves = comparison.figures.iter().map(|figure| {
            let values: Vec<Value> = own.curve(*figure).map(|(_, value)| number(value)).collect();
            (figure.id(), Value::Array(values))
        });
        let days_of: Vec<u32> = comparison
            .figures
            .first()
            .map_or(Vec::new(), |one| own.curve(*one).map(|(day, _)| day).collect());
        json!({
            "name": name(&own.edits),
            "differs_on": own.differs_on,
            "decisions": decisions(own, days),
            "days": days_of,
            "figures": Value::Object(curves.collect()),
        })
    };
    json!({
        "from": comparison.from,
        "until": comparison.until,
        "recorded_until": comparison.recorded_until,
        "branches": comparison.branches.iter().map(branch).collect::<Vec<_>>(),
        "futures": futures.map(|futures| futures_as_data(comparison, futures)),
    })
}

fn futures_as_data(comparison: &BranchComparison, futures: &Futures) -> Value {
    let branch = |at: usize| {
        let figures = comparison.figures.iter().map(|figure| {
            let bands: Vec<Value> = futures
                .bands(at, *figure)
                .map(|(day, band)| json!({ "day": day, "low": band.low, "median": band.median, "high": band.high }))
                .collect();
            let difference = futures.difference(at, *figure, comparison.until).map(|own| {
                let interval = own.interval.map(|own| [own.low, own.high]);
                json!({ "mean": own.mean, "interval": interval, "more": own.more, "of": own.of })
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
    fn a_question_names_weeks_futures_and_alternatives() {
        let edit = |text: &str| text.parse::<DecisionEdit>().expect(text);
        let asked = read("from 20 until 40 futures: set_prices * 0.9; drop 7 | keep set_prices", 1);
        let expected = Question {
            from: 20,
            until: Some(40),
            futures: Some(FUTURES),
            alternatives: vec![vec![edit("set_prices * 0.9"), edit("drop 7")], vec![edit("keep set_prices")]],
        };
        assert_eq!(asked, Ok(expected.clone()));
        let file = "# cheaper\nfrom 20 until 40 futures:\nset_prices * 0.9; drop 7\n\nkeep set_prices\n";
        assert_eq!(read(&as_question(file), 1), Ok(expected));
        assert_eq!(read("from 3", 1).map(|own| own.alternatives), Ok(Vec::new()));
    }

    #[test]
    fn what_is_no_question_is_refused_where_it_goes_wrong() {
        let said = |words: &str| read(words, 8).expect_err(words);
        assert_eq!(said("").column, 8);
        assert!(said("from: set_prices * 2").text.starts_with("from needs a week number"));
        let wrong = said("from 20 to 30: drop 1");
        assert_eq!((wrong.column, wrong.text.starts_with("to is not understood")), (16, true));
        assert!(said("adopt 5").text.starts_with("adopt needs from and a week"));
        assert!(said("file").text.starts_with("file needs"));
        assert_eq!(read("from week 3", 1).map(|own| own.from), Ok(3));
        assert!(said("from 20 futures 1: drop 1").text.starts_with("the number of futures"));
        let wrong = said("from 20: set_price * 2");
        assert_eq!((wrong.column, wrong.text.contains("did you mean set_prices")), (17, true));
    }
}
