//! Texts for the events and pages of a lesson.

use super::formatting::format_money;
use novamind_base::formatting::{compact_number, dollars_and_cents, parse_number, percent, short_dollars};
use novamind_course::{GoalStatus, LessonQuestion, LessonStatus};
use novamind_record::trajectory::record::{LessonEvent, RecordedLessonEvent};

/// Returns the name that tables and texts use for a lesson event.
pub fn event_name(event: LessonEvent) -> &'static str {
    match event {
        LessonEvent::Begun => "begun",
        LessonEvent::Guess => "guess",
        LessonEvent::Hint => "hint",
        LessonEvent::Pitfall => "pitfall",
        LessonEvent::Outcome => "outcome",
        LessonEvent::Goal => "goal",
    }
}

/// Describes a `lesson` event of a trajectory, without reading the lesson file.
pub fn describe_note(note: &RecordedLessonEvent) -> String {
    let number = note.number.unwrap_or(1);
    let value = note.value.map(compact_number).unwrap_or_else(|| "none".to_owned());
    match note.event {
        LessonEvent::Begun if number > 1 => format!("step {} started, try {number}", note.step),
        LessonEvent::Begun => format!("step {} started", note.step),
        LessonEvent::Guess => format!("step {}: guessed {value}", note.step),
        LessonEvent::Hint => format!("step {}: hint {number}", note.step),
        LessonEvent::Pitfall => format!("step {}: pitfall {}", note.step, note.name.as_deref().unwrap_or("")),
        LessonEvent::Outcome => format!("step {}: the outcome was {value}", note.step),
        LessonEvent::Goal => {
            let text = if note.met == Some(true) { "reached" } else { "missed" };
            format!("step {}: goal {number} {text} with {value}", note.step)
        }
    }
}

/// Returns the lesson page of a student as lines of text.
pub fn describe_page(page: &LessonStatus) -> Vec<String> {
    let mut lines = vec![step_heading(page)];
    lines.extend(page.text.lines().map(str::to_owned));
    if let Some(question) = &page.question {
        lines.push(String::new());
        lines.extend(describe_question(question));
    }
    if !page.goals.is_empty() {
        lines.push(String::new());
        lines.extend(page.goals.iter().map(describe_goal));
    }
    for (at, hint) in page.hints.iter().enumerate() {
        lines.push(format!("Hint {} of {}: {hint}", at + 1, page.hint_count));
    }
    for (day, say) in &page.pitfalls {
        lines.push(format!("Day {day}: {say}"));
    }
    lines.push(String::new());
    lines.push(describe_next_action(page));
    lines
}

/// Returns a heading with the lesson, the step and the week.
pub fn step_heading(page: &LessonStatus) -> String {
    let part = page.part.as_ref().map(|part| format!(" · {part}")).unwrap_or_default();
    let again = if page.try_number > 1 { format!(", try {}", page.try_number) } else { String::new() };
    format!(
        "{}{part} · step {} of {}: {}, week {} of {}{again}",
        page.title,
        page.step + 1,
        page.steps,
        page.step_title,
        (page.weeks.0 + 1).min(page.weeks.1),
        page.weeks.1
    )
}

/// Describes the question of a step, the student's guess and the outcome.
pub fn describe_question(question: &LessonQuestion) -> Vec<String> {
    let mut lines = vec![format!("Your guess: {}", question.text)];
    lines.extend(question.choices.iter().enumerate().map(|(at, choice)| format!("  {}) {choice}", at + 1)));
    lines.extend(describe_guess_and_outcome(question));
    lines
}

/// Describes the student's guess and, if it is known, the outcome.
pub fn describe_guess_and_outcome(question: &LessonQuestion) -> Vec<String> {
    let written = |value: f64| format_guess(question, value);
    let is_choice = !question.choices.is_empty();
    let sentence = |choice: &str, number: &str, value: f64| match is_choice {
        true => format!("{choice}: {}.", written(value)),
        false => format!("{number} {}.", written(value)),
    };
    let guess = question.guess.map(|guess| sentence("You chose", "You guessed", guess));
    let outcome = match question.outcome {
        Some(outcome) => Some(sentence("The answer", "It was", outcome)),
        None if question.guess.is_some() && question.is_shown_at_part_end => {
            Some("You will see the result at the end of this part.".to_owned())
        }
        None => None,
    };
    guess.into_iter().chain(outcome).collect()
}

