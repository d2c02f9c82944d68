//! Gaps: requests of the firmware that the chip model could not serve.
//!
//! A finding is every access to a register that is missing, has no model, or is refused by the model. [`ALLOWED`] lists
//! the exceptions with the reason why each does no harm.

use rigless::machine::Board;
use rigless::session::Session;
use std::fmt;

/// An access that is allowed, and why.
#[derive(Clone, Copy, Debug)]
pub struct Allowed {
    /// First and last address.
    pub addresses: (u64, u64),
    /// The name of the part at this address.
    pub name: &'static str,
    /// Why it does no harm.
    pub reason: &'static str,
}

/// The allow-list.
pub const ALLOWED: &[Allowed] = &[
    Allowed {
        addresses: (0x0800_4000, 0x0800_BFFF),
        name: "sectors 1 and 2 of flash",
        reason: "settings, where a board keeps them there; the crate's bus has no flash to write to, flash_interface.rs takes the stores",
    },
    Allowed {
        addresses: (0x4002_3894, 0x4002_3894),
        name: "RCC_DCKCFGR2",
        reason: "of the F446 only; selects clocks of USB, SDIO, I2C4 and CEC: USB has nothing plugged in, the others are not used",
    },
    Allowed {
        addresses: (0xE004_2000, 0xE004_2010),
        name: "DBGMCU",
        reason: "keeps clocks alive under a debugger, of which there is none",
    },
];

/// One gap.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct Gap {
    /// The address; 0 if there is none.
    pub address: u64,
    /// The event in words.
    pub what: String,
}

impl fmt::Display for Gap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:#010x} {}", self.address, self.what)
    }
}

/// All gaps of a run: the findings, and the allowed ones.
#[derive(Clone, Default, Debug)]
pub struct Gaps {
    /// Findings.
    pub found: Vec<Gap>,
    /// Gaps on the allow-list.
    pub allowed: Vec<Gap>,
}

impl Gaps {
    /// The gaps that `session` has noted.
    #[must_use]
    pub fn of<B: Board>(session: &Session<B>) -> Self {
        let mut all = Vec::new();
        for unmapped in session.unmapped() {
            let what = format!("no such register, from {:#010x}", unmapped.program_counter);
            all.push(Gap { address: unmapped.address, what });
        }
        for (&address, fault) in session.refused() {
            all.push(Gap { address, what: format!("refused: {fault:?}") });
        }
        for (&address, gap) in session.unimplemented() {
            let (instance, register, pc) = (gap.instance, gap.register, gap.program_counter);
            let what = format!("{instance}.{register} has no model, {} reads, {} writes", gap.reads, gap.writes);
            all.push(Gap { address, what: format!("{what}, from {pc:#010x}") });
        }
        for (&address, gap) in session.undefined() {
            let what = format!("{} has nothing there, from {:#010x}", gap.instance, gap.program_counter);
            all.push(Gap { address, what });
        }
        for (instance, number) in session.unrouted() {
            all.push(Gap { address: 0, what: format!("interrupt {number} of {instance} has no line") });
        }
        for told in session.told() {
            let what = format!("{}.{}: {}", told.instance, told.register, told.reason);
            all.push(Gap { address: 0, what });
        }
        let is_allowed = |gap: &Gap| {
            ALLOWED.iter().any(|a| (a.addresses.0..=a.addresses.1).contains(&gap.address) && gap.address != 0)
        };
        let (allowed, found) = all.into_iter().partition(is_allowed);
        Self { found, allowed }
    }
}
