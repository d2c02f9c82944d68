//! Lines in a pause: which are of the print's stream, and which of a button or a script ([`paused_stream`]).
//!
//! [`paused_stream`]: crate::machine::state::paused_stream

use super::pause::put_modes;
use crate::gcode::Command;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::state::modal::Modal;
use crate::machine::state::paused_stream::counting;
use crate::machine::state::program::Dynamics;
use crate::port::Wake;

/// Modes, limits and counts are those of the paused stream again; nothing moves.
fn leave_detour<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, modal: &mut Modal) {
    if let Some(program) = main_loop.stream.program().copied() {
        main_loop.commanded = counting(&main_loop.commanded, &program.commanded);
        put_modes(main_loop, modal, &program);
    }
}

/// Whether the line that is carried out may be one of the print's stream.
pub(in crate::machine) fn is_own<P: PortSet, W: Wake>(main_loop: &MainLoop<'_, P, W>) -> bool {
    main_loop.job.is_of(main_loop.hosts.serving()) && main_loop.stream.may_hold(main_loop.hosts.window().0.is_some())
}

/// A line comes in a pause; one of the stream finds the state that the stream has left.
pub(in crate::machine) fn begin_line<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    modal: &mut Modal,
    command: &Command<'_>,
) {
    if !is_own(main_loop) {
        main_loop.stream.note_foreign(command);
    } else if main_loop.stream.take_foreign() {
        leave_detour(main_loop, modal);
    }
}

/// A line was carried out in a pause: the stream has come so far, or a detour ends.
pub(in crate::machine) fn end_line<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    modal: &mut Modal,
    command: &Command<'_>,
) {
    if !is_own(main_loop) {
        return;
    }
    let limits = Dynamics::of(&main_loop.settings);
    if main_loop.stream.note_own(command, modal, &main_loop.commanded, &limits) {
        leave_detour(main_loop, modal);
    }
}
