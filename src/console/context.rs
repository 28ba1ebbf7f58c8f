//! Types that screens, dialogs and effects share: screen identifiers, the context of a view, and explainable figures.

use super::action::{Action, Scope};
use super::keys::KeyBindings;
use novamind_insight::WeekQuantity;
use novamind_worker::company::DisplayedCompany;

/// Placeholder for charts and tables before the first week.
pub const NO_DATA: &str = "no data yet: run a week (n)";

/// Defines the screens in the order of their keys.
macro_rules! screen_ids {
    ($($(#[$doc:meta])* $Screen:ident,)*) => {
        /// Identifier of a screen.
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
    /// Quality, capacity, issues and R&D.
    Product,
    /// The social feed and the company's posts.
    Social,
    /// Negotiations with enterprises.
    Inbox,
    /// Groups, studies and the economy.
    Market,
    /// Forms for all tools.
    Tools,
    /// Queries of the database.
    Sql,
    /// Past actions and forecast scores.
    Journal,
    /// Hidden state, if the run permits inspections.
    Xray,
}

impl ScreenId {
    /// Returns the name of the screen in the trajectory.
    pub fn record_name(self) -> &'static str {
        self.action().entry().name
    }

    /// Returns whether the screen is available. The X-ray screen requires permission to view hidden state.
    pub fn is_available_in(self, company: &DisplayedCompany) -> bool {
        self != ScreenId::Xray || company.can_inspect
    }
}

/// Values that a screen needs to draw its panes and to handle actions.
#[derive(Clone, Copy)]
pub struct ScreenContext<'a> {
    /// The displayed company.
    pub company: &'a DisplayedCompany,
    /// Key bindings, which are used to label actions.
    pub keys: &'a KeyBindings,
    /// Number of rows that the focused list showed in the last frame, for paging.
    pub page_rows: u16,
}

impl ScreenContext<'_> {
    /// Returns the key and the title of an action for a border: `ctrl-s apply`.
    pub fn hint(&self, action: Action) -> String {
        match self.keys.label(action) {
            Some(key) => format!("{key} {}", action.entry().title),
            None => action.entry().title.to_owned(),
        }
    }

    /// Returns the keys and the titles of several actions, without actions that are not available.
    pub fn hints(&self, actions: &[Action]) -> String {
        let available = actions.iter().filter(|action| self.keys.is_available(**action));
        available.map(|action| self.hint(*action)).collect::<Vec<_>>().join(" · ")
    }
}

/// A text that can be edited in another program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EditorDocument {
    /// The text.
    pub text: String,
    /// Extension of the file, from which editors derive the highlighting.
    pub extension: &'static str,
}

/// A figure that can be explained and traced to its source rows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Figure {
    /// Title of the figure, for example `cancellations of S1`.
    pub title: String,
    /// Term that explains the figure: a glossary entry (`churn`), a tool or an argument (`set_prices`, `set_prices.A`),
    /// or a column (`ledger.amount`).
    pub term: &'static str,
    /// Query for the source rows, if the figure has source rows.
    pub sql: Option<String>,
    /// The weekly quantity that the figure shows and its week, if the change in the figure can be explained.
    pub week_quantity: Option<(WeekQuantity, u32)>,
}

impl Figure {
    /// Returns the figure with a weekly quantity, or unchanged if `quantity` is `None`.
    pub fn with_week_quantity(self, quantity: Option<WeekQuantity>, week: u32) -> Figure {
        Figure { week_quantity: quantity.map(|quantity| (quantity, week)), ..self }
    }
}

/// Scopes and actions of a pane, for the help.
pub struct PaneKeys {
    /// Title of the pane.
    pub title: String,
    /// Scopes of the pane, the innermost first, without the global scope.
    pub scopes: Vec<Scope>,
    /// Most common actions of the pane.
    pub hints: Vec<Action>,
}
