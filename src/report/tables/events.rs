//! `events.csv`: a row for each line of a run, including lines recorded after its end.

use super::answers::value_in_words;
use super::column::{Column, columns};
use super::place::{LineRow, Placed, with_place};
use super::{flag, number, word};
use novamind_base::notation::json_number;
use novamind_record::trajectory::Record;
use novamind_record::trajectory::record::{
    Activity, Call, DialogStep, Draft, Outcome, Presence, Reversal, Start, VoiceAnswer,
};

pub(super) fn columns<'a>() -> Vec<Column<LineRow<'a, Event>>> {
    with_place(columns! { row: LineRow<'a, Event>;
        "afterwards", "0 or 1", "1: the line is in afterwards.jsonl" => row.placed.is_afterwards;
        "kind", "word", "kind of the line" => row.placed.line.record.kind();
        "what", "text", "call: tool; view: screen; select: kind of object; dialog, draft: which; help: term; session, clock: \
         event; limit: which; question, answer: questionnaire; look: command; xray: what was shown; query, advance: via; \
         start: mode; override: key; voice: kind of event; end: reason" => row.own.what;
        "which", "text", "call: via; view: screen before; select: object; dialog, draft: outcome; help: place; session: \
         interface or cause; limit: event; question, answer: question; xray: group, customer, part or statement; query: error; \
         note, memo: hash; start: scenario; branch: run; voice: judged post, or what failed" => row.own.which;
        "value", "text", "call: accepted or code of the rejection; query: rows; draft, note, memo: length; limit: minutes; \
         question: form; answer: answer; week, step, end: cash; start: seed; branch: line; override: new value; xray: day \
         shown; voice: groups or posts" => row.own.value;
        "for_ms", "milliseconds", "how long: view, dialog, draft, answer, query; call, voice: duration; limit: active time \
         used; clock: time it stood; session: time since the last key" => row.own.for_ms;
        "detail", "name=value", "other values of the line" => row.own.detail_in_words();
        "text", "text", "call: arguments; query: statement; advance: rationale; draft: text not submitted; question: text shown; clock: \
         reason; look: its request" => row.own.text;
    })
}

