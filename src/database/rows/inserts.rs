//! Writes rows immediately, because these rows do not change again before the commit.

use rusqlite::{Transaction, params};

use super::{ForecastRow, ProjectionEntry};
use novamind_base::formatting::spaced_json;
use novamind_world::events::{Facts, ResearchChange};
use novamind_world::identifiers::{Group, Plan};
use novamind_world::settings::SettingsChange;

pub(super) fn insert_service(transaction: &Transaction<'_>, facts: &Facts) -> rusqlite::Result<()> {
    let Some(service) = facts.service else { return Ok(()) };
    transaction
        .prepare_cached("INSERT OR REPLACE INTO service_day VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)")?
        .execute(params![
            facts.day,
            service.total_usage as i64,
            service.p95_ms,
            service.error_rate,
            service.downtime_minutes,
            service.capacity_tier,
            service.capacity_units,
        ])?;
    Ok(())
}

pub(super) fn insert_research(transaction: &Transaction<'_>, facts: &Facts) -> rusqlite::Result<()> {
    // Update the row of a completed project, because a replaced row would move to the end of the table.
    let mut write = transaction.prepare_cached(
        "INSERT INTO research_projects VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7) \
         ON CONFLICT (project_id) DO UPDATE SET status = excluded.status, \
         quality_boost_applied = excluded.quality_boost_applied",
    )?;
    for change in &facts.research {
        let (project, status, applied) = match change {
            ResearchChange::Started(project) => (project, "in_progress", 0.0),
            ResearchChange::Completed(project) => (project, "completed", project.boost),
        };
        write.execute(params![
            project.id(),
            project.tier,
            status,
            project.started_day,
            project.due_day,
            project.boost,
            applied,
        ])?;
    }
    Ok(())
}

pub(super) fn insert_channel_leads(transaction: &Transaction<'_>, facts: &Facts) -> rusqlite::Result<()> {
    let mut insert = transaction.prepare_cached(
        "INSERT INTO ad_channel_leads (day, channel_id, group_id, leads_generated, spend) VALUES (?1, ?2, ?3, ?4, ?5)",
    )?;
    for pair in &facts.channel_leads {
        insert.execute(params![facts.day, pair.channel.id(), pair.group.id(), pair.leads, pair.spend])?;
    }
    Ok(())
}

pub(super) fn insert_settings(
    transaction: &Transaction<'_>,
    entry: &ProjectionEntry,
) -> rusqlite::Result<()> {
    let facts = &entry.facts;
    for change in &facts.settings {
        let (tool, kind) = match change {
            SettingsChange::Core(core) => {
                let quota = |plan: Plan| core.quotas[plan].units();
                transaction
                    .prepare_cached(
                        "INSERT OR REPLACE INTO config_history (day, price_A, price_B, price_C, tier_A, tier_B, tier_C, \
                         spend_operations, spend_development, capacity_tier, quota_A, quota_B, quota_C) \
                         VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13)",
                    )?
                    .execute(params![
                        facts.day,
                        core.prices[Plan::A],
                        core.prices[Plan::B],
                        core.prices[Plan::C],
                        core.tiers[Plan::A],
                        core.tiers[Plan::B],
                        core.tiers[Plan::C],
                        core.operations,
                        core.development,
                        core.capacity_tier,
                        quota(Plan::A),
                        quota(Plan::B),
                        quota(Plan::C),
                    ])?;
                continue;
            }
            SettingsChange::Promotion(_) => ("set_promotion", "promotion"),
            SettingsChange::LeadPromotion(_) => ("set_lead_promotion", "lead_promotion"),
            SettingsChange::AdsStrength(_) => ("set_ads_strength", "ads_strength"),
            SettingsChange::TargetedAds(_) => ("set_targeted_ad_spend", "targeted_ad_spend"),
            SettingsChange::TargetedOperations(_) => ("set_targeted_ops_spend", "targeted_ops_spend"),
            SettingsChange::TargetedDevelopment(_) => ("set_targeted_dev_spend", "targeted_dev_spend"),
        };
        let family = entry.settings.clone().or_else(|| change.family_json()).unwrap_or_default();
        transaction
            .prepare_cached(
                "INSERT INTO config_overrides (day, tool_name, setting_type, settings_json) VALUES (?1, ?2, ?3, ?4)",
            )?
            .execute(params![facts.day, tool, kind, spaced_json(&family)])?;
    }
    Ok(())
}

pub(super) fn insert_forecasts(transaction: &Transaction<'_>, rows: &[ForecastRow]) -> rusqlite::Result<()> {
    let mut insert = transaction
        .prepare_cached("INSERT OR REPLACE INTO predictions VALUES (?1, ?2, 'cash', ?3, ?4, ?5, ?6)")?;
    for row in rows {
        insert.execute(params![
            row.submit_day,
            row.horizon_days,
            row.point,
            row.lower,
            row.upper,
            row.submitted_at
        ])?;
    }
    Ok(())
}

pub(super) fn insert_discovery(transaction: &Transaction<'_>, facts: &Facts) -> rusqlite::Result<()> {
    let mut log = transaction.prepare_cached(
        "INSERT INTO segment_discovery (day, cost, success, discovered_group_id) VALUES (?1, ?2, ?3, ?4)",
    )?;
    for attempt in &facts.attempts {
        let found = attempt.found.map(Group::id);
        log.execute(params![facts.day, attempt.cost, found.is_some(), found])?;
    }
    let mut write = transaction.prepare_cached(
        "INSERT INTO group_info_levels VALUES (?1, ?2, ?3, ?4, ?5) \
         ON CONFLICT (group_id) DO UPDATE SET info_level = excluded.info_level, \
         discovered_day = excluded.discovered_day, last_research_day = excluded.last_research_day",
    )?;
    for (group, knowledge) in &facts.knowledge {
        let hidden = !group.is_initially_known();
        // Groups that are known from the start were not studied on day 0.
        let studied = knowledge.last_research_day.filter(|day| hidden || *day > 0);
        write.execute(params![group.id(), knowledge.level, hidden, knowledge.discovered_day, studied])?;
    }
    Ok(())
}
