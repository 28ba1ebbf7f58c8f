//! Recording of user activity: viewed screens, objects, dialogs and terms, edited texts, and presence. The session
//! thread writes the events, so recording does not block the console.

use std::time::Duration;

use crossterm::event::{Event, KeyEventKind, MouseEventKind};

use super::{App, Layer, Order, Run, Stage};
use crate::attention::EditSource;
use crate::context::ScreenId;
use novamind_record::rules::DraftRecording;
use novamind_record::trajectory::record::{
    Activity, DialogOutcome, HelpRequest, ObjectSelection, PresenceEvent, ScreenView, TextEdit,
    TextEditOutcome,
};
use novamind_session::{Interface, Session};
use novamind_tools::ToolId;
use novamind_worker::Job;
use novamind_worker::request::Request;

const NEXT_WEEK_DRAFTS: [&str; 2] = ["rationale", "forecasts"];

impl App {
    /// Returns whether a run is being played. Views of a playback are not recorded.
    fn is_played(&self) -> bool {
        self.run().is_some_and(|run| run.playback.is_none())
    }

    pub(super) fn record(&mut self, note: impl FnOnce(&mut Session) + Send + 'static) {
        self.orders.push(Order::Job(Job::RecordActivity(Box::new(note))));
    }

    pub(super) fn record_activity(&mut self, activity: Activity) {
        if self.is_played() {
            self.record(|session| session.activity().record(activity));
        }
    }

    pub(super) fn record_presence(
        &mut self,
        event: PresenceEvent,
        idle_ms: Option<u64>,
        window: Option<(u16, u16)>,
    ) {
        if self.is_played() {
            self.record(move |session| session.activity().record_presence(event, idle_ms, window));
        }
    }

    pub(super) fn attach_to_run(&mut self) {
        if self.is_played() {
            self.presence.start(self.stopwatch.elapsed());
            let window = (self.window.0 > 0).then_some(self.window);
            self.orders.push(Order::Job(Job::Attach(Interface { name: "console", window })));
        }
    }

    /// Records that the user leaves the run and all open views.
    pub(super) fn detach_from_run(&mut self) {
        self.save_drafts();
        self.close_layers();
        for place in self.typing_log.places() {
            self.end_draft(&place, TextEditOutcome::Left);
        }
        self.record_view();
    }

    pub(super) fn handle_input(&mut self, event: Event) {
        let now = self.stopwatch.elapsed();
        let noted = match &event {
            Event::Key(key) if key.kind == KeyEventKind::Release => Vec::new(),
            Event::Mouse(mouse) if mouse.kind == MouseEventKind::Moved => Vec::new(),
            Event::Key(_) | Event::Paste(_) => self.presence.handle_input(false, now),
            Event::Mouse(_) => self.presence.handle_input(true, now),
            Event::FocusGained => self.presence.set_focus(true).into_iter().collect(),
            Event::FocusLost => self.presence.set_focus(false).into_iter().collect(),
            Event::Resize(columns, rows) => {
                self.presence.set_window((*columns, *rows), now);
                Vec::new()
            }
        };
        for (event, idle_ms, window) in noted {
            self.record_presence(event, idle_ms, window);
        }
        if self.pause_screen.is_some() {
            return self.handle_paused_event(event);
        }
        self.edit_source =
            if matches!(event, Event::Paste(_)) { EditSource::Pasted } else { EditSource::Typed };
        let before = self.edited_text();
        self.dispatch_event(event);
        if let (Some((place, old)), Some((same, new))) = (before, self.edited_text())
            && place == same
            && old != new
        {
            self.typing_log.record_change(&place, &old, new, self.edit_source, now);
        }
        self.schedule_draft_save();
    }

    /// Returns the recorded name and the content of the text that is being edited.
    pub(super) fn edited_text(&self) -> Option<(String, String)> {
        let run = self.run().filter(|run| run.playback.is_none())?;
        match self.layers.top() {
            Some(Layer::NextWeek) => crate::dialogs::Dialog::edited_text(&run.next_week),
            Some(Layer::Dialog(dialog)) => dialog.edited_text(),
            None => run.screens.get(run.screen).edited_text(),
        }
    }

