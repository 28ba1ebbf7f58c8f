//! The debrief of a lesson as text and as a page.

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

const MOST_SETTINGS: usize = 6;

const MOST_CALLS: usize = 2;

/// Summarizes the result of the part in a sentence.
pub fn headline(own: &Debrief) -> String {
    let last = |cash: &[f64]| money(cash.last().copied().unwrap_or(0.0));
    let day = own.own.len().saturating_sub(1);
    let end = match own.ended {
        Some(Ended::Bankruptcy) => format!("You went bankrupt on day {day}"),
        _ => format!("You had {} on day {day}", last(&own.own)),
    };
    let other = |curve: &Option<ReferenceCurve>, name: &str| {
        curve.as_ref().map(|curve| format!("{name} play {}", last(&curve.cash_by_day)))
    };
    let cash_of = |curve: &Option<ReferenceCurve>| curve.as_ref().map(|curve| last(&curve.cash_by_day));
    let others: Vec<String> = match cash_of(&own.good) {
        Some(cash) if cash_of(&own.bad).as_ref() == Some(&cash) => {
            vec![format!("reference and bad play both {cash}")]
        }
        _ => [other(&own.good, "reference"), other(&own.bad, "bad")].into_iter().flatten().collect(),
    };
    let cash = match others.is_empty() {
        true => format!("{end}."),
        false => format!("{end}; {}.", others.join(", ")),
    };
    own.judged_by.as_ref().and_then(judged_in_words).map_or(cash.clone(), |judged| format!("{judged} {cash}"))
}

fn judged_in_words(judged: &JudgedFigure) -> Option<String> {
    let last = |curve: &[(u32, f64)]| curve.last().map(|(_, value)| of_figure(judged.figure, *value));
    let (day, _) = judged.own.last()?;
    let mut said =
        format!("{} on day {day}: yours {}", capitalised(judged.figure.name()), last(&judged.own)?);
    for (name, curve) in [("reference", &judged.good), ("bad", &judged.bad)] {
        if let Some(value) = curve.as_deref().and_then(last) {
            said += &format!(", the {name} play's {value}");
        }
    }
    Some(said + ".")
}

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

/// Returns the debrief as paragraphs.
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

/// Describes the first decisions that differ from the reference play, and their effect.
pub fn comparison_in_words(own: &Debrief) -> Vec<String> {
    match &own.comparison {
        DecisionComparison::Same => {
            vec!["You made the same decisions as the reference play, week by week.".to_owned()]
        }
        DecisionComparison::Nothing => vec!["There was nothing to decide in this part.".to_owned()],
        DecisionComparison::Unknown => {
            vec!["Your decisions cannot be compared with the reference play in this run.".to_owned()]
        }
        DecisionComparison::Parted(parting) => {
            let told = |name: &str, play: &Option<ReferenceCurve>| {
                let text = play.as_ref().and_then(|play| play.text.as_ref());
                text.map(|text| format!("The {name} play: {text}"))
            };
            let mut lines: Vec<String> =
                [told("reference", &own.good), told("bad", &own.bad)].into_iter().flatten().collect();
            lines.push(format!("Your decisions first differ in week {}, day {}:", parting.week, parting.day));
            let names = own.company_names();
            lines.extend(parting.decisions.iter().map(|one| format!("  {}", decision_in_words(one, &names))));
            lines.push(effect_in_words(parting, own));
            lines
        }
    }
}

