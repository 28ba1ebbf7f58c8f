//! The debrief of a lesson in words, and as a page.

use serde_json::Value;

use super::deals::deals_in_words;
use super::lesson::{goal_amount, goal_in_words, guess_in_words, question_in_words};
use super::page::{Block, Chart, Curve, Fact, Page, Plot, Table};
use super::words::{count, money};
use novamind_base::notation::{grouped, percent, signed_dollars};
use novamind_course::{
    Debrief, DebriefStep, DecisionComparison, DecisionContrast, DecisionEffect, FirstDifference,
    JudgedFigure, MEASURED_SEEDS, PartedDecision, PartingEffect, ReferenceCurve, SettingContrast,
};
use novamind_glossary::{Term, terms};
use novamind_record::figures::{FigureUnit, WeekFigure};
use novamind_record::trajectory::record::Ended;
use novamind_session::CompanyNames;
use novamind_tools::ToolId;

/// Most settings of a tool that are named one by one.
const MOST_SETTINGS: usize = 6;

/// Most calls of a tool that are named one by one.
const MOST_CALLS: usize = 2;

/// What the part came to, in a sentence.
pub fn headline(own: &Debrief) -> String {
    let last = |cash: &[f64]| money(cash.last().copied().unwrap_or(0.0));
    let day = own.own.len().saturating_sub(1);
    let end = match own.ended {
        Some(Ended::Bankruptcy) => format!("You went bankrupt on day {day}"),
        _ => format!("You had {} on day {day}", last(&own.own)),
    };
    let other = |curve: &Option<ReferenceCurve>, name: &str| {
        curve.as_ref().map(|curve| format!("the {name} play {}", last(&curve.cash_by_day)))
    };
    let cash_of = |curve: &Option<ReferenceCurve>| curve.as_ref().map(|curve| last(&curve.cash_by_day));
    let others: Vec<String> = match cash_of(&own.good) {
        Some(cash) if cash_of(&own.bad).as_ref() == Some(&cash) => {
            vec![format!("the good and the bad play both {cash}")]
        }
        _ => [other(&own.good, "good"), other(&own.bad, "bad")].into_iter().flatten().collect(),
    };
    let cash = match others.is_empty() {
        true => format!("{end}."),
        false => format!("{end}; {}.", others.join(", ")),
    };
    own.judged_by.as_ref().and_then(judged_in_words).map_or(cash.clone(), |judged| format!("{judged} {cash}"))
}

/// What the figure came to that the part is judged by.
fn judged_in_words(judged: &JudgedFigure) -> Option<String> {
    let last = |curve: &[(u32, f64)]| curve.last().map(|(_, value)| of_figure(judged.figure, *value));
    let (day, _) = judged.own.last()?;
    let mut said =
        format!("{} on day {day}: yours {}", capitalised(judged.figure.name()), last(&judged.own)?);
    for (name, curve) in [("good", &judged.good), ("bad", &judged.bad)] {
        if let Some(value) = curve.as_deref().and_then(last) {
            said += &format!(", the {name} play's {value}");
        }
    }
    Some(said + ".")
}

/// A value of a figure of weeks.
fn of_figure(figure: WeekFigure, value: f64) -> String {
    match figure.unit() {
        FigureUnit::Dollars => money(value),
        FigureUnit::Count => grouped(value, 0),
        FigureUnit::Share | FigureUnit::FineShare => percent(value, 1),
        FigureUnit::Level => grouped(value, 3),
    }
}

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// The debrief as paragraphs.
pub fn in_words(own: &Debrief) -> Vec<String> {
    let part = own.part.as_ref().map(|part| format!(" · {part}")).unwrap_or_default();
    let mut lines = vec![format!("{}{part}", own.title), headline(own), String::new()];
    lines.extend(comparison_in_words(own));
    for step in &own.steps {
        lines.push(String::new());
        lines.extend(step_in_words(step));
    }
    if !own.pitfalls.is_empty() {
        lines.push(String::new());
        lines.extend(own.pitfalls.iter().map(|(day, say)| format!("Day {day}: {say}")));
    }
    if let Some(text) = &own.text {
        lines.extend(paragraphs(text).into_iter().flat_map(|own| [String::new(), own]));
        lines.extend([String::new(), figures_in_text(own)]);
        lines.push(String::new());
        lines.extend(named_terms(text).iter().map(|term| format!("{}: {}", term.title, term.text)));
    }
    lines
}

