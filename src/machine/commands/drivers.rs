//! The settings of the motor drivers: M569, M906, M913, M914.
//!
//! X and Y both mean the four belt motors, which have one set of settings. A change reaches the drivers of motors
//! with power within a second, in the background and without stopping the motion; the others before they get it.

use crate::gcode::{AxisFlags, AxisWords, Number};
use crate::machine::answers::answer::Answer;
use crate::machine::answers::driver_value::DriverValue;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::state::clamps::Clamps;
use crate::machine::state::modal::Modal;
use crate::port::Pend;
use crate::settings::{DriverGroups, DriverSettings, Range, ranges};
use crate::units::MmPerSec;

/// M906, M913, M914, and M569. The named values are changed; without words all are reported.
pub(in crate::machine) fn set_drivers<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    value: DriverValue,
    words: &AxisWords,
    modal: &Modal,
    clamps: &mut Clamps,
) -> Answer<'static> {
    if main_loop.power.uarts().is_empty() {
        return Answer::Line("echo:drivers are set by their jumpers");
    }
    if *words == AxisWords::default() {
        return Answer::DriverValues(value);
    }
    let code = value.code();
    if words.x.is_some() && words.y.is_some() && words.x != words.y {
        return Answer::OneBelt(code);
    }
    let mut wanted = main_loop.settings.drivers;
    let DriverGroups { belt, z, e } = &mut wanted;
    let xy = if words.x.is_some() { "X" } else { "Y" };
    for (group, axis, number) in [(belt, xy, words.x.or(words.y)), (z, "Z", words.z), (e, "E", words.e)] {
        if let Some(number) = number {
            change(group, value, axis, number, modal, clamps);
        }
    }
    if !clamps.refuses_line() {
        main_loop.use_driver_settings(wanted);
    }
    Answer::Nothing
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

/// M569 S as a word for each axis that it names, all if it names none.
fn mode_words(stealth: bool, axes: AxisFlags) -> AxisWords {
    let all = axes == AxisFlags::default();
    let word = |is_named: bool| (is_named || all).then_some(Number::from(i32::from(stealth)));
    AxisWords { x: word(axes.x), y: word(axes.y), z: word(axes.z), e: word(axes.e) }
}

/// M569. The motion rests first: a motor that changes its mode at speed may lose steps.
pub(in crate::machine) async fn change_mode<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    modal: &Modal,
    clamps: &mut Clamps,
    stealth: Option<bool>,
    axes: AxisFlags,
) -> Result<Answer<'static>, Interrupt> {
    let mut words = AxisWords::default();
    if let Some(stealth) = stealth.filter(|_| !main_loop.power.uarts().is_empty()) {
        main_loop.finish().await?;
        words = mode_words(stealth, axes);
    }
    let answer = set_drivers(main_loop, DriverValue::Mode, &words, modal, clamps);
    main_loop.await_drivers().await?;
    Ok(answer)
}
