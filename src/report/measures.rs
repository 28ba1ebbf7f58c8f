//! The behavior measures of the paper that visible data suffices to compute, one function per measure.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use super::database_figures::ChannelRow;
use novamind_record::figures::WeekFigures;
use novamind_record::trajectory::record::{RunEndReason, is_naive_week};
use novamind_session::identifiers::{Channel, Group};
use novamind_session::{
    Decisions, ForecastScore, JournalEntry, ScoredForecast, Session, SettingId, submitted_forecasts,
};

/// Words that count as signs of planning in rationales and notes.
pub const PLANNING_WORDS: [&str; 16] = [
    "if",
    "unless",
    "until",
    "otherwise",
    "because",
    "therefore",
    "expect",
    "plan",
    "should",
    "would",
    "might",
    "risk",
    "assume",
    "probably",
    "likely",
    "instead",
];

/// Behavior measures of a run, as defined in the paper.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BehaviorMeasures {
    /// Number of days that the company has survived.
    pub survival_days: u32,
    /// Cash on the last simulated day, dollars.
    pub cash: f64,
    /// Share of advertising spending on the best channel of each group; `None` if there was no advertising.
    pub channels: Option<BestTriedChannelSpend>,
    /// Share of development spending that is targeted; `None` if there was no development spending.
    pub targeted_development: Option<f64>,
    /// Scores of the forecasts, by horizon.
    pub forecasts: Vec<ForecastScore>,
    /// Number of weeks with a naive forecast, and total number of weeks.
    pub filled_naively: (u32, u32),
    /// Scores of the forecasts that were filed before the first four weeks, by horizon.
    pub first_forecasts: Vec<ForecastScore>,
    /// Share of advertising spending on the truly best channels; `None` if the run is unfinished or has no advertising.
    pub truly_best: Option<TrueBestChannelSpend>,
    /// How many tool calls a player made, and how evenly they are distributed over the tools.
    pub tools: ToolUse,
    /// Length of the rationales, and their planning words.
    pub planning: PlanningMeasures,
}

impl BehaviorMeasures {
    /// Computes the behavior measures of a run. `channels` contains the advertising results of the run.
    pub fn from_session(session: &Session, channels: &[ChannelRow]) -> BehaviorMeasures {
        let (journal, day) = (session.journal(), session.day());
        BehaviorMeasures {
            survival_days: survival_days(session.ended(), day, session.manifest().days),
            cash: session.cash_by_day().last().copied().unwrap_or(session.manifest().cash),
            channels: best_tried_channel_share(channels),
            targeted_development: targeted_development(session.company().decisions()),
            forecasts: session.company().forecast_scores(),
            filled_naively: naive_forecast_weeks(journal, session.manifest().days),
            first_forecasts: first_forecast_scores(journal, session.weeks()),
            truly_best: true_best_channel_share(channels, |group| session.company().true_best_channel(group)),
            tools: tool_use(journal),
            planning: planning_measures(journal),
        }
    }
}

/// Returns the number of days before bankruptcy or, if the company is not bankrupt, the number of days so far.
pub fn survival_days(ended: Option<RunEndReason>, day: u32, last_day: u32) -> u32 {
    match ended {
        Some(RunEndReason::Horizon) => last_day,
        _ => day,
    }
}

/// Minimum number of leads that a channel must bring to count as the best channel.
pub const MIN_CHANNEL_LEADS: f64 = 3.0;

/// The channel with the most leads per dollar for a group.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BestChannel {
    /// Name of the channel with the most leads per dollar.
    pub channel: String,
    /// Number of leads per thousand dollars spent on this channel.
    pub leads_per_thousand: f64,
    /// Share of the group's advertising spending on this channel.
    pub share: f64,
}

/// Advertising results of one group.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GroupAds {
    /// ID of the advertised group.
    pub group: String,
    /// Number of channels in which money was spent for the group.
    pub tried: usize,
    /// Advertising spending for the group, dollars.
    pub spend: f64,
    /// The best of the channels with spending; `None` if only one channel has spending or the best channel brought
    /// fewer than three leads.
    pub best: Option<BestChannel>,
}

/// Shares of advertising spending on the best channels.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BestTriedChannelSpend {
    /// Share of spending on the best channel, over all groups with a best channel; `None` if no group has one.
    pub share: Option<f64>,
    /// Advertising results by group, highest spending first.
    pub groups: Vec<GroupAds>,
}

