//! Consistency checks of a lesson plan and its texts.

use std::collections::BTreeSet;

use super::definition::{LessonPart, MeasuredFigure, ReferencePlay, ScheduledCalls};
use super::lesson_file::Lesson;
use crate::folder::configuration::Configuration;

/// A defect of a lesson file.
pub(super) struct LessonDefect {
    /// Text by which the faulty line is found: the first line that contains this text.
    pub place: String,
    pub key: &'static str,
    pub problem: String,
}

/// Returns the first defect in a parsed lesson.
pub(super) fn find_defect(lesson: &Lesson) -> Option<LessonDefect> {
    let plan = &lesson.plan;
    let wrong = |place: &str, key, problem: String| LessonDefect { place: place.to_owned(), key, problem };
    if plan.parts.is_empty() || plan.parts.iter().any(|part| part.steps.is_empty()) {
        return Some(wrong(
            "[[part",
            "part",
            "a lesson needs a part, and every part needs a step".to_owned(),
        ));
    }
    plan.parts
        .iter()
        .find_map(find_part_defect)
        .or_else(|| {
            let known: BTreeSet<&str> = plan.pitfalls.iter().map(|pitfall| pitfall.name.as_str()).collect();
            let named = plan.bad.pitfall.as_deref();
            match named.is_some_and(|name| known.contains(name)) {
                true => None,
                false => Some(wrong(
                    "[bad]",
                    "bad.pitfall",
                    "the pitfall play must name the pitfall that it triggers".to_owned(),
                )),
            }
        })
        .or_else(|| {
            let parts = plan.parts.len();
            let far = plan.pitfalls.iter().find(|pitfall| pitfall.part >= parts)?;
            Some(wrong(
                &format!("name = \"{}\"", far.name),
                "pitfall.part",
                format!("this part does not exist; number of parts: {parts}"),
            ))
        })
        .or_else(|| {
            find_play_defect(lesson, "good", &plan.good)
                .or_else(|| find_play_defect(lesson, "bad", &plan.bad))
        })
        .or_else(|| find_figure_defect(lesson))
        .or_else(|| find_unknown_placeholder(lesson))
}

fn find_part_defect(part: &LessonPart) -> Option<LessonDefect> {
    let step_of = |title: &str, key, problem: &str| {
        Some(LessonDefect { place: format!("title = \"{title}\""), key, problem: problem.to_owned() })
    };
    for step in &part.steps {
        if step.weeks == 0 {
            return step_of(&step.title, "step.weeks", "a step needs at least one week");
        }
        if !(1..=3).contains(&step.hints.len()) {
            return step_of(&step.title, "step.hints", "a step needs one to three hints");
        }
    }
    let early = part.start.iter().find(|scheduled_calls| scheduled_calls.week > part.start_weeks)?;
    Some(LessonDefect {
        place: format!("week = {}", early.week),
        key: "start.week",
        problem: format!(
            "the start has {} weeks; remove calls in later weeks, which the student plays",
            part.start_weeks
        ),
    })
}

fn find_play_defect(lesson: &Lesson, name: &'static str, play: &ReferencePlay) -> Option<LessonDefect> {
    let fits = |calls: &&ScheduledCalls| {
        lesson
            .plan
            .parts
            .get(calls.part)
            .is_some_and(|part| (part.start_weeks..part.weeks()).contains(&calls.week))
    };
    let wrong = play.plays.iter().find(|calls| !fits(calls))?;
    Some(LessonDefect {
        place: format!("[[{name}.play]]"),
        key: "play.week",
        problem: format!("part {} has no week {} in which a student decides", wrong.part + 1, wrong.week),
    })
}

fn find_figure_defect(lesson: &Lesson) -> Option<LessonDefect> {
    let mut names = BTreeSet::new();
    for measured_figure in &lesson.plan.measured {
        let part = lesson.plan.parts.get(measured_figure.part);
        let problem = match part {
            _ if !names.insert(&measured_figure.name) => "another measured figure has this name".to_owned(),
            None => format!("this part does not exist; number of parts: {}", lesson.plan.parts.len()),
            Some(part) if measured_figure.week.is_some_and(|week| !(1..=part.weeks()).contains(&week)) => {
                format!("the part has weeks 1 to {}", part.weeks())
            }
            Some(part) => match figure_parameters_error(part, measured_figure) {
                Some(problem) => problem,
                None => continue,
            },
        };
        return Some(LessonDefect {
            place: format!("name = \"{}\"", measured_figure.name),
            key: "measured",
            problem,
        });
    }
    None
}

/// Returns the error in the scenario or parameters of a measured figure, if any.
fn figure_parameters_error(part: &LessonPart, measured_figure: &MeasuredFigure) -> Option<String> {
    if measured_figure.scenario.is_none() && measured_figure.parameters.is_empty() {
        return None;
    }
    let bundled = Configuration::bundled();
    let all = part.parameters.iter().chain(&measured_figure.parameters);
    let overrides: Vec<(String, String)> = all.map(|(key, value)| (key.clone(), value.to_string())).collect();
    let scenario = bundled.load_scenario(measured_figure.scenario.as_ref().unwrap_or(&part.scenario));
    scenario
        .and_then(|scenario| bundled.load_parameters(&scenario, &overrides, false))
        .err()
        .map(|error| error.to_string())
}

/// Returns the first placeholder that is not the name of a measured figure.
fn find_unknown_placeholder(lesson: &Lesson) -> Option<LessonDefect> {
    let steps = lesson.plan.parts.iter().flat_map(|part| &part.steps);
    let texts = steps.flat_map(|step| step.hints.iter().chain([&step.text]));
    let pitfall_texts = lesson.plan.pitfalls.iter().map(|pitfall| &pitfall.say);
    for text in texts.chain(pitfall_texts).chain([&lesson.debrief, &lesson.instructor_notes]) {
        let filled = lesson.fill_figures(text);
        let name = filled.split('{').skip(1).filter_map(|rest| rest.split_once('}')).map(|(name, _)| name);
        let is_name =
            |name: &&str| name.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_');
        if let Some(name) = name.into_iter().find(is_name) {
            return Some(LessonDefect {
                place: format!("{{{name}}}"),
                key: "measured",
                problem: format!("a text names {{{name}}}, which is not a measured figure"),
            });
        }
    }
    None
}
