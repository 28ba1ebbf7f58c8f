//! Pages over the screen that ask the worker when they are opened.

use super::App;
use crate::action::Action;
use crate::context::Figure;
use crate::dialogs::Dialog;
use crate::dialogs::branches::BranchesPage;
use crate::dialogs::curve::CurvePage;
use crate::dialogs::opponents::OpponentsPage;
use crate::dialogs::rows::RowsBehind;
use crate::dialogs::why::WhyBox;
use crate::effect::Effect;
use novamind_session::identifiers::Group;
use novamind_session::week_of;
use novamind_worker::asking::Ask;

/// Weeks before the end of a run that is over at which a what-if begins.
const WEEKS_BEFORE_END: u32 = 12;

impl App {
    fn open_asking(&mut self, (page, ask): (impl Dialog + 'static, Ask)) {
        self.open(page);
        self.follow(vec![Effect::Ask(ask)]);
    }

    /// The curve of a group beside the plans; of the first known one if none is named.
    pub(super) fn show_curve(&mut self, group: Option<Group>) {
        let known = self.run().and_then(|run| run.company.seen.known_groups.first().copied());
        if let Some(group) = group.or(known) {
            self.open_asking(CurvePage::new(group));
        }
    }

    /// The strong policies beside the run that is over.
    pub(super) fn show_opponents(&mut self) {
        self.open_asking(OpponentsPage::new(self.opponents));
    }

    /// The page of decisions, from the week that is shown on; in a run that is played, from the last one that ran on, and where
    /// the run is over from so far before its end that figures of twelve weeks follow.
    pub(super) fn show_branches(&mut self) {
        let Some(run) = self.run() else { return };
        let seen = &run.company.seen;
        let last_week = week_of(seen.day.min(seen.last_day.saturating_sub(1)) + 1);
        let back = match (run.company.is_running(), self.is_replay()) {
            (false, _) => WEEKS_BEFORE_END,
            (true, true) => 0,
            (true, false) => 1,
        };
        let week = last_week.saturating_sub(back).max(1);
        self.open_asking(BranchesPage::new(week, last_week));
    }

    /// The rows that make up a figure.
    pub(super) fn show_rows_of(&mut self, Figure { title, sql, .. }: Figure) {
        let Some(sql) = sql else {
            let explain = self.keys.label(Action::Explain).unwrap_or_default();
            return self.complain(format!("{title} has no source rows; {explain} explains it"));
        };
        let here = self.run().map_or("", |run| run.here.action().entry().title);
        self.note_opened("figure", title.clone());
        self.open_asking(RowsBehind::new(format!("{here} › {title}"), sql));
    }

    /// Why a figure of a week changed.
    pub(super) fn ask_why(&mut self, figure: Figure) {
        let Some((quantity, week)) = figure.why else {
            let key = self.keys.label(Action::Why).unwrap_or_default();
            return self.complain(format!(
                "{key} explains a week's cash, leads, sales, churn, service: Overview, Cash, Customers"
            ));
        };
        self.note_opened("figure", figure.title.clone());
        self.open_asking(WhyBox::new(figure, quantity, week));
    }
}
