//! Why a figure may have moved: rules over what a player can see of the same week. At most one cause each, and never
//! more than a "may": two things that happen in one week need not hang together.

use super::words::{number, whole};
use crate::notation::percent;
use crate::session::{Change, Decisions, WeekFigures};

/// A figure of a week.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Figure {
    /// Recurring revenue a month.
    Revenue,
    /// Payments of subscribers.
    Payments,
    /// Running costs.
    Costs,
    /// Individual subscribers.
    Subscribers,
    /// Enterprise seats.
    Seats,
    /// New individual leads.
    Leads,
    /// New companies that ask.
    CompanyLeads,
    /// People who signed up.
    Signups,
    /// Of the leads, those who signed up.
    Conversion,
    /// Cancellations of individuals.
    Cancellations,
    /// Units used.
    Usage,
    /// Largest overload.
    Overload,
    /// Minutes of outages.
    Outage,
    /// Subscribers with an open issue.
    Issues,
}

/// What could be seen of a week.
pub struct Seen<'a> {
    /// The week.
    pub now: &'a WeekFigures,
    /// The week before.
    pub before: &'a WeekFigures,
    /// What was decided before it.
    pub decided: Option<&'a Decisions>,
    /// Posts of the press in it: rivals and the economy.
    pub press: u32,
    /// Our own posts in the week before, which are read in this one.
    pub own_posts: u32,
}

/// A sum of settings of one kind before and after.
struct Moved {
    old: f64,
    new: f64,
    text: String,
}

impl Seen<'_> {
    fn changes(&self) -> impl Iterator<Item = &Change> {
        self.decided.into_iter().flat_map(|decided| &decided.changes)
    }

    /// What settings that begin like this did in sum; one change is named, several are counted.
    fn moved(&self, tool: &str, beginning: &str) -> Option<Moved> {
        let fitting: Vec<&Change> = self
            .changes()
            .filter(|change| change.tool == tool && change.setting.starts_with(beginning))
            .collect();
        let first = fitting.first()?;
        let text = match fitting.len() {
            1 => format!("{} {} → {} {}", first.setting, number(first.old), number(first.new), first.unit),
            more => format!("{more} changes by {tool}"),
        };
        let sum = |side: fn(&Change) -> f64| fitting.iter().map(|change| side(change)).sum();
        Some(Moved { old: sum(|change| change.old), new: sum(|change| change.new), text })
    }

    fn raised(&self, tool: &str, beginning: &str) -> Option<String> {
        self.moved(tool, beginning).filter(|moved| moved.new > moved.old).map(|moved| moved.text)
    }

    fn lowered(&self, tool: &str, beginning: &str) -> Option<String> {
        self.moved(tool, beginning).filter(|moved| moved.new < moved.old).map(|moved| moved.text)
    }

    fn outage(&self) -> Option<String> {
        self.now.outage.then(|| format!("an outage of {} minutes", self.now.downtime_minutes))
    }

    fn overload(&self) -> Option<String> {
        (self.now.overload_peak > 0.0)
            .then(|| format!("usage was up to {} above capacity", percent(self.now.overload_peak, 1)))
    }

    fn issues(&self) -> Option<String> {
        let (new, old) = (f64::from(self.now.open_issues), f64::from(self.before.open_issues));
        let many = new > 0.01 * f64::from(self.now.individual_subscribers) && new > 20.0;
        (many && new > 1.25 * old).then(|| format!("open issues rose to {}", whole(new)))
    }

    fn press(&self) -> Option<String> {
        (self.press > 0).then(|| match self.press {
            1 => "a post of the press: rivals or the economy".to_owned(),
            more => format!("{more} posts of the press: rivals or the economy"),
        })
    }

    fn own_posts(&self) -> Option<String> {
        (self.own_posts > 0).then(|| match self.own_posts {
            1 => "our post was read".to_owned(),
            more => format!("our {more} posts were read"),
        })
    }

    /// A stock that moved the same way by at least a fiftieth.
    fn follows(&self, up: bool, figure: fn(&WeekFigures) -> f64, name: &str) -> Option<String> {
        let (new, old) = (figure(self.now), figure(self.before));
        let moved = if up { new > 1.02 * old } else { new < 0.98 * old };
        (moved && old + new > 0.0).then(|| format!("{name} {} → {}", whole(old), whole(new)))
    }
}

