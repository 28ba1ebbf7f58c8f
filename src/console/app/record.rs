//! Recording of user activity: viewed screens, objects, dialogs and terms, edited texts, and presence. The session
//! thread writes the events; nothing here blocks.

use std::time::Duration;

use crossterm::event::{Event, KeyEventKind, MouseEventKind};

use super::{App, Layer, Order, Run, Stage};
use crate::attention::Edit;
use crate::context::ScreenId;
use novamind_record::rules::DraftsKept;
use novamind_record::trajectory::record::{
    Activity, DialogOutcome, Draft, DraftOutcome, Help, PresenceEvent, Select, View,
};
use novamind_session::{Interface, Session};
use novamind_tools::ToolId;
use novamind_worker::Job;
use novamind_worker::request::Request;

const OF_FILING: [&str; 2] = ["rationale", "forecasts"];

impl App {
    /// Returns whether a run is being played. Views of a playback are not recorded.
    fn is_played(&self) -> bool {
        self.run().is_some_and(|run| run.viewer.is_none())
    }

    pub(super) fn record(&mut self, note: impl FnOnce(&mut Session) + Send + 'static) {
        self.orders.push(Order::Job(Job::Note(Box::new(note))));
    }

    pub(super) fn note(&mut self, activity: Activity) {
        if self.is_played() {
            self.record(|session| session.activity().note(activity));
        }
    }

    fn note_presence(&mut self, event: PresenceEvent, idle_ms: Option<u64>, window: Option<(u16, u16)>) {
        if self.is_played() {
            self.record(move |session| session.activity().note_presence(event, idle_ms, window));
        }
    }

    pub(super) fn take_up(&mut self) {
        if self.is_played() {
            self.presence.begin(self.stopwatch.now());
            let window = (self.window.0 > 0).then_some(self.window);
            self.orders.push(Order::Job(Job::TakeUp(Interface { name: "console", window })));
        }
    }

    /// Records that the user leaves the run and everything open in it.
    pub(super) fn put_down(&mut self) {
        self.keep_texts();
        self.close_layers();
        for place in self.typing.places() {
            self.end_text(&place, DraftOutcome::Left);
        }
        self.close_view();
    }

    pub(super) fn take_input(&mut self, event: Event) {
        let now = self.stopwatch.now();
        let noted = match &event {
            Event::Key(key) if key.kind == KeyEventKind::Release => Vec::new(),
            Event::Mouse(mouse) if mouse.kind == MouseEventKind::Moved => Vec::new(),
            Event::Key(_) | Event::Paste(_) => self.presence.key(false, now),
            Event::Mouse(_) => self.presence.key(true, now),
            Event::FocusGained => self.presence.focus(true).into_iter().collect(),
            Event::FocusLost => self.presence.focus(false).into_iter().collect(),
            Event::Resize(columns, rows) => {
                self.presence.resize((*columns, *rows), now);
                Vec::new()
            }
        };
        for (event, idle_ms, window) in noted {
            self.note_presence(event, idle_ms, window);
        }
        if self.cover.is_some() {
            return self.input_under_cover(event);
        }
        self.edit = if matches!(event, Event::Paste(_)) { Edit::Pasted } else { Edit::Typed };
        let before = self.edited();
        self.input(event);
        if let (Some((place, old)), Some((same, new))) = (before, self.edited())
            && place == same
            && old != new
        {
            self.typing.change(&place, &old, new, self.edit, now);
        }
        self.touch_texts();
    }

    /// Returns the place and content of the text that is being edited.
    fn edited(&self) -> Option<(String, String)> {
        let run = self.run().filter(|run| run.viewer.is_none())?;
        match self.layers.last() {
            Some(Layer::Filing) => crate::dialogs::Dialog::edited(&run.filing),
            Some(Layer::Dialog(dialog)) => dialog.edited(),
            None => run.screens.get(run.here).edited(),
        }
    }

    /// Records the end of a view: the screen was left, a week started or the clock stopped. The time under a dialog
    /// counts for the screen; the dialog has its own event.
    pub(super) fn close_view(&mut self) {
        let now = self.stopwatch.now();
        let Stage::Run(run) = &mut self.stage else { return };
        // Simulated time is not counted as viewing.
        let Some(since) = run.shown.replace(now) else {
            run.shown = None;
            return;
        };
        let view = View {
            screen: run.here.id().to_owned(),
            from: run.came_from.map_or(String::new(), |screen| screen.id().to_owned()),
            for_ms: u64::try_from(now.saturating_sub(since).as_millis()).unwrap_or(u64::MAX),
        };
        self.note(Activity::View(view));
    }

    pub(super) fn lay(&mut self, layer: Layer) {
        self.layers.push(layer, self.stopwatch.now());
        self.note_step();
    }

    pub(super) fn note_step(&mut self) {
        let step = match (self.layers.last(), &self.stage) {
            (Some(Layer::Filing), Stage::Run(run)) => crate::dialogs::Dialog::step(&run.filing),
            (Some(Layer::Dialog(dialog)), _) => dialog.step(),
            _ => None,
        };
        if let Some(step) = step {
            self.layers.enter_step(step, self.stopwatch.now());
        }
    }

    pub(super) fn close_layer(&mut self, confirmed: bool) {
        let outcome = if confirmed { DialogOutcome::Confirmed } else { DialogOutcome::Cancelled };
        if let Some(used) = self.layers.pop(outcome, self.stopwatch.now()) {
            self.note(Activity::Dialog(used));
        }
    }

