//! A kind of driver chip: the trait that a chip implements so that [`Drivers`](super::Drivers) can prove and watch it.
//!
//! [`Tmc2209`](super::Tmc2209) is the one that the boards have. A chip on SPI has other frames and perhaps no count of
//! accepted writes: its scripts leave that check out. Where a value comes with the next frame, the bus sends the frame
//! of a read twice.

use super::error::DriverError;
use super::reading::Reading;
use crate::motors::Motor;
use crate::port::Frame;
use crate::settings::Settings;
use core::fmt::Debug;

/// A kind of driver chip.
pub trait Chip: Debug + 'static {
    /// A register.
    type Register: Copy + PartialEq + Debug;

    /// The required contents of its registers.
    type Config: Copy + PartialEq + Debug;

    /// The exchanges of each task.
    const SCRIPTS: Scripts<Self::Register>;

    /// The contents that the settings require in the driver of `motor`.
    fn config(motor: Motor, settings: &Settings) -> Self::Config;

    /// The required value of a register; 0 for registers that are not written.
    fn value(config: &Self::Config, register: Self::Register) -> u32;

    /// What these contents do.
    fn held(config: &Self::Config) -> Held;

    /// The frame that asks for a register, and the length of its reply in bytes.
    fn read(register: Self::Register) -> (Frame, usize);

    /// The frame that writes a register, and the length of its reply in bytes.
    fn write(register: Self::Register, value: u32) -> (Frame, usize);

    /// The value of `register` in a reply; `None` if the reply is invalid or damaged.
    fn reply(reply: &[u8], register: Self::Register) -> Option<u32>;

    /// The error if the register that names the chip has this value.
    fn other_chip(value: u32) -> Option<DriverError>;

    /// The error that the flags report.
    fn error_of_flags(flags: u32) -> Option<DriverError>;

    /// The error that the status reports.
    fn error_of_status(status: u32) -> Option<DriverError>;

    /// The error if a register has another value than was written.
    fn difference(register: Self::Register, value: u32, wanted: u32) -> Option<DriverError>;

    /// Takes down a value for reports.
    fn note(reading: &mut Reading, register: Self::Register, value: u32);

    /// What a reading shows.
    fn shown(reading: &Reading) -> Shown;
}

/// The effect of the contents of a driver's registers.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Held {
    /// Microsteps of a full step.
    pub microsteps: u32,
    /// Run current in mA.
    pub run_ma: u32,
    /// Current at rest in mA.
    pub hold_ma: u32,
    /// Steps a second above which the quiet mode ends; `None` if it never does.
    pub quiet_steps_per_s: Option<u32>,
}

/// The state of a driver as its registers show it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Shown {
    /// Microsteps of a full step; `None` if its pins decide.
    pub microsteps: Option<u32>,
    /// Whether it interpolates its microsteps to 256.
    pub interpolates: bool,
    /// Its chopper mode at low speed.
    pub mode: &'static str,
    /// Whether that is the quiet one.
    pub is_quiet: bool,
    /// Its temperature range.
    pub temperature: &'static str,
    /// Whether it is near the temperature at which it switches itself off.
    pub is_hot: bool,
    /// Whether a coil seems to be open; valid only while the motor turns slowly.
    pub seems_open: bool,
    /// Its error.
    pub problem: Option<DriverError>,
}

/// The check of a value that was read.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Check {
    /// None.
    Any,
    /// It must be this kind of chip.
    Chip,
    /// No flag may be set.
    Flags,
    /// The count of accepted writes begins here.
    Count,
    /// It must have accepted all writes since [`Check::Count`], and no others.
    Counted,
    /// It must be the required value.
    Same,
    /// It must not have switched itself off.
    Status,
}

/// One exchange.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Step<R> {
    /// Write a register; the write is not counted.
    Tell(R),
    /// Write a register.
    Write(R),
    /// Read a register.
    Read(R, Check),
}

/// The exchanges of each task.
#[derive(Clone, Copy, Debug)]
pub struct Scripts<R: 'static> {
    /// Write a configuration and prove it. The motor has no power.
    pub configure: &'static [Step<R>],
    /// The quick proof, for a driver that was configured before.
    pub check: &'static [Step<R>],
    /// Change the configuration of a motor with power. The flags must not be cleared.
    pub adjust: &'static [Step<R>],
    /// Check a motor with power, and find its error.
    pub poll: &'static [Step<R>],
    /// Read the values for a report.
    pub read: &'static [Step<R>],
    /// Read the load as often as a reading has room for.
    pub load: &'static [Step<R>],
    /// Read the position in the sine table twice.
    pub phase: &'static [Step<R>],
    /// The look at everything that ends a motor's torque or changes its steps.
    pub flags: &'static [Step<R>],
    /// The look at heat and shorts.
    pub status: &'static [Step<R>],
    /// The look at the register with the microsteps.
    pub chopper: &'static [Step<R>],
}
