//! Posts of customers about their experience.

use std::sync::LazyLock;

use super::wording::{self, SpeechRegister};
use crate::grammar::{Chooser, Context, Grammar};
use novamind_world::events::{Opinion, PostAuthor, PostCause, Sentiment, Theme};
use novamind_world::params::Params;

static GRAMMAR: LazyLock<Grammar> = LazyLock::new(|| {
    let sources = [
        include_str!("../../../assets/voice/customers.toml"),
        include_str!("../../../assets/voice/groups.toml"),
    ];
    Grammar::parse_all(&sources).expect("the bundled grammars are valid")
});

/// Number of days for which an author counts as a new customer.
const NEW_CUSTOMER_DAYS: u32 = 30;
const VETERAN_AFTER_DAYS: u32 = 120;
/// One in this many casual authors writes without capital letters.
const LOWERCASE_AUTHOR_INTERVAL: u32 = 9;

pub(super) fn draft_post(context: &Context, choose: Chooser<'_>) -> String {
    GRAMMAR.expand("post", context, choose)
}

/// Returns whether an author writes without capital letters. The result is the same for all posts of the author.
pub(super) fn writes_in_lowercase(author: &PostAuthor) -> bool {
    SpeechRegister::for_group(Some(author.group)) == SpeechRegister::Casual
        && author.n.is_multiple_of(LOWERCASE_AUTHOR_INTERVAL)
}

/// Returns the grammar context of a post.
pub(super) fn context(author: &PostAuthor, opinion: &Opinion, tone: Sentiment, params: &Params) -> Context {
    let company = author.group.is_enterprise();
    let person = |individual: &'static str, of_company: &'static str| {
        if company { of_company } else { individual }
    };
    let tone_id = tone_id(tone);
    let situation = situation(opinion);
    let register = SpeechRegister::for_group(Some(author.group)).id();
    let also = |trouble: bool, post_cause: PostCause| trouble && opinion.cause != post_cause;
    let days = opinion.days_subscribed;
    let kind = match opinion.cause {
        PostCause::Lost { thread, .. } => Some(thread.id()),
        _ => None,
    };
    Context::default()
        .with("group", author.group.id())
        .with("key", format!("{situation}.{tone_id}"))
        .with("shape", post_form(opinion.cause, tone))
        .with("mood", format!("{register}.{tone_id}"))
        .with("I", person("I", "we"))
        .with("me", person("me", "us"))
        .with("my", person("my", "our"))
        .with("am", person("I'm", "we're"))
        .with("role", wording::role(author, params))
        .with("trade", wording::industry(author, params))
        .with("since", wording::time_span(days))
        .with("per", person("a month", "a seat and month"))
        .with_optional("plan", opinion.plan.map(|plan| format!("plan {plan}")))
        .with_optional("price", wording::price(opinion.price))
        .with_optional(
            "waiting",
            (opinion.waiting_days > 1).then(|| wording::time_span(opinion.waiting_days)),
        )
        .with_optional("downtime", wording::outage_span(opinion.downtime_minutes))
        .with_optional("seats", company.then(|| wording::approximate_seats(opinion.seats)))
        .with_tag("new", days <= NEW_CUSTOMER_DAYS)
        .with_tag("settled", days > NEW_CUSTOMER_DAYS && days <= VETERAN_AFTER_DAYS)
        .with_tag("veteran", days > VETERAN_AFTER_DAYS)
        .with_tag("rose", opinion.cause == PostCause::Improved)
        .with_tag("fell", opinion.cause == PostCause::Declined)
        .with_tag("company", company)
        .with_tag("skilled", wording::is_skilled(author, params))
        .with_tag("senior", wording::is_senior(author, params))
        .with_tag("also_down", also(opinion.customer_problems.outage, PostCause::Outage))
        .with_tag("also_waiting", also(opinion.customer_problems.issue, PostCause::Issue))
        .with_tag("also_short", also(opinion.customer_problems.quota, PostCause::Quota))
        .with_tag("unanswered", matches!(opinion.cause, PostCause::Lost { unanswered: true, .. }))
        .with_tag("wanted_to_leave", kind == Some("churn_prevention"))
        .with_tag("new_terms", kind == Some("renegotiation"))
        .with_tag("other_plan", kind == Some("plan_change"))
}

fn tone_id(tone: Sentiment) -> &'static str {
    match tone {
        Sentiment::Positive => "positive",
        Sentiment::Neutral => "neutral",
        Sentiment::Negative => "negative",
    }
}

fn post_form(cause: PostCause, tone: Sentiment) -> &'static str {
    match (cause, tone) {
        (PostCause::Cancelled, _) => "leaving",
        (PostCause::Lost { .. }, _) => "lost",
        (_, Sentiment::Neutral) => "neutral",
        (PostCause::Improved | PostCause::Declined | PostCause::General, Sentiment::Positive) => "positive",
        (PostCause::Improved | PostCause::Declined | PostCause::General, Sentiment::Negative) => "grumble",
        (_, Sentiment::Positive) => "forgiving",
        (_, Sentiment::Negative) => "trouble",
    }
}