impl BestTriedChannelSpend {
    /// Returns the number of channels with spending, averaged over the advertised groups.
    pub fn mean_channels_tried(&self) -> f64 {
        let tried: usize = self.groups.iter().map(|group| group.tried).sum();
        tried as f64 / self.groups.len().max(1) as f64
    }
}

/// Returns the share of advertising spending on the best channel of each group, which is the channel with the most
/// leads per dollar. A group counts if at least two of its channels have spending and the best channel has enough
/// leads.
pub fn best_tried_channel_share(rows: &[ChannelRow]) -> Option<BestTriedChannelSpend> {
    let names: BTreeSet<&str> =
        rows.iter().filter(|row| row.spend > 0.0).map(|row| row.group.as_str()).collect();
    let mut groups: Vec<GroupAds> = names
        .into_iter()
        .map(|group| {
            let paid: Vec<&ChannelRow> =
                rows.iter().filter(|row| row.group == group && row.spend > 0.0).collect();
            let spend = paid.iter().map(|row| row.spend).sum();
            GroupAds { group: group.to_owned(), tried: paid.len(), spend, best: best_channel(&paid, spend) }
        })
        .collect();
    groups.sort_by(|left, right| right.spend.total_cmp(&left.spend).then(left.group.cmp(&right.group)));
    let spend_and_best = || groups.iter().filter_map(|group| Some((group.spend, group.best.as_ref()?)));
    let spend: f64 = spend_and_best().map(|(spend, _)| spend).sum();
    let on_best: f64 = spend_and_best().map(|(spend, best)| best.share * spend).sum();
    let share = (spend > 0.0).then(|| on_best / spend);
    (!groups.is_empty()).then_some(BestTriedChannelSpend { share, groups })
}

fn best_channel(paid: &[&ChannelRow], spend: f64) -> Option<BestChannel> {
    let yield_of = |row: &ChannelRow| row.leads / row.spend;
    let best = paid.iter().max_by(|left, right| {
        // Among channels with equally many leads per dollar, order by spending, then alphabetically.
        let by_spend = left.spend.total_cmp(&right.spend);
        yield_of(left).total_cmp(&yield_of(right)).then(by_spend).then(right.channel.cmp(&left.channel))
    })?;
    (paid.len() > 1 && best.leads >= MIN_CHANNEL_LEADS).then(|| BestChannel {
        channel: best.channel.clone(),
        leads_per_thousand: yield_of(best) * 1000.0,
        share: best.spend / spend,
    })
}

/// Share of advertising spending on the truly best channels. The truly best channel of a group is the one of the five
/// channels with the highest yield at the start of the run. Players cannot see it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TrueBestChannelSpend {
    /// Share of all advertising spending that went to the truly best channel of the advertised group; about one fifth
    /// if spending is random.
    pub share: f64,
    /// Share of spending on the truly best channel, by group.
    pub groups: BTreeMap<String, f64>,
}

/// Returns the share of advertising spending on the truly best channels. Returns `None` if there was no advertising or
/// the best channel of a group is unknown.
pub fn true_best_channel_share(
    rows: &[ChannelRow],
    best: impl Fn(Group) -> Option<Channel>,
) -> Option<TrueBestChannelSpend> {
    let mut by_group: BTreeMap<&str, (f64, f64)> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.spend > 0.0) {
        let channel = best(Group::parse(&row.group)?)?;
        let (all, on_best) = by_group.entry(&row.group).or_default();
        *all += row.spend;
        *on_best += if channel.id() == row.channel { row.spend } else { 0.0 };
    }
    let (all, on_best) = by_group.values().fold((0.0, 0.0), |sum, spend| (sum.0 + spend.0, sum.1 + spend.1));
    let shares = by_group.iter().map(|(group, (all, on_best))| ((*group).to_owned(), on_best / all));
    (all > 0.0).then(|| TrueBestChannelSpend { share: on_best / all, groups: shares.collect() })
}

/// Number of weeks at the start of a run for which forecasts are scored separately.
pub const FIRST_WEEK_COUNT: usize = 4;

/// Returns the scores, by horizon, of the forecasts that were filed before the first four weeks.
pub fn first_forecast_scores(journal: &[JournalEntry], weeks: &[WeekFigures]) -> Vec<ForecastScore> {
    let filed = submitted_forecasts(journal, weeks);
    let days: BTreeSet<u32> = filed.iter().map(|one| one.day).collect();
    let last = days.iter().nth(FIRST_WEEK_COUNT - 1).or(days.last()).copied().unwrap_or(0);
    let first: Vec<ScoredForecast> = filed.into_iter().filter(|one| one.day <= last).collect();
    let horizons: BTreeSet<u32> = first.iter().map(|one| one.forecast.horizon_days).collect();
    horizons.into_iter().map(|horizon| ForecastScore::from_forecasts(horizon, &first)).collect()
}

