//! The text of the weekly dashboard that agents receive.

use std::fmt::Write;

use super::week::week_of_day;
use novamind_base::formatting::{dollars, grouped_number, percent, price, released_dollars, signed_dollars};
use novamind_record::figures::WeekFigures;
use novamind_record::trajectory::record::CalculationOutput;
use novamind_world::identifiers::{ByPlan, Group, Plan};
use novamind_world::market::social::own_posts::OwnPost;
use novamind_world::params::Params;
use novamind_world::state::World;

/// Delivered quality of each plan for a known group.
#[derive(Debug, Clone, PartialEq)]
pub struct DeliveredQuality {
    /// Group for which the quality is delivered.
    pub group: Group,
    /// Delivered quality by plan, with the plan's current model tier.
    pub by_plan: ByPlan<f64>,
    /// Quality bonus from development for the group.
    pub group_bonus: f64,
}

/// Returns the delivered quality for every known group, ordered by group identifier.
pub fn delivered_quality(world: &World, params: &Params) -> Vec<DeliveredQuality> {
    let mut known: Vec<Group> = Group::all().filter(|group| world.market.is_known(*group)).collect();
    known.sort_by_key(|group| group.id());
    known
        .into_iter()
        .map(|group| DeliveredQuality {
            group,
            by_plan: ByPlan::from_fn(|plan| {
                let multiplier = params.model_tier(world.settings.core.tiers[plan]).quality_multiplier;
                world.product.quality(group, params) * multiplier
            }),
            group_bonus: world.product.group_bonus[group],
        })
        .collect()
}

/// Summary of the threads that wait for a response of the player.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct WaitingLeads {
    /// Number of threads that wait for a response.
    pub threads: u32,
    /// Days until the first thread ends without a response.
    pub days_left: u32,
}

/// Builds the text of the dashboard. `week` contains the figures of the last week, or is `None` before the first week.
pub fn dashboard_text(
    world: &World,
    params: &Params,
    week: Option<&WeekFigures>,
    stocks: &WeekFigures,
    calculated: &[CalculationOutput],
    waiting: WaitingLeads,
) -> String {
    let mut text = format!("=== Week {} (day {}) ===\n", week_of_day(world.day), world.day);
    write_header_block(&mut text, stocks);
    if let Some(week) = week {
        write_week_block(&mut text, week);
    }
    write_settings_block(&mut text, world);
    write_quality_block(&mut text, world, params);
    write_calculations_block(&mut text, calculated);
    write_posts_block(&mut text, world, params);
    write_inbox_block(&mut text, week, waiting);
    text
}

fn write_header_block(text: &mut String, stocks: &WeekFigures) {
    let _ = writeln!(
        text,
        "Cash: {} | Individual Subscribers: {}",
        released_dollars(stocks.cash),
        stocks.individual_subscribers
    );
    let _ = writeln!(
        text,
        "Enterprise Subscribed Seats: {} | Open Issues: {}",
        stocks.enterprise_seats, stocks.open_issues
    );
}

fn write_week_block(text: &mut String, week: &WeekFigures) {
    let overload = if week.overload_peak > 0.0 { percent(week.overload_peak, 1) } else { "None".to_owned() };
    let outage =
        if week.outage { format!("yes ({} minutes)", week.downtime_minutes) } else { "no".to_owned() };
    let _ = writeln!(text, "\n--- This week ---");
    let _ = writeln!(
        text,
        "Cash Change: {} | Recurring Revenue: {}",
        signed_dollars(week.cash_change),
        released_dollars(week.recurring_revenue)
    );
    let _ = writeln!(
        text,
        "Payments: {} | Running Costs: {}",
        released_dollars(week.payments),
        released_dollars(week.costs)
    );
    let _ = writeln!(text, "Usage: {} units", grouped_number(week.usage as f64, 0));
    let _ = writeln!(
        text,
        "New Individual Leads: {} | New Enterprise Leads: {}",
        week.new_individual_leads, week.new_enterprise_leads
    );
    let _ = writeln!(
        text,
        "New Individual Subscribers: {} | New Enterprise Subscribed Seats: {}",
        week.new_individual_subscribers, week.new_enterprise_seats
    );
    let _ = writeln!(
        text,
        "Cancellations: {} | Enterprise Lost: {} companies, {} seats",
        week.cancellations, week.companies_lost, week.seats_lost
    );
    let _ = writeln!(text, "Upgrades: {} | Downgrades: {}", week.upgrades, week.downgrades);
    let _ = writeln!(text, "Overload (peak): {overload} | Outage: {outage}");
    let _ = writeln!(
        text,
        "P95 Latency (peak): {} ms | Error Rate (peak): {}",
        grouped_number(week.p95_ms_peak, 0),
        percent(week.error_rate_peak, 2)
    );
}

