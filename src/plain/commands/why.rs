//! `why FIGURE [WEEK]`: the change of a figure in a week, and the contribution of each cause.

use serde_json::{Value, json};

use super::super::answers::Answer;
use super::super::grammar::Problem;
use super::Interpreter;
use novamind_database::text::aligned;
use novamind_insight::{ConditionProblem, WeekQuestion, Why, begin_why, folder_of_causes, unless_stopped};
use novamind_report::why::{equation, heading, lines};
use novamind_session::identifiers::Group;
use novamind_tools::Refusal;

impl Interpreter {
    pub(super) fn why(&mut self, words: &str, column: usize) -> Result<Answer, Problem> {
        if let Err(refusal) = folder_of_causes(&self.session) {
            return Ok(Answer::refused("why", refusal));
        }
        let asked: WeekQuestion = words.parse().map_err(|problem: ConditionProblem| Problem {
            text: problem.message,
            column: column + problem.column - 1,
        })?;
        self.note_look(&format!("why {words}"), &[]);
        let stop = self.watch.enter_stoppable();
        let folder = begin_why(&mut self.session, &asked);
        let answer =
            folder.and_then(|folder| self.causes_kept.of(folder)?.why(asked, &|_| unless_stopped(&stop)));
        self.watch.enter(super::Phase::Working);
        Ok(match answer {
            Ok(Some(why)) => Answer::done("why", as_text(&why), as_data(&why)),
            Ok(None) => {
                Answer::refused("why", Refusal::new("stopped", "stopped before the answer was found"))
            }
            Err(refusal) => Answer::refused("why", refusal),
        })
    }
}

fn as_text(why: &Why) -> String {
    let row = |line: novamind_report::why::CauseLine| {
        vec![line.name.to_owned(), line.written, line.details.join(" · ")]
    };
    let rows: Vec<Vec<String>> = lines(why).into_iter().map(row).collect();
    let table = aligned(&["cause", "share", "what differed"].map(str::to_owned), &rows);
    format!(
        "{}\n{}\n{table}the week was simulated {} more times",
        heading(why),
        equation(why),
        why.simulations
    )
}

fn as_data(why: &Why) -> Value {
    let cause = |line: &novamind_report::why::CauseLine| json!({ "cause": line.name, "amount": line.amount, "details": line.details });
    json!({
        "figure": why.quantity.figure().id(),
        "group": why.quantity.group().map(Group::id),
        "week": why.week,
        "before": why.before,
        "after": why.after,
        "change": why.change(),
        "causes": lines(why).iter().map(cause).collect::<Vec<_>>(),
        "simulations": why.simulations,
    })
}