/// The likeliest cause of a move that can be seen, if any.
pub fn cause(figure: Figure, up: bool, seen: &Seen<'_>) -> Option<String> {
    let people = |week: &WeekFigures| f64::from(week.individual_subscribers);
    let seats = |week: &WeekFigures| f64::from(week.enterprise_seats);
    let leads = |week: &WeekFigures| f64::from(week.new_individual_leads);
    let usage = |week: &WeekFigures| week.usage as f64;
    match figure {
        Figure::Cancellations if up => {
            leaving(seen).or_else(|| seen.follows(true, people, "more subscribers can leave:"))
        }
        Figure::Cancellations => seen
            .lowered("set_prices", "price")
            .or_else(|| better_product(seen))
            .or_else(|| seen.follows(false, people, "fewer subscribers are left:")),
        Figure::Subscribers if up => seen.follows(true, leads, "more leads:"),
        Figure::Subscribers => leaving(seen),
        Figure::Leads => lead_cause(up, seen, people),
        Figure::CompanyLeads => ads(up, seen).or_else(|| seen.press()),
        Figure::Signups => seen
            .follows(up, leads, if up { "more leads:" } else { "fewer leads:" })
            .or_else(|| conversion(up, seen)),
        Figure::Conversion => conversion(up, seen),
        Figure::Revenue | Figure::Payments => {
            let (more, fewer) = (seen.follows(up, people, "subscribers"), seen.follows(up, seats, "seats"));
            more.or(fewer)
        }
        Figure::Costs => costs(up, seen).or_else(|| seen.follows(up, usage, "usage")),
        Figure::Seats if up => (seen.now.new_enterprise_seats > 0).then(|| {
            format!("deals for {} seats were signed", whole(f64::from(seen.now.new_enterprise_seats)))
        }),
        Figure::Seats => {
            (seen.now.companies_lost > 0).then(|| format!("{} companies left", seen.now.companies_lost))
        }
        Figure::Usage => quota(up, seen)
            .or_else(|| seen.follows(up, people, "subscribers"))
            .or_else(|| seen.follows(up, seats, "seats")),
        Figure::Overload if up => {
            seen.lowered("set_capacity_tier", "").or_else(|| seen.follows(true, usage, "usage"))
        }
        Figure::Overload => {
            seen.raised("set_capacity_tier", "").or_else(|| seen.follows(false, usage, "usage"))
        }
        Figure::Outage if up => seen.overload(),
        Figure::Outage => seen.raised("set_capacity_tier", ""),
        Figure::Issues if up => seen
            .outage()
            .or_else(|| seen.overload())
            .or_else(|| seen.lowered("set_daily_spend", "operations"))
            .or_else(|| seen.follows(true, people, "subscribers")),
        Figure::Issues => seen
            .raised("set_daily_spend", "operations")
            .or_else(|| seen.raised("set_targeted_ops_spend", ""))
            .or_else(|| seen.follows(false, people, "subscribers")),
    }
}

/// What makes people leave. A dearer list price does not: those who are there keep theirs.
fn leaving(seen: &Seen<'_>) -> Option<String> {
    seen.outage()
        .or_else(|| seen.overload())
        .or_else(|| seen.lowered("set_model_tiers", "model tier"))
        .or_else(|| seen.lowered("set_usage_quotas", "quota"))
        .or_else(|| seen.raised("set_ads_strength", "in-app ads"))
        .or_else(|| seen.lowered("set_promotion", "discount"))
        .or_else(|| seen.issues())
        .or_else(|| seen.press())
}

fn better_product(seen: &Seen<'_>) -> Option<String> {
    seen.raised("set_model_tiers", "model tier")
        .or_else(|| seen.raised("set_usage_quotas", "quota"))
        .or_else(|| seen.raised("set_promotion", "discount"))
        .or_else(|| seen.lowered("set_ads_strength", "in-app ads"))
}

fn ads(up: bool, seen: &Seen<'_>) -> Option<String> {
    if up {
        seen.raised("set_targeted_ad_spend", "ads")
    } else {
        seen.lowered("set_targeted_ad_spend", "ads")
    }
}

fn lead_cause(up: bool, seen: &Seen<'_>, people: fn(&WeekFigures) -> f64) -> Option<String> {
    let words = if up { "word of mouth of more subscribers:" } else { "word of mouth of fewer subscribers:" };
    ads(up, seen)
        .or_else(|| seen.own_posts())
        .or_else(|| seen.follows(up, people, words))
        .or_else(|| seen.press())
}

