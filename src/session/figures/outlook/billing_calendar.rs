//! Bills that the current subscribers receive on the coming days.

/// Number of past weeks whose signups are counted.
pub const SIGN_UP_WEEKS: usize = 4;

/// Bills that the current subscribers receive in the next billing period if they stay, and recent signups.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BillingCalendar {
    /// Bills of individuals by day, beginning with tomorrow, dollars.
    pub individuals: Vec<f64>,
    /// Bills of enterprises by day, beginning with tomorrow, dollars.
    pub enterprises: Vec<f64>,
    /// Monthly revenue of the individuals who signed up in each of the last four weeks, the last week first, dollars.
    pub signed_up: [f64; SIGN_UP_WEEKS],
}

impl BillingCalendar {
    /// Creates a calendar without bills for a billing period of this number of days.
    pub fn new(period: u32) -> BillingCalendar {
        let days = vec![0.0; period as usize];
        BillingCalendar { individuals: days.clone(), enterprises: days, signed_up: Default::default() }
    }
}