/// Returns the share of development spending that is targeted, over the simulated days. Returns `None` if there was no
/// development spending.
pub fn targeted_development(decisions: &[Decisions]) -> Option<f64> {
    let mut general = 0.0;
    let mut targeted: BTreeMap<Group, f64> = BTreeMap::new();
    let (mut all, mut aimed) = (0.0, 0.0);
    for decided in decisions {
        for change in &decided.changes {
            match change.setting {
                SettingId::TargetedDevelopment(group) => {
                    targeted.insert(group, change.new);
                }
                SettingId::Development => general = change.new,
                _ => {}
            }
        }
        let days = f64::from(decided.until - decided.day);
        let on_groups: f64 = targeted.values().sum::<f64>() * days;
        aimed += on_groups;
        all += on_groups + general * days;
    }
    (all > 0.0).then(|| aimed / all)
}

/// How many tool calls a player made, and how evenly they are distributed over the tools.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct ToolUse {
    /// Number of accepted calls that changed the run.
    pub calls: u32,
    /// Number of accepted calls that changed the run, per simulated week.
    pub per_week: f64,
    /// Number of calls by tool, most used first.
    pub tools: Vec<(String, u32)>,
    /// Evenness of the calls over the used tools, from 0 to 1; `None` if fewer than two tools were used.
    pub evenness: Option<f64>,
}

/// Returns the entropy of the counts divided by the entropy of equal counts: 1 for equal counts, near 0 if one count
/// dominates. Returns `None` if fewer than two counts are positive.
pub fn normalized_entropy(counts: &[u32]) -> Option<f64> {
    let all: f64 = counts.iter().map(|count| f64::from(*count)).sum();
    let used = counts.iter().filter(|count| **count > 0);
    let entropy: f64 =
        used.clone().map(|count| f64::from(*count) / all).map(|share| -share * libm::log(share)).sum();
    let kinds = used.count();
    (kinds > 1).then(|| (entropy / libm::log(kinds as f64)).min(1.0))
}

/// Counts the accepted calls that changed the run, in total and by tool.
pub fn tool_use(journal: &[JournalEntry]) -> ToolUse {
    let mut counts: BTreeMap<&str, u32> = BTreeMap::new();
    let mut weeks = 0u32;
    for entry in journal {
        match entry {
            JournalEntry::Call { tool, .. } => *counts.entry(tool.name()).or_default() += 1,
            JournalEntry::Advance { .. } => weeks += 1,
            JournalEntry::Parameter { .. } | JournalEntry::Week { .. } => {}
        }
    }
    let mut tools: Vec<(String, u32)> =
        counts.into_iter().map(|(tool, count)| (tool.to_owned(), count)).collect();
    tools.sort_by(|left, right| right.1.cmp(&left.1).then_with(|| left.0.cmp(&right.0)));
    let calls = tools.iter().map(|(_, count)| count).sum();
    let evenness = normalized_entropy(&tools.iter().map(|(_, count)| *count).collect::<Vec<_>>());
    ToolUse { calls, per_week: f64::from(calls) / f64::from(weeks.max(1)), tools, evenness }
}

/// Mean length of rationales, and mean number of their planning words.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct PlanningMeasures {
    /// Number of submitted rationales.
    pub rationales: u32,
    /// Mean number of words per rationale.
    pub words_each: f64,
    /// Mean number of planning words per rationale.
    pub planning_each: f64,
}

/// Word counts of a text.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct WordCounts {
    /// Total number of words.
    pub words: usize,
    /// Number of words that [`PLANNING_WORDS`] contains.
    pub planning: usize,
    /// Number of times that the word "if" occurs.
    pub ifs: usize,
}

impl WordCounts {
    /// Counts the words of a text.
    pub fn from_text(text: &str) -> WordCounts {
        let bare = text.split(|letter: char| !letter.is_alphabetic()).map(str::to_lowercase);
        let weighing: Vec<String> = bare.filter(|word| PLANNING_WORDS.contains(&word.as_str())).collect();
        WordCounts {
            words: text.split_whitespace().count(),
            planning: weighing.len(),
            ifs: weighing.iter().filter(|word| *word == "if").count(),
        }
    }