fn write_settings_block(text: &mut String, world: &World) {
    let core = &world.settings.core;
    let list =
        |value: &dyn Fn(Plan) -> String| Plan::ALL.map(|plan| format!("{plan} {}", value(plan))).join(" | ");
    let _ = writeln!(text, "\n--- Settings ---");
    let _ = writeln!(text, "Prices: {}", list(&|plan| price(core.prices[plan])));
    let _ = writeln!(text, "Model Tiers: {}", list(&|plan| core.tiers[plan].to_string()));
    let _ = writeln!(text, "Quotas: {}", list(&|plan| grouped_number(core.quotas[plan].units(), 0)));
    let _ = writeln!(text, "Capacity Tier: {}", core.capacity_tier);
    let _ = writeln!(text, "Ops: {}/day | Dev: {}/day", dollars(core.operations), dollars(core.development));
    let settings = &world.settings;
    let _ = writeln!(
        text,
        "Targeted spend: ops {}/day, dev {}/day, ads {}/day (see config_overrides)",
        dollars(settings.targeted_operations.total()),
        dollars(settings.targeted_development.total()),
        dollars(settings.targeted_ads.total())
    );
}

fn write_quality_block(text: &mut String, world: &World, params: &Params) {
    let core = &world.settings.core;
    let _ = writeln!(
        text,
        "\n--- Delivered quality (base {:.2}, global bonus {:.4}) ---",
        params.quality.base_product_quality, world.product.shared_bonus
    );
    let caption = |plan: Plan| format!("{plan} (T{})", core.tiers[plan]);
    let [a, b, c] = Plan::ALL.map(caption);
    let _ = writeln!(text, "{:<8}{a:<14}{b:<14}{c:<14}Group bonus", "Group");
    for row in delivered_quality(world, params) {
        let [a, b, c] = row.by_plan.0.map(|quality| format!("{quality:.4}"));
        let bonus = if row.group_bonus > 0.0 { format!("+{:.4}", row.group_bonus) } else { "0".to_owned() };
        let _ = writeln!(text, "{:<8}{a:<14}{b:<14}{c:<14}{bonus}", row.group.id());
    }
}

fn write_calculations_block(text: &mut String, calculated: &[CalculationOutput]) {
    if calculated.is_empty() {
        return;
    }
    let _ = writeln!(text, "\n--- Weekly Calculations ---");
    for CalculationOutput { name, output } in calculated {
        let _ = writeln!(text, "{name}:");
        output.lines().for_each(|line| {
            let _ = writeln!(text, "  {line}");
        });
    }
}

fn write_posts_block(text: &mut String, world: &World, params: &Params) {
    let week = params.run.days_per_week;
    let posts = world.market.social.own.iter();
    let recent: Vec<&OwnPost> =
        posts.filter(|post| post.day < world.day && post.day + week >= world.day).collect();
    if recent.is_empty() {
        return;
    }
    let _ = writeln!(text, "\n--- Your posts ---");
    for post in recent {
        let shown = params.limits.dashboard_post_preview_chars as usize;
        let preview: String = post.content.chars().take(shown).collect();
        let comments: Vec<String> = post.comments.iter().map(u32::to_string).collect();
        let numbers = if comments.is_empty() { String::new() } else { format!(" ({})", comments.join(", ")) };
        let views = grouped_number(post.views as f64, 0);
        let _ = writeln!(
            text,
            "Day {}: {views} views, {} comments{numbers} | {preview}",
            post.day,
            comments.len()
        );
    }
}

