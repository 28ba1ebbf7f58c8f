//! Results of a class as text for the terminal.

use super::ClassView;
use super::curves::{scatter, student_curves};
use super::guesses::{class_questions, pitfall_counts};
use super::ranking::{RankedStudent, rank_students};
use crate::formatting::{format_money, pluralize};
use crate::plot::{PlotSeries, plot_report};
use novamind_base::formatting::{compact_number, escape_control_characters, percent};
use novamind_course::{ClassFinding, RunVerdict};

/// Describes a finding, and what the instructor can do about it.
pub fn describe_finding(finding: &ClassFinding) -> String {
    match finding {
        ClassFinding::Unreadable { label, path, problem } => {
            let who = label.as_ref().map(|label| format!("{label}: ")).unwrap_or_default();
            let place = path.display().to_string();
            // Most descriptions of problems already contain the path.
            let place = if problem.contains(&place) { String::new() } else { format!("{place}: ") };
            format!("{who}not collected: {place}{problem}")
        }
        ClassFinding::Altered { label, run, problem } => {
            format!(
                "{label}: run {run} was altered and does not count. {problem}. Ask the student to send it again"
            )
        }
        ClassFinding::Conflicting { label, run, paths } => {
            let paths: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
            format!(
                "{label}: run {run} has two records, and neither continues the other: {}. Neither is ranked; ask \
                 which one counts, and collect again without the other",
                paths.join(" and ")
            )
        }
        ClassFinding::OtherLesson { label, run } => {
            format!(
                "{label}: run {run} belongs to a different lesson or to another version of the lesson and does not count"
            )
        }
        ClassFinding::OtherHandout { label, run, of: Some(of) } => {
            format!(
                "{label}: run {run} started from the handout of {of} and does not count; find out who played it"
            )
        }
        ClassFinding::OtherHandout { label, run, of: None } => {
            format!("{label}: run {run} does not continue the run that was handed out and does not count")
        }
        ClassFinding::Unknown { label, run, path } => {
            let who = label.as_deref().unwrap_or("unknown student");
            format!(
                "{who}: run {run} in {} did not start from a handout of this class and does not count",
                path.display()
            )
        }
        ClassFinding::Missing { label } => format!("{label}: no submission"),
        ClassFinding::NotFinished { label, parts } if parts.len() == 1 && parts[0] == 1 => {
            format!("{label}: not finished")
        }
        ClassFinding::NotFinished { label, parts } => {
            let parts: Vec<String> = parts.iter().map(u32::to_string).collect();
            format!("{label}: not finished: part {}", parts.join(", "))
        }
        ClassFinding::AlteredHandout { label } => {
            format!(
                "{label}: the handout in the class folder was altered; runs started before the change are not affected"
            )
        }
    }
}

/// Summarizes the submissions and lists the findings.
pub fn describe_collection(view: &ClassView<'_>) -> String {
    let collection = view.collection;
    let mut text = headline(view) + "\n";
    if collection.superseded > 0 {
        let records = pluralize(collection.superseded, "record");
        text += &format!("{records} skipped: duplicates or earlier states of collected runs\n");
    }
    if collection.others > 0 {
        text += &format!("{} from outside the class ignored\n", pluralize(collection.others, "run"));
    }
    for finding in &collection.findings {
        text += &format!("! {}\n", escape_control_characters(&describe_finding(finding)));
    }
    text
}

fn headline(view: &ClassView<'_>) -> String {
    format!("{} · {}", view.title(), describe_submission_count(view))
}

/// Summarizes how many students the class has and how many runs they submitted.
pub fn describe_submission_count(view: &ClassView<'_>) -> String {
    let students = view.class.students.len() as u32;
    let of = |verdict: RunVerdict| view.collection.runs.iter().filter(|run| run.verdict == verdict).count();
    let verdicts = [
        RunVerdict::Finished,
        RunVerdict::NotFinished,
        RunVerdict::Altered,
        RunVerdict::Conflicting,
        RunVerdict::OtherLesson,
        RunVerdict::OtherHandout,
        RunVerdict::Unknown,
    ];
    let runs: Vec<String> = verdicts
        .into_iter()
        .filter(|verdict| of(*verdict) > 0)
        .map(|verdict| format!("{} {}", of(verdict), verdict.label()))
        .collect();
    let runs =
        if runs.is_empty() { "no submissions".to_owned() } else { format!("runs: {}", runs.join(", ")) };
    format!("{} · {runs}", pluralize(students, "student"))
}

/// Shows the class in a terminal: ranking, curves, a scatter plot, guesses, pitfalls and findings.
pub fn class_to_text(view: &ClassView<'_>) -> String {
    let ranking = rank_students(view);
    let mut text = format!("{}\nRanked by {}.\n\n", headline(view), view.describe_measure());
    text += &ranking_text(view, &ranking);
    let lit = view.display.highlighted_student.as_deref().or(ranking.first().map(|first| first.label));
    for part in 1..=view.part_count() {
        text += &drawings_text(view, &ranking, part, lit);
    }
    text += &guesses_text(view, &ranking);
    let counts = pitfall_counts(view);
    if let Some((most, others)) = counts.split_first() {
        let students = pluralize(most.students as u32, "student");
        text += &format!("\nMost common pitfall: {}, by {students}. {}\n", most.name, most.explanation);
        for pitfall_count in others {
            text += &format!("  {}: {}\n", pitfall_count.name, pitfall_count.students);
        }
    }
    match view.display.hides_names {
        // If names are hidden, findings are omitted, because they contain labels of students.
        true => text,
        false => {
            let wrong: String = view
                .collection
                .findings
                .iter()
                .map(|class_finding| format!("! {}\n", describe_finding(class_finding)))
                .collect();
            let text = if wrong.is_empty() { text } else { text + "\n" + &wrong };
            escape_control_characters(&text).into_owned()
        }
    }
}

