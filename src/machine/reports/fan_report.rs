//! How fast fans with a tachometer turn (M123, M122).

use crate::connectors::FANS;
use crate::machine::answers::reply_writer::ReplyWriter;
use crate::settings::{FanRole, Settings, part_fans};
use crate::status::Heat;
use crate::thermal::guard::turns_a_minute;
use core::fmt;

/// The fans as M123 has them, in the order of their outputs: `PRN1:3000 RPM E0:4200 RPM PRN1@:127 E0@:255`, the turns a
/// minute and then the duties of 255. Hotend fans are Marlin's E0, E1 and so on (`print_fan_states`), part fans PRN1
/// and so on as Prusa's firmwares have them; any other has the name of its output.
pub(in crate::machine) struct FanTurns<'a> {
    pub settings: &'a Settings,
    pub heat: &'a Heat,
}

impl FanTurns<'_> {
    /// Whether there is a fan with a tachometer.
    pub fn has_any(&self) -> bool {
        (0..FANS).any(|fan| self.heat.tachometer(fan).is_some())
    }
}

impl fmt::Display for FanTurns<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { settings, heat } = self;
        let parts = part_fans(settings.thermal.fans.map(|fan| fan.role));
        let mut gap = "";
        for is_of_duties in [false, true] {
            let (mut hotend_fans, mut part_fans) = (0, 1);
            for (fan, (its, is_part)) in settings.thermal.fans.iter().zip(parts).enumerate() {
                let Some(pulses) = heat.tachometer(fan) else { continue };
                let mut number = fan;
                let (name, count) = match its.role {
                    FanRole::Hotend => ("E", &mut hotend_fans),
                    _ if is_part => ("PRN", &mut part_fans),
                    _ => ("FAN", &mut number),
                };
                let (mark, value, unit) = match is_of_duties {
                    false => (":", turns_a_minute(pulses, settings.fan_pulses), " RPM"),
                    true => ("@:", u32::from(heat.fan(fan) >> 8), ""),
                };
                write!(f, "{gap}{name}{count}{mark}{value}{unit}")?;
                *count += 1;
                gap = " ";
            }
        }
        Ok(())
    }
}

/// Part of M122.
pub(super) fn report_fans(to: &mut ReplyWriter<'_>, settings: &Settings, heat: &Heat) {
    let turns = FanTurns { settings, heat };
    if turns.has_any() {
        to.say(text!("echo:fans {turns}"));
    }
}