/// Where the own decisions parted from those of the good play, and what that was worth.
pub fn comparison_in_words(own: &Debrief) -> Vec<String> {
    match &own.comparison {
        DecisionComparison::Same => vec!["You decided as the good play does, week by week.".to_owned()],
        DecisionComparison::Nothing => vec!["There was nothing to decide in this part.".to_owned()],
        DecisionComparison::Unknown => {
            vec!["Your decisions cannot be held against those of the good play in this run.".to_owned()]
        }
        DecisionComparison::Parted(parting) => {
            let told = |name: &str, play: &Option<ReferenceCurve>| {
                let text = play.as_ref().and_then(|play| play.text.as_ref());
                text.map(|text| format!("The {name} play: {text}"))
            };
            let mut lines: Vec<String> =
                [told("good", &own.good), told("bad", &own.bad)].into_iter().flatten().collect();
            lines.push(format!(
                "Week {}, day {}, is the first in which you decided otherwise:",
                parting.week, parting.day
            ));
            let names = own.company_names();
            lines.extend(parting.decisions.iter().map(|one| format!("  {}", decision_in_words(one, &names))));
            lines.push(effect_in_words(parting, own));
            lines
        }
    }
}

/// What one tool did in both plays.
fn decision_in_words(decision: &PartedDecision, names: &CompanyNames) -> String {
    let said = match &decision.difference {
        DecisionContrast::Settings { settings } => {
            let one = |setting: &SettingContrast| {
                format!(
                    "{} {}, the good play {}",
                    setting.name,
                    written(&setting.own),
                    written(&setting.good)
                )
            };
            let more = match settings.len().saturating_sub(MOST_SETTINGS) {
                0 => String::new(),
                more => format!("; {more} more"),
            };
            settings.iter().take(MOST_SETTINGS).map(one).collect::<Vec<_>>().join("; ") + &more
        }
        DecisionContrast::Calls { own, good } => {
            let told = |calls| calls_in_words(decision.tool, calls, names);
            format!("{}; the good play: {}", told(own), told(good))
        }
    };
    format!("{}: {said}", decision.tool.name())
}

fn written(value: &Value) -> String {
    match value {
        Value::Null => "nothing".to_owned(),
        Value::String(text) => text.clone(),
        Value::Number(number) => {
            let value = number.as_f64().unwrap_or(0.0);
            grouped(value, if value.fract() == 0.0 { 0 } else { 2 })
        }
        other => other.to_string(),
    }
}

/// Calls of one tool by their arguments.
fn calls_in_words(tool: ToolId, calls: &[Value], names: &CompanyNames) -> String {
    let one = |call: &Value| {
        if let Some(words) = deals_in_words(tool, call, names) {
            return words;
        }
        let of = |(name, value): (&String, &Value)| format!("{name} {}", written(value));
        call.as_object()
            .map_or_else(|| written(call), |own| own.iter().map(of).collect::<Vec<_>>().join(", "))
    };
    let more = match calls.len().saturating_sub(MOST_CALLS) {
        0 => String::new(),
        more => format!("; {more} more"),
    };
    match calls {
        [] => "no call".to_owned(),
        calls => calls.iter().take(MOST_CALLS).map(one).collect::<Vec<_>>().join("; ") + &more,
    }
}

fn effect_in_words(parting: &FirstDifference, own: &Debrief) -> String {
    let effect = match parting.effect {
        DecisionEffect::Simulated(effect) => effect,
        DecisionEffect::Refused => {
            return "The calls of the good play are refused in your run, so their effect was not simulated."
                .to_owned();
        }
        DecisionEffect::OtherCustomers => {
            return "Your later letters name companies by number. After other decisions other companies come under \
                    those numbers, so the effect was not simulated."
                .to_owned();
        }
    };
    let judged_by = own.judged_by.as_ref();
    let figure = judged_by.zip(effect.judged).map(|(judged, (own, with))| {
        let (own, with) = (of_figure(judged.figure, own), of_figure(judged.figure, with));
        format!("{} of {with} instead of {own}, and ", judged.figure.name())
    });
    let told = format!(
        "Simulated again with these decisions of the good play in week {}, and everything else as you decided it: {}\
         cash of {} on day {} instead of {} ({}).",
        parting.week,
        figure.unwrap_or_default(),
        money(effect.with),
        effect.day,
        money(effect.own),
        signed_dollars(effect.with - effect.own)
    );
    told + &alone_or_together(effect, own)
}

