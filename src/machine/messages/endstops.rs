//! M119: which endstops are pressed.

use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::Nature;
use crate::machine::answers::reply_writer::ReplyWriter;
use crate::machine::answers::words::Facts;
use crate::port::EndstopSet;

pub(in crate::machine) const ENTRY: Entry = Entry::m("Reports and messages", &[119])
    .nature(Nature::Report)
    .does("", "endstops and probe")
    .examples(&[("M119", &["Reporting endstop status", "x_min: open", "y_min: open", "z_min: open"])]);

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    _: &mut States,
    _: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    main_loop.motion.look_at_endstops();
    main_loop.poll().await?;
    let pressed = main_loop.status.endstops();
    main_loop.tell(|to, facts| report_endstops(to, facts, pressed));
    Ok(Answer::Said)
}

/// Which endstops are pressed, of the inputs that there are, and whether filament presses the switch of its sensor.
fn report_endstops(to: &mut ReplyWriter<'_>, facts: &Facts<'_>, pressed: EndstopSet) {
    let (endstops, inputs) = (&facts.settings.endstops, facts.status.inputs());
    let state = |e: EndstopSet| if pressed.has(e) { "TRIGGERED" } else { "open" };
    to.say(text!("Reporting endstop status"));
    let of_axis =
        [('x', endstops.x, EndstopSet::X), ('y', endstops.y, EndstopSet::Y), ('z', endstops.z, EndstopSet::Z)];
    for (axis, endstop, switch) in of_axis {
        to.say(text!("{axis}_{}: {}", endstop.end.name(), state(switch)));
    }
    if inputs.has(EndstopSet::PROBE) {
        to.say(text!("z_probe: {}", state(EndstopSet::PROBE)));
    }
    if let Some(is_there) = facts.status.heat().filament() {
        // Marlin's words: with filament the switch has triggered (`Endstops::report_states`).
        to.say(text!("filament: {}", if is_there { "TRIGGERED" } else { "open" }));
    }
}
