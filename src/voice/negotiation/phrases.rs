//! Phrases for messages of enterprises. Names in braces are placeholders.

/// Openings and cores of the messages in one situation.
pub(super) struct Phrases {
    pub openings: &'static [&'static str],
    pub cores: &'static [&'static str],
}

/// Closing sentences for one decision style.
pub(super) struct Endings {
    /// Closing sentences during a negotiation.
    pub open: [&'static str; 4],
    /// Closing sentences after an agreement.
    pub after_agreement: [&'static str; 4],
}

const OFFER_OPENINGS: &[&str] = &[
    "Thank you for the offer.",
    "We went through your proposal.",
    "Thanks for coming back to us.",
    "Your figures were on our table this week.",
    "We compared your proposal with our budget.",
    "Our team has looked at what you sent.",
    "We have read your proposal with interest.",
    "Your message has made the rounds here.",
    "We took the time to calculate your offer through.",
];

/// Phrases for a counter-offer close to the offered price.
pub(super) const NEAR_COUNTER_OFFER: Phrases = Phrases {
    openings: OFFER_OPENINGS,
    cores: &[
        "We are nearly there: plan {plan} at {price} per seat for one month is where we see it.",
        "Only a little is missing; we have {price} per seat for plan {plan} in mind, one month at a time.",
        "Plan {plan} fits, the last step is the price: {price} per seat and month.",
        "Could you move slightly, to {price} per seat a month for plan {plan}?",
        "We like plan {plan}; at {price} per seat for a month we would feel comfortable.",
        "Between your figure and ours there is not much: we think of {price} per seat for a month of plan {plan}.",
        "For plan {plan} we had set aside {price} per seat and month, just below your price.",
        "A small concession would help: {price} a seat for one month of plan {plan}.",
    ],
};

/// Phrases for a counter-offer clearly below the offered price.
pub(super) const MODERATE_COUNTER_OFFER: Phrases = Phrases {
    openings: OFFER_OPENINGS,
    cores: &[
        "For plan {plan} we can see {price} per seat for one month, not more at this point.",
        "The price is above what plan {plan} is worth to us; we would pay {price} per seat and month.",
        "Our proposal is plan {plan} at {price} a seat, for a month.",
        "We would rather talk about {price} per seat a month for plan {plan}.",
        "With plan {plan} as it is today, {price} per seat for one month is our figure.",
        "Our calculation for plan {plan} arrives at {price} per seat and month.",
        "To go ahead with plan {plan} we need a price around {price} per seat for a month.",
        "What we get from plan {plan} justifies {price} a seat and month in our eyes.",
    ],
};

/// Phrases for a counter-offer far below the offered price.
pub(super) const FAR_COUNTER_OFFER: Phrases = Phrases {
    openings: OFFER_OPENINGS,
    cores: &[
        "We are far apart: plan {plan} is worth {price} per seat and month to us.",
        "That is well beyond our frame. For a month of plan {plan} we think of {price} per seat.",
        "Frankly, we expected something like {price} a seat for one month of plan {plan}.",
        "At this level we cannot go on; {price} per seat a month for plan {plan} would be another matter.",
        "Your price and our value of plan {plan} do not meet. Ours is {price} per seat for one month.",
        "Plan {plan} would have to come down a long way, to {price} per seat and month.",
        "Nobody here would sign that. We can defend {price} a seat for a month of plan {plan}.",
        "For plan {plan} in its present state we see no more than {price} per seat and month.",
    ],
};

/// Phrases for accepting an offer.
pub(super) const ACCEPTANCE: Phrases = Phrases {
    openings: &[
        "Good news from our side.",
        "That works for us.",
        "We have an agreement.",
        "Thank you, we accept.",
        "Consider it settled.",
        "We are glad to confirm.",
        "Our answer is yes.",
        "This is what we were looking for.",
        "The decision has been made.",
    ],
    cores: &[
        "We take plan {plan} at {price} per seat for one month.",
        "Please set us up on plan {plan}, {price} a seat and month.",
        "Plan {plan} for {price} per seat and month it is.",
        "We sign for a month of plan {plan} at {price} per seat.",
        "Your offer of plan {plan} at {price} per seat a month stands, and so do we.",
        "Go ahead with plan {plan}; {price} a seat for the month is approved.",
        "Our seats move onto plan {plan} at {price} each for one month.",
        "Put {price} per seat and month for plan {plan} into the contract.",
    ],
};

/// Phrases of a subscriber that threatens to cancel because the price is too high for the quality.
pub(super) const THREAT: Phrases = Phrases {
    openings: &[
        "We need to talk about our contract.",
        "This is not an easy message to write.",
        "Our users have been asking us questions.",
        "We reviewed what we spend on your service.",
        "Before we go any further, a frank word.",
        "Our internal review has come to a result.",
        "Something has to change between us.",
        "We would rather tell you than simply leave.",
        "Your service was a topic in our last meeting.",
    ],
    cores: &[
        "The price no longer fits the value we receive, and we are looking at alternatives.",
        "What we pay and what we get have drifted apart; other vendors are being considered.",
        "For this price we expected more than we see, so we have begun to compare.",
        "We can no longer justify the price with what the product does for us, and competitors have noticed.",
        "At today's price the service is not worth it to us, and we are weighing other options.",
        "The benefit has fallen behind the bill; a switch is under discussion here.",
        "Either the terms follow the value we see, or we move to somebody else.",
        "We find it hard to defend this price any longer, and alternatives are on the table.",
        "The value we receive has slipped below its price, and we have asked others for quotes.",
    ],
};

const PLAN_OPENINGS: &[&str] = &[
    "We have looked at your other plans.",
    "A question about our subscription.",
    "Our needs have shifted a little.",
    "We compared the plans on your price list.",
    "Our team went over how we use the product.",
    "It may be time for another plan.",
    "We are thinking about a change.",
    "Your price list gave us an idea.",
    "We would like to adjust our subscription.",
];

/// Phrases of a subscriber that asks for the price of a higher-priced plan.
pub(super) const UPGRADE: Phrases = Phrases {
    openings: PLAN_OPENINGS,
    cores: &[
        "What would plan {plan} cost for our {seats} seats?",
        "Could you quote us plan {plan} for {seats} seats?",
        "Plan {plan} looks right for our {seats} seats; which price per seat can you offer?",
        "We would consider moving {seats} seats up to plan {plan} at the right price per seat.",
        "Please send us a price for {seats} seats on plan {plan}.",
        "With {seats} seats we could grow into plan {plan}; what is your price?",
        "Let us know what you would charge per seat if our {seats} seats went to plan {plan}.",
        "For {seats} seats, plan {plan} seems to give us more for the money; what can you propose?",
    ],
};

/// Phrases of a subscriber that asks for the price of a lower-priced plan.
pub(super) const DOWNGRADE: Phrases = Phrases {
    openings: PLAN_OPENINGS,
    cores: &[
        "Our {seats} seats do not need all of plan {from}; what would be a fitting price for plan {plan}?",
        "We are on plan {from} with {seats} seats, and plan {plan} would do. Please quote us accordingly.",
        "Could we bring our {seats} seats from plan {from} to plan {plan}, at a price that fits it?",
        "Plan {plan} would be enough for our {seats} seats; which price per seat replaces that of plan {from}?",
        "We would like to step down from plan {from} to plan {plan} with {seats} seats, for a lower price.",
        "Please send us terms for {seats} seats on plan {plan} instead of plan {from}.",
        "For {seats} seats plan {from} is more than we use; what do you ask for plan {plan}?",
        "We think of plan {plan} rather than plan {from} for our {seats} seats, and of a price to match.",
    ],
};

/// Closing sentences for messages in long negotiations, for all decision styles.
pub(super) const LATE_ENDINGS: [&str; 6] = [
    "We have been writing back and forth for a while and would like to come to an end.",
    "Our patience with this round of letters is not endless.",
    "It would be good to close this soon.",
    "After so many messages we hope for a clear word.",
    "We cannot keep this open for ever.",
    "Please make the next letter count.",
];

/// Closing sentences by decision style: quick, numbers, committee, careful, partner.
pub(super) const ENDINGS: [Endings; 5] = [
    Endings {
        open: [
            "We can decide on the day your answer arrives.",
            "No need for a long exchange; a short answer will do.",
            "As {culture} company we like to keep this simple.",
            "What counts for us is {concern}, and speed.",
        ],
        after_agreement: [
            "We would like to start right away.",
            "Thank you for keeping it short.",
            "No further meetings are needed.",
            "This helps us with {concern}.",
        ],
    },
    Endings {
        open: [
            "The figures have to add up for us.",
            "With {concern} in mind we look at every dollar.",
            "Show us that the sum works out and we can agree.",
            "As {culture} organisation we calculate before we sign.",
        ],
        after_agreement: [
            "The figures add up.",
            "It supports our work on {concern}.",
            "Finance has released the budget.",
            "We will look at the return at the end of the month.",
        ],
    },
    Endings {
        open: [
            "Whatever you send goes to several people here.",
            "The group that decides meets again soon.",
            "Several of us have to agree, and {concern} is what they ask about first.",
            "In {culture} organisation like ours nobody decides alone.",
        ],
        after_agreement: [
            "Everybody who had a say has agreed.",
            "The vote was clear.",
            "Our colleagues saw the use for {concern}.",
            "The minutes have been signed.",
        ],
    },
    Endings {
        open: [
            "We check everything twice, above all where {concern} is touched.",
            "Please put your answer in writing so that we can file it.",
            "As {culture} organisation we take no chances.",
            "Our reviewers will read your answer closely.",
        ],
        after_agreement: [
            "All checks have been passed.",
            "The review, {concern} included, raised no objections.",
            "The papers are complete on our side.",
            "We expect the service to be as described.",
        ],
    },
    Endings {
        open: [
            "We would like this to become a lasting relationship.",
            "We look for a partner who understands {concern}.",
            "As {culture} company we think beyond the next month.",
            "Our management follows this personally.",
        ],
        after_agreement: [
            "We look forward to working together.",
            "May this be the beginning of something larger.",
            "Our management sends its regards.",
            "Together we can get ahead with {concern}.",
        ],
    },
];
