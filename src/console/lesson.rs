//! The task of a lesson, drawn next to the screen or on a page: question, goals, hints, pitfalls and available
//! features.

use ratatui::layout::Rect;
use ratatui::text::Line;

use super::action::Action;
use super::context::{ScreenContext, ScreenId};
use novamind_course::{GoalStatus, LessonQuestion, LessonStatus};
use novamind_report::lesson::{describe_goal_progress, describe_guess_and_outcome};
use novamind_tools::ToolId;
use novamind_tui::canvas::Canvas;
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_tui::widgets::sparkline::bar;
use novamind_worker::company::DisplayedCompany;

/// Width of the side pane, in columns.
pub const TASK_WIDTH: u16 = 38;
/// Minimum window width for the side pane, in columns.
pub const MIN_WIDTH_FOR_TASK: u16 = 118;

/// Screens that are open in every lesson.
const ALWAYS_OPEN_SCREENS: [ScreenId; 3] = [ScreenId::Overview, ScreenId::Tools, ScreenId::Journal];

/// Returns why a screen is closed in the current lesson, or `None` if it is open.
pub fn closed_reason(screen: ScreenId, company: &DisplayedCompany) -> Option<String> {
    let lesson = company.running_lesson()?;
    let screens = lesson.screens.as_ref()?;
    let queries = lesson.tools.as_ref().is_none_or(|tools| tools.contains(&ToolId::Query));
    let open = |screen_id: ScreenId| {
        let asks = screen_id == ScreenId::Sql && queries;
        asks || ALWAYS_OPEN_SCREENS.contains(&screen_id)
            || screens.iter().any(|name| name.eq_ignore_ascii_case(screen_id.record_name()))
    };
    // The X-ray screen has its own permission.
    if screen == ScreenId::Xray || open(screen) {
        return None;
    }
    let title = |id: ScreenId| id.action().entry().title;
    let all: Vec<&str> = ScreenId::ALL.into_iter().filter(|id| open(*id)).map(title).collect();
    Some(format!("{} is closed in this lesson; open screens: {}", title(screen), all.join(", ")))
}

/// Draws the task next to the screen. The lesson page shows the complete task.
pub fn draw_side_task(canvas: &mut Canvas<'_>, area: Rect, page: &LessonStatus, context: &ScreenContext<'_>) {
    canvas.clear(area, Role::Text);
    let note = format!("week {} of {}", (page.weeks.0 + 1).min(page.weeks.1), page.weeks.1);
    let inside = canvas.draw_pane_frame(area, "Lesson", &note, false);
    let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
    let lines = task_lines(page, context, (inside.width as usize, TaskPlace::SidePane));
    let cut = lines.len() > inside.height as usize;
    draw_lines(canvas, inside, &lines, 0);
    let keys = match cut {
        true => format!("{} shows more", context.hint(Action::LessonPage)),
        false => context.hints(&[Action::LessonPage, Action::Lesson]),
    };
    canvas.draw_pane_keys(area, &keys);
}

/// Draws as many lines as fit, starting at the line with index `from`.
pub fn draw_lines(canvas: &mut Canvas<'_>, area: Rect, lines: &[(String, Role)], from: usize) {
    let shown = lines.iter().skip(from).take(area.height as usize);
    let shown: Vec<Line<'_>> =
        shown.map(|(text, role)| Line::from(canvas.span(text.as_str(), *role))).collect();
    canvas.draw_lines(area, &shown);
}

struct StyledLines {
    width: usize,
    lines: Vec<(String, Role)>,
}

impl StyledLines {
    fn push_text(&mut self, text: &str, role: Role) {
        self.lines.extend(wrap(text, self.width).into_iter().map(|line| (line, role)));
    }

    fn push_blank(&mut self) {
        if self.lines.last().is_some_and(|(text, _)| !text.is_empty()) {
            self.lines.push((String::new(), Role::Text));
        }
    }
}

/// The place where the task is drawn, which determines the keys of the task.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TaskPlace {
    /// Next to the screen.
    SidePane,
    /// On the lesson page.
    FullPage,
}

/// Formats the task as lines that fit into a width.
pub fn task_lines(
    page: &LessonStatus,
    context: &ScreenContext<'_>,
    (width, place): (usize, TaskPlace),
) -> Vec<(String, Role)> {
    let mut lines = StyledLines { width, lines: Vec::new() };
    lines.push_text(&page.title, Role::Title);
    if let Some(part) = &page.part {
        lines.push_text(part, Role::Dim);
    }
    if let Some(before) = &page.previous_step {
        lines.push_blank();
        lines.push_text(&format!("Step {} is complete: {}", page.step, before.title), Role::Header);
        push_outcome(&mut lines, before.question.as_ref(), &before.goals);
    }
    lines.push_blank();
    let again = if page.try_number > 1 { format!(", try {}", page.try_number) } else { String::new() };
    let step = format!("Step {} of {}: {}{again}", page.step + 1, page.steps, page.step_title);
    lines.push_text(&step, Role::Strong);
    if page.is_finished {
        lines.push_blank();
        push_outcome(&mut lines, page.question.as_ref(), &page.goals);
        push_pitfalls(&mut lines, page);
        lines.push_blank();
        lines.push_text(&next_steps_text(page, context, place), Role::Key);
        return lines.lines;
    }
    // Goals are first, because small windows cut off the last lines.
    for goal in &page.goals {
        push_goal(&mut lines, goal);
    }
    if !page.goals.is_empty() {
        lines.push_blank();
    }
    lines.push_text(&unwrap_paragraphs(&page.text), Role::Text);
    if let Some(question) = &page.question {
        lines.push_blank();
        push_question(&mut lines, question, context);
    }
    push_pitfalls(&mut lines, page);
    push_hints(&mut lines, page, context);
    push_available_features(&mut lines, context);
    lines.lines
}

