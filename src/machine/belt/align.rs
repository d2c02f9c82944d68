//! Alignment: trims motors of one belt against each other until none of them strains it.
//!
//! A TMC2209 measures a motor's load only while it turns, and without its direction (SG_RESULT; datasheet rev 1.09,
//! section 11). So the tool moves back and forth with the belt strained on purpose, first one way and then the other.
//! Where both loads are equal, the strain in the middle is zero ([`load_curve`](super::load_curve)). Drivers measure in
//! stealthChop, which is switched on for this time.

use super::diagnosis::FULL_STEPS_A_TURN;
use super::load_curve::{
    Findings, Load, PARTS, Readings, Slope, apex, contradiction, dragged, is_less_loaded, load_of_stroke, slope,
    thousandths, without_torque,
};
use crate::driver::{DriverError, Fault, Job};
use crate::kinematics::{Residual, Residuals, motors_in};
use crate::machine::answers::answer::Answer;
use crate::machine::answers::belt_answer::{AlignError, BeltAnswer};
use crate::machine::apart::apart;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::phase::find_phase;
use crate::machine::main_loop::trim::{preload_of, trim, trimmed};
use crate::machine::ports::PortSet;
use crate::machine::state::trimming::Found;
use crate::motion::Target;
use crate::port::{EndstopSet, Motor, MotorSet, Pend};
use crate::settings::{HomedAxis, Range, Settings};
use crate::units::{Mm, MmPerSec, Steps, whole_root};
use core::pin::pin;

/// Speed of a stroke: one turn a second of a pulley of 40 mm. Far below, load readings are too coarse (section 11: "a
/// few 10 rpm").
const SPEED: MmPerSec = MmPerSec::const_from_int(40);

/// Length of a stroke, 1.5 s: about 25 jobs of [`Job::Load`] between the polls. On a short axis, a third of it.
const STROKE: Mm = Mm::const_from_int(60);

/// Part of a stroke at either end that is not measured: enough to reach the speed with 200 mm/s2.
const RAMP: Mm = Mm::const_from_int(4);

/// Trim to either side on the load curve, in full steps. Power-up leaves at most this much, so the apex lies between.
const ARM: i32 = 2;

/// Search range of the apex, in arms: three electrical turns. Four motors do not hold a larger strain
/// (docs/research/twin.md: a single turn takes a third of their torque).
const MOST_ARMS: i32 = 6;

/// Findings of an apex that are averaged: at least three, and more until they agree to [`SURE`].
const ROUNDS: core::ops::Range<i64> = 3..12;

/// Required uncertainty of a finding in 256ths of a step: 0.4, in addition to the half step of trimming. `WITHIN` in
/// `main_loop::phase` includes it.
const SURE: i64 = 102;

/// The proof's apex may be this far from the first one besides chance, in 256ths of a step: its bound, and half a step.
const AGREES: i64 = 128 + SURE + 128;

/// A driver in stealthChop tunes itself at rest for more than 130 ms (section 6.2.1).
const TUNING_MS: u32 = 200;

/// Why work on the belt ended early.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum BeltError {
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

/// The trim with the least load on the motors of a residual.
#[derive(Clone, Copy)]
pub(in crate::machine) struct ApexFound {
    /// In steps from the trimmed motor's start.
    pub step: i32,
    /// The finding's distance from that step, in 256ths of a step.
    pub beside: i64,
    /// Its error bound, in 256ths of a step.
    pub within: i64,
    /// Loads contradict each other.
    pub is_contradicted: bool,
    slope: Slope,
}

impl ApexFound {
    /// The fall of a reading for a mm of strain.
    pub fn readings_per_mm(&self, settings: &Settings) -> u16 {
        self.slope.readings_per_mm(settings.axes.x.steps_per_mm.to_num())
    }
}

/// State of a scan: the motor's trim from its start.
struct Scan {
    /// The residual's number.
    number: usize,
    motor: Motor,
    motors: MotorSet,
    /// Strokes go along y, because not all of the motors turn for x.
    is_along_y: bool,
    at: i32,
}

impl Scan {
    /// A scan of a residual, with the motor at its present place.
    fn new<P: PortSet, W: Pend>(
        main_loop: &MainLoop<'_, P, W>,
        number: usize,
        motor: Motor,
        residual: &Residual,
    ) -> Self {
        let (motors, mechanism) = (motors_in(residual), main_loop.motion.groups().mechanism());
        let is_along_y = motors.without(mechanism.motors_of(0)) != MotorSet::NONE;
        Self { number, motor, motors, is_along_y, at: 0 }
    }
}

