//! `answers.csv`: a row for each question of the study that was shown.

use super::place::{PLACE, Placed, with_place};
use super::{Heading, flag, heading};
use novamind_session::record::{Answered, Asked};
use novamind_session::{Activity, Record};
use serde_json::Value;

const OWN: [Heading; 12] = [
    heading("questionnaire", "name", "questionnaire it belongs to"),
    heading("occasion", "text", "when it was asked: before, week 4, break 1, end"),
    heading("question", "name", "name of the question"),
    heading("form", "word", "likert, number, choice, text or attention"),
    heading("shown", "text", "its text as it was shown"),
    heading("options", "text", "what could be chosen, one in a line"),
    heading("answered", "0 or 1", "1: it was answered or passed over; 0: the run ends without it"),
    heading("value", "text", "the answer; several options one in a line; empty if it was passed over"),
    heading("as_expected", "0 or 1", "attention checks: 1, the expected answer; empty otherwise"),
    heading("answered_at", "RFC 3339", "when it was answered"),
    heading("for_ms", "milliseconds", "from showing to answering"),
    heading("changes", "count", "how often the answer was changed before"),
];

/// The columns. The place is that of the question.
pub(super) const HEADINGS: [Heading; PLACE.len() + OWN.len()] = with_place(&OWN);

/// The rows of a run: each question with the answer that follows it.
pub(super) fn rows(lines: &[Placed<'_>]) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    for (at, placed) in lines.iter().enumerate() {
        let Record::Activity(Activity::Question(asked)) = &placed.line.record else { continue };
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
        rows.push(placed.row(cells(asked, next.flatten())));
    }
    rows
}

fn answers(answer: &Answered, asked: &Asked) -> bool {
    (&answer.questionnaire, &answer.occasion, &answer.id)
        == (&asked.questionnaire, &asked.occasion, &asked.id)
}

fn same(one: &Asked, other: &Asked) -> bool {
    (&one.questionnaire, &one.occasion) == (&other.questionnaire, &other.occasion)
}

fn cells(asked: &Asked, answer: Option<(&Placed<'_>, &Answered)>) -> [String; OWN.len()] {
    let told = |of: &dyn Fn(&Placed<'_>, &Answered) -> String| {
        answer.map(|(placed, answer)| of(placed, answer)).unwrap_or_default()
    };
    [
        asked.questionnaire.clone(),
        asked.occasion.clone(),
        asked.id.clone(),
        asked.form.clone(),
        asked.text.clone(),
        asked.options.join("\n"),
        flag(answer.is_some()),
        told(&|_, answer| value_in_words(&answer.value)),
        told(&|_, answer| answer.as_expected.map(flag).unwrap_or_default()),
        told(&|placed, _| placed.line.at.clone()),
        told(&|_, answer| answer.for_ms.to_string()),
        told(&|_, answer| answer.changes.to_string()),
    ]
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
