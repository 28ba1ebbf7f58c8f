//! Messages of enterprises, and the system message that confirms a deal
//! (docs/mechanics/market/social/texts.md#messages-of-enterprises).
//!
//! A message consists of an opening, a core with the facts, and an ending that fits the decision style of the
//! enterprise. The number of the message selects the pair of opening and core. The stride between consecutive messages
//! is coprime to the number of pairs, so a pair repeats only after all other pairs have been used. Every situation has
//! more than sixty pairs. A message reveals nothing that the offers and the profile do not show.

mod phrases;

use phrases::{
    ACCEPTANCE, DOWNGRADE, ENDINGS, FAR_COUNTER_OFFER, LATE_ENDINGS, MODERATE_COUNTER_OFFER,
    NEAR_COUNTER_OFFER, Phrases, THREAT, UPGRADE,
};

use novamind_base::formatting::grouped_number;
use novamind_world::events::{ThreadTurn, TurnContent};
use novamind_world::identifiers::Group;
use novamind_world::params::Personas;

/// Distance between the pairs of consecutive messages in the list of all pairs of opening and core.
const STRIDE: u32 = 31;

/// Gaps between offered and asked price, as shares of the offered price. A gap below the first value is near; a gap
/// above the second value is far.
const PRICE_GAPS: (f64, f64) = (0.10, 0.35);

/// First turn in which an enterprise can mention that the negotiation is long.
const LONG_NEGOTIATION_TURN: u32 = 6;

/// Returns the text of a turn, or an empty string for a turn without text.
pub fn message(turn: &ThreadTurn, personas: &Personas) -> String {
    match &turn.content {
        TurnContent::Opening | TurnContent::Offer(_) | TurnContent::Rejection => String::new(),
        TurnContent::Closing(offering) => format!(
            "Deal closed with customer {}: plan {} at {} per seat and month, {} seats.",
            turn.customer,
            offering.plan,
            format_price(offering.price),
            grouped_number(f64::from(turn.seats), 0)
        ),
        TurnContent::Threat => fill_phrases(turn, &THREAT, &[], personas),
        TurnContent::PlanChangeRequest { from, to } => {
            let seats = grouped_number(f64::from(turn.seats), 0);
            let facts = [("{from}", from.to_string()), ("{plan}", to.to_string()), ("{seats}", seats)];
            fill_phrases(turn, if to > from { &UPGRADE } else { &DOWNGRADE }, &facts, personas)
        }
        TurnContent::Counter { asked, offered } => {
            let facts = [("{plan}", asked.plan.to_string()), ("{price}", format_price(asked.price))];
            fill_phrases(turn, phrases_for_gap(asked.price, *offered), &facts, personas)
        }
        TurnContent::Acceptance(offering) => {
            let facts = [("{plan}", offering.plan.to_string()), ("{price}", format_price(offering.price))];
            fill_phrases(turn, &ACCEPTANCE, &facts, personas)
        }
    }
}

fn format_price(price: f64) -> String {
    format!("${}", grouped_number(price, 2))
}

/// Returns the phrases for the gap between the asked and the offered price.
fn phrases_for_gap(asked: f64, offered: f64) -> &'static Phrases {
    let gap = if offered > 0.0 { (offered - asked) / offered } else { 0.0 };
    match gap {
        _ if gap < PRICE_GAPS.0 => &NEAR_COUNTER_OFFER,
        _ if gap <= PRICE_GAPS.1 => &MODERATE_COUNTER_OFFER,
        _ => &FAR_COUNTER_OFFER,
    }
}

fn fill_phrases(
    turn: &ThreadTurn,
    phrases: &Phrases,
    facts: &[(&str, String)],
    personas: &Personas,
) -> String {
    let pairs = (phrases.openings.len() * phrases.cores.len()) as u32;
    let pair = (u64::from(turn.message) * u64::from(STRIDE) % u64::from(pairs)) as usize;
    let (opening, core) = (pair / phrases.cores.len(), pair % phrases.cores.len());
    let mut text = phrases.cores[core].to_owned();
    for (name, value) in facts {
        text = text.replace(name, value);
    }
    format!("{} {text} {}", phrases.openings[opening], closing_sentence(turn, personas))
}

