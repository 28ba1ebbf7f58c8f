//! Where enter led: the places one came from, and the way back along them.

use super::{App, Run, Stage};
use crate::action::Action;
use crate::context::{Look, ScreenId};

/// Most places that are remembered.
const LONGEST: usize = 8;

/// A place from which something was opened on another screen.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stop {
    screen: ScreenId,
    /// The pane that had the focus.
    pane: usize,
    /// What was open there: a group, a tool.
    open: Option<String>,
    /// How far esc went back inside of the next screen when it was reached.
    depth: usize,
}

impl Run {
    /// Names of the places one came from, and of what is open here instead of the list that led to it.
    pub fn path(&self, look: &Look<'_>) -> Vec<String> {
        let mut path = Vec::new();
        for stop in &self.trail {
            path.push(stop.screen.action().entry().title.to_owned());
            path.extend(stop.open.clone());
        }
        let screen = self.screens.get(self.here);
        if !screen.covers_list() {
            return path;
        }
        if self.trail.last().is_none_or(|stop| screen.depth() > stop.depth) {
            path.push(self.here.action().entry().title.to_owned());
        }
        path.extend(screen.open_here(look));
        path
    }

    /// What is shown is left for another place by a way of its own: nothing leads back along the path any more.
    pub(super) fn forget_trail(&mut self) {
        self.trail.clear();
    }
}

impl App {
    /// Shows a place on a screen that was opened from where one is.
    pub(super) fn lead_to(&mut self, screen: ScreenId, prepare: impl FnOnce(&mut Run)) {
        if self.is_kept_shut(screen) {
            return;
        }
        let Stage::Run(run) = &mut self.stage else { return };
        let company = run.company.clone();
        let look = Look { company: &company, keys: &self.keys, page: self.page };
        let from = run.screens.get(run.here);
        let mut stop = Stop { screen: run.here, pane: from.focus(), open: from.open_here(&look), depth: 0 };
        prepare(run);
        if stop.screen != screen {
            // A place that is on the path already is gone back to.
            if let Some(at) = run.trail.iter().position(|own| own.screen == screen) {
                run.trail.truncate(at);
            } else {
                stop.depth = run.screens.get(screen).depth();
                run.trail.push(stop);
            }
            if run.trail.len() > LONGEST {
                run.trail.remove(0);
            }
        }
        self.show(screen);
    }

    /// Goes back along the path if esc has nothing to close here. True if it did.
    pub(super) fn goes_back_along(&mut self, action: Action) -> bool {
        let Stage::Run(run) = &mut self.stage else { return false };
        if action != Action::Close || run.screens.sql.is_running() {
            return false;
        }
        let depth = run.screens.get(run.here).depth();
        let Some(stop) = run.trail.pop_if(|stop| depth <= stop.depth) else { return false };
        if run.before.last() == Some(&stop.screen) {
            run.before.pop();
            run.after.push(run.here);
        }
        self.move_to(stop.screen);
        self.load();
        self.with_screen(|screen, _| screen.set_focus(stop.pane));
        true
    }
}
