//! Values that all customer mechanisms of a day share. They are computed after the day's service health.

use super::events::ServiceDay;
use super::morning::Morning;
use super::params::Params;
use super::product::ads::AdLoad;
use super::random::Streams;
use super::settings::Settings;
use crate::quality::TenureTable;

/// The context in which customers use and evaluate the product, negotiate and pay on one day.
#[derive(Clone, Copy)]
pub struct DayContext<'a> {
    /// Values that were fixed at the start of the day.
    pub morning: &'a Morning,
    /// Settings that are in force today.
    pub settings: &'a Settings,
    /// Service health of today.
    pub service: &'a ServiceDay,
    /// Quality loss from today's overload and outage. The fidelity parameter `service_penalty` determines whether the
    /// loss also affects decisions.
    pub service_penalty: f64,
    /// Strength of in-app advertising for each group.
    pub ads: &'a AdLoad<'a>,
    /// Tenure bonuses by days as a subscriber.
    pub tenure: &'a TenureTable,
    /// Parameters of the run.
    pub params: &'a Params,
    /// Random streams of the run.
    pub streams: &'a Streams,
}

impl DayContext<'_> {
    /// Returns the number of the simulated day.
    pub fn day(&self) -> u32 {
        self.morning.day
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Runs `check` with a day context that has tenure bonuses for up to 600 days.
    pub(crate) fn with_day_context<R>(
        morning: &Morning,
        settings: &Settings,
        service: &ServiceDay,
        (params, streams): (&Params, &Streams),
        check: impl FnOnce(&DayContext<'_>) -> R,
    ) -> R {
        let ads = AdLoad::new(&settings.ads_strength, params);
        let tenure = TenureTable::up_to(600, params);
        let (ads, tenure) = (&ads, &tenure);
        check(&DayContext { morning, settings, service, service_penalty: 0.0, ads, tenure, params, streams })
    }
}
