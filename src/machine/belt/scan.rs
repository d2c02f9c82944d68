//! A scan: the load of the motors of a residual, with one of them trimmed to several places.
//!
//! A TMC2209 measures a motor's load only while it turns, so the tool makes a stroke and goes back at each place.

use super::align_error::AlignError;
use super::load_curve::{Load, Readings, Slope, load_of_stroke, slope};
use crate::driver::{DriverError, DriverJob, Fault};
use crate::kinematics::{Residual, motors_in};
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::trim::trim;
use crate::machine::ports::PortSet;
use crate::motion::Target;
use crate::port::{EndstopSet, Motor, MotorSet, Wake};
use crate::settings::{HomedAxis, Range};
use crate::units::{Mm, MmPerSec};

/// Speed of a stroke: one turn a second of a pulley of 40 mm. Far below, load readings are too coarse (section 11: "a
/// few 10 rpm").
const SPEED: MmPerSec = MmPerSec::const_from_int(40);

/// Length of a stroke, 1.5 s: about 25 jobs of [`DriverJob::Load`] between the polls. On a short axis, a third of it.
const STROKE: Mm = Mm::const_from_int(60);

/// Part of a stroke at either end that is not measured: enough to reach the speed with 200 mm/s2.
const RAMP: Mm = Mm::const_from_int(4);

/// Trim to either side on the load curve, in full steps. Power-up leaves at most this much, so the apex lies between.
pub(super) const ARM: i32 = 2;

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

/// State of a scan: the motor's trim from its start.
pub(super) struct Scan {
    /// The residual's number.
    pub number: usize,
    pub motor: Motor,
    motors: MotorSet,
    /// Strokes go along y, because not all of the motors turn for x.
    is_along_y: bool,
    pub at: i32,
    /// Steps to either side.
    pub arm: i32,
    /// The last loads: with an arm less, in the middle, and with an arm more.
    pub loads: [Load; 3],
}

/// Places of a scan: an arm less, the middle, and an arm more.
pub(super) const ALL: [bool; 3] = [true; 3];
pub(super) const LEFT: [bool; 3] = [true, false, false];
pub(super) const RIGHT: [bool; 3] = [false, false, true];
pub(super) const ARMS: [bool; 3] = [true, false, true];

impl Scan {
    /// A scan of a residual, with the motor at its present place.
    pub fn new<P: PortSet, W: Wake>(
        main_loop: &MainLoop<'_, P, W>,
        number: usize,
        motor: Motor,
        residual: &Residual,
    ) -> Self {
        let (motors, mechanism) = (motors_in(residual), main_loop.motion.groups().mechanism());
        let is_along_y = motors.without(mechanism.motors_of(0)) != MotorSet::NONE;
        let arm = ARM * i32::from(main_loop.settings.drivers.belt.microsteps);
        Self { number, motor, motors, is_along_y, at: 0, arm, loads: [Load::default(); 3] }
    }

    /// X or y of the tool, along which strokes go.
    const fn along<T: Copy>(&self, [x, y, ..]: [T; 4]) -> T {
        if self.is_along_y { y } else { x }
    }

    pub fn slope(&self) -> Option<Slope> {
        slope(&self.loads, self.arm.into())
    }
}

/// Turns the trimmed motor to a place, counted from the start of the scan.
pub(super) async fn go_to<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    scan: &mut Scan,
    place: i32,
) -> Result<(), Interrupt> {
    trim(main_loop, scan.motor, place - scan.at).await?;
    scan.at = place;
    Ok(())
}

/// Measures the load of the motors at a trim, and with an arm less and more: where it is missing. Each is measured on a
/// stroke along x or y and back.
pub(super) async fn measure<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    scan: &mut Scan,
    middle: i32,
    missing: [bool; 3],
) -> Result<(), BeltError> {
    for (place, is_missing) in missing.into_iter().enumerate() {
        if !is_missing {
            continue;
        }
        go_to(main_loop, scan, middle + (place as i32 - 1) * scan.arm).await?;
        let at = scan.along(main_loop.motion.end_mm());
        let axis = if scan.is_along_y { HomedAxis::Y } else { HomedAxis::X };
        let Range { least, most } = main_loop.settings.reach(axis);
        let length = most.saturating_sub(least);
        let mut stroke = STROKE.min(length / 3);
        if at > least.saturating_add(length / 2) {
            stroke = -stroke;
        }
        let mut there_and_back = [Readings::default(); 2];
        for readings in &mut there_and_back {
            go_along(main_loop, scan, stroke, readings).await?;
            stroke = -stroke;
        }
        let load = load_of_stroke(&there_and_back, scan.motors).ok_or(AlignError::TooFewReadings)?;
        if let Some(place) = scan.loads.get_mut(place) {
            *place = load;
        }
    }
    Ok(())
}

async fn go_along<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    scan: &Scan,
    by: Mm,
    readings: &mut Readings,
) -> Result<(), BeltError> {
    let start = scan.along(main_loop.motion.real_steps());
    let mut position = main_loop.motion.end_mm();
    let [x, y, ..] = &mut position;
    let at = if scan.is_along_y { y } else { x };
    *at = at.saturating_add(by);
    main_loop.plan(Target { position, speed: SPEED.into(), has_overrides: false, watch: EndstopSet::NONE }).await?;
    let [from, to] = [RAMP, by.saturating_abs() - RAMP].map(|place| scan.along(main_loop.motion.to_steps([place; 4])));
    let mut is_in_cruise = false;
    while main_loop.motion.has_motion() {
        main_loop.motion.release_all(&main_loop.settings);
        for motor in scan.motors.iter() {
            let reading = main_loop.ask_driver(DriverJob::Load, motor).await?;
            let reading = reading.map_err(|error: DriverError| {
                AlignError::Driver(Fault { motor, name: main_loop.settings.name_of(motor), error })
            })?;
            let was_in_cruise = is_in_cruise;
            let way = scan.along(main_loop.motion.real_steps()).wrapping_sub(start).wrapping_abs();
            is_in_cruise = from <= way && way < to;
            if was_in_cruise && is_in_cruise {
                reading.loads().into_iter().for_each(|load| readings.note(motor, load.into()));
            }
        }
    }
    main_loop.finish().await?;
    Ok(())
}
