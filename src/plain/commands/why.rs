//! `why FIGURE [WEEK]`: what a figure of a week changed by, and how much of it each cause brought.

use serde_json::{Value, json};

use super::super::answers::Answer;
use super::super::grammar::Problem;
use super::Interpreter;
use crate::database::text::aligned;
use crate::notation::nearest;
use crate::report::why::{equation, heading, lines};
use crate::session::{Causes, Refusal, WeekFigure, Why, unless_stopped};

impl Interpreter {
    pub(super) fn why(&mut self, words: &str) -> Result<Answer, Problem> {
        let (figure, week) = read(words)?;
        let stop = self.watch.enter_stoppable();
        let answer = self.causes().and_then(|causes| causes.why(figure, week, &|_| unless_stopped(&stop)));
        self.watch.enter(super::Phase::Working);
        self.note_look(format!("why {words}").trim_end(), &[]);
        Ok(match answer {
            Ok(Some(why)) => Answer::done("why", as_text(&why), as_data(&why)),
            Ok(None) => {
                Answer::refused("why", Refusal::new("stopped", "stopped before the answer was found"))
            }
            Err(refusal) => Answer::refused("why", refusal),
        })
    }

    fn causes(&mut self) -> Result<&mut Causes, Refusal> {
        let folder = self.session.folder_of_causes()?;
        self.causes_kept.of(folder)
    }
}

/// The figure and the week of a question. Words of a name may be joined by blanks, dashes or underscores.
fn read(words: &str) -> Result<(WeekFigure, Option<u32>), Problem> {
    let problem = |text: String| Problem { text, column: 5 };
    let (name, week) = match words.rsplit_once(char::is_whitespace) {
        Some((name, week)) if week.starts_with(|first: char| first.is_ascii_digit()) => (name, Some(week)),
        _ => (words, None),
    };
    let number = |week: &str| {
        week.parse().map_err(|_| {
            problem(format!("{week} is not the number of a week; for instance: why cancellations 12"))
        })
    };
    let week: Option<u32> = week.map(number).transpose()?;
    let name = name.trim().to_lowercase().replace(['_', '-'], " ");
    let ids = || WeekFigure::ALL.iter().map(|figure| figure.id());
    if name.is_empty() {
        return Err(problem(format!("why needs a figure: {}", ids().collect::<Vec<_>>().join(", "))));
    }
    let found = WeekFigure::named(&name);
    found.map(|figure| (figure, week)).ok_or_else(|| {
        let ids: Vec<String> = ids().collect();
        let near = nearest(&name.replace(' ', "_"), ids.iter().map(String::as_str));
        let help = match near.is_empty() {
            true => format!("the figures are {}", ids.join(", ")),
            false => format!("did you mean {}?", near.join(" or ")),
        };
        problem(format!("there is no figure {name}; {help}"))
    })
}

fn as_text(why: &Why) -> String {
    let row = |line: crate::report::why::CauseLine| {
        vec![line.name.to_owned(), line.written, line.details.join(" · ")]
    };
    let rows: Vec<Vec<String>> = lines(why).into_iter().map(row).collect();
    let table = aligned(&["cause", "share", "what differed"].map(str::to_owned), &rows);
    format!(
        "{}\n{}\n{table}the week was simulated again {} times",
        heading(why),
        equation(why),
        why.simulations
    )
}

fn as_data(why: &Why) -> Value {
    let cause = |line: &crate::report::why::CauseLine| json!({ "cause": line.name, "amount": line.amount, "details": line.details });
    json!({
        "figure": why.figure.id(),
        "week": why.week,
        "before": why.before,
        "after": why.after,
        "change": why.change(),
        "causes": lines(why).iter().map(cause).collect::<Vec<_>>(),
        "simulations": why.simulations,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_question_names_a_figure_and_may_name_a_week() {
        assert_eq!(read("cancellations"), Ok((WeekFigure::Cancellations, None)));
        assert_eq!(read("new subscribers 12"), Ok((WeekFigure::NewSubscribers, Some(12))));
        assert_eq!(read("New_Subscribers  3"), Ok((WeekFigure::NewSubscribers, Some(3))));
        let said = |words| read(words).expect_err("a problem").text;
        assert_eq!(
            said("cancelations"),
            "there is no figure cancelations; did you mean cancellations or conversion?"
        );
        assert!(said("").starts_with("why needs a figure: cash_change, recurring_revenue"));
        assert!(said("quality").starts_with("there is no figure quality; the figures are cash_change"));
        assert!(said("usage 4x").starts_with("4x is not the number of a week"));
        assert!(said("usage 99999999999").starts_with("99999999999 is not the number of a week"));
    }
}
