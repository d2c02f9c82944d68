//! What the machine says of itself.

use super::console::{Console, Interrupt, PortSet};
use super::limits::Homed;
use crate::gcode::Number;
use crate::port::{EndstopSet, Pend};
use crate::settings::CornerRule;
use crate::storage;
use crate::units::Mm;
use core::fmt;
use fixed::types::I32F32;

/// What hosts may rely on. AUTOREPORT_TEMP speaks of M155, which works, and not of heaters, of which the report says
/// as little as M105 does.
const CAPABILITIES: [(&str, u8); 8] = [
    ("SERIAL_XON_XOFF", 0),
    ("AUTOREPORT_POS", 1),
    ("AUTOREPORT_TEMP", 1),
    ("EMERGENCY_PARSER", 1),
    ("HOST_ACTION_COMMANDS", 1),
    ("PROMPT_SUPPORT", 1),
    ("SDCARD", 0),
    ("ARCS", 1),
];

/// A value with two decimals, as hosts expect positions.
pub(super) struct Hundredths(pub Mm);

impl fmt::Display for Hundredths {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bits = i128::from(self.0.to_bits()) * 100;
        let hundredths = (bits + (1 << 31)) >> 32;
        let sign = if hundredths < 0 { "-" } else { "" };
        let hundredths = hundredths.unsigned_abs();
        write!(f, "{sign}{}.{:02}", hundredths / 100, hundredths % 100)
    }
}

/// The temperatures. There is no heater yet; hosts take the form of the line as a sign of life.
pub(super) struct Temperatures;

impl fmt::Display for Temperatures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("T:0.00 /0.00 @:0")
    }
}

/// A position, and the counts of the motor groups.
pub(super) struct Position {
    at: [Mm; 4],
    counts: [i32; 4],
}

impl fmt::Display for Position {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z, e] = self.at.map(Hundredths);
        let [a, b, c, _] = self.counts;
        write!(f, "X:{x} Y:{y} Z:{z} E:{e} Count A:{a} B:{b} Z:{c}")
    }
}