fn write_inbox_block(text: &mut String, week: Option<&WeekFigures>, waiting: WaitingLeads) {
    let _ = writeln!(text, "\n--- Inbox ---");
    let mut lines = 0;
    if let Some(week) = week.filter(|week| week.threads_opened > 0) {
        let _ =
            writeln!(text, "- {} new enterprise leads ({} seats)", week.threads_opened, week.thread_seats);
        lines += 1;
    }
    if let Some(week) = week.filter(|week| week.replies > 0) {
        let _ = writeln!(text, "- {} new replies", week.replies);
        lines += 1;
    }
    if waiting.threads > 0 {
        let _ = writeln!(
            text,
            "- {} awaiting your response; the first is lost in {} {} unless it is answered now",
            waiting.threads,
            waiting.days_left,
            if waiting.days_left == 1 { "day" } else { "days" }
        );
        lines += 1;
    }
    if lines == 0 {
        let _ = writeln!(text, "Nothing new");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_world::events::Facts;

    fn world() -> (World, Params) {
        let params = Params::bundled();
        (World::new(500, 1_000_000.0, &params, &mut Facts::default()), params)
    }

    #[test]
    fn dashboard_shows_stocks_settings_and_quality_on_day_0() {
        let (world, params) = world();
        let stocks = WeekFigures { cash: 1_000_000.0, ..WeekFigures::default() };
        let text = dashboard_text(&world, &params, None, &stocks, &[], WaitingLeads::default());
        let expected = "=== Week 0 (day 0) ===\n\
            Cash: $1,000,000 | Individual Subscribers: 0\n\
            Enterprise Subscribed Seats: 0 | Open Issues: 0\n\n\
            --- Settings ---\n\
            Prices: A $0 | B $0 | C $0\n\
            Model Tiers: A 1 | B 1 | C 1\n\
            Quotas: A 0 | B 0 | C 0\n\
            Capacity Tier: 0\n\
            Ops: $0/day | Dev: $0/day\n\
            Targeted spend: ops $0/day, dev $0/day, ads $0/day (see config_overrides)\n\n\
            --- Delivered quality (base 0.20, global bonus 0.0000) ---\n\
            Group   A (T1)        B (T1)        C (T1)        Group bonus\n\
            E1      0.1200        0.1200        0.1200        0\n\
            E2      0.1200        0.1200        0.1200        0\n\
            E3      0.1200        0.1200        0.1200        0\n\
            S1      0.1200        0.1200        0.1200        0\n\
            S2      0.1200        0.1200        0.1200        0\n\
            S3      0.1200        0.1200        0.1200        0\n\n\
            --- Inbox ---\n\
            Nothing new\n";
        assert_eq!(text, expected);
    }

    #[test]
    fn prices_keep_their_cents_and_targeted_spend_is_summed() {
        let (mut world, params) = world();
        let s1 = Group::at(0).expect("S1");
        world.settings.core.prices = ByPlan([22.5, 0.4, 55.0]);
        world.settings.targeted_development.targeted_spend.insert(s1, 4_500.0);
        let text =
            dashboard_text(&world, &params, None, &WeekFigures::default(), &[], WaitingLeads::default());
        assert!(text.contains("Prices: A $22.50 | B $0.40 | C $55\n"), "{text}");
        assert!(text.contains("Targeted spend: ops $0/day, dev $4,500/day, ads $0/day"), "{text}");
    }

    #[test]
    fn quality_is_shown_for_each_group_and_plan() {
        let (mut world, params) = world();
        world.settings.core.tiers = ByPlan([1, 2, 3]);
        world.product.shared_bonus = 0.02257;
        world.product.group_bonus[Group::at(0).expect("S1")] = 0.27773;
        let text =
            dashboard_text(&world, &params, None, &WeekFigures::default(), &[], WaitingLeads::default());
        assert!(text.contains("S1      0.3002        0.3752        0.4503        +0.2777"), "{text}");
        assert!(text.contains("S2      0.1335        0.1669        0.2003        0\n"), "{text}");
        assert!(text.contains("global bonus 0.0226"), "{text}");
    }

    #[test]
    fn posts_block_lists_posts_of_the_last_week() {
        let (mut world, params) = world();
        let own_posts = &mut world.market.social.own;
        own_posts.push(OwnPost::new(0, "An old one.", None));
        own_posts.push(OwnPost {
            views: 1840,
            comments: vec![91, 92],
            ..OwnPost::new(7, "y".repeat(90), None)
        });
        world.day = 14;
        let text =
            dashboard_text(&world, &params, None, &WeekFigures::default(), &[], WaitingLeads::default());
        let line = format!("Day 7: 1,840 views, 2 comments (91, 92) | {}\n", "y".repeat(80));
        assert!(text.contains(&line) && !text.contains("An old one"), "{text}");
        world.day = 7;
        let text =
            dashboard_text(&world, &params, None, &WeekFigures::default(), &[], WaitingLeads::default());
        assert!(text.contains("An old one.") && !text.contains("1,840"), "{text}");
    }

    #[test]
    fn dashboard_shows_peaks_and_losses() {
        let (world, params) = world();
        let week = WeekFigures {
            overload_peak: 0.12345,
            outage: true,
            downtime_minutes: 40,
            p95_ms_peak: 250.5,
            error_rate_peak: 0.012345,
            cash_change: -2095.4,
            companies_lost: 1,
            seats_lost: 120,
            threads_opened: 2,
            thread_seats: 512,
            replies: 3,
            ..WeekFigures::default()
        };
        let waiting = WaitingLeads { threads: 2, days_left: 4 };
        let text = dashboard_text(&world, &params, Some(&week), &week, &[], waiting);
        for part in [
            "Overload (peak): 12.3% | Outage: yes (40 minutes)",
            "P95 Latency (peak): 250 ms | Error Rate (peak): 1.23%",
            "Cash Change: -$2,095",
            "Enterprise Lost: 1 companies, 120 seats",
            "- 2 new enterprise leads (512 seats)",
            "- 3 new replies",
            "- 2 awaiting your response; the first is lost in 4 days",
        ] {
            assert!(text.contains(part), "{part} is missing in {text}");
        }
    }
}