/// What is to be said where the first other decisions of the good play alone would have made it worse.
fn alone_or_together(effect: PartingEffect, own: &Debrief) -> String {
    let (mine, with) = effect.judged.unwrap_or((effect.own, effect.with));
    if with >= mine {
        return String::new();
    }
    let is_missed = |step: &DebriefStep| step.goals.iter().any(|goal| goal.met == Some(false));
    if effect.judged.is_none() && own.steps.iter().any(is_missed) {
        return " Cash alone is no measure of this part: its goals say what it asks for.".to_owned();
    }
    let good = match (&own.judged_by, effect.judged) {
        (Some(judged), Some(_)) => {
            judged.good.as_ref().and_then(|good| Some((good.last()?.1, judged.figure)))
        }
        _ => None,
    };
    let cash = own.good.as_ref().and_then(|good| good.cash_by_day.last());
    let (reached, words) = match (good, cash) {
        (Some((value, figure)), _) => (value, of_figure(figure, value)),
        (None, Some(cash)) => (*cash, money(*cash)),
        (None, None) => return String::new(),
    };
    match reached > mine {
        true => format!(
            " Alone they would have cost you; with all that the good play decides later they come to {words}."
        ),
        false => {
            format!(" They would have cost you: you came out ahead of the good play, which comes to {words}.")
        }
    }
}

fn step_in_words(step: &DebriefStep) -> Vec<String> {
    let mut lines = vec![format!("{} · {}", step.title, effort(step))];
    lines.extend(step.question.iter().flat_map(question_in_words));
    lines.extend(step.goals.iter().map(goal_in_words));
    lines
}

/// Tries and hints of a step.
fn effort(step: &DebriefStep) -> String {
    let (used, all) = step.hints;
    let tries = if step.tries == 1 { "1 try".to_owned() } else { format!("{} tries", step.tries) };
    format!("{tries}, {used} of {}", count(all as u32, "hint"))
}

/// Whose figures the text of a debrief tells.
fn figures_in_text(own: &Debrief) -> String {
    let (from, to) = (MEASURED_SEEDS.start(), MEASURED_SEEDS.end());
    format!("Amounts in this text are means over seeds {from} to {to}; your company had seed {}.", own.seed)
}

/// The paragraphs of a text in Markdown, without its marks.
fn paragraphs(text: &str) -> Vec<String> {
    let plain = |paragraph: &str| {
        let words: Vec<&str> = paragraph.split_whitespace().collect();
        words.join(" ").replace(['*', '`'], "")
    };
    text.split("\n\n").map(plain).filter(|paragraph| !paragraph.is_empty()).collect()
}

/// Terms of the glossary that a text in Markdown emphasises, each once.
pub fn named_terms(text: &str) -> Vec<&'static Term> {
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

/// The page of a debrief.
pub(super) fn page_of(own: &Debrief) -> Page {
    let mut blocks = vec![Block::Facts(facts(own))];
    if let Some(judged) = &own.judged_by {
        blocks.push(Block::Heading("What was to be reached"));
        blocks.push(Block::Chart(judged_chart(judged, &headline(own))));
    }
    blocks.push(Block::Heading("Cash"));
    blocks.push(Block::Chart(cash(own)));
    blocks.push(Block::Heading("Beside the good play"));
    blocks.extend(comparison_in_words(own).into_iter().map(|line| Block::Text(line.trim().to_owned())));
    blocks.extend(guesses(own));
    blocks.extend(goals(own));
    if !own.pitfalls.is_empty() {
        blocks.push(Block::Heading("Pitfalls"));
        let row = |(day, say): &(u32, String)| vec![day.to_string(), say.clone()];
        blocks.push(Block::Table(Table {
            columns: vec![("day", true), ("what was said", false)],
            rows: own.pitfalls.iter().map(row).collect(),
        }));
    }
    if let Some(text) = &own.text {
        blocks.push(Block::Heading("The mechanism"));
        blocks.extend(paragraphs(text).into_iter().map(Block::Text));
        blocks.push(Block::Text(figures_in_text(own)));
        let row = |term: &&Term| vec![term.title.clone(), term.text.clone()];
        let rows: Vec<Vec<String>> = named_terms(text).iter().map(row).collect();
        if !rows.is_empty() {
            blocks.push(Block::Table(Table { columns: vec![("term", false), ("what it is", false)], rows }));
        }
    }
    let mut tags = vec![format!("run {}", own.run), format!("seed {}", own.seed)];
    tags.extend(own.part.iter().cloned());
    tags.extend(own.participant.iter().map(|who| format!("played by {who}")));
    Page {
        title: format!("Debrief · {}", own.title),
        headline: headline(own),
        tags,
        blocks,
        foot: format!(
            "Recorded by NovaMind console {}. The good and the bad play were simulated on the seed of the run.",
            env!("CARGO_PKG_VERSION")
        ),
    }
}

