//! The task of a lesson next to the screen: question, goals, hints, pitfalls and closed features.

use ratatui::layout::Rect;
use ratatui::text::Line;

use super::action::Action;
use super::context::{Look, ScreenId};
use novamind_course::{GoalPage, LessonPage, LessonQuestion};
use novamind_report::lesson::{goal_at, guess_and_outcome};
use novamind_tools::ToolId;
use novamind_tui::canvas::Canvas;
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;
use novamind_tui::widgets::spark::bar;
use novamind_worker::company::Company;

/// Width of the side pane, in columns.
pub const COLUMNS: u16 = 38;
/// Minimum window width for the side pane, in columns.
pub const WIDE: u16 = 118;

/// Screens that are open in every lesson.
const ALWAYS: [ScreenId; 3] = [ScreenId::Overview, ScreenId::Tools, ScreenId::Journal];

/// Returns why a screen is closed in the current lesson, or `None` if it is open.
pub fn why_closed(screen: ScreenId, company: &Company) -> Option<String> {
    let lesson = company.running_lesson()?;
    let screens = lesson.screens.as_ref()?;
    let queries = lesson.tools.as_ref().is_none_or(|tools| tools.contains(&ToolId::Query));
    let open = |own: ScreenId| {
        let asks = own == ScreenId::Sql && queries;
        asks || ALWAYS.contains(&own) || screens.iter().any(|name| name.eq_ignore_ascii_case(own.id()))
    };
    // Hidden state has its own permission.
    if screen == ScreenId::Xray || open(screen) {
        return None;
    }
    let title = |own: ScreenId| own.action().entry().title;
    let all: Vec<&str> = ScreenId::ALL.into_iter().filter(|own| open(*own)).map(title).collect();
    Some(format!("{} is closed in this lesson; open screens: {}", title(screen), all.join(", ")))
}

/// Draws the task next to the screen. The lesson page shows all of it.
pub fn draw_beside(canvas: &mut Canvas<'_>, area: Rect, page: &LessonPage, look: &Look<'_>) {
    canvas.clear(area, Role::Text);
    let note = format!("week {} of {}", (page.weeks.0 + 1).min(page.weeks.1), page.weeks.1);
    let inside = canvas.pane(area, "Lesson", &note, false);
    let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
    let lines = lines_of(page, look, (inside.width as usize, Where::Beside));
    let cut = lines.len() > inside.height as usize;
    draw_lines(canvas, inside, &lines, 0);
    let keys = match cut {
        true => format!("{} for more", look.hint(Action::LessonPage)),
        false => look.hints(&[Action::LessonPage, Action::Lesson]),
    };
    canvas.pane_keys(area, &keys);
}

/// Draws lines from an index.
pub fn draw_lines(canvas: &mut Canvas<'_>, area: Rect, lines: &[(String, Role)], from: usize) {
    let shown = lines.iter().skip(from).take(area.height as usize);
    let shown: Vec<Line<'_>> =
        shown.map(|(text, role)| Line::from(canvas.span(text.as_str(), *role))).collect();
    canvas.lines(area, &shown);
}

struct Lines {
    width: usize,
    all: Vec<(String, Role)>,
}

impl Lines {
    fn say(&mut self, text: &str, role: Role) {
        self.all.extend(wrapped(text, self.width).into_iter().map(|line| (line, role)));
    }

    fn gap(&mut self) {
        if self.all.last().is_some_and(|(text, _)| !text.is_empty()) {
            self.all.push((String::new(), Role::Text));
        }
    }
}

/// Where the task is drawn, which determines its keys.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Where {
    /// Next to the screen.
    Beside,
    /// On the lesson page.
    OnPage,
}

/// Formats the task as lines of a width.
pub fn lines_of(page: &LessonPage, look: &Look<'_>, (width, place): (usize, Where)) -> Vec<(String, Role)> {
    let mut lines = Lines { width, all: Vec::new() };
    lines.say(&page.title, Role::Title);
    if let Some(part) = &page.part {
        lines.say(part, Role::Dim);
    }
    if let Some(before) = &page.before {
        lines.gap();
        lines.say(&format!("Step {} is complete: {}", page.step, before.title), Role::Header);
        say_outcome(&mut lines, before.question.as_ref(), &before.goals);
    }
    lines.gap();
    let again = if page.try_number > 1 { format!(", try {}", page.try_number) } else { String::new() };
    let step = format!("Step {} of {}: {}{again}", page.step + 1, page.steps, page.step_title);
    lines.say(&step, Role::Strong);
    if page.is_over {
        lines.gap();
        say_outcome(&mut lines, page.question.as_ref(), &page.goals);
        say_pitfalls(&mut lines, page);
        lines.gap();
        lines.say(&what_follows(page, look, place), Role::Key);
        return lines.all;
    }
    // Goals come first, because small windows truncate the end.
    for goal in &page.goals {
        say_goal(&mut lines, goal);
    }
    if !page.goals.is_empty() {
        lines.gap();
    }
    lines.say(&unwrapped(&page.text), Role::Text);
    if let Some(question) = &page.question {
        lines.gap();
        say_question(&mut lines, question, look);
    }
    say_pitfalls(&mut lines, page);
    say_hints(&mut lines, page, look);
    say_locked(&mut lines, look);
    lines.all
}

