//! M915 aligns the motors of a belt. With D it meets the switches of x and y again, to check whether the tool is where
//! the steps say. With R it also repairs the difference. Then the tool returns to its place. `belt` carries it out.

use crate::kinematics::{Mechanism, Residual, Residuals};
use crate::machine::answers::answer::Answer;
use crate::machine::answers::reply_writer::ReplyWriter;
use crate::machine::apart::apart;
use crate::machine::belt::align::{ApexFound, BeltError, begin_measuring, end_measuring, find_apex, leave_at};
use crate::machine::belt::align_error::AlignError;
use crate::machine::belt::diagnosis::{Diagnosis, Touched, diagnose, with_moved_pulley};
use crate::machine::belt::load_curve::{PARTS, thousandths};
use crate::machine::belt::report::tell_not_aligned;
use crate::machine::homing::homing_axes::home_and_align;
use crate::machine::homing::proof::{is_anywhere_aside, lengths, prove, tell_touched, touch_both};
use crate::machine::homing::shift_z::{go_to, shift_z};
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::offsets::z_reach;
use crate::machine::main_loop::phase::{drop_phase, keep_findings, phase_at_apex};
use crate::machine::main_loop::trim::{preload_of, trim, trimmed};
use crate::machine::ports::PortSet;
use crate::machine::setup::stored::note_belt_loads;
use crate::machine::state::notices::Notices;
use crate::machine::state::pulleys::{Shift, TURN, difference, shift_of, shows_a_tooth};
use crate::machine::state::trimming::Trimming;
use crate::port::{EndstopSet, Wake};
use crate::settings::Settings;
use crate::units::Mm;
use core::pin::pin;

/// Lift of z while the tool goes to the switches, so that the nozzle does not touch the print.
const LIFT: Mm = Mm::const_from_int(5);

/// The axes of the belt.
const BELT_AXES: [bool; 3] = [true, true, false];

/// The answer on a machine without such motors.
const NO_RESIDUAL: Answer<'static> =
    Answer::Line(packed!("echo:no motors of this machine can pull against each other"));

/// What was found, and done.
enum Finding {
    Diagnosis(Diagnosis),
    /// Loads could not be measured.
    NotAligned(AlignError),
    /// The fault was repaired; afterwards the x and y switches were this many steps from their expected positions.
    Repaired([i32; 2]),
    /// It was to be set right, but something kept it from being so.
    NotRepaired(AlignError),
}

impl Finding {
    fn tell<P: PortSet, W: Wake>(&self, main_loop: &mut MainLoop<'_, P, W>) {
        match *self {
            Self::Diagnosis(diagnosis) => main_loop.tell(|to, facts| report_diagnosis(to, diagnosis, facts.settings)),
            Self::NotAligned(why) => tell_not_aligned(main_loop, why),
            Self::Repaired(aside) => {
                let [x, y] = lengths(main_loop, aside);
                main_loop.say(text!("echo:belt repaired, x and y homed; touched again: X{x} Y{y} mm"));
            }
            Self::NotRepaired(why) => main_loop.say(text!("echo:belt not repaired: {why}")),
        }
    }
}

fn report_diagnosis(to: &mut ReplyWriter<'_>, diagnosis: Diagnosis, s: &Settings) {
    let line = match diagnosis {
        Diagnosis::Skip { motor, full_steps } => {
            let name = s.name_of(motor);
            return to.say(text!("echo:motor {name} has skipped by {full_steps:+} full steps"));
        }
        Diagnosis::Nothing => packed!("echo:no motor has skipped"),
        Diagnosis::Aside => packed!(
            "echo:the belt is not strained, and no skip moves the tool so far: a switch has moved, or something drags"
        ),
        Diagnosis::Moved => packed!("echo:no skip strains the belt like this (M915 aligns)"),
        Diagnosis::Alike => {
            packed!("echo:all motors have skipped equally, or a switch has moved: the belt is not strained")
        }
        Diagnosis::Several => packed!("echo:more than one skip: which motors cannot be told (M915 aligns)"),
    };
    to.say(text!("{line}"));
}

/// M915: x and y are homed, their motors aligned, and x and y homed again.
pub(in crate::machine) async fn align_belt<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    notices: &mut Notices,
) -> Result<Answer<'static>, Interrupt> {
    if main_loop.settings.residuals().is_empty() {
        return Ok(NO_RESIDUAL);
    }
    let lift = lift(main_loop).await?;
    home_and_align(main_loop, notices, BELT_AXES, true).await?;
    lower(main_loop, lift).await?;
    Ok(Answer::Nothing)
}

