//! Steps: the table of the guide. docs/tutorial/first-hour.md has the same steps in the same order (a test checks
//! that).

use super::guide::{Failure, Found, Guide};
use super::step_error::StepError;
use super::{advice, directions, drivers, endstops, greeting, heaters, homing, motors, sensors, supply, tuning};

/// A step. Each is safe by itself, and may be done again or skipped.
pub(super) struct Step {
    /// Its name, for `--from`.
    pub name: &'static str,
    /// Its heading.
    pub title: &'static str,
    /// What it does.
    pub does: &'static str,
    /// What the owner is asked.
    pub asks: &'static str,
    /// Steps that should have passed before.
    pub needs: &'static [&'static str],
    /// What may be wrong, with cures.
    pub failures: &'static [&'static Failure],
    pub run: fn(&mut Guide) -> Result<Found, StepError>,
}

/// Every step in its order.
pub(super) const STEPS: [Step; 11] = [
    Step {
        name: "greeting",
        title: "The board answers",
        does: "Asks for the firmware and the machine, and for a fault from before.",
        asks: "Nothing.",
        needs: &[],
        failures: greeting::FAILURES,
        run: greeting::run,
    },
    Step {
        name: "supply",
        title: "Supply voltages",
        does: "Notes the voltages that the board cannot measure by itself.",
        asks: "To measure them with a meter.",
        needs: &[],
        failures: supply::FAILURES,
        run: supply::run,
    },
    Step {
        name: "sensors",
        title: "Thermistors",
        does: "Reads every thermistor in the cold, then watches which one a warm hand changes.",
        asks: "To hold each sensor in a hand.",
        needs: &[],
        failures: sensors::FAILURES,
        run: sensors::run,
    },
    Step {
        name: "endstops",
        title: "Endstops",
        does: "Reads every switch before, while and after it is pressed.",
        asks: "To press each switch and to let it go.",
        needs: &[],
        failures: endstops::FAILURES,
        run: endstops::run,
    },
    Step {
        name: "drivers",
        title: "Motor drivers",
        does: "Asks every driver over its wire. No motor gets power.",
        asks: "Nothing.",
        needs: &[],
        failures: drivers::FAILURES,
        run: drivers::run,
    },
    Step {
        name: "motors",
        title: "Motors",
        does: "Moves every motor alone, 1 mm to and fro, and finds the wiring from what was seen.",
        asks: "To put the tool where it has 10 mm of room, and where it goes each time.",
        needs: &[],
        failures: motors::FAILURES,
        run: motors::run,
    },
    Step {
        name: "heaters",
        title: "Heaters",
        does: "Warms every heater by some degrees (SELF_TEST). Its own sensor must follow, and no other.",
        asks: "To stay with the machine, a hand at its plug.",
        needs: &["sensors"],
        failures: heaters::FAILURES,
        run: heaters::run,
    },
    Step {
        name: "homing",
        title: "Homing",
        does: "Homes one axis after the other, slowly. Enter stops everything at once (M112).",
        asks: "To start each axis, and whether it met its switch.",
        needs: &["endstops", "motors"],
        failures: homing::FAILURES,
        run: homing::run,
    },
    Step {
        name: "directions",
        title: "Directions",
        does: "Moves every axis by 10 mm.",
        asks: "Where it went.",
        needs: &["homing"],
        failures: directions::FAILURES,
        run: directions::run,
    },
    Step {
        name: "tuning",
        title: "Heater tuning",
        does: "Finds the gains of every heater (M303) and stores them (M500). It takes some minutes.",
        asks: "Whether to heat now.",
        needs: &["sensors", "heaters"],
        failures: tuning::FAILURES,
        run: tuning::run,
    },
    Step {
        name: "first-layer",
        title: "First layer",
        does: "Says how to set the height of the nozzle, and what to print first.",
        asks: "Nothing.",
        needs: &[],
        failures: &[],
        run: advice::run,
    },
];
