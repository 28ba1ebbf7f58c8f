//! Monthly random changes in channel yields (docs/mechanics/market/leads.md).

use crate::identifiers::{ByChannel, ByGroup, Channel, Group};
use crate::params::{Leads, Params};
use crate::random::{Part, Streams};

/// Returns a channel yield after one month. `z` is a standard normal draw. A yield of 0 stays 0.
pub fn yield_after_month(value: f64, z: f64, leads: &Leads) -> f64 {
    (value + leads.monthly_channel_noise_fraction * value * z).max(leads.monthly_channel_value_min)
}

/// Changes the yields of all groups, including undiscovered groups, on days divisible by 30. The draws are assigned to
/// the channels in alphabetical order.
pub fn vary_yields(day: u32, yields: &mut ByChannel<ByGroup<f64>>, params: &Params, streams: &Streams) {
    let interval = params.leads.monthly_channel_noise_interval_days;
    if !day.is_multiple_of(interval) {
        return;
    }
    let month = day / interval;
    let mut alphabetical = Channel::ALL;
    alphabetical.sort_by_key(|channel| channel.id());
    for group in Group::all() {
        let keys = [group.index() as u64, u64::from(month)];
        let mut stream = streams.open(Part::LeadRateDrift, keys);
        for channel in alphabetical {
            let value = &mut yields[channel][group];
            let series = params.replayed_series();
            if let Some(given) = series.and_then(|series| series.channel_yield(channel, group, month)) {
                *value = given;
            } else if *value > 0.0 {
                *value = yield_after_month(*value, stream.standard_normal(), &params.leads);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn yield_changes_by_a_fraction_above_its_minimum() {
        let leads = Params::bundled().leads;
        assert!((yield_after_month(124.5849, 1.0, &leads) - 130.814145).abs() < 1e-9);
        assert_eq!(yield_after_month(124.5849, -25.0, &leads), 0.0);
    }

    #[test]
    fn yields_vary_monthly_by_five_percent() {
        let params = Params::bundled();
        let streams = Streams::new(3);
        let start = params.starting_yields();
        let mut yields = start;
        vary_yields(29, &mut yields, &params, &streams);
        assert_eq!(yields, start);
        let (mut sum, mut squares) = (0.0, 0.0);
        vary_yields(30, &mut yields, &params, &streams);
        for channel in Channel::ALL {
            for group in Group::all() {
                let change = yields[channel][group] / start[channel][group] - 1.0;
                sum += change;
                squares += change * change;
            }
        }
        let (mean, std) = (sum / 130.0, (squares / 130.0).sqrt());
        assert!(mean.abs() < 0.015 && (std - 0.05).abs() < 0.012, "{mean} {std}");
    }
}
