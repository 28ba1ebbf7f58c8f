//! Formats the debrief of a lesson as text or as a page.

use serde_json::Value;

use super::deals::describe_deals;
use super::formatting::{format_money, pluralize};
use super::lesson::{describe_goal, describe_question, format_goal_amount, format_guess};
use super::page::{Block, Chart, Curve, NamedValue, Page, Plot, Table};
use novamind_base::formatting::{grouped_number, percent, signed_dollars};
use novamind_course::{
    Debrief, DebriefStep, DecisionComparison, DecisionDifference, DecisionEffect, DifferentDecision,
    FirstDifference, JudgedFigure, MEASURED_SEEDS, ReferenceCurve, ReferenceEffect, SettingDifference,
};
use novamind_glossary::{Term, terms};
use novamind_record::figures::{FigureUnit, WeekFigure};
use novamind_record::trajectory::record::RunEndReason;
use novamind_session::EnterpriseNames;
use novamind_tools::ToolId;

const MAX_LISTED_SETTINGS: usize = 6;

const MAX_LISTED_CALLS: usize = 2;

/// Summarizes the result of a part of the lesson in a sentence.
pub fn headline(debrief: &Debrief) -> String {
    let last = |cash: &[f64]| format_money(cash.last().copied().unwrap_or(0.0));
    let day = debrief.cash_by_day.len().saturating_sub(1);
    let end = match debrief.ended {
        Some(RunEndReason::Bankruptcy) => format!("You went bankrupt on day {day}"),
        _ => format!("You had {} on day {day}", last(&debrief.cash_by_day)),
    };
    let other = |curve: &Option<ReferenceCurve>, name: &str| {
        curve.as_ref().map(|curve| format!("{name} play {}", last(&curve.cash_by_day)))
    };
    let cash_of = |curve: &Option<ReferenceCurve>| curve.as_ref().map(|curve| last(&curve.cash_by_day));
    let others: Vec<String> = match cash_of(&debrief.reference) {
        Some(cash) if cash_of(&debrief.bad_play).as_ref() == Some(&cash) => {
            vec![format!("reference and pitfall play both {cash}")]
        }
        _ => [other(&debrief.reference, "reference"), other(&debrief.bad_play, "pitfall")]
            .into_iter()
            .flatten()
            .collect(),
    };
    let cash = match others.is_empty() {
        true => format!("{end}."),
        false => format!("{end}; {}.", others.join(", ")),
    };
    debrief
        .judged_by
        .as_ref()
        .and_then(describe_judged_figure)
        .map_or(cash.clone(), |judged| format!("{judged} {cash}"))
}

fn describe_judged_figure(judged: &JudgedFigure) -> Option<String> {
    let last = |curve: &[(u32, f64)]| curve.last().map(|(_, value)| format_figure(judged.figure, *value));
    let (day, _) = judged.actual.last()?;
    let mut text =
        format!("{} on day {day}: yours {}", capitalize(judged.figure.name()), last(&judged.actual)?);
    for (name, curve) in [("reference", &judged.reference), ("pitfall", &judged.bad_play)] {
        if let Some(value) = curve.as_deref().and_then(last) {
            text += &format!(", the {name} play's {value}");
        }
    }
    Some(text + ".")
}

fn format_figure(figure: WeekFigure, value: f64) -> String {
    match figure.unit() {
        FigureUnit::Dollars => format_money(value),
        FigureUnit::Count => grouped_number(value, 0),
        FigureUnit::Share | FigureUnit::PreciseShare => percent(value, 1),
        FigureUnit::Level => grouped_number(value, 3),
    }
}