/// Returns the rule name that the grammar uses for the subject of a post.
fn situation(opinion: &Opinion) -> &'static str {
    match opinion.cause {
        PostCause::Overload => "overload",
        PostCause::Outage => "outage",
        PostCause::Issue => "issue",
        PostCause::Quota => "quota",
        PostCause::Cancelled if opinion.theme == Theme::Price => "cancelled_price",
        PostCause::Cancelled => "cancelled_quality",
        PostCause::Lost { .. } => "lost",
        PostCause::Improved | PostCause::Declined | PostCause::General => theme_id(opinion.theme),
    }
}

fn theme_id(theme: Theme) -> &'static str {
    match theme {
        Theme::Price => "price",
        Theme::Quality => "quality",
        Theme::Rivals => "rivals",
        Theme::Service => "service",
        Theme::Support => "support",
        Theme::Limits => "limits",
        Theme::Ads => "ads",
        Theme::Progress => "progress",
        Theme::Habit => "habit",
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use novamind_world::customers::persona::PersonaPicks;
    use novamind_world::events::{CustomerProblems, ThreadKind};
    use novamind_world::identifiers::{Group, Plan};

    pub(in crate::posts) fn author(group: Group) -> PostAuthor {
        PostAuthor { customer: 9, group, n: 4, persona: PersonaPicks::default(), enterprise_seats: 0 }
    }

    pub(in crate::posts) fn opinion(cause: PostCause, theme: Theme) -> Opinion {
        Opinion {
            cause,
            customer_problems: CustomerProblems::default(),
            theme,
            days_subscribed: 80,
            plan: Some(Plan::B),
            price: 25.0,
            seats: 140,
            waiting_days: 4,
            downtime_minutes: 30,
        }
    }

    const THEMES: [Theme; 9] = [
        Theme::Price,
        Theme::Quality,
        Theme::Rivals,
        Theme::Service,
        Theme::Support,
        Theme::Limits,
        Theme::Ads,
        Theme::Progress,
        Theme::Habit,
    ];
    const TONES: [Sentiment; 3] = [Sentiment::Positive, Sentiment::Neutral, Sentiment::Negative];

    /// Returns every combination of opinion and tone that can occur.
    pub(in crate::posts) fn situations() -> Vec<(Opinion, Sentiment)> {
        let mut list = Vec::new();
        for tone in TONES {
            for cause in [PostCause::Overload, PostCause::Outage, PostCause::Issue, PostCause::Quota] {
                list.push((opinion(cause, Theme::Quality), tone));
            }
            for cause in [PostCause::General, PostCause::Improved, PostCause::Declined] {
                list.extend(THEMES.map(|theme| (opinion(cause, theme), tone)));
            }
        }
        for theme in [Theme::Price, Theme::Quality] {
            list.push((opinion(PostCause::Cancelled, theme), Sentiment::Negative));
        }
        for unanswered in [false, true] {
            let cause = PostCause::Lost { thread: ThreadKind::NewLead, unanswered };
            list.push((
                Opinion { plan: None, price: 0.0, ..opinion(cause, Theme::Support) },
                Sentiment::Negative,
            ));
        }
        list
    }

    #[test]
    fn every_situation_has_posts_for_every_group() {
        let params = Params::bundled();
        for group in Group::all() {
            for (mut opinion, tone) in situations() {
                // A minimal context, without optional values.
                (opinion.plan, opinion.price, opinion.waiting_days, opinion.downtime_minutes) =
                    (None, 0.0, 0, 0);
                let context = context(&author(group), &opinion, tone, &params);
                let key = format!("fact.{}.{}", situation(&opinion), tone_id(tone));
                assert!(GRAMMAR.has_rule(&key), "{key}");
                assert!(GRAMMAR.has_rule(&format!("form.{}", post_form(opinion.cause, tone))));
                let facts = GRAMMAR.count_phrasings(&key, &context);
                let phrasings = GRAMMAR.count_phrasings("post", &context);
                assert!(
                    facts >= 2 && phrasings >= 300,
                    "{group} {key}: {facts} facts, {phrasings} phrasings"
                );
                for kind in ["doing", "audience", "stake", "gain"] {
                    assert!(GRAMMAR.has_rule(&format!("{kind}.{group}")), "{kind} of {group}");
                }
            }
        }
    }

    #[test]
    fn context_names_are_declared_in_the_grammar() {
        let params = Params::bundled();
        let context = context(
            &author(Group::parse("E1").expect("a group")),
            &opinion(PostCause::General, Theme::Price),
            Sentiment::Negative,
            &params,
        );
        for name in context.names() {
            assert!(GRAMMAR.declares(name), "{name}");
        }
    }
}
