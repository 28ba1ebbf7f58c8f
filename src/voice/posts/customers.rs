//! Posts of customers about their experience.

use std::sync::LazyLock;

use super::words::{self, Register};
use crate::grammar::{Chooser, Context, Grammar};
use novamind_world::events::{Cause, Opinion, PostAuthor, Sentiment, Theme};
use novamind_world::params::Params;

static GRAMMAR: LazyLock<Grammar> = LazyLock::new(|| {
    let sources = [
        include_str!("../../../assets/voice/customers.toml"),
        include_str!("../../../assets/voice/groups.toml"),
    ];
    Grammar::read_all(&sources).expect("the bundled grammars are valid")
});

/// Days after which an author is no longer new, and after which they are a long-term customer.
const SETTLED: u32 = 30;
const VETERAN: u32 = 120;
/// One in this many casual authors writes without capitals.
const WITHOUT_CAPITALS: u32 = 9;

pub(super) fn draft(context: &Context, choose: Chooser<'_>) -> String {
    GRAMMAR.write("post", context, choose)
}

/// Returns whether an author writes without capitals, which is constant for each author.
pub(super) fn without_capitals(author: &PostAuthor) -> bool {
    Register::of(Some(author.group)) == Register::Casual && author.n.is_multiple_of(WITHOUT_CAPITALS)
}

/// Returns the grammar context of a post.
pub(super) fn context(author: &PostAuthor, opinion: &Opinion, tone: Sentiment, params: &Params) -> Context {
    let company = author.group.is_enterprise();
    let person = |individual: &'static str, of_company: &'static str| {
        if company { of_company } else { individual }
    };
    let tone_id = tone_id(tone);
    let situation = situation(opinion);
    let register = Register::of(Some(author.group)).id();
    let also = |trouble: bool, own: Cause| trouble && opinion.cause != own;
    let days = opinion.days_subscribed;
    let kind = match opinion.cause {
        Cause::Lost { thread, .. } => Some(thread.id()),
        _ => None,
    };
    Context::default()
        .with("group", author.group.id())
        .with("key", format!("{situation}.{tone_id}"))
        .with("shape", shape(opinion.cause, tone))
        .with("mood", format!("{register}.{tone_id}"))
        .with("I", person("I", "we"))
        .with("me", person("me", "us"))
        .with("my", person("my", "our"))
        .with("am", person("I'm", "we're"))
        .with("role", words::role(author, params))
        .with("trade", words::trade(author, params))
        .with("since", words::time_span(days))
        .with("per", person("a month", "a seat and month"))
        .maybe("plan", opinion.plan.map(|plan| format!("plan {plan}")))
        .maybe("price", words::price(opinion.price))
        .maybe("waiting", (opinion.waiting_days > 1).then(|| words::time_span(opinion.waiting_days)))
        .maybe("downtime", words::outage_span(opinion.downtime_minutes))
        .maybe("seats", company.then(|| words::seats_roughly(opinion.seats)))
        .tag("new", days <= SETTLED)
        .tag("settled", days > SETTLED && days <= VETERAN)
        .tag("veteran", days > VETERAN)
        .tag("rose", opinion.cause == Cause::Improved)
        .tag("fell", opinion.cause == Cause::Declined)
        .tag("company", company)
        .tag("skilled", words::skilled(author, params))
        .tag("senior", words::senior(author, params))
        .tag("also_down", also(opinion.troubles.outage, Cause::Outage))
        .tag("also_waiting", also(opinion.troubles.issue, Cause::Issue))
        .tag("also_short", also(opinion.troubles.quota, Cause::Quota))
        .tag("unanswered", matches!(opinion.cause, Cause::Lost { unanswered: true, .. }))
        .tag("wanted_to_leave", kind == Some("churn_prevention"))
        .tag("new_terms", kind == Some("renegotiation"))
        .tag("other_plan", kind == Some("plan_change"))
}

fn tone_id(tone: Sentiment) -> &'static str {
    match tone {
        Sentiment::Positive => "positive",
        Sentiment::Neutral => "neutral",
        Sentiment::Negative => "negative",
    }
}

