//! M81: everything off that can be switched off. It acts whatever stands behind it.

use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};

pub(in crate::machine) const ENTRY: Entry = Entry::m("Heat and fans", &[81])
    .does("", "heaters and fans off; the power supply stays on")
    .examples(&[("M81", &["echo:M81: heaters and fans are off; this firmware does not switch the power supply"])]);

/// A print that goes on would have no heat.
pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    _: &mut States,
    _: &TableCommand<'a>,
) -> Answer<'a> {
    main_loop.heat.switch_off(&main_loop.settings.thermal);
    if main_loop.job.is_printing() {
        main_loop.job.end();
    }
    Answer::Line(packed!("echo:M81: heaters and fans are off; this firmware does not switch the power supply"))
}
