//! What is selected on the screen, and the rows behind it.

use super::super::Figure;
use super::model::level_of;
use super::{ATTEMPTS, ECONOMY, Market, NEWS, REPORT};
use crate::console::company::Company;

/// The figure that is selected.
pub(super) fn of(market: &Market, company: &Company) -> Option<Figure> {
    match market.focus {
        ATTEMPTS => Some(Figure {
            title: "attempts at market research".to_owned(),
            term: "market-research",
            sql: Some(
                "SELECT day, cost, success, discovered_group_id FROM segment_discovery ORDER BY id DESC"
                    .to_owned(),
            ),
        }),
        NEWS => {
            let item = market.headlines.selected().and_then(|row| market.news.get(row))?;
            let number = item.post.number;
            Some(Figure {
                title: format!("news #{number}"),
                term: if item.rival.is_some() { "competitor" } else { "press" },
                sql: Some(format!("SELECT * FROM social_media_posts WHERE post_id = {number}")),
            })
        }
        ECONOMY => {
            let point = market.published()?;
            Some(Figure {
                title: format!("PMI of day {}", point.day),
                term: "pmi",
                sql: Some(format!("SELECT * FROM macroeconomic_conditions WHERE day = {}", point.day)),
            })
        }
        REPORT => of_group(market, company, "get_group_insights", "estimates of"),
        _ => {
            let (term, what) = match market.table.selected_column() {
                2 | 3 => ("group_info_levels.info_level", "level of knowledge of"),
                4 => ("research_group.target_level", "the next study of"),
                5 => ("group_info_levels.discovered_day", "day of finding"),
                6 => ("group_info_levels.last_research_day", "last study of"),
                _ => ("group_info_levels.group_id", "knowledge of"),
            };
            of_group(market, company, term, what)
        }
    }
}

fn of_group(market: &Market, company: &Company, term: &'static str, what: &str) -> Option<Figure> {
    let group = market.group()?;
    let what = if level_of(company, group) == 0 { "what is known of" } else { what };
    Some(Figure {
        title: format!("{what} {group}"),
        term,
        sql: Some(format!("SELECT * FROM group_info_levels WHERE group_id = '{group}'")),
    })
}