/// Aligns all motors that can pull against each other. They have power, and the tool has room along x and y. The tool
/// ends near its place. The caller then homes x and y and proves the result ([`measure_again`]).
pub(in crate::machine) async fn align<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<(), BeltError> {
    let residuals = main_loop.settings.residuals();
    main_loop.trimming.forget();
    main_loop.trimming.note_phase(false);
    let mechanism = main_loop.motion.groups().mechanism();
    main_loop.homed.release(residuals.motors(), mechanism);
    begin_measuring(main_loop, residuals.motors()).await?;
    let result = align_each(main_loop, &residuals).await;
    if !matches!(result, Err(BeltError::Interrupted(_))) {
        end_measuring(main_loop).await?;
    }
    result
}

async fn align_each<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    residuals: &Residuals,
) -> Result<(), BeltError> {
    for (number, residual) in residuals.iter().enumerate() {
        let Some(found) = apart(pin!(find_apex(main_loop, number, residual))).await? else { continue };
        let phase = find_phase(main_loop, residual, found.beside).await?;
        leave_at(main_loop, number, residual, found, phase).await?;
    }
    Ok(())
}

/// Proves that the belt has the wanted strain. A skip after trimming, or one that spoiled the findings, strains it by
/// about four full steps. A roller that holds strain back holds another one after homing. The proof relies on no
/// earlier finding, and both have to agree.
pub(in crate::machine) async fn measure_again<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    residuals: &Residuals,
) -> Result<(), BeltError> {
    begin_measuring(main_loop, residuals.motors()).await?;
    let result = measure_each_again(main_loop, residuals).await;
    if !matches!(result, Err(BeltError::Interrupted(_))) {
        end_measuring(main_loop).await?;
    }
    result
}

async fn measure_each_again<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    residuals: &Residuals,
) -> Result<(), BeltError> {
    let full_step = i32::from(main_loop.settings.drivers.belt.microsteps);
    for (number, residual) in residuals.iter().enumerate() {
        let Some((motor, times)) = trimmed(residual) else { continue };
        let mut scan = Scan::new(main_loop, number, motor, residual);
        let (middle, arm) = (-preload_of(residual, main_loop.settings.preload_steps()) / times, ARM * full_step);
        let loads = loads_about(main_loop, &mut scan, middle, arm).await;
        if !matches!(loads, Err(BeltError::Interrupted(_))) {
            go_to(main_loop, &mut scan, 0).await?;
        }
        let loads @ [left, _, right] = loads?;
        let slope = slope(loads, arm.into());
        let contradiction = each_follows(main_loop, loads, arm, slope)?;
        let slope = slope.ok_or(AlignError::Flat)?;
        let apex = apex(left, right, slope);
        if apex.at.abs() > AGREES + contradiction + 3 * whole_root(apex.variance.unsigned_abs()) as i64 {
            let strain = main_loop.settings.belt_length(thousandths(apex.at * i64::from(-times)));
            return Err(AlignError::Strained(strain).into());
        }
        let within = main_loop.settings.belt_length(thousandths(128 + SURE + contradiction));
        let per_mm = slope.readings_per_mm(main_loop.settings.axes.x.steps_per_mm.to_num());
        main_loop.trimming.prove(number, (contradiction > 0).then_some(within), per_mm);
    }
    Ok(())
}

/// Moves the trimmed motor of a residual from the apex to the wanted preload and notes the finding, with the phase if
/// it was searched for.
pub(in crate::machine) async fn leave_at<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    number: usize,
    residual: &Residual,
    apex: ApexFound,
    phase: Option<u16>,
) -> Result<(), Interrupt> {
    let Some((motor, times)) = trimmed(residual) else { return Ok(()) };
    trim(main_loop, motor, preload_of(residual, main_loop.settings.preload_steps()) / times).await?;
    let found = Found {
        was: main_loop.settings.belt_length(i64::from(-apex.step * times) * 1000),
        within: main_loop.settings.belt_length(thousandths(apex.within)),
        readings_per_mm: Some(apex.readings_per_mm(&main_loop.settings)),
        phase,
        is_contradicted: apex.is_contradicted,
    };
    main_loop.trimming.note(number, found);
    Ok(())
}

/// Switches the drivers of these motors to load measurement.
pub(in crate::machine) async fn begin_measuring<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    motors: MotorSet,
) -> Result<(), BeltError> {
    if !motors.without(main_loop.power.uarts()).is_empty() {
        return Err(AlignError::NoUart.into());
    }
    main_loop.finish().await?;
    let mut measuring: Settings = *main_loop.settings;
    measuring.drivers.belt.stealth = true;
    measuring.drivers.belt.hybrid_threshold = MmPerSec::ZERO;
    // A motor at rest needs all its torque, because the belt is strained on purpose.
    measuring.drivers.belt.hold_percent = 100;
    measuring.drivers.own.iter_mut().for_each(|own| own.hold_percent = 0);
    main_loop.trimming.measure(true);
    main_loop.configure_drivers(&measuring).await?;
    let tuned = main_loop.now().after_ms(TUNING_MS);
    main_loop.settle(tuned).await?;
    Ok(())
}

