//! Tests that follow threads from their first turn to their end.

use super::test_kit::NegotiationKit;
use super::{EnterpriseDayResult, EnterpriseStatus};
use crate::customers::columns::Subscriber;
use crate::events::{
    EndCause, LossCause, Notice, Offering, Sender, SubscriptionStatus, ThreadKind, TurnContent,
};
use crate::identifiers::Plan;

/// Returns a kit with a lead of day 0 that replies after `delay` days and accepts at most `turns` turns.
fn kit_with_lead(delay: f64, turns: u32) -> NegotiationKit {
    let mut kit = NegotiationKit::new(0);
    // Without a first-impression factor, the enterprise does not misjudge the quality.
    kit.params.quality.initial_decision_noise_min = 1.0;
    kit.params.quality.initial_decision_noise_max = 1.0;
    let company = kit.reference_enterprise(delay, turns);
    kit.enterprise.open_lead_thread(0, company, &mut kit.facts);
    kit
}

fn run_days(kit: &mut NegotiationKit, days: std::ops::RangeInclusive<u32>) -> Vec<EnterpriseDayResult> {
    days.map(|day| kit.run_day(day)).collect()
}

fn senders_and_turn_numbers(kit: &NegotiationKit) -> Vec<(Sender, u32)> {
    kit.facts.turns.iter().map(|turn| (turn.sender, turn.number)).collect()
}

#[test]
fn accepted_offer_activates_the_lead() {
    let mut kit = kit_with_lead(3.0, 6);
    assert_eq!(senders_and_turn_numbers(&kit), [(Sender::System, 0)]);
    let messages = kit.send_offer(&[(Plan::B, 35.0)]);
    assert_eq!((messages[0].reply_day, messages[0].turn, messages[0].relationship), (3, 1, None));
    assert_eq!(senders_and_turn_numbers(&kit), [(Sender::Agent, 1)]);
    assert_eq!(kit.facts.turns[0].seats, 1);
    assert!(run_days(&mut kit, 1..=2).iter().all(|day| day.new_seats == 0));
    assert!(kit.facts.turns.is_empty());
    assert_eq!(kit.run_day(3).new_seats, 100);
    assert_eq!(senders_and_turn_numbers(&kit), [(Sender::Customer, 2), (Sender::System, 3)]);
    let offering = Offering { plan: Plan::B, price: 35.0 };
    assert_eq!(kit.facts.turns[0].content, TurnContent::Acceptance(offering));
    assert_eq!(kit.facts.notices, [Notice::DealWon { price: 35.0 }]);
    let deal = kit.facts.deals[0];
    assert_eq!((deal.activated, deal.contract_end_day), (true, Some(33)));
    assert_eq!((deal.agent_turns, deal.days, deal.seats), (1, 3, 100));
    let row = kit.customers.groups[kit.group].subscriber(1).expect("a subscriber");
    assert_eq!((row.start_day, row.billing_day, row.billed_once), (3, 0, false));
    assert_eq!((row.listed_price, row.promotion, row.effective_price), (35.0, 0.0, 35.0));
    assert!((row.relationship - 0.6).abs() < 1e-12 && row.usage_rate > 0.0 && row.required > 0.0);
    assert!(kit.enterprise.threads.is_empty());
    assert_eq!(kit.enterprise.companies[0].status, EnterpriseStatus::Subscriber);
}

#[test]
fn lead_is_lost_by_silence_or_timeout() {
    let mut kit = kit_with_lead(3.0, 6);
    run_days(&mut kit, 1..=6);
    assert!(kit.facts.endings.is_empty());
    kit.run_day(7);
    let ending = kit.facts.endings[0];
    assert_eq!(
        (ending.day, ending.status, ending.cause),
        (7, SubscriptionStatus::Lost, EndCause::LeadTimeout)
    );
    assert_eq!(kit.facts.notices, [Notice::LeadLostByTimeout { days: 7 }]);
    kit.run_day(8);
    assert!(kit.facts.notices.is_empty() && kit.enterprise.threads.is_empty());
    assert!(kit.enterprise.companies.is_empty());

    let mut kit = kit_with_lead(3.0, 2);
    kit.send_offer(&[(Plan::B, 59.0)]);
    run_days(&mut kit, 1..=3);
    assert_eq!(kit.facts.notices, [Notice::CounterOffer { customer: 2 }]);
    kit.run_day(4);
    kit.send_offer(&[(Plan::B, 59.0)]);
    run_days(&mut kit, 5..=7);
    assert_eq!(kit.facts.notices, [Notice::LeadSilent]);
    assert_eq!((kit.facts.endings[0].day, kit.facts.endings[0].cause), (7, EndCause::LeadSilent));
    for day in 8..=14 {
        kit.run_day(day);
        // The counter-offer of day 3 is the newest turn that is not dead.
        let notice = Notice::LeadLossRepeated {
            days: day - 3,
            customer: 2,
            cause: LossCause::Silence,
            message_day: 4,
        };
        let expected = if day < 10 { vec![] } else { vec![notice] };
        assert_eq!(kit.facts.notices, expected, "day {day}");
        assert!(kit.facts.endings.is_empty() && kit.facts.turns.is_empty());
    }
    assert!(kit.enterprise.open_threads().newest(2).is_none());
}

