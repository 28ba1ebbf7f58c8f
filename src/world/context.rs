//! What everybody's day has in common: made once the service has been observed, and read until the evening.

use super::events::ServiceDay;
use super::morning::Morning;
use super::params::Params;
use super::product::ads::AdLoad;
use super::random::Streams;
use super::settings::Settings;
use crate::quality::TenureTable;

/// The day as those who feel, decide, negotiate and pay meet it.
#[derive(Clone, Copy)]
pub struct DayContext<'a> {
    /// Values frozen this morning.
    pub morning: &'a Morning,
    /// Settings of today.
    pub settings: &'a Settings,
    /// Service of today.
    pub service: &'a ServiceDay,
    /// Quality lost to today's service, where fidelity makes it count.
    pub service_penalty: f64,
    /// In-app ads.
    pub ads: &'a AdLoad<'a>,
    /// Tenure bonuses by days.
    pub tenure: &'a TenureTable,
    /// Parameters.
    pub params: &'a Params,
    /// Random streams.
    pub streams: &'a Streams,
}

impl DayContext<'_> {
    /// The day.
    pub fn day(&self) -> u32 {
        self.morning.day
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Runs `check` on a day whose service is given; nobody has been here for longer than 600 days.
    pub(crate) fn on_day<R>(
        morning: &Morning,
        settings: &Settings,
        service: &ServiceDay,
        (params, streams): (&Params, &Streams),
        check: impl FnOnce(&DayContext<'_>) -> R,
    ) -> R {
        let ads = AdLoad::of(&settings.ads_strength, params);
        let tenure = TenureTable::up_to(600, params);
        let (ads, tenure) = (&ads, &tenure);
        check(&DayContext { morning, settings, service, service_penalty: 0.0, ads, tenure, params, streams })
    }
}
