//! What screens, dialogs and effects share: which screen, what a view reads, and figures that can be explained.

use super::action::{Action, Scope};
use super::keys::Keys;
use novamind_insight::WeekQuantity;
use novamind_worker::company::Company;

/// Text of charts and tables before the first week.
pub const NO_DATA: &str = "no data yet: run a week (n)";

/// The list of screens, in the order of their keys.
macro_rules! screen_ids {
    ($($(#[$doc:meta])* $Screen:ident,)*) => {
        /// Which screen.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum ScreenId { $($(#[$doc])* $Screen,)* }

        impl ScreenId {
            /// All screens in the order of their keys.
            pub const ALL: [ScreenId; [$(ScreenId::$Screen),*].len()] = [$(ScreenId::$Screen),*];

            /// The action that shows it.
            pub fn action(self) -> Action {
                match self { $(ScreenId::$Screen => Action::$Screen,)* }
            }
        }
    };
}

screen_ids! {
    /// The company at a glance.
    Overview,
    /// Where money comes from and goes to.
    Cash,
    /// The customer groups.
    Customers,
    /// Quality, capacity, issues, R&D.
    Product,
    /// What people write, and our posts.
    Social,
    /// Negotiations with companies.
    Inbox,
    /// Groups, studies, the economy.
    Market,
    /// Forms of all tools.
    Tools,
    /// The database.
    Sql,
    /// What was done.
    Journal,
    /// Hidden state, where it may be shown.
    Xray,
}

impl ScreenId {
    /// Name for the trajectory.
    pub fn id(self) -> &'static str {
        self.action().entry().name
    }

    /// Whether it stands among the screens of a run: the X-ray only where hidden state may be shown.
    pub fn is_shown_in(self, company: &Company) -> bool {
        self != ScreenId::Xray || company.may_look_inside
    }
}

/// What a screen may look at.
#[derive(Clone, Copy)]
pub struct Look<'a> {
    /// The company.
    pub company: &'a Company,
    /// Keys, for hints.
    pub keys: &'a Keys,
    /// Rows that the focused list showed last, for paging.
    pub page: u16,
}

impl Look<'_> {
    /// A key with what it does, for borders: `ctrl-s apply`.
    pub fn hint(&self, action: Action) -> String {
        match self.keys.label(action) {
            Some(key) => format!("{key} {}", action.entry().title),
            None => action.entry().title.to_owned(),
        }
    }

    /// Several of them.
    pub fn hints(&self, actions: &[Action]) -> String {
        actions.iter().map(|action| self.hint(*action)).collect::<Vec<_>>().join(" · ")
    }
}

/// A figure on a screen that can be explained, and followed to the rows that make it up.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Figure {
    /// What it is here: `cancellations of S1`.
    pub title: String,
    /// What explains it: an entry of the glossary (`churn`), a tool or its argument (`set_prices`, `set_prices.A`), or a
    /// column of a table (`ledger.amount`).
    pub term: &'static str,
    /// The question whose answer are the rows behind it, where rows make it up.
    pub sql: Option<String>,
    /// The figure of a week that it is, whose change can be explained.
    pub why: Option<(WeekQuantity, u32)>,
}

impl Figure {
    /// The same as a figure of a week whose change can be explained, if it is one.
    pub fn of_week(self, quantity: Option<WeekQuantity>, week: u32) -> Figure {
        Figure { why: quantity.map(|quantity| (quantity, week)), ..self }
    }
}

/// The keys of one pane, for the help.
pub struct PaneKeys {
    /// What the pane is called.
    pub title: String,
    /// Its scopes, the innermost first, without the global one.
    pub scopes: Vec<Scope>,
    /// What one does in it most.
    pub hints: Vec<Action>,
}
