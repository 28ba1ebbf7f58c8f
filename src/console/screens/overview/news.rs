//! What has happened in the last week, as alerts: notices, posts and the news.

use super::alerts::{Alert, Kind};
use crate::console::company::Company;
use crate::console::posts::Kind as Author;
use crate::console::screens::product::model::Project;
use crate::session::Rows;
use crate::session::text_at;

/// What the notices of a week say, the newest first.
pub fn of_notices(rows: &Rows) -> Vec<Alert> {
    let mut alerts = Vec::new();
    for row in &rows.rows {
        let message = text_at(row, 2).trim_end_matches('.').to_owned();
        alerts.push(match text_at(row, 1) {
            "macro_economic_update" => Alert::note(Kind::Economy, message),
            "market_discovery" | "group_research_complete" => Alert::note(Kind::Study, message),
            "social_media" => Alert::note(Kind::Posts, message),
            _ => continue,
        });
    }
    alerts
}

/// R&D that has ended in the last week, with what it adds.
pub fn of_research(projects: &[Project], day: u32) -> Vec<Alert> {
    let ended = |project: &&Project| project.done && project.expected + 7 > day && project.expected <= day;
    let words = |project: &Project| {
        let text = format!("R&D {} is done: {:+.4} quality for everybody", project.id, project.boost);
        Alert::note(Kind::Research, text)
    };
    projects.iter().filter(ended).map(words).collect()
}

/// What people and the press wrote in the last week; many more posts than usual need the person.
pub fn of_posts(company: &Company) -> Vec<Alert> {
    let day = company.seen.day;
    // Number of posts of the last week, and of the four before it.
    let (mut own, mut before, mut press) = (0u32, 0u32, 0u32);
    // The newest stand first; what is older than five weeks does not count.
    for post in company.posts.iter().take_while(|post| post.day + 35 > day) {
        let weeks = day.saturating_sub(post.day) / 7;
        match (post.kind, weeks) {
            (Author::Customers | Author::Comments, 0) => own += 1,
            (Author::Customers | Author::Comments, 1..=4) => before += 1,
            (Author::Press, 0) => press += 1,
            _ => {}
        }
    }
    let usual = f64::from(before) / 4.0;
    let mut alerts = Vec::new();
    let noun = |count: u32| if count == 1 { "post" } else { "posts" };
    if own >= 8 && f64::from(own) > 2.0 * usual {
        let text = format!("{own} posts about us in a week, {usual:.0} is usual: read what it is about");
        alerts.push(Alert { kind: Kind::Stir, text, urgent: true });
    } else if own > 0 {
        alerts.push(Alert::note(Kind::Posts, format!("{own} new {} about us", noun(own))));
    }
    if press > 0 {
        let text = format!("{press} {} of the press on rivals and the economy", noun(press));
        alerts.push(Alert::note(Kind::Press, text));
    }
    alerts
}
