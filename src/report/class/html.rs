//! Results of a class as a self-contained HTML page for a projector, without scripts. Radio buttons, which the user
//! selects with the mouse or the arrow keys, highlight a student.

use std::fmt::Write;

use super::curves::{scatter, student_curves};
use super::drawing::{PointDrawing, draw};
use super::guesses::{class_questions, pitfall_counts};
use super::ranking::{RankedStudent, rank_students};
use super::text::describe_finding;
use super::{ClassView, RunVerdict};
use crate::formatting::{format_money, pluralize};
use crate::html::STYLE;
use novamind_base::formatting::{escape_html, percent};

const CLASS_STYLE: &str = include_str!("../../../assets/class.css");

/// Returns the results of a class as an HTML page.
pub fn class_to_html(view: &ClassView<'_>) -> String {
    let ranking = rank_students(view);
    let lit = view.display.highlighted_student.as_deref().or(ranking.first().map(|first| first.label));
    let finished = view.collection.runs.iter().filter(|run| run.verdict == RunVerdict::Finished).count();
    let title = escape_html(&view.title());
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
         <meta name=\"color-scheme\" content=\"light dark\"/>\n<title>{title}</title>\n<style>\n{STYLE}{CLASS_STYLE}{}</style>\n\
         </head>\n<body>\n<main>\n<header>\n<p class=\"brand\">NovaMind class</p>\n<h1>{title}</h1>\n<ul class=\"tags\">\
         <li>{}</li><li>{} finished</li></ul>\n<p class=\"note\">Ranked by {}.</p>\n</header>\n",
        highlight_style(ranking.len()),
        pluralize(view.class.students.len() as u32, "student"),
        pluralize(finished as u32, "run"),
        escape_html(&view.describe_measure())
    );
    // A CSS selector matches only elements that follow the radio buttons, so the buttons are written first.
    for (at, student) in ranking.iter().enumerate() {
        let checked = if Some(student.label) == lit { " checked=\"checked\"" } else { "" };
        let name = escape_html(&student.name);
        let _ = writeln!(
            page,
            "<input class=\"pick\" type=\"radio\" name=\"lit\" id=\"r{at}\" aria-label=\"{name}\"{checked}/>"
        );
    }
    let names = ranking.iter().enumerate();
    let names: String = names
        .map(|(at, ranked_student)| {
            format!("<label class=\"n{at}\" for=\"r{at}\">{}</label>\n", escape_html(&ranked_student.name))
        })
        .collect();
    let _ = write!(page, "<div class=\"names\">\n{names}</div>\n");
    for part in 1..=view.part_count() {
        page += &part_drawings(view, &ranking, part);
    }
    page += &ranking_table(view, &ranking);
    page += &guesses_html(view, &ranking);
    page += &pitfalls_html(view);
    if !view.display.hides_names && !view.collection.findings.is_empty() {
        let wrong = view
            .collection
            .findings
            .iter()
            .map(|class_finding| format!("<li>{}</li>\n", escape_html(&describe_finding(class_finding))));
        let _ = write!(
            page,
            "<section>\n<h2>Not counted or missing</h2>\n<ul>\n{}</ul>\n</section>\n",
            wrong.collect::<String>()
        );
    }
    page + "</main>\n</body>\n</html>\n"
}

fn highlight_style(students: usize) -> String {
    let rule = |at: usize| {
        format!(
            "#r{at}:checked~section .c{at}{{stroke:var(--c2);stroke-opacity:1;stroke-width:4;fill-opacity:1}}\
             #r{at}:checked~section .dot.c{at}{{fill:var(--c2);stroke:none}}\
             #r{at}:checked~.names .n{at},#r{at}:checked~section tr.t{at} td{{color:var(--c2);font-weight:700}}\
             #r{at}:focus-visible~.names .n{at}{{outline:2px solid var(--c2)}}\n"
        )
    };
    (0..students).map(rule).collect()
}

fn student_marks<'a>(ranking: &'a [RankedStudent<'a>]) -> impl Fn(&str) -> Option<(String, String)> + 'a {
    |label| {
        let at = ranking.iter().position(|ranked_student| ranked_student.label == label)?;
        Some((format!("c{at}"), ranking[at].name.clone()))
    }
}

fn figure_html(caption: &str, drawing: &PointDrawing<'_>, ranking: &[RankedStudent<'_>]) -> String {
    format!(
        "<figure>\n<figcaption>{}</figcaption>\n{}</figure>\n",
        escape_html(caption),
        draw(drawing, &student_marks(ranking))
    )
}

