//! Breadcrumbs: the screens from which the current screen was opened, and navigation back to these screens.

use super::{App, Run, Stage};
use crate::action::Action;
use crate::context::{ScreenContext, ScreenId};

const MAX_BREADCRUMBS: usize = 8;

/// A screen with its state, from which the user opened another screen.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Breadcrumb {
    screen: ScreenId,
    pane: usize,
    open_item: Option<String>,
    /// Escape depth that the opened screen had when it was opened from this screen.
    escape_depth: usize,
}

impl Run {
    /// Returns the titles of the breadcrumbs, and the title of the open item if that item covers its list.
    pub fn breadcrumb_titles(&self, context: &ScreenContext<'_>) -> Vec<String> {
        let mut path = Vec::new();
        for stop in &self.breadcrumbs {
            path.push(stop.screen.action().entry().title.to_owned());
            path.extend(stop.open_item.clone());
        }
        let screen = self.screens.get(self.screen);
        if !screen.covers_list() {
            return path;
        }
        if self.breadcrumbs.last().is_none_or(|stop| screen.escape_depth() > stop.escape_depth) {
            path.push(self.screen.action().entry().title.to_owned());
        }
        path.extend(screen.open_item_title(context));
        path
    }

    /// Clears the breadcrumbs, because the user navigated elsewhere.
    pub(super) fn clear_breadcrumbs(&mut self) {
        self.breadcrumbs.clear();
    }
}

impl App {
    /// Opens another screen and adds the current screen to the breadcrumbs.
    pub(super) fn open_linked_screen(&mut self, screen: ScreenId, prepare: impl FnOnce(&mut Run)) {
        if self.reject_closed_screen(screen) {
            return;
        }
        let Stage::Run(run) = &mut self.stage else { return };
        let company = run.company.clone();
        let context = ScreenContext { company: &company, keys: &self.keys, page_rows: self.page_rows };
        let from = run.screens.get(run.screen);
        let mut stop = Breadcrumb {
            screen: run.screen,
            pane: from.focused_index(),
            open_item: from.open_item_title(&context),
            escape_depth: 0,
        };
        prepare(run);
        if stop.screen != screen {
            // If the target screen already has a breadcrumb, that breadcrumb and all later ones are removed.
            if let Some(at) = run.breadcrumbs.iter().position(|breadcrumb| breadcrumb.screen == screen) {
                run.breadcrumbs.truncate(at);
            } else {
                stop.escape_depth = run.screens.get(screen).escape_depth();
                run.breadcrumbs.push(stop);
            }
            if run.breadcrumbs.len() > MAX_BREADCRUMBS {
                run.breadcrumbs.remove(0);
            }
        }
        self.show_screen(screen);
    }

    /// Goes back to the last breadcrumb if escape has nothing to close on this screen. Returns whether the screen
    /// changed.
    pub(super) fn go_back_to_breadcrumb(&mut self, action: Action) -> bool {
        let Stage::Run(run) = &mut self.stage else { return false };
        if action != Action::Close || run.screens.sql.is_running() {
            return false;
        }
        let depth = run.screens.get(run.screen).escape_depth();
        let Some(stop) = run.breadcrumbs.pop_if(|stop| depth <= stop.escape_depth) else { return false };
        let discarded = match run.screen {
            ScreenId::Tools => run.screens.tools.discard_suggestion(&run.company),
            _ => Vec::new(),
        };
        if run.back_history.last() == Some(&stop.screen) {
            run.back_history.pop();
            run.forward_history.push(run.screen);
        }
        self.switch_screen(stop.screen);
        self.request_screen_data();
        self.with_screen(|screen, _| screen.set_focus(stop.pane));
        self.execute_effects(discarded);
        true
    }
}
