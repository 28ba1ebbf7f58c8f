//! `events.csv`: a row for each line of a run, including lines recorded after its end.

use super::answers::format_answer;
use super::column::{Column, columns};
use super::located_line::{LineRow, LocatedLine, with_location_columns};
use super::{format_flag, format_number, serialized_name};
use novamind_base::formatting::json_number;
use novamind_record::trajectory::Record;
use novamind_record::trajectory::record::{
    Activity, Call, DialogStep, Outcome, Presence, Reversal, Start, TextEdit, VoiceAnswer,
};

pub(super) fn columns<'a>() -> Vec<Column<LineRow<'a, EventRow>>> {
    with_location_columns(columns! { row: LineRow<'a, EventRow>;
        "afterwards", "0 or 1", "1: the line is in afterwards.jsonl" => row.located.is_after_end;
        "kind", "word", "kind of the line" => row.located.line.record.kind();
        "what", "text", "call: tool; view: screen; select: kind of object; dialog, draft, limit: name; help: term; \
         session, clock: event; question, answer: questionnaire; look: command; xray: what was shown; query, advance: via; \
         start: mode; override: key; voice: kind of event; end: reason" => row.row.what;
        "which", "text", "call: via; view: screen before; select: object; dialog, draft: outcome; help: place; session: \
         interface or cause; limit: event; question, answer: question; xray: group, customer, part or statement; query: error; \
         note, memo: hash; start: scenario; branch: run; voice: judged post, or what failed" => row.row.which;
        "value", "text", "call: accepted or code of the rejection; query: rows; draft, note, memo: length; limit: minutes; \
         question: form; answer: answer; week, step, end: cash; start: seed; branch: line; override: new value; xray: day \
         shown; voice: groups or posts" => row.row.value;
        "for_ms", "milliseconds", "view, dialog, draft, answer, query, call, voice: duration; limit: active time \
         used; clock: time for which it was stopped; session: time since the last key press" => row.row.for_ms;
        "detail", "name=value", "other values of the line" => row.row.format_detail();
        "text", "text", "call: arguments; query: statement; advance: rationale; draft: text not submitted; question: text shown; clock: \
         reason; look: request" => row.row.text;
    })
}

