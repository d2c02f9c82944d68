//! The ports of the step interrupt: lines to the drivers and endstops, and the step timer.

use crate::motors::{EndstopSet, GroupSet};
use crate::units::Tick;

/// The time that a step line has to be high, in ns, for every supported driver. TMC2209 datasheet rev 1.09, section
/// 13.1: t_SH >= max(t_FILTSD, t_CLK + 20 ns). That is 103 ns with the internal clock of 12 MHz and 118 ns at its
/// slowest.
pub const STEP_PULSE_NS: u32 = 133;

/// Step and direction lines of all motors, and the endstop inputs. Called from the step interrupt only:
/// no call may block, lock or loop without a constant bound.
pub trait StepPort {
    /// Sets the direction lines so that a step increases the coordinates of the groups in `forward` and decreases the
    /// others. [`Coupling::forward_motors`](crate::motors::Coupling::forward_motors) gives the direction of each motor.
    /// Returns when a step may follow (TMC2209 datasheet rev 1.09, section 13.1: DIR to STEP set-up 20 ns).
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
