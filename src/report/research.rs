//! Texts for R&D projects: the expected duration and gain of a project before its purchase, and projects that will
//! finish too late.

use serde_json::Value;

use novamind_base::formatting::grouped_number;
use novamind_session::{LateProject, Observation, ResearchMeans, ResearchOutlook, ResearchSpread};

/// Describes the expected duration and gain of a project before it is started.
pub fn outlook_lines(outlook: &ResearchOutlook) -> Vec<String> {
    let ResearchOutlook { earliest, last_day, spread, .. } = outlook;
    if earliest > last_day {
        return vec![format!(
            "no project started now can finish before day {earliest}, after the last day ({last_day})"
        )];
    }
    let Some(spread) = spread else { return Vec::new() };
    vec![describe_duration(spread, *earliest, *last_day), describe_gain(spread)]
}

fn describe_duration(spread: &ResearchSpread, earliest: u32, last_day: u32) -> String {
    let [quarter, half, three_quarters] = spread.quartile_days;
    let by_the_end = format!("{} by the last day ({last_day})", format_whole_percent(spread.by_last_day));
    if quarter > earliest {
        return format!(
            "half of all projects finish between day {quarter} and {three_quarters}; {by_the_end}"
        );
    }
    // A quartile that equals the minimum duration adds no information.
    let mut parts = vec![format!(
        "{} chance of finishing on day {earliest}, the earliest",
        format_whole_percent(spread.at_earliest)
    )];
    if half > earliest {
        parts.push(format!("50% by day {half}"));
    }
    if three_quarters > earliest {
        parts.push(format!("75% by day {three_quarters}"));
    }
    format!("{}; {by_the_end}", parts.join(", "))
}

fn describe_gain(spread: &ResearchSpread) -> String {
    let [quarter, _, three_quarters] = spread.quartile_gains;
    let min = match format_whole_percent(spread.at_least_gain).as_str() {
        "less than 1%" => String::new(),
        share => format!("; {share} gain the minimum, {:+}", spread.least_gain),
    };
    format!("half of all projects gain between {quarter:+.4} and {three_quarters:+.4} quality{min}")
}

/// Formats a share as a whole percentage: `62%`.
fn format_whole_percent(share: f64) -> String {
    match (share * 100.0).round() {
        0.0 => "less than 1%".to_owned(),
        100.0 if share < 1.0 => "more than 99%".to_owned(),
        count => format!("{count}%"),
    }
}

/// Formats the mean duration of a tier's projects in whole days: `39`. Formats it as `≥30` if only a lower bound is
/// known.
pub fn format_mean_days(means: &ResearchMeans) -> String {
    format!("{}{}", if means.are_lower_bounds { "≥" } else { "" }, grouped_number(means.days, 0))
}

/// Formats the mean quality gain of a tier's projects: `+0.0402`. Formats it as `≥0.0400` if only a lower bound is
/// known.
pub fn format_mean_gain(means: &ResearchMeans, decimals: usize) -> String {
    format!("{}{:.decimals$}", if means.are_lower_bounds { "≥" } else { "+" }, means.gain)
}

/// Returns the result of `list_research_projects` for display. Replaces the means with those that take the minimum
/// duration and gain into account.
pub fn projects_with_means(answer: &Value, means: &[ResearchMeans]) -> Value {
    let mut shown = answer.clone();
    let tiers = shown.get_mut("tiers").and_then(Value::as_array_mut).into_iter().flatten();
    for (tier, means) in tiers.filter_map(Value::as_object_mut).zip(means) {
        tier.insert("mean_days".to_owned(), format_mean_days(means).into());
        tier.insert("mean_quality_boost".to_owned(), format_mean_gain(means, 4).into());
    }
    shown
}

/// Returns a line for each project that was started since the last week and will finish after the last day.
pub fn late_project_lines(seen: &Observation) -> Vec<String> {
    let new = seen.late_projects.iter().filter(|project| project.is_new);
    let line = |project: &LateProject| describe_late_project(&project.id, project.due_day, seen.last_day);
    new.map(line).collect()
}

