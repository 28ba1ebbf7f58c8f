//! Customers' posts: the selection of authors (docs/mechanics/market/social/crowd.md).
//!
//! Weighted drawing without replacement has the same distribution as sorting by the times of exponential clocks whose
//! rates are the weights. The first authors are therefore drawn from all subscribers before the decisions of the day.
//! Customers who leave later in the day are added with separate clocks.

use super::Social;
use super::engagement::draw_engagement;
use super::opinions::OpinionContext;
use super::sentiment::sentiment;
use super::weights::{cancelled_weight, lost_company_weight, post_weight};
use crate::customers::Customers;
use crate::customers::columns::Block;
use crate::customers::traits::draw_traits;
use crate::enterprise::churn::{LostEnterprise, ThreadFailure};
use crate::events::{CustomerProblems, Facts, Opinion, PostAuthor, PostCause, PostSubject, Sentiment, Theme};
use crate::identifiers::Group;
use crate::params::{CustomerPosts, Params};
use crate::random::{Part, Stream, Streams};
use crate::retention::renewal::CancelledIndividual;

/// Returns whether customers post on a day.
pub fn is_posting_day(day: u32, params: &Params) -> bool {
    match params.fidelity.customer_posts {
        CustomerPosts::Weekly => day.is_multiple_of(params.run.days_per_week),
        CustomerPosts::Daily => true,
    }
}

/// Post weights of the subscribers in a block.
pub struct BlockWeights {
    /// Satisfaction of each row of the block before today's update.
    before: Vec<f64>,
    /// Sum of the post weights of all rows that have not been picked.
    weight: f64,
}

/// Computes the post weights of a block from the satisfaction before today's update.
pub fn weigh_block(
    group: Group,
    block: &Block,
    before: Vec<f64>,
    context: &OpinionContext<'_>,
) -> BlockWeights {
    let weight =
        before.iter().enumerate().map(|(at, before)| row_weight(context, group, block, at, *before)).sum();
    BlockWeights { before, weight }
}

#[derive(Debug, Clone, Copy)]
struct Candidate {
    /// Time of the candidate's exponential clock.
    time: f64,
    customer: u32,
    group: Group,
    n: u32,
    /// Satisfaction that determines the tone of the post; `None` for a complaint.
    satisfaction: Option<f64>,
    opinion: Opinion,
}

/// The selection of today's authors.
pub struct AuthorSelection {
    stream: Stream,
    candidates: Vec<Candidate>,
    remaining_posts: usize,
}

/// Starts the selection among all subscribers, directly after the satisfaction update. `weights_by_block` has one element for
/// each non-empty block, in block order.
pub fn from_subscribers(
    mut weights_by_block: Vec<BlockWeights>,
    customers: &Customers,
    context: &OpinionContext<'_>,
    streams: &Streams,
) -> AuthorSelection {
    let mut stream = streams.open(Part::CustomerPosts, [u64::from(context.day.day())]);
    let max_posts = context.day.params.social.max_posts_per_day as usize;
    let blocks: Vec<(Group, &Block)> = customers.blocks().collect();
    let mut picked: Vec<(usize, usize)> = Vec::new();
    let (mut candidates, mut time) = (Vec::new(), 0.0);
    while candidates.len() < max_posts {
        let total: f64 = weights_by_block.iter().map(|block_weights| block_weights.weight).sum();
        if total <= 0.0 {
            break;
        }
        time += stream.exponential(1.0 / total);
        let target = stream.uniform() * total;
        let is_picked = |number: usize, at: usize| picked.contains(&(number, at));
        let Some((number, at)) = find_row(&blocks, &weights_by_block, target, context, is_picked) else {
            break;
        };
        picked.push((number, at));
        let (group, block) = blocks[number];
        let weights = &mut weights_by_block[number];
        let contribution = weights.before[at];
        weights.weight = (weights.weight - row_weight(context, group, block, at, contribution)).max(0.0);
        candidates.push(Candidate {
            time,
            customer: block.customer[at],
            group,
            n: block.n[at],
            satisfaction: Some(block.satisfaction[at]),
            opinion: context.opinion(group, block, at, contribution, stream.uniform()),
        });
    }
    AuthorSelection { stream, candidates, remaining_posts: max_posts }
}

#[inline]
fn row_weight(context: &OpinionContext<'_>, group: Group, block: &Block, at: usize, before: f64) -> f64 {
    post_weight(&context.weight_inputs(group, block, at, before), &context.day.params.social)
}

