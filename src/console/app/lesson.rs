//! Lessons in the console: the task next to the screen or as a page, weeks that run without a dialog, closed screens,
//! and the debrief.

use std::sync::Arc;

use super::{App, Layer, Run, Stage};
use crate::action::Action;
use crate::context::ScreenId;
use crate::dialogs::confirm::ConfirmDialog;
use crate::dialogs::debrief::DebriefPage;
use crate::dialogs::lesson::LessonDialog;
use crate::dialogs::retry_step::RetryStepDialog;
use crate::effect::Effect;
use crate::lesson::{MIN_WIDTH_FOR_TASK, closed_reason};
use novamind_course::{Debrief, LessonStatus};
use novamind_report::pluralize;
use novamind_tools::Rejection;
use novamind_worker::company::DisplayedCompany;
use novamind_worker::request::{LessonRequest, Request};

const NO_RATIONALE: &str = "(not asked for in this lesson)";
const NO_LESSON: &str = "this run is not part of a lesson; the start menu lists lessons";

/// Console state of the lesson that a run belongs to.
#[derive(Default)]
pub struct LessonState {
    /// Whether the side pane with the task is hidden.
    pub is_task_hidden: bool,
    /// The debrief, once the worker has computed it.
    pub debrief: Option<Arc<Result<Debrief, Rejection>>>,
}

impl Run {
    /// Returns the lesson if its task is shown next to the screen in a window of this width.
    pub fn side_task(&self, columns: u16) -> Option<&LessonStatus> {
        let fits = columns >= MIN_WIDTH_FOR_TASK
            && !self.zoomed
            && !self.lesson.is_task_hidden
            && self.playback.is_none();
        self.company.lesson.as_ref().filter(|_| fits)
    }
}

impl App {
    fn lesson_page(&self) -> Option<&LessonStatus> {
        self.run()?.company.lesson.as_ref()
    }

    /// Shows or hides the task next to the screen. In a narrow window, opens the task as a page.
    pub(super) fn toggle_lesson_task(&mut self) {
        if self.lesson_page().is_none() {
            return self.show_error(NO_LESSON);
        }
        if self.window.0 < MIN_WIDTH_FOR_TASK {
            return self.open_dialog(LessonDialog::default());
        }
        if let Stage::Run(run) = &mut self.stage {
            run.lesson.is_task_hidden = !run.lesson.is_task_hidden;
        }
    }

    pub(super) fn open_lesson_page(&mut self) {
        match self.lesson_page() {
            Some(_) => self.open_dialog(LessonDialog::default()),
            None => self.show_error(NO_LESSON),
        }
    }

    /// Opens the task page of a new lesson in a narrow window, which has no space for the task next to the screen.
    pub(super) fn open_initial_lesson_page(&mut self) {
        let Some(page) = self.lesson_page() else { return };
        if page.is_finished {
            return;
        }
        let begins = page.weeks.0 == 0;
        if begins && self.window.0 < MIN_WIDTH_FOR_TASK {
            self.open_dialog(LessonDialog::default());
        }
    }

    /// Handles the next-week key in a lesson. Returns false if the next-week dialog should open.
    pub(super) fn handle_next_week_in_lesson(&mut self) -> bool {
        let Some(run) = self.run() else { return false };
        let Some(page) = run.company.running_lesson() else { return false };
        let open = page.question.as_ref().is_some_and(|question| question.guess.is_none());
        let at_once = page.skips_forecasts;
        let forecasts =
            novamind_session::Forecasts { filled_naively: [true; 4], ..run.company.naive_forecasts };
        if open {
            self.open_dialog(LessonDialog::for_question());
            return true;
        }
        if !at_once {
            return false;
        }
        let unsent: Vec<&str> =
            run.screens.tools.tools_with_drafts().iter().map(|tool| tool.name()).collect();
        let week = Effect::Request(Request::Advance { rationale: NO_RATIONALE.to_owned(), forecasts });
        if unsent.is_empty() {
            self.confirm_or_run_week(week);
            return true;
        }
        let apply = self.keys.label(Action::Apply).unwrap_or_default();
        let text = format!(
            "The form of {} has unsubmitted values; {apply} in the form submits them. Run the week without them?",
            unsent.join(", ")
        );
        self.open_dialog(ConfirmDialog::new("Next week", text, vec![week]));
        true
    }

