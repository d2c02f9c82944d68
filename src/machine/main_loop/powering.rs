//! Power for the motors: only with proof from their drivers, not a step longer. The motors of one belt get it in turn,
//! or none of them gets it.

use super::phase::{align_by_phases, meet_phases};
use crate::driver::{DriverError, DriverJob, Fault, News, Reading};
use crate::machine::apart::apart;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::motors::MOTORS;
use crate::port::{BoardFacts, Motor, MotorSet, Wake};
use crate::units::Instant;
use core::pin::pin;

/// Proofs requested until motors have power. Usually a configuration and a quick proof of each suffice. If the first
/// proofs expire before the last ones arrive, the wire is too bad to print with.
const MOST_PROOFS: usize = 6 * MOTORS;

impl<P: PortSet, W: Wake> MainLoop<'_, P, W> {
    /// Gives power to motors: to all of them, or, if one driver is not as it should be, to none.
    ///
    /// A rotor that gets power goes to its nearest rest, up to two full steps away. Motors that can pull against each
    /// other get power one after another, and settle in between. Then only the last one's move to its rest strains the
    /// belt. Talking to drivers and settling take up to a second and a half and happen before anything is planned, so
    /// they change no step.
    pub async fn power_up(&mut self, motors: MotorSet) -> Result<(), Interrupt> {
        refuse_without_machine(self)?;
        let residuals = self.settings.residuals();
        self.power.watch_closely(residuals.motors());
        let before = self.power.powered();
        let mut result = apart(pin!(self.power_in_turn(residuals.with_opponents(motors), before))).await;
        // A phase does not show a skip: it applies to rotors that have just come to rest.
        if result.is_ok() && !residuals.motors().without(before).is_empty() {
            result = align_by_phases(self, &residuals).await;
        }
        if result.is_err() {
            // Power for a part of a belt is worse than none.
            self.unpower(self.power.powered().without(before));
        }
        result
    }

    /// Gives power to these motors and to no other one of their belt, which is not aligned: some of its motors turn
    /// freely. Until `trim::end_buzz` takes the power away again.
    pub async fn power_for_buzz(&mut self, motors: MotorSet) -> Result<(), Interrupt> {
        refuse_without_machine(self)?;
        self.unpower(motors);
        self.power.watch_closely(motors);
        self.trimming.begin_buzz(motors);
        apart(pin!(self.power_in_turn(motors, self.power.powered()))).await
    }

    async fn power_in_turn(&mut self, motors: MotorSet, before: MotorSet) -> Result<(), Interrupt> {
        let mut proofs = 0;
        while !self.power.is_on(motors) {
            let now = self.now();
            let (powered, missing) = (self.power.powered(), motors.without(self.power.powered()));
            if let Some(motor) = self.power.unproved(powered.with(missing), now) {
                proofs += 1;
                let proof = self.ask_driver(DriverJob::Verify, motor).await?;
                let proof = proof.and(if proofs < MOST_PROOFS { Ok(()) } else { Err(DriverError::Garbled) });
                if let Err(error) = proof {
                    // Before the message to the host, which may be slow.
                    self.unpower(self.power.powered().without(before));
                    let name = self.settings.name_of(motor);
                    let fault = Fault { motor, name, error };
                    self.say(text!("Error:{fault}; no motor got power"));
                    return Err(Interrupt::NoPower);
                }
                continue;
            }
            let residuals = self.settings.residuals();
            let next = residuals.first_of(missing);
            meet_phases(self, &residuals, next).await?;
            // All of them have proved their settings.
            let now = self.now();
            self.power.set(powered.with(next), now);
            // The idle timeout must not take it away before the move that it is for.
            self.power.note_motion(now);
            if residuals.motors().intersects(next) {
                self.settle(now.after_ms(self.settings.belt.settling_ms.into())).await?;
            } else if !self.power.is_on(motors) {
                // Other microsteps are being sent to motors that have power.
                self.poll().await?;
            }
        }
        Ok(())
    }

    /// Lets rotors come to rest.
    pub async fn settle(&mut self, until: Instant) -> Result<(), Interrupt> {
        while self.now() < until {
            self.poll().await?;
        }
        Ok(())
    }

    /// Takes power from motors, and from all that would go on pulling at the same belt. The axes that they held are no
    /// longer homed, and a print that is under way has lost them.
    pub fn unpower(&mut self, motors: MotorSet) {
        let motors = self.settings.residuals().with_opponents(motors);
        let on = self.power.powered().without(motors);
        self.power.set(on, self.now());
        let mechanism = self.motion.groups().mechanism();
        self.homed.release(motors, mechanism);
        self.job.note_lost([0, 1, 2].map(|axis| mechanism.motors_of(axis).intersects(motors)));
        let belt = self.settings.residuals().motors();
        if belt.intersects(motors) {
            self.trimming.forget();
        }
    }

    /// Takes power from all motors when nothing has moved for long enough. Called with the heat work, every 5 ms.
    pub(super) fn watch_idleness(&mut self, now: Instant) {
        let keeps_place = self.job.is_paused() && !self.homed.lacks_one_of(self.job.to_home([false; 3], false));
        let is_waiting = keeps_place || !self.pauses.waiting().is_idle_for_motors();
        if is_waiting || self.motion.has_motion() || self.trimming.is_measuring() {
            self.power.note_motion(now);
        } else if self.power.is_idle(now, self.job.is_printing()) {
            self.unpower(MotorSet::ALL);
        }
    }

    /// Has a job done with one driver.
    pub async fn ask_driver(
        &mut self,
        job: DriverJob,
        motor: Motor,
    ) -> Result<Result<Reading, DriverError>, Interrupt> {
        self.power.ask(job, motor);
        loop {
            if let Some(result) = self.power.answer() {
                return Ok(result);
            }
            self.poll().await?;
        }
    }

    /// Ends the motion and takes the power from all motors, at once. In this order, so that the Stepper makes no step
    /// without power.
    pub(super) fn stop_and_cut(&mut self) {
        self.motion.abort();
        self.power.cut();
        self.limping.end();
    }

    /// Continues the work of the drivers. A fault ends the motion at once.
    pub(super) fn tend_drivers(&mut self, now: Instant) -> Result<(), Interrupt> {
        match self.power.step(now) {
            Some(News::Stopped(fault)) => self.meet_driver_fault(fault),
            Some(News::Hot(motor)) => {
                let name = self.settings.name_of(motor);
                self.hosts.notify_all(text!(
                    "echo:driver of motor {name} is hot and will switch itself off if it gets hotter"
                ));
            }
            None => {}
        }
        // Asked at every turn: a command in the middle of a transfer may miss it once. Limp mode needs a fault.
        if self.power.fault().is_none() {
            return Ok(());
        }
        if self.limping.is_late(now) {
            self.stop_and_cut();
        }
        if self.limping.is_wanted() {
            Err(Interrupt::Limp)
        } else if self.limping.is_under_way() {
            Ok(())
        } else {
            Err(Interrupt::Halt)
        }
    }
}

/// Says why this board has no machine, if it has none.
fn refuse_without_machine<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>) -> Result<(), Interrupt> {
    let Some(why) = main_loop.board.refusal() else { return Ok(()) };
    main_loop.say(text!("Error:{why}; no motor got power"));
    Err(Interrupt::NoPower)
}
