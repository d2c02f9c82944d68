//! The exchanges of each task.

use super::config::WRITTEN;
use super::registers::Register;
use crate::driver::chip::{Check, Scripts, Step};
use crate::driver::reading::LOADS;

pub(super) const SCRIPTS: Scripts<Register> = Scripts {
    configure: CONFIGURE,
    check: &[FLAGS, same(Register::Gconf), same(Register::Chopconf)],
    adjust: ADJUST,
    poll: &[STATUS, FLAGS, same(Register::Chopconf)],
    read: &[
        note(Register::Gstat),
        note(Register::Gconf),
        note(Register::Chopconf),
        note(Register::DrvStatus),
        note(Register::SgResult),
        note(Register::Ifcnt),
    ],
    // The drivers measure again in every full step.
    load: &[note(Register::SgResult); LOADS],
    phase: &[note(Register::Mscnt); 2],
    flags: &[FLAGS],
    status: &[STATUS],
    chopper: &[same(Register::Chopconf)],
};

const FLAGS: Step<Register> = Step::Read(Register::Gstat, Check::Flags);
const STATUS: Step<Register> = Step::Read(Register::DrvStatus, Check::Status);
const COUNT: Step<Register> = Step::Read(Register::Ifcnt, Check::Count);
const COUNTED: Step<Register> = Step::Read(Register::Ifcnt, Check::Counted);

const fn same(register: Register) -> Step<Register> {
    Step::Read(register, Check::Same)
}

const fn note(register: Register) -> Step<Register> {
    Step::Read(register, Check::Any)
}

/// Another firmware may have set late replies, so the first write makes replies fast. The flags are cleared before all
/// else, so that any later reset is seen.
const CONFIGURE: &[Step<Register>] = &script::<4, CONFIGURE_STEPS>([
    Step::Tell(Register::Slaveconf),
    Step::Read(Register::Ioin, Check::Chip),
    Step::Tell(Register::Gstat),
    COUNT,
]);

/// The flags of a driver with power must not be cleared: they may show a reset that was not read yet.
const ADJUST: &[Step<Register>] = &script::<3, ADJUST_STEPS>([STATUS, FLAGS, COUNT]);

/// The steps after the writes.
const AFTER: [Step<Register>; 5] =
    [COUNTED, same(Register::Gconf), same(Register::Chopconf), same(Register::Pwmconf), FLAGS];

const CONFIGURE_STEPS: usize = 4 + WRITTEN.len() + AFTER.len();
const ADJUST_STEPS: usize = 3 + WRITTEN.len() + AFTER.len();

/// The steps before, the writes, the steps after.
const fn script<const BEFORE: usize, const ALL: usize>(before: [Step<Register>; BEFORE]) -> [Step<Register>; ALL] {
    let mut steps = [COUNTED; ALL];
    let mut i = 0;
    while i < ALL {
        steps[i] = if i < BEFORE {
            before[i]
        } else if i < BEFORE + WRITTEN.len() {
            Step::Write(WRITTEN[i - BEFORE])
        } else {
            AFTER[i - BEFORE - WRITTEN.len()]
        };
        i += 1;
    }
    steps
}
