//! Executes `fit [GROUP]`, which compares plans with the requirements of groups, and `leads [GROUP]`, which shows the
//! sources and costs of leads. Also formats the insights of a group as ranges.

use serde_json::{Value, json};

use super::super::grammar::{Argument, ParseError};
use super::super::response::CommandResponse;
use super::curve::measured_to_json;
use super::{Interpreter, argument_error};
use novamind_base::formatting::{dollars, dollars_and_cents, pluralize};
use novamind_base::similar_names;
use novamind_insight::CurveExplorer;
use novamind_report::curve::{describe_omissions, describe_outcome};
use novamind_report::fit::{Fit, FitCriterion, LeadFlow, PlanFit, fits};
use novamind_report::insights::{insights_as_ranges, overview_with_ages};
use novamind_report::lead_costs::{AdResults, LeadCost, lead_costs_by_pair};
use novamind_report::research::projects_with_means;
use novamind_session::identifiers::{Group, Plan};
use novamind_session::{GroupWeek, Session};

impl Interpreter {
    pub(super) fn fit(
        &self,
        name: Option<&str>,
        arguments: &[Argument],
    ) -> Result<CommandResponse, ParseError> {
        let all = fits(&self.session);
        let shown = select_groups(&all, name, arguments)?;
        let (mut lines, mut groups): (Vec<String>, Vec<Value>) = Default::default();
        for fit in shown {
            let explorer = CurveExplorer::from_estimates_without_points(&self.session, fit.group);
            let estimated = explorer.as_ref().map(|explorer| explorer.outcome_for_plans(&explorer.plans));
            lines.extend(fit.describe_lines());
            lines.push(match &estimated {
                Ok(outcome) => format!("  signups  {}", describe_outcome(outcome)),
                Err(refusal) => format!("  signups  {}", refusal.message),
            });
            lines.push(format!("           {}", fit.measured.describe()));
            lines.extend(
                explorer.iter().map(|explorer| format!("           {}", describe_omissions(explorer))),
            );
            let mut data = fit_to_json(fit);
            data["estimated_conversion"] = json!(estimated.ok().map(|outcome| outcome.conversion));
            data["measured"] = measured_to_json(&fit.measured);
            groups.push(data);
        }
        lines.push(
            "ranges are for group averages; a customer's required quality rises with the price".to_owned(),
        );
        let data = json!({ "groups": groups });
        Ok(CommandResponse::success("fit", lines.join("\n"), data))
    }

    pub(super) fn leads(
        &self,
        name: Option<&str>,
        arguments: &[Argument],
    ) -> Result<CommandResponse, ParseError> {
        let (all, weeks) = (fits(&self.session), self.session.company().group_weeks());
        let shown = select_groups(&all, name, arguments)?;
        let mut lines: Vec<String> = Vec::new();
        for fit in &shown {
            match fit.last_week {
                Some(week) => {
                    let (group, week, recent) = (fit.group, week.describe(), fit.recent.describe());
                    lines.push(format!("{group}: last week {week}; last 4 weeks {recent}"));
                }
                None => lines.push(format!("{}: no week has run", fit.group)),
            }
        }
        let mut costs = lead_costs_by_pair(weeks);
        costs.retain(|pair| shown.iter().any(|fit| fit.group == pair.group));
        lines.extend(costs.iter().map(cost_line));
        let week = |(at, group_week): (usize, &GroupWeek)| {
            json!({
                "week": at + 1,
                "leads": group_week.leads,
                "paid": group_week.paid_leads(),
                "word_of_mouth": group_week.word_of_mouth,
                "signed": group_week.signed,
            })
        };
        let by_week = |group: Group| -> Vec<Value> {
            weeks.iter().map(|week| &week[group]).enumerate().map(week).collect()
        };
        let groups: Vec<Value> =
            shown.iter().map(|fit| json!({ "group": fit.group.id(), "weeks": by_week(fit.group) })).collect();
        let costs: Vec<Value> = costs.iter().map(cost_to_json).collect();
        Ok(CommandResponse::success("leads", lines.join("\n"), json!({ "groups": groups, "costs": costs })))
    }
}

