//! Reports: the wording of the machine's state. `report` holds the wording, `answer` the content.
//!
//! Plain functions of their subject: position (M114), firmware (M115), endstops (M119, M211), overload (M122).

use crate::connectors::Heater;
use crate::kinematics::Groups;
use crate::machine::answers::reply_writer::ReplyWriter;
use crate::machine::numbers::{exact, shortest_with};
use crate::machine::state::commanded::Commanded;
use crate::machine::state::position::RealPosition;
use crate::motors::MOST_GROUPS;
use crate::port::EndstopSet;
use crate::settings::{Cartesian, Endstop, HomedAxis, Settings};
use crate::status::{Late, Overload};
use crate::units::{Mm, TICKS_PER_MS};
use core::fmt;
use fixed::types::I32F32;

/// What a capability depends on.
#[derive(Clone, Copy)]
enum Has {
    /// Every machine has it.
    Always,
    /// This firmware has it on no machine.
    Never,
    /// Memory for settings.
    Storage,
    /// The heater of a chamber.
    Chamber,
    /// A probe at an input of the board: it measures the bed, too.
    Probe,
    /// Motors of z.
    Z,
}

/// The capabilities that hosts may rely on: all those of Marlin (M115.cpp), because a screen assumes some that are not
/// named (BTT's TouchScreenFirmware, Settings.c: Z_PROBE, LEVELING_DATA, EEPROM). AUTOREPORT_TEMP means that M155
/// works, even without heaters. BUILD_PERCENT: M73 is kept. PRINT_JOB: M75 to M77 keep no time. THERMAL_PROTECTION: no
/// setting switches a guard off.
const CAPABILITIES: [(&str, Has); 38] = [
    ("EEPROM", Has::Storage),
    ("CHAMBER_TEMPERATURE", Has::Chamber),
    ("PAREN_COMMENTS", Has::Always),
    ("QUOTED_STRINGS", Has::Always),
    ("SERIAL_XON_XOFF", Has::Never),
    ("BINARY_FILE_TRANSFER", Has::Never),
    ("VOLUMETRIC", Has::Never),
    ("AUTOREPORT_POS", Has::Always),
    ("AUTOREPORT_TEMP", Has::Always),
    ("PROGRESS", Has::Never),
    ("PRINT_JOB", Has::Never),
    ("AUTOLEVEL", Has::Probe),
    ("RUNOUT", Has::Never),
    ("Z_PROBE", Has::Probe),
    ("LEVELING_DATA", Has::Probe),
    ("BUILD_PERCENT", Has::Always),
    ("SOFTWARE_POWER", Has::Never),
    ("TOGGLE_LIGHTS", Has::Never),
    ("CASE_LIGHT_BRIGHTNESS", Has::Never),
    ("EMERGENCY_PARSER", Has::Always),
    ("HOST_ACTION_COMMANDS", Has::Always),
    ("PROMPT_SUPPORT", Has::Always),
    ("SDCARD", Has::Never),
    ("MULTI_VOLUME", Has::Never),
    ("REPEAT", Has::Never),
    ("SD_WRITE", Has::Never),
    ("AUTOREPORT_SD_STATUS", Has::Never),
    ("LONG_FILENAME", Has::Never),
    ("LFN_WRITE", Has::Never),
    ("CUSTOM_FIRMWARE_UPLOAD", Has::Never),
    ("EXTENDED_M20", Has::Never),
    ("THERMAL_PROTECTION", Has::Always),
    ("MOTION_MODES", Has::Never),
    ("ARCS", Has::Always),
    ("BABYSTEPPING", Has::Z),
    ("COOLER_TEMPERATURE", Has::Never),
    ("MEATPACK", Has::Never),
    ("CONFIG_EXPORT", Has::Never),
];

/// A value with two decimals, as hosts expect positions.
pub(in crate::machine) struct Hundredths(I32F32);

impl Hundredths {
    pub fn of(value: impl Into<I32F32>) -> Self {
        Self(value.into())
    }
}

impl fmt::Display for Hundredths {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bits = self.0.to_bits();
        let hundredths = (bits >> 32) * 100 + (((bits & 0xFFFF_FFFF) * 100 + (1 << 31)) >> 32);
        let sign = if hundredths < 0 { "-" } else { "" };
        let hundredths = hundredths.unsigned_abs();
        write!(f, "{sign}{}.{:02}", hundredths / 100, hundredths % 100)
    }
}

/// A position, and the counts of the motor groups that move the tool.
pub(in crate::machine) struct Position<'m> {
    at: [Mm; 4],
    counts: [i32; MOST_GROUPS],
    groups: &'m Groups,
    /// The circulation of the belt, if it can circulate.
    circulation: Option<Mm>,
}

/// The letters of axes, and of coordinates that are a sum of axes.
const LETTERS: ([char; 4], [char; MOST_GROUPS]) = (['X', 'Y', 'Z', 'E'], ['A', 'B', 'C', 'D', 'E']);

impl fmt::Display for Position<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z, e] = self.at.map(Hundredths::of);
        write!(f, "X:{x} Y:{y} Z:{z} E:{e}")?;
        if let Some(c) = self.circulation.map(Hundredths::of) {
            write!(f, " C:{c}")?;
        }
        put!(f, " Count")?;
        let (axes, sums) = LETTERS;
        let mut sums = sums.into_iter();
        for (group, count) in self.groups.iter().zip(self.counts).filter(|(group, _)| group.is_tool()) {
            let letter = match group.axis() {
                Some(axis) => axes.get(axis).copied(),
                None => sums.next(),
            };
            write!(f, " {}:{count}", letter.unwrap_or_default())?;
        }
        Ok(())
    }
}

