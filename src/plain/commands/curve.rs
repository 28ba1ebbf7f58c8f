//! `curve GROUP [PRICE QUALITY]`: the quality that a group requires at a price, and the expected result of a price and a quality.

use serde_json::{Value, json};

use super::super::grammar::{Argument, ParseError};
use super::super::response::CommandResponse;
use super::{Interpreter, argument_error};
use novamind_base::formatting::price_to_cents;
use novamind_base::similar_names;
use novamind_database::text::align_columns;
use novamind_insight::{CurveExplorer, CurveOutcome, CurvePoint, LEAD_SAMPLE_SIZE};
use novamind_report::curve::{
    column_names, describe_basis, describe_outcome, describe_plan, footnotes, format_quality, rows,
};
use novamind_report::measured_conversion::MeasuredConversion;
use novamind_session::identifiers::{Group, Plan};

const USAGE: &str = "give a group, and optionally a price and a quality: curve S1, curve S1 30 0.4";

/// Group, and optionally price and quality.
type CurveRequest = (Group, Option<(f64, f64)>);

impl Interpreter {
    pub(super) fn curve(&mut self, arguments: &[Argument]) -> Result<CommandResponse, ParseError> {
        let (group, product) = parse_request(arguments)?;
        Ok(match CurveExplorer::open(&mut self.session, group) {
            Ok(curve_explorer) => {
                let measured = MeasuredConversion::of_group(&self.session, group);
                curve_response(&curve_explorer, product, &measured)
            }
            Err(rejection) => CommandResponse::rejected("curve", rejection),
        })
    }
}

fn parse_request(arguments: &[Argument]) -> Result<CurveRequest, ParseError> {
    let usage = || argument_error(arguments, USAGE);
    let (first, rest) = arguments.split_first().ok_or_else(usage)?;
    let id = first.value.as_str().filter(|_| first.key.is_none()).ok_or_else(usage)?;
    let group = Group::all().find(|group| group.id().eq_ignore_ascii_case(id)).ok_or_else(|| {
        let text = match similar_names(id, Group::all().map(Group::id))[..] {
            [] => format!("there is no group {id}"),
            ref near => format!("there is no group {id}; did you mean {}?", near.join(" or ")),
        };
        ParseError { text, column: first.column }
    })?;
    let number = |argument: &Argument| {
        let value = argument.value.as_f64().filter(|value| argument.key.is_none() && *value >= 0.0);
        value.ok_or_else(|| ParseError {
            text: "price and quality must be numbers from 0: curve S1 30 0.4".to_owned(),
            column: argument.column,
        })
    };
    match rest {
        [] => Ok((group, None)),
        [price, quality] => Ok((group, Some((number(price)?, number(quality)?)))),
        _ => Err(usage()),
    }
}

fn curve_response(
    curve_explorer: &CurveExplorer,
    product: Option<(f64, f64)>,
    measured: &MeasuredConversion,
) -> CommandResponse {
    let basis = describe_basis(&curve_explorer.basis);
    let mut lines = Vec::new();
    let outcome = match product {
        Some((list, delivered)) => {
            lines.push(format!(
                "{}: one product at {} with quality {}, by {basis}",
                curve_explorer.group,
                price_to_cents(list),
                format_quality(delivered)
            ));
            curve_explorer.outcome_at(list, delivered)
        }
        None => {
            lines
                .push(format!("{}: quality that leads require at a price, by {basis}", curve_explorer.group));
            lines.extend(
                align_columns(&column_names(curve_explorer), &rows(curve_explorer))
                    .lines()
                    .map(str::to_owned),
            );
            curve_explorer.outcome_for_plans(&curve_explorer.plans)
        }
    };
    if product.is_none() {
        lines.extend(
            Plan::ALL
                .map(|plan| describe_plan(plan, &curve_explorer.plans[plan], outcome.plan_shares.as_ref())),
        );
    }
    lines.push(format!("{}; {LEAD_SAMPLE_SIZE} sampled leads", describe_outcome(&outcome)));
    let with_plans = if product.is_some() { "with your plans: " } else { "" };
    lines.push(format!("{with_plans}{}", measured.describe()));
    lines.extend(footnotes(curve_explorer));
    let mut data = curve_to_json(curve_explorer, product, &outcome);
    data["measured"] = measured_to_json(measured);
    CommandResponse::success("curve", lines.join("\n"), data)
}

pub(super) fn measured_to_json(measured: &MeasuredConversion) -> Value {
    json!({
        "conversion": measured.share(),
        "taken": measured.taken,
        "leads": measured.leads,
        "weeks": measured.weeks,
        "plans_changed_on": measured.changed_on.last(),
    })
}

fn curve_to_json(
    curve_explorer: &CurveExplorer,
    product: Option<(f64, f64)>,
    outcome: &CurveOutcome,
) -> Value {
    let point = |curve_point: &CurvePoint| {
        let (least, most) = curve_point.median_range;
        json!({
            "price": curve_point.price, "tenth": curve_point.p10, "half": curve_point.median, "nine_tenths": curve_point.p90,
            "half_at_least": least, "half_at_most": most,
        })
    };
    let plan = |plan: Plan| {
        let point = &curve_explorer.plans[plan];
        let taken = outcome.plan_shares.filter(|_| product.is_none()).map(|all| all[plan]);
        json!({ "plan": plan.id(), "list_price": point.list_price, "quality": point.quality, "quota": point.quota, "taken_by": taken })
    };
    json!({
        "group": curve_explorer.group,
        "basis": curve_explorer.basis,
        "asked": product.map(|(price, quality)| json!({ "price": price, "quality": quality })),
        "curve": curve_explorer.points.iter().map(point).collect::<Vec<_>>(),
        "plans": Plan::ALL.map(plan),
        "conversion": outcome.conversion,
        "revenue_per_lead": outcome.revenue_per_lead,
        "leads": LEAD_SAMPLE_SIZE,
    })
}