    /// Runs a week of a lesson. Asks for confirmation at the start of a step without a question. Also asks for
    /// confirmation if enterprises wait for answers and the rules that were sent last can answer these enterprises.
    fn confirm_or_run_week(&mut self, week: Effect) {
        let Some(run) = self.run() else { return };
        let Some(page) = run.company.running_lesson() else { return };
        if page.step > 0 && page.weeks.0 == 0 && page.question.is_none() {
            let title = format!("Step {}", page.step + 1);
            let weeks = pluralize(page.weeks.1, "week");
            let text = format!("{title} starts: {}, {weeks}. Run its first week?", page.step_title);
            return self.open_dialog(ConfirmDialog::new(title, text, vec![week]));
        }
        let waiting = run.company.observation.waiting.len() as u32;
        if run.screen != ScreenId::Inbox && waiting > 0 && run.screens.inbox.has_sent_rules() {
            let who = match waiting {
                1 => "1 enterprise is waiting".to_owned(),
                many => format!("{} are waiting", pluralize(many, "enterprise")),
            };
            let key = self.keys.label(Action::NextWeek).unwrap_or_default();
            let text = format!(
                "{who} for an answer. Go to Inbox? There, {key} lets you answer with the rules that you sent last."
            );
            let confirm_dialog = ConfirmDialog::new("Next week", text, vec![Effect::Show(ScreenId::Inbox)]);
            return self.open_dialog(confirm_dialog.with_alternative(Action::SkipAnswers, vec![week]));
        }
        let answers = match run.screen {
            ScreenId::Inbox => run.screens.inbox.last_rule_answers(&run.company),
            _ => None,
        };
        let Some((calls, text)) = answers else { return self.execute_effects(vec![week]) };
        let answer_effects = calls.into_iter().map(|(tool, arguments)| Effect::call(tool, arguments));
        let effects = answer_effects.chain([week.clone()]).collect();
        let text = format!("Answer with the rules that you sent last, and run the week:\n{text}");
        let dialog = ConfirmDialog::new("Answer and next week", text, effects);
        self.open_dialog(dialog.with_alternative(Action::SkipAnswers, vec![week]));
    }

    /// Shows the changes of a lesson week that ran without the next-week dialog. Returns whether these changes replace
    /// the weekly report.
    pub(super) fn show_lesson_week(&mut self, before: Option<&LessonStatus>) -> bool {
        let Some(page) = self.lesson_page().cloned() else { return false };
        let pitfalls = before.map_or(0, |before| before.pitfalls.len());
        let step_is_over = before.is_some_and(|before| before.step != page.step);
        let is_news = step_is_over || page.pitfalls.len() > pitfalls;
        let has_side_task = self.run().is_some_and(|run| run.side_task(self.window.0).is_some());
        if is_news && !has_side_task {
            self.open_dialog(LessonDialog::default());
        }
        page.skips_forecasts || (is_news && !has_side_task)
    }

    pub(super) fn handle_lesson_response(
        &mut self,
        refused: Option<Rejection>,
        company: Arc<DisplayedCompany>,
    ) {
        self.update_company(company);
        match refused {
            Some(rejection) => self.show_error(rejection.to_string()),
            None if self.layers.is_empty() => {
                let key = self.keys.label(Action::NextWeek).unwrap_or_default();
                self.show_status(format!("guess recorded; {key} runs the week"));
            }
            None => self.show_status("recorded"),
        }
    }

    pub(super) fn confirm_retry(&mut self, step: usize) {
        self.open_dialog(RetryStepDialog::new(step));
    }

    pub(super) fn open_debrief(&mut self) {
        let Some(run) = self.run() else { return };
        let found = run.lesson.debrief.clone();
        if found.is_none() {
            self.execute_effects(vec![Effect::Request(Request::Lesson(LessonRequest::Debrief))]);
        }
        self.open_dialog(DebriefPage::new(found));
    }

    /// Handles the end of a lesson: opens the page that leads to the next part, or the debrief. Returns false if the
    /// run has no lesson.
    pub(super) fn show_lesson_end(&mut self) -> bool {
        let Some(page) = self.lesson_page() else { return false };
        match page.next_part {
            Some(_) => self.open_dialog(LessonDialog::default()),
            None => self.open_debrief(),
        }
        true
    }

    pub(super) fn set_debrief(&mut self, found: Arc<Result<Debrief, Rejection>>) {
        let Stage::Run(run) = &mut self.stage else { return };
        // The debrief may belong to a run that the user has left in the meantime.
        if found.as_ref().as_ref().is_ok_and(|debrief| debrief.run != run.company.observation.run) {
            return;
        }
        run.lesson.debrief = Some(found.clone());
        for layer in self.layers.iter_mut() {
            if let Layer::Dialog(dialog) = layer {
                dialog.set_debrief(&found);
            }
        }
    }

    /// Shows why a screen is closed in this lesson. Returns whether the screen is closed.
    pub(super) fn reject_closed_screen(&mut self, screen: ScreenId) -> bool {
        let why = self.run().and_then(|run| closed_reason(screen, &run.company));
        why.map(|why| self.show_error(why)).is_some()
    }
}
