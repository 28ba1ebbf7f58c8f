//! Playback actions, and responses that change the playback.

use std::sync::atomic::Ordering;

use super::{App, Busy, Closing, DaysRun, Order, Run, Stage};
use crate::action::{Action, Scope};
use crate::dialogs::reader::Reader;
use crate::dialogs::seek::Seek;
use crate::dialogs::take_over::TakeOver;
use crate::viewer::{Viewer, told};
use novamind_session::Goal;
use novamind_worker::Job;
use novamind_worker::asking::Pending;
use novamind_worker::message::Arrival;

const OF_PLAYERS: [Action; 17] = [
    Action::NextWeek,
    Action::Undo,
    Action::Redo,
    Action::Tour,
    Action::Apply,
    Action::SendOffer,
    Action::TakeAsk,
    Action::RejectOffer,
    Action::Compose,
    Action::Reply,
    Action::SendPost,
    Action::EditMemo,
    Action::SaveMemo,
    Action::FindGroup,
    Action::StudyGroup,
    // Threads are marked for offers.
    Action::Mark,
    Action::MarkAll,
];

impl Run {
    /// Returns the scopes of the focused place. Playback keys take precedence, except while text is typed.
    pub(super) fn scopes(&self) -> Vec<Scope> {
        let mut scopes = self.screens.get(self.here).scopes();
        let typing = scopes.first().is_some_and(|scope| scope.is_text());
        if self.viewer.is_some() && !typing {
            scopes.insert(0, Scope::Viewer);
        }
        scopes
    }

    pub(super) fn hints(&self) -> Vec<Action> {
        let own = self.screens.get(self.here).hints();
        let typing = self.scopes().first().is_some_and(|scope| scope.is_text());
        let replay =
            [Action::WeekBack, Action::WeekForward, Action::PlayPause, Action::TakeOver, Action::LeaveViewer];
        match &self.viewer {
            Some(_) if !typing => replay
                .into_iter()
                .chain(own.into_iter().filter(|action| !OF_PLAYERS.contains(action)))
                .collect(),
            _ => own,
        }
    }
}

impl App {
    pub(super) fn is_replay(&self) -> bool {
        self.run().is_some_and(|run| run.viewer.is_some())
    }

    fn viewer(&mut self) -> Option<&mut Viewer> {
        match &mut self.stage {
            Stage::Run(run) => run.viewer.as_mut(),
            Stage::Menu(_) | Stage::Visit(_) => None,
        }
    }

    pub(super) fn complain_of_replay(&mut self) {
        let key = self.keys.label(Action::TakeOver).unwrap_or_default();
        self.complain(format!("this is a replay; press {key} to take over"));
    }

    /// Rejects actions that change the run. Returns whether it did.
    pub(super) fn refuses_in_replay(&mut self, action: Action) -> bool {
        // In a finished run the same key shows the final page.
        let shows_end = action == Action::NextWeek && self.run().is_some_and(|run| !run.company.is_running());
        let refused = self.is_replay() && OF_PLAYERS.contains(&action) && !shows_end;
        if refused {
            self.complain_of_replay();
        }
        refused
    }

    /// Returns whether the console was seeking.
    pub(super) fn stop_on_the_way(&mut self) -> bool {
        let goes = self.busy.is_some();
        match self.viewer() {
            Some(viewer) if goes && viewer.goes => {
                viewer.stop.store(true, Ordering::Relaxed);
                true
            }
            _ => false,
        }
    }

    pub(super) fn act_in_viewer(&mut self, action: Action) {
        let beside = self.window.0 >= Viewer::BESIDE;
        let Some(viewer) = self.viewer() else { return };
        match action {
            Action::WeekBack => self.go(Goal::Weeks(-1)),
            Action::WeekForward => self.go(Goal::Weeks(1)),
            Action::LineBack => self.go(Goal::Lines(-1)),
            Action::LineForward => self.go(Goal::Lines(1)),
            Action::ReelStart => self.go(Goal::First),
            Action::ReelEnd => self.go(Goal::Last),
            Action::SeekWeek => {
                let weeks = viewer.place.weeks;
                self.open(Seek::new(weeks));
            }
            Action::PlayPause => self.play_or_pause(),
            Action::Faster | Action::Slower => {
                viewer.change_speed(action == Action::Faster);
                let text = viewer.speed_in_words();
                self.say(text);
            }
            Action::Decisions if beside => viewer.shows_decisions = !viewer.shows_decisions,
            Action::Decisions | Action::DecisionsWhole => self.show_decisions(),
            Action::DecisionsUp => viewer.scroll_by(-3),
            Action::DecisionsDown => viewer.scroll_by(3),
            Action::TakeOver => self.ask_to_take_over(),
            Action::LeaveViewer => self.leave(Closing::ToMenu),
            _ => {}
        }
    }

