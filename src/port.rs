//! The ports: the traits that a board, or a simulator, implements so that the core can run on it.
//!
//! The core uses hardware through these few traits only. A simulated fault is one more implementation wrapped round
//! another, never a flag.

pub use crate::connectors::{FANS, HEATERS, Heater, OUTPUTS, Output, OutputSet, SENSORS, Sensor};
pub use crate::motors::{Coupling, EndstopSet, GroupSet, Motor, MotorSet};

use crate::accelerometer::{Kind, Sample, SensorFault};
use crate::connectors::BoardConnectors;
use crate::units::{Celsius, Instant, Tick};
use core::any::Any;

/// The time that a step line has to be high, in ns, for every supported driver. TMC2209 datasheet rev 1.09, section
/// 13.1: t_SH >= max(t_FILTSD, t_CLK + 20 ns). That is 103 ns with the internal clock of 12 MHz and 118 ns at its
/// slowest.
pub const STEP_PULSE_NS: u32 = 133;

/// Step and direction lines of all motors, and the endstop inputs. Called from the step interrupt only:
/// no call may block, lock or loop without a constant bound.
pub trait StepPort {
    /// Sets the direction lines so that a step increases the coordinates of the groups in `forward` and decreases the
    /// others. [`Coupling::forward_motors`] gives the direction of each motor. Returns when a step may follow (TMC2209
    /// datasheet rev 1.09, section 13.1: DIR to STEP set-up 20 ns).
    fn dir(&mut self, forward: GroupSet);

    /// Raises the step lines of all motors of `steps` in one instant: one store a GPIO port.
    /// `tick` is the event's motion time, which a trace records and a GPIO port ignores.
    fn rise(&mut self, steps: GroupSet, tick: u64);

    /// Lowers the step lines of `steps`, at least [`STEP_PULSE_NS`] after `rise`. In between lies a call of
    /// [`StepClock::alarm_again`].
    fn fall(&mut self, steps: GroupSet);

    /// Groups with step lines that take longer than the others: this is the time of their [`rise`](Self::rise) alone.
    fn slow_groups(&self) -> GroupSet {
        GroupSet::NONE
    }

    /// [`rise`](Self::rise) without slow groups.
    #[inline(always)]
    fn rise_quick(&mut self, steps: GroupSet, tick: u64) {
        self.rise(steps, tick);
    }

    /// [`fall`](Self::fall) after [`rise_quick`](Self::rise_quick).
    #[inline(always)]
    fn fall_quick(&mut self, steps: GroupSet) {
        self.fall(steps);
    }

    /// All endstop inputs, including the Z probe, in one read of each GPIO port.
    fn endstops(&mut self) -> EndstopSet;

    /// The endstops of the machine; the Z probe ([`EndstopSet::PROBE`]) only if the machine has one.
    fn inputs(&self) -> EndstopSet {
        EndstopSet::SWITCHES
    }
}

/// The step timer: a free-running counter of [`Tick`]s and one alarm.
pub trait StepClock {
    /// The counter.
    fn now(&self) -> Tick;

    /// Whether `at` has come, no more than `ticks` ago. For an `at` that is at most some seconds ahead.
    #[inline(always)]
    fn is_due(&self, at: Tick, ticks: u32) -> bool {
        self.now().since(at) <= ticks
    }

    /// Requests the step interrupt at `at`; false if that has passed already, and then none need come.
    #[must_use]
    fn alarm(&mut self, at: Tick) -> bool;

    /// The same from within the step interrupt that an alarm has triggered. It may also be false for an `at` that is
    /// too near or too far away to be finished at once; then [`alarm`](Self::alarm) or [`silence`](Self::silence) has
    /// to follow.
    #[must_use]
    #[inline(always)]
    fn alarm_again(&mut self, at: Tick) -> bool {
        self.alarm(at)
    }

    /// No alarm until the next call of [`alarm`](Self::alarm).
    fn silence(&mut self);
}

/// A way to wake another context: pends the interrupt that runs it.
pub trait Wake {
    /// Wakes the StepGenerator's context.
    fn wake_generator(&self);

    /// Wakes the Stepper's context (its alarm may be silent).
    fn wake_stepper(&self);

    /// Sees what is queued for the StepGenerator, an `Entry` of `motion`, before it is. Hardware has no use for it, and
    /// without a body it is no code; a simulator follows the moves by it.
    fn sees_queued(&self, _entry: &dyn Any) {}
}

/// The Console's clock.
pub trait Clock {
    /// Time since start.
    fn now(&self) -> Instant;
}

/// An event of the serial line.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Received {
    /// A byte that arrived whole.
    Byte(u8),
    /// Something was lost or damaged here: overrun, framing or noise error.
    Lost,
    /// A host has opened the line; earlier bytes came from another host. Only for lines that know, such as USB.
    Opened,
}

