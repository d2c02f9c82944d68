//! Alignment: trims motors of one belt against each other until none of them strains it.
//!
//! A TMC2209 measures a motor's load only while it turns, and without its direction (SG_RESULT; datasheet rev 1.09,
//! section 11). So the tool moves back and forth with the belt strained on purpose, first one way and then the other.
//! Where both loads are equal, the strain in the middle is zero ([`load_curve`](super::load_curve)). Drivers measure in
//! stealthChop, which is switched on for this time.

pub(in crate::machine) use super::scan::BeltError;

use super::align_error::AlignError;
use super::diagnosis::FULL_STEPS_A_TURN;
use super::load_curve::{
    Findings, PARTS, Slope, apex, contradiction, dragged, error, is_less_loaded, thousandths, without_torque,
};
use super::scan::{ALL, ARM, ARMS, LEFT, RIGHT, Scan, go_to, measure};
use crate::kinematics::{Residual, Residuals};
use crate::machine::apart::apart;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::phase::find_phase;
use crate::machine::main_loop::trim::{preload_of, trim, trimmed};
use crate::machine::ports::PortSet;
use crate::machine::reports::residual_sum::ResidualSum;
use crate::machine::state::trimming::Found;
use crate::port::{MotorSet, Wake};
use crate::settings::Settings;
use crate::units::MmPerSec;
use core::pin::pin;

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
        per_mm(self.slope, settings)
    }
}

/// What is done with the motors of each residual, as their loads are measured.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Work {
    Align,
    Prove,
}

/// Aligns all motors that can pull against each other. They have power, and the tool has room along x and y. The tool
/// ends near its place. The caller then homes x and y and proves the result ([`measure_again`]).
pub(in crate::machine) async fn align<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<(), BeltError> {
    let residuals = main_loop.settings.residuals();
    main_loop.trimming.forget();
    main_loop.trimming.note_phase(false);
    let mechanism = main_loop.motion.groups().mechanism();
    main_loop.homed.release(residuals.motors(), mechanism);
    apart(pin!(measure_each(main_loop, &residuals, Work::Align))).await
}

/// Proves that the belt has the wanted strain. A skip after trimming, or one that spoiled the findings, strains it by
/// about four full steps. A roller that holds strain back holds another one after homing. The proof relies on no
/// earlier finding, and both have to agree.
pub(in crate::machine) fn measure_again<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    residuals: &Residuals,
) -> impl Future<Output = Result<(), BeltError>> {
    measure_each(main_loop, residuals, Work::Prove)
}

async fn measure_each<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    residuals: &Residuals,
    work: Work,
) -> Result<(), BeltError> {
    begin_measuring(main_loop, residuals.motors()).await?;
    let mut result = Ok(());
    for (number, residual) in residuals.iter().enumerate() {
        result = match work {
            Work::Align => align_one(main_loop, number, residual).await,
            Work::Prove => prove_one(main_loop, number, residual).await,
        };
        if result.is_err() {
            break;
        }
    }
    if !matches!(result, Err(BeltError::Interrupted(_))) {
        end_measuring(main_loop).await?;
    }
    result
}

async fn align_one<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    number: usize,
    residual: &Residual,
) -> Result<(), BeltError> {
    let Some(found) = apart(pin!(find_apex(main_loop, number, residual))).await? else { return Ok(()) };
    let phase = find_phase(main_loop, residual, found.beside).await?;
    Ok(leave_at(main_loop, number, residual, found, phase).await?)
}

async fn prove_one<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    number: usize,
    residual: &Residual,
) -> Result<(), BeltError> {
    let Some((motor, times)) = trimmed(residual) else { return Ok(()) };
    let mut scan = Scan::new(main_loop, number, motor, residual);
    let middle = -preload_of(residual, main_loop.settings.preload_steps()) / times;
    let measured = apart(pin!(measure(main_loop, &mut scan, middle, ALL))).await;
    if !matches!(measured, Err(BeltError::Interrupted(_))) {
        go_to(main_loop, &mut scan, 0).await?;
    }
    measured?;
    let slope = scan.slope();
    let contradiction = each_follows(main_loop, &scan, slope)?;
    let slope = slope.ok_or(AlignError::Flat)?;
    let apex = apex(&scan.loads, slope);
    if apex.at.abs() > AGREES + contradiction + 3 * error(apex.variance) {
        let strain = main_loop.settings.belt_length(thousandths(apex.at * i64::from(-times)));
        return Err(AlignError::Strained(strain).into());
    }
    let within = main_loop.settings.belt_length(thousandths(128 + SURE + contradiction));
    let per_mm = per_mm(slope, &main_loop.settings);
    main_loop.trimming.prove(number, (contradiction > 0).then_some(within), per_mm);
    Ok(())
}

/// The fall of a reading for a mm of strain.
fn per_mm(slope: Slope, settings: &Settings) -> u16 {
    slope.readings_per_mm(settings.axes.x.steps_per_mm.to_num())
}