/// Returns the first row at which the running sum of the remaining rows' weights exceeds the target. If rounding keeps
/// the sum below the target, returns the last row.
fn find_row(
    blocks: &[(Group, &Block)],
    weights_by_block: &[BlockWeights],
    mut target: f64,
    context: &OpinionContext<'_>,
    is_picked: impl Fn(usize, usize) -> bool,
) -> Option<(usize, usize)> {
    let mut last = None;
    for (number, ((group, block), block_weights)) in blocks.iter().zip(weights_by_block).enumerate() {
        if block_weights.weight <= 0.0 {
            continue;
        }
        let mut rows = (0..block.len()).filter(|at| !is_picked(number, *at));
        if target >= block_weights.weight {
            target -= block_weights.weight;
            last = rows.next_back().map(|at| (number, at)).or(last);
            continue;
        }
        for at in rows {
            last = Some((number, at));
            target -= row_weight(context, *group, block, at, block_weights.before[at]);
            if target < 0.0 {
                return last;
            }
        }
    }
    last
}

impl AuthorSelection {
    /// Adds individuals who cancelled today and enterprises that were lost today as candidates.
    pub fn add_departed(
        &mut self,
        cancelled: &[CancelledIndividual],
        lost: &[LostEnterprise],
        params: &Params,
    ) {
        let social_params = &params.social;
        for cancelled_individual in cancelled {
            let weight = cancelled_weight(cancelled_individual.satisfaction, 1.0, social_params);
            let theme = if cancelled_individual.satisfaction < 0.0 { Theme::Quality } else { Theme::Price };
            let opinion = Opinion {
                cause: PostCause::Cancelled,
                customer_problems: CustomerProblems::default(),
                theme,
                days_subscribed: cancelled_individual.days_subscribed,
                plan: Some(cancelled_individual.plan),
                price: cancelled_individual.price,
                seats: 1,
                waiting_days: 0,
                downtime_minutes: 0,
            };
            self.add_candidate(
                weight,
                cancelled_individual.customer,
                cancelled_individual.group,
                cancelled_individual.n,
                opinion,
            );
        }
        for lost_enterprise in lost {
            let weight = lost_company_weight(f64::from(lost_enterprise.seats), social_params);
            let opinion = Opinion {
                cause: PostCause::Lost {
                    thread: lost_enterprise.kind,
                    unanswered: lost_enterprise.failure == ThreadFailure::Timeout,
                },
                customer_problems: CustomerProblems::default(),
                theme: Theme::Support,
                days_subscribed: lost_enterprise
                    .days_subscribed
                    .unwrap_or(social_params.enterprise_churn_event_fallback_days),
                plan: None,
                price: 0.0,
                seats: lost_enterprise.seats,
                waiting_days: 0,
                downtime_minutes: 0,
            };
            self.add_candidate(
                weight,
                lost_enterprise.customer,
                lost_enterprise.group,
                lost_enterprise.n,
                opinion,
            );
        }
    }

    fn add_candidate(&mut self, weight: f64, customer: u32, group: Group, n: u32, opinion: Opinion) {
        let time = self.stream.exponential(1.0 / weight);
        self.candidates.push(Candidate { time, customer, group, n, satisfaction: None, opinion });
    }

    /// Publishes the posts of the candidates with the earliest clock times.
    pub fn publish(mut self, social: &mut Social, params: &Params, streams: &Streams, facts: &mut Facts) {
        self.candidates.sort_by(|one, other| one.time.total_cmp(&other.time));
        self.candidates.truncate(self.remaining_posts);
        for candidate in self.candidates {
            let u = self.stream.uniform();
            // Customers who left always complain.
            let tone = candidate
                .satisfaction
                .map_or(Sentiment::Negative, |contribution| sentiment(contribution, u, &params.social));
            let engagement = draw_engagement(tone, candidate.group.id(), params, &mut self.stream);
            let author = post_author(
                candidate.customer,
                candidate.group,
                candidate.n,
                candidate.opinion.seats,
                params,
                streams,
            );
            social.publish(Some(author), tone, engagement, PostSubject::Opinion(candidate.opinion), facts);
        }
    }
}

/// Returns a customer as an author, with the profile that was drawn at arrival.
pub fn post_author(
    customer: u32,
    group: Group,
    n: u32,
    seats: u32,
    params: &Params,
    streams: &Streams,
) -> PostAuthor {
    // The deal velocity (1.0) does not affect the profile.
    let persona = draw_traits(group, n, 1.0, params, streams).persona;
    PostAuthor {
        customer,
        group,
        n,
        persona,
        enterprise_seats: if group.is_enterprise() { seats } else { 0 },
    }
}

#[cfg(test)]
mod tests {
    use std::sync::LazyLock;

    use super::*;
    use crate::context::tests::with_day_context;
    use crate::customers::columns::Subscriber;
    use crate::events::{Post, ServiceDay, ThreadKind};
    use crate::identifiers::Plan;
    use crate::morning::tests::morning;
    use crate::settings::Settings;
    use crate::test_kit::subscriber;

    fn group() -> Group {
        Group::parse("S1").expect("a group")
    }

