//! The views of the X-ray, and what is chosen in each.

use strum::VariantArray;

/// What is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, VariantArray)]
pub enum View {
    /// The equation of a group's leads.
    #[default]
    Leads,
    /// What is delivered to a group.
    Quality,
    /// What moved the satisfaction of a group.
    Satisfaction,
    /// What moved the reputation of a group.
    Reputation,
    /// How reputation spilled over.
    Spillover,
    /// Rivals.
    Rivals,
    /// Drift.
    Drift,
    /// The next draws of a part.
    Streams,
    /// A customer from within.
    Customer,
    /// Breakpoints.
    Breakpoints,
    /// Words as plain mode takes them.
    Words,
}

/// What a view has to choose from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Choices {
    /// The customer groups.
    Groups,
    /// Parts of the world that draw.
    Parts,
    /// The breakpoints that are set.
    Breakpoints,
    /// Nothing: it shows the whole market, or what is typed.
    Nothing,
}

impl View {
    /// Its name in the list.
    pub fn title(self) -> &'static str {
        match self {
            View::Leads => "leads",
            View::Quality => "quality",
            View::Satisfaction => "satisfaction",
            View::Reputation => "reputation",
            View::Spillover => "spill-over",
            View::Rivals => "rivals",
            View::Drift => "drift",
            View::Streams => "streams",
            View::Customer => "customer",
            View::Breakpoints => "breakpoints",
            View::Words => "words",
        }
    }

    /// What is chosen in it.
    pub fn choices(self) -> Choices {
        match self {
            View::Leads | View::Quality | View::Satisfaction | View::Reputation => Choices::Groups,
            View::Streams => Choices::Parts,
            View::Breakpoints => Choices::Breakpoints,
            View::Spillover | View::Rivals | View::Drift | View::Customer | View::Words => Choices::Nothing,
        }
    }

    /// Whether it shows one day; the others show what comes next, or what is set.
    pub fn has_day(self) -> bool {
        !matches!(self, View::Streams | View::Breakpoints | View::Words)
    }

    /// The entry of the glossary that explains it.
    pub fn term(self) -> &'static str {
        match self {
            View::Breakpoints => "breakpoint",
            _ => "x-ray",
        }
    }
}

impl Choices {
    /// Title of the list of them.
    pub fn title(self) -> &'static str {
        match self {
            Choices::Groups => "Group",
            Choices::Parts => "Part",
            Choices::Breakpoints => "Set",
            Choices::Nothing => "",
        }
    }
}