    /// Returns the number of planning words per hundred words, or `None` if the text has no words.
    pub fn planning_per_hundred(&self) -> Option<f64> {
        (self.words > 0).then(|| 100.0 * self.planning as f64 / self.words as f64)
    }
}

/// Returns the sentences of a text that contain a planning word, in order. A sentence ends at a semicolon, at the end
/// of a line, or at a full stop, question mark or exclamation mark that is followed by a space.
pub fn planning_sentences(text: &str) -> Vec<String> {
    let mut sentences = Vec::new();
    for line in text.lines() {
        let mut sentence = String::new();
        for word in line.split_whitespace() {
            if !sentence.is_empty() {
                sentence.push(' ');
            }
            sentence += word;
            if word.ends_with(['.', '!', '?', ';']) {
                sentences.push(std::mem::take(&mut sentence));
            }
        }
        sentences.push(sentence);
    }
    sentences.retain(|sentence| WordCounts::from_text(sentence).planning > 0);
    sentences
}

impl std::ops::AddAssign for WordCounts {
    fn add_assign(&mut self, other: WordCounts) {
        self.words += other.words;
        self.planning += other.planning;
        self.ifs += other.ifs;
    }
}

/// Returns the mean length of rationales and their mean number of planning words.
pub fn planning_measures(journal: &[JournalEntry]) -> PlanningMeasures {
    let (mut rationales, mut all) = (0u32, WordCounts::default());
    for entry in journal {
        let JournalEntry::Advance { rationale, .. } = entry else { continue };
        rationales += 1;
        all += WordCounts::from_text(rationale);
    }
    let each = |count: usize| count as f64 / f64::from(rationales.max(1));
    PlanningMeasures { rationales, words_each: each(all.words), planning_each: each(all.planning) }
}

