//! Breadcrumbs: the places from which the current one was opened, and the way back.

use super::{App, Run, Stage};
use crate::action::Action;
use crate::context::{Look, ScreenId};

const LONGEST: usize = 8;

/// A place from which the user opened something on another screen.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stop {
    screen: ScreenId,
    pane: usize,
    open: Option<String>,
    /// Escape depth of the next screen when it was opened.
    depth: usize,
}

impl Run {
    /// Returns the titles of the breadcrumbs, and of the open item if it covers its list.
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

    /// Clears the breadcrumbs, because the user navigated elsewhere.
    pub(super) fn forget_trail(&mut self) {
        self.trail.clear();
    }
}

impl App {
    /// Shows a place on another screen that was opened from the current one.
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
            // A place that is already among the breadcrumbs is returned to.
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

    /// Returns to the last breadcrumb if escape has nothing to close here. Returns whether it did.
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