/// Restores the drivers' settings if they measure loads. Nothing moves during the change of mode, and motion is at
/// rest.
pub(in crate::machine) async fn end_measuring<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<(), Interrupt> {
    if !main_loop.trimming.is_measuring() {
        return Ok(());
    }
    main_loop.restore_drivers().await?;
    main_loop.trimming.measure(false);
    Ok(())
}

/// Finds the trim at which the motors of a residual do not pull against each other, and leaves the motor there.
pub(in crate::machine) async fn find_apex<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    number: usize,
    residual: &Residual,
) -> Result<Option<ApexFound>, BeltError> {
    let Some((motor, _)) = trimmed(residual) else { return Ok(None) };
    let mut scan = Scan::new(main_loop, number, motor, residual);
    let found = apart(pin!(climb(main_loop, &mut scan))).await;
    if let Err(BeltError::Align(_)) = found {
        // Nothing is known, so the motor returns.
        trim(main_loop, motor, -scan.at).await?;
    }
    found.map(Some)
}

async fn climb<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    scan: &mut Scan,
) -> Result<ApexFound, BeltError> {
    let full_step = i32::from(main_loop.settings.drivers.belt.microsteps);
    let arm = ARM * full_step;
    let mut middle = 0;
    let mut loads = loads_about(main_loop, scan, middle, arm).await?;
    // Climb until the apex is in the middle.
    loop {
        let [left, here, right] = loads;
        if is_less_loaded(left, here) {
            middle -= arm;
            loads = [load_at(main_loop, scan, middle - arm).await?, left, here];
        } else if is_less_loaded(right, here) {
            middle += arm;
            loads = [here, right, load_at(main_loop, scan, middle + arm).await?];
        } else {
            break;
        }
        if middle.abs() > MOST_ARMS * arm {
            return Err(AlignError::TooFar.into());
        }
    }
    let slope = slope(loads, arm.into());
    if let Some(slope) = slope {
        tell_of_load(main_loop, scan.number, slope).await?;
    }
    let contradiction = each_follows(main_loop, loads, arm, slope)?;
    let slope = slope.ok_or(AlignError::Flat)?;
    let [left, _, right] = loads;
    let mut findings = Findings::default();
    findings.note(middle, apex(left, right, slope));
    let mut about = findings.step();
    findings = Findings::default();
    while findings.count() < ROUNDS.start || findings.bound() > 128 + SURE {
        if findings.count() >= ROUNDS.end {
            return Err(AlignError::Unsure.into());
        }
        let (left, right) =
            (load_at(main_loop, scan, about - arm).await?, load_at(main_loop, scan, about + arm).await?);
        all_have_torque(&[left, right])?;
        findings.note(about, apex(left, right, slope));
        about = findings.step();
        if findings.spread() > i64::from(full_step) * PARTS / 2 {
            return Err(AlignError::Unsure.into());
        }
    }
    go_to(main_loop, scan, about).await?;
    Ok(ApexFound {
        step: about,
        beside: findings.beside(),
        within: findings.bound() + contradiction,
        is_contradicted: contradiction > 0,
        slope,
    })
}

/// Tells the host if a mm of strain takes much more or less of the load than before. A roller that holds
/// strain back makes the belt stiffer for the motors next to it, and friction hides a part of the load.
async fn tell_of_load<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    number: usize,
    slope: Slope,
) -> Result<(), Interrupt> {
    let now = slope.readings_per_mm(main_loop.settings.axes.x.steps_per_mm.to_num());
    match main_loop.trimming.other_load(number, now) {
        Some(before) => main_loop.reply(Answer::Belt(BeltAnswer::Load { number, now, before })).await,
        None => Ok(()),
    }
}

/// Refuses a motor that does not follow its field, with the apex in the middle: it moves with the next stroke. Refuses
/// loads that contradict each other by more than half a full step, at which strain and phase are not known. If other
/// motors do so without that motor, it is not to blame. Returns the contradiction, in fractions of a step.
fn each_follows<P: PortSet, W: Pend>(
    main_loop: &MainLoop<'_, P, W>,
    loads: [Load; 3],
    arm: i32,
    slope: Option<Slope>,
) -> Result<i64, AlignError> {
    let blamed = without_torque(&loads).or_else(|| dragged(loads));
    let found = slope.map_or(0, |slope| contradiction(loads, arm.into(), slope, blamed));
    if found > i64::from(arm) * PARTS / 4 {
        return Err(AlignError::Drags(main_loop.settings.belt_length(thousandths(found))));
    }
    blamed.map_or(Ok(found), |motor| Err(AlignError::AtLimit(motor)))
}