/// Returns the group with a name, or every known group if no name is given.
fn select_groups<'a>(
    all: &'a [Fit],
    name: Option<&str>,
    arguments: &[Argument],
) -> Result<Vec<&'a Fit>, ParseError> {
    let Some(id) = name else { return Ok(all.iter().collect()) };
    if let Some(fit) = all.iter().find(|fit| fit.group.id().eq_ignore_ascii_case(id)) {
        return Ok(vec![fit]);
    }
    let near = similar_names(id, all.iter().map(|fit| fit.group.id()));
    let known = match near.is_empty() {
        true => format!("known: {}", all.iter().map(|fit| fit.group.id()).collect::<Vec<_>>().join(", ")),
        false => format!("similar: {}", near.join(", ")),
    };
    Err(argument_error(arguments, &format!("{id} is not a known group; {known}")))
}

/// Returns the result of a tool with ranges and dates instead of point estimates, and with the true means of
/// R&D projects. Returns `None` if the result contains neither estimates nor R&D projects.
pub(super) fn answer_with_ranges(session: &Session, answer: &novamind_tools::Answer) -> Option<Value> {
    match answer {
        novamind_tools::Answer::GetGroupInsights(insights) => {
            let all = fits(session);
            let fit = all.iter().find(|fit| fit.group == insights.group_id)?;
            Some(insights_as_ranges(&answer.to_json(), fit))
        }
        novamind_tools::Answer::GetMarketOverview(_) => {
            Some(overview_with_ages(&answer.to_json(), &fits(session)))
        }
        novamind_tools::Answer::ListResearchProjects(_) => {
            Some(projects_with_means(&answer.to_json(), &session.company().research_means()))
        }
        _ => None,
    }
}

fn fit_to_json(fit: &Fit) -> Value {
    let plan = |plan_fit: &PlanFit| {
        let missing = |concern: &FitCriterion| {
            (concern.name().to_owned(), json!(fit.certain_gap(plan_fit.plan, *concern)))
        };
        let missing: serde_json::Map<String, Value> = FitCriterion::ALL.iter().map(missing).collect();
        json!({
            "plan": plan_fit.plan.id(),
            "list_price": plan_fit.list_price,
            "price_for_leads": plan_fit.lead_price,
            "billed": plan_fit.billed_price,
            "quality": plan_fit.quality,
            "quota": plan_fit.quota,
            "missing": missing,
        })
    };
    json!({
        "group": fit.group.id(),
        "level": fit.level,
        "noise": fit.max_relative_error,
        "as_of": fit.study_day,
        "age_days": fit.age_days,
        "floor": fit.floor,
        "budget": fit.budget,
        "usage": fit.usage,
        "plans": Plan::ALL.map(|id| plan(&fit.plans[id])),
        "last_week": fit.last_week.map(flow_to_json),
        "last_4_weeks": flow_to_json(fit.recent),
    })
}

fn flow_to_json(flow: LeadFlow) -> Value {
    json!({
        "leads": flow.leads,
        "paid": flow.channel_leads,
        "word_of_mouth": flow.word_of_mouth,
        "signed": flow.signups,
        "conversion": flow.conversion(),
    })
}

fn cost_to_json(pair: &LeadCost) -> Value {
    let spell = |spell: &AdResults| {
        json!({
            "weeks": [spell.weeks.0, spell.weeks.1],
            "leads": spell.leads,
            "spend": spell.spend,
            "per_lead": spell.cost_per_lead(),
            "first_bills": spell.first_bills,
            "per_first_bill": spell.cost_per_bill(),
        })
    };
    json!({
        "channel": pair.channel.id(),
        "group": pair.group.id(),
        "last_4_weeks": spell(&pair.recent),
        "cheapest_4_weeks_before": pair.cheapest.as_ref().map(spell),
    })
}

fn cost_line(pair: &LeadCost) -> String {
    let each = |value: Option<f64>| value.map_or("–".to_owned(), dollars_and_cents);
    let words = |spell: &AdResults| {
        format!("{} per lead, {} per first bill", each(spell.cost_per_lead()), each(spell.cost_per_bill()))
    };
    let before = pair.cheapest.map_or(String::new(), |spell| {
        format!("; cheapest in weeks {} to {}: {}", spell.weeks.0, spell.weeks.1, words(&spell))
    });
    format!(
        "{} × {}: {} for {} in 4 weeks, {}{before}",
        pair.channel.id(),
        pair.group,
        pluralize(pair.recent.leads, "lead"),
        dollars(pair.recent.spend),
        words(&pair.recent)
    )
}