    pub(super) fn close_layers(&mut self) {
        while !self.layers.is_empty() {
            self.close_layer(false);
        }
    }

    /// Records that an object was opened: an item of a list, or the rows of a figure.
    pub(super) fn note_opened(&mut self, what: &str, which: String) {
        if let Some(screen) = self.run().map(|run| run.here.id().to_owned()) {
            self.note(Activity::Select(Select { screen, what: what.to_owned(), which }));
        }
    }

    pub(super) fn send_texts(&mut self, request: &Request) {
        match request {
            Request::Advance { .. } => self.leave_filing(DraftOutcome::Sent),
            Request::SetMemo(_) => self.end_text("notes", DraftOutcome::Sent),
            Request::Call { tool, .. } => {
                if *tool == ToolId::PostSocialMedia {
                    self.end_text("post", DraftOutcome::Sent);
                }
                self.end_text(&format!("form {tool}"), DraftOutcome::Sent);
            }
            _ => {}
        }
    }

    pub(super) fn leave_filing(&mut self, outcome: DraftOutcome) {
        OF_FILING.into_iter().for_each(|place| self.end_text(place, outcome));
    }

    pub(super) fn end_text(&mut self, place: &str, outcome: DraftOutcome) {
        let kept = self.run().map_or(DraftsKept::None, |run| run.company.rules.drafts);
        if let Some(draft) = self.typing.end(place, outcome, kept == DraftsKept::Text) {
            self.note_draft(draft);
        }
    }

    pub(super) fn note_draft(&mut self, draft: Draft) {
        if self.run().is_some_and(|run| run.company.rules.drafts != DraftsKept::None) {
            self.note(Activity::Draft(draft));
        }
    }

    /// Records selections, help terms and abandoned drafts that followed from the last message.
    pub(super) fn settle_record(&mut self) {
        if !self.is_played() {
            return;
        }
        self.note_selection();
        self.note_term();
        let left: Vec<String> =
            self.typing.places().into_iter().filter(|place| !self.is_at_text(place)).collect();
        for place in left {
            self.end_text(&place, DraftOutcome::Left);
        }
    }

    fn note_selection(&mut self) {
        let Some(run) = self.run() else { return };
        let here = run.here;
        let opened = self.look_at_screen().map(|(what, which)| (here, what, which));
        let Stage::Run(run) = &mut self.stage else { return };
        if run.selected == opened {
            return;
        }
        run.selected.clone_from(&opened);
        if let Some((_, what, which)) = opened {
            self.note_opened(what, which);
        }
    }

    fn look_at_screen(&self) -> Option<(&'static str, String)> {
        let run = self.run()?;
        let look = crate::context::Look { company: &run.company, keys: &self.keys, page: self.page };
        run.screens.get(run.here).open_object(&look)
    }

    fn note_term(&mut self) {
        let term = match self.layers.last() {
            Some(Layer::Dialog(dialog)) => dialog.term(),
            _ => None,
        };
        if term == self.term {
            return;
        }
        self.term.clone_from(&term);
        if let (Some(term), Some(run)) = (term, self.run()) {
            let below = self.layers.below().map(str::to_owned);
            let place = below.unwrap_or_else(|| run.here.id().to_owned());
            self.note(Activity::Help(Help { term, place }));
        }
    }

    /// Returns whether the place of a text is still visible.
    fn is_at_text(&self, place: &str) -> bool {
        let Some(run) = self.run() else { return false };
        if OF_FILING.contains(&place) {
            return self.layers.iter().any(|layer| matches!(layer, Layer::Filing));
        }
        match place {
            "notes" => run.here == ScreenId::Journal,
            "sql" => run.here == ScreenId::Sql,
            "post" => run.here == ScreenId::Social,
            form => {
                run.here == ScreenId::Tools && form.strip_prefix("form ") == run.screens.tools.form_name()
            }
        }
    }

    pub(super) fn pass_time(&mut self) {
        let now = self.stopwatch.now();
        if !self.is_played() || self.stopwatch.is_halted() {
            return;
        }
        for (event, idle_ms, window) in self.presence.pass(now) {
            self.note_presence(event, idle_ms, window);
        }
        self.keep_texts_in_time(now);
    }

    /// Returns the time until [`novamind_worker::message::Message::Time`] is due, or `None` if nothing depends on it.
    pub fn wakes_after(&self) -> Option<Duration> {
        if !self.is_played() || self.stopwatch.is_halted() {
            return None;
        }
        let next = [self.presence.next(), self.texts_due()].into_iter().flatten().min()?;
        Some(next.saturating_sub(self.stopwatch.now()))
    }

    /// Records that the shell suspends the program.
    pub fn suspend(&mut self) {
        self.keep_texts();
        self.close_view();
        self.note_presence(PresenceEvent::Suspended, None, None);
        self.stopwatch.halt();
    }

    /// Records that the program resumes.
    pub fn resume(&mut self) {
        if self.cover.is_none() {
            self.stopwatch.run();
        }
        self.note_presence(PresenceEvent::Resumed, None, None);
    }
}

impl Run {
    /// Pauses the view timer: simulated time is not counted as viewing.
    pub(super) fn stop_looking(&mut self) {
        self.shown = None;
    }

    pub(super) fn look_again(&mut self, now: Duration) {
        self.shown = Some(now);
    }
}