fn capitalize(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// Returns the debrief as paragraphs of text.
pub fn debrief_paragraphs(debrief: &Debrief) -> Vec<String> {
    let part = debrief.part.as_ref().map(|part| format!(" · {part}")).unwrap_or_default();
    let mut lines = vec![format!("{}{part}", debrief.title), headline(debrief), String::new()];
    lines.extend(describe_comparison(debrief));
    for step in &debrief.steps {
        lines.push(String::new());
        lines.extend(describe_step(step));
    }
    if !debrief.pitfalls.is_empty() {
        lines.push(String::new());
        lines.extend(debrief.pitfalls.iter().map(|(day, say)| format!("Day {day}: {say}")));
    }
    if let Some(text) = &debrief.text {
        lines.extend(split_paragraphs(text).into_iter().flat_map(|paragraph| [String::new(), paragraph]));
        lines.extend([String::new(), describe_figure_source(debrief)]);
        lines.push(String::new());
        lines.extend(emphasized_terms(text).iter().map(|term| format!("{}: {}", term.title, term.text)));
    }
    lines
}

/// Describes the first decisions that differ from the reference play, and their effect.
pub fn describe_comparison(debrief: &Debrief) -> Vec<String> {
    match &debrief.comparison {
        DecisionComparison::Same => {
            vec!["You made the same decisions as the reference play, week by week.".to_owned()]
        }
        DecisionComparison::NoDecisions => vec!["This part required no decisions.".to_owned()],
        DecisionComparison::NotComparable => {
            vec!["Your decisions cannot be compared with the reference play in this run.".to_owned()]
        }
        DecisionComparison::Different(difference) => {
            let describe_play = |name: &str, play: &Option<ReferenceCurve>| {
                let text = play.as_ref().and_then(|play| play.text.as_ref());
                text.map(|text| format!("The {name} play: {text}"))
            };
            let mut lines: Vec<String> =
                [describe_play("reference", &debrief.reference), describe_play("pitfall", &debrief.bad_play)]
                    .into_iter()
                    .flatten()
                    .collect();
            lines.push(format!(
                "Your decisions first differ in week {}, day {}:",
                difference.week, difference.day
            ));
            let names = debrief.enterprise_names();
            lines.extend(
                difference.decisions.iter().map(|one| format!("  {}", describe_decision(one, &names))),
            );
            lines.push(describe_effect(difference, debrief));
            lines
        }
    }
}

fn describe_decision(decision: &DifferentDecision, names: &EnterpriseNames) -> String {
    let text = match &decision.difference {
        DecisionDifference::Settings { settings } => {
            let one = |setting: &SettingDifference| {
                format!(
                    "{} {}, reference play {}",
                    setting.name,
                    format_argument(&setting.own),
                    format_argument(&setting.good)
                )
            };
            let more = match settings.len().saturating_sub(MAX_LISTED_SETTINGS) {
                0 => String::new(),
                more => format!("; {more} more"),
            };
            settings.iter().take(MAX_LISTED_SETTINGS).map(one).collect::<Vec<_>>().join("; ") + &more
        }
        DecisionDifference::Calls { own: values, good } => {
            let describe = |calls| describe_calls(decision.tool, calls, names);
            format!("{}; reference play: {}", describe(values), describe(good))
        }
    };
    format!("{}: {text}", decision.tool.name())
}

fn format_argument(value: &Value) -> String {
    match value {
        Value::Null => "nothing".to_owned(),
        Value::String(text) => text.clone(),
        Value::Number(number) => {
            let value = number.as_f64().unwrap_or(0.0);
            grouped_number(value, if value.fract() == 0.0 { 0 } else { 2 })
        }
        other => other.to_string(),
    }
}

fn describe_calls(tool: ToolId, calls: &[Value], names: &EnterpriseNames) -> String {
    let one = |call: &Value| {
        if let Some(words) = describe_deals(tool, call, names) {
            return words;
        }
        let of = |(name, value): (&String, &Value)| format!("{name} {}", format_argument(value));
        call.as_object().map_or_else(
            || format_argument(call),
            |fields| fields.iter().map(of).collect::<Vec<_>>().join(", "),
        )
    };
    let more = match calls.len().saturating_sub(MAX_LISTED_CALLS) {
        0 => String::new(),
        more => format!("; {more} more"),
    };
    match calls {
        [] => "no call".to_owned(),
        calls => calls.iter().take(MAX_LISTED_CALLS).map(one).collect::<Vec<_>>().join("; ") + &more,
    }
}

fn describe_effect(difference: &FirstDifference, debrief: &Debrief) -> String {
    let effect = match difference.effect {
        DecisionEffect::Simulated(effect) => effect,
        DecisionEffect::Rejected => {
            return "The reference play's calls are rejected in your run, so their effect was not simulated."
                .to_owned();
        }
        DecisionEffect::DifferentCustomers => {
            return "Your later messages refer to enterprises by number. With other decisions, these numbers belong \
             to different enterprises, so the effect was not simulated."
                .to_owned();
        }
    };
    let judged_by = debrief.judged_by.as_ref();
    let figure = judged_by.zip(effect.judged).map(|(judged, (actual, with))| {
        let (actual, with) = (format_figure(judged.figure, actual), format_figure(judged.figure, with));
        format!("{} of {with} rather than {actual}, and ", judged.figure.name())
    });
    let text = format!(
        "Re-run with these decisions of the reference play in week {} and your other decisions: {}\
         cash of {} on day {} rather than {} ({}).",
        difference.week,
        figure.unwrap_or_default(),
        format_money(effect.with),
        effect.day,
        format_money(effect.own),
        signed_dollars(effect.with - effect.own)
    );
    text + &describe_single_or_joint_effect(effect, debrief)
}

/// Explains why the first decisions of the reference play that differ can worsen the result if only they are copied.
fn describe_single_or_joint_effect(effect: ReferenceEffect, debrief: &Debrief) -> String {
    let (mine, with) = effect.judged.unwrap_or((effect.own, effect.with));
    if with >= mine {
        return String::new();
    }
    let is_missed = |step: &DebriefStep| step.goals.iter().any(|goal| goal.met == Some(false));
    if effect.judged.is_none() && debrief.steps.iter().any(is_missed) {
        return " Cash alone does not measure this part; see its goals.".to_owned();
    }
    let good = match (&debrief.judged_by, effect.judged) {
        (Some(judged), Some(_)) => {
            judged.reference.as_ref().and_then(|good| Some((good.last()?.1, judged.figure)))
        }
        _ => None,
    };
    let cash = debrief.reference.as_ref().and_then(|good| good.cash_by_day.last());
    let (reached, words) = match (good, cash) {
        (Some((value, figure)), _) => (value, format_figure(figure, value)),
        (None, Some(cash)) => (*cash, format_money(*cash)),
        (None, None) => return String::new(),
    };
    match reached > mine {
        true => format!(
            " Copying only these decisions would have reduced your result. With its later decisions, the reference play reaches {words}."
        ),
        false => {
            format!(
                " Copying these decisions would have reduced your result: you did better than the reference play, which reaches {words}."
            )
        }
    }
}

fn describe_step(step: &DebriefStep) -> Vec<String> {
    let mut lines = vec![format!("{} · {}", step.title, describe_effort(step))];
    lines.extend(step.question.iter().flat_map(describe_question));
    lines.extend(step.goals.iter().map(describe_goal));
    lines
}

fn describe_effort(step: &DebriefStep) -> String {
    let (used, all) = step.hints;
    let tries = if step.tries == 1 { "1 try".to_owned() } else { format!("{} tries", step.tries) };
    format!("{tries}, {used} of {}", pluralize(all as u32, "hint"))
}

fn describe_figure_source(debrief: &Debrief) -> String {
    let (from, to) = (MEASURED_SEEDS.start(), MEASURED_SEEDS.end());
    format!(
        "Amounts in this text are averages over seeds {from} to {to}; your company has seed {}.",
        debrief.seed
    )
}

fn split_paragraphs(text: &str) -> Vec<String> {
    let plain = |paragraph: &str| {
        let words: Vec<&str> = paragraph.split_whitespace().collect();
        words.join(" ").replace(['*', '`'], "")
    };
    text.split("\n\n").map(plain).filter(|paragraph| !paragraph.is_empty()).collect()
}

/// Returns the glossary terms that a Markdown text emphasizes, each once.
pub fn emphasized_terms(text: &str) -> Vec<&'static Term> {
    let mut found: Vec<&'static Term> = Vec::new();
    let flat = text.split_whitespace().collect::<Vec<_>>().join(" ");
    for word in flat.split('*').skip(1).step_by(2) {
        let named = |term: &&Term| {
            let mut names = std::iter::once(&term.title).chain(&term.aka);
            names.any(|name| name.eq_ignore_ascii_case(word.trim()))
        };
        if let Some(term) = terms().iter().find(named)
            && !found.contains(&term)
        {
            found.push(term);
        }
    }
    found
}

