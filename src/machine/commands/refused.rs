//! Commands that end the job, because their missing effect matters.

use crate::gcode::RefusedCommand;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::state::job::JobEnd;
use crate::port::Wake;

/// Why the job ends.
pub(super) const fn end<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, command: RefusedCommand) -> Interrupt {
    main_loop.job.note_end(match command {
        RefusedCommand::Conditional => JobEnd::Conditional,
    });
    Interrupt::EndJob
}