#[test]
fn dead_threads_do_not_reappear_if_disabled() {
    let mut kit = kit_with_lead(3.0, 2);
    kit.params.fidelity.reappearing_threads = false;
    kit.send_offer(&[(Plan::B, 59.0)]);
    run_days(&mut kit, 1..=4);
    kit.send_offer(&[(Plan::B, 59.0)]);
    run_days(&mut kit, 5..=7);
    assert_eq!(kit.facts.notices, [Notice::LeadSilent]);
    assert!(kit.enterprise.threads.is_empty() && kit.enterprise.companies.is_empty());
    run_days(&mut kit, 8..=12);
    assert!(kit.facts.notices.is_empty());
}

/// Returns a kit with a subscriber whose price is too high from day 4 on.
fn kit_with_unhappy_subscriber() -> NegotiationKit {
    let mut kit = NegotiationKit::new(3);
    kit.subscribe(6, |row| (row.listed_price, row.relationship) = (59.0, 0.6));
    kit.product.shared_bonus = 0.4;
    kit
}

#[test]
fn unanswered_threat_loses_the_subscriber() {
    let mut kit = kit_with_unhappy_subscriber();
    kit.run_day(4);
    assert_eq!(senders_and_turn_numbers(&kit), [(Sender::System, 0), (Sender::Customer, 1)]);
    assert_eq!(kit.facts.turns[1].content, TurnContent::Threat);
    assert_eq!(kit.facts.notices, [Notice::ChurnThreat { customer: 2 }]);
    let thread = kit.enterprise.open_threads().newest(2).expect("an open thread").number;
    kit.facts.start_day(4);
    kit.enterprise.reject_threads(&[thread], 4, &mut kit.facts);
    assert_eq!(senders_and_turn_numbers(&kit), [(Sender::Agent, 2)]);
    assert!(kit.facts.endings.is_empty() && kit.enterprise.open_threads().newest(2).is_none());
    // On the next day the enterprise opens a new thread, and the player does not answer.
    let opened = kit.run_day(5);
    assert!(opened.suspended.is_empty(), "a thread suspends payment from the day after");
    assert_eq!(kit.enterprise.threads[0].kind, ThreadKind::ChurnPrevention);
    for run in run_days(&mut kit, 6..=11) {
        assert_eq!(run.suspended.iter().copied().collect::<Vec<u32>>(), [2]);
    }
    assert_eq!(kit.customers.groups[kit.group].active_count(), 1);
    let reputation = kit.reputation.get(kit.group);
    let lost = kit.run_day(12);
    let ending = kit.facts.endings[0];
    assert_eq!((ending.day, ending.status), (33, SubscriptionStatus::Cancelled));
    assert_eq!(ending.cause, EndCause::PriceSensitivity);
    assert_eq!(kit.customers.groups[kit.group].active_count(), 0);
    let company = kit.enterprise.enterprise_customer(2).expect("its thread can still trigger").clone();
    let relationship = company.row(&kit.customers).expect("a row").relationship;
    assert!((relationship - 0.3).abs() < 1e-12, "{relationship}");
    assert_eq!((lost.lost[0].days_subscribed, lost.lost[0].seats), (Some(9), 100));
    // When the thread triggers again on later days, only the reputation changes.
    let mut before = kit.reputation.get(kit.group);
    assert!(before < reputation);
    for day in 13..=16 {
        let day_result = kit.run_day(day);
        assert_eq!((day_result.lost.len(), day_result.lost[0].days_subscribed), (1, None));
        assert!(kit.facts.endings.is_empty() && kit.facts.notices.is_empty());
        let damage = before - kit.reputation.get(kit.group);
        assert!((9.375e-5..2.8125e-4).contains(&damage), "{damage}");
        before = kit.reputation.get(kit.group);
    }
}