pub(super) fn rows<'a>(lines: &'a [Placed<'a>]) -> impl Iterator<Item = LineRow<'a, Event>> {
    lines.iter().map(|placed| LineRow { placed, own: Event::of(&placed.line.record) })
}

#[derive(Default)]
pub(super) struct Event {
    what: String,
    which: String,
    value: String,
    for_ms: String,
    detail: Vec<(&'static str, String)>,
    text: String,
}

impl Event {
    fn detail_in_words(&self) -> String {
        self.detail.iter().map(|(name, value)| format!("{name}={value}")).collect::<Vec<_>>().join(";")
    }

    fn of(record: &Record) -> Event {
        let named = |what: &str, which: &str, value: String| Event {
            what: what.to_owned(),
            which: which.to_owned(),
            value,
            ..Event::default()
        };
        match record {
            Record::Start(start) => Event::of_start(start),
            Record::Call(call) => Event::of_call(call),
            Record::Query(query) => Event {
                for_ms: number(query.took_ms),
                text: query.sql.clone(),
                ..named(
                    &query.via.map(|via| word(&via)).unwrap_or_default(),
                    query.error.as_deref().unwrap_or_default(),
                    query.rows.map(|rows| rows.to_string()).unwrap_or_default(),
                )
            },
            Record::Activity(activity) => Event::of_activity(activity),
            Record::Memo(memo) => named("", &memo.digest, memo.length.to_string()),
            Record::Note(note) => named("", &note.digest, note.length.to_string()),
            Record::Advance(filed) => {
                Event { text: filed.rationale.clone(), ..named(&word(&filed.via), "", String::new()) }
            }
            Record::Week(closing) | Record::Step(closing) => Event {
                detail: vec![("days_run", closing.days_run.to_string())],
                ..named("", "", number(closing.cash))
            },
            Record::Voice(VoiceAnswer::Scores(judged)) => Event {
                for_ms: number(judged.took_ms),
                ..named("scores", &judged.post.to_string(), judged.scores.len().to_string())
            },
            Record::Voice(VoiceAnswer::Words(worded)) => {
                Event { for_ms: number(worded.took_ms), ..named("words", "", worded.posts.len().to_string()) }
            }
            Record::Voice(VoiceAnswer::Failed(failed)) => Event {
                for_ms: number(failed.took_ms),
                text: failed.problem.clone(),
                ..named("failed", &word(&failed.asked), String::new())
            },
            Record::Override(change) => named(&change.key, "", change.new.to_string()),
            Record::Branch(branch) => match &branch.from {
                Some(from) => named("", &from.run, from.seq.to_string()),
                None => Event::default(),
            },
            Record::End(end) => named(end.reason.id(), "", number(end.cash)),
            Record::Unknown(_) => Event::default(),
        }
    }

    fn of_start(start: &Start) -> Event {
        Event {
            what: start.mode.id().to_owned(),
            which: start.scenario.clone(),
            value: start.seed.to_string(),
            detail: vec![("format", start.format.to_string()), ("version", start.version.clone())],
            ..Event::default()
        }
    }

    fn of_call(call: &Call) -> Event {
        let value = match &call.outcome {
            Outcome::Accepted(_) => "accepted".to_owned(),
            Outcome::Refused(refusal) => refusal.code.clone(),
        };
        let reversal = match call.reversal {
            Some(Reversal::Undoes(seq)) => vec![("undoes", seq.to_string())],
            Some(Reversal::Redoes(seq)) => vec![("redoes", seq.to_string())],
            None => Vec::new(),
        };
        Event {
            what: call.tool.to_string(),
            which: word(&call.via),
            value,
            for_ms: number(call.took_ms),
            detail: reversal,
            text: call.args.to_string(),
        }
    }

    fn of_activity(activity: &Activity) -> Event {
        let mut event = Event::default();
        match activity {
            Activity::Session(presence) => return Event::of_presence(presence),
            Activity::Draft(draft) => return Event::of_draft(draft),
            Activity::Clock(clock) => {
                event.what = word(&clock.event);
                event.text = clock.reason.clone().unwrap_or_default();
                event.for_ms = clock.stood_ms.map(|ms| ms.to_string()).unwrap_or_default();
            }
            Activity::Limit(limit) => {
                (event.what, event.which) = (word(&limit.limit), word(&limit.event));
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
                (event.what, event.which) = (dialog.what.clone(), word(&dialog.outcome));
                event.for_ms = dialog.for_ms.to_string();
                let step = |step: &DialogStep| ("step", format!("{}:{}", step.step, step.for_ms));
                event.detail = dialog.steps.iter().map(step).collect();
            }
            Activity::Help(help) => (event.what, event.which) = (help.term.clone(), help.place.clone()),
            Activity::Question(asked) => {
                (event.what, event.which) = (asked.questionnaire.clone(), asked.id.clone());
                (event.value, event.text) = (asked.form.clone(), asked.text.clone());
                event.detail = vec![("occasion", asked.occasion.clone())];
            }
            Activity::Answer(answer) => {
                (event.what, event.which) = (answer.questionnaire.clone(), answer.id.clone());
                (event.value, event.for_ms) = (value_in_words(&answer.value), answer.for_ms.to_string());
                event.detail =
                    vec![("occasion", answer.occasion.clone()), ("changes", answer.changes.to_string())];
                event.detail.extend(answer.as_expected.map(|expected| ("as_expected", flag(expected))));
            }
            Activity::Lesson(note) => {
                (event.what, event.which) =
                    (crate::lesson::word(note.event).to_owned(), note.step.to_string());
                event.value = note.value.map(|value| json_number(value).to_string()).unwrap_or_default();
                event.text = crate::lesson::in_words(note);
            }
            Activity::Look(look) => (event.what, event.text) = (look.command.clone(), look.detail.clone()),
            Activity::Xray(look) => {
                (event.what, event.which) = (look.what.clone(), look.which.clone());
                event.value = look.shown_day.to_string();
            }
        }
        event
    }

    fn of_presence(presence: &Presence) -> Event {
        let mut detail = vec![
            ("machine", presence.machine.clone()),
            ("boot", presence.boot.clone()),
            ("monotonic_ms", presence.monotonic_ms.to_string()),
        ];
        detail.extend(presence.window.map(|(columns, rows)| ("window", format!("{columns}x{rows}"))));
        detail.extend(presence.version.clone().map(|version| ("version", version)));
        let which = presence.interface.clone().or(presence.cause.as_ref().map(word));
        Event {
            what: word(&presence.event),
            which: which.unwrap_or_default(),
            for_ms: presence.idle_ms.map(|ms| ms.to_string()).unwrap_or_default(),
            detail,
            ..Event::default()
        }
    }

    fn of_draft(draft: &Draft) -> Event {
        Event {
            what: draft.place.clone(),
            which: word(&draft.outcome),
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
