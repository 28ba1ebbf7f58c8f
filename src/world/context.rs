//! Values of a day that all customer mechanisms share, created after the service has been observed.

use super::events::ServiceDay;
use super::morning::Morning;
use super::params::Params;
use super::product::ads::AdLoad;
use super::random::Streams;
use super::settings::Settings;
use crate::quality::TenureTable;

/// The context in which customers use, evaluate, negotiate and pay on one day.
#[derive(Clone, Copy)]
pub struct DayContext<'a> {
    /// Values fixed at the start of the day.
    pub morning: &'a Morning,
    /// Settings of today.
    pub settings: &'a Settings,
    /// Service of today.
    pub service: &'a ServiceDay,
    /// Quality lost to today's service, if the fidelity setting applies it to decisions.
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

    /// Runs `check` with the context of a given day. Tenure is at most 600 days.
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
