//! Ledger amounts by week and category, and the steps of the waterfall.

use std::collections::BTreeMap;

use novamind_base::formatting::grouped_number;
use novamind_record::figures::{CategoryTotals, WeekFigure};
use novamind_report::category_name;
use novamind_session::{Category, ledger_weeks_condition_sql, week_of_day};
use novamind_worker::company::DisplayedCompany;

#[derive(Debug, PartialEq, Eq)]
pub struct CategoryDisplay {
    pub category: Category,
    /// Unique glyph of the category in bars, for terminals without colors or block glyphs.
    pub glyph: char,
    pub is_income: bool,
}

impl CategoryDisplay {
    pub fn name(&self) -> &'static str {
        category_name(self.category)
    }
}

const fn category_display(category: Category, glyph: char, income: bool) -> CategoryDisplay {
    CategoryDisplay { category, glyph, is_income: income }
}

pub const CATEGORY_COUNT: usize = Category::ALL.len();

/// All ledger categories, income first.
pub static CATEGORIES: [CategoryDisplay; CATEGORY_COUNT] = [
    category_display(Category::SubscriptionPayment, '█', true),
    category_display(Category::AdRevenue, '░', true),
    category_display(Category::InitialFunding, '$', true),
    category_display(Category::Compute, '▓', false),
    category_display(Category::Capacity, '▒', false),
    category_display(Category::Advertising, '≡', false),
    category_display(Category::LeadAcquisitionCost, '×', false),
    category_display(Category::Operations, '+', false),
    category_display(Category::Development, '─', false),
    category_display(Category::ResearchProject, '▲', false),
    category_display(Category::MarketResearch, '?', false),
    category_display(Category::GroupResearch, '▼', false),
];

/// Dollars by category, with negative amounts for costs.
pub type CategoryAmounts = [f64; CATEGORY_COUNT];

/// Dollars by week and category from the first week, without the opening cash.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct WeeklyLedger {
    weeks: BTreeMap<u32, CategoryAmounts>,
    /// The last simulated week. Later purchases belong to the next week.
    last_week: u32,
}

impl WeeklyLedger {
    pub fn from_company(company: &DisplayedCompany) -> WeeklyLedger {
        let last = week_of_day(company.observation.day);
        let mut weeks = BTreeMap::new();
        for figures in &company.weeks {
            weeks.insert(week_of_day(figures.day), category_amounts(&figures.booked));
        }
        weeks.insert(company.weeks.len() as u32 + 1, category_amounts(&company.observation.booked_since));
        WeeklyLedger { weeks, last_week: last }
    }

    /// Returns the last simulated week.
    pub fn last_week(&self) -> u32 {
        self.last_week
    }

    /// Returns the next week to simulate, which contains the purchases since the last simulated week.
    pub fn open_week(&self) -> u32 {
        self.weeks.keys().next_back().copied().unwrap_or(0)
    }

    pub fn week(&self, week: u32) -> CategoryAmounts {
        self.weeks.get(&week).copied().unwrap_or([0.0; CATEGORY_COUNT])
    }

    /// Returns the mean amounts of up to four weeks, the last of which is the given week.
    pub fn four_week_mean(&self, week: u32) -> CategoryAmounts {
        let from = week.saturating_sub(3).max(1);
        let count = f64::from((week + 1).saturating_sub(from).max(1));
        let mut mean = [0.0; CATEGORY_COUNT];
        for amounts in self.weeks.range(from..=week.max(from)).map(|(_, amounts)| amounts) {
            mean.iter_mut().zip(amounts).for_each(|(sum, amount)| *sum += amount / count);
        }
        mean
    }

    pub fn total(&self) -> CategoryAmounts {
        let mut total = [0.0; CATEGORY_COUNT];
        for amounts in self.weeks.values() {
            total.iter_mut().zip(amounts).for_each(|(sum, amount)| *sum += amount);
        }
        total
    }

    /// Returns whether a category has any amount in the run.
    pub fn is_used(&self, category: usize) -> bool {
        self.weeks.values().any(|amounts| amounts[category] != 0.0)
    }

    pub fn last_weeks(&self, count: usize) -> Vec<(u32, CategoryAmounts)> {
        let mut last: Vec<(u32, CategoryAmounts)> = self
            .weeks
            .iter()
            .rev()
            .filter(|(week, _)| (1..=self.last_week).contains(*week))
            .take(count)
            .map(|(week, amounts)| (*week, *amounts))
            .collect();
        last.reverse();
        last
    }
}

fn category_amounts(booked: &CategoryTotals) -> CategoryAmounts {
    std::array::from_fn(|at| booked.category_total(CATEGORIES[at].category))
}

/// Returns the sum of all income categories or of all cost categories.
pub fn income_or_cost_total(amounts: &CategoryAmounts, income: bool) -> f64 {
    let side_amounts = amounts.iter().zip(&CATEGORIES).filter(|(_, category)| category.is_income == income);
    side_amounts.map(|(amount, _)| amount).sum()
}

/// Returns the first and last day of a week. Week 0 consists of day 0 only.
pub fn days_of_week(week: u32) -> (u32, u32) {
    match week {
        0 => (0, 0),
        week => (7 * (week - 1) + 1, 7 * week),
    }
}

