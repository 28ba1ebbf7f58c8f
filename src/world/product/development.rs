//! General and targeted development (`docs/mechanics/product/development.md`).

use super::Product;
use crate::fault::Fault;
use crate::params::{Development, Params};
use crate::random::{Part, Streams};
use crate::settings::Settings;

/// Returns the quality gain of all groups from one day of general development: 0.0045 ln(1 + spend / 5000).
pub fn development_gain(spend: f64, development: &Development) -> f64 {
    if spend <= 0.0 {
        return 0.0;
    }
    development.dev_improvement_coef * libm::log(1.0 + spend / development.dev_spend_scale)
}

/// Returns the quality gain of a group from one day of targeted development: 0.0225 ln(1 + spend / 5000).
pub fn targeted_development_gain(spend: f64, development: &Development) -> f64 {
    if spend <= 0.0 {
        return 0.0;
    }
    development.targeted_dev_improvement_coef * libm::log(1.0 + spend / development.targeted_dev_spend_scale)
}

/// Draws the noise of the shared quality on a day.
pub fn daily_noise(day: u32, params: &Params, streams: &Streams) -> f64 {
    let mut stream = streams.open(Part::QualityNoise, [u64::from(day)]);
    stream.normal(0.0, params.development.quality_shared_noise_scale)
}

/// Applies one day of development to the product. Noise is added to the general bonus every day, regardless of
/// spending, but never to the quality bank.
pub fn apply_development(
    day: u32,
    product: &mut Product,
    settings: &Settings,
    params: &Params,
    streams: &Streams,
) {
    let gain = development_gain(settings.core.development, &params.development);
    product.shared_bonus += gain + daily_noise(day, params, streams);
    product.shared_bank += gain;
    for (&group, &spend) in &settings.targeted_development.targeted_spend {
        let gain = match params.has_fault(Fault::TargetedGainAsGeneral) {
            true => development_gain(spend, &params.development),
            false => targeted_development_gain(spend, &params.development),
        };
        product.group_bonus[group] += gain;
        product.group_bank[group] += gain;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identifiers::Group;

    #[test]
    fn development_gain_is_logarithmic_in_spending() {
        let development = Params::bundled().development;
        for (spend, shared, targeted) in [
            (1.0, 8.99910012e-7, 4.49955006e-6),
            (200.0, 1.76493209e-4, 8.82466046e-4),
            (1000.0, 8.20447006e-4, 4.10223503e-3),
            (5000.0, 3.11916231e-3, 1.55958116e-2),
            (40_000.0, 9.88751060e-3, 4.94375530e-2),
        ] {
            assert!((development_gain(spend, &development) / shared - 1.0).abs() < 1e-8);
            assert!((targeted_development_gain(spend, &development) / targeted - 1.0).abs() < 1e-8);
        }
        assert_eq!(development_gain(0.0, &development), 0.0);
    }

    #[test]
    fn banks_receive_daily_development_gains() {
        let mut params = Params::bundled();
        params.development.quality_shared_noise_scale = 0.0;
        let s1 = Group::at(0).expect("S1");
        let mut settings = Settings::initial(&params);
        settings.core.development = 2500.0;
        settings.targeted_development.targeted_spend.insert(s1, 4000.0);
        let mut product = Product::initial(&params);
        apply_development(1, &mut product, &settings, &params, &Streams::new(1));
        assert!((product.shared_bonus - 0.0018245929864867).abs() < 1e-15);
        assert_eq!(product.shared_bonus, product.shared_bank);
        assert!((product.group_bonus[s1] - 0.013225199960298).abs() < 1e-14);
        assert_eq!(product.group_bonus[s1], product.group_bank[s1]);
    }
}
