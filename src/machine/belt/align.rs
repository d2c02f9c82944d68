//! Alignment: motors of one belt are turned against each other until none of them strains it.
//!
//! How hard a motor pulls, a TMC2209 knows only while it turns, and only how hard, not which way (SG_RESULT; datasheet rev 1.09, section 11).
//! So the tool goes to and fro with the belt strained on purpose to one side and to the other: where both are as hard, there is no
//! strain in the middle ([`load_curve`](super::load_curve)). Drivers measure in stealthChop, which they are put into meanwhile.

use super::diagnosis::FULL_STEPS_A_TURN;
use super::load_curve::{Findings, Load, Readings, Slope, apex, is_less_loaded, load_of_stroke, slope, thousandths};
use crate::driver::{DriverError, Fault, Job};
use crate::kinematics::{Residual, Residuals, motors_in};
use crate::machine::answers::belt_answer::AlignError;
use crate::machine::console::{Console, PortSet};
use crate::machine::interrupt::Interrupt;
use crate::machine::state::trimming::Found;
use crate::motion::Target;
use crate::port::{Clock, EndstopSet, Motor, MotorSet, Pend};
use crate::settings::Settings;
use crate::units::{Mm, MmPerSec, Steps};

/// Speed of a stroke: a turn a second of a pulley of 40 mm. Load is measured too coarsely far below (section 11: "a few 10 rpm").
const SPEED: MmPerSec = MmPerSec::const_from_int(40);

/// Length of a stroke, 1.5 s: some 25 jobs of [`Job::Load`] beside the polls. On a short axis a third of it.
const STROKE: Mm = Mm::const_from_int(60);

/// What of it is not looked at, at either end: enough to reach the speed with 200 mm/s2.
const RAMP: Mm = Mm::const_from_int(4);

/// Trim of either arm of the load curve, in full steps: as much as power-up leaves at most, so that the apex lies between.
const ARM: i32 = 2;

/// How far the apex is looked for, in arms: three electrical turns. Four motors that pull against each other by more do not hold
/// (docs/twin.md: a single turn takes a third of their torque).
const MOST_ARMS: i32 = 6;

/// Findings of an apex that are averaged: three at least, and more until they agree to [`SURE`].
const ROUNDS: core::ops::Range<i64> = 3..12;

/// How sure a finding has to be, in 256ths of a step, beyond the half step that nothing can be trimmed to: 0.4.
const SURE: i64 = 102;

/// stealthChop tunes itself at standstill, for more than 130 ms (section 6.2.1).
const TUNING_MS: u32 = 200;

/// Why work on the belt ended early.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum BeltError {
    Align(AlignError),
    Interrupted(Interrupt),
}

impl From<Interrupt> for BeltError {
    fn from(interrupt: Interrupt) -> Self {
        Self::Interrupted(interrupt)
    }
}

impl From<AlignError> for BeltError {
    fn from(error: AlignError) -> Self {
        Self::Align(error)
    }
}

/// The motor of a residual that is turned against the others, and its part of the sum.
pub(super) fn trimmed(residual: &Residual) -> Option<(Motor, i32)> {
    Motor::ALL.into_iter().zip(*residual).find(|(_, times)| *times != 0)
}

/// What a preload of so many steps makes of a residual: as the trimmed motor turns by it.
pub(super) fn preload_of(residual: &Residual, preload: i32) -> i32 {
    trimmed(residual).map_or(0, |(_, times)| preload * times.abs())
}

/// The trim with which the motors of a residual bear least.
#[derive(Clone, Copy)]
pub(super) struct ApexFound {
    /// In steps from where the trimmed motor was.
    pub step: i32,
    /// How far it is from there at most, in 256ths of a step.
    within: i64,
    slope: Slope,
}