/// Serial lines to hosts that a machine may have: USB and two UARTs, as on the Octopus. The Console serves each in
/// turn.
pub const LINES: usize = 3;

/// The serial lines of a machine.
pub type Lines<S> = heapless::Vec<S, LINES>;

/// A serial line; never blocks. A line without a host takes all bytes that are sent.
pub trait Serial {
    /// The next thing received, if any.
    fn recv(&mut self) -> Option<Received>;

    /// Takes as many of `bytes` as fit and returns their number; replies must leave at once, not wait for more.
    fn send(&mut self, bytes: &[u8]) -> usize;

    /// The next of the things that have arrived and were neither received nor overheard; [`recv`](Self::recv) returns
    /// it in its turn. Emergencies are heard so behind lines for which there is no room. A line that can hold its host
    /// up may leave it out.
    fn overhear(&mut self) -> Option<Received> {
        None
    }

    /// Whether the next thing to receive was overheard.
    fn was_overheard(&self) -> bool {
        false
    }
}

/// The motor drivers: their enable lines, and the one-wire UART of each.
///
/// One exchange, a request and its reply, runs at a time, in parallel with all other work: nothing here blocks, and no
/// caller awaits it. The default methods describe drivers without a UART.
pub trait DriverBus {
    /// Powers exactly the motors of `on`, all that change in one transaction.
    fn enable(&mut self, on: MotorSet);

    /// From now on a step of a group turns these motors: the step pins take it, and their direction lines are set again
    /// ([`Stepper::recouple`](crate::motion::Stepper::recouple)). Nothing moves during the change.
    fn couple(&mut self, coupling: &Coupling);

    /// Motors with a driver that has a UART; the others run as their jumpers say.
    fn lines(&self) -> MotorSet {
        MotorSet::NONE
    }

    /// Sends the request on the line of a motor that is in [`lines`](Self::lines), and then listens for `reply` bytes.
    /// An exchange under way is dropped.
    fn begin(&mut self, _motor: Motor, _request: &Frame, _reply: usize) {}

    /// The outcome of the exchange, once; `None` while it is under way. Every exchange ends by itself in bounded time.
    fn outcome(&mut self) -> Option<Result<Frame, BusError>> {
        Some(Err(BusError::Silent))
    }

    /// Gives the servo of a BLTouch an order: pulses of so many us, every 20 ms, five of them at least. Then its line
    /// stays low. `None` ends an order at once. A later order replaces an earlier one.
    fn servo(&mut self, _micros: Option<u16>) {}

    /// The board's connectors.
    fn connectors(&self) -> &'static BoardConnectors {
        &BoardConnectors::ANY
    }

    /// Why no motor may have power, independent of its driver: the board has no machine, or one for another board.
    fn refusal(&self) -> Option<&'static str> {
        None
    }

    /// A warning for M122 about this board's protection of its outputs, if it does not work.
    fn warning(&self) -> Option<&'static str> {
        None
    }
}

/// The bytes of one direction of an exchange; the longest datagram has eight (TMC2209 datasheet rev 1.09,
/// section 4.1).
pub type Frame = heapless::Vec<u8, 8>;

/// Why an exchange with a driver failed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum BusError {
    /// No answer, or one that stopped in the middle: no motor supply, no driver, no wire.
    Silent,
    /// The received signal is no byte: a stop bit is low.
    Garbled,
}

/// Why the storage did not do it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StorageError {
    /// There is no storage, or no such address.
    Absent,
    /// It does not answer: wiring, or a broken chip.
    Failed,
}

impl core::fmt::Display for StorageError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Absent => put!(f, "no storage on this machine"),
            Self::Failed => put!(f, "storage does not answer"),
        }
    }
}

impl core::error::Error for StorageError {}

/// Byte-addressed memory that keeps its content without power.
///
/// Every call ends in bounded time, with [`StorageError::Failed`] if necessary. A future that is dropped half-way is
/// like a power cut: the page that was being written may hold anything.
#[expect(async_fn_in_trait, reason = "the Console polls them in its own context; nobody needs Send")]
pub trait Storage {
    /// Size in bytes; 0 if there is none.
    fn capacity(&self) -> u32;

    /// Fills `into` with the bytes from address `at` on.
    ///
    /// # Errors
    /// [`StorageError`]; then `into` may hold anything.
    async fn read(&mut self, at: u32, into: &mut [u8]) -> Result<(), StorageError>;

    /// Takes `bytes` for address `at`; they are stored permanently as soon as the storage [is done](Self::is_done). The
    /// core never writes across a page of [`crate::storage::PAGE`] bytes.
    ///
    /// # Errors
    /// [`StorageError`]; then some of the bytes may have been written.
    async fn write(&mut self, at: u32, bytes: &[u8]) -> Result<(), StorageError>;

