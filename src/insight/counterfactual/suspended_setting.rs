//! Settings that a re-simulation suspends.

use novamind_world::settings::Settings;

/// A kind of spending or discount that a re-simulation suspends while days are simulated. Calls still change the
/// setting, so recorded calls are accepted as in the run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SuspendedSetting {
    /// Shared and targeted development.
    Development,
    /// Advertising budgets.
    Advertising,
    /// Shared and targeted operations.
    Operations,
    /// Discounts for subscribers and first-bill discounts.
    Discounts,
    /// Strength of in-app advertising.
    InAppAds,
}

impl SuspendedSetting {
    pub(crate) const ALL: [SuspendedSetting; 5] = [
        SuspendedSetting::Development,
        SuspendedSetting::Advertising,
        SuspendedSetting::Operations,
        SuspendedSetting::Discounts,
        SuspendedSetting::InAppAds,
    ];

    /// Returns whether clearing the setting would change the settings.
    pub(crate) fn is_active(self, settings: &Settings) -> bool {
        let mut without = settings.clone();
        self.clear(&mut without);
        without != *settings
    }

    /// Sets the spending or discount to 0.
    pub(crate) fn clear(self, settings: &mut Settings) {
        match self {
            SuspendedSetting::Development => {
                settings.core.development = 0.0;
                settings.targeted_development = Default::default();
            }
            SuspendedSetting::Advertising => settings.targeted_ads = Default::default(),
            SuspendedSetting::Operations => {
                settings.core.operations = 0.0;
                settings.targeted_operations = Default::default();
            }
            SuspendedSetting::Discounts => {
                settings.promotion = Default::default();
                settings.lead_promotion = Default::default();
            }
            SuspendedSetting::InAppAds => settings.ads_strength = Default::default(),
        }
    }
}