fn facts(own: &Debrief) -> Vec<Fact> {
    let last = |cash: &[f64]| money(cash.last().copied().unwrap_or(0.0));
    let day = format!("day {}", own.own.len().saturating_sub(1));
    let mut facts = vec![Fact::new("You", last(&own.own), day)];
    for (name, curve) in [("Good play", &own.good), ("Bad play", &own.bad)] {
        let told = |curve: &ReferenceCurve| {
            Fact::new(name, last(&curve.cash_by_day), curve.text.clone().unwrap_or_default())
        };
        facts.extend(curve.as_ref().map(told));
    }
    facts
}

fn cash(own: &Debrief) -> Chart {
    let curve = |name: &str, cash: &[f64]| Curve {
        name: name.to_owned(),
        points: cash.iter().enumerate().map(|(day, cash)| (day as f64, *cash)).collect(),
    };
    let references = [("good play", &own.good), ("bad play", &own.bad)];
    let others =
        references.into_iter().filter_map(|(name, own)| Some(curve(name, &own.as_ref()?.cash_by_day)));
    Chart {
        title: "Cash by day".to_owned(),
        summary: headline(own),
        across: "day",
        dollars: true,
        within: None,
        plot: Plot::Lines {
            curves: std::iter::once(curve("you", &own.own)).chain(others).collect(),
            band: None,
        },
    }
}

/// The figure that the part is judged by, week by week.
fn judged_chart(judged: &JudgedFigure, summary: &str) -> Chart {
    let curve = |name: &str, values: &[(u32, f64)]| Curve {
        name: name.to_owned(),
        points: values.iter().map(|(day, value)| (f64::from(*day), *value)).collect(),
    };
    let references = [("good play", &judged.good), ("bad play", &judged.bad)];
    let others = references.into_iter().filter_map(|(name, own)| Some(curve(name, own.as_ref()?)));
    Chart {
        title: format!("{} by week", capitalised(judged.figure.name())),
        summary: summary.to_owned(),
        across: "day",
        dollars: judged.figure.unit() == FigureUnit::Dollars,
        within: None,
        plot: Plot::Lines {
            curves: std::iter::once(curve("you", &judged.own)).chain(others).collect(),
            band: None,
        },
    }
}

fn guesses(own: &Debrief) -> Vec<Block> {
    let asked = own.steps.iter().filter_map(|step| Some((step, step.question.as_ref()?)));
    let rows: Vec<Vec<String>> = asked
        .map(|(step, question)| {
            let said =
                |value: Option<f64>| value.map_or("–".to_owned(), |value| guess_in_words(question, value));
            vec![step.title.clone(), question.text.clone(), said(question.guess), said(question.outcome)]
        })
        .collect();
    if rows.is_empty() {
        return Vec::new();
    }
    let columns = vec![("step", false), ("question", false), ("your guess", false), ("outcome", false)];
    vec![Block::Heading("Guesses"), Block::Table(Table { columns, rows })]
}

fn goals(own: &Debrief) -> Vec<Block> {
    let row = |step: &DebriefStep| {
        let met = |met| match met {
            Some(true) => "reached",
            Some(false) => "missed",
            None => "not judged",
        };
        let one = |goal: &novamind_course::GoalPage| {
            let number =
                |value: Option<f64>| value.map_or("–".to_owned(), |value| goal_amount(goal, value));
            vec![
                step.title.clone(),
                goal.text.clone(),
                number(goal.value),
                number(goal.bound),
                met(goal.met).to_owned(),
                effort(step),
            ]
        };
        step.goals.iter().map(one).collect::<Vec<_>>()
    };
    let rows: Vec<Vec<String>> = own.steps.iter().flat_map(row).collect();
    if rows.is_empty() {
        return Vec::new();
    }
    let columns = vec![
        ("step", false),
        ("goal", false),
        ("value", true),
        ("bound", true),
        ("", false),
        ("tries and hints", false),
    ];
    vec![Block::Heading("Goals"), Block::Table(Table { columns, rows })]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn emphasised_words_are_looked_up_and_marks_do_not_stay() {
        let text = "People *churn* if `a < b`.\n\nGlossary: *churn*, *model\ntier*, *no such thing*.";
        let names: Vec<&str> = named_terms(text).iter().map(|term| term.id.as_str()).collect();
        assert_eq!(names, ["churn", "model-tier"]);
        assert_eq!(paragraphs(text)[0], "People churn if a < b.");
    }
}