pub(super) fn debrief_page(debrief: &Debrief) -> Page {
    let mut blocks = vec![Block::Facts(summary_facts(debrief))];
    if let Some(judged) = &debrief.judged_by {
        blocks.push(Block::Heading("Target"));
        blocks.push(Block::Chart(judged_chart(judged, &headline(debrief))));
    }
    blocks.push(Block::Heading("Cash"));
    blocks.push(Block::Chart(cash_chart(debrief)));
    blocks.push(Block::Heading("Comparison with the reference play"));
    blocks.extend(describe_comparison(debrief).into_iter().map(|line| Block::Text(line.trim().to_owned())));
    blocks.extend(guess_blocks(debrief));
    blocks.extend(goal_blocks(debrief));
    if !debrief.pitfalls.is_empty() {
        blocks.push(Block::Heading("Pitfalls"));
        let row = |(day, say): &(u32, String)| vec![day.to_string(), say.clone()];
        blocks.push(Block::Table(Table {
            columns: vec![("day", true), ("explanation", false)],
            rows: debrief.pitfalls.iter().map(row).collect(),
        }));
    }
    if let Some(text) = &debrief.text {
        blocks.push(Block::Heading("The mechanism"));
        blocks.extend(split_paragraphs(text).into_iter().map(Block::Text));
        blocks.push(Block::Text(describe_figure_source(debrief)));
        let row = |term: &&Term| vec![term.title.clone(), term.text.clone()];
        let rows: Vec<Vec<String>> = emphasized_terms(text).iter().map(row).collect();
        if !rows.is_empty() {
            blocks.push(Block::Table(Table { columns: vec![("term", false), ("meaning", false)], rows }));
        }
    }
    let mut tags = vec![format!("run {}", debrief.run), format!("seed {}", debrief.seed)];
    tags.extend(debrief.part.iter().cloned());
    tags.extend(debrief.participant.iter().map(|who| format!("played by {who}")));
    Page {
        title: format!("Debrief · {}", debrief.title),
        headline: headline(debrief),
        tags,
        blocks,
        footer: format!(
            "Recorded by NovaMind console {}. The reference play and the pitfall play were simulated with the seed of the run.",
            env!("CARGO_PKG_VERSION")
        ),
    }
}

