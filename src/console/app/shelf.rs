//! Every screen of a run.

use crate::console::screens::cash::Cash;
use crate::console::screens::customers::Customers;
use crate::console::screens::inbox::Inbox;
use crate::console::screens::journal::Journal;
use crate::console::screens::market::Market;
use crate::console::screens::overview::Overview;
use crate::console::screens::product::Product;
use crate::console::screens::social::Social;
use crate::console::screens::sql::Sql;
use crate::console::screens::tools::Tools;
use crate::console::screens::{Screen, ScreenId};

/// Every screen of a run.
#[derive(Default)]
pub struct Screens {
    pub(super) overview: Overview,
    pub(super) cash: Cash,
    pub(super) customers: Customers,
    pub(super) product: Product,
    pub(super) social: Social,
    pub(super) inbox: Inbox,
    pub(super) market: Market,
    pub(super) tools: Tools,
    pub(super) sql: Sql,
    pub(super) journal: Journal,
}

impl Screens {
    /// A screen.
    pub fn get(&self, id: ScreenId) -> &dyn Screen {
        match id {
            ScreenId::Overview => &self.overview,
            ScreenId::Cash => &self.cash,
            ScreenId::Customers => &self.customers,
            ScreenId::Product => &self.product,
            ScreenId::Social => &self.social,
            ScreenId::Inbox => &self.inbox,
            ScreenId::Market => &self.market,
            ScreenId::Tools => &self.tools,
            ScreenId::Sql => &self.sql,
            ScreenId::Journal => &self.journal,
        }
    }

    /// A screen, to change it.
    pub fn get_mut(&mut self, id: ScreenId) -> &mut dyn Screen {
        match id {
            ScreenId::Overview => &mut self.overview,
            ScreenId::Cash => &mut self.cash,
            ScreenId::Customers => &mut self.customers,
            ScreenId::Product => &mut self.product,
            ScreenId::Social => &mut self.social,
            ScreenId::Inbox => &mut self.inbox,
            ScreenId::Market => &mut self.market,
            ScreenId::Tools => &mut self.tools,
            ScreenId::Sql => &mut self.sql,
            ScreenId::Journal => &mut self.journal,
        }
    }
}
