//! `answers.csv`: a row for each question that was shown to a participant.

use super::column::{Column, columns};
use super::located_line::{LineRow, LocatedLine, with_location_columns};
use novamind_record::trajectory::Record;
use novamind_record::trajectory::record::{Activity, QuestionAnswer, QuestionShown};
use serde_json::Value;

pub(super) struct ShownQuestion<'a> {
    asked: &'a QuestionShown,
    answer: Option<(&'a LocatedLine<'a>, &'a QuestionAnswer)>,
}

impl ShownQuestion<'_> {
    fn answer_part<T>(&self, part: impl Fn(&QuestionAnswer) -> T) -> Option<T> {
        self.answer.map(|(_, answer)| part(answer))
    }
}

/// Returns the columns of `answers.csv`. The location columns describe the line that shows the question.
pub(super) fn columns<'a>() -> Vec<Column<LineRow<'a, ShownQuestion<'a>>>> {
    with_location_columns(columns! { row: LineRow<'a, ShownQuestion<'a>>;
        "questionnaire", "name", "name of the questionnaire" => row.row.asked.questionnaire;
        "occasion", "text", "occasion of the question: before, week 4, break 1, end" => row.row.asked.occasion;
        "question", "name", "name of the question" => row.row.asked.id;
        "form", "word", "likert, number, choice, text or attention" => row.row.asked.form;
        "shown", "text", "text of the question" => row.row.asked.text;
        "options", "text", "options, one per line" => row.row.asked.options.join("\n");
        "answered", "0 or 1", "1: answered or skipped; 0: the run ends before the answer" => row.row.answer.is_some();
        "value", "text", "answer of the participant; several options one per line; empty if skipped"
            => row.row.answer_part(|answer| format_answer(&answer.value));
        "as_expected", "0 or 1", "attention checks: 1 for the expected answer; empty otherwise"
            => row.row.answer_part(|answer| answer.as_expected);
        "answered_at", "RFC 3339", "time of the answer" => row.row.answer.map(|(placed, _)| &placed.line.at);
        "for_ms", "milliseconds", "time from display to answer" => row.row.answer_part(|answer| answer.for_ms);
        "changes", "count", "number of changes before the answer" => row.row.answer_part(|answer| answer.changes);
    })
}

/// Returns the rows of a run: each question, with the answer from a later line if there is one.
pub(super) fn rows<'a>(lines: &'a [LocatedLine<'a>]) -> impl Iterator<Item = LineRow<'a, ShownQuestion<'a>>> {
    lines.iter().enumerate().filter_map(|(at, placed)| {
        let Record::Activity(Activity::Question(question_shown)) = &placed.line.record else { return None };
        let next = lines[at + 1..].iter().find_map(|later| match &later.line.record {
            Record::Activity(Activity::Answer(answer)) if is_answer_to(answer, question_shown) => {
                Some(Some((later, answer)))
            }
            // If a question is shown again before it is answered, the answer belongs to the later line.
            Record::Activity(Activity::Question(again))
                if again.id == question_shown.id && is_same_question(again, question_shown) =>
            {
                Some(None)
            }
            _ => None,
        });
        Some(LineRow {
            located: placed,
            row: ShownQuestion { asked: question_shown, answer: next.flatten() },
        })
    })
}

fn is_answer_to(answer: &QuestionAnswer, question_shown: &QuestionShown) -> bool {
    (&answer.questionnaire, &answer.occasion, &answer.id)
        == (&question_shown.questionnaire, &question_shown.occasion, &question_shown.id)
}

fn is_same_question(one: &QuestionShown, other: &QuestionShown) -> bool {
    (&one.questionnaire, &one.occasion) == (&other.questionnaire, &other.occasion)
}

/// Formats an answer for a cell. Several options are written one per line.
pub(super) fn format_answer(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        Value::Array(values) => values.iter().map(format_answer).collect::<Vec<_>>().join("\n"),
        other => other.to_string(),
    }
}