fn next_steps_text(page: &LessonStatus, context: &ScreenContext<'_>, place: TaskPlace) -> String {
    if place == TaskPlace::SidePane {
        let key = context.keys.label(Action::NextWeek).unwrap_or_default();
        return match page.next_part {
            Some(_) => format!("This part has ended: {key} opens the page with the next part."),
            None => format!("The lesson has ended: {key} opens the debrief."),
        };
    }
    let again = context.hint(Action::TryAgain);
    let debrief = context.hint(Action::Debrief);
    match page.next_part {
        Some(_) => format!("This part has ended: {}, {again}, {debrief}.", context.hint(Action::NextPart)),
        None => format!("The lesson has ended: {debrief}, {again}."),
    }
}

/// Returns the step that a retry restarts, counted from 0: the current step, or the step that has just ended.
pub fn retry_step(page: &LessonStatus) -> usize {
    page.step - usize::from(page.previous_step.is_some())
}

/// Joins the wrapped lines of each paragraph.
fn unwrap_paragraphs(text: &str) -> String {
    let paragraphs = text.trim().split("\n\n");
    let joined = paragraphs.map(|paragraph| paragraph.split_whitespace().collect::<Vec<_>>().join(" "));
    joined.collect::<Vec<_>>().join("\n\n")
}

fn push_question(lines: &mut StyledLines, question: &LessonQuestion, context: &ScreenContext<'_>) {
    lines.push_text(&format!("Your guess: {}", question.text), Role::Strong);
    match question.guess {
        Some(_) => {
            describe_guess_and_outcome(question).iter().for_each(|line| lines.push_text(line, Role::Text))
        }
        None => {
            for (at, choice) in question.choices.iter().enumerate() {
                lines.push_text(&format!("{}) {choice}", at + 1), Role::Text);
            }
            lines.push_text(&format!("{} asks for your guess", context.hint(Action::NextWeek)), Role::Key);
        }
    }
}

fn push_outcome(lines: &mut StyledLines, question: Option<&LessonQuestion>, goals: &[GoalStatus]) {
    if let Some(question) = question {
        lines.push_text(&question.text, Role::Dim);
        describe_guess_and_outcome(question).iter().for_each(|line| lines.push_text(line, Role::Strong));
    }
    for goal in goals {
        push_goal(lines, goal);
    }
}

/// Adds the lines of a goal with a progress bar.
fn push_goal(lines: &mut StyledLines, goal: &GoalStatus) {
    let (mark, role) = match goal.met {
        Some(true) => ("reached: ", Role::Good),
        Some(false) => ("missed: ", Role::Bad),
        None => ("Goal: ", Role::Strong),
    };
    lines.push_text(&format!("{mark}{}", goal.text), role);
    let Some(at) = describe_goal_progress(goal) else { return };
    let room = lines.width.saturating_sub(at.chars().count() + 1).min(16);
    match goal.value.zip(goal.bound).filter(|(_, bound)| *bound > 0.0 && room > 3) {
        Some((value, bound)) => {
            // A bar is full only if the goal is reached.
            let max = if goal.met == Some(true) || value >= bound { 1.0 } else { 1.0 - 1.0 / room as f64 };
            lines.push_text(&format!("{} {at}", bar((value / bound).min(max), room)), Role::Text);
        }
        None => lines.push_text(&at, Role::Text),
    }
}

fn push_pitfalls(lines: &mut StyledLines, page: &LessonStatus) {
    for (day, say) in &page.pitfalls {
        lines.push_blank();
        lines.push_text(&format!("! Day {day}: {say}"), Role::Warning);
    }
}

fn push_hints(lines: &mut StyledLines, page: &LessonStatus, context: &ScreenContext<'_>) {
    lines.push_blank();
    for (at, hint) in page.hints.iter().enumerate() {
        lines.push_text(&format!("Hint {}: {hint}", at + 1), Role::Text);
    }
    let count = format!("hints {}/{}", page.hints.len(), page.hint_count);
    let more = page.hints.len() < page.hint_count;
    let keys = || {
        let key = |action| context.keys.label(action).unwrap_or_default();
        format!(" · {} {} shows one", key(Action::LessonPage), key(Action::NextHint))
    };
    lines.push_text(&if more { count + &keys() } else { count }, Role::Dim);
}

fn push_available_features(lines: &mut StyledLines, context: &ScreenContext<'_>) {
    let Some(lesson) = context.company.running_lesson() else { return };
    lines.push_blank();
    if let Some(tools) = &lesson.tools {
        let names: Vec<&str> = tools.iter().map(|tool| tool.name()).collect();
        lines.push_text(&format!("Tools in this lesson: {}.", names.join(", ")), Role::Dim);
    }
    if lesson.screens.is_some() {
        let is_closed = |screen: &ScreenId| closed_reason(*screen, context.company).is_some();
        let closed = ScreenId::ALL.into_iter().filter(is_closed);
        let closed: Vec<&str> = closed.map(|screen| screen.action().entry().title).collect();
        if !closed.is_empty() {
            lines.push_text(&format!("Closed in this lesson: {}.", closed.join(", ")), Role::Dim);
        }
    }
}
