//! Why a command ends before it is done, and why the Console does.

/// Why a command ends before it is done. No interrupt of the processor.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Interrupt {
    /// M112, or a fault that only a reset ends.
    Halt,
    /// A motor of the belt has failed, and the others park the tool; then it is a halt.
    Limp,
    /// M410, or M524, which the [`Job`](super::state::job::Job) knows.
    QuickStop,
    /// Motors may not have power; the host got the reason. Nothing was planned.
    NoPower,
    /// The job ends, the machine stays: why, [`Job`](super::state::job::Job) knows.
    EndJob,
}

// Every turn of the main loop returns one through all futures that wait for it: a byte goes in a register.
const _: () = assert!(size_of::<Result<(), Interrupt>>() == 1);

/// Why [`Console::run`](crate::machine::Console::run) ends: the machine is to restart, as after a reset. No motor has
/// power.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Restart;
