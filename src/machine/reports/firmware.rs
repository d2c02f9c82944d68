//! M115: name, version and capabilities. A stopped machine answers it too (`main_loop::halted`).

use crate::connectors::Heater;
use crate::machine::answers::reply_writer::ReplyWriter;
use crate::machine::answers::words::Facts;
use crate::port::EndstopSet;
use crate::settings::HomedAxis;

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

/// The lines. BTT's screens and OctoPrint's EEPROM editor look for Marlin in the name.
pub(in crate::machine) fn report_firmware(to: &mut ReplyWriter<'_>, facts: &Facts<'_>) {
    let (s, inputs) = (facts.settings, facts.status.inputs());
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
            Has::Storage => facts.has_storage,
            Has::Chamber => s.thermal.heater(Heater::Chamber).is_fitted,
            Has::Probe => s.probe.is_fitted() && inputs.has(EndstopSet::PROBE),
            Has::Z => !s.mechanism.motors_of(HomedAxis::Z as usize).is_empty(),
        };
        to.say(text!("Cap:{name}:{}", u8::from(is_there)));
    }
}
