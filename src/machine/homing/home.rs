//! G28: axes meet their switches.

use super::homing_axes::{HomeWords, home};
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{AxisFlags, Grammar, Nature, Number};
use crate::machine::apart::apart;
use crate::machine::main_loop::surface::use_mesh;
use crate::machine::reports::mesh_report::report_levelling;
use core::pin::pin;

/// With W, Prusa's G28 leaves the mesh; L0 is Marlin's word for it.
pub(in crate::machine) const ENTRY: Entry = Entry::g("Motion", &[28])
    .nature(Nature::Mode)
    .grammar(&Grammar::numbers(b"R").no_axes(b"ABCUV").not_negative(b"R"))
    .does(
        "X Y Z O R W L",
        "homes the named axes, all without words; O: those that are not homed; R raises Z first; W, L0: no mesh",
    )
    .examples(&[("G28 X0 Y0", &[])]);

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let words = HomeWords { axes: AxisFlags { e: false, ..command.flags() }, only_lost: command.has(b'O') };
    // In the units of the line (G20), which `home` does not know.
    let raise = command.number(b'R').map(|raise| states.modal.length(raise));
    apart(pin!(home(main_loop, &mut states.notices, words, raise))).await?;
    let drops_mesh = command.has(b'W') || command.number(b'L') == Some(Number::ZERO);
    if drops_mesh && main_loop.settings.mesh.is_on {
        use_mesh(main_loop, false).await?;
        return Ok(Answer::words(&report_levelling));
    }
    Ok(Answer::Nothing)
}