    fn show_decisions(&mut self) {
        let Some(names) = self.run().map(|run| run.company.names.clone()) else { return };
        let Some(viewer) = self.viewer() else { return };
        let (title, text) = (told::title(&viewer.place.chapter), told::whole(&viewer.place, &names));
        self.open(Reader::new(title, text));
    }

    fn ask_to_take_over(&mut self) {
        let Some(place) = self.viewer().map(|viewer| viewer.place.clone()) else { return };
        match place.no_branch {
            Some(reason) => self.complain(reason),
            None => self.open(TakeOver::new(place.day, place.chapter.week)),
        }
    }

    pub(super) fn go(&mut self, goal: Goal) {
        if self.busy.is_some() {
            return self.complain("already seeking; esc stops it");
        }
        let Some(viewer) = self.viewer() else { return };
        let place = &viewer.place;
        if place.at_end && goal == Goal::Weeks(1) {
            let text = if place.follows { "no more actions recorded yet" } else { "end of the record" };
            viewer.playing = false;
            return self.say(text);
        }
        let target = match goal {
            Goal::First => 0,
            Goal::Last => place.recorded_day,
            Goal::Week(week) => 7 * week.min(place.weeks),
            Goal::Weeks(weeks) => place.day.saturating_add_signed(7 * weeks),
            Goal::Lines(_) => place.day,
        };
        let back = target < place.day || matches!(goal, Goal::Lines(count) if count < 0);
        let from = if back { 0 } else { place.day };
        viewer.stop.store(false, Ordering::Relaxed);
        viewer.goes = true;
        let stop = viewer.stop.clone();
        let days = Some(DaysRun::between(from, target.max(from)));
        self.busy = Some(Busy { days, ..Busy::with("seeking") });
        self.orders.push(Order::Job(Job::Go(goal, stop)));
    }

    fn play_or_pause(&mut self) {
        let Some(viewer) = self.viewer() else { return };
        if viewer.playing {
            viewer.playing = false;
            viewer.ordered = false;
            self.orders.push(Order::Job(Job::Hold));
            return self.say("paused");
        }
        if viewer.place.at_end {
            return self.say("end of the record; go back to replay it");
        }
        viewer.playing = true;
        let text = viewer.speed_in_words();
        self.say(format!("playing, {text}"));
        self.play_on();
    }

    /// Requests the next week once the screen is complete.
    pub(super) fn play_on(&mut self) {
        let waits =
            self.busy.is_some() || self.run().is_some_and(|run| run.asked.values().any(Pending::is_waiting));
        let Some(viewer) = self.viewer() else { return };
        if viewer.playing && !viewer.ordered && !waits {
            viewer.ordered = true;
            let pause = viewer.pause();
            self.orders.push(Order::Job(Job::GoOn(pause)));
        }
    }

    pub(super) fn arrived(&mut self, arrival: Arrival, asked: bool) {
        let Arrival { company, place, problem } = arrival;
        if asked {
            self.busy = None;
        }
        let Stage::Run(run) = &mut self.stage else { return };
        let Some(viewer) = &mut run.viewer else { return };
        let news = place.lines != viewer.place.lines && place.line == viewer.place.line;
        viewer.arrive(place, asked);
        let ends = viewer.playing && viewer.place.at_end;
        if ends {
            viewer.playing = false;
        }
        if let Some(company) = company {
            self.changed(company);
        }
        match problem {
            Some(problem) => self.complain(problem),
            None if ends => self.say("end of the record"),
            None if news => self.say("new actions recorded"),
            None => {}
        }
        self.play_on();
    }
}