/// Returns the cash at the end of the previous week and at the end of the week. For the open week, the second value is
/// the current cash.
pub fn cash_before_and_after(company: &DisplayedCompany, week: u32) -> Option<(f64, f64)> {
    let ended = |week: u32| company.weeks.get(week.checked_sub(1)? as usize).map(|figures| figures.cash);
    let before = match week.checked_sub(1)? {
        0 => company.observation.starting_cash,
        before => ended(before)?,
    };
    Some((before, ended(week).unwrap_or(company.observation.cash)))
}

/// A step of the waterfall.
#[derive(Debug, Clone, PartialEq)]
pub struct CashStep {
    pub name: String,
    /// Cash before the step. For a level, `from` and `to` are equal.
    pub from: f64,
    pub to: f64,
    /// Whether the step is a level: the initial or final cash of the week.
    pub is_level: bool,
    pub subject: LedgerSubject,
}

/// Returns the steps of a week in at most `most` rows: income first, then costs by size. The smallest costs are
/// combined.
pub fn cash_steps(ledger: &WeeklyLedger, company: &DisplayedCompany, week: u32, most: usize) -> Vec<CashStep> {
    let Some((before, after)) = cash_before_and_after(company, week) else { return Vec::new() };
    let amounts = ledger.week(week);
    let mut moved: Vec<usize> = (0..CATEGORY_COUNT).filter(|at| amounts[*at] != 0.0).collect();
    moved.sort_by(|left, right| {
        let order = |at: &usize| (!CATEGORIES[*at].is_income, -amounts[*at].abs());
        let (left, right) = (order(left), order(right));
        left.0.cmp(&right.0).then(left.1.total_cmp(&right.1))
    });
    let level = |name: String, cash: f64| CashStep {
        name,
        from: cash,
        to: cash,
        is_level: true,
        subject: LedgerSubject::Net,
    };
    let mut steps = vec![level(format!("day {}", 7 * (week - 1)), before)];
    let mut cash = before;
    let room = most.saturating_sub(2).max(1);
    let number = if moved.len() > room { room - 1 } else { moved.len() };
    for at in &moved[..number] {
        let to = cash + amounts[*at];
        let (name, subject) = (CATEGORIES[*at].name().to_owned(), LedgerSubject::Category(*at));
        steps.push(CashStep { name, from: cash, to, is_level: false, subject });
        cash = to;
    }
    if number < moved.len() {
        let rest: f64 = moved[number..].iter().map(|at| amounts[*at]).sum();
        let name = if number == 0 { "net" } else { "other costs" }.to_owned();
        let subject = if number == 0 { LedgerSubject::Net } else { LedgerSubject::Costs };
        steps.push(CashStep { name, from: cash, to: cash + rest, is_level: false, subject });
    }
    steps.push(level(format!("day {}", (7 * week).min(company.observation.day)), after));
    steps
}

/// Formats whole dollars, with a minus sign for negative amounts.
pub fn format_money(value: f64) -> String {
    let sign = if value <= -0.5 { "-" } else { "" };
    format!("{sign}${}", grouped_number(value.abs(), 0))
}

/// Returns the query for the ledger rows of a subject in a range of weeks.
pub fn ledger_query(what: &LedgerSubject, (first, last): (u32, u32)) -> String {
    let condition = match what {
        LedgerSubject::Category(at) => format!("\n    AND category = '{}'", CATEGORIES[*at].category.id()),
        LedgerSubject::Income => "\n    AND amount > 0".to_owned(),
        LedgerSubject::Costs => "\n    AND amount < 0".to_owned(),
        LedgerSubject::Net => String::new(),
    };
    let weeks = if first == last { format!("week {last}") } else { format!("weeks {first} to {last}") };
    format!(
        "-- {weeks}\nSELECT day, category, amount, note\nFROM ledger\nWHERE {}{condition}\nORDER BY id",
        ledger_weeks_condition_sql(first, last)
    )
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LedgerSubject {
    Category(usize),
    Income,
    Costs,
    /// The net result: income minus costs.
    Net,
}

impl LedgerSubject {
    pub fn name(self) -> &'static str {
        match self {
            LedgerSubject::Category(at) => CATEGORIES[at].name(),
            LedgerSubject::Income => "income",
            LedgerSubject::Costs => "costs",
            LedgerSubject::Net => "net",
        }
    }

    pub fn term(self) -> &'static str {
        match self {
            LedgerSubject::Category(at) => match CATEGORIES[at].category {
                Category::SubscriptionPayment => "payments",
                Category::LeadAcquisitionCost => "lead-acquisition-cost",
                _ => "ledger",
            },
            LedgerSubject::Income | LedgerSubject::Costs | LedgerSubject::Net => "cash-change",
        }
    }

    /// Returns the weekly figure that corresponds to the subject.
    pub fn figure(self) -> Option<WeekFigure> {
        match self {
            LedgerSubject::Category(at) => WeekFigure::for_category(CATEGORIES[at].category),
            LedgerSubject::Income => Some(WeekFigure::Income),
            LedgerSubject::Costs => Some(WeekFigure::Costs),
            LedgerSubject::Net => Some(WeekFigure::CashChange),
        }
    }

    pub fn amount(self, amounts: &CategoryAmounts) -> f64 {
        match self {
            LedgerSubject::Category(at) => amounts[at],
            LedgerSubject::Income => income_or_cost_total(amounts, true),
            LedgerSubject::Costs => income_or_cost_total(amounts, false),
            LedgerSubject::Net => amounts.iter().sum(),
        }
    }
}
