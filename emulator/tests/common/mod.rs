//! The image under test, and how it is run.
#![allow(dead_code, reason = "each file of tests uses some of it")]

use corehbot::settings::Settings;
use corehbot_emulator::driver_line::DriverLines;
use corehbot_emulator::firmware::Firmware;
use corehbot_emulator::line::Manner;
use corehbot_emulator::run::{Request, Seen, run};
use corehbot_emulator::watch::{Injection, Patience};
use corehbot_emulator::wiring::OCTOPUS;
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
    serve(firmware, gcode, None, Manner::default(), injection)
}

/// Prints `gcode`, and `second` from the other serial port at the same time.
pub fn serve(
    firmware: &Firmware,
    gcode: &str,
    second: Option<&str>,
    manner: Manner,
    injection: Option<Injection>,
) -> Seen {
    print_on(firmware, (gcode, second), manner, injection, &drivers())
}

/// Drivers as new in all slots.
pub fn drivers() -> DriverLines {
    DriverLines::new(&OCTOPUS)
}

/// Prints `gcode` with drivers of one's own.
pub fn print_with(firmware: &Firmware, gcode: &str, injection: Option<Injection>, drivers: &DriverLines) -> Seen {
    print_on(firmware, (gcode, None), Manner::default(), injection, drivers)
}

fn print_on(
    firmware: &Firmware,
    (gcode, second): (&str, Option<&str>),
    manner: Manner,
    injection: Option<Injection>,
    drivers: &DriverLines,
) -> Seen {
    let settings = Settings::prototype();
    let patience = Patience { whole: 120_000 * MS, silent: 10_000 * MS, after_reset: 50 * MS };
    let wiring = &OCTOPUS;
    let settings = &settings;
    let request = Request { firmware, wiring, settings, gcode, second, manner, patience, injection, drivers };
    run(&request).unwrap_or_else(|e| panic!("{e:#}"))
}