fn summary_facts(debrief: &Debrief) -> Vec<NamedValue> {
    let last = |cash: &[f64]| format_money(cash.last().copied().unwrap_or(0.0));
    let day = format!("day {}", debrief.cash_by_day.len().saturating_sub(1));
    let mut facts = vec![NamedValue::new("You", last(&debrief.cash_by_day), day)];
    for (name, curve) in [("Reference play", &debrief.reference), ("Pitfall play", &debrief.bad_play)] {
        let fact = |curve: &ReferenceCurve| {
            NamedValue::new(name, last(&curve.cash_by_day), curve.text.clone().unwrap_or_default())
        };
        facts.extend(curve.as_ref().map(fact));
    }
    facts
}

fn cash_chart(debrief: &Debrief) -> Chart {
    let curve = |name: &str, cash: &[f64]| Curve {
        name: name.to_owned(),
        points: cash.iter().enumerate().map(|(day, cash)| (day as f64, *cash)).collect(),
    };
    let references = [("reference play", &debrief.reference), ("pitfall play", &debrief.bad_play)];
    let others = references
        .into_iter()
        .filter_map(|(name, reference_curve)| Some(curve(name, &reference_curve.as_ref()?.cash_by_day)));
    Chart {
        title: "Cash by day".to_owned(),
        summary: headline(debrief),
        x_label: "day",
        is_in_dollars: true,
        y_limits: None,
        plot: Plot::Lines {
            curves: std::iter::once(curve("you", &debrief.cash_by_day)).chain(others).collect(),
            band: None,
        },
    }
}