fn conversion(up: bool, seen: &Seen<'_>) -> Option<String> {
    if up {
        seen.lowered("set_prices", "price")
            .or_else(|| seen.raised("set_lead_promotion", "lead discount"))
            .or_else(|| better_product(seen))
    } else {
        seen.outage()
            .or_else(|| seen.overload())
            .or_else(|| seen.raised("set_prices", "price"))
            .or_else(|| seen.lowered("set_lead_promotion", "lead discount"))
            .or_else(|| seen.lowered("set_model_tiers", "model tier"))
            .or_else(|| seen.press())
    }
}

fn costs(up: bool, seen: &Seen<'_>) -> Option<String> {
    let spent = [
        ("set_capacity_tier", ""),
        ("set_targeted_dev_spend", ""),
        ("set_targeted_ad_spend", ""),
        ("set_daily_spend", ""),
        ("set_targeted_ops_spend", ""),
        ("set_model_tiers", ""),
    ];
    spent.iter().find_map(
        |(tool, beginning)| {
            if up { seen.raised(tool, beginning) } else { seen.lowered(tool, beginning) }
        },
    )
}

fn quota(up: bool, seen: &Seen<'_>) -> Option<String> {
    if up { seen.raised("set_usage_quotas", "") } else { seen.lowered("set_usage_quotas", "") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn change(tool: &'static str, setting: &str, old: f64, new: f64) -> Change {
        Change { tool, setting: setting.to_owned(), old, new, unit: "$/day" }
    }

    fn because(
        figure: Figure,
        up: bool,
        now: &WeekFigures,
        changes: Vec<Change>,
        press: u32,
    ) -> Option<String> {
        let before = WeekFigures { individual_subscribers: 1000, ..WeekFigures::default() };
        let decided = Decisions { day: 7, until: 14, changes, purchases: Vec::new() };
        let seen = Seen { now, before: &before, decided: Some(&decided), press, own_posts: 0 };
        cause(figure, up, &seen)
    }

    #[test]
    fn people_leave_for_what_was_worst_that_week() {
        let calm = WeekFigures { individual_subscribers: 1000, ..WeekFigures::default() };
        let dark = WeekFigures { outage: true, downtime_minutes: 40, ..calm };
        let tier = || vec![change("set_model_tiers", "model tier A", 3.0, 2.0)];
        let up =
            |now: &WeekFigures, changes, press| because(Figure::Cancellations, true, now, changes, press);
        assert_eq!(up(&dark, tier(), 1).as_deref(), Some("an outage of 40 minutes"));
        assert_eq!(up(&calm, tier(), 1).as_deref(), Some("model tier A 3 → 2 $/day"));
        assert_eq!(up(&calm, vec![], 1).as_deref(), Some("a post of the press: rivals or the economy"));
        let busy = WeekFigures { open_issues: 90, ..calm };
        assert_eq!(up(&busy, vec![], 0).as_deref(), Some("open issues rose to 90"));
        let dearer = vec![change("set_prices", "price A", 12.0, 20.0)];
        assert_eq!(up(&calm, dearer, 0), None, "those who are there keep their price");
        let grown = WeekFigures { individual_subscribers: 1500, ..calm };
        assert_eq!(up(&grown, vec![], 0).as_deref(), Some("more subscribers can leave: 1,000 → 1,500"));
    }

    #[test]
    fn a_cause_points_the_same_way_as_the_move() {
        let calm = WeekFigures { individual_subscribers: 1000, ..WeekFigures::default() };
        let more = || vec![change("set_targeted_ad_spend", "ads linkedin S1", 0.0, 300.0)];
        let told = because(Figure::Leads, true, &calm, more(), 0);
        assert_eq!(told.as_deref(), Some("ads linkedin S1 0 → 300 $/day"));
        assert_eq!(because(Figure::Leads, false, &calm, more(), 0), None);
        let cheaper =
            || vec![change("set_prices", "price A", 20.0, 12.0), change("set_prices", "price B", 30.0, 25.0)];
        let told = because(Figure::Conversion, true, &calm, cheaper(), 0);
        assert_eq!(told.as_deref(), Some("2 changes by set_prices"));
        assert_eq!(because(Figure::Conversion, false, &calm, cheaper(), 0), None);
        let larger = vec![change("set_capacity_tier", "capacity tier", 2.0, 3.0)];
        assert!(because(Figure::Costs, true, &calm, larger.clone(), 0).is_some());
        assert!(because(Figure::Overload, false, &calm, larger, 0).is_some());
    }
}