    /// Whether all written bytes are stored permanently. Ask until it is true before the next transfer: a transfer that
    /// comes too early blocks until then, and no other context runs.
    ///
    /// # Errors
    /// [`StorageError::Failed`] if it takes too long.
    fn is_done(&mut self) -> Result<bool, StorageError> {
        Ok(true)
    }

    /// Whether each page can be written by itself, without a save of all settings. Memory that is erased first cannot.
    fn keeps_pages(&self) -> bool {
        true
    }

    /// The content of the program memory, as a number that differs after an update; `None` for a program that is not
    /// flashed, such as a simulator's.
    fn image(&self) -> Option<u32> {
        None
    }
}

/// For machines without storage.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoStorage;

impl Storage for NoStorage {
    fn capacity(&self) -> u32 {
        0
    }

    async fn read(&mut self, _at: u32, _into: &mut [u8]) -> Result<(), StorageError> {
        Err(StorageError::Absent)
    }

    async fn write(&mut self, _at: u32, _bytes: &[u8]) -> Result<(), StorageError> {
        Err(StorageError::Absent)
    }
}

/// An accelerometer at the tool. Nothing here blocks: the board reads the sensor by itself, and the Console takes the
/// samples.
pub trait Accelerometer {
    /// Identifies a sensor of this kind and starts it at the rate nearest to so many samples a second. Samples of an
    /// earlier start are dropped. What fails is the answer of the following [`take`](Self::take).
    fn start(&mut self, kind: Kind, rate: u16);

    /// Moves as many of the oldest samples as are there and fit, and returns their number. The Console calls it every
    /// millisecond or so, and at least every 20 ms.
    ///
    /// # Errors
    /// [`SensorFault`], from then on up to the next start.
    fn take(&mut self, into: &mut [Sample]) -> Result<usize, SensorFault>;

    /// Stops the sensor.
    fn stop(&mut self);
}

/// For machines without a connector for an accelerometer.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoAccelerometer;

impl Accelerometer for NoAccelerometer {
    fn start(&mut self, _kind: Kind, _rate: u16) {}

    fn take(&mut self, _into: &mut [Sample]) -> Result<usize, SensorFault> {
        Err(SensorFault::Absent)
    }

    fn stop(&mut self) {}
}

/// Heaters, fans, temperature sensors, and their watchdog. Called from the thermal context only; no call may block or
/// lock.
pub trait ThermalPort {
    /// The converter's reading: its part of the reference voltage, in units of 1/65,536. `None` if there is no such
    /// sensor, or if the converter has stopped: a value is never older than some milliseconds.
    fn sample(&mut self, sensor: Sensor) -> Option<u16>;

    /// The converter's reading of its internal reference, as a part of the supply in units of 1/65,536; `None` if the
    /// board does not measure it.
    fn reference(&mut self) -> Option<u16> {
        None
    }

    /// The processor's own temperature at the last [`reference`](Self::reference); `None` if it is not measured.
    fn mcu(&mut self) -> Option<Celsius> {
        None
    }

    /// Outputs that may heat: hardware switches them off by itself if [`heat`](Self::heat) is not called any more.
    fn outputs(&self) -> OutputSet {
        OutputSet::NONE
    }

    /// Switches each output on for this part of the coming control period, in units of 1/65,535; then it goes off by
    /// itself. Called once a period.
    fn heat(&mut self, _duties: &[u16; OUTPUTS]) {}

    /// Fans that there are, FAN0 and so on.
    fn fans(&self) -> usize {
        0
    }

    /// Runs a fan at this part of full speed, in units of 1/65,535, until the next call.
    fn set_fan(&mut self, _fan: usize, _duty: u16) {}

    /// The pulses that a fan's tachometer has given, wrapping; `None` where there is no tachometer.
    fn tachometer(&self, _fan: usize) -> Option<u16> {
        None
    }

    /// Whether filament presses the switch of its sensor; `None` without a sensor.
    fn filament(&self) -> Option<bool> {
        None
    }

    /// Whether the board can switch the power supply off (PS_ON).
    fn has_supply_switch(&self) -> bool {
        false
    }

    /// Switches the power supply on or off. A board that has switched it off keeps it off over resets, until power was
    /// cut or a user has asked twice (M999).
    fn switch_supply(&mut self, _on: bool) {}

    /// Every context has sent its heartbeat: restarts the watchdog's time.
    fn feed_watchdog(&mut self) {}
}

/// For machines without heaters.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoHeaters;

impl ThermalPort for NoHeaters {
    fn sample(&mut self, _sensor: Sensor) -> Option<u16> {
        None
    }
}