impl<'m> Position<'m> {
    /// The named position of a machine at `position`, with the step counts of its motor groups.
    pub fn new(
        position: [Mm; 4],
        circulation: Option<Mm>,
        counts: [i32; MOST_GROUPS],
        commanded: &Commanded,
        real: &RealPosition<'m>,
    ) -> Self {
        let (at, counts) = (commanded.named(position), real.of_groups(counts));
        Self { at, counts, groups: real.groups(), circulation }
    }
}

/// M115. BTT's screens and OctoPrint's EEPROM editor look for Marlin in the name.
pub(in crate::machine) fn report_firmware(
    to: &mut ReplyWriter<'_>,
    has_storage: bool,
    inputs: EndstopSet,
    s: &Settings,
) {
    to.say(text!(
        "FIRMWARE_NAME:CoreH-bot {} (Marlin dialect) SOURCE_CODE_URL:- PROTOCOL_VERSION:1.0 MACHINE_TYPE:{} \
         EXTRUDER_COUNT:1 UUID:00000000-0000-0000-0000-000000000000",
        env!("CARGO_PKG_VERSION"),
        s.name
    ));
    for (name, has) in CAPABILITIES {
        let is_there = match has {
            Has::Always => true,
            Has::Never => false,
            Has::Storage => has_storage,
            Has::Chamber => s.thermal.heater(Heater::Chamber).is_fitted,
            Has::Probe => s.probe.is_fitted() && inputs.has(EndstopSet::PROBE),
            Has::Z => !s.mechanism.motors_of(HomedAxis::Z as usize).is_empty(),
        };
        to.say(text!("Cap:{name}:{}", u8::from(is_there)));
    }
}

/// M119: which endstops are pressed, of the inputs that there are, and whether filament presses the switch of its
/// sensor.
pub(in crate::machine) fn report_endstops(
    to: &mut ReplyWriter<'_>,
    pressed: EndstopSet,
    inputs: EndstopSet,
    endstops: &Cartesian<Endstop>,
    filament: Option<bool>,
) {
    let state = |e: EndstopSet| if pressed.has(e) { "TRIGGERED" } else { "open" };
    to.say(text!("Reporting endstop status"));
    let of_axis =
        [('x', endstops.x, EndstopSet::X), ('y', endstops.y, EndstopSet::Y), ('z', endstops.z, EndstopSet::Z)];
    for (axis, endstop, switch) in of_axis {
        to.say(text!("{axis}_{}: {}", endstop.end.name(), state(switch)));
    }
    if inputs.has(EndstopSet::PROBE) {
        to.say(text!("z_probe: {}", state(EndstopSet::PROBE)));
    }
    if let Some(is_there) = filament {
        // Marlin's words: with filament the switch has triggered (`Endstops::report_states`).
        to.say(text!("filament: {}", if is_there { "TRIGGERED" } else { "open" }));
    }
}

/// Part of M122: overload since the start, and its worst case.
pub(in crate::machine) fn report_overload(to: &mut ReplyWriter<'_>, overload: Overload) {
    let Overload { events, spans, starved, underruns } = overload;
    let us = |late: Late| late.worst / const { TICKS_PER_MS / 1000 };
    to.say(text!(
        "echo:overload: {} steps late, worst {} us; {} spans stretched, worst {} us; {starved} times out of steps, \
         {underruns} times out of moves",
        events.count,
        us(events),
        spans.count,
        us(spans)
    ));
}

/// M290: the sum of all shifts since z was homed (Marlin's words), and the kept offsets. These are the probe's offset
/// if it homes z, the program's offset, and the sum by which both lift the nozzle.
pub(in crate::machine) fn report_z_offset(to: &mut ReplyWriter<'_>, shifted: Mm, s: &Settings, are_stored: [bool; 2]) {
    to.say(text!("echo:Babystep Z{}", Hundredths::of(shifted)));
    let [news, news_of_probe] = are_stored.map(|is_stored| if is_stored { "" } else { ", not saved: M500 keeps it" });
    let kept = exact(s.bed.z_offset);
    if s.homes_z_by_probe() {
        to.say(text!("echo:Probe Offset Z{}{news_of_probe}", exact(s.probe.offset.z)));
        // The sum of two rounded decimals is a bit or two off the decimal that it means.
        let sum = shortest_with(s.probe_in_program().offset.z.into(), 24);
        to.say(text!("echo:Z offset {kept}, the sum is {sum}{news}"));
    } else {
        to.say(text!("echo:Z offset {kept}{news}"));
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::ToString;

    #[test]
    fn positions_have_two_decimals_and_one_sign() {
        let text = |v: f64| Hundredths::of(Mm::from_num(v)).to_string();
        assert_eq!(text(1.005_1), "1.01");
        assert_eq!(text(-0.5), "-0.50");
        assert_eq!(text(-0.001), "0.00");
        assert_eq!(text(417.6), "417.60");
        assert_eq!(Hundredths::of(Mm::MAX).to_string(), "2147483648.00");
        assert_eq!(Hundredths::of(Mm::MIN).to_string(), "-2147483648.00");
    }
}
