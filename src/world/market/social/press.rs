//! Press posts about competitors and the economy (docs/mechanics/market/social/press.md).

use super::Social;
use crate::events::{Engagement, Facts, PostSubject, Reading, Sentiment, Severity, Trend};
use crate::market::competitors::{CompetitorEvent, severity};
use crate::market::economy::Economy;
use crate::params::{Competitor, MacroEconomy, Params};
use crate::random::{Part, Stream, Streams};

/// Returns the event that the press covers: the oldest event within its coverage period.
pub fn current_event<'a>(
    day: u32,
    events: &'a [CompetitorEvent],
    competitor: &Competitor,
) -> Option<&'a CompetitorEvent> {
    events.iter().find(|event| event.day + competitor.competitor_event_post_days >= day)
}

/// Returns the gain in quality that the press estimates for an event. `u` is a uniform draw within the error range.
pub fn estimated_boost(boost: f64, u: f64) -> f64 {
    (boost + u * boost).max(0.0)
}

/// Returns the engagement of a post about a competitor. Views are int(base (1 + U)); likes and shares are int(views
/// ratio (1 + U)).
pub fn competitor_engagement(
    severity: Severity,
    [views, likes, shares]: [f64; 3],
    competitor: &Competitor,
) -> Engagement {
    let base = match severity {
        Severity::Minor => competitor.competitor_post_base_views_minor,
        Severity::Moderate => competitor.competitor_post_base_views_moderate,
        Severity::Major => competitor.competitor_post_base_views_major,
        Severity::Transformative => competitor.competitor_post_base_views_transformative,
    };
    let views = (f64::from(base) * (1.0 + views)).trunc();
    let count_from_views = |ratio: f64, u: f64| (views * ratio * (1.0 + u)).trunc() as u32;
    Engagement {
        likes: count_from_views(competitor.competitor_post_likes_ratio, likes),
        shares: count_from_views(competitor.competitor_post_shares_ratio, shares),
        virality: 0.0,
    }
}

/// Writes today's posts about competitors.
pub fn write_competitor_posts(
    day: u32,
    events: &[CompetitorEvent],
    social: &mut Social,
    params: &Params,
    streams: &Streams,
    facts: &mut Facts,
) {
    let competitor = &params.competitor;
    let Some(event) = current_event(day, events, competitor) else { return };
    let mut stream = streams.open(Part::CompetitorPosts, [u64::from(day)]);
    let u = stream
        .between(competitor.competitor_post_boost_noise_min, competitor.competitor_post_boost_noise_max);
    let estimate = estimated_boost(event.boost, u);
    let severity = severity(estimate, competitor);
    for _ in 0..competitor.competitor_event_posts_per_day {
        let name = stream.index(competitor.competitor_names.len()) as u8;
        let perspective = stream.index(competitor.post_perspective_count as usize) as u8;
        let draws = [stream.uniform(), stream.uniform(), stream.uniform()];
        let engagement = competitor_engagement(severity, draws, competitor);
        let matter = PostSubject::CompetitorEvent { name, perspective, severity, estimate };
        social.publish(None, Sentiment::Neutral, engagement, matter, facts);
    }
}

/// Returns the tone of posts about the economy.
pub fn economy_tone(trend: Trend) -> Sentiment {
    match trend {
        Trend::StrongExpansion | Trend::Expansion => Sentiment::Positive,
        Trend::Neutral => Sentiment::Neutral,
        Trend::Contraction | Trend::SevereContraction => Sentiment::Negative,
    }
}

/// Returns the engagement of a post about the economy.
pub fn economy_engagement([views, likes, shares]: [f64; 3], economy: &MacroEconomy) -> Engagement {
    let views = (economy.macro_post_views_base * (1.0 + views)).trunc();
    let count_from_views = |ratio: f64, u: f64| (views * ratio * (1.0 + u)).trunc() as u32;
    Engagement {
        likes: count_from_views(economy.macro_post_likes_ratio, likes),
        shares: count_from_views(economy.macro_post_shares_ratio, shares),
        virality: 0.0,
    }
}