/// A setting with as many decimals as reading it back needs.
pub(super) fn exact(value: impl Into<I32F32>) -> Number {
    Number::saturating(value.into())
}

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// M105.
    pub(super) async fn report_temperatures(&mut self) -> Result<(), Interrupt> {
        self.say(format_args!("ok {Temperatures}")).await
    }

    /// Where the program is, or with `real` where the tool is.
    pub(super) fn position(&self, real: bool) -> Position {
        let position = if real { self.planner.mm(self.real_steps()) } else { self.modal.position };
        Position { at: self.modal.named_position(position), counts: self.real_counts() }
    }

    /// M114.
    pub(super) async fn report_position(&mut self, real: bool) -> Result<(), Interrupt> {
        let position = self.position(real);
        self.say(format_args!("{position}")).await
    }

    /// M115.
    pub(super) async fn report_firmware(&mut self) -> Result<(), Interrupt> {
        self.say(format_args!(
            "FIRMWARE_NAME:CoreH-bot {} SOURCE_CODE_URL:- PROTOCOL_VERSION:1.0 MACHINE_TYPE:CoreH-bot \
             EXTRUDER_COUNT:1 UUID:00000000-0000-0000-0000-000000000000",
            env!("CARGO_PKG_VERSION")
        ))
        .await?;
        let has_storage = u8::from(storage::is_present(&self.ports.storage));
        self.say(format_args!("Cap:EEPROM:{has_storage}")).await?;
        for (name, value) in CAPABILITIES {
            self.say(format_args!("Cap:{name}:{value}")).await?;
        }
        Ok(())
    }

    /// M119.
    pub(super) async fn report_endstops(&mut self) -> Result<(), Interrupt> {
        self.link.look_at_endstops();
        self.turn().await?;
        let pressed = self.link.status().endstops();
        let state = |e: EndstopSet| if pressed.has(e) { "TRIGGERED" } else { "open" };
        let (x, y, z) = (state(EndstopSet::X), state(EndstopSet::Y), state(EndstopSet::Z));
        self.say(format_args!("Reporting endstop status")).await?;
        self.say(format_args!("x_min: {x}")).await?;
        self.say(format_args!("y_min: {y}")).await?;
        self.say(format_args!("z_min: {z}")).await?;
        if self.link.status().inputs().has(EndstopSet::PROBE) {
            self.say(format_args!("z_probe: {}", state(EndstopSet::PROBE))).await?;
        }
        Ok(())
    }

    /// M211 without S.
    pub(super) async fn report_soft_endstops(&mut self) -> Result<(), Interrupt> {
        let state = if self.settings.soft_endstops { "ON" } else { "OFF" };
        let a = self.settings.axes;
        let (x, y, z) = (Hundredths(a.x.length), Hundredths(a.y.length), Hundredths(a.z.length));
        let Homed([hx, hy, hz]) = self.homed;
        let known = if hx && hy && hz { "" } else { "  (once homed)" };
        self.say(format_args!("Soft endstops: {state}  Min:  X0.00 Y0.00 Z0.00   Max:  X{x} Y{y} Z{z}{known}")).await
    }

    /// M503: every setting that G-code can set, as the line that sets it.
    pub(super) async fn report_settings(&mut self) -> Result<(), Interrupt> {
        self.say(format_args!("echo:  G21")).await?;
        self.report_resolutions().await?;
        self.report_max_speeds().await?;
        self.report_max_accelerations().await?;
        self.report_accelerations().await?;
        self.report_corners().await?;
        self.report_retraction().await?;
        self.report_recovery().await?;
        self.report_driver_settings().await?;
        let (soft, keepalive) = (u8::from(self.settings.soft_endstops), self.settings.keepalive_s);
        self.say(format_args!("echo:  M211 S{soft}")).await?;
        self.say(format_args!("echo:  M113 S{keepalive}")).await
    }

    pub(super) async fn report_resolutions(&mut self) -> Result<(), Interrupt> {
        let [x, y, z, e] = self.settings.axes.map(|a| exact(a.steps_per_mm)).to_array();
        self.say(format_args!("echo:  M92 X{x} Y{y} Z{z} E{e}")).await
    }

    pub(super) async fn report_max_speeds(&mut self) -> Result<(), Interrupt> {
        let [x, y, z, e] = self.settings.axes.map(|a| exact(a.max_speed)).to_array();
        self.say(format_args!("echo:  M203 X{x} Y{y} Z{z} E{e}")).await
    }

    pub(super) async fn report_max_accelerations(&mut self) -> Result<(), Interrupt> {
        let [x, y, z, e] = self.settings.axes.map(|a| exact(a.max_acceleration)).to_array();
        self.say(format_args!("echo:  M201 X{x} Y{y} Z{z} E{e}")).await
    }

    pub(super) async fn report_accelerations(&mut self) -> Result<(), Interrupt> {
        let s = &self.settings;
        let (p, r, t) = (exact(s.print_acceleration), exact(s.retract_acceleration), exact(s.travel_acceleration));
        self.say(format_args!("echo:  M204 P{p} R{r} T{t}")).await
    }

    pub(super) async fn report_corners(&mut self) -> Result<(), Interrupt> {
        let s = &self.settings;
        let (e, feed, travel) = (exact(s.extruder_jerk), exact(s.min_feed), exact(s.min_travel));
        match s.corner {
            CornerRule::JunctionDeviation(d) => {
                self.say(format_args!("echo:  M205 J{} E{e} S{feed} T{travel}", exact(d))).await
            }
            CornerRule::SquareCorner(v) => {
                let v = exact(v);
                self.say(format_args!("echo:  M205 X{v} Y{v} E{e} S{feed} T{travel}")).await
            }
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::ToString;

    #[test]
    fn positions_have_two_decimals_and_one_sign() {
        let text = |v: f64| Hundredths(Mm::from_num(v)).to_string();
        assert_eq!(text(1.005_1), "1.01");
        assert_eq!(text(-0.5), "-0.50");
        assert_eq!(text(-0.001), "0.00");
        assert_eq!(text(417.6), "417.60");
    }
}
