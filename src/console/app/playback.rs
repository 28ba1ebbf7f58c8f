//! Actions of the playback, and worker responses that change the playback.

use std::sync::atomic::Ordering;

use super::{App, BusyState, ExitTarget, Order, Run, SimulationProgress, Stage};
use crate::action::{Action, Scope};
use crate::dialogs::seek_week::SeekWeekDialog;
use crate::dialogs::take_over::TakeOverDialog;
use crate::dialogs::text_dialog::TextDialog;
use crate::playback::{PlaybackViewer, entry_text};
use novamind_session::SeekTarget;
use novamind_worker::Job;
use novamind_worker::message::PlaybackUpdate;
use novamind_worker::question::Pending;

const PLAYER_ACTIONS: [Action; 17] = [
    Action::NextWeek,
    Action::Undo,
    Action::Redo,
    Action::Tour,
    Action::Apply,
    Action::SendOffer,
    Action::MatchAskedPrice,
    Action::RejectOffer,
    Action::Compose,
    Action::Reply,
    Action::SendPost,
    Action::EditNotes,
    Action::SaveNotes,
    Action::FindGroup,
    Action::StudyGroup,
    // Marking a thread prepares an offer.
    Action::Mark,
    Action::MarkAll,
];

impl Run {
    /// Returns the scopes of the focused pane or dialog. Playback keys take precedence, except while text is typed.
    pub(super) fn scopes(&self) -> Vec<Scope> {
        let mut scopes = self.screens.get(self.screen).scopes();
        let typing = scopes.first().is_some_and(|scope| scope.is_text());
        if self.playback.is_some() && !typing {
            scopes.insert(0, Scope::Playback);
        }
        scopes
    }

    pub(super) fn hints(&self) -> Vec<Action> {
        let actions = self.screens.get(self.screen).hints();
        let typing = self.scopes().first().is_some_and(|scope| scope.is_text());
        let replay = [
            Action::WeekBack,
            Action::WeekForward,
            Action::PlayPause,
            Action::TakeOver,
            Action::LeavePlayback,
        ];
        match &self.playback {
            Some(_) if !typing => replay
                .into_iter()
                .chain(actions.into_iter().filter(|action| !PLAYER_ACTIONS.contains(action)))
                .collect(),
            _ => actions,
        }
    }
}

impl App {
    pub(super) fn is_playback(&self) -> bool {
        self.run().is_some_and(|run| run.playback.is_some())
    }

    fn playback_mut(&mut self) -> Option<&mut PlaybackViewer> {
        match &mut self.stage {
            Stage::Run(run) => run.playback.as_mut(),
            Stage::Menu(_) | Stage::Study(_) => None,
        }
    }

    pub(super) fn show_playback_error(&mut self) {
        let key = self.keys.label(Action::TakeOver).unwrap_or_default();
        self.show_error(format!("this is a replay; press {key} to take over"));
    }

    /// Rejects an action that would change the run. Returns whether the action was rejected.
    pub(super) fn reject_in_playback(&mut self, action: Action) -> bool {
        // In a finished run, the next-week key shows the final page.
        let shows_end = action == Action::NextWeek && self.run().is_some_and(|run| !run.company.is_running());
        let refused = self.is_playback() && PLAYER_ACTIONS.contains(&action) && !shows_end;
        if refused {
            self.show_playback_error();
        }
        refused
    }

    /// Stops seeking. Returns whether the console was seeking.
    pub(super) fn stop_seeking(&mut self) -> bool {
        let was_seeking = self.busy.is_some();
        match self.playback_mut() {
            Some(viewer) if was_seeking && viewer.is_seeking => {
                viewer.stop_flag.store(true, Ordering::Relaxed);
                true
            }
            _ => false,
        }
    }

    pub(super) fn handle_playback_action(&mut self, action: Action) {
        let is_wide = self.window.0 >= PlaybackViewer::MIN_WIDTH_FOR_DECISIONS;
        let Some(viewer) = self.playback_mut() else { return };
        match action {
            Action::WeekBack => self.seek(SeekTarget::Weeks(-1)),
            Action::WeekForward => self.seek(SeekTarget::Weeks(1)),
            Action::LineBack => self.seek(SeekTarget::Lines(-1)),
            Action::LineForward => self.seek(SeekTarget::Lines(1)),
            Action::SeekStart => self.seek(SeekTarget::First),
            Action::SeekEnd => self.seek(SeekTarget::Last),
            Action::SeekWeek => {
                let weeks = viewer.position.weeks;
                self.open_dialog(SeekWeekDialog::new(weeks));
            }
            Action::PlayPause => self.toggle_playing(),
            Action::Faster | Action::Slower => {
                viewer.change_speed(action == Action::Faster);
                let text = viewer.speed_label();
                self.show_status(text);
            }
            Action::Decisions if is_wide => viewer.shows_decisions = !viewer.shows_decisions,
            Action::Decisions | Action::DecisionsInFull => self.open_decisions(),
            Action::DecisionsUp => viewer.scroll_by(-3),
            Action::DecisionsDown => viewer.scroll_by(3),
            Action::TakeOver => self.open_take_over(),
            Action::LeavePlayback => self.exit_run(ExitTarget::Menu),
            _ => {}
        }
    }