fn shape(cause: Cause, tone: Sentiment) -> &'static str {
    match (cause, tone) {
        (Cause::Cancelled, _) => "leaving",
        (Cause::Lost { .. }, _) => "lost",
        (_, Sentiment::Neutral) => "neutral",
        (Cause::Improved | Cause::Declined | Cause::General, Sentiment::Positive) => "positive",
        (Cause::Improved | Cause::Declined | Cause::General, Sentiment::Negative) => "grumble",
        (_, Sentiment::Positive) => "forgiving",
        (_, Sentiment::Negative) => "trouble",
    }
}

/// Returns the grammar's name for the subject of a post.
fn situation(opinion: &Opinion) -> &'static str {
    match opinion.cause {
        Cause::Overload => "overload",
        Cause::Outage => "outage",
        Cause::Issue => "issue",
        Cause::Quota => "quota",
        Cause::Cancelled if opinion.theme == Theme::Price => "cancelled_price",
        Cause::Cancelled => "cancelled_quality",
        Cause::Lost { .. } => "lost",
        Cause::Improved | Cause::Declined | Cause::General => theme_id(opinion.theme),
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
    use novamind_world::events::{ThreadKind, Troubles};
    use novamind_world::identifiers::{Group, Plan};

    pub(in crate::posts) fn author(group: Group) -> PostAuthor {
        PostAuthor { customer: 9, group, n: 4, persona: PersonaPicks::default(), company: 0 }
    }

    pub(in crate::posts) fn opinion(cause: Cause, theme: Theme) -> Opinion {
        Opinion {
            cause,
            troubles: Troubles::default(),
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

    /// All possible situations with their tones.
    pub(in crate::posts) fn situations() -> Vec<(Opinion, Sentiment)> {
        let mut list = Vec::new();
        for tone in TONES {
            for cause in [Cause::Overload, Cause::Outage, Cause::Issue, Cause::Quota] {
                list.push((opinion(cause, Theme::Quality), tone));
            }
            for cause in [Cause::General, Cause::Improved, Cause::Declined] {
                list.extend(THEMES.map(|theme| (opinion(cause, theme), tone)));
            }
        }
        for theme in [Theme::Price, Theme::Quality] {
            list.push((opinion(Cause::Cancelled, theme), Sentiment::Negative));
        }
        for unanswered in [false, true] {
            let cause = Cause::Lost { thread: ThreadKind::NewLead, unanswered };
            list.push((
                Opinion { plan: None, price: 0.0, ..opinion(cause, Theme::Support) },
                Sentiment::Negative,
            ));
        }
        list
    }

    #[test]
    fn every_situation_has_its_words_for_every_group() {
        let params = Params::shipped();
        for group in Group::all() {
            for (mut opinion, tone) in situations() {
                // The minimal context without optional values.
                (opinion.plan, opinion.price, opinion.waiting_days, opinion.downtime_minutes) =
                    (None, 0.0, 0, 0);
                let context = context(&author(group), &opinion, tone, &params);
                let key = format!("fact.{}.{}", situation(&opinion), tone_id(tone));
                assert!(GRAMMAR.has(&key), "{key}");
                assert!(GRAMMAR.has(&format!("form.{}", shape(opinion.cause, tone))));
                let facts = GRAMMAR.phrasings(&key, &context);
                let phrasings = GRAMMAR.phrasings("post", &context);
                assert!(
                    facts >= 2 && phrasings >= 300,
                    "{group} {key}: {facts} facts, {phrasings} phrasings"
                );
                for kind in ["doing", "audience", "stake", "gain"] {
                    assert!(GRAMMAR.has(&format!("{kind}.{group}")), "{kind} of {group}");
                }
            }
        }
    }

    #[test]
    fn the_context_uses_no_name_that_the_grammar_does_not_know() {
        let params = Params::shipped();
        let context = context(
            &author(Group::parse("E1").expect("a group")),
            &opinion(Cause::General, Theme::Price),
            Sentiment::Negative,
            &params,
        );
        for name in context.names() {
            assert!(GRAMMAR.knows(name), "{name}");
        }
    }
}
