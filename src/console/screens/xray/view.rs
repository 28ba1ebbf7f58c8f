//! Views of the x-ray and their choices.

use strum::VariantArray;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, VariantArray)]
pub enum View {
    /// The equation of a group's leads.
    #[default]
    Leads,
    /// Delivered quality of a group.
    Quality,
    /// Causes of a group's satisfaction.
    Satisfaction,
    /// Causes of a group's reputation.
    Reputation,
    /// Spillover of reputation.
    Spillover,
    Rivals,
    Drift,
    /// Next random draws of a component.
    Streams,
    /// Hidden state of a customer.
    Customer,
    Breakpoints,
    /// Plain-mode commands.
    Words,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Choices {
    Groups,
    /// Components with random draws.
    Parts,
    Breakpoints,
    /// None: the view shows the whole market, or typed commands.
    Nothing,
}

impl View {
    pub fn title(self) -> &'static str {
        match self {
            View::Leads => "leads",
            View::Quality => "quality",
            View::Satisfaction => "satisfaction",
            View::Reputation => "reputation",
            View::Spillover => "spillover",
            View::Rivals => "competitors",
            View::Drift => "drift",
            View::Streams => "streams",
            View::Customer => "customer",
            View::Breakpoints => "breakpoints",
            View::Words => "commands",
        }
    }

    pub fn choices(self) -> Choices {
        match self {
            View::Leads | View::Quality | View::Satisfaction | View::Reputation => Choices::Groups,
            View::Streams => Choices::Parts,
            View::Breakpoints => Choices::Breakpoints,
            View::Spillover | View::Rivals | View::Drift | View::Customer | View::Words => Choices::Nothing,
        }
    }

    /// Returns whether it shows one day. The others show future values or settings.
    pub fn has_day(self) -> bool {
        !matches!(self, View::Streams | View::Breakpoints | View::Words)
    }

    pub fn term(self) -> &'static str {
        match self {
            View::Breakpoints => "breakpoint",
            _ => "x-ray",
        }
    }
}

impl Choices {
    pub fn title(self) -> &'static str {
        match self {
            Choices::Groups => "Group",
            Choices::Parts => "Component",
            Choices::Breakpoints => "Set",
            Choices::Nothing => "",
        }
    }
}
