//! SELF_TEST: finds out whether each heater warms its own sensor.
//!
//! No firmware has an M-code for it, so it has a name, as Klipper's commands do.

use super::{Answer, MainLoop, OwnCommand, OwnEntry, PortSet, States, Wake};
use crate::gcode::Nature;
use crate::machine::answers::next_step::NextStep;

pub(super) const ENTRY: OwnEntry = OwnEntry::name("Heat and fans", &["SELF_TEST"])
    .nature(Nature::Work)
    .does("", "tests that each heater warms its own sensor")
    .examples(&[("SELF_TEST", &["echo:no heaters configured, ignored"])]);

pub(super) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    _: &mut States,
    _: &OwnCommand<'a>,
) -> Answer<'a> {
    if main_loop.settings.thermal.has_heater() {
        Answer::Then(NextStep::SelfTest)
    } else {
        Answer::Line(packed!("echo:no heaters configured, ignored"))
    }
}
