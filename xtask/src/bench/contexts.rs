//! Contexts that run on the board, by the vector that starts each (boards/qemu, an386/vectors.rs).

use std::fmt;

/// Code between an exception's entry and its return.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
#[repr(u8)]
pub enum Context {
    /// Start-up and the idle loop.
    Idle = 0,
    /// The millisecond.
    SysTick = 15,
    /// A byte has come.
    Received = 16,
    /// A byte can go.
    Transmitted = 17,
    /// The step interrupt.
    Steps = 24,
    /// Makes step events.
    Generator = 47,
    /// A control period of the heaters.
    Thermal = 45,
    /// Lines, commands, planning, when something was received.
    Console = 46,
    /// The same handler when nothing was: it waits, and looks round every millisecond.
    Waiting = 48,
}

impl Context {
    /// All except idling, the most urgent first.
    pub const BUSY: [Self; 8] = [
        Self::Steps,
        Self::Received,
        Self::Transmitted,
        Self::SysTick,
        Self::Generator,
        Self::Thermal,
        Self::Console,
        Self::Waiting,
    ];

    /// The context that a vector starts.
    pub fn of_vector(vector: u64) -> Option<Self> {
        Self::BUSY.into_iter().chain([Self::Idle]).find(|context| context.vector() as u64 == vector)
    }

    /// Its place in the table of vectors; beyond the table for one without a place of its own.
    pub const fn vector(self) -> usize {
        self as usize
    }

    /// How urgent it is; less is more.
    pub const fn priority(self) -> u8 {
        match self {
            Self::Steps => 0x00,
            Self::Received | Self::Transmitted | Self::SysTick => 0x40,
            Self::Generator => 0x80,
            Self::Thermal => 0xA0,
            Self::Console | Self::Waiting => 0xC0,
            Self::Idle => 0xFF,
        }
    }
}

impl fmt::Display for Context {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Idle => "idle",
            Self::SysTick => "millisecond",
            Self::Received => "byte in",
            Self::Transmitted => "byte out",
            Self::Steps => "step interrupt",
            Self::Generator => "generator",
            Self::Thermal => "heat",
            Self::Console => "console",
            Self::Waiting => "console waits",
        })
    }
}
