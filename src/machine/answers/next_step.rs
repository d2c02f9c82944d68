//! What comes after the effect of a command of the table. The dispatch awaits it, before the `ok`.

use crate::connectors::HEATERS;
use crate::gcode::TuningWords;

/// The next step.
#[derive(Clone, Copy, Debug)]
pub(in crate::machine) enum NextStep {
    /// The motion ends.
    Rest,
    /// A fan gets this speed in its turn among the moves.
    Fan(u8, u16),
    /// These heaters reach their targets; with `cools` also from above.
    Heat { heaters: [bool; HEATERS], cools: bool },
    /// A heater is tuned.
    Tune(TuningWords),
    /// The heaters are tested.
    SelfTest,
    /// The job ends, for a reason that was noted.
    EndJob,
}