    /// Returns the posts of a posting day with the given subscribers and customers who left.
    fn posts(
        rows: &[Subscriber],
        cancelled: &[CancelledIndividual],
        lost: &[LostEnterprise],
        seed: u64,
    ) -> Vec<Post> {
        static PARAMS: LazyLock<Params> = LazyLock::new(Params::bundled);
        let (params, streams) = (&*PARAMS, Streams::new(seed));
        let settings = Settings::initial(params);
        let mut social = Social::initial(&settings);
        let mut customers = Customers::default();
        rows.iter().for_each(|row| customers.groups[group()].activate(*row));
        let day = morning(70);
        let chronicle = social.chronicle.clone();
        let quiet = ServiceDay::without_load();
        let mut selection = with_day_context(&day, &settings, &quiet, (params, &streams), |day| {
            let context = OpinionContext { day, chronicle: &chronicle };
            let satisfaction_of = |block: &Block| block.satisfaction.clone();
            let weights_by_block = customers
                .map_blocks(|group, block| weigh_block(group, block, satisfaction_of(block), &context));
            from_subscribers(weights_by_block, &customers, &context, &streams)
        });
        selection.add_departed(cancelled, lost, params);
        let mut facts = Facts::default();
        facts.start_day(70);
        selection.publish(&mut social, params, &streams, &mut facts);
        facts.posts
    }

    fn subscriber_with_satisfaction(n: u32, satisfaction: f64) -> Subscriber {
        Subscriber { satisfaction, usage_rate: 0.0, ..subscriber(n) }
    }

    fn cancelled_individual() -> CancelledIndividual {
        CancelledIndividual {
            customer: 900,
            group: group(),
            n: 900,
            satisfaction: -0.2,
            days_subscribed: 30,
            plan: Plan::A,
            price: 12.0,
        }
    }

    fn lost_company() -> LostEnterprise {
        LostEnterprise {
            customer: 800,
            group: Group::parse("E1").expect("a group"),
            n: 7,
            seats: 120,
            days_subscribed: None,
            kind: ThreadKind::NewLead,
            failure: ThreadFailure::Timeout,
        }
    }

    #[test]
    fn at_most_five_different_subscribers_post() {
        let rows: Vec<Subscriber> = (1..=40).map(|n| subscriber_with_satisfaction(n, 0.1)).collect();
        let mut authors: Vec<u32> = posts(&rows, &[], &[], 1)
            .iter()
            .filter_map(|post| post.author)
            .map(|post_author| post_author.customer)
            .collect();
        authors.sort_unstable();
        authors.dedup();
        assert_eq!(authors.len(), 5);
        assert_eq!(posts(&rows[..3], &[], &[], 1).len(), 3);
        assert_eq!(posts(&[], &[], &[], 1).len(), 0);
        assert_eq!(posts(&[], &[cancelled_individual()], &[], 1).len(), 1);
        assert_eq!(posts(&rows, &[], &[], 1), posts(&rows, &[], &[], 1));
    }

    #[test]
    fn first_author_is_drawn_by_weight() {
        // The weights are 1 + 10 |S|, that is 1, 2 and 3, and 15 for an individual who cancelled at satisfaction -0.2.
        let rows = [
            subscriber_with_satisfaction(1, 0.0),
            subscriber_with_satisfaction(2, 0.1),
            subscriber_with_satisfaction(3, 0.2),
        ];
        let runs = 4000;
        let mut first = [0.0; 4];
        for seed in 0..runs {
            let posts = posts(&rows, &[cancelled_individual()], &[], seed);
            let author = posts[0].author.expect("a customer").n;
            first[if author == 900 { 3 } else { author as usize - 1 }] += 1.0 / runs as f64;
        }
        for (share, weight) in first.into_iter().zip([1.0, 2.0, 3.0, 15.0]) {
            let expected: f64 = weight / 21.0;
            let error = (expected * (1.0 - expected) / runs as f64).sqrt();
            assert!((share - expected).abs() < 4.0 * error, "{first:?}");
        }
    }

    #[test]
    fn departed_customers_complain_with_cause() {
        let found = posts(&[], &[cancelled_individual()], &[lost_company()], 3);
        assert_eq!(
            found[0].author.map(|author| author.enterprise_seats),
            Some(120),
            "the weights are 960 and 15"
        );
        assert!(found.iter().all(|post| post.sentiment == Sentiment::Negative));
        let causes: Vec<PostCause> = found
            .iter()
            .map(|post| match post.matter {
                PostSubject::Opinion(opinion) => opinion.cause,
                _ => panic!("an opinion"),
            })
            .collect();
        assert!(causes.contains(&PostCause::Cancelled));
        assert!(causes.contains(&PostCause::Lost { thread: ThreadKind::NewLead, unanswered: true }));
    }

    #[test]
    fn posting_day_is_every_seventh_day() {
        let mut params = Params::bundled();
        let days: Vec<u32> = (1..=21).filter(|day| is_posting_day(*day, &params)).collect();
        assert_eq!(days, [7, 14, 21]);
        params.fidelity.customer_posts = CustomerPosts::Daily;
        assert!((1..=21).all(|day| is_posting_day(day, &params)));
    }
}
