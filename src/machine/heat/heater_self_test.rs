//! SELF_TEST: finds out whether each heater warms its own sensor.
//!
//! No firmware has an M-code for it, so it has a name, as Klipper's commands do.

use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::Nature;
use crate::machine::answers::next_step::NextStep;

pub(in crate::machine) const ENTRY: Entry = Entry::name("Heat and fans", &["SELF_TEST"])
    .nature(Nature::Work)
    .does("", "tests that each heater warms its own sensor")
    .examples(&[("SELF_TEST", &["echo:no heaters configured, ignored"])]);

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    _: &mut States,
    _: &TableCommand<'a>,
) -> Answer<'a> {
    if main_loop.settings.thermal.has_heater() {
        Answer::Then(NextStep::SelfTest)
    } else {
        Answer::Line(packed!("echo:no heaters configured, ignored"))
    }
}