/// Moves the trimmed motor of a residual from the apex to the wanted preload and notes the finding, with the phase if
/// it was searched for.
pub(in crate::machine) async fn leave_at<P: PortSet, W: Wake>(
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
pub(in crate::machine) async fn begin_measuring<P: PortSet, W: Wake>(
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
    main_loop.configure_drivers(Some(&measuring)).await?;
    let tuned = main_loop.now().after_ms(TUNING_MS);
    main_loop.settle(tuned).await?;
    Ok(())
}

/// Restores the drivers' settings if they measure loads. Nothing moves during the change of mode, and motion is at
/// rest.
pub(in crate::machine) async fn end_measuring<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<(), Interrupt> {
    if !main_loop.trimming.is_measuring() {
        return Ok(());
    }
    main_loop.configure_drivers(None).await?;
    main_loop.trimming.measure(false);
    Ok(())
}

/// Finds the trim at which the motors of a residual do not pull against each other, and leaves the motor there.
pub(in crate::machine) async fn find_apex<P: PortSet, W: Wake>(
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

async fn climb<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    scan: &mut Scan,
) -> Result<ApexFound, BeltError> {
    let (mut middle, mut missing) = (0, ALL);
    // Climb until the apex is in the middle.
    loop {
        apart(pin!(measure(main_loop, scan, middle, missing))).await?;
        if middle.abs() > MOST_ARMS * scan.arm {
            return Err(AlignError::TooFar.into());
        }
        let [left, here, right] = &mut scan.loads;
        if is_less_loaded(left, here) {
            middle -= scan.arm;
            (*right, *here, missing) = (*here, *left, LEFT);
        } else if is_less_loaded(right, here) {
            middle += scan.arm;
            (*left, *here, missing) = (*here, *right, RIGHT);
        } else {
            break;
        }
    }
    let slope = scan.slope();
    // A roller that holds strain back makes the belt stiffer for the motors next to it, and friction hides a part of
    // the load. So the host is told if a mm of strain takes much more or less of the load than before.
    let number = scan.number;
    let now = slope.map_or(0, |slope| per_mm(slope, &main_loop.settings));
    if slope.is_some()
        && let Some(before) = main_loop.trimming.other_load(number, now)
    {
        tell_of_load(main_loop, number, now, before);
    }
    let contradiction = each_follows(main_loop, scan, slope)?;
    let slope = slope.ok_or(AlignError::Flat)?;
    let mut findings = Findings::default();
    findings.note(middle, apex(&scan.loads, slope));
    let mut about = findings.step();
    findings = Findings::default();
    while findings.count() < ROUNDS.start || findings.bound() > 128 + SURE {
        if findings.count() >= ROUNDS.end {
            return Err(AlignError::Unsure.into());
        }
        apart(pin!(measure(main_loop, scan, about, ARMS))).await?;
        // Strain takes only a part of the torque near the apex. Far from it, strain may take all of it.
        let [left, _, right] = &scan.loads;
        if let Some(motor) = without_torque([left, right]) {
            return Err(AlignError::AtLimit(main_loop.settings.name_of(motor)).into());
        }
        findings.note(about, apex(&scan.loads, slope));
        about = findings.step();
        if findings.spread() > i64::from(scan.arm / ARM) * PARTS / 2 {
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

/// A mm of strain takes another part of the load than before, of this residual.
fn tell_of_load<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, number: usize, now: u16, before: u16) {
    let Some(residual) = main_loop.settings.residuals().iter().nth(number).copied() else { return };
    main_loop.tell(|to, facts| {
        let sum = ResidualSum(&residual, facts.settings);
        to.say(text!(
            "echo:{sum}: a mm of strain takes {now} of SG_RESULT, {before} before: a roller or motor drags, the belt \
            has changed, or currents (M906)"
        ));
    });
}

/// Refuses a motor that does not follow its field, with the apex in the middle: it moves with the next stroke. Refuses
/// loads that contradict each other by more than half a full step, at which strain and phase are not known. If other
/// motors do so without that motor, it is not to blame. Returns the contradiction, in fractions of a step.
fn each_follows<P: PortSet, W: Wake>(
    main_loop: &MainLoop<'_, P, W>,
    scan: &Scan,
    slope: Option<Slope>,
) -> Result<i64, AlignError> {
    let (loads, arm) = (&scan.loads, i64::from(scan.arm));
    let blamed = without_torque(loads).or_else(|| dragged(loads));
    let found = slope.map_or(0, |slope| contradiction(loads, arm, slope, blamed));
    if found > arm * PARTS / 4 {
        return Err(AlignError::Drags(main_loop.settings.belt_length(thousandths(found))));
    }
    blamed.map_or(Ok(found), |motor| Err(AlignError::AtLimit(main_loop.settings.name_of(motor))))
}

/// Whether a printing move needs an alignment first.
pub(in crate::machine) fn lacks_alignment<P: PortSet, W: Wake>(main_loop: &MainLoop<'_, P, W>) -> bool {
    if main_loop.trimming.is_aligned() {
        return false;
    }
    let motors = main_loop.settings.residuals().motors();
    // Motors without UART cannot be aligned, so they need not be.
    !motors.is_empty() && motors.without(main_loop.power.uarts()).is_empty()
}

/// A skip of one turn is always within the search range, with any strain of power-up.
const _: () = assert!(MOST_ARMS * ARM >= FULL_STEPS_A_TURN + ARM);