/// Returns whether a question asks for a share, from 0 to 1.
pub fn asks_for_share(question: &LessonQuestion) -> bool {
    question.unit.starts_with("share")
}

/// Parses a typed guess: `12,000`, `12k`, `$1.2M`, the number of a choice, or a share such as `0.4` or `40%`.
///
/// # Errors
/// Returns a message with an example if the text is not a valid guess.
pub fn parse_guess(question: &LessonQuestion, text: &str) -> Result<f64, String> {
    let text = text.trim();
    let value = match text.strip_suffix('%') {
        Some(bare) if asks_for_share(question) => parse_number(bare).map(|value| value / 100.0),
        Some(bare) if question.unit == "%" => parse_number(bare),
        Some(_) => None,
        None => parse_number(text),
    };
    let wanted = match (question.choices.is_empty(), asks_for_share(question)) {
        (false, _) => "answer with the number of a choice",
        (true, true) => "enter a share from 0 to 1, for example 0.4 or 40%",
        (true, false) => "enter a number, for example 12,000 or $1.2M",
    };
    value
        .filter(|value| !asks_for_share(question) || (0.0..=1.0).contains(value))
        .ok_or_else(|| wanted.to_owned())
}

/// Formats a guess or an outcome.
pub fn format_guess(question: &LessonQuestion, value: f64) -> String {
    match question.choices.get((value - 1.0).max(0.0) as usize) {
        Some(choice) => choice.clone(),
        None if asks_for_share(question) => percent(value, 0),
        None if question.unit == "$" => short_dollars(value),
        None if question.unit == "%" => format!("{value:.0}%"),
        None if question.unit.is_empty() => compact_number(value),
        None => format!("{} {}", compact_number(value), question.unit),
    }
}

/// Describes a goal and its current value.
pub fn describe_goal(goal: &GoalStatus) -> String {
    let mark = match goal.met {
        Some(true) => "reached",
        Some(false) => "missed",
        None => "goal",
    };
    let at = describe_goal_progress(goal).map(|at| format!(": {at}")).unwrap_or_default();
    format!("{mark}: {}{at}", goal.text)
}

/// Describes a goal's current value and, if it is known, the target.
pub fn describe_goal_progress(goal: &GoalStatus) -> Option<String> {
    let value = format_goal_amount(goal, goal.value?);
    Some(match (goal.bound, goal.required_reference_share) {
        (None, _) => format!("{value} now; the target is shown at the end of the step"),
        (Some(bound), Some(share)) => {
            let good = format_goal_amount(goal, bound / share);
            format!(
                "{value}, at least {} ({} of the reference play's {good})",
                format_goal_amount(goal, bound),
                percent(share, 1)
            )
        }
        (Some(bound), None) if goal.is_bound_maximum => {
            format!("{value}, at most {}", format_goal_amount(goal, bound))
        }
        (Some(bound), None) => format!("{value}, at least {}", format_goal_amount(goal, bound)),
    })
}

/// Formats an amount in the unit of a goal.
pub fn format_goal_amount(goal: &GoalStatus, value: f64) -> String {
    match goal.in_dollars {
        true if value.abs() < 1000.0 => dollars_and_cents(value),
        true => format_money(value),
        false => compact_number(value),
    }
}

fn describe_next_action(page: &LessonStatus) -> String {
    let open = page.question.as_ref().is_some_and(|question| question.guess.is_none());
    match page.next_part {
        Some(part) => format!(
            "This part is complete. `lesson next` starts part {part}; `retry {}` restarts the step.",
            page.step + 1
        ),
        None if page.is_finished => {
            format!(
                "The lesson is complete. `debrief` shows the result; `retry {}` restarts the step.",
                page.step + 1
            )
        }
        None if open => "Answer with `guess ANSWER`. Then `next` runs a week.".to_owned(),
        None if page.hints.len() < page.hint_count => "`next` runs a week. `hint` shows a hint.".to_owned(),
        None => "`next` runs a week.".to_owned(),
    }
}
