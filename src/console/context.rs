//! Types that screens, dialogs and effects share: screen identifiers, the context of a view, and explainable figures.

use super::action::{Action, Scope};
use super::keys::KeyBindings;
use novamind_insight::WeekQuantity;
use novamind_worker::company::DisplayedCompany;

/// Placeholder of charts and tables before the first week.
pub const NO_DATA: &str = "no data yet: run a week (n)";

/// The list of screens, in the order of their keys.
macro_rules! screen_ids {
    ($($(#[$doc:meta])* $Screen:ident,)*) => {
        /// A screen.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum ScreenId { $($(#[$doc])* $Screen,)* }

        impl ScreenId {
            /// All screens in the order of their keys.
            pub const ALL: [ScreenId; [$(ScreenId::$Screen),*].len()] = [$(ScreenId::$Screen),*];

            /// Returns the action that shows the screen.
            pub fn action(self) -> Action {
                match self { $(ScreenId::$Screen => Action::$Screen,)* }
            }
        }
    };
}

screen_ids! {
    /// Key figures of the company.
    Overview,
    /// Income and costs.
    Cash,
    /// The customer groups.
    Customers,
    /// Quality, capacity, issues, R&D.
    Product,
    /// The social feed and the company's posts.
    Social,
    /// Negotiations with enterprises.
    Inbox,
    /// Groups, studies, the economy.
    Market,
    /// Forms of all tools.
    Tools,
    /// The database.
    Sql,
    /// Past actions and forecast scores.
    Journal,
    /// Hidden state, if permitted.
    Xray,
}

impl ScreenId {
    /// Returns the name in the trajectory.
    pub fn record_name(self) -> &'static str {
        self.action().entry().name
    }

    /// Returns whether the screen is available: the x-ray requires permission to view hidden state.
    pub fn is_available_in(self, company: &DisplayedCompany) -> bool {
        self != ScreenId::Xray || company.can_inspect
    }
}

/// Context that a screen reads.
#[derive(Clone, Copy)]
pub struct ScreenContext<'a> {
    /// The company.
    pub company: &'a DisplayedCompany,
    /// Keys, for labels.
    pub keys: &'a KeyBindings,
    /// Rows that the focused list showed last, for paging.
    pub page_rows: u16,
}

impl ScreenContext<'_> {
    /// Returns an action with its key, for borders: `ctrl-s apply`.
    pub fn hint(&self, action: Action) -> String {
        match self.keys.label(action) {
            Some(key) => format!("{key} {}", action.entry().title),
            None => action.entry().title.to_owned(),
        }
    }

    /// Returns several actions with their keys.
    pub fn hints(&self, actions: &[Action]) -> String {
        actions.iter().map(|action| self.hint(*action)).collect::<Vec<_>>().join(" · ")
    }
}

/// A figure that can be explained and traced to its source rows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Figure {
    /// Its title: `cancellations of S1`.
    pub title: String,
    /// Term that explains it: a glossary entry (`churn`), a tool or an argument (`set_prices`, `set_prices.A`), or a
    /// column (`ledger.amount`).
    pub term: &'static str,
    /// Query for the source rows, if it has any.
    pub sql: Option<String>,
    /// The weekly quantity that it shows and its week, if its change can be explained.
    pub week_quantity: Option<(WeekQuantity, u32)>,
}

impl Figure {
    /// Returns the figure with a weekly quantity, if it has one.
    pub fn with_week_quantity(self, quantity: Option<WeekQuantity>, week: u32) -> Figure {
        Figure { week_quantity: quantity.map(|quantity| (quantity, week)), ..self }
    }
}

/// Keys of a pane, for the help.
pub struct PaneKeys {
    /// Title of the pane.
    pub title: String,
    /// Scopes of the pane, the innermost first, without the global scope.
    pub scopes: Vec<Scope>,
    /// Most common actions of the pane.
    pub hints: Vec<Action>,
}
