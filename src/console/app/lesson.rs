//! Lessons in the console: the task next to the screen or as a page, immediate weeks, closed screens, the debrief.

use std::sync::Arc;

use super::{App, Layer, Run, Stage};
use crate::action::Action;
use crate::context::ScreenId;
use crate::dialogs::again::TryAgain;
use crate::dialogs::confirm::Confirm;
use crate::dialogs::debrief::DebriefPage;
use crate::dialogs::lesson::LessonDialog;
use crate::effect::Effect;
use crate::lesson::{WIDE, why_closed};
use novamind_course::{Debrief, LessonPage};
use novamind_report::count;
use novamind_tools::Refusal;
use novamind_worker::company::Company;
use novamind_worker::request::{LessonRequest, Request};

const NO_RATIONALE: &str = "the lesson asks for none";
const NO_LESSON: &str = "this run is not part of a lesson; the start menu lists lessons";

/// State of the lesson of a run.
#[derive(Default)]
pub struct LessonView {
    /// Whether the side pane with the task is hidden.
    pub hidden: bool,
    /// The debrief, after it was computed.
    pub debrief: Option<Arc<Result<Debrief, Refusal>>>,
}

impl Run {
    /// Returns the lesson if its task is shown next to the screen in a window of this width.
    pub fn lesson_beside(&self, columns: u16) -> Option<&LessonPage> {
        let fits = columns >= WIDE && !self.zoomed && !self.lesson.hidden && self.viewer.is_none();
        self.company.lesson.as_ref().filter(|_| fits)
    }
}

impl App {
    fn lesson_page(&self) -> Option<&LessonPage> {
        self.run()?.company.lesson.as_ref()
    }

    /// Shows or hides the task next to the screen; in a narrow window, opens it as a page.
    pub(super) fn toggle_lesson(&mut self) {
        if self.lesson_page().is_none() {
            return self.complain(NO_LESSON);
        }
        if self.window.0 < WIDE {
            return self.open(LessonDialog::default());
        }
        if let Stage::Run(run) = &mut self.stage {
            run.lesson.hidden = !run.lesson.hidden;
        }
    }

    pub(super) fn show_lesson(&mut self) {
        match self.lesson_page() {
            Some(_) => self.open(LessonDialog::default()),
            None => self.complain(NO_LESSON),
        }
    }

    /// Opens the task of a new lesson in a narrow window, where it is not shown next to the screen.
    pub(super) fn open_lesson(&mut self) {
        let Some(page) = self.lesson_page() else { return };
        if page.is_over {
            return;
        }
        let begins = page.weeks.0 == 0;
        if begins && self.window.0 < WIDE {
            self.open(LessonDialog::default());
        }
    }

    /// Handles the next-week key in a lesson. Returns false if the usual dialog should open.
    pub(super) fn files_in_lesson(&mut self) -> bool {
        let Some(run) = self.run() else { return false };
        let Some(page) = run.company.running_lesson() else { return false };
        let open = page.question.as_ref().is_some_and(|question| question.guess.is_none());
        let at_once = page.runs_at_once;
        let forecasts = novamind_session::Forecasts { filled_naively: [true; 4], ..run.company.naive };
        if open {
            self.open(LessonDialog::asking());
            return true;
        }
        if !at_once {
            return false;
        }
        let unsent: Vec<&str> = run.screens.tools.unsent().iter().map(|tool| tool.name()).collect();
        let week = Effect::Request(Request::Advance { rationale: NO_RATIONALE.to_owned(), forecasts });
        if unsent.is_empty() {
            self.ask_or_run(week);
            return true;
        }
        let apply = self.keys.label(Action::Apply).unwrap_or_default();
        let text = format!(
            "The form of {} has unsent values; {apply} in the form sends them. Run the week without them?",
            unsent.join(", ")
        );
        self.open(Confirm::new("Next week", text, vec![week]));
        true
    }