/// Where a scan stands: how far the motor is trimmed from where it was.
struct Scan {
    motor: Motor,
    motors: MotorSet,
    at: i32,
}

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// What the motors of x and y could do to the belt.
    pub(in crate::machine) fn residuals(&self) -> Residuals {
        Residuals::new(&self.settings.mechanism, self.settings.belt.is_closed)
    }

    /// Aligns all motors that can pull against each other. They have power, and the tool has room along x. It ends somewhere near: x and y
    /// are to be homed again.
    pub(super) async fn align(&mut self) -> Result<(), BeltError> {
        let residuals = self.residuals();
        self.trimming.forget();
        self.trimming.note_phase(false);
        self.homed.release(residuals.motors(), self.real.groups().mechanism());
        self.begin_measuring(residuals.motors()).await?;
        let result = self.align_each(&residuals).await;
        if !matches!(result, Err(BeltError::Interrupted(_))) {
            self.end_measuring().await?;
        }
        result
    }

    async fn align_each(&mut self, residuals: &Residuals) -> Result<(), BeltError> {
        for (number, residual) in residuals.iter().enumerate() {
            let Some(found) = self.find_apex(residual).await? else { continue };
            self.learn_phase(number, residual).await?;
            self.leave_at(number, residual, found).await?;
        }
        self.trimming.align();
        Ok(())
    }

    /// Leaves the trimmed motor of a residual, which stands at the apex, with the preload that is wanted, and notes what was found.
    pub(super) async fn leave_at(
        &mut self,
        number: usize,
        residual: &Residual,
        ApexFound { step, within, slope }: ApexFound,
    ) -> Result<(), Interrupt> {
        let Some((motor, times)) = trimmed(residual) else { return Ok(()) };
        self.trim(motor, preload_of(residual, self.preload_steps()) / times).await?;
        let was = self.belt_length(i64::from(-step * times) * 1000);
        let per_mm = slope.readings_per_mm(self.settings.axes.x.steps_per_mm.to_num());
        let found = Found { was, within: self.belt_length(thousandths(within)), readings_per_mm: Some(per_mm) };
        self.trimming.note(number, found);
        Ok(())
    }

    /// The preload in steps of belt.
    pub(super) fn preload_steps(&self) -> i32 {
        self.belt_steps(self.settings.belt.preload).wrapping_round().to_num()
    }

    /// A length of belt in steps.
    fn belt_steps(&self, length: Mm) -> Steps {
        let per_mm = self.settings.axes.x.steps_per_mm;
        Steps::from_bits(((i128::from(length.to_bits()) * i128::from(per_mm.to_bits())) >> 16) as i64)
    }

    /// Thousandths of a step of belt as a length.
    pub(super) fn belt_length(&self, thousandths: i64) -> Mm {
        let per_mm = i64::from(self.settings.axes.x.steps_per_mm.to_bits()).max(1);
        Mm::from_bits((i128::from(thousandths) * (1 << 48) / (i128::from(per_mm) * 1000)) as i64)
    }

    /// Has the drivers of these motors measure loads.
    pub(super) async fn begin_measuring(&mut self, motors: MotorSet) -> Result<(), BeltError> {
        if !motors.without(self.drivers.lines()).is_empty() {
            return Err(AlignError::NoUart.into());
        }
        self.finish().await?;
        let mut measuring: Settings = *self.settings;
        measuring.drivers.belt.stealth = true;
        measuring.drivers.belt.hybrid_threshold = MmPerSec::ZERO;
        // A motor at rest has all its torque: the belt is strained on purpose.
        measuring.drivers.belt.hold_percent = 100;
        self.trimming.measure(true);
        self.drivers.want(&measuring);
        self.until(|c| c.drivers.is_configured()).await?;
        let tuned = self.ports.clock.now().after_ms(TUNING_MS);
        self.settle(tuned).await?;
        Ok(())
    }

    /// Waits until drivers are as the settings say again, if they measure loads: nothing moves while they change their mode. Motion
    /// rests.
    pub(in crate::machine) async fn end_measuring(&mut self) -> Result<(), Interrupt> {
        if !self.trimming.is_measuring() {
            return Ok(());
        }
        self.trimming.measure(false);
        self.drivers.want(&self.settings);
        self.until(|c| c.drivers.is_configured()).await
    }

    /// Looks for the trim at which the motors of a residual do not pull against each other, and leaves it there.
    pub(super) async fn find_apex(&mut self, residual: &Residual) -> Result<Option<ApexFound>, BeltError> {
        let Some((motor, _)) = trimmed(residual) else { return Ok(None) };
        let mut scan = Scan { motor, motors: motors_in(residual), at: 0 };
        let found = self.scan(&mut scan).await;
        if let Err(BeltError::Align(_)) = found {
            // Nothing is known, so nothing is changed.
            self.trim(motor, -scan.at).await?;
        }
        found.map(Some)
    }

    async fn scan(&mut self, scan: &mut Scan) -> Result<ApexFound, BeltError> {
        let arm = ARM * i32::from(self.settings.drivers.belt.microsteps);
        let mut middle = 0;
        let mut loads = [self.load_at(scan, -arm).await?, self.load_at(scan, 0).await?, self.load_at(scan, arm).await?];
        // Uphill, until the summit is in the middle.
        loop {
            let [left, here, right] = loads;
            if is_less_loaded(left, here) {
                middle -= arm;
                loads = [self.load_at(scan, middle - arm).await?, left, here];
            } else if is_less_loaded(right, here) {
                middle += arm;
                loads = [here, right, self.load_at(scan, middle + arm).await?];
            } else {
                break;
            }
            if middle.abs() > MOST_ARMS * arm {
                return Err(AlignError::TooFar.into());
            }
        }
        let slope = slope(loads, arm.into()).ok_or(AlignError::Flat)?;
        let [left, _, right] = loads;
        let mut findings = Findings::default();
        findings.note(middle, apex(left, right, slope));
        let mut about = findings.step();
        findings = Findings::default();
        while findings.count() < ROUNDS.start || findings.bound() > 128 + SURE {
            if findings.count() >= ROUNDS.end {
                return Err(AlignError::Unsure.into());
            }
            let (left, right) = (self.load_at(scan, about - arm).await?, self.load_at(scan, about + arm).await?);
            findings.note(about, apex(left, right, slope));
            about = findings.step();
        }
        self.go_to(scan, about).await?;
        Ok(ApexFound { step: about, within: findings.bound(), slope })
    }

    /// Turns the trimmed motor to a place, counted from where the scan began.
    async fn go_to(&mut self, scan: &mut Scan, place: i32) -> Result<(), Interrupt> {
        self.trim(scan.motor, place - scan.at).await?;
        scan.at = place;
        Ok(())
    }

    /// How hard the motors pull with this trim, on a stroke along x and back.
    async fn load_at(&mut self, scan: &mut Scan, place: i32) -> Result<Load, BeltError> {
        self.go_to(scan, place).await?;
        let ([x, ..], length) = (self.planner.mm(self.planner.end()), self.settings.axes.x.length);
        let stroke = STROKE.min(length / 3);
        let stroke = if x > length / 2 { -stroke } else { stroke };
        let (mut there, mut back) = (Readings::default(), Readings::default());
        self.stroke(stroke, scan.motors, &mut there).await?;
        self.stroke(-stroke, scan.motors, &mut back).await?;
        Ok(load_of_stroke(&there, &back, scan.motors).ok_or(AlignError::TooFewReadings)?)
    }

    async fn stroke(&mut self, by: Mm, motors: MotorSet, readings: &mut Readings) -> Result<(), BeltError> {
        let [start, ..] = self.real_steps();
        let mut position = self.planner.mm(self.planner.end());
        let [x, ..] = &mut position;
        *x = x.saturating_add(by);
        self.plan(Target { position, speed: SPEED, has_overrides: false, watch: EndstopSet::NONE }).await?;
        let cruise = self.belt_steps(RAMP)..self.belt_steps(by.abs() - RAMP);
        let mut is_in_cruise = false;
        while self.has_motion() {
            self.policy.note_awaited();
            self.planner.release_all();
            for motor in Motor::ALL.into_iter().filter(|motor| motors.has(*motor)) {
                let reading = self.ask_driver(Job::Load, motor).await?;
                let reading = reading.map_err(|error: DriverError| AlignError::Driver(Fault { motor, error }))?;
                let was_in_cruise = is_in_cruise;
                let [x, ..] = self.real_steps();
                is_in_cruise = cruise.contains(&x.wrapping_sub(start).wrapping_abs());
                if was_in_cruise && is_in_cruise {
                    reading.loads().into_iter().for_each(|load| readings.note(motor, load.into()));
                }
            }
        }
        self.finish().await?;
        Ok(())
    }
}

/// Skips of one turn are never too far, whatever power-up leaves with them.
const _: () = assert!(MOST_ARMS * ARM >= FULL_STEPS_A_TURN + ARM);