/// M915 D and R: finds what happened since the motors were aligned; with `repairs` it repairs that.
pub(in crate::machine) async fn examine_belt<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    notices: &mut Notices,
    repairs: bool,
) -> Result<Answer<'static>, Interrupt> {
    let residuals = main_loop.settings.residuals();
    if residuals.is_empty() {
        return Ok(NO_RESIDUAL);
    }
    let [x, y, _] = main_loop.homed.axes();
    if !(main_loop.trimming.is_aligned() && x && y && main_loop.power.is_on(residuals.motors())) {
        return Ok(Answer::Line(packed!("echo:nothing to compare with: align the belt motors first (M915)")));
    }
    let lift = lift(main_loop).await?;
    let place = main_loop.motion.end_mm();
    let aside = touch_both(main_loop).await?;
    tell_touched(main_loop, aside);
    // Until the check has succeeded, the position counts as unknown: M410 may end this with a motor on its way.
    let (homed, mut before) = (main_loop.homed, main_loop.trimming);
    let aside = Aside { now: aside, homed: before.homed_aside(), had_power: !before.is_by_phases() };
    main_loop.trimming.forget();
    let mechanism = main_loop.motion.groups().mechanism();
    main_loop.homed.release(residuals.motors(), mechanism);
    let mut finding = match examine(main_loop, &residuals, &mut before, aside, repairs).await {
        Ok(diagnosis) => Finding::Diagnosis(diagnosis),
        Err(BeltError::Align(error)) => Finding::NotAligned(error),
        Err(BeltError::Interrupted(interrupt)) => return Err(interrupt),
    };
    let is_well = matches!(finding, Finding::Diagnosis(Diagnosis::Nothing));
    let is_known = matches!(finding, Finding::Diagnosis(_));
    if is_well {
        // Something may have happened while loads were measured.
        let again = touch_both(main_loop).await?;
        if is_anywhere_aside(main_loop, again) {
            tell_touched(main_loop, again);
            finding = Finding::Diagnosis(Diagnosis::Several);
        } else if main_loop.power.is_on(residuals.motors()) {
            main_loop.homed.believe(&homed);
            main_loop.trimming = before;
        }
    } else if repairs && is_known {
        finding.tell(main_loop);
        home_and_align(main_loop, notices, BELT_AXES, false).await?;
        let proven = apart(pin!(prove(main_loop))).await;
        finding = match proven {
            Ok(aside) => {
                keep_findings(main_loop, false);
                note_belt_loads(main_loop).await?;
                Finding::Repaired(aside)
            }
            Err(BeltError::Align(error)) => Finding::NotRepaired(error),
            Err(BeltError::Interrupted(interrupt)) => return Err(interrupt),
        };
    }
    go_back(main_loop, place).await?;
    lower(main_loop, lift).await?;
    finding.tell(main_loop);
    Ok(Answer::Said)
}

/// Distance in steps of the x and y switches from their expected positions.
#[derive(Clone, Copy)]
struct Aside {
    now: [i32; 2],
    /// When they were homed since the motors were aligned.
    homed: [i32; 2],
    /// Motors have had power since the belt's strain was measured.
    had_power: bool,
}

impl Aside {
    /// The diagnosis of a residual: by the present distances of the switches; or, if x and y were homed after the skip,
    /// by the distances that homing removed.
    fn diagnose(
        self,
        mechanism: &Mechanism,
        residual: &Residual,
        strain: i32,
        full_step: i32,
        shift: Shift,
    ) -> Diagnosis {
        let of = |aside| {
            let touched = Touched { aside, residual: strain };
            let found = diagnose(mechanism, residual, touched, full_step);
            let has_skipped = self.had_power && matches!(shift, Shift::Teeth(_));
            match shift {
                Shift::None => found,
                _ => with_moved_pulley(mechanism, found, touched, full_step, has_skipped),
            }
        };
        let [x, y] = [0, 1].map(|axis| {
            let of = |aside: [i32; 2]| aside.get(axis).copied().unwrap_or_default();
            of(self.now).saturating_add(of(self.homed))
        });
        match (of(self.now), of([x, y])) {
            (Diagnosis::Several, skip @ Diagnosis::Skip { .. }) => skip,
            (now, _) => now,
        }
    }
}

