//! Short descriptions of recorded user activity.

use super::entry_text::format_millis;
use novamind_base::formatting::pluralize;
use novamind_record::trajectory::record::{
    Activity, ClockEvent, DetachCause, DialogOutcome, LimitEvent, LimitScope, Presence, PresenceEvent,
    TextEditOutcome,
};
use novamind_tui::theme::Role;

pub(super) fn activity_summary(activity: &Activity) -> (String, Role) {
    let text = match activity {
        Activity::View(view) => format!("viewed {} for {}", view.screen, format_millis(view.for_ms)),
        Activity::Select(select) if select.what == "command" => format!("used command {}", select.which),
        Activity::Select(select) => format!("opened {} {}", select.what, select.which),
        Activity::Dialog(dialog) => {
            let end = match dialog.outcome {
                DialogOutcome::Confirmed => "confirmed",
                DialogOutcome::Cancelled => "cancelled",
            };
            let steps =
                dialog.steps.iter().map(|step| format!("{} {}", step.step, format_millis(step.for_ms)));
            let steps = steps.collect::<Vec<_>>().join(", ");
            let steps = if steps.is_empty() { steps } else { format!(" ({steps})") };
            format!("{}: {end} after {}{steps}", dialog.what, format_millis(dialog.for_ms))
        }
        Activity::Help(help) => format!("looked up {} in {}", help.term, help.place),
        Activity::Draft(draft) => {
            let end = match draft.outcome {
                TextEditOutcome::Sent => "sent",
                TextEditOutcome::Left => "not sent",
                TextEditOutcome::Restored => "restored after a crash",
            };
            let pasted = match draft.pasted {
                0 => String::new(),
                pasted => format!(", {pasted} pasted"),
            };
            format!("{}: {} {end}{pasted}", draft.place, pluralize(draft.length as u32, "character"))
        }
        Activity::Session(presence) => return (presence_summary(presence), Role::Header),
        Activity::Clock(clock) => {
            let what = match clock.event {
                ClockEvent::Stopped => "stopped the clock",
                ClockEvent::Started => "started the clock",
                ClockEvent::Forgotten => "the program ended while the clock was stopped",
            };
            let reason = clock.reason.as_ref().map_or(String::new(), |reason| format!(": {reason}"));
            let stood = clock.stood_ms.map_or(String::new(), |ms| format!(" after {}", format_millis(ms)));
            return (format!("{what}{reason}{stood}"), Role::Header);
        }
        Activity::Limit(limit) => {
            let scope = match limit.limit {
                LimitScope::Week => "week",
                LimitScope::Session => "session",
                LimitScope::Study => "study",
            };
            let what = match limit.event {
                LimitEvent::Warned => "warned of",
                LimitEvent::Reminded => "reminded of",
                LimitEvent::FiledNaively => "submitted with naive forecasts at",
                LimitEvent::Paused => "stopped by",
            };
            return (
                format!("{what} the limit of {} per {scope}", pluralize(limit.minutes, "minute")),
                Role::Warning,
            );
        }
        Activity::Question(question_shown) => format!("asked: {}", question_shown.text),
        Activity::Answer(answer) if answer.value.is_null() => format!("{}: no answer", answer.id),
        Activity::Answer(answer) => format!("{}: {}", answer.id, answer.value),
        Activity::Lesson(note) => novamind_report::lesson::describe_note(note),
        Activity::ExternalRead(external_read) => {
            format!("read by another program: {} {}", external_read.command, external_read.detail)
        }
        Activity::Inspection(inspection) => {
            format!("x-ray of day {}: {} {}", inspection.shown_day, inspection.what, inspection.which)
        }
    };
    (text, Role::Dim)
}

fn presence_summary(presence: &Presence) -> String {
    match presence.event {
        PresenceEvent::Opened => match &presence.interface {
            Some(interface) => format!("opened in {interface}"),
            None => "opened".to_owned(),
        },
        PresenceEvent::Closed => match presence.cause {
            None | Some(DetachCause::Quit) => "closed".to_owned(),
            Some(DetachCause::EndOfInput) => "closed at the end of the input".to_owned(),
            Some(DetachCause::Signal) => "closed by a signal".to_owned(),
            Some(DetachCause::Hangup) => "closed because the terminal closed".to_owned(),
            Some(DetachCause::Strict) => "closed after a rejection (strict mode)".to_owned(),
            Some(DetachCause::Withdrawn) => "closed: the participant withdrew".to_owned(),
        },
        PresenceEvent::Idle => format!("no input for {}", format_millis(presence.idle_ms.unwrap_or(0))),
        PresenceEvent::Active => format!("input after {}", format_millis(presence.idle_ms.unwrap_or(0))),
        PresenceEvent::FocusLost => "window lost focus".to_owned(),
        PresenceEvent::FocusGained => "window regained focus".to_owned(),
        PresenceEvent::Suspended => "suspended by the shell".to_owned(),
        PresenceEvent::Resumed => "resumed".to_owned(),
        PresenceEvent::Resized => match presence.window {
            Some((columns, rows)) => format!("window {columns}×{rows}"),
            None => "window resized".to_owned(),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_record::trajectory::record::{
        Clock, DialogStep, DialogUse, HelpRequest, ObjectSelection, TextEdit,
    };

    #[test]
    fn activity_summaries_name_object_and_duration() {
        let step = |step: &str, for_ms| DialogStep { step: step.to_owned(), for_ms };
        let dialog = DialogUse {
            what: "next week".to_owned(),
            outcome: DialogOutcome::Confirmed,
            for_ms: 61_000,
            steps: vec![step("review", 1_000), step("rationale", 60_000)],
        };
        let draft = TextEdit {
            place: "notes".to_owned(),
            outcome: TextEditOutcome::Left,
            length: 20,
            typed: 8,
            deleted: 0,
            pasted: 12,
            pauses: 0,
            for_ms: 4_000,
            text: None,
        };
        let help = HelpRequest { term: "churn".to_owned(), place: "customers".to_owned() };
        let (screen, what) = ("plain".to_owned(), "command".to_owned());
        let select = ObjectSelection { screen, what, which: "fit S1".to_owned() };
        let clock = Clock { event: ClockEvent::Started, reason: None, stood_ms: Some(300_000) };
        let summarize = |activity: Activity| activity_summary(&activity).0;
        let words = summarize(Activity::Dialog(dialog));
        assert!(words.starts_with("next week: confirmed after ") && words.contains("rationale "), "{words}");
        assert_eq!(summarize(Activity::Draft(draft)), "notes: 20 characters not sent, 12 pasted");
        assert_eq!(summarize(Activity::Help(help)), "looked up churn in customers");
        assert_eq!(summarize(Activity::Select(select)), "used command fit S1");
        assert!(summarize(Activity::Clock(clock)).starts_with("started the clock after "));
    }
}