    /// Runs a week of a lesson. Asks first if an accidental key press could do harm: at the start of a step without a
    /// guess, and if waiting messages match the rules that were sent last.
    fn ask_or_run(&mut self, week: Effect) {
        let Some(run) = self.run() else { return };
        let Some(page) = run.company.running_lesson() else { return };
        if page.step > 0 && page.weeks.0 == 0 && page.question.is_none() {
            let title = format!("Step {}", page.step + 1);
            let weeks = count(page.weeks.1, "week");
            let text = format!("{title} starts: {}, {weeks}. Run its first week?", page.step_title);
            return self.open(Confirm::new(title, text, vec![week]));
        }
        let waiting = run.company.seen.waiting.len() as u32;
        if run.here != ScreenId::Inbox && waiting > 0 && run.screens.inbox.has_sent_rules() {
            let who = match waiting {
                1 => "1 enterprise is waiting".to_owned(),
                many => format!("{} are waiting", count(many, "enterprise")),
            };
            let key = self.keys.label(Action::NextWeek).unwrap_or_default();
            let text = format!(
                "{who} for an answer. Go to Inbox, where {key} offers to answer with the rules that you sent last?"
            );
            let asked = Confirm::new("Next week", text, vec![Effect::Show(ScreenId::Inbox)]);
            return self.open(asked.or(Action::WeekUnanswered, vec![week]));
        }
        let answers = match run.here {
            ScreenId::Inbox => run.screens.inbox.answers_of_before(&run.company),
            _ => None,
        };
        let Some((calls, text)) = answers else { return self.follow(vec![week]) };
        let both = calls.into_iter().map(|(tool, arguments)| Effect::call(tool, arguments));
        let both = both.chain([week.clone()]).collect();
        let text = format!("Answer with the rules that you sent last, and run the week:\n{text}");
        let asked = Confirm::new("Answer and next week", text, both);
        self.open(asked.or(Action::WeekUnanswered, vec![week]));
    }

    /// Shows what changed in a lesson week that runs at once. Returns whether that replaces the weekly report.
    pub(super) fn tells_week_of_lesson(&mut self, before: Option<&LessonPage>) -> bool {
        let Some(page) = self.lesson_page().cloned() else { return false };
        let pitfalls = before.map_or(0, |before| before.pitfalls.len());
        let step_is_over = before.is_some_and(|before| before.step != page.step);
        let is_news = step_is_over || page.pitfalls.len() > pitfalls;
        let beside = self.run().is_some_and(|run| run.lesson_beside(self.window.0).is_some());
        if is_news && !beside {
            self.open(LessonDialog::default());
        }
        page.runs_at_once || (is_news && !beside)
    }

    pub(super) fn heard_in_lesson(&mut self, refused: Option<Refusal>, company: Arc<Company>) {
        self.changed(company);
        match refused {
            Some(refusal) => self.complain(refusal.to_string()),
            None if self.layers.is_empty() => {
                let key = self.keys.label(Action::NextWeek).unwrap_or_default();
                self.say(format!("guess recorded; {key} runs the week"));
            }
            None => self.say("recorded"),
        }
    }

    pub(super) fn ask_to_try_again(&mut self, step: usize) {
        self.open(TryAgain::new(step));
    }

    pub(super) fn show_debrief(&mut self) {
        let Some(run) = self.run() else { return };
        let found = run.lesson.debrief.clone();
        if found.is_none() {
            self.follow(vec![Effect::Request(Request::Lesson(LessonRequest::Debrief))]);
        }
        self.open(DebriefPage::of(found));
    }

    /// Handles the end of a lesson: opens the page that leads to the next part, or the debrief. Returns false if the
    /// run has no lesson.
    pub(super) fn ends_lesson(&mut self) -> bool {
        let Some(page) = self.lesson_page() else { return false };
        match page.next_part {
            Some(_) => self.open(LessonDialog::default()),
            None => self.show_debrief(),
        }
        true
    }

    pub(super) fn debriefed(&mut self, found: Arc<Result<Debrief, Refusal>>) {
        let Stage::Run(run) = &mut self.stage else { return };
        // The debrief may belong to a run that was left in the meantime.
        if found.as_ref().as_ref().is_ok_and(|debrief| debrief.run != run.company.seen.run) {
            return;
        }
        run.lesson.debrief = Some(found.clone());
        for layer in self.layers.iter_mut() {
            if let Layer::Dialog(dialog) = layer {
                dialog.take_debrief(&found);
            }
        }
    }

    /// Shows why a screen is closed in this lesson. Returns whether it is.
    pub(super) fn is_kept_shut(&mut self, screen: ScreenId) -> bool {
        let why = self.run().and_then(|run| why_closed(screen, &run.company));
        why.map(|why| self.complain(why)).is_some()
    }
}
