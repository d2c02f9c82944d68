//! The settings of the motor drivers: M569, M906, M913, M914.
//!
//! X and Y both mean the four belt motors, which have one set of settings. With I a line is for one driver of an axis,
//! as in Marlin (`M906.cpp`): I0 is the first, -1 is all of them. It sets the motor's own value, and 0 takes that away.
//! A change reaches the drivers of motors with power within a second, in the background and without stopping the
//! motion; the others before they get it.

use super::driver_report::{report_driver_values, report_own_driver_values};
use crate::gcode::{Absent, AxisWords, Named, Number, Part};
use crate::machine::answers::answer::Answer;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::reports::driver_value::DriverValue;
use crate::machine::state::clamps::Clamps;
use crate::machine::state::modal::Modal;
use crate::machine::states::{States, tell_clamps};
use crate::port::{Motor, Wake};
use crate::settings::{DriverSettings, OwnDriver, Range, Settings, ranges};
use crate::units::MmPerSec;

/// The drivers that a word of an axis sets.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Place {
    /// All of the group.
    Group,
    /// A single one.
    Motor(Motor),
}

/// The drivers of an axis that I selects. `None` if it has no such driver.
fn place(s: &Settings, axis: usize, driver: Option<Number>) -> Option<Place> {
    let Some(driver) = driver.filter(|driver| *driver != Number::from(-1)) else { return Some(Place::Group) };
    let single = s.single_drivers(axis);
    if single.is_empty() {
        return (driver == Number::ZERO).then_some(Place::Group);
    }
    let found = (0..).zip(single.iter()).find(|(number, _)| Number::from(*number) == driver);
    found.map(|(_, motor)| Place::Motor(motor))
}

/// M906, M913, M914, and M569. The named values are changed; without words all are reported.
pub(in crate::machine) fn set_drivers<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    value: DriverValue,
    words: &AxisWords,
    driver: Option<Number>,
    states: &mut States,
) -> Answer<'static> {
    let States { modal, clamps, notices, .. } = states;
    let (code, is_report) = (value.code(), *words == AxisWords::default());
    let asked = [words.x, words.y, words.z, words.e];
    let places = [0, 1, 2, 3].map(|axis| place(&main_loop.settings, axis, driver));
    let mut named = places.iter().zip(asked).filter(|(_, number)| is_report || number.is_some());
    let is_absent =
        if is_report { named.all(|(place, _)| place.is_none()) } else { named.any(|(place, _)| place.is_none()) };
    if let Some(driver) = driver.filter(|_| is_absent) {
        let which = driver.value().to_bits().to_le_bytes();
        let absent = Absent { command: Named::Name(code), part: Part::Driver, which: &which };
        if !notices.give_absent(absent.key()) {
            return Answer::Nothing;
        }
        let part = Part::Driver.name();
        main_loop.say(text!("echo:{code} ignored: there is no {part} {driver}"));
        return Answer::Said;
    }
    if main_loop.power.uarts().is_empty() {
        return Answer::Line(packed!("echo:drivers are set by their jumpers"));
    }
    if is_report {
        main_loop.tell(|to, facts| report_driver_values(to, value, facts.settings));
        return Answer::Said;
    }
    let [x, y, ..] = places;
    let are_one = words.x.is_some() && words.y.is_some() && x == y;
    if are_one && words.x != words.y {
        main_loop.say(text!("echo:{code} ignored: X and Y move one belt and need the same value"));
        return Answer::Said;
    }
    let (mut wanted, mut sets_group) = (main_loop.settings.drivers, false);
    for (axis, (place, number)) in places.into_iter().zip(asked).enumerate() {
        // X has set the belt.
        let Some(number) = number.filter(|_| !(are_one && axis == 1)) else { continue };
        let (group, letter) = match axis {
            0 => (&mut wanted.belt, "X"),
            1 => (&mut wanted.belt, "Y"),
            2 => (&mut wanted.z, "Z"),
            _ => (&mut wanted.e, "E"),
        };
        let Some(Place::Motor(motor)) = place else {
            change(group, value, letter, number, modal, clamps);
            sets_group = true;
            continue;
        };
        let present = main_loop.settings.driver_of(motor);
        if let Some(own) = wanted.own.get_mut(motor.index()) {
            change_own(own, &present, value, letter, number, clamps);
        }
    }
    if clamps.refuses_line() {
        return Answer::Nothing;
    }
    main_loop.use_driver_settings(wanted);
    // Motors with their own value do not follow their group.
    let has_own = value.of_motors(&main_loop.settings).next().is_some();
    if !(sets_group && has_own) {
        return Answer::Nothing;
    }
    tell_clamps(main_loop, clamps);
    main_loop.tell(|to, facts| report_own_driver_values(to, value, facts.settings));
    Answer::Said
}

/// Changes a value of a single motor if it is legal; 0 is the value of its group.
fn change_own(
    own: &mut OwnDriver,
    present: &DriverSettings,
    value: DriverValue,
    axis: &'static str,
    number: Number,
    clamps: &mut Clamps,
) {
    let (range, present) = match value {
        DriverValue::Current => (ranges::CURRENT_MA, present.current_ma),
        DriverValue::StallThreshold => {
            let Range { least, most } = ranges::OWN_STALL_THRESHOLD;
            (Range { least: least.into(), most: most.into() }, present.stall_threshold.into())
        }
        // The drivers of an axis have one value.
        DriverValue::HybridThreshold | DriverValue::Mode => return,
    };
    let is_group = number == Number::ZERO;
    let wanted = if is_group { Some(0) } else { clamps.whole_of([value.code(), axis], number, range, Some(present)) };
    match (value, wanted) {
        (DriverValue::Current, Some(wanted)) => own.current_ma = wanted,
        (DriverValue::StallThreshold, Some(wanted)) => own.stall_threshold = wanted as u8,
        _ => {}
    }
}

/// Changes one value if it is legal.
fn change(
    group: &mut DriverSettings,
    value: DriverValue,
    axis: &'static str,
    number: Number,
    modal: &Modal,
    clamps: &mut Clamps,
) {
    let word = [value.code(), axis];
    match value {
        DriverValue::Current => clamps.whole(word, number, ranges::CURRENT_MA, &mut group.current_ma),
        DriverValue::HybridThreshold => {
            let range = Range { least: MmPerSec::ZERO, ..ranges::SPEED };
            clamps.length(modal, word, number, range, &mut group.hybrid_threshold);
        }
        DriverValue::StallThreshold => {
            let mut wanted = u16::from(group.stall_threshold);
            clamps.whole(word, number, Range { least: 0, most: u16::from(u8::MAX) }, &mut wanted);
            group.stall_threshold = wanted as u8;
        }
        DriverValue::Mode => group.stealth = number != Number::ZERO,
    }
}
