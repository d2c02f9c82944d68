//! Fans: the source of each fan's speed, and the kick that its motor needs to start. [`Fan::period`] turns a commanded
//! speed (M106) into a duty, one control period at a time. M303 bypasses it (`set_fan` in `control.rs`, which also
//! counts the run-on of the controller fan).

use super::fixed_point::PERIOD_MS;
use crate::settings::{FanRole, FanSettings};

/// Needs for fans that G-code does not control.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Needs {
    /// The hotend is warm.
    pub hotend: bool,
    /// Motors or heaters have power, or had it within the run-on time.
    pub controller: bool,
    /// A heat fault: all fans at full speed.
    pub all: bool,
}

/// One fan.
#[derive(Clone, Copy, Debug)]
pub struct Fan {
    settings: FanSettings,
    commanded: u16,
    /// Remaining periods of the kick.
    kick: u16,
    given: u16,
}

impl Fan {
    /// A stopped fan.
    #[must_use]
    pub const fn new(settings: FanSettings) -> Self {
        Self { settings, commanded: 0, kick: 0, given: 0 }
    }

    /// Takes other settings.
    pub const fn configure(&mut self, settings: FanSettings) {
        self.settings = settings;
    }

    /// Its settings.
    #[must_use]
    pub const fn settings(&self) -> &FanSettings {
        &self.settings
    }

    /// Sets its commanded speed, of 65,535.
    pub const fn command(&mut self, speed: u16) {
        self.commanded = speed;
    }

    /// The duty for the next control period, of 65,535.
    pub fn period(&mut self, needs: Needs) -> u16 {
        let speed = match self.settings.role {
            _ if needs.all => u16::MAX,
            FanRole::Commanded | FanRole::Part => self.commanded,
            FanRole::Hotend if needs.hotend => u16::MAX,
            FanRole::Controller if needs.controller => u16::MAX,
            FanRole::Hotend | FanRole::Controller => 0,
        };
        if speed == 0 {
            (self.kick, self.given) = (0, 0);
            return 0;
        }
        if self.given == 0 {
            self.kick = self.settings.kick_ms.div_ceil(PERIOD_MS as u16);
        }
        let [least, most] = [self.settings.least, self.settings.most].map(|part| part.to_bits().min(1 << 16));
        let span = u64::from(most.saturating_sub(least));
        // Plus one, so that full speed is `most` and nothing less.
        let scaled = u64::from(least) + ((span * (u64::from(speed) + 1)) >> 16);
        // At least 1: the next period would take 0 for a fan that stands, and kick it again.
        self.given = if self.kick > 0 { u16::MAX } else { (scaled.max(1) as u32).min(65_535) as u16 };
        self.kick = self.kick.saturating_sub(1);
        self.given
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Ratio;

    #[test]
    fn a_fan_is_kicked_and_scaled() {
        let mut fan = Fan::new(FanSettings {
            kick_ms: 60,
            least: Ratio::lit("0.25"),
            most: Ratio::lit("0.75"),
            ..FanSettings::new(FanRole::Commanded)
        });
        assert_eq!(fan.period(Needs::default()), 0);
        fan.command(32_767);
        let duties = [(); 5].map(|()| fan.period(Needs::default()));
        assert_eq!(duties, [65_535, 65_535, 65_535, 32_768, 32_768]);
        fan.command(1);
        assert_eq!(fan.period(Needs::default()), 16_385);
        fan.command(0);
        assert_eq!(fan.period(Needs::default()), 0);
        assert_eq!(fan.period(Needs { all: true, ..Needs::default() }), 65_535);
    }

    #[test]
    fn roles_decide() {
        let mut fans =
            [FanRole::Commanded, FanRole::Hotend, FanRole::Controller].map(|role| Fan::new(FanSettings::new(role)));
        let mut run = |needs| fans.each_mut().map(|fan| fan.period(needs) > 0);
        assert_eq!(run(Needs { hotend: true, ..Needs::default() }), [false, true, false]);
        assert_eq!(run(Needs { controller: true, ..Needs::default() }), [false, false, true]);
        assert_eq!(run(Needs { all: true, ..Needs::default() }), [true; 3]);
        assert_eq!(run(Needs::default()), [false; 3]);
    }
}
