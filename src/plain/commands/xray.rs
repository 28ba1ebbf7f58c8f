//! `xray …`: hidden state of debug runs and of runs that are over, in words (docs/debugging.md).

use serde_json::{Value, json};

use super::super::answers::Answer;
use super::super::grammar::{Argument, Problem};
use super::{Interpreter, problem};
use crate::notation::nearest;
use crate::session::{LeadEquation, LeadFactor, Refusal};
use crate::world::identifiers::Group;

/// What can be shown.
const VIEWS: [&str; 1] = ["leads"];

impl Interpreter {
    pub(super) fn xray(&mut self, arguments: &[Argument]) -> Result<Answer, Problem> {
        // Nothing is read of what is asked for before it is clear that it may be shown.
        if let Err(refusal) = self.session.refuse_to_look_inside() {
            return Ok(Answer::refused("xray", refusal));
        }
        let (view, rest) = view_of(arguments)?;
        let shown = match view {
            "leads" => self.lead_equation(rest)?,
            _ => return Err(problem(arguments, &views())),
        };
        Ok(shown.unwrap_or_else(|refusal| Answer::refused("xray", refusal)))
    }

    fn lead_equation(&mut self, arguments: &[Argument]) -> Result<Result<Answer, Refusal>, Problem> {
        let held = arguments.iter().filter(|own| own.key.is_some()).map(held_factor);
        let held: Vec<(LeadFactor, f64)> = held.collect::<Result<_, _>>()?;
        let plain: Vec<&Argument> = arguments.iter().filter(|own| own.key.is_none()).collect();
        let (group, day) = group_and_day(&plain)?;
        Ok(self.session.lead_equations(group, day).map(|days| shown_leads(&days, &held)))
    }
}

fn views() -> String {
    format!("xray shows {}", VIEWS.join(", "))
}

/// What is to be shown, and of what.
fn view_of(arguments: &[Argument]) -> Result<(&str, &[Argument]), Problem> {
    match arguments.split_first() {
        Some((Argument { key: None, value: Value::String(view), .. }, rest)) => Ok((view, rest)),
        _ => Err(problem(arguments, &views())),
    }
}

/// A group, and a day or none.
fn group_and_day(arguments: &[&Argument]) -> Result<(Group, Option<u32>), Problem> {
    let at = |argument: &Argument, text: String| Problem { text, column: argument.column };
    let usage =
        || Problem { text: "name a group, and a day or none: xray leads S2 84".to_owned(), column: 1 };
    let (first, day) = match arguments {
        [first] => (first, None),
        [first, day] => (first, Some(day)),
        _ => return Err(usage()),
    };
    let id = first.value.as_str().ok_or_else(usage)?;
    let group = Group::all().find(|group| group.id().eq_ignore_ascii_case(id)).ok_or_else(|| {
        let near = nearest(id, Group::all().map(Group::id));
        let help =
            if near.is_empty() { String::new() } else { format!("; did you mean {}?", near.join(" or ")) };
        at(first, format!("there is no group {id}{help}"))
    })?;
    let day = day.map(|day| day_of(day)).transpose()?;
    Ok((group, day))
}

fn day_of(argument: &Argument) -> Result<u32, Problem> {
    let day = argument.value.as_u64().and_then(|day| u32::try_from(day).ok());
    day.ok_or_else(|| Problem { text: "a day is a whole number".to_owned(), column: argument.column })
}

/// `R=1`: a factor that is held.
fn held_factor(argument: &Argument) -> Result<(LeadFactor, f64), Problem> {
    let name = argument.key.as_deref().unwrap_or_default();
    let wrong = |text: String| Problem { text, column: argument.column };
    let factor = LeadFactor::parse(name).ok_or_else(|| {
        let letters = LeadFactor::ALL.map(|own| format!("{own} {}", own.in_words())).join(", ");
        wrong(format!("{name} is not a factor; the factors are {letters}"))
    })?;
    let value = argument.value.as_f64().filter(|value| *value >= 0.0);
    value
        .map(|value| (factor, value))
        .ok_or_else(|| wrong(format!("{factor} is held at a number of at least 0")))
}

/// The equation of the last of some days, with the range of each factor over all of them.
fn shown_leads(days: &[LeadEquation], held: &[(LeadFactor, f64)]) -> Answer {
    let Some(own) = days.last() else { return Answer::done("xray", String::new(), json!({})) };
    let mut lines = vec![format!("leads of {} on day {}", own.group, own.day)];
    if own.is_known {
        lines.push(equation(own));
        lines.extend(LeadFactor::ALL.map(|factor| over_days(days, factor)));
        let sources: Vec<String> =
            own.word_of_mouth.iter().map(|(group, leads)| format!("{group} {leads:.4}")).collect();
        lines.push(format!("  word of mouth from {}", or_nobody(&sources)));
    } else {
        lines.push("not discovered on that day: no leads".to_owned());
    }
    if !held.is_empty() && own.is_known {
        let held_at: Vec<String> = held.iter().map(|(factor, value)| format!("{factor} {value}")).collect();
        let with = own.holding(held);
        lines.push(format!("with {}: λ {with:.2} instead of {:.2}", held_at.join(", "), own.expected()));
    }
    Answer::done("xray", lines.join("\n"), leads_as_data(own, held))
}

/// `R 0.50 × … × (search_ads 5.0 + word of mouth 12.4) = λ 98.3, came 104 (p 0.56)`
fn equation(own: &LeadEquation) -> String {
    let factors = LeadFactor::ALL.map(|factor| format!("{factor} {:.4}", own.factor(factor)));
    let mut sources: Vec<String> =
        own.channels().map(|(channel, leads)| format!("{} {leads:.2}", channel.id())).collect();
    sources.push(format!("word of mouth {:.2}", own.by_word_of_mouth()));
    format!(
        "  {} × ({}) = λ {:.2}, came {} (p {:.2})",
        factors.join(" × "),
        sources.join(" + "),
        own.expected(),
        own.came,
        own.p_value()
    )
}

fn over_days(days: &[LeadEquation], factor: LeadFactor) -> String {
    let values = || days.iter().filter(|day| day.is_known).map(|day| day.factor(factor));
    let (least, most) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
    let now = days.last().map_or(0.0, |day| day.factor(factor));
    format!(
        "  {factor} {:<18} {now:>8.4}   last {} days {least:.4} to {most:.4}",
        factor.in_words(),
        values().count()
    )
}

fn or_nobody(sources: &[String]) -> String {
    if sources.is_empty() { "nobody: there are no subscribers".to_owned() } else { sources.join(" + ") }
}

fn leads_as_data(own: &LeadEquation, held: &[(LeadFactor, f64)]) -> Value {
    let factors = LeadFactor::ALL.map(|factor| (factor.letter().to_owned(), json!(own.factor(factor))));
    let channels = own.channels().map(|(channel, leads)| (channel.id().to_owned(), json!(leads)));
    let word_of_mouth = own.word_of_mouth.iter().map(|(group, leads)| (group.id().to_owned(), json!(leads)));
    json!({
        "group": own.group.id(),
        "day": own.day,
        "known": own.is_known,
        "factors": Value::Object(factors.into_iter().collect()),
        "channels": Value::Object(channels.collect()),
        "word_of_mouth": Value::Object(word_of_mouth.collect()),
        "expected": own.expected(),
        "came": own.came,
        "p": own.p_value(),
        "held": (!held.is_empty()).then(|| own.holding(held)),
    })
}
