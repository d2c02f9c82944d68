//! What comes after the effect of a command of the table. The dispatch awaits it, before the `ok`.

use crate::connectors::{HEATERS, Heater};
use crate::gcode::Number;

/// The words of M303, M306 T.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) struct TuningWords {
    /// E: 0 the hotend, -1 the bed, -2 the chamber; `None` for another number.
    pub heater: Option<Heater>,
    /// S, in degrees Celsius.
    pub target: Option<Number>,
    /// C: swings.
    pub cycles: Option<Number>,
    /// U: whether to use the result.
    pub applies: bool,
}

/// The next step.
#[derive(Clone, Copy, Debug)]
pub(in crate::machine) enum NextStep {
    /// The feed override is this many percent.
    Feed(u16),
    /// So many ms pass; M108 ends them.
    LetPass(u32),
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
    /// The machine stops.
    Halt,
}