fn part_drawings(view: &ClassView<'_>, ranking: &[RankedStudent<'_>], part: u32) -> String {
    let heading = view.part_title(part).unwrap_or("Curves");
    let all = student_curves(view, ranking, part);
    let title = format!("Cash by day of {}", pluralize(ranking.len() as u32, "student"));
    let curves =
        PointDrawing { title, x_label: "day".to_owned(), points: &all, is_line: true, has_diagonal: false };
    let mut text = format!("<section>\n<h2>{}</h2>\n", escape_html(heading));
    text += &figure_html("Cash, dollars. The dashed curve is the reference play", &curves, ranking);
    if let Some(scatter) = scatter(view, ranking, part) {
        let caption = format!("Final {} by {}", scatter.figure, scatter.decision);
        let across = format!("{}, mean over the weeks", scatter.decision);
        let points = &scatter.points;
        let drawing = PointDrawing {
            title: caption.clone(),
            x_label: across,
            points,
            is_line: false,
            has_diagonal: false,
        };
        text += &figure_html(&caption, &drawing, ranking);
    }
    text + "</section>\n"
}

fn ranking_table(view: &ClassView<'_>, ranking: &[RankedStudent<'_>]) -> String {
    let score = if view.lesson.is_some() { "Share of reference" } else { "Cash" };
    let mut text = format!(
        "<section>\n<h2>Ranking</h2>\n<div class=\"wide\"><table>\n<thead><tr><th scope=\"col\" class=\"number\">Rank</th>\
         <th scope=\"col\">Student</th><th scope=\"col\" class=\"number\">{score}</th><th scope=\"col\" class=\"number\">Tries\
         </th><th scope=\"col\" class=\"number\">Hints</th><th scope=\"col\" class=\"number\">Goals</th><th scope=\"col\">\
         Pitfalls</th></tr></thead>\n<tbody>\n"
    );
    for (at, student) in ranking.iter().enumerate() {
        let score =
            if view.lesson.is_some() { percent(student.score, 0) } else { format_money(student.score) };
        let _ = writeln!(
            text,
            "<tr class=\"t{at}\"><td class=\"number\">{}</td><td>{}</td><td class=\"number\">{score}</td><td class=\"number\">{}\
             </td><td class=\"number\">{}</td><td class=\"number\">{}</td><td>{}</td></tr>",
            at + 1,
            escape_html(&student.name),
            student.max_try(),
            student.hint_count(),
            student.format_goals(),
            escape_html(&student.format_pitfalls())
        );
    }
    text + "</tbody>\n</table></div>\n</section>\n"
}

fn guesses_html(view: &ClassView<'_>, ranking: &[RankedStudent<'_>]) -> String {
    let mut text = String::new();
    for class_question in class_questions(view).into_iter().filter(|asked| !asked.answers.is_empty()) {
        if class_question.choices.is_empty() {
            let points = class_question.points();
            let title = format!("{} Outcome by guess", class_question.question);
            let across = "guess; points on the line were exact".to_owned();
            let drawing =
                PointDrawing { title, x_label: across, points: &points, is_line: false, has_diagonal: true };
            text += &figure_html(class_question.question, &drawing, ranking);
            continue;
        }
        text += &format!("<h3>{}</h3>\n", escape_html(class_question.question));
        let bar = |(number, choice): (u32, &String)| {
            let taken = class_question.answers.iter().filter(|answer| answer.1 == f64::from(number)).count();
            let is_right = class_question.answers.iter().any(|answer| answer.2 == f64::from(number));
            (choice.clone(), taken, is_right)
        };
        text += &bars_html((1..).zip(class_question.choices).map(bar), class_question.answers.len());
    }
    if text.is_empty() { text } else { format!("<section>\n<h2>Guesses</h2>\n{text}</section>\n") }
}

fn pitfalls_html(view: &ClassView<'_>) -> String {
    let counts = pitfall_counts(view);
    let Some(most) = counts.first() else { return String::new() };
    let rows = counts
        .iter()
        .enumerate()
        .map(|(at, pitfall_count)| (pitfall_count.name.to_owned(), pitfall_count.students, at == 0));
    format!(
        "<section>\n<h2>Pitfalls</h2>\n<p>{}</p>\n{}</section>\n",
        escape_html(&most.explanation),
        bars_html(rows, view.class.students.len())
    )
}

fn bars_html(rows: impl Iterator<Item = (String, usize, bool)>, all: usize) -> String {
    let bar = |(name, count, is_highlighted): (String, usize, bool)| {
        format!(
            "<li{}><span class=\"name\">{}</span><span class=\"amount\">{count}</span><span class=\"track\"><span \
             style=\"width:{:.1}%\"></span></span></li>\n",
            if is_highlighted { " class=\"own\"" } else { "" },
            escape_html(&name),
            100.0 * count as f64 / all.max(1) as f64
        )
    };
    format!("<ol class=\"bars\">\n{}</ol>\n", rows.map(bar).collect::<String>())
}