    /// Records the end of a view: the screen was left, a week started or the clock stopped. The view time of a screen
    /// includes the time during which a dialog covers the screen. The dialog has a separate event.
    pub(super) fn record_view(&mut self) {
        let now = self.stopwatch.elapsed();
        let Stage::Run(run) = &mut self.stage else { return };
        // Time during a simulation is not counted as view time.
        let Some(since) = run.shown_since.replace(now) else {
            run.shown_since = None;
            return;
        };
        let view = ScreenView {
            screen: run.screen.record_name().to_owned(),
            from: run.previous_screen.map_or(String::new(), |screen| screen.record_name().to_owned()),
            for_ms: u64::try_from(now.saturating_sub(since).as_millis()).unwrap_or(u64::MAX),
        };
        self.record_activity(Activity::View(view));
    }

    pub(super) fn push_layer(&mut self, layer: Layer) {
        self.layers.push(layer, self.stopwatch.elapsed());
        self.record_dialog_step();
    }

    pub(super) fn record_dialog_step(&mut self) {
        let step = match (self.layers.top(), &self.stage) {
            (Some(Layer::NextWeek), Stage::Run(run)) => crate::dialogs::Dialog::step(&run.next_week),
            (Some(Layer::Dialog(dialog)), _) => dialog.step(),
            _ => None,
        };
        if let Some(step) = step {
            self.layers.enter_step(step, self.stopwatch.elapsed());
        }
    }

    pub(super) fn close_layer(&mut self, confirmed: bool) {
        let outcome = if confirmed { DialogOutcome::Confirmed } else { DialogOutcome::Cancelled };
        if let Some(used) = self.layers.pop(outcome, self.stopwatch.elapsed()) {
            self.record_activity(Activity::Dialog(used));
        }
    }

    pub(super) fn close_layers(&mut self) {
        while !self.layers.is_empty() {
            self.close_layer(false);
        }
    }

    /// Records that an object was opened: an item of a list, or the rows of a figure.
    pub(super) fn record_opened_object(&mut self, what: &str, which: String) {
        if let Some(screen) = self.run().map(|run| run.screen.record_name().to_owned()) {
            self.record_activity(Activity::Select(ObjectSelection { screen, what: what.to_owned(), which }));
        }
    }

    pub(super) fn record_sent_drafts(&mut self, request: &Request) {
        match request {
            Request::Advance { .. } => self.end_next_week_drafts(TextEditOutcome::Sent),
            Request::SetNotes(_) => self.end_draft("notes", TextEditOutcome::Sent),
            Request::Call { tool, .. } => {
                if *tool == ToolId::PostSocialMedia {
                    self.end_draft("post", TextEditOutcome::Sent);
                }
                self.end_draft(&format!("form {tool}"), TextEditOutcome::Sent);
            }
            _ => {}
        }
    }

    pub(super) fn end_next_week_drafts(&mut self, outcome: TextEditOutcome) {
        NEXT_WEEK_DRAFTS.into_iter().for_each(|place| self.end_draft(place, outcome));
    }

    pub(super) fn end_draft(&mut self, place: &str, outcome: TextEditOutcome) {
        let kept = self.run().map_or(DraftRecording::None, |run| run.company.rules.drafts);
        if let Some(draft) = self.typing_log.finish(place, outcome, kept == DraftRecording::Text) {
            self.record_draft(draft);
        }
    }

    pub(super) fn record_draft(&mut self, draft: TextEdit) {
        if self.run().is_some_and(|run| run.company.rules.drafts != DraftRecording::None) {
            self.record_activity(Activity::Draft(draft));
        }
    }

