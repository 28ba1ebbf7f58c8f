//! `curve GROUP [PRICE QUALITY]`: the quality that a group requires at a price, and the expected result of a price and a quality.

use serde_json::{Value, json};

use super::super::answers::Answer;
use super::super::grammar::{Argument, Problem};
use super::{Interpreter, problem};
use novamind_base::nearest;
use novamind_base::notation::price_to_cents;
use novamind_database::text::aligned;
use novamind_insight::{CurveExplorer, CurveOutcome, CurvePoint, SAMPLED_LEADS};
use novamind_report::curve::{
    basis_in_words, columns, outcome_in_words, plan_in_words, quality, remarks, rows,
};
use novamind_session::identifiers::{Group, Plan};

const USAGE: &str = "give a group, and optionally a price and a quality: curve S1, curve S1 30 0.4";

/// A group, and optionally a price and a quality.
type Asked = (Group, Option<(f64, f64)>);

impl Interpreter {
    pub(super) fn curve(&mut self, arguments: &[Argument]) -> Result<Answer, Problem> {
        let (group, product) = asked(arguments)?;
        Ok(match CurveExplorer::of(&mut self.session, group) {
            Ok(own) => answer(&own, product),
            Err(refusal) => Answer::refused("curve", refusal),
        })
    }
}

fn asked(arguments: &[Argument]) -> Result<Asked, Problem> {
    let usage = || problem(arguments, USAGE);
    let (first, rest) = arguments.split_first().ok_or_else(usage)?;
    let id = first.value.as_str().filter(|_| first.key.is_none()).ok_or_else(usage)?;
    let group = Group::all().find(|group| group.id().eq_ignore_ascii_case(id)).ok_or_else(|| {
        let text = match nearest(id, Group::all().map(Group::id))[..] {
            [] => format!("there is no group {id}"),
            ref near => format!("there is no group {id}; did you mean {}?", near.join(" or ")),
        };
        Problem { text, column: first.column }
    })?;
    let number = |own: &Argument| {
        let value = own.value.as_f64().filter(|value| own.key.is_none() && *value >= 0.0);
        value.ok_or_else(|| Problem {
            text: "price and quality must be numbers from 0: curve S1 30 0.4".to_owned(),
            column: own.column,
        })
    };
    match rest {
        [] => Ok((group, None)),
        [price, quality] => Ok((group, Some((number(price)?, number(quality)?)))),
        _ => Err(usage()),
    }
}

fn answer(own: &CurveExplorer, product: Option<(f64, f64)>) -> Answer {
    let basis = basis_in_words(&own.basis);
    let mut lines = Vec::new();
    let outcome = match product {
        Some((list, delivered)) => {
            lines.push(format!(
                "{}: one product at {} with quality {}, by {basis}",
                own.group,
                price_to_cents(list),
                quality(delivered)
            ));
            own.outcome_of(list, delivered)
        }
        None => {
            lines.push(format!("{}: quality that leads require at a price, by {basis}", own.group));
            lines.extend(aligned(&columns(own), &rows(own)).lines().map(str::to_owned));
            own.outcome(&own.plans)
        }
    };
    if product.is_none() {
        lines.extend(Plan::ALL.map(|plan| plan_in_words(plan, &own.plans[plan], outcome.takers.as_ref())));
    }
    lines.push(format!("{}; {SAMPLED_LEADS} sampled leads", outcome_in_words(&outcome)));
    lines.extend(remarks(own));
    Answer::done("curve", lines.join("\n"), as_data(own, product, &outcome))
}

fn as_data(own: &CurveExplorer, product: Option<(f64, f64)>, outcome: &CurveOutcome) -> Value {
    let point = |own: &CurvePoint| {
        let (least, most) = own.median_between;
        json!({
            "price": own.price, "tenth": own.tenth, "half": own.median, "nine_tenths": own.ninetieth,
            "half_at_least": least, "half_at_most": most,
        })
    };
    let plan = |plan: Plan| {
        let point = &own.plans[plan];
        let taken = outcome.takers.filter(|_| product.is_none()).map(|all| all[plan]);
        json!({ "plan": plan.id(), "list_price": point.list, "quality": point.quality, "quota": point.quota, "taken_by": taken })
    };
    json!({
        "group": own.group,
        "basis": own.basis,
        "asked": product.map(|(price, quality)| json!({ "price": price, "quality": quality })),
        "curve": own.points.iter().map(point).collect::<Vec<_>>(),
        "plans": Plan::ALL.map(plan),
        "conversion": outcome.conversion,
        "revenue_per_lead": outcome.revenue_per_lead,
        "leads": SAMPLED_LEADS,
    })
}