fn what_follows(page: &LessonPage, look: &Look<'_>, place: Where) -> String {
    if place == Where::Beside {
        let key = look.keys.label(Action::NextWeek).unwrap_or_default();
        return match page.next_part {
            Some(_) => format!("This part has ended: {key} opens the page with the next part."),
            None => format!("The lesson has ended: {key} opens the debrief."),
        };
    }
    let again = look.hint(Action::TryAgain);
    let debrief = look.hint(Action::Debrief);
    match page.next_part {
        Some(_) => format!("This part has ended: {}, {again}, {debrief}.", look.hint(Action::NextPart)),
        None => format!("The lesson has ended: {debrief}, {again}."),
    }
}

/// Returns the step that a retry starts with, counted from 0: the current one, or the one that has just ended.
pub fn step_to_try(page: &LessonPage) -> usize {
    page.step - usize::from(page.before.is_some())
}

/// Joins the wrapped lines of each paragraph.
fn unwrapped(text: &str) -> String {
    let paragraphs = text.trim().split("\n\n");
    let joined = paragraphs.map(|own| own.split_whitespace().collect::<Vec<_>>().join(" "));
    joined.collect::<Vec<_>>().join("\n\n")
}

fn say_question(lines: &mut Lines, question: &LessonQuestion, look: &Look<'_>) {
    lines.say(&format!("Your guess: {}", question.text), Role::Strong);
    match question.guess {
        Some(_) => guess_and_outcome(question).iter().for_each(|line| lines.say(line, Role::Text)),
        None => {
            for (at, choice) in question.choices.iter().enumerate() {
                lines.say(&format!("{}) {choice}", at + 1), Role::Text);
            }
            lines.say(&format!("{} asks for your guess", look.hint(Action::NextWeek)), Role::Key);
        }
    }
}

fn say_outcome(lines: &mut Lines, question: Option<&LessonQuestion>, goals: &[GoalPage]) {
    if let Some(question) = question {
        lines.say(&question.text, Role::Dim);
        guess_and_outcome(question).iter().for_each(|line| lines.say(line, Role::Strong));
    }
    for goal in goals {
        say_goal(lines, goal);
    }
}

/// Adds a goal with a progress bar.
fn say_goal(lines: &mut Lines, goal: &GoalPage) {
    let (mark, role) = match goal.met {
        Some(true) => ("reached: ", Role::Good),
        Some(false) => ("missed: ", Role::Bad),
        None => ("Goal: ", Role::Strong),
    };
    lines.say(&format!("{mark}{}", goal.text), role);
    let Some(at) = goal_at(goal) else { return };
    let room = lines.width.saturating_sub(at.chars().count() + 1).min(16);
    match goal.value.zip(goal.bound).filter(|(_, bound)| *bound > 0.0 && room > 3) {
        Some((value, bound)) => {
            // A bar is full only if the goal is reached.
            let most = if goal.met == Some(true) || value >= bound { 1.0 } else { 1.0 - 1.0 / room as f64 };
            lines.say(&format!("{} {at}", bar((value / bound).min(most), room)), Role::Text);
        }
        None => lines.say(&at, Role::Text),
    }
}

fn say_pitfalls(lines: &mut Lines, page: &LessonPage) {
    for (day, say) in &page.pitfalls {
        lines.gap();
        lines.say(&format!("! Day {day}: {say}"), Role::Warning);
    }
}

fn say_hints(lines: &mut Lines, page: &LessonPage, look: &Look<'_>) {
    lines.gap();
    for (at, hint) in page.hints.iter().enumerate() {
        lines.say(&format!("Hint {}: {hint}", at + 1), Role::Text);
    }
    let count = format!("hints {}/{}", page.hints.len(), page.hints_in_all);
    let more = page.hints.len() < page.hints_in_all;
    let keys = || {
        let key = |action| look.keys.label(action).unwrap_or_default();
        format!(" · {} {} shows one", key(Action::LessonPage), key(Action::NextHint))
    };
    lines.say(&if more { count + &keys() } else { count }, Role::Dim);
}

fn say_locked(lines: &mut Lines, look: &Look<'_>) {
    let Some(lesson) = look.company.running_lesson() else { return };
    lines.gap();
    if let Some(tools) = &lesson.tools {
        let names: Vec<&str> = tools.iter().map(|tool| tool.name()).collect();
        lines.say(&format!("Tools in this lesson: {}.", names.join(", ")), Role::Dim);
    }
    if lesson.screens.is_some() {
        let is_closed = |screen: &ScreenId| why_closed(*screen, look.company).is_some();
        let closed = ScreenId::ALL.into_iter().filter(is_closed);
        let closed: Vec<&str> = closed.map(|screen| screen.action().entry().title).collect();
        if !closed.is_empty() {
            lines.say(&format!("Closed in this lesson: {}.", closed.join(", ")), Role::Dim);
        }
    }
}
