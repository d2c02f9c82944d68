//! State of the commands, kept from line to line or for one line (`clamps`): the main loop never needs it.

use super::cold_extrusion::ColdExtrusion;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::state::clamps::Clamps;
use crate::machine::state::known_bed::PrintArea;
use crate::machine::state::machine_pieces::MachinePieces;
use crate::machine::state::modal::Modal;
use crate::machine::state::notices::Notices;
use crate::machine::state::retraction::RetractionSettings;
use crate::port::Wake;

/// Reports the clamped values to the host, and forgets them.
pub(super) fn tell_clamps<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, clamps: &mut Clamps) {
    let mut place = 0;
    while let Some(clamp) = clamps.get(place) {
        main_loop.say(text!("echo:{clamp}"));
        place += 1;
    }
    clamps.clear();
}

/// All of it. The dispatch hands each command those that it names.
pub(in crate::machine) struct States {
    /// The modal state of lines.
    pub(in crate::machine) modal: Modal,
    /// How G10 and G11 retract.
    pub(super) retraction: RetractionSettings,
    /// Values of the present command that were out of range.
    pub(super) clamps: Clamps,
    /// Notices that hosts got once.
    pub(super) notices: Notices,
    /// A machine record in transfer.
    pub(super) pieces: MachinePieces,
    /// M302.
    pub(super) cold: ColdExtrusion,
    /// The area that the print needs.
    pub(super) area: PrintArea,
}

impl States {
    /// As after a reset.
    pub const fn new() -> Self {
        Self {
            modal: Modal::new(),
            retraction: RetractionSettings::new(),
            clamps: Clamps::new(),
            notices: Notices::new(),
            pieces: MachinePieces::new(),
            cold: ColdExtrusion::new(),
            area: PrintArea::NONE,
        }
    }

    /// Another print begins.
    pub fn begin_print(&mut self) {
        self.notices.renew_for_print();
        // It was for the print that has begun.
        self.area = PrintArea::NONE;
    }
}
