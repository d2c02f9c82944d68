//! Ends: the two ends of a print. A host talks to the printer; a sink records motors and heaters.

use crate::moves::{MadeMove, ShaperChange};
use corehbot::connectors::{FANS, HEATERS};
use corehbot::motors::MotorSet;
use corehbot::units::Celsius;

/// A receiver of every step event, in order. `tick` is motion time (10 MHz) and never falls.
pub trait Sink {
    /// The motors of `steps` step at `tick`, each forward if it is in `forward`.
    fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet);
    /// A switch, the probe or a stop of the machine has just ended all motion at once, at this tick.
    fn stopped(&mut self, _tick: u64) {}
    /// From the next event on z follows a mesh and leads to this z of the program, in mm; or it follows none.
    fn stand_on_mesh(&mut self, _z: Option<f64>) {}
    /// Whether moves are to be followed for [`moved`](Self::moved) and [`reshaped`](Self::reshaped); asked once.
    fn wants_moves(&self) -> bool {
        false
    }
    /// A move has been made to its end.
    fn moved(&mut self, _made: &MadeMove) {}
    /// An axis has another shaper from now on, or its first one.
    fn reshaped(&mut self, _change: &ShaperChange) {}
    /// A control period has passed on a machine with heaters.
    fn heat(&mut self, _period: &HeatPeriod) {}
}

/// Heat at the end of a control period.
#[derive(Clone, Copy, Debug)]
pub struct HeatPeriod {
    /// Time since the printer was switched on, in ticks.
    pub now: u64,
    /// Motion time, in ticks.
    pub tick: u64,
    /// The fitted heaters.
    pub heaters: [Option<HeaterPeriod>; HEATERS],
    /// Duty of each fan, of 65,535, as the plant got it.
    pub fans: [u16; FANS],
}

/// A heater at the end of a control period.
#[derive(Clone, Copy, Debug)]
pub struct HeaterPeriod {
    /// The firmware's measurement; `None` before the first one.
    pub measured: Option<Celsius>,
    /// The target; 0 is off.
    pub target: Celsius,
    /// Of 65,535, as the plant got it.
    pub duty: u16,
}

/// The other end of the serial line.
pub trait Host {
    /// The next bytes to put on the wire, appended to `out`; called whenever the printer waits for input.
    fn send(&mut self, out: &mut Vec<u8>);
    /// Bytes to put on the wire although the printer is busy, appended to `out`; called all the time.
    fn interject(&mut self, _out: &mut Vec<u8>) {}
    /// How much time has passed since the printer was switched on, in ticks; shared all the time.
    fn clock(&mut self, _tick: u64) {}
    /// Whether it opens its line now, so that earlier bytes belong to another host; polled all the time.
    fn opens(&mut self) -> bool {
        false
    }
    /// The command that was sent last: its line in the file, its type for the slicer (an index into
    /// [`types`](crate::slicer::Notes::types)), and its text.
    fn sent(&self) -> Option<(u32, u16, &str)> {
        None
    }
    /// A whole line from the printer, without its line end.
    fn hear(&mut self, line: &str);
    /// Whether everything was sent and answered.
    fn is_done(&self) -> bool;
}
