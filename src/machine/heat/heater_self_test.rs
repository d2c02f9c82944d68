//! SELF_TEST: finds out whether each heater warms its own sensor.
//!
//! No firmware has an M-code for it, so it has a name, as Klipper's commands do.

use super::self_test::test_heaters;
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::Nature;

pub(in crate::machine) const ENTRY: Entry = Entry::name("Heat and fans", &["SELF_TEST"])
    .nature(Nature::Work)
    .does("", "tests that each heater warms its own sensor")
    .examples(&[("SELF_TEST", &["echo:no heaters configured, ignored"])]);

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    _: &mut States,
    _: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    if main_loop.settings.thermal.has_heater() {
        test_heaters(main_loop).await
    } else {
        Ok(Answer::Line(packed!("echo:no heaters configured, ignored")))
    }
}