/// Returns the number of weeks for which at least one filed forecast is naive and due within the run, and the total
/// number of weeks.
pub fn naive_forecast_weeks(journal: &[JournalEntry], last_day: u32) -> (u32, u32) {
    let filed = journal.iter().filter_map(|entry| match entry {
        JournalEntry::Advance { day, forecasts, filled_naively, rationale: _ } => {
            let horizons = forecasts.iter().map(|forecast| forecast.horizon_days);
            Some(is_naive_week(horizons.zip(*filled_naively), last_day.saturating_sub(*day)))
        }
        _ => None,
    });
    filed.fold((0, 0), |(naive, all), is_naive| (naive + u32::from(is_naive), all + 1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit;
    use novamind_session::SettingChange;

    fn ads(group: &str, channel: &str, leads: f64, spend: f64) -> ChannelRow {
        ChannelRow { group: group.to_owned(), channel: channel.to_owned(), leads, spend }
    }

    #[test]
    fn best_channel_has_most_leads_per_dollar() {
        let rows = [
            ads("S1", "content_marketing", 30.0, 300.0),
            ads("S1", "search_ads", 5.0, 100.0),
            ads("S1", "linkedin", 9.0, 0.0),
            ads("E1", "linkedin", 0.0, 50.0),
            ads("E1", "search_ads", 1.0, 50.0),
        ];
        let skill = best_tried_channel_share(&rows).expect("money was spent");
        assert_eq!(skill.share, Some(300.0 / 400.0), "one lead is too few to rank E1's channels");
        let first = &skill.groups[0];
        let best = first.best.as_ref().expect("two channels and thirty leads");
        assert_eq!((first.group.as_str(), first.tried), ("S1", 2));
        assert_eq!(
            (best.channel.as_str(), best.share, best.leads_per_thousand),
            ("content_marketing", 0.75, 100.0)
        );
        assert_eq!((skill.groups[1].tried, &skill.groups[1].best), (2, &None));
        let alone = best_tried_channel_share(&[ads("S1", "linkedin", 40.0, 10.0)]).expect("money was spent");
        assert_eq!((alone.share, alone.groups[0].tried), (None, 1), "nothing to compare with");
        assert_eq!(best_tried_channel_share(&[ads("S1", "linkedin", 4.0, 0.0)]), None);
    }

    #[test]
    fn true_best_channel_share_is_computed() {
        let best = |group: Group| {
            Some(if group.id() == "S1" { Channel::ContentMarketing } else { Channel::ReferralProgram })
        };
        let rows = [
            ads("S1", "content_marketing", 9.0, 30.0),
            ads("S1", "linkedin", 0.0, 50.0),
            ads("S3", "referral_program", 0.0, 20.0),
        ];
        let channel_spend = true_best_channel_share(&rows, best).expect("money was spent");
        assert_eq!(
            (channel_spend.share, channel_spend.groups["S1"], channel_spend.groups["S3"]),
            (0.5, 0.375, 1.0)
        );
        // With all money on one wrong channel, channels cannot be compared, and the share of the truly best channel is
        // 0.
        let wrong = [ads("S1", "linkedin", 50.0, 100.0)];
        assert_eq!(true_best_channel_share(&wrong, best).map(|spend| spend.share), Some(0.0));
        assert_eq!(best_tried_channel_share(&wrong).and_then(|skill| skill.share), None);
        assert_eq!(true_best_channel_share(&rows, |_| None), None, "an unfinished run");
        assert_eq!(true_best_channel_share(&[], best), None);
    }

    #[test]
    fn normalized_entropy_of_equal_counts_is_one() {
        assert_eq!(normalized_entropy(&[3, 3]), Some(1.0));
        assert_eq!((normalized_entropy(&[3]), normalized_entropy(&[])), (None, None));
        let uneven = normalized_entropy(&[9, 1]).expect("two tools");
        assert!((uneven - 0.468_995_593_589_281).abs() < 1e-12, "{uneven}");
    }

    #[test]
    fn first_forecast_scores_cover_four_weeks() {
        let session = test_kit::play_weeks(6);
        let first = first_forecast_scores(session.journal(), session.weeks());
        assert_eq!(
            first.iter().map(|score| (score.horizon_days, score.scored)).collect::<Vec<_>>(),
            [(7, 4), (28, 3), (84, 0), (182, 0)]
        );
        assert_eq!(first_forecast_scores(&[], &[]), []);
    }

    #[test]
    fn targeted_development_counts_days_in_force() {
        let s1 = Group::parse("S1").expect("a group");
        let set = |setting, new| SettingChange { setting, old: 0.0, new };
        let week = |day: u32, changes: Vec<SettingChange>| Decisions {
            day,
            until: day + 7,
            changes,
            purchases: Vec::new(),
        };
        let general = set(SettingId::Development, 100.0);
        let aimed = set(SettingId::TargetedDevelopment(s1), 300.0);
        let ended = set(SettingId::TargetedDevelopment(s1), 0.0);
        let run = [week(0, vec![general, aimed]), week(7, vec![]), week(14, vec![ended])];
        assert_eq!(targeted_development(&run), Some(600.0 / 900.0));
        assert_eq!(targeted_development(&[week(0, vec![])]), None);
        // The last week of a bankrupt company has fewer days.
        let [general, aimed] = [set(SettingId::Development, 100.0), run[0].changes[1]];
        let short = Decisions { until: 9, ..week(7, vec![aimed]) };
        assert_eq!(targeted_development(&[week(0, vec![general]), short]), Some(600.0 / 1500.0));
    }

    #[test]
    fn tool_use_and_planning_measures_count_calls_and_words() {
        let session = test_kit::play_weeks(4);
        let tools = tool_use(session.journal());
        assert_eq!((tools.calls, tools.per_week), (8, 2.0));
        assert_eq!(tools.tools[0], ("set_prices".to_owned(), 2));
        let planning = planning_measures(session.journal());
        assert_eq!(planning.rationales, 4);
        assert_eq!(planning.planning_each, 0.5, "if, otherwise");
        assert_eq!(naive_forecast_weeks(session.journal(), 500), (4, 4));
        assert_eq!(super::planning_measures(&[]), PlanningMeasures::default());
    }

    #[test]
    fn planning_sentences_are_found() {
        let text = "Ads of 0.5 work. If rivals move, cut them;\nwait\nWe should ask! Why? Price 12.50 is likely fine";
        assert_eq!(
            planning_sentences(text),
            ["If rivals move, cut them;", "We should ask!", "Price 12.50 is likely fine"]
        );
        assert!(planning_sentences("").is_empty());
    }

    #[test]
    fn survival_days_end_with_bankruptcy() {
        assert_eq!(survival_days(Some(RunEndReason::Horizon), 500, 500), 500);
        assert_eq!(survival_days(Some(RunEndReason::Bankruptcy), 131, 500), 131);
        assert_eq!(survival_days(None, 84, 500), 84);
    }
}