#[test]
fn lost_subscriber_damages_the_reputation_once_without_reappearing_threads() {
    let mut kit = kit_with_unhappy_subscriber();
    kit.params.fidelity.reappearing_threads = false;
    run_days(&mut kit, 4..=10);
    assert_eq!(kit.run_day(11).lost.len(), 1, "seven days after the threat of day 4");
    assert_eq!((kit.facts.endings.len(), kit.facts.endings[0].cause), (1, EndCause::PriceSensitivity));
    let reputation = kit.reputation.get(kit.group);
    for day in 12..=16 {
        assert!(kit.run_day(day).lost.is_empty(), "day {day}");
        assert_eq!(kit.reputation.get(kit.group), reputation, "day {day}");
    }
    assert!(kit.enterprise.threads.is_empty() && kit.enterprise.companies.is_empty());
}

#[test]
fn threat_suspends_payment_until_a_deal() {
    let mut kit = kit_with_unhappy_subscriber();
    kit.run_day(29);
    let suspended = |run: &EnterpriseDayResult| run.suspended.contains(&2);
    assert!(suspended(&kit.run_day(30)));
    kit.product.shared_bonus = 0.6;
    kit.send_offer(&[(Plan::B, 30.0)]);
    let runs = run_days(&mut kit, 31..=33);
    assert!(runs.iter().all(suspended), "including the day on which it is settled");
    assert_eq!(kit.facts.notices, [Notice::DealWon { price: 30.0 }]);
    let deal = kit.facts.deals[0];
    assert_eq!(
        (deal.activated, deal.contract_end_day, deal.kind),
        (false, Some(63), ThreadKind::ChurnPrevention)
    );
    let row = kit.customers.groups[kit.group].subscriber(1).expect("a subscriber");
    assert_eq!((row.listed_price, row.effective_price, row.start_day), (30.0, 30.0, 3));
    assert!((row.relationship - 0.6).abs() < 1e-12, "only new deals raise the relationship");
    assert!(!suspended(&kit.run_day(34)));
}

#[test]
fn promotion_lowers_the_deal_price() {
    let mut kit = kit_with_lead(2.0, 6);
    kit.settings.promotion.global = 4.0;
    kit.send_offer(&[(Plan::B, 35.0)]);
    run_days(&mut kit, 1..=2);
    let row = kit.customers.groups[kit.group].subscriber(1).expect("a subscriber");
    assert_eq!((row.listed_price, row.promotion, row.effective_price), (35.0, 4.0, 31.0));
    assert_eq!(row.effective_price * row.seats, 3100.0);
}

#[test]
fn failed_renegotiation_loses_the_customer() {
    let mut kit = NegotiationKit::new(3);
    kit.subscribe(6, |row| row.relationship = 0.5);
    kit.run_day(4);
    assert!(kit.facts.turns.is_empty(), "it is satisfied");
    let messages = kit.send_offer(&[(Plan::A, 58.0)]);
    assert_eq!((messages[0].starts_thread, messages[0].turn, messages[0].reply_day), (true, 0, 7));
    assert_eq!((kit.facts.turns[0].seats, kit.facts.turns[0].kind), (100, ThreadKind::Renegotiation));
    // The quality of the product is below the required quality at every price.
    kit.product.shared_bonus = 0.1;
    kit.morning.product.0.iter_mut().for_each(|product| *product = 0.3);
    let runs = run_days(&mut kit, 5..=7);
    assert!(runs[2].lost[0].kind == ThreadKind::Renegotiation);
    assert_eq!(kit.facts.endings[0].cause, EndCause::QualityChange);
    assert_eq!(kit.facts.endings[0].day, 7);
    // The thread has only one turn, which is dead, so the thread does not reappear.
    assert!(kit.enterprise.threads.is_empty() && kit.enterprise.companies.is_empty());
    assert!(kit.run_day(20).lost.is_empty());
}

#[test]
fn repeated_offers_use_turns_and_only_the_newest_is_answered() {
    let mut kit = kit_with_lead(3.0, 3);
    kit.send_offer(&[(Plan::B, 59.0)]);
    let offer_messages = kit.send_offer(&[(Plan::B, 20.0)]);
    assert_eq!((offer_messages[0].turn, offer_messages[0].relationship), (2, None));
    run_days(&mut kit, 1..=3);
    assert_eq!(senders_and_turn_numbers(&kit), [(Sender::Customer, 3), (Sender::System, 4)]);
    let mut kit = kit_with_lead(3.0, 2);
    kit.send_offer(&[(Plan::B, 59.0)]);
    kit.send_offer(&[(Plan::B, 20.0)]);
    run_days(&mut kit, 1..=3);
    // At turn 2 of 2 the enterprise never replies, regardless of the offer. The reply to the first message is due too,
    // and the enterprise does not send it.
    assert_eq!(kit.facts.notices.first(), Some(&Notice::LeadSilent));
}

