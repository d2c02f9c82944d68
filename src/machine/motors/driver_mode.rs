//! M569: stealthChop or spreadCycle.

use super::drivers::set_drivers;
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{AxisFlags, AxisWords, Grammar, Number, Part, Verdict, Words};
use crate::machine::reports::driver_value::DriverValue;

/// With P it is RepRapFirmware's, and turns a motor round.
pub(in crate::machine) const ENTRY: Entry = Entry::m("Motors and drivers", &[569])
    .grammar(&Grammar::numbers(b"").parts(&[(b'I', Part::Driver), (b'T', Part::Extruder)]))
    .judge(|_, text| if Words::new(text).any(|word| word.letter == b'P') { Verdict::Unknown } else { Verdict::InOrder })
    .does("S X Y Z E", "stealthChop (1) or spreadCycle (0); or reports; with P unknown")
    .examples(&[("M569 S1 X", &[])]);

/// The motion rests first: a motor that changes its mode at speed may lose steps.
pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let mut words = AxisWords::default();
    if let Some(stealth) = command.switch().filter(|_| !main_loop.power.uarts().is_empty()) {
        main_loop.finish().await?;
        words = mode_words(stealth, command.flags());
    }
    let answer = set_drivers(main_loop, DriverValue::Mode, &words, None, states);
    main_loop.await_drivers().await?;
    Ok(answer)
}

/// S as a word for each axis that is named, all if none is.
fn mode_words(stealth: bool, axes: AxisFlags) -> AxisWords {
    let all = axes == AxisFlags::default();
    let word = |is_named: bool| (is_named || all).then_some(Number::from(i32::from(stealth)));
    AxisWords { x: word(axes.x), y: word(axes.y), z: word(axes.z), e: word(axes.e) }
}
