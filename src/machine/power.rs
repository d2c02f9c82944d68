//! Power for the motors: only with proof from their drivers, and not a step longer.

use crate::driver::{DriverError, Fault, Job, Name, News, Reading};
use crate::fault::{self, Cause};
use crate::machine::answers::answer::Answer;
use crate::machine::console::{Console, PortSet};
use crate::machine::interrupt::Interrupt;
use crate::port::{Clock, DriverBus, Motor, MotorSet, Pend};

/// Proofs asked for until motors have power. Seven configurations and seven quick proofs are the rule; a wire so
/// bad that the first proofs are too old when the last ones come is not one to print with.
const MOST_PROOFS: usize = 6 * Motor::ALL.len();

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// Whether these motors have power, and their steps are of the size that is counted on.
    pub(super) fn has_power(&self, motors: MotorSet) -> bool {
        motors.without(self.drivers.powered()).is_empty() && self.drivers.is_drivable()
    }

    /// Gives power to motors: to all of them, or, if one driver is not as it should be, to none.
    ///
    /// Talking to drivers takes up to a second and happens before anything is planned, so it changes no step.
    pub(super) async fn power(&mut self, motors: MotorSet) -> Result<(), Interrupt> {
        if let Some(why) = self.ports.drivers.refusal() {
            self.tell(Answer::Refused(why)).await?;
            return Err(Interrupt::NoPower);
        }
        let mut proofs = 0;
        while !self.has_power(motors) {
            let now = self.ports.clock.now();
            let on = self.drivers.powered().with(motors);
            let Err(motor) = self.drivers.power(on, &mut self.ports.drivers, now) else {
                // The idle timeout must not take it away before the move that it is for.
                self.idle_timeout.note_motion(now);
                if !self.has_power(motors) {
                    // Other microsteps are on their way to motors that have power.
                    self.turn().await?;
                }
                continue;
            };
            proofs += 1;
            let proof = self.ask_driver(Job::Verify, motor).await?;
            let proof = proof.and(if proofs < MOST_PROOFS { Ok(()) } else { Err(DriverError::Garbled) });
            if let Err(error) = proof {
                self.tell(Answer::NoPower(Fault { motor, error })).await?;
                return Err(Interrupt::NoPower);
            }
        }
        Ok(())
    }

    /// Takes power from motors; what they held is no longer where it was.
    pub(super) fn unpower(&mut self, motors: MotorSet) {
        let on = self.drivers.powered().without(motors);
        // Nobody gets power that had none, so nobody has anything to prove.
        let _ = self.drivers.power(on, &mut self.ports.drivers, self.ports.clock.now());
        self.homed.release(motors, self.real.groups().mechanism());
    }

    /// Takes power from all motors when nothing has moved for long enough.
    pub(super) fn watch_idleness(&mut self) {
        let now = self.ports.clock.now();
        if !self.pauses.waiting().is_idle_for_motors() || self.has_motion() {
            self.idle_timeout.note_motion(now);
        } else if self.idle_timeout.is_over(now) && !self.drivers.powered().is_empty() {
            self.unpower(MotorSet::ALL);
        }
    }

    /// Has a job done with one driver.
    pub(super) async fn ask_driver(
        &mut self,
        job: Job,
        motor: Motor,
    ) -> Result<Result<Reading, DriverError>, Interrupt> {
        self.drivers.ask(job, motor);
        loop {
            if let Some(result) = self.drivers.answer() {
                return Ok(result);
            }
            self.turn().await?;
        }
    }

    /// Ends the motion and takes the power from all motors, at once. In this order, so that the Stepper makes no step without
    /// power.
    pub(super) fn stop_and_cut(&mut self) {
        self.link.abort();
        self.drivers.cut(&mut self.ports.drivers);
    }

    /// Goes on with the drivers. A fault ends the motion here and now.
    pub(super) fn tend_drivers(&mut self) -> Result<(), Interrupt> {
        let now = self.ports.clock.now();
        match self.drivers.step(&mut self.ports.drivers, now) {
            Some(News::Stopped(Fault { motor, .. })) => {
                self.stop_and_cut();
                let fault = fault::Fault { cause: Cause::Driver, subject: motor as u8, value: 0, limit: 0 };
                self.link.status().fault().set(fault);
            }
            Some(News::Hot(motor)) => {
                let name = Name(motor);
                self.hosts.tell_all(format_args!(
                    "echo:driver of motor {name} is hot and will switch itself off if it gets hotter"
                ));
            }
            None => {}
        }
        // Asked at every turn: who is in the middle of a transfer may overhear it once.
        if self.drivers.fault().is_some() { Err(Interrupt::Halt) } else { Ok(()) }
    }
}