/// Refuses a motor without torque near the apex, where strain takes only a part of it. Far from the apex, strain may
/// take all of it.
fn all_have_torque(loads: &[Load]) -> Result<(), AlignError> {
    without_torque(loads).map_or(Ok(()), |motor| Err(AlignError::AtLimit(motor)))
}

/// Turns the trimmed motor to a place, counted from the start of the scan.
async fn go_to<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    scan: &mut Scan,
    place: i32,
) -> Result<(), Interrupt> {
    trim(main_loop, scan.motor, place - scan.at).await?;
    scan.at = place;
    Ok(())
}

/// Load of the motors at a trim, and with an arm less and more.
async fn loads_about<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    scan: &mut Scan,
    middle: i32,
    arm: i32,
) -> Result<[Load; 3], BeltError> {
    let left = load_at(main_loop, scan, middle - arm).await?;
    Ok([left, load_at(main_loop, scan, middle).await?, load_at(main_loop, scan, middle + arm).await?])
}

/// Load of the motors at this trim, on a stroke along x or y and back.
async fn load_at<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    scan: &mut Scan,
    place: i32,
) -> Result<Load, BeltError> {
    go_to(main_loop, scan, place).await?;
    let [x, y, ..] = main_loop.motion.end_mm();
    let (at, axis) = if scan.is_along_y { (y, HomedAxis::Y) } else { (x, HomedAxis::X) };
    let Range { least, most } = main_loop.settings.reach(axis);
    let length = most.saturating_sub(least);
    let stroke = STROKE.min(length / 3);
    let stroke = if at > least.saturating_add(length / 2) { -stroke } else { stroke };
    let (mut there, mut back) = (Readings::default(), Readings::default());
    go_along(main_loop, scan, stroke, &mut there).await?;
    go_along(main_loop, scan, -stroke, &mut back).await?;
    Ok(load_of_stroke(&there, &back, scan.motors).ok_or(AlignError::TooFewReadings)?)
}

async fn go_along<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    scan: &Scan,
    by: Mm,
    readings: &mut Readings,
) -> Result<(), BeltError> {
    let along = |[x, y, ..]: [Steps; 4]| if scan.is_along_y { y } else { x };
    let start = along(main_loop.motion.real_steps());
    let mut position = main_loop.motion.end_mm();
    let [x, y, ..] = &mut position;
    let at = if scan.is_along_y { y } else { x };
    *at = at.saturating_add(by);
    main_loop.plan(Target { position, speed: SPEED.into(), has_overrides: false, watch: EndstopSet::NONE }).await?;
    let cruise =
        along(main_loop.motion.to_steps([RAMP; 4]))..along(main_loop.motion.to_steps([by.saturating_abs() - RAMP; 4]));
    let mut is_in_cruise = false;
    while main_loop.motion.has_motion() {
        main_loop.motion.release_all(&main_loop.settings);
        for motor in Motor::ALL.into_iter().filter(|motor| scan.motors.has(*motor)) {
            let reading = main_loop.ask_driver(Job::Load, motor).await?;
            let reading = reading.map_err(|error: DriverError| {
                AlignError::Driver(Fault { motor, name: main_loop.settings.name_of(motor), error })
            })?;
            let was_in_cruise = is_in_cruise;
            is_in_cruise = cruise.contains(&along(main_loop.motion.real_steps()).wrapping_sub(start).wrapping_abs());
            if was_in_cruise && is_in_cruise {
                reading.loads().into_iter().for_each(|load| readings.note(motor, load.into()));
            }
        }
    }
    main_loop.finish().await?;
    Ok(())
}

/// Whether a printing move needs an alignment first.
pub(in crate::machine) fn lacks_alignment<P: PortSet, W: Pend>(main_loop: &MainLoop<'_, P, W>) -> bool {
    if main_loop.trimming.is_aligned() {
        return false;
    }
    let motors = main_loop.settings.residuals().motors();
    // Motors without UART cannot be aligned, so they need not be.
    !motors.is_empty() && motors.without(main_loop.power.uarts()).is_empty()
}

/// A skip of one turn is always within the search range, with any strain of power-up.
const _: () = assert!(MOST_ARMS * ARM >= FULL_STEPS_A_TURN + ARM);
