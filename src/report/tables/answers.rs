//! `answers.csv`: a row for each question of the study that was shown.

use super::column::{Column, columns};
use super::place::{LineRow, Placed, with_place};
use novamind_record::trajectory::Record;
use novamind_record::trajectory::record::{Activity, Answered, Asked};
use serde_json::Value;

pub(super) struct ShownQuestion<'a> {
    asked: &'a Asked,
    answer: Option<(&'a Placed<'a>, &'a Answered)>,
}

impl ShownQuestion<'_> {
    fn answered<T>(&self, part: impl Fn(&Answered) -> T) -> Option<T> {
        self.answer.map(|(_, answer)| part(answer))
    }
}

/// Returns the columns. The place columns are those of the question.
pub(super) fn columns<'a>() -> Vec<Column<LineRow<'a, ShownQuestion<'a>>>> {
    with_place(columns! { row: LineRow<'a, ShownQuestion<'a>>;
        "questionnaire", "name", "name of the questionnaire" => row.own.asked.questionnaire;
        "occasion", "text", "occasion of the question: before, week 4, break 1, end" => row.own.asked.occasion;
        "question", "name", "name of the question" => row.own.asked.id;
        "form", "word", "likert, number, choice, text or attention" => row.own.asked.form;
        "shown", "text", "text of the question" => row.own.asked.text;
        "options", "text", "options, one per line" => row.own.asked.options.join("\n");
        "answered", "0 or 1", "1: answered or skipped; 0: the run ends before the answer" => row.own.answer.is_some();
        "value", "text", "the answer; several options one per line; empty if skipped"
            => row.own.answered(|answer| value_in_words(&answer.value));
        "as_expected", "0 or 1", "attention checks: 1 for the expected answer; empty otherwise"
            => row.own.answered(|answer| answer.as_expected);
        "answered_at", "RFC 3339", "time of the answer" => row.own.answer.map(|(placed, _)| &placed.line.at);
        "for_ms", "milliseconds", "time from display to answer" => row.own.answered(|answer| answer.for_ms);
        "changes", "count", "number of changes before the answer" => row.own.answered(|answer| answer.changes);
    })
}

/// Returns the rows of a run: each question with the answer that follows it.
pub(super) fn rows<'a>(lines: &'a [Placed<'a>]) -> impl Iterator<Item = LineRow<'a, ShownQuestion<'a>>> {
    lines.iter().enumerate().filter_map(|(at, placed)| {
        let Record::Activity(Activity::Question(asked)) = &placed.line.record else { return None };
        let next = lines[at + 1..].iter().find_map(|later| match &later.line.record {
            Record::Activity(Activity::Answer(answer)) if answers(answer, asked) => {
                Some(Some((later, answer)))
            }
            // The question is shown again, so the answer belongs to the later display.
            Record::Activity(Activity::Question(again)) if again.id == asked.id && same(again, asked) => {
                Some(None)
            }
            _ => None,
        });
        Some(LineRow { placed, own: ShownQuestion { asked, answer: next.flatten() } })
    })
}

fn answers(answer: &Answered, asked: &Asked) -> bool {
    (&answer.questionnaire, &answer.occasion, &answer.id)
        == (&asked.questionnaire, &asked.occasion, &asked.id)
}

fn same(one: &Asked, other: &Asked) -> bool {
    (&one.questionnaire, &one.occasion) == (&other.questionnaire, &other.occasion)
}

/// Formats an answer for a cell: several options one per line.
pub(super) fn value_in_words(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        Value::Array(values) => values.iter().map(value_in_words).collect::<Vec<_>>().join("\n"),
        other => other.to_string(),
    }
}