fn ranking_text(view: &ClassView<'_>, ranking: &[RankedStudent<'_>]) -> String {
    let width = ranking.iter().map(|student| student.name.chars().count()).max().unwrap_or(0).max(7);
    let heading = if view.lesson.is_some() { "of reference" } else { "cash" };
    let mut text = format!("rank  {:<width$}  {heading:>12}  tries  hints  goals  pitfalls\n", "student");
    for (at, student) in ranking.iter().enumerate() {
        let score = format_score(view, student);
        text += format!(
            "{:>4}  {:<width$}  {score:>12}  {:>5}  {:>5}  {:>5}  {}",
            at + 1,
            student.name,
            student.max_try(),
            student.hint_count(),
            student.format_goals(),
            student.format_pitfalls()
        )
        .trim_end();
        text.push('\n');
    }
    text
}

/// Formats a student's score: a percentage of the reference play, or dollars.
pub fn format_score(view: &ClassView<'_>, student: &RankedStudent<'_>) -> String {
    match view.lesson {
        Some(_) => percent(student.score, 0),
        None => format_money(student.score),
    }
}

impl RankedStudent<'_> {
    /// Returns the highest try number in the runs that count.
    pub fn max_try(&self) -> u32 {
        self.runs.iter().map(|run| run.evidence.tries).max().unwrap_or(0)
    }

    /// Returns the number of hints used in the runs that count.
    pub fn hint_count(&self) -> u32 {
        self.runs.iter().map(|run| run.evidence.hints).sum()
    }

    /// Formats the number of reached goals and the number of judged goals: `2/3`.
    pub fn format_goals(&self) -> String {
        let goals = || self.runs.iter().flat_map(|run| &run.evidence.steps).flat_map(|step| &step.goals);
        format!("{}/{}", goals().filter(|goal| goal.met).count(), goals().count())
    }

    /// Formats the names of the triggered pitfalls.
    pub fn format_pitfalls(&self) -> String {
        let all: Vec<&str> =
            self.runs.iter().flat_map(|run| &run.evidence.pitfalls).map(String::as_str).collect();
        all.join(" ")
    }
}

fn drawings_text(
    view: &ClassView<'_>,
    ranking: &[RankedStudent<'_>],
    part: u32,
    lit: Option<&str>,
) -> String {
    let all = student_curves(view, ranking, part);
    let title = view.part_title(part).map(|title| format!(", {title}")).unwrap_or_default();
    let name = ranking
        .iter()
        .find(|ranked_student| Some(ranked_student.label) == lit)
        .map_or("no one", |student| student.name.as_str());
    let mut text = format!("\nCash by day{title}: {name} #, reference play o, others ·\n");
    let sign = |label: Option<&str>| match label {
        None => 'o',
        label if label == lit => '#',
        Some(_) => '\u{b7}',
    };
    let drawn = |student_points: &[super::curves::StudentPoints<'_>], is_line: bool| {
        let mut all: Vec<PlotSeries<'_>> = student_points
            .iter()
            .map(|student| PlotSeries { mark: sign(student.label), points: &student.points, is_line })
            .collect();
        all.sort_by_key(|plot_series| ['\u{b7}', 'o', '#'].iter().position(|sign| *sign == plot_series.mark));
        plot_report(&all)
    };
    text += &drawn(&all, true);
    if let Some(scatter) = scatter(view, ranking, part) {
        text += &format!("\n{} across, {} up: {name} #, others ·\n", scatter.decision, scatter.figure);
        text += &drawn(&scatter.points, false);
    }
    text
}

fn guesses_text(view: &ClassView<'_>, ranking: &[RankedStudent<'_>]) -> String {
    let mut text = String::new();
    for class_question in class_questions(view).into_iter().filter(|question| !question.answers.is_empty()) {
        let part =
            if view.part_count() > 1 { format!("part {}: ", class_question.part) } else { String::new() };
        text += &format!("\nGuesses: {part}{}\n", class_question.question);
        if class_question.choices.is_empty() {
            let mut guesses: Vec<f64> = class_question.answers.iter().map(|answer| answer.1).collect();
            guesses.sort_by(f64::total_cmp);
            let distance = |answer: &&(&str, f64, f64)| (answer.1 - answer.2).abs();
            let nearest =
                class_question.answers.iter().min_by(|one, other| distance(one).total_cmp(&distance(other)));
            let named = |label: &str| {
                ranking
                    .iter()
                    .find(|ranked_student| ranked_student.label == label)
                    .map_or("-", |student| student.name.as_str())
            };
            let nearest = nearest.map(|(label, guess, outcome)| {
                format!(
                    "; nearest {}: {} for {}",
                    named(label),
                    compact_number(*guess),
                    compact_number(*outcome)
                )
            });
            text += &format!(
                "  {} from {} to {}, median {}{}\n",
                guesses.len(),
                compact_number(guesses[0]),
                compact_number(guesses[guesses.len() - 1]),
                compact_number(guesses[guesses.len() / 2]),
                nearest.unwrap_or_default()
            );
        } else {
            for (number, choice) in (1..).zip(class_question.choices) {
                let taken =
                    class_question.answers.iter().filter(|answer| answer.1 == f64::from(number)).count();
                let is_right = class_question.answers.iter().any(|answer| answer.2 == f64::from(number));
                text += &format!("  {:>3}  {choice}{}\n", taken, if is_right { "  (correct)" } else { "" });
            }
        }
    }
    text
}
