//! What is selected on the screen, and the rows behind it.

use super::super::Figure;
use super::{CAPACITY, ISSUES, PLANS, Product, QUALITY, RESEARCH, SERVICE};
use crate::console::company::Company;
use crate::world::identifiers::Plan;

/// The figure that is selected.
pub(super) fn of(product: &Product, company: &Company) -> Option<Figure> {
    let place = product.places[product.focus.0];
    match product.focus.0 {
        QUALITY => {
            let group = company.quality.get(place)?.group;
            let sql = "SELECT day, amount, note FROM ledger WHERE category = 'development' ORDER BY day DESC";
            Some(figure(format!("delivered quality in {group}"), "delivered-quality", Some(sql.to_owned())))
        }
        PLANS => Some(of_plan(place, Plan::ALL[product.column.min(2)])),
        CAPACITY => {
            let tier = product.rungs.get(place)?.tier;
            let sql = "SELECT day, total_usage_units, capacity_units, capacity_tier FROM service_day\n\
                       WHERE day > (SELECT max(day) FROM service_day) - 7 ORDER BY day DESC";
            Some(figure(
                format!("use of tier {tier} in the last week"),
                "capacity-tier",
                Some(sql.to_owned()),
            ))
        }
        SERVICE => {
            let sql = "SELECT day, p95_ms, error_rate, downtime_minutes, total_usage_units, capacity_units\n\
                       FROM service_day ORDER BY day DESC LIMIT 28";
            Some(figure("the service in 28 days".to_owned(), "outage", Some(sql.to_owned())))
        }
        ISSUES => {
            let group = product.issues.as_ref()?.keys().nth(place)?;
            let sql = format!(
                "SELECT i.issue_id, i.customer_id, i.open_day, i.days_open\n\
                 FROM issues i JOIN subscriptions s ON s.customer_id = i.customer_id\n\
                 WHERE i.group_id = '{group}' AND i.status = 'open' AND s.status = 'subscribed'\n    \
                 AND i.open_day > (SELECT max(day) FROM service_day) - 112 ORDER BY i.days_open DESC"
            );
            Some(figure(format!("open issues of {group}"), "issue", Some(sql)))
        }
        RESEARCH => of_research(product, place),
        _ => None,
    }
}

fn figure(title: String, term: &'static str, sql: Option<String>) -> Figure {
    Figure { title, term, sql }
}

/// A figure of a plan, by the rows of the table of plans.
fn of_plan(row: usize, plan: Plan) -> Figure {
    let subscribers = || {
        Some(format!(
            "SELECT s.customer_id, c.group_id, s.effective_price, s.seat_count, s.start_day\n\
             FROM subscriptions s JOIN customers c USING (customer_id)\n\
             WHERE s.plan = '{plan}' AND s.status = 'subscribed' ORDER BY s.customer_id"
        ))
    };
    let usage = || {
        Some(format!(
            "SELECT u.customer_id, s.seat_count, u.usage_units\n\
             FROM daily_usage u JOIN subscriptions s USING (customer_id)\n\
             WHERE u.day = (SELECT max(day) FROM service_day) AND s.plan = '{plan}' AND s.status = 'subscribed'"
        ))
    };
    let setting =
        |column: &str| Some(format!("SELECT day, \"{column}_{plan}\" FROM config_history ORDER BY day"));
    let (name, term, sql) = match row {
        0 => ("model tier", "model-tier", setting("tier")),
        1 => ("price", "list-price", setting("price")),
        2 => ("quota", "quota", setting("quota")),
        3 => ("unit cost", "compute", setting("tier")),
        4 => ("customers", "subscriber", subscribers()),
        5 => ("billed seats", "billed-seats", subscribers()),
        6 => ("usage a seat", "usage", usage()),
        7 => ("paid a seat", "effective-price", subscribers()),
        8 => ("compute a seat", "compute", usage()),
        9 => ("gross margin", "gross-margin", subscribers()),
        _ => ("billed a month", "billed-seats", subscribers()),
    };
    figure(format!("{name} of plan {plan}"), term, sql)
}

fn of_research(product: &Product, place: usize) -> Option<Figure> {
    let title = match (product.projects.get(place), place.checked_sub(product.projects.len())) {
        (Some(project), _) => {
            let sql = format!("SELECT * FROM research_projects WHERE project_id = '{}'", project.id);
            return Some(figure(format!("project {}", project.id), "research-project", Some(sql)));
        }
        (None, offer) => product.offers.get(offer?).map(|offer| format!("project of tier {}", offer.tier))?,
    };
    let sql = "SELECT * FROM research_projects ORDER BY started_day DESC";
    Some(figure(title, "research-project", Some(sql.to_owned())))
}