    /// Records selections, help terms and abandoned drafts that resulted from the last message.
    pub(super) fn record_user_state(&mut self) {
        if !self.is_played() {
            return;
        }
        self.record_selection();
        self.record_help_term();
        let left: Vec<String> =
            self.typing_log.places().into_iter().filter(|place| !self.is_editing(place)).collect();
        for place in left {
            self.end_draft(&place, TextEditOutcome::Left);
        }
    }

    fn record_selection(&mut self) {
        let Some(run) = self.run() else { return };
        let here = run.screen;
        let opened = self.open_object().map(|(what, which)| (here, what, which));
        let Stage::Run(run) = &mut self.stage else { return };
        if run.selected == opened {
            return;
        }
        run.selected.clone_from(&opened);
        if let Some((_, what, which)) = opened {
            self.record_opened_object(what, which);
        }
    }

    fn open_object(&self) -> Option<(&'static str, String)> {
        let run = self.run()?;
        let screen_context = crate::context::ScreenContext {
            company: &run.company,
            keys: &self.keys,
            page_rows: self.page_rows,
        };
        run.screens.get(run.screen).open_object(&screen_context)
    }

    fn record_help_term(&mut self) {
        let term = match self.layers.top() {
            Some(Layer::Dialog(dialog)) => dialog.term(),
            _ => None,
        };
        if term == self.explained_term {
            return;
        }
        self.explained_term.clone_from(&term);
        if let (Some(term), Some(run)) = (term, self.run()) {
            let below = self.layers.covered_dialog_name().map(str::to_owned);
            let place = below.unwrap_or_else(|| run.screen.record_name().to_owned());
            self.record_activity(Activity::Help(HelpRequest { term, place }));
        }
    }

    /// Returns whether the edited text with this recorded name is still visible.
    fn is_editing(&self, place: &str) -> bool {
        let Some(run) = self.run() else { return false };
        if NEXT_WEEK_DRAFTS.contains(&place) {
            return self.layers.iter().any(|layer| matches!(layer, Layer::NextWeek));
        }
        match place {
            "notes" => run.screen == ScreenId::Journal,
            "sql" => run.screen == ScreenId::Sql,
            "post" => run.screen == ScreenId::Social,
            form => {
                run.screen == ScreenId::Tools && form.strip_prefix("form ") == run.screens.tools.form_name()
            }
        }
    }

    pub(super) fn handle_time(&mut self) {
        let now = self.stopwatch.elapsed();
        // The console receives no input while the user's editor is open, so the user does not count as idle.
        if !self.is_played() || self.stopwatch.is_paused() || self.is_editing_externally {
            return;
        }
        for (event, idle_ms, window) in self.presence.check_time(now) {
            self.record_presence(event, idle_ms, window);
        }
        self.save_drafts_if_due(now);
    }

    /// Returns the time until [`novamind_worker::message::Message::RedrawDue`] is due, or `None` if nothing depends
    /// on the time.
    pub fn time_until_wake(&self) -> Option<Duration> {
        if !self.is_played() || self.stopwatch.is_paused() || self.is_editing_externally {
            return None;
        }
        let next = [self.presence.next_deadline(), self.draft_save_due()].into_iter().flatten().min()?;
        Some(next.saturating_sub(self.stopwatch.elapsed()))
    }

    /// Records that the shell suspends the program.
    pub fn suspend(&mut self) {
        self.save_drafts();
        self.record_view();
        self.record_presence(PresenceEvent::Suspended, None, None);
        self.stopwatch.pause();
    }

    /// Records that the program resumes.
    pub fn resume(&mut self) {
        if self.pause_screen.is_none() {
            self.stopwatch.resume();
        }
        self.record_presence(PresenceEvent::Resumed, None, None);
    }
}

impl Run {
    /// Pauses the view timer, because time during a simulation is not counted as view time.
    pub(super) fn pause_view_timer(&mut self) {
        self.shown_since = None;
    }

    pub(super) fn resume_view_timer(&mut self, now: Duration) {
        self.shown_since = Some(now);
    }
}