/// Returns a closing sentence about the decision style, the primary concern, or the length of the negotiation.
fn closing_sentence(turn: &ThreadTurn, personas: &Personas) -> String {
    let profile = EnterpriseProfile::from_turn(turn, personas);
    let settled = matches!(turn.content, TurnContent::Acceptance(_));
    let choice = (turn.message / 3 + turn.customer) as usize;
    if !settled && turn.number >= LONG_NEGOTIATION_TURN && choice.is_multiple_of(2) {
        return LATE_ENDINGS[choice / 2 % LATE_ENDINGS.len()].to_owned();
    }
    let endings = &ENDINGS[DecisionStyle::from_words(profile.decision) as usize];
    let pool = if settled { &endings.after_agreement } else { &endings.open };
    pool[choice % pool.len()]
        .replace("{concern}", &profile.concern.replace('-', " "))
        .replace("{culture}", &with_article(profile.culture))
}

fn with_article(word: &str) -> String {
    let vowel = word.chars().next().is_some_and(|letter| "aeiouAEIOU".contains(letter));
    format!("{} {word}", if vowel { "an" } else { "a" })
}

/// Profile words of an enterprise, as in the customers table.
struct EnterpriseProfile<'a> {
    culture: &'a str,
    decision: &'a str,
    concern: &'a str,
}