/// Describes a project that will finish after the last day of the run.
pub fn describe_late_project(project: &str, due_day: u32, last_day: u32) -> String {
    format!("R&D project {project} finishes on day {due_day}, after the last day ({last_day})")
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use novamind_record::folder::configuration::Configuration;
    use novamind_record::mode::Mode;
    use novamind_record::trajectory::record::Via;
    use novamind_session::{NewRun, Session, Storage};

    fn run(days: u32, mode: Mode) -> Session {
        let new = NewRun {
            seed: Some(3),
            days: Some(days),
            cash: Some(30_000_000.0),
            mode,
            storage: Storage::Memory,
            projection: false,
            ..NewRun::default()
        };
        Session::create(new, &Configuration::bundled()).expect("a run")
    }

    #[test]
    fn outlook_shows_the_spread_before_purchase() {
        let session = run(500, Mode::Sandbox);
        let outlook = |tier: u8| outlook_lines(&session.company().research_outlook(tier));
        assert_eq!(
            outlook(1),
            [
                "94% chance of finishing on day 30, the earliest; 100% by the last day (500)",
                "half of all projects gain between +0.0265 and +0.0535 quality; 3% gain the minimum, +0.001",
            ]
        );
        assert_eq!(
            outlook(9)[0],
            "32% chance of finishing on day 30, the earliest, 50% by day 102, 75% by day 204; more than 99% by the \
             last day (500)"
        );
        assert_eq!(
            outlook(20),
            [
                "35% chance of finishing on day 30, the earliest, 50% by day 466, 75% by day 1222; 51% by \
                 the last day (500)",
                "half of all projects gain between +3.6833 and +12.3167 quality; 11% gain the minimum, +0.001",
            ]
        );
    }

    #[test]
    fn format_mean_days_is_at_least_the_minimum() {
        let mean_texts = |mode| {
            let session = run(500, mode);
            let means = session.company().research_means();
            assert_eq!(means[4], session.company().research_outlook(5).means);
            [0, 1, 2, 4].map(|at| (format_mean_days(&means[at]), format_mean_gain(&means[at], 4)))
        };
        let words = |days: &str, gain: &str| (days.to_owned(), gain.to_owned());
        assert_eq!(
            mean_texts(Mode::Sandbox),
            [words("30", "+0.0402"), words("33", "+0.0703"), words("39", "+0.1105"), words("59", "+0.2210")]
        );
        let session = run(500, Mode::Sandbox);
        let answer = json!({"tiers": [{"tier": 1, "mean_days": 12, "mean_quality_boost": 0.04}]});
        assert_eq!(
            projects_with_means(&answer, &session.company().research_means()),
            json!({"tiers": [{"tier": 1, "mean_days": "30", "mean_quality_boost": "+0.0402"}]})
        );
        // In a baseline run, only lower bounds of the means are shown.
        assert_eq!(
            mean_texts(Mode::Baseline),
            [
                words("≥30", "≥0.0400"),
                words("≥30", "≥0.0700"),
                words("≥30", "≥0.1100"),
                words("≥42", "≥0.2200")
            ]
        );
    }

    #[test]
    fn late_projects_are_named() {
        let session = run(28, Mode::Sandbox);
        let texts = outlook_lines(&session.company().research_outlook(2));
        assert_eq!(texts, ["no project started now can finish before day 30, after the last day (28)"]);
        let mut session = run(200, Mode::Sandbox);
        for tier in 12..=20 {
            let _ = session.call("start_research_project", &json!({ "tier": tier }), Via::Script);
        }
        let seen = session.company().observe();
        let due = |project: &novamind_session::LateProject| project.due_day > 200 && project.is_new;
        assert!(!seen.late_projects.is_empty() && seen.late_projects.iter().all(due));
        let first = &seen.late_projects[0];
        let words =
            format!("R&D project {} finishes on day {}, after the last day (200)", first.id, first.due_day);
        assert_eq!(late_project_lines(&seen)[0], words);
    }
}