/// The diagnosis from the switches and the residuals together. With `repairs`, motors that have skipped are left
/// without strain; all others are as they were.
async fn examine<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    residuals: &Residuals,
    before: &mut Trimming,
    aside: Aside,
    repairs: bool,
) -> Result<Diagnosis, BeltError> {
    begin_measuring(main_loop, residuals.motors()).await?;
    let result = examine_each(main_loop, residuals, before, aside, repairs).await;
    if !matches!(result, Err(BeltError::Interrupted(_))) {
        end_measuring(main_loop).await?;
    }
    result
}

async fn examine_each<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    residuals: &Residuals,
    before: &mut Trimming,
    aside: Aside,
    repairs: bool,
) -> Result<Diagnosis, BeltError> {
    let full_step = i32::from(main_loop.settings.drivers.belt.microsteps);
    let mut said = Diagnosis::Nothing;
    for (number, residual) in residuals.iter().enumerate() {
        let Some((motor, times)) = trimmed(residual) else { continue };
        let preload = preload_of(residual, main_loop.settings.preload_steps());
        let Some(apex) = apart(pin!(find_apex(main_loop, number, residual))).await? else { continue };
        let strain = -apex.step * times - preload;
        let phase = phase_at_apex(main_loop, residual, apex.beside).await?;
        let known = before.found(number).and_then(|found| found.phase);
        let by = phase.zip(known).map(|(phase, known)| difference(phase.into(), known.into()));
        // Drivers that cannot be asked have made the steps that are counted.
        let by = by.unwrap_or_else(|| difference(-strain * TURN / (4 * full_step.max(1)), 0));
        let shift = shift_of(&main_loop.settings, residual, by);
        let found = aside.diagnose(&main_loop.settings.mechanism, residual, strain, full_step, shift);
        said = found.graver(said);
        if repairs && found != Diagnosis::Nothing {
            leave_at(main_loop, number, residual, apex, known.and(phase)).await?;
        } else {
            trim(main_loop, motor, -apex.step).await?;
            note_measured(main_loop, before, number, strain, &apex);
            if repairs && let Some(found) = before.found(number) {
                main_loop.trimming.note(number, found);
            }
        }
        if shift != Shift::None && !repairs {
            drop_phase(main_loop, number, by, shift);
        } else if matches!(found, Diagnosis::Skip { .. } | Diagnosis::Several | Diagnosis::Alike)
            && !shows_a_tooth(&main_loop.settings, residual)
        {
            main_loop.say(text!(
                "echo:a tooth is whole electrical turns on this machine: jumped teeth cannot be told from skips"
            ));
        }
    }
    Ok(said)
}

/// Nothing has changed, and that is measured: motors are not aligned by phases alone any more.
fn note_measured<P: PortSet, W: Wake>(
    main_loop: &MainLoop<'_, P, W>,
    before: &mut Trimming,
    number: usize,
    strain: i32,
    apex: &ApexFound,
) {
    let parts = i64::from(strain.abs()) * PARTS + apex.within;
    let within = main_loop.settings.belt_length(thousandths(parts));
    before.prove(number, Some(within), apex.readings_per_mm(&main_loop.settings));
}

/// Lifts z if its position is known, and returns the lift.
async fn lift<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>) -> Result<Mm, Interrupt> {
    main_loop.finish().await?;
    let [.., z] = main_loop.homed.axes();
    let position = main_loop.motion.end_mm();
    let [_, _, at, _] = position;
    let lift = LIFT.min(z_reach(main_loop).most.saturating_sub(at)).max(Mm::ZERO);
    if !z {
        return Ok(Mm::ZERO);
    }
    shift_z(main_loop, lift, main_loop.settings.axes.z.max_speed, EndstopSet::NONE).await?;
    Ok(lift)
}

/// Undoes [`lift`].
async fn lower<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, lift: Mm) -> Result<(), Interrupt> {
    shift_z(main_loop, -lift, main_loop.settings.axes.z.max_speed, EndstopSet::NONE).await
}

/// Moves the tool back to its earlier place, if the position is known: a paused print continues from there.
async fn go_back<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, place: [Mm; 4]) -> Result<(), Interrupt> {
    let ([x, y, ..], [is_x, is_y, _]) = (place, main_loop.homed.axes());
    if !(is_x && is_y) {
        return Ok(());
    }
    let [.., z, e] = main_loop.motion.end_mm();
    go_to(main_loop, [x, y, z, e], main_loop.settings.axes.x.max_speed, EndstopSet::NONE).await
}