fn judged_chart(judged: &JudgedFigure, summary: &str) -> Chart {
    let curve = |name: &str, values: &[(u32, f64)]| Curve {
        name: name.to_owned(),
        points: values.iter().map(|(day, value)| (f64::from(*day), *value)).collect(),
    };
    let references = [("reference play", &judged.reference), ("pitfall play", &judged.bad_play)];
    let others = references.into_iter().filter_map(|(name, values)| Some(curve(name, values.as_ref()?)));
    Chart {
        title: format!("{} by week", capitalize(judged.figure.name())),
        summary: summary.to_owned(),
        x_label: "day",
        is_in_dollars: judged.figure.unit() == FigureUnit::Dollars,
        y_limits: None,
        plot: Plot::Lines {
            curves: std::iter::once(curve("you", &judged.actual)).chain(others).collect(),
            band: None,
        },
    }
}

fn guess_blocks(debrief: &Debrief) -> Vec<Block> {
    let asked = debrief.steps.iter().filter_map(|step| Some((step, step.question.as_ref()?)));
    let rows: Vec<Vec<String>> = asked
        .map(|(step, question)| {
            let guess_text =
                |value: Option<f64>| value.map_or("–".to_owned(), |value| format_guess(question, value));
            vec![
                step.title.clone(),
                question.text.clone(),
                guess_text(question.guess),
                guess_text(question.outcome),
            ]
        })
        .collect();
    if rows.is_empty() {
        return Vec::new();
    }
    let columns = vec![("step", false), ("question", false), ("your guess", false), ("outcome", false)];
    vec![Block::Heading("Guesses"), Block::Table(Table { columns, rows })]
}

fn goal_blocks(debrief: &Debrief) -> Vec<Block> {
    let row = |step: &DebriefStep| {
        let verdict = |is_met| match is_met {
            Some(true) => "reached",
            Some(false) => "missed",
            None => "not judged",
        };
        let one = |goal: &novamind_course::GoalStatus| {
            let number =
                |value: Option<f64>| value.map_or("–".to_owned(), |value| format_goal_amount(goal, value));
            vec![
                step.title.clone(),
                goal.text.clone(),
                number(goal.value),
                number(goal.bound),
                verdict(goal.met).to_owned(),
                describe_effort(step),
            ]
        };
        step.goals.iter().map(one).collect::<Vec<_>>()
    };
    let rows: Vec<Vec<String>> = debrief.steps.iter().flat_map(row).collect();
    if rows.is_empty() {
        return Vec::new();
    }
    let columns = vec![
        ("step", false),
        ("goal", false),
        ("value", true),
        ("target", true),
        ("", false),
        ("tries and hints", false),
    ];
    vec![Block::Heading("Goals"), Block::Table(Table { columns, rows })]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn emphasized_terms_are_found_and_marks_removed() {
        let text = "People *churn* if `a < b`.\n\nGlossary: *churn*, *model\ntier*, *no such thing*.";
        let names: Vec<&str> = emphasized_terms(text).iter().map(|term| term.id.as_str()).collect();
        assert_eq!(names, ["churn", "model-tier"]);
        assert_eq!(split_paragraphs(text)[0], "People churn if a < b.");
    }
}
