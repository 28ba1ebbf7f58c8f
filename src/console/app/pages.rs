//! Pages over the screen that send a question to the worker when they open.

use super::App;
use crate::action::Action;
use crate::context::{Figure, ScreenContext};
use crate::dialogs::Dialog;
use crate::dialogs::branches::BranchesPage;
use crate::dialogs::causes::CausesDialog;
use crate::dialogs::curve::CurveDialog;
use crate::dialogs::opponents::OpponentsPage;
use crate::dialogs::source_rows::SourceRowsDialog;
use crate::effect::Effect;
use novamind_session::identifiers::Group;
use novamind_session::week_of_day;
use novamind_worker::question::OutgoingQuestion;

/// Number of weeks between the default start of a what-if and the end of a finished run.
const WEEKS_BEFORE_END: u32 = 12;

impl App {
    fn open_page_with_question(&mut self, (page, ask): (impl Dialog + 'static, OutgoingQuestion)) {
        self.open_dialog(page);
        self.execute_effects(vec![Effect::Ask(ask)]);
    }

    /// Opens the participation curve of a group. The default is the group selected on the screen, or the first known
    /// group.
    pub(super) fn show_curve(&mut self, group: Option<Group>) {
        let default = self.run().and_then(|run| {
            let context =
                ScreenContext { company: &run.company, keys: &self.keys, page_rows: self.page_rows };
            let known = &run.company.observation.known_groups;
            let selected = run.screens.get(run.screen).selected_group(&context);
            selected.filter(|group| known.contains(group)).or(known.first().copied())
        });
        if let Some(group) = group.or(default) {
            self.open_page_with_question(CurveDialog::new(group));
        }
    }

    pub(super) fn show_opponents(&mut self) {
        self.open_page_with_question(OpponentsPage::new(self.opponents));
    }

    /// Opens the what-if page. The initial week is the displayed week of a playback, the last completed week of a
    /// running run, or the week twelve weeks before the end of a finished run.
    pub(super) fn show_branches(&mut self) {
        let Some(run) = self.run() else { return };
        let seen = &run.company.observation;
        let last_week = week_of_day(seen.day.min(seen.last_day.saturating_sub(1)) + 1);
        let back = match (run.company.is_running(), self.is_playback()) {
            (false, _) => WEEKS_BEFORE_END,
            (true, true) => 0,
            (true, false) => 1,
        };
        let week = last_week.saturating_sub(back).max(1);
        self.open_page_with_question(BranchesPage::new(week, last_week));
    }

    pub(super) fn show_source_rows(&mut self, Figure { title, sql, .. }: Figure) {
        let Some(sql) = sql else {
            let explain = self.keys.label(Action::Explain).unwrap_or_default();
            return self
                .show_error(format!("{title} has no source rows; press {explain} for an explanation"));
        };
        let here = self.run().map_or("", |run| run.screen.action().entry().title);
        self.record_opened_object("figure", title.clone());
        self.open_page_with_question(SourceRowsDialog::new(format!("{here} › {title}"), sql));
    }

    pub(super) fn show_causes(&mut self, figure: Figure) {
        let Some((quantity, week)) = figure.week_quantity else {
            let key = self.keys.label(Action::Why).unwrap_or_default();
            let focus = self.keys.label(Action::FocusNext).unwrap_or_default();
            return self.show_error(format!(
                "{key} explains a weekly figure: select one with {focus} and the arrow keys"
            ));
        };
        self.record_opened_object("figure", figure.title.clone());
        self.open_page_with_question(CausesDialog::new(figure, quantity, week));
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;

    use ratatui::buffer::Buffer;
    use ratatui::layout::Rect;

    use super::*;
    use crate::app::Order;
    use crate::context::ScreenId;
    use crate::frame;
    use crate::headless::key_event;
    use crate::test_kit::{new_company, settings};
    use novamind_database::QueryResult;
    use novamind_tools::Rejection;
    use novamind_worker::message::{Message, Response};
    use novamind_worker::page_questions::CurveQuestion;
    use novamind_worker::queries::Query;
    use novamind_worker::question::Question;
    use novamind_worker::screen_queries::Reading;

    /// Returns a console with an open run and no worker. The test answers the questions.
    fn console_with_open_run() -> App {
        let mut app = App::new(settings("nowhere".as_ref()));
        app.window = (120, 40);
        app.handle_message(Message::Response(Response::Opened(new_company().into())));
        app.take_orders();
        app
    }

    fn press_key(app: &mut App, key: &str) {
        app.handle_message(Message::Input(key_event(key).expect("a key")));
    }

    /// Removes and returns the collected questions of a type.
    fn take_questions<Q: Question>(app: &mut App) -> Vec<OutgoingQuestion> {
        let ask = |order| match order {
            Order::Ask(ask, _) => ask.question::<Q>().is_some().then_some(ask),
            _ => None,
        };
        app.take_orders().into_iter().filter_map(ask).collect()
    }

    /// Answers a question. With `None`, drops the reply without an answer, as a panicking thread does.
    fn answer_question<Q: Question>(
        app: &mut App,
        ask: &OutgoingQuestion,
        answer: Option<Result<Q::Answer, Rejection>>,
    ) {
        let (sender, messages) = channel();
        let reply = ask.reply::<Q>(sender).expect("of this type");
        match answer {
            Some(answer) => reply.answer(answer),
            None => drop(reply),
        }
        messages.into_iter().for_each(|message| app.handle_message(message));
    }

    fn rejected_answer<T>(words: &str) -> Option<Result<T, Rejection>> {
        Some(Err(Rejection::new("not_possible", words)))
    }

    fn screen_text(app: &App) -> String {
        let mut buffer = Buffer::empty(Rect::new(0, 0, 120, 40));
        frame::draw_frame(app, &mut buffer);
        buffer.content().iter().map(|cell| cell.symbol()).collect()
    }

    #[test]
    fn curve_page_ignores_a_late_answer_to_an_earlier_question() {
        let mut app = console_with_open_run();
        app.start(Effect::ShowCurve(None));
        let first = take_questions::<CurveQuestion>(&mut app);
        press_key(&mut app, ".");
        let second = take_questions::<CurveQuestion>(&mut app);
        answer_question::<CurveQuestion>(&mut app, &first[0], rejected_answer("of the first group"));
        assert!(
            screen_text(&app).contains("asking 2000 leads")
                && !screen_text(&app).contains("of the first group")
        );
        answer_question::<CurveQuestion>(&mut app, &second[0], rejected_answer("of the second group"));
        assert!(screen_text(&app).contains("of the second group"));
    }

    #[test]
    fn curve_page_shows_the_selected_group() {
        for keys in ["3 down ; v", "3 down enter ; v", "7 down ; v"] {
            let mut app = console_with_open_run();
            keys.split(' ').for_each(|key| press_key(&mut app, key));
            let groups: Vec<_> = take_questions::<CurveQuestion>(&mut app)
                .iter()
                .filter_map(|ask| ask.question::<CurveQuestion>().map(|question| question.0.to_string()))
                .collect();
            assert_eq!(groups.last().map(String::as_str), Some("S2"), "{keys}");
        }
    }

    #[test]
    fn answer_for_a_closed_page_is_dropped() {
        let mut app = console_with_open_run();
        app.start(Effect::ShowCurve(None));
        let ask = take_questions::<CurveQuestion>(&mut app);
        press_key(&mut app, "esc");
        app.start(Effect::ShowCurve(None));
        answer_question::<CurveQuestion>(&mut app, &ask[0], rejected_answer("for the page before"));
        assert!(screen_text(&app).contains("asking 2000 leads"));
        press_key(&mut app, "esc");
        let without = screen_text(&app);
        answer_question::<CurveQuestion>(&mut app, &ask[0], rejected_answer("once more"));
        assert_eq!(screen_text(&app), without);
    }

    #[test]
    fn query_results_from_before_a_run_change_are_dropped() {
        let mut app = console_with_open_run();
        app.start(Effect::Show(ScreenId::Customers));
        let before = take_questions::<Reading>(&mut app);
        app.handle_message(Message::Response(Response::RunChanged(new_company().into())));
        let after = take_questions::<Reading>(&mut app);
        let question = |ask: &OutgoingQuestion| ask.question::<Reading>().copied();
        let outgoing_question =
            after.iter().find(|ask| question(ask) == question(&before[0])).expect("asked again");
        answer_question::<Reading>(&mut app, &before[0], rejected_answer("of before"));
        assert!(!screen_text(&app).contains("of before"));
        answer_question::<Reading>(&mut app, outgoing_question, rejected_answer("of now"));
        assert!(screen_text(&app).contains("of now"));
    }

    #[test]
    fn page_stops_waiting_after_its_question_panics() {
        let mut app = console_with_open_run();
        app.start(Effect::ShowCurve(None));
        let ask = take_questions::<CurveQuestion>(&mut app);
        answer_question::<CurveQuestion>(&mut app, &ask[0], None);
        assert!(
            screen_text(&app).contains("no answer because")
                && !screen_text(&app).contains("asking 2000 leads")
        );
        press_key(&mut app, "esc");
        app.start(Effect::RunSql("SELECT 1".to_owned()));
        let ask = take_questions::<Query>(&mut app);
        assert!(app.is_waiting());
        answer_question::<Query>(&mut app, &ask[0], None);
        assert!(!app.is_waiting() && screen_text(&app).contains("no answer because"));
        app.start(Effect::RunSql("SELECT 2".to_owned()));
        let ask = take_questions::<Query>(&mut app);
        answer_question::<Query>(
            &mut app,
            &ask[0],
            Some(Ok((QueryResult::default(), std::time::Duration::ZERO))),
        );
        assert!(!app.is_waiting());
    }

    #[test]
    fn covered_page_keeps_its_answer() {
        let mut app = console_with_open_run();
        app.start(Effect::ShowCurve(None));
        let ask = take_questions::<CurveQuestion>(&mut app);
        app.start(Effect::ShowText("over".to_owned(), "the curve".to_owned()));
        answer_question::<CurveQuestion>(&mut app, &ask[0], rejected_answer("the answer was rejected"));
        press_key(&mut app, "esc");
        assert!(screen_text(&app).contains("the answer was rejected"));
    }
}
