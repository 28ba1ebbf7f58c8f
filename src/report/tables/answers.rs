//! `answers.csv`: a row for each question of the study that was shown.

use super::column::{Column, columns};
use super::place::{LineRow, Placed, with_place};
use novamind_record::trajectory::Record;
use novamind_record::trajectory::record::{Activity, Answered, Asked};
use serde_json::Value;

/// A question, and its answer with its place.
pub(super) struct ShownQuestion<'a> {
    asked: &'a Asked,
    answer: Option<(&'a Placed<'a>, &'a Answered)>,
}

impl ShownQuestion<'_> {
    /// Returns a part of the answer, if there is one.
    fn answered<T>(&self, part: impl Fn(&Answered) -> T) -> Option<T> {
        self.answer.map(|(_, answer)| part(answer))
    }
}

/// The columns. The place is that of the question.
pub(super) fn columns<'a>() -> Vec<Column<LineRow<'a, ShownQuestion<'a>>>> {
    with_place(columns! { row: LineRow<'a, ShownQuestion<'a>>;
        "questionnaire", "name", "questionnaire it belongs to" => row.own.asked.questionnaire;
        "occasion", "text", "when it was asked: before, week 4, break 1, end" => row.own.asked.occasion;
        "question", "name", "name of the question" => row.own.asked.id;
        "form", "word", "likert, number, choice, text or attention" => row.own.asked.form;
        "shown", "text", "its text as it was shown" => row.own.asked.text;
        "options", "text", "what could be chosen, one in a line" => row.own.asked.options.join("\n");
        "answered", "0 or 1", "1: it was answered or passed over; 0: the run ends without it" => row.own.answer.is_some();
        "value", "text", "the answer; several options one in a line; empty if it was passed over"
            => row.own.answered(|answer| value_in_words(&answer.value));
        "as_expected", "0 or 1", "attention checks: 1, the expected answer; empty otherwise"
            => row.own.answered(|answer| answer.as_expected);
        "answered_at", "RFC 3339", "when it was answered" => row.own.answer.map(|(placed, _)| &placed.line.at);
        "for_ms", "milliseconds", "from showing to answering" => row.own.answered(|answer| answer.for_ms);
        "changes", "count", "how often the answer was changed before" => row.own.answered(|answer| answer.changes);
    })
}

/// The rows of a run: each question with the answer that follows it.
pub(super) fn rows<'a>(lines: &'a [Placed<'a>]) -> impl Iterator<Item = LineRow<'a, ShownQuestion<'a>>> {
    lines.iter().enumerate().filter_map(|(at, placed)| {
        let Record::Activity(Activity::Question(asked)) = &placed.line.record else { return None };
        let next = lines[at + 1..].iter().find_map(|later| match &later.line.record {
            Record::Activity(Activity::Answer(answer)) if answers(answer, asked) => {
                Some(Some((later, answer)))
            }
            // Shown again: what follows belongs to that.
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

/// A value of an answer in a cell: several options one in a line.
pub(super) fn value_in_words(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        Value::Array(values) => values.iter().map(value_in_words).collect::<Vec<_>>().join("\n"),
        other => other.to_string(),
    }
}