#[test]
fn late_reply_lowers_relationship_once() {
    let mut kit = kit_with_lead(3.0, 9);
    kit.send_offer(&[(Plan::B, 59.0)]);
    run_days(&mut kit, 1..=7);
    let messages = kit.send_offer(&[(Plan::B, 44.0)]);
    // The counter-offer arrived on day 3. The player answers after four days, of which three are late.
    let relationship = messages[0].relationship.expect("a late answer");
    assert!((relationship - 0.44).abs() < 1e-12, "{relationship}");
    assert_eq!(
        kit.send_offer(&[(Plan::B, 44.0)])[0].relationship,
        None,
        "a second message has no further penalty"
    );
    let row =
        kit.enterprise.enterprise_customer(2).and_then(|company| company.row(&kit.customers)).expect("a row");
    assert!((row.relationship - 0.44).abs() < 1e-12);
}

#[test]
fn parallel_renegotiations_are_answered_separately() {
    let mut kit = NegotiationKit::new(3);
    kit.subscribe(6, |row| row.relationship = 0.6);
    kit.run_day(4);
    let proposal =
        super::messages::OfferDraft { customer: 2, offerings: vec![Offering { plan: Plan::B, price: 20.0 }] };
    let twice = [proposal.clone(), proposal];
    let offer_messages = kit.enterprise.resolve_offers(&twice, 4, &kit.customers, &kit.params, &kit.streams);
    assert_eq!(
        (offer_messages[0].thread + 1, offer_messages[1].starts_thread),
        (offer_messages[1].thread, true)
    );
    kit.facts.start_day(4);
    kit.enterprise.send_offers(&offer_messages, 4, &mut kit.customers, &mut kit.facts);
    run_days(&mut kit, 5..=7);
    assert_eq!(kit.facts.deals.len(), 2);
    assert_eq!(kit.customers.groups[kit.group].active_count(), 1);
    assert!(kit.enterprise.threads.is_empty());
}

#[test]
fn two_offers_in_one_call_share_a_turn_number() {
    let mut kit = kit_with_lead(3.0, 9);
    let proposal =
        super::messages::OfferDraft { customer: 2, offerings: vec![Offering { plan: Plan::B, price: 59.0 }] };
    kit.send_offer(&[(Plan::B, 59.0)]);
    run_days(&mut kit, 1..=7);
    let offer_messages = kit.enterprise.resolve_offers(
        &[proposal.clone(), proposal],
        7,
        &kit.customers,
        &kit.params,
        &kit.streams,
    );
    let relationship: Vec<f64> = offer_messages.iter().filter_map(|message| message.relationship).collect();
    assert!((relationship[0] - 0.44).abs() < 1e-12 && (relationship[1] - 0.38).abs() < 1e-12);
    kit.facts.start_day(7);
    kit.enterprise.send_offers(&offer_messages, 7, &mut kit.customers, &mut kit.facts);
    assert_eq!(senders_and_turn_numbers(&kit), [(Sender::Agent, 3), (Sender::Agent, 3)]);
    let replies: Vec<Option<u32>> =
        kit.enterprise.threads[0].turns[3..].iter().map(|t| t.reply_day).collect();
    assert_eq!(replies, [None, Some(10)]);
}

#[test]
fn rejected_lead_is_lost() {
    let mut kit = kit_with_lead(3.0, 9);
    kit.facts.start_day(0);
    let thread = kit.enterprise.open_threads().newest(2).expect("the lead's thread").number;
    kit.enterprise.reject_threads(&[thread, thread, 77], 0, &mut kit.facts);
    assert_eq!((senders_and_turn_numbers(&kit), kit.facts.endings.len()), (vec![(Sender::Agent, 1)], 1));
    assert_eq!(kit.facts.endings[0].cause, EndCause::LeadRejected);
    assert!(kit.enterprise.threads.is_empty() && kit.enterprise.companies.is_empty());
}

#[test]
fn threatening_customer_with_two_turns_always_leaves() {
    let mut kit = kit_with_unhappy_subscriber();
    kit.enterprise.companies[0].negotiator.max_negotiation_turns = 2;
    kit.run_day(4);
    kit.send_offer(&[(Plan::B, 1.0)]);
    let runs = run_days(&mut kit, 5..=7);
    assert_eq!(runs[2].lost.len(), 1);
    assert_eq!(kit.facts.endings[0].day, 7);
}

#[test]
fn free_and_negative_prices_are_accepted() {
    let mut kit = kit_with_lead(2.0, 6);
    kit.send_offer(&[(Plan::B, -5.0)]);
    run_days(&mut kit, 1..=2);
    let row: Subscriber = kit.customers.groups[kit.group].subscriber(1).expect("a subscriber");
    assert_eq!((row.listed_price, row.effective_price), (-5.0, 0.0));
}
