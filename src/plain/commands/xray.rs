//! `xray …`: hidden state of debug runs and of runs that are over, in words (docs/debugging.md).

use serde_json::{Value, json};

use super::super::answers::Answer;
use super::super::grammar::{Argument, Problem};
use super::{Interpreter, problem};
use crate::notation::nearest;
use crate::report::xray::{company_in_words, customer_in_words, leads_in_words};
use crate::session::{
    CompanyDay, CompanyLens, CustomerDay, CustomerLens, LeadEquation, LeadFactor, Lens, PlanTerms, Refusal,
    Weighed,
};
use crate::world::identifiers::{Group, Plan};

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
        Ok(self.session.lead_equations(group, day).map(|days| {
            let data = days.last().map_or(Value::Null, |own| leads_as_data(own, &held));
            Answer::done("xray", leads_in_words(&days, &held).join("\n"), data)
        }))
    }

    /// `lens CUSTOMER [DAY]`
    pub(super) fn lens(&mut self, arguments: &[Argument]) -> Result<Answer, Problem> {
        if let Err(refusal) = self.session.refuse_to_look_inside() {
            return Ok(Answer::refused("lens", refusal));
        }
        let numbers: Vec<u32> = arguments.iter().map(whole_number).collect::<Result<_, _>>()?;
        let shown = match numbers[..] {
            [customer] => self.session.lens(customer, None),
            [customer, day] => self.session.lens(customer, Some(day)),
            _ => return Err(problem(arguments, "name a customer, and a day or none: lens 4711 151")),
        };
        Ok(match shown {
            Ok(Lens::Individual(lens)) => {
                let lines = customer_in_words(&lens);
                let data = customer_as_data(&lens, &lines[1]);
                Answer::done("lens", lines.join("\n"), data)
            }
            Ok(Lens::Company(lens)) => {
                Answer::done("lens", company_in_words(&lens).join("\n"), company_as_data(&lens))
            }
            Err(refusal) => Answer::refused("lens", refusal),
        })
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
    let day = day.map(|day| whole_number(day)).transpose()?;
    Ok((group, day))
}

pub(super) fn whole_number(argument: &Argument) -> Result<u32, Problem> {
    let number = argument.value.as_u64().filter(|_| argument.key.is_none());
    let number = number.and_then(|number| u32::try_from(number).ok());
    number.ok_or_else(|| Problem { text: "a whole number is expected".to_owned(), column: argument.column })
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

fn customer_as_data(lens: &CustomerLens, headline: &str) -> Value {
    let plan = |weighed: &Weighed, plan: Plan| {
        let PlanTerms { price, experience, quality, required, surplus, within_budget } = weighed.plans[plan];
        json!({
            "plan": plan.id(), "price": price, "delivered": experience.delivered,
            "relationship": experience.relationship, "tenure": experience.tenure, "quota": experience.quota,
            "issues": experience.issues, "ads": experience.ads, "quality": quality, "required": required,
            "surplus": surplus, "within_budget": within_budget,
        })
    };
    let day = |own: &CustomerDay| {
        json!({
            "day": own.day,
            "plan": own.plan.id(),
            "price": own.price,
            "billing_day": own.is_due,
            "satisfaction": own.satisfaction,
            "relationship": own.relationship,
            "open_issue_days": own.open_issue_days,
            "choice": own.weighed.choice.map(Plan::id),
            "plans": Plan::ALL.map(|own_plan| plan(&own.weighed, own_plan)),
        })
    };
    json!({
        "customer_id": lens.customer,
        "group": lens.group.id(),
        "headline": headline,
        "came": lens.first.day,
        "signed_up": lens.first.signed_up,
        "shown": lens.shown().map(day),
        "last_bill": lens.last_bill().map(day),
    })
}

fn company_as_data(lens: &CompanyLens) -> Value {
    let thread = |own: &CompanyDay| {
        let plan = |plan: Plan| {
            let judged = own.plans[plan];
            json!({
                "plan": plan.id(), "quality": judged.quality, "quality_if_answered": judged.quality_if_answered,
                "accepts_below": judged.accepts_below, "accepts_any_price": judged.accepts_any_price,
                "would_name": judged.counter,
            })
        };
        json!({
            "thread": own.thread,
            "kind": own.kind.id(),
            "budget": own.budget,
            "turns_left": own.turns_left,
            "relationship": own.relationship,
            "late_penalty": own.late_penalty,
            "reply_day": own.reply_day,
            "plans": Plan::ALL.map(plan),
        })
    };
    json!({
        "customer_id": lens.customer,
        "group": lens.group.id(),
        "day": lens.day,
        "threads": lens.shown().map(thread).collect::<Vec<Value>>(),
    })
}
