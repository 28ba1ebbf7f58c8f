//! A lesson on the screen: the task beside it or as a page, weeks that run at once, what is not open, the debrief.

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

/// The rationale of a week for which the lesson asks for none.
const NO_RATIONALE: &str = "the lesson asks for none";
/// Said where there is no lesson.
const NO_LESSON: &str = "this run belongs to no lesson; the start menu lists lessons";

/// What the person has of the lesson of a run.
#[derive(Default)]
pub struct LessonView {
    /// The task is not shown beside the screen.
    pub hidden: bool,
    /// What came of it, once it was found.
    pub debrief: Option<Arc<Result<Debrief, Refusal>>>,
}

impl Run {
    /// The lesson, where its task stands beside the screen of a window of so many columns.
    pub fn lesson_beside(&self, columns: u16) -> Option<&LessonPage> {
        let fits = columns >= WIDE && !self.zoomed && !self.lesson.hidden && self.viewer.is_none();
        self.company.lesson.as_ref().filter(|_| fits)
    }
}

impl App {
    fn lesson_page(&self) -> Option<&LessonPage> {
        self.run()?.company.lesson.as_ref()
    }

    /// Shows the task beside the screen, or hides it; where there is no room, opens it as a page.
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

    /// Opens the whole task.
    pub(super) fn show_lesson(&mut self) {
        match self.lesson_page() {
            Some(_) => self.open(LessonDialog::default()),
            None => self.complain(NO_LESSON),
        }
    }

    /// Opens the task of a lesson that was opened, where it does not stand beside the screen.
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

    /// What the key of the next week does in a lesson, if that is something of its own.
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
            "The form of {} holds values that were not sent; {apply} in it sends them. Run the week without them?",
            unsent.join(", ")
        );
        self.open(Confirm::new("Next week", text, vec![week]));
        true
    }

    /// Runs a week of a lesson, after a question where one key too many would do harm: at the beginning of a step that asks
    /// for no guess, and where the rules that were sent last have letters to answer.
    fn ask_or_run(&mut self, week: Effect) {
        let Some(run) = self.run() else { return };
        let Some(page) = run.company.running_lesson() else { return };
        if page.step > 0 && page.weeks.0 == 0 && page.question.is_none() {
            let title = format!("Step {}", page.step + 1);
            let weeks = count(page.weeks.1, "week");
            let text = format!("{title} begins: {}, {weeks}. Run its first week?", page.step_title);
            return self.open(Confirm::new(title, text, vec![week]));
        }
        let waiting = run.company.seen.waiting.len() as u32;
        if run.here != ScreenId::Inbox && waiting > 0 && run.screens.inbox.has_sent_rules() {
            let who = match waiting {
                1 => "A company waits".to_owned(),
                many => format!("{} wait", count(many, "company")),
            };
            let key = self.keys.label(Action::NextWeek).unwrap_or_default();
            let text = format!(
                "{who} for an answer. Go to Inbox, where {key} asks whether the rules that you sent last answer?"
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
        let text = format!("The rules that you sent last answer, and the week runs:\n{text}");
        let asked = Confirm::new("Answer and next week", text, both);
        self.open(asked.or(Action::WeekUnanswered, vec![week]));
    }

    /// After a week of a lesson that runs at once: what is new of it. True if that takes the place of the report.
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

    /// Says how an answer or a hint was taken.
    pub(super) fn heard_in_lesson(&mut self, refused: Option<Refusal>, company: Arc<Company>) {
        self.changed(company);
        match refused {
            Some(refusal) => self.complain(refusal.to_string()),
            None if self.layers.is_empty() => {
                let key = self.keys.label(Action::NextWeek).unwrap_or_default();
                self.say(format!("your guess is recorded: {key} runs the week"));
            }
            None => self.say("recorded"),
        }
    }

    /// Asks once before a step is tried again, which may be one before it.
    pub(super) fn ask_to_try_again(&mut self, step: usize) {
        self.open(TryAgain::new(step));
    }

    /// Opens what came of the lesson; it is found once.
    pub(super) fn show_debrief(&mut self) {
        let Some(run) = self.run() else { return };
        let found = run.lesson.debrief.clone();
        if found.is_none() {
            self.follow(vec![Effect::Request(Request::Lesson(LessonRequest::Debrief))]);
        }
        self.open(DebriefPage::of(found));
    }

    /// The end of a lesson: where another part follows, the page that leads there, else the debrief. True if it is one.
    pub(super) fn ends_lesson(&mut self) -> bool {
        let Some(page) = self.lesson_page() else { return false };
        match page.next_part {
            Some(_) => self.open(LessonDialog::default()),
            None => self.show_debrief(),
        }
        true
    }

    /// The debrief was found.
    pub(super) fn debriefed(&mut self, found: Arc<Result<Debrief, Refusal>>) {
        let Stage::Run(run) = &mut self.stage else { return };
        // It may be that of a run which was left meanwhile.
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

    /// Says so where a screen is not in the lesson that is played.
    pub(super) fn is_kept_shut(&mut self, screen: ScreenId) -> bool {
        let why = self.run().and_then(|run| why_closed(screen, &run.company));
        why.map(|why| self.complain(why)).is_some()
    }
}
