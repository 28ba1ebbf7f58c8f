//! What screens ask the database for. Every reading is one guarded query over the visible tables, the same a
//! person could ask; its words are in `assets/readings`.

macro_rules! readings {
    ($($variant:ident $file:literal $doc:literal)*) => {
        /// A question of a screen.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Reading { $(#[doc = $doc] $variant,)* }

        impl Reading {
            /// All readings.
            pub const ALL: &'static [Reading] = &[$(Reading::$variant,)*];

            /// The statement.
            pub fn sql(self) -> &'static str {
                match self { $(Reading::$variant => include_str!(concat!("../../assets/readings/", $file, ".sql")),)* }
            }
        }
    };
}

readings! {
    LedgerByWeek "ledger_by_week" "Dollars by week and category: week, category, amount, entries."
    Groups "groups" "One row per group with what is known of its customers: see the file."
    LeadsByChannel "leads_by_channel" "Leads and spend of the last weeks by channel and group."
    LeadsByWeek "leads_by_week" "Leads, new subscribers and departures by week and group."
    Service "service" "Usage, capacity, latency, errors and downtime by day."
    UsageByPlan "usage_by_plan" "Usage of the last seven days by plan."
    OpenIssues "open_issues" "Open issues by group and age."
    Research "research" "R&D projects."
    SpendHistory "spend_history" "Operations and development spend by decision day."
}
