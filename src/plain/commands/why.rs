//! `why FIGURE [WEEK]`: shows the change of a figure in a week and the contribution of each cause.

use serde_json::{Value, json};

use super::super::grammar::ParseError;
use super::super::response::CommandResponse;
use super::Interpreter;
use novamind_database::text::align_columns;
use novamind_insight::{
    ChangeExplanation, ConditionParseError, WeekQuestion, begin_cause_analysis, cause_analysis_folder,
    continue_unless_stopped,
};
use novamind_report::why::{cause_lines, equation, heading};
use novamind_session::identifiers::Group;
use novamind_tools::Rejection;

impl Interpreter {
    pub(super) fn run_why(&mut self, words: &str, column: usize) -> Result<CommandResponse, ParseError> {
        if let Err(rejection) = cause_analysis_folder(&self.session) {
            return Ok(CommandResponse::rejected("why", rejection));
        }
        let week_question: WeekQuestion = words.parse().map_err(|problem: ConditionParseError| {
            ParseError { text: problem.message, column: column + problem.column - 1 }
        })?;
        self.record_view(&format!("why {words}"), &[]);
        let stop = self.watch.enter_simulation();
        let folder = begin_cause_analysis(&mut self.session, &week_question);
        let answer = folder.and_then(|folder| {
            self.cached_causes
                .get_or_open(folder)?
                .explain(week_question, &|_| continue_unless_stopped(&stop))
        });
        self.watch.set_phase(super::Phase::Working);
        Ok(match answer {
            Ok(Some(why)) => CommandResponse::success("why", why_to_text(&why), why_to_json(&why)),
            Ok(None) => CommandResponse::rejected(
                "why",
                Rejection::new("stopped", "stopped before the answer was found"),
            ),
            Err(rejection) => CommandResponse::rejected("why", rejection),
        })
    }
}

fn why_to_text(why: &ChangeExplanation) -> String {
    let row = |line: novamind_report::why::CauseLine| {
        vec![line.name.to_owned(), line.amount_text, line.details.join(" · ")]
    };
    let rows: Vec<Vec<String>> = cause_lines(why).into_iter().map(row).collect();
    let table = align_columns(&["cause", "share", "difference"].map(str::to_owned), &rows);
    format!(
        "{}\n{}\n{table}the week was simulated {} more times",
        heading(why),
        equation(why),
        why.simulation_count
    )
}

fn why_to_json(why: &ChangeExplanation) -> Value {
    let cause = |line: &novamind_report::why::CauseLine| json!({ "cause": line.name, "amount": line.amount, "details": line.details });
    json!({
        "figure": why.quantity.figure().id(),
        "group": why.quantity.group().map(Group::id),
        "week": why.week,
        "before": why.before,
        "after": why.after,
        "change": why.total_change(),
        "causes": cause_lines(why).iter().map(cause).collect::<Vec<_>>(),
        "simulations": why.simulation_count,
    })
}