fn decision_in_words(decision: &PartedDecision, names: &CompanyNames) -> String {
    let said = match &decision.difference {
        DecisionContrast::Settings { settings } => {
            let one = |setting: &SettingContrast| {
                format!(
                    "{} {}, reference play {}",
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
            format!("{}; reference play: {}", told(own), told(good))
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
            return "The rules reject the reference play's calls in your run, so their effect was not simulated."
                .to_owned();
        }
        DecisionEffect::OtherCustomers => {
            return "Your later messages name enterprises by number. After other decisions these numbers belong to \
                    different enterprises, so the effect was not simulated."
                .to_owned();
        }
    };
    let judged_by = own.judged_by.as_ref();
    let figure = judged_by.zip(effect.judged).map(|(judged, (own, with))| {
        let (own, with) = (of_figure(judged.figure, own), of_figure(judged.figure, with));
        format!("{} of {with} rather than {own}, and ", judged.figure.name())
    });
    let told = format!(
        "Re-run with these decisions of the reference play in week {} and your other decisions: {}\
         cash of {} on day {} rather than {} ({}).",
        parting.week,
        figure.unwrap_or_default(),
        money(effect.with),
        effect.day,
        money(effect.own),
        signed_dollars(effect.with - effect.own)
    );
    told + &alone_or_together(effect, own)
}

/// Explains the result if the first different decisions of the reference play alone make it worse.
fn alone_or_together(effect: PartingEffect, own: &Debrief) -> String {
    let (mine, with) = effect.judged.unwrap_or((effect.own, effect.with));
    if with >= mine {
        return String::new();
    }
    let is_missed = |step: &DebriefStep| step.goals.iter().any(|goal| goal.met == Some(false));
    if effect.judged.is_none() && own.steps.iter().any(is_missed) {
        return " Cash alone does not measure this part; see its goals.".to_owned();
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
            " Copying them alone would have cost you; with its later decisions, the reference play reaches {words}."
        ),
        false => {
            format!(
                " Copying them would have cost you: you did better than the reference play, which reaches {words}."
            )
        }
    }
}

fn step_in_words(step: &DebriefStep) -> Vec<String> {
    let mut lines = vec![format!("{} · {}", step.title, effort(step))];
    lines.extend(step.question.iter().flat_map(question_in_words));
    lines.extend(step.goals.iter().map(goal_in_words));
    lines
}

fn effort(step: &DebriefStep) -> String {
    let (used, all) = step.hints;
    let tries = if step.tries == 1 { "1 try".to_owned() } else { format!("{} tries", step.tries) };
    format!("{tries}, {used} of {}", count(all as u32, "hint"))
}

fn figures_in_text(own: &Debrief) -> String {
    let (from, to) = (MEASURED_SEEDS.start(), MEASURED_SEEDS.end());
    format!(
        "Amounts in this text are averages over seeds {from} to {to}; your company has seed {}.",
        own.seed
    )
}

fn paragraphs(text: &str) -> Vec<String> {
    let plain = |paragraph: &str| {
        let words: Vec<&str> = paragraph.split_whitespace().collect();
        words.join(" ").replace(['*', '`'], "")
    };
    text.split("\n\n").map(plain).filter(|paragraph| !paragraph.is_empty()).collect()
}

/// Returns the glossary terms that a Markdown text emphasizes, each once.
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

pub(super) fn page_of(own: &Debrief) -> Page {
    let mut blocks = vec![Block::Facts(facts(own))];
    if let Some(judged) = &own.judged_by {
        blocks.push(Block::Heading("Target"));
        blocks.push(Block::Chart(judged_chart(judged, &headline(own))));
    }
    blocks.push(Block::Heading("Cash"));
    blocks.push(Block::Chart(cash(own)));
    blocks.push(Block::Heading("Comparison with the reference play"));
    blocks.extend(comparison_in_words(own).into_iter().map(|line| Block::Text(line.trim().to_owned())));
    blocks.extend(guesses(own));
    blocks.extend(goals(own));
    if !own.pitfalls.is_empty() {
        blocks.push(Block::Heading("Pitfalls"));
        let row = |(day, say): &(u32, String)| vec![day.to_string(), say.clone()];
        blocks.push(Block::Table(Table {
            columns: vec![("day", true), ("explanation", false)],
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
            blocks.push(Block::Table(Table { columns: vec![("term", false), ("meaning", false)], rows }));
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
            "Recorded by NovaMind console {}. The reference play and the bad play were simulated with the seed of the run.",
            env!("CARGO_PKG_VERSION")
        ),
    }
}

fn facts(own: &Debrief) -> Vec<Fact> {
    let last = |cash: &[f64]| money(cash.last().copied().unwrap_or(0.0));
    let day = format!("day {}", own.own.len().saturating_sub(1));
    let mut facts = vec![Fact::new("You", last(&own.own), day)];
    for (name, curve) in [("Reference play", &own.good), ("Bad play", &own.bad)] {
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
    let references = [("reference play", &own.good), ("bad play", &own.bad)];
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

fn judged_chart(judged: &JudgedFigure, summary: &str) -> Chart {
    let curve = |name: &str, values: &[(u32, f64)]| Curve {
        name: name.to_owned(),
        points: values.iter().map(|(day, value)| (f64::from(*day), *value)).collect(),
    };
    let references = [("reference play", &judged.good), ("bad play", &judged.bad)];
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
    fn emphasised_words_are_looked_up_and_marks_do_not_stay() {
        let text = "People *churn* if `a < b`.\n\nGlossary: *churn*, *model\ntier*, *no such thing*.";
        let names: Vec<&str> = named_terms(text).iter().map(|term| term.id.as_str()).collect();
        assert_eq!(names, ["churn", "model-tier"]);
        assert_eq!(paragraphs(text)[0], "People churn if a < b.");
    }
}
