//! Views of the x-ray screen and their lists of choices.

use strum::VariantArray;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, VariantArray)]
pub enum XrayView {
    /// The equation of a group's leads.
    #[default]
    Leads,
    /// Delivered quality of a group.
    Quality,
    /// Causes of a group's satisfaction.
    Satisfaction,
    /// Causes of a group's reputation.
    Reputation,
    /// Spillover of reputation between groups.
    Spillover,
    Competitors,
    Drift,
    /// Next random draws of a component.
    Draws,
    /// Hidden state of a customer.
    Customer,
    Breakpoints,
    /// Plain-mode commands.
    Commands,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ViewChoices {
    Groups,
    /// Components with random draws.
    Components,
    Breakpoints,
    /// No list: the view shows the complete market, a customer, or the result of a command.
    Nothing,
}

impl XrayView {
    pub fn title(self) -> &'static str {
        match self {
            XrayView::Leads => "leads",
            XrayView::Quality => "quality",
            XrayView::Satisfaction => "satisfaction",
            XrayView::Reputation => "reputation",
            XrayView::Spillover => "spillover",
            XrayView::Competitors => "competitors",
            XrayView::Drift => "drift",
            XrayView::Draws => "streams",
            XrayView::Customer => "customer",
            XrayView::Breakpoints => "breakpoints",
            XrayView::Commands => "commands",
        }
    }

    pub fn choices(self) -> ViewChoices {
        match self {
            XrayView::Leads | XrayView::Quality | XrayView::Satisfaction | XrayView::Reputation => ViewChoices::Groups,
            XrayView::Draws => ViewChoices::Components,
            XrayView::Breakpoints => ViewChoices::Breakpoints,
            XrayView::Spillover | XrayView::Competitors | XrayView::Drift | XrayView::Customer | XrayView::Commands => ViewChoices::Nothing,
        }
    }

    /// Returns whether the view shows the state of one day. Other views show future values, breakpoints or command
    /// results.
    pub fn has_day(self) -> bool {
        !matches!(self, XrayView::Draws | XrayView::Breakpoints | XrayView::Commands)
    }

    pub fn term(self) -> &'static str {
        match self {
            XrayView::Breakpoints => "breakpoint",
            _ => "x-ray",
        }
    }
}

impl ViewChoices {
    pub fn title(self) -> &'static str {
        match self {
            ViewChoices::Groups => "Group",
            ViewChoices::Components => "Component",
            ViewChoices::Breakpoints => "Set",
            ViewChoices::Nothing => "",
        }
    }
}