/// Writes today's posts about the economy: one for each published PMI reading, and at intervals a round of opinions
/// about the current state of the economy.
pub fn write_economy_posts(
    day: u32,
    economy: &Economy,
    social: &mut Social,
    params: &Params,
    streams: &Streams,
    facts: &mut Facts,
) {
    let macro_economy = &params.economy;
    let mut stream = streams.open(Part::MacroPosts, [u64::from(day)]);
    let mut write = |social: &mut Social, stream: &mut Stream, trend, matter| {
        let draws = [stream.uniform(), stream.uniform(), stream.uniform()];
        social.publish(None, economy_tone(trend), economy_engagement(draws, macro_economy), matter, facts);
    };
    let is_published_today =
        |reading: &&Reading| reading.measured_day + macro_economy.macro_pmi_publication_delay_days == day;
    if let Some(reading) = economy.published.as_ref().filter(is_published_today) {
        write(social, &mut stream, reading.trend, PostSubject::Reading(*reading));
    }
    let next = *social.next_round.get_or_insert_with(|| {
        let mut first = streams.open(Part::MacroPosts, [0]);
        first.integer(
            macro_economy.macro_social_post_interval_min,
            macro_economy.macro_social_post_interval_max,
        )
    });
    if day < next {
        return;
    }
    let pause = stream
        .integer(macro_economy.macro_social_post_interval_min, macro_economy.macro_social_post_interval_max);
    social.next_round = Some(day + pause);
    let trend = Trend::from_index(economy.pmi, macro_economy);
    for _ in 0..stream
        .integer(macro_economy.macro_social_post_count_min, macro_economy.macro_social_post_count_max)
    {
        let perspective = stream.index(macro_economy.post_perspective_count as usize) as u8;
        write(social, &mut stream, trend, PostSubject::Economy { trend, pmi: economy.pmi, perspective });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Settings;

    fn event(day: u32, boost: f64) -> CompetitorEvent {
        CompetitorEvent { day, boost, sampled: boost, u: 0.0, by_feedback: false }
    }

    /// Returns the press estimate, and the likes and shares of two posts, for given draws.
    fn posts(events: &[CompetitorEvent], day: u32, u: f64) -> (f64, Vec<(u32, u32)>) {
        let competitor = Params::bundled().competitor;
        let event = current_event(day, events, &competitor).expect("a topic");
        let estimate = estimated_boost(event.boost, u);
        let engagement = |draws| {
            let reactions = competitor_engagement(severity(estimate, &competitor), draws, &competitor);
            (reactions.likes, reactions.shares)
        };
        (estimate, vec![engagement([0.5, 0.5, 0.5]), engagement([0.25, 0.75, 0.1])])
    }

    #[test]
    fn competitor_posts_cover_the_oldest_event() {
        assert_eq!(posts(&[event(100, 0.09)], 100, 0.0), (0.09, vec![(22, 9), (21, 5)]));
        let (estimate, engagement) = posts(&[event(100, 0.09)], 100, 0.25);
        assert!((estimate - 0.1125).abs() < 1e-12);
        assert_eq!(engagement, [(56, 22), (54, 13)]);
        let over = [event(96, 0.02), event(100, 0.25)];
        assert_eq!(posts(&over, 100, 0.0), (0.25, vec![(112, 45), (109, 27)]));
        let older = [event(98, 0.02), event(100, 0.25)];
        assert_eq!(posts(&older, 100, 0.0), (0.02, vec![(5, 2), (5, 1)]));
        assert_eq!(current_event(104, &[event(100, 0.1)], &Params::bundled().competitor), None);
    }

    #[test]
    fn economy_posts_follow_intervals_and_readings() {
        let params = Params::bundled();
        let streams = Streams::new(9);
        let mut social = Social::initial(&Settings::initial(&params));
        let mut economy = Economy::initial(&params);
        let (mut rounds, mut readings) = (Vec::new(), 0);
        for day in 1..=500 {
            let mut facts = Facts::default();
            facts.start_day(day);
            crate::market::economy::step(day, &mut economy, false, &params, &streams, &mut facts);
            write_economy_posts(day, &economy, &mut social, &params, &streams, &mut facts);
            let published =
                facts.posts.iter().filter(|post| matches!(post.matter, PostSubject::Reading(_))).count();
            assert_eq!(published, facts.readings.len());
            readings += published;
            let opinion_posts = facts.posts.len() - published;
            if opinion_posts > 0 {
                assert!((2..=8).contains(&opinion_posts));
                rounds.push(day);
            }
        }
        assert_eq!(readings, 16);
        assert!((5..=20).contains(&rounds[0]));
        assert!(rounds.windows(2).all(|pair| (5..=20).contains(&(pair[1] - pair[0]))), "{rounds:?}");
        assert!((150..=310).contains(&(social.next_post - 1)), "{}", social.next_post - 1);
    }

    /// By renewal theory, 60 days have 60/12.5 - 0.39 rounds of 5 posts, plus one reading.
    #[test]
    fn first_sixty_days_average_23_economy_posts() {
        let params = Params::bundled();
        let seeds = 300;
        let mut count = 0.0;
        for seed in 0..seeds {
            let (streams, mut facts) = (Streams::new(seed), Facts::default());
            let mut social = Social::initial(&Settings::initial(&params));
            let mut economy = Economy::initial(&params);
            for day in 1..=60 {
                crate::market::economy::step(day, &mut economy, false, &params, &streams, &mut facts);
                write_economy_posts(day, &economy, &mut social, &params, &streams, &mut facts);
            }
            count += f64::from(social.next_post - 1);
        }
        let mean = count / seeds as f64;
        assert!((mean - 23.04).abs() < 4.0 * 7.0 / (seeds as f64).sqrt(), "{mean}");
    }
}