    fn open_decisions(&mut self) {
        let Some(names) = self.run().map(|run| run.company.enterprise_names.clone()) else { return };
        let Some(viewer) = self.playback_mut() else { return };
        let (title, text) = (
            entry_text::chapter_title(&viewer.position.chapter),
            entry_text::decisions_text(&viewer.position, &names),
        );
        self.open_dialog(TextDialog::new(title, text));
    }

    fn open_take_over(&mut self) {
        let Some(place) = self.playback_mut().map(|viewer| viewer.position.clone()) else { return };
        match place.branch_rejection {
            Some(reason) => self.show_error(reason),
            None => self.open_dialog(TakeOverDialog::new(place.day, place.chapter.week)),
        }
    }

    pub(super) fn seek(&mut self, goal: SeekTarget) {
        if self.busy.is_some() {
            return self.show_error("already seeking; esc stops seeking");
        }
        let Some(viewer) = self.playback_mut() else { return };
        let place = &viewer.position;
        if place.is_at_end && goal == SeekTarget::Weeks(1) {
            let text = if place.is_following { "no more actions recorded yet" } else { "end of the record" };
            viewer.playing = false;
            return self.show_status(text);
        }
        let target = match goal {
            SeekTarget::First => 0,
            SeekTarget::Last => place.recorded_day,
            SeekTarget::Week(week) => 7 * week.min(place.weeks),
            SeekTarget::Weeks(weeks) => place.day.saturating_add_signed(7 * weeks),
            SeekTarget::Lines(_) => place.day,
        };
        let back = target < place.day || matches!(goal, SeekTarget::Lines(count) if count < 0);
        let from = if back { 0 } else { place.day };
        viewer.stop_flag.store(false, Ordering::Relaxed);
        viewer.is_seeking = true;
        let stop = viewer.stop_flag.clone();
        let days = Some(SimulationProgress::new(from, target.max(from)));
        self.busy = Some(BusyState { progress: days, ..BusyState::new("seeking") });
        self.orders.push(Order::Job(Job::Seek(goal, stop)));
    }

    fn toggle_playing(&mut self) {
        let Some(viewer) = self.playback_mut() else { return };
        if viewer.playing {
            viewer.playing = false;
            viewer.has_requested_week = false;
            self.orders.push(Order::Job(Job::CancelNextWeek));
            return self.show_status("paused");
        }
        if viewer.position.is_at_end {
            return self.show_status("end of the record; go back to replay the run");
        }
        viewer.playing = true;
        let text = viewer.speed_label();
        self.show_status(format!("playing, {text}"));
        self.request_next_week();
    }

    /// Requests the next week once all data of the screen has arrived.
    pub(super) fn request_next_week(&mut self) {
        let waits = self.busy.is_some()
            || self.run().is_some_and(|run| run.requested_queries.values().any(Pending::is_waiting));
        let Some(viewer) = self.playback_mut() else { return };
        if viewer.playing && !viewer.has_requested_week && !waits {
            viewer.has_requested_week = true;
            let pause = viewer.week_interval();
            self.orders.push(Order::Job(Job::ScheduleNextWeek(pause)));
        }
    }

    pub(super) fn handle_playback_update(&mut self, arrival: PlaybackUpdate, asked: bool) {
        let PlaybackUpdate { company, position: place, problem } = arrival;
        if asked {
            self.busy = None;
        }
        let Stage::Run(run) = &mut self.stage else { return };
        let Some(viewer) = &mut run.playback else { return };
        let news = place.lines != viewer.position.lines && place.line == viewer.position.line;
        viewer.update_position(place, asked);
        let ends = viewer.playing && viewer.position.is_at_end;
        if ends {
            viewer.playing = false;
        }
        if let Some(company) = company {
            self.update_company(company);
        }
        match problem {
            Some(problem) => self.show_error(problem),
            None if ends => self.show_status("end of the record"),
            None if news => self.show_status("new actions recorded"),
            None => {}
        }
        self.request_next_week();
    }
}
