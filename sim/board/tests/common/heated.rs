//! A machine with heaters that warm within seconds.

use corehbot::connectors::Heater;
use corehbot::settings::Settings;
use corehbot::units::Watts;

/// A hotend and a bed, with a small one's time to warm.
pub fn heated() -> Settings {
    let mut settings = Settings::prototype();
    for heater in [Heater::Hotend, Heater::Bed] {
        settings.thermal.heater_mut(heater).is_fitted = true;
    }
    settings.thermal.heaters.bed.power = Watts::from_num(1000);
    settings
}
