//! What hosts read of the belt: how an alignment ended, and the belt's part of M122. That is alignment, lost steps
//! between drivers and counts, and the path since the switches of x and y were met.

use super::align_error::AlignError;
use crate::kinematics::Residuals;
use crate::machine::answers::reply_writer::ReplyWriter;
use crate::machine::answers::words::Facts;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::phase::strain;
use crate::machine::numbers::Thousandths;
use crate::machine::ports::PortSet;
use crate::machine::reports::residual_sum::ResidualSum;
use crate::machine::state::trimming::Found;
use crate::port::Wake;

/// The belt's part of M122; nothing on a machine without motors that can pull against each other.
pub(in crate::machine) async fn report_belt<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<(), Interrupt> {
    let residuals = main_loop.settings.residuals();
    if residuals.is_empty() {
        return Ok(());
    }
    main_loop.tell(report_state);
    // Drivers are read only at rest: in motion their positions would change between the replies.
    if main_loop.trimming.is_aligned() && !main_loop.motion.has_motion() && main_loop.power.is_on(residuals.motors()) {
        for (number, residual) in residuals.iter().enumerate() {
            // Against the phase of this alignment: settings may have got another one.
            let phase = main_loop.trimming.found(number).and_then(|found| found.phase);
            let Some(phase) = phase else { continue };
            if let Some(strain) = strain(main_loop, phase.into(), residual).await? {
                match strain {
                    // M915 R leaves a motor where loads say, which may be a step or two from the phase that M915 found
                    // before.
                    -2..=2 => main_loop.say(text!("Belt: drivers have made the steps that are counted")),
                    steps => main_loop.say(text!(
                        "Belt: drivers stand {steps} steps apart: steps were lost on their lines (M915 aligns)"
                    )),
                }
            }
        }
    }
    match main_loop.homed.since_met(main_loop.motion.path()) {
        [Some(x), Some(y)] => {
            main_loop.say(text!("Belt: x met its switch {x} mm of path ago, y {y} (M915 D meets them again)"));
        }
        _ => main_loop.say(text!("Belt: x and y have not met their switches (G28)")),
    }
    Ok(())
}

/// Whether motors are aligned, and the last results.
fn report_state(to: &mut ReplyWriter<'_>, Facts { settings: s, trimming, .. }: &Facts<'_>) {
    let state = match trimming.is_aligned() {
        false => packed!("not aligned since motors got power (M915)"),
        true if trimming.is_by_phases() => {
            packed!("aligned by stored phases alone: no load was measured (M915 D measures)")
        }
        true => packed!("aligned"),
    };
    to.say(text!("Belt: motors {state}"));
    for (number, residual) in Residuals::new(&s.mechanism, s.belt.is_closed).iter().enumerate() {
        let Some(Found { was, within, readings_per_mm, .. }) = trimming.found(number) else { continue };
        let (sum, was, within) = (ResidualSum(residual, s), Thousandths(was), Thousandths(within));
        match readings_per_mm {
            None => to.say(text!("Belt: {sum} was {was} mm from its stored phase")),
            Some(readings) => {
                to.say(text!("Belt: {sum} was {was} mm, then measured within {within} mm"));
                to.say(text!("Belt: {sum}: a mm of strain takes {readings} of SG_RESULT"));
            }
        }
    }
}

/// Says that motors are aligned, and the finding for each residual.
pub(in crate::machine) fn tell_aligned<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>) {
    main_loop.tell(|to, Facts { settings: s, trimming, .. }| {
        for (number, residual) in Residuals::new(&s.mechanism, s.belt.is_closed).iter().enumerate() {
            let Some(Found { was, within, .. }) = trimming.found(number) else { continue };
            let (sum, was, within) = (ResidualSum(residual, s), Thousandths(was), Thousandths(within));
            to.say(text!("echo:belt motors aligned: {sum} was {was} mm, is correct now within {within} mm"));
        }
        if trimming.has_new_phase() {
            to.say(text!(
                "echo:stored settings lack the new phase of the belt: M500 stores it, and motors align when they get \
                power"
            ));
        }
    });
}

/// Says why they could not be aligned.
pub(in crate::machine) fn tell_not_aligned<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, why: AlignError) {
    main_loop.say(text!("echo:belt motors not aligned: {why}"));
}
