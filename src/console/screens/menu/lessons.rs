//! List of lessons with their duration, title and learning goal.

use std::sync::Arc;

use ratatui::layout::Rect;

use crate::effect::Effect;
use novamind_course::Lesson;
use novamind_record::folder::configuration::Configuration;
use novamind_record::mode::Mode;
use novamind_report::pluralize;
use novamind_session::{LessonOptions, NewRun};
use novamind_tui::canvas::{Canvas, Click, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_worker::request::Request;

const MIN_WIDTH_FOR_DETAILS: u16 = 76;

#[derive(Default)]
pub(super) struct LessonList {
    lessons: Vec<ListedLesson>,
}

/// A lesson in the list: its name, and its definition or the error in its file.
struct ListedLesson {
    name: String,
    lesson: Result<Arc<Lesson>, String>,
}

impl LessonList {
    pub(super) fn load(configuration: &Configuration) -> LessonList {
        let read = |name: String| {
            let lesson = Lesson::load(&name, configuration).map(Arc::new).map_err(|error| error.to_string());
            ListedLesson { name, lesson }
        };
        LessonList { lessons: configuration.lesson_names().into_iter().map(read).collect() }
    }

    pub(super) fn len(&self) -> usize {
        self.lessons.len()
    }

    pub(super) fn start_lesson(&self, selected: usize) -> Vec<Effect> {
        match self.lessons.get(selected).map(|listed_lesson| &listed_lesson.lesson) {
            Some(Ok(lesson)) => {
                let entry = LessonOptions { lesson: lesson.clone(), part: 0, is_judged: true };
                let new = NewRun { mode: Mode::Lesson, lesson: Some(entry), ..NewRun::default() };
                vec![Effect::Request(Request::Create(Box::new(new)))]
            }
            Some(Err(problem)) => vec![Effect::ShowError(problem.clone())],
            None => Vec::new(),
        }
    }

    /// Draws the list and the learning goal of the selected lesson.
    pub(super) fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, selected: usize) {
        let is_wide = area.width >= MIN_WIDTH_FOR_DETAILS;
        let (above, below) = if is_wide {
            let left = Rect { width: area.width / 2, ..area };
            (left, Rect { x: left.right() + 1, width: area.width - left.width - 1, ..area })
        } else {
            let rows = (self.lessons.len() as u16 + 2).min(area.height);
            let left = Rect { height: rows, ..area };
            (left, Rect { y: left.bottom(), height: area.height - rows, ..area })
        };
        let inside =
            canvas.draw_pane_frame(above, "Lessons", &pluralize(self.lessons.len() as u32, "lesson"), true);
        let from = canvas.scroll_to_row(inside, selected, self.lessons.len());
        for (row, (at, listed_lesson)) in row_rects(inside).zip(self.lessons.iter().enumerate().skip(from)) {
            let here = at == selected;
            if here {
                canvas.clear(row, Role::Selection);
            }
            let (minutes, title) = match &listed_lesson.lesson {
                Ok(lesson) => (format!("{:>2} min", lesson.plan.minutes), lesson.plan.title.as_str()),
                Err(_) => ("  –".to_owned(), listed_lesson.name.as_str()),
            };
            let mark = if here { "›" } else { " " };
            canvas.draw_text(
                row,
                &format!("{mark} {minutes:<6}  {title}"),
                if here { Role::Selection } else { Role::Text },
            );
            canvas.register_click(row, Click::Row(0, at));
        }
        if let Some(lesson) = self.lessons.get(selected) {
            draw_lesson(canvas, below, lesson);
        }
    }
}

fn draw_lesson(canvas: &mut Canvas<'_>, area: Rect, listed_lesson: &ListedLesson) {
    if area.height < 3 {
        return;
    }
    let inside = canvas.draw_pane_frame(area, &listed_lesson.name, "", false);
    let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
    let (text, role) = match &listed_lesson.lesson {
        Ok(lesson) => {
            let plan = &lesson.plan;
            let parts = match plan.parts.len() {
                1 => pluralize(plan.parts[0].steps.len() as u32, "step"),
                parts => pluralize(parts as u32, "part"),
            };
            (
                format!("{}\n\n{}\n\n{} minutes, {parts}.", plan.title, plan.learning_goal, plan.minutes),
                Role::Text,
            )
        }
        Err(problem) => (format!("! {problem}"), Role::Bad),
    };
    for (row, line) in row_rects(inside).zip(wrap(&text, inside.width as usize)) {
        canvas.draw_text(row, &line, role);
    }
}
