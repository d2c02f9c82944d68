//! The image under test, and how it is run.
#![allow(dead_code, reason = "each test is a program of its own and needs but some of this")]

use corehbot::settings::Settings;
use corehbot_emulator::eeprom::At24c32;
use corehbot_emulator::firmware::Firmware;
use corehbot_emulator::run::{Request, Seen, run};
use corehbot_emulator::watch::{Injection, Patience};
use corehbot_emulator::wiring::{OCTOPUS, Pin};
use std::path::{Path, PathBuf};

/// A virtual millisecond in ns.
pub const MS: u64 = 1_000_000;

/// The image that `COREHBOT_ELF` names, or the one in the checkout's own target directory.
pub fn firmware() -> Firmware {
    let default = || root().join("target/thumbv7em-none-eabihf/release/corehbot-octopus");
    let path = std::env::var_os("COREHBOT_ELF").map_or_else(default, PathBuf::from);
    Firmware::read(&path).unwrap_or_else(|e| panic!("build the image first or set COREHBOT_ELF: {e:#}"))
}

/// The checkout.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Prints `gcode` with the image, and with a fault if there is one.
pub fn print(firmware: &Firmware, gcode: &str, injection: Option<Injection>) -> Seen {
    let eeprom = At24c32::default();
    print_with(firmware, gcode, injection, &eeprom, &[], None)
}

/// Prints `gcode` with a board whose EEPROM is `eeprom`, with voltages on channels of ADC3, and of which a pin may be
/// held.
pub fn print_with(
    firmware: &Firmware,
    gcode: &str,
    injection: Option<Injection>,
    eeprom: &At24c32,
    thermistors: &[(u8, u32)],
    stuck: Option<(Pin, bool)>,
) -> Seen {
    let settings = Settings::prototype();
    let patience = Patience { whole: 120_000 * MS, silent: 10_000 * MS, after_reset: 50 * MS };
    let request = Request {
        firmware,
        wiring: &OCTOPUS,
        settings: &settings,
        gcode,
        patience,
        injection,
        eeprom,
        thermistors,
        stuck,
    };
    run(&request).unwrap_or_else(|e| panic!("{e:#}"))
}