impl<'a> EnterpriseProfile<'a> {
    fn from_turn(turn: &ThreadTurn, personas: &'a Personas) -> EnterpriseProfile<'a> {
        let group_persona = &personas.group[Group::index(turn.group)];
        let [.., culture, decision, concern] = turn.persona.0;
        let word = |list: &'a [String], at: u8, otherwise: &'a str| {
            list.get(usize::from(at)).map_or(otherwise, String::as_str)
        };
        EnterpriseProfile {
            culture: word(&group_persona.culture, culture, "practical"),
            decision: word(&group_persona.decision_style, decision, "pragmatic"),
            concern: word(&group_persona.primary_concern, concern, "value"),
        }
    }
}

/// The decision style of an enterprise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(usize)]
enum DecisionStyle {
    Quick,
    Numbers,
    Committee,
    Careful,
    Partner,
}

impl DecisionStyle {
    /// Returns the decision style that the words of a profile describe.
    fn from_words(decision: &str) -> DecisionStyle {
        let has = |words: &[&str]| words.iter().any(|word| decision.contains(word));
        if has(&["committee-light", "fast", "quick", "pragmatic", "field-tested"]) {
            DecisionStyle::Quick
        } else if has(&["committee", "board", "senate", "consensus", "panel", "RFP"]) {
            DecisionStyle::Committee
        } else if has(&["ROI", "cost", "budget", "benchmark", "actuarial", "bid", "justified", "bakeoff"]) {
            DecisionStyle::Numbers
        } else if has(&["strategic", "relationship", "executive", "long-cycle", "champion", "partner"]) {
            DecisionStyle::Partner
        } else {
            DecisionStyle::Careful
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::{BTreeSet, VecDeque};

    use super::*;
    use novamind_world::customers::persona::PersonaPicks;
    use novamind_world::events::{Offering, Sender, ThreadKind};
    use novamind_world::identifiers::Plan;
    use novamind_world::params::Params;

    fn turn_with_content(message: u32, content: TurnContent) -> ThreadTurn {
        ThreadTurn {
            message,
            thread: 1,
            customer: 40 + message % 7,
            group: Group::parse("E2").expect("a group"),
            persona: PersonaPicks([0, 0, 0, 0, (message % 5) as u8, (message / 5 % 5) as u8, 2]),
            kind: ThreadKind::NewLead,
            number: 2 + message % 9,
            sender: Sender::Customer,
            seats: 1200,
            content,
        }
    }

    fn situations() -> Vec<TurnContent> {
        let offering = Offering { plan: Plan::B, price: 31.5 };
        vec![
            TurnContent::Threat,
            TurnContent::PlanChangeRequest { from: Plan::A, to: Plan::C },
            TurnContent::PlanChangeRequest { from: Plan::C, to: Plan::B },
            TurnContent::Counter { asked: offering, offered: 33.0 },
            TurnContent::Counter { asked: offering, offered: 40.0 },
            TurnContent::Counter { asked: offering, offered: 90.0 },
            TurnContent::Acceptance(offering),
        ]
    }

    #[test]
    fn sixty_consecutive_messages_differ() {
        let personas = Params::bundled().personas;
        for content in situations() {
            // All messages have the same situation, so repetition is most likely.
            let mut recent: VecDeque<String> = VecDeque::new();
            let mut all = BTreeSet::new();
            for number in 0..500 {
                let text = message(&turn_with_content(number, content.clone()), &personas);
                assert!(!recent.contains(&text), "{text}");
                all.insert(text.clone());
                recent.push_back(text);
                if recent.len() > 60 {
                    recent.pop_front();
                }
            }
            assert!(all.len() >= 150, "{content:?}: {} texts", all.len());
        }
    }

    #[test]
    fn stride_visits_all_phrase_pairs() {
        for phrases in [
            &THREAT,
            &UPGRADE,
            &DOWNGRADE,
            &NEAR_COUNTER_OFFER,
            &MODERATE_COUNTER_OFFER,
            &FAR_COUNTER_OFFER,
            &ACCEPTANCE,
        ] {
            let pairs = (phrases.openings.len() * phrases.cores.len()) as u32;
            assert!(pairs > 60);
            let visited: BTreeSet<u32> = (0..pairs).map(|message| message * STRIDE % pairs).collect();
            assert_eq!(visited.len(), pairs as usize);
            let sentences: BTreeSet<&str> = phrases.openings.iter().chain(phrases.cores).copied().collect();
            assert_eq!(
                sentences.len(),
                phrases.openings.len() + phrases.cores.len(),
                "a phrase is duplicated"
            );
        }
    }

    #[test]
    fn messages_contain_their_facts_without_placeholders() {
        let personas = Params::bundled().personas;
        for (content, facts) in situations().into_iter().zip([
            &[][..],
            &["plan c", "1,200"],
            &["plan c", "plan b", "1,200"],
            &["plan b", "$31.50"],
            &["plan b", "$31.50"],
            &["plan b", "$31.50"],
            &["plan b", "$31.50"],
        ]) {
            for number in 0..400 {
                let text = message(&turn_with_content(number, content.clone()), &personas);
                assert!(!text.contains(['{', '}']) && !text.contains("  "), "{text}");
                let lowercase = text.to_lowercase();
                assert!(facts.iter().all(|fact| lowercase.contains(fact)), "{facts:?} in {text}");
                assert_eq!(text, text.trim());
                assert!(text.ends_with(['.', '?', '!']), "{text}");
                if facts.is_empty() {
                    assert!(!text.contains(char::is_numeric), "{text}");
                }
            }
        }
    }

    #[test]
    fn player_turns_and_openings_have_no_text() {
        let personas = Params::bundled().personas;
        let offering = Offering { plan: Plan::A, price: 28.0 };
        for content in [TurnContent::Opening, TurnContent::Rejection, TurnContent::Offer(vec![offering])] {
            assert_eq!(message(&turn_with_content(3, content), &personas), "");
        }
        assert_eq!(
            message(&turn_with_content(3, TurnContent::Closing(offering)), &personas),
            "Deal closed with customer 43: plan A at $28.00 per seat and month, 1,200 seats."
        );
    }

    #[test]
    fn every_profile_has_a_decision_style() {
        let personas = Params::bundled().personas;
        let styles = personas.group.iter().flat_map(|group| &group.decision_style);
        let manners: BTreeSet<usize> =
            styles.map(|style| DecisionStyle::from_words(style) as usize).collect();
        assert_eq!(manners.len(), ENDINGS.len());
        assert_eq!(DecisionStyle::from_words("committee-heavy"), DecisionStyle::Committee);
        assert_eq!(DecisionStyle::from_words("ROI-focused"), DecisionStyle::Numbers);
        assert_eq!(DecisionStyle::from_words("HIPAA-gated"), DecisionStyle::Careful);
        assert_eq!(
            (with_article("audit-ready"), with_article("lean")),
            ("an audit-ready".into(), "a lean".into())
        );
    }
}
