//! What a person did besides acting, in few words.

use super::told::time;
use crate::console::theme::Role;
use crate::session::Activity;
use crate::session::record::{
    ClockEvent, DialogOutcome, DraftOutcome, LimitEvent, LimitScope, Presence, PresenceEvent,
};

/// An activity in a line.
pub(super) fn brief(activity: &Activity) -> (String, Role) {
    let text = match activity {
        Activity::View(view) => format!("viewed {} for {}", view.screen, time(view.for_ms)),
        Activity::Select(select) => format!("opened {} {}", select.what, select.which),
        Activity::Dialog(dialog) => {
            let end = match dialog.outcome {
                DialogOutcome::Confirmed => "confirmed",
                DialogOutcome::Cancelled => "left",
            };
            format!("{}: {end} after {}", dialog.what, time(dialog.for_ms))
        }
        Activity::Help(help) => format!("looked up {}", help.term),
        Activity::Draft(draft) => {
            let end = match draft.outcome {
                DraftOutcome::Sent => "sent",
                DraftOutcome::Left => "left unsent",
                DraftOutcome::Restored => "restored after a crash",
            };
            format!("{}: {} characters {end}", draft.place, draft.length)
        }
        Activity::Session(presence) => return (presence_in_words(presence), Role::Header),
        Activity::Clock(clock) => {
            let what = match clock.event {
                ClockEvent::Stopped => "stopped the clock",
                ClockEvent::Started => "started the clock",
                ClockEvent::Forgotten => "the clock stood when the program ended",
            };
            let reason = clock.reason.as_ref().map_or(String::new(), |reason| format!(": {reason}"));
            return (format!("{what}{reason}"), Role::Header);
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
                LimitEvent::FiledNaively => "filed naively at",
                LimitEvent::Paused => "stopped by",
            };
            return (format!("{what} the limit of {} minutes a {scope}", limit.minutes), Role::Warning);
        }
        Activity::Question(asked) => format!("asked: {}", asked.text),
        Activity::Answer(answer) if answer.value.is_null() => format!("{}: no answer", answer.id),
        Activity::Answer(answer) => format!("{}: {}", answer.id, answer.value),
        Activity::Look(look) => format!("read from outside: {} {}", look.command, look.detail),
    };
    (text, Role::Dim)
}

fn presence_in_words(presence: &Presence) -> String {
    match presence.event {
        PresenceEvent::Opened => match &presence.interface {
            Some(interface) => format!("opened in {interface}"),
            None => "opened".to_owned(),
        },
        PresenceEvent::Closed => "closed".to_owned(),
        PresenceEvent::Idle => format!("idle for {}", time(presence.idle_ms.unwrap_or(0))),
        PresenceEvent::Active => "active again".to_owned(),
        PresenceEvent::FocusLost => "another window had the focus".to_owned(),
        PresenceEvent::FocusGained => "this window had the focus again".to_owned(),
        PresenceEvent::Suspended => "suspended by the shell".to_owned(),
        PresenceEvent::Resumed => "resumed".to_owned(),
        PresenceEvent::Resized => match presence.window {
            Some((columns, rows)) => format!("window {columns}×{rows}"),
            None => "window resized".to_owned(),
        },
    }
}