pub(super) fn rows<'a>(lines: &'a [LocatedLine<'a>]) -> impl Iterator<Item = LineRow<'a, EventRow>> {
    lines.iter().map(|placed| LineRow { located: placed, row: EventRow::from_record(&placed.line.record) })
}

#[derive(Default)]
pub(super) struct EventRow {
    what: String,
    which: String,
    value: String,
    for_ms: String,
    detail: Vec<(&'static str, String)>,
    text: String,
}

impl EventRow {
    fn format_detail(&self) -> String {
        self.detail.iter().map(|(name, value)| format!("{name}={value}")).collect::<Vec<_>>().join(";")
    }

    fn from_record(record: &Record) -> EventRow {
        let named = |what: &str, which: &str, value: String| EventRow {
            what: what.to_owned(),
            which: which.to_owned(),
            value,
            ..EventRow::default()
        };
        match record {
            Record::Start(start) => EventRow::from_start(start),
            Record::Call(call) => EventRow::from_call(call),
            Record::Query(query) => EventRow {
                for_ms: format_number(query.took_ms),
                text: query.sql.clone(),
                ..named(
                    &query.via.map(|via| serialized_name(&via)).unwrap_or_default(),
                    query.error.as_deref().unwrap_or_default(),
                    query.rows.map(|rows| rows.to_string()).unwrap_or_default(),
                )
            },
            Record::Activity(activity) => EventRow::from_activity(activity),
            Record::Memo(memo) => named("", &memo.digest, memo.length.to_string()),
            Record::Note(note) => named("", &note.digest, note.length.to_string()),
            Record::Advance(filed) => EventRow {
                text: filed.rationale.clone(),
                ..named(&serialized_name(&filed.via), "", String::new())
            },
            Record::Week(closing) | Record::Step(closing) => EventRow {
                detail: vec![("days_run", closing.days_run.to_string())],
                ..named("", "", format_number(closing.cash))
            },
            Record::Voice(VoiceAnswer::Scores(judged)) => EventRow {
                for_ms: format_number(judged.took_ms),
                ..named("scores", &judged.post.to_string(), judged.scores.len().to_string())
            },
            Record::Voice(VoiceAnswer::Words(worded)) => EventRow {
                for_ms: format_number(worded.took_ms),
                ..named("words", "", worded.posts.len().to_string())
            },
            Record::Voice(VoiceAnswer::Failed(failed)) => EventRow {
                for_ms: format_number(failed.took_ms),
                text: failed.problem.clone(),
                ..named("failed", &serialized_name(&failed.asked), String::new())
            },
            Record::Override(change) => named(&change.key, "", change.new.to_string()),
            Record::Branch(branch) => match &branch.from {
                Some(from) => named("", &from.run, from.seq.to_string()),
                None => EventRow::default(),
            },
            Record::End(end) => named(end.reason.id(), "", format_number(end.cash)),
            Record::Unknown(_) => EventRow::default(),
        }
    }

    fn from_start(start: &Start) -> EventRow {
        EventRow {
            what: start.mode.id().to_owned(),
            which: start.scenario.clone(),
            value: start.seed.to_string(),
            detail: vec![("format", start.format.to_string()), ("version", start.version.clone())],
            ..EventRow::default()
        }
    }

    fn from_call(call: &Call) -> EventRow {
        let value = match &call.outcome {
            Outcome::Accepted(_) => "accepted".to_owned(),
            Outcome::Rejected(refusal) => refusal.code.clone(),
        };
        let reversal = match call.reversal {
            Some(Reversal::Undoes(seq)) => vec![("undoes", seq.to_string())],
            Some(Reversal::Redoes(seq)) => vec![("redoes", seq.to_string())],
            None => Vec::new(),
        };
        EventRow {
            what: call.tool.to_string(),
            which: serialized_name(&call.via),
            value,
            for_ms: format_number(call.took_ms),
            detail: reversal,
            text: call.args.to_string(),
        }
    }

    fn from_activity(activity: &Activity) -> EventRow {
        let mut event = EventRow::default();
        match activity {
            Activity::Session(presence) => return EventRow::from_presence(presence),
            Activity::Draft(draft) => return EventRow::from_draft(draft),
            Activity::Clock(clock) => {
                event.what = serialized_name(&clock.event);
                event.text = clock.reason.clone().unwrap_or_default();
                event.for_ms = clock.stood_ms.map(|ms| ms.to_string()).unwrap_or_default();
            }
            Activity::Limit(limit) => {
                (event.what, event.which) = (serialized_name(&limit.limit), serialized_name(&limit.event));
                (event.value, event.for_ms) = (limit.minutes.to_string(), limit.used_ms.to_string());
            }
            Activity::View(view) => {
                (event.what, event.which) = (view.screen.clone(), view.from.clone());
                event.for_ms = view.for_ms.to_string();
            }
            Activity::Select(select) => {
                (event.what, event.which) = (select.what.clone(), select.which.clone());
                event.detail = vec![("screen", select.screen.clone())];
            }
            Activity::Dialog(dialog) => {
                (event.what, event.which) = (dialog.what.clone(), serialized_name(&dialog.outcome));
                event.for_ms = dialog.for_ms.to_string();
                let step = |step: &DialogStep| ("step", format!("{}:{}", step.step, step.for_ms));
                event.detail = dialog.steps.iter().map(step).collect();
            }
            Activity::Help(help) => (event.what, event.which) = (help.term.clone(), help.place.clone()),
            Activity::Question(question_shown) => {
                (event.what, event.which) = (question_shown.questionnaire.clone(), question_shown.id.clone());
                (event.value, event.text) = (question_shown.form.clone(), question_shown.text.clone());
                event.detail = vec![("occasion", question_shown.occasion.clone())];
            }
            Activity::Answer(answer) => {
                (event.what, event.which) = (answer.questionnaire.clone(), answer.id.clone());
                (event.value, event.for_ms) = (format_answer(&answer.value), answer.for_ms.to_string());
                event.detail =
                    vec![("occasion", answer.occasion.clone()), ("changes", answer.changes.to_string())];
                event
                    .detail
                    .extend(answer.as_expected.map(|expected| ("as_expected", format_flag(expected))));
            }
            Activity::Lesson(note) => {
                (event.what, event.which) =
                    (crate::lesson::event_name(note.event).to_owned(), note.step.to_string());
                event.value = note.value.map(|value| json_number(value).to_string()).unwrap_or_default();
                event.text = crate::lesson::describe_note(note);
            }
            Activity::ExternalRead(read) => {
                (event.what, event.text) = (read.command.clone(), read.detail.clone())
            }
            Activity::Inspection(inspection) => {
                (event.what, event.which) = (inspection.what.clone(), inspection.which.clone());
                event.value = inspection.shown_day.to_string();
            }
        }
        event
    }

    fn from_presence(presence: &Presence) -> EventRow {
        let mut detail = vec![
            ("machine", presence.machine.clone()),
            ("boot", presence.boot.clone()),
            ("monotonic_ms", presence.monotonic_ms.to_string()),
        ];
        detail.extend(presence.window.map(|(columns, rows)| ("window", format!("{columns}x{rows}"))));
        detail.extend(presence.version.clone().map(|version| ("version", version)));
        let which = presence.interface.clone().or(presence.cause.as_ref().map(serialized_name));
        EventRow {
            what: serialized_name(&presence.event),
            which: which.unwrap_or_default(),
            for_ms: presence.idle_ms.map(|ms| ms.to_string()).unwrap_or_default(),
            detail,
            ..EventRow::default()
        }
    }

    fn from_draft(draft: &TextEdit) -> EventRow {
        EventRow {
            what: draft.place.clone(),
            which: serialized_name(&draft.outcome),
            value: draft.length.to_string(),
            for_ms: draft.for_ms.to_string(),
            detail: vec![
                ("typed", draft.typed.to_string()),
                ("deleted", draft.deleted.to_string()),
                ("pasted", draft.pasted.to_string()),
                ("pauses", draft.pauses.to_string()),
            ],
            text: draft.text.clone().unwrap_or_default(),
        }
    }
}
