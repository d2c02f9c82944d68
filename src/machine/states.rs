//! State of the commands, kept from line to line or for one line (`clamps`): the main loop never needs it.

use crate::connectors::Heater;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::state::clamps::Clamps;
use crate::machine::state::cold_extrusion::ColdExtrusion;
use crate::machine::state::known_bed::PrintArea;
use crate::machine::state::machine_pieces::MachinePieces;
use crate::machine::state::modal::Modal;
use crate::machine::state::notices::Notices;
use crate::machine::state::retraction::RetractionSettings;
use crate::machine::state::running_texts::RunningTexts;
use crate::machine::state::saved_states::SavedStates;
use crate::port::Wake;
use crate::units::Mm;

/// Reports the clamped values to the host, and forgets them.
pub(in crate::machine) fn tell_clamps<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, clamps: &mut Clamps) {
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
    pub(in crate::machine) retraction: RetractionSettings,
    /// Values of the present command that were out of range.
    pub(in crate::machine) clamps: Clamps,
    /// Notices that hosts got once.
    pub(in crate::machine) notices: Notices,
    /// A machine record in transfer.
    pub(in crate::machine) pieces: MachinePieces,
    /// M302.
    pub(in crate::machine) cold: ColdExtrusion,
    /// The area that the print needs.
    pub(in crate::machine) area: PrintArea,
    /// G60, SAVE_GCODE_STATE.
    pub(in crate::machine) saved: SavedStates,
    /// M603: lengths of filament that go in and come out.
    pub(in crate::machine) filament: [Mm; 2],
    /// The texts that are carried out.
    pub(in crate::machine) texts: RunningTexts,
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
            saved: SavedStates::new(),
            // Marlin's (Configuration_adv.h 2.1, `FILAMENT_CHANGE_UNLOAD_LENGTH`).
            filament: [Mm::const_from_int(100); 2],
            texts: RunningTexts::new(),
        }
    }

    /// Whether filament must not move, because the hotend is too cold.
    pub fn is_too_cold<P: PortSet, W: Wake>(&self, main_loop: &MainLoop<'_, P, W>) -> bool {
        self.cold.is_too_cold(&main_loop.settings.thermal, main_loop.heat.believed(Heater::Hotend))
    }

    /// Another print begins.
    pub fn begin_print(&mut self) {
        self.notices.renew_for_print();
        // It was for the print that has begun.
        self.area = PrintArea::NONE;
    }
}
