//! Proof that the tool is where the steps say, and that no motor strains the belt. No driver reports a skip, so this
//! test searches for it.
//!
//! Loads first, then the switches. A motor that skipped before loads are measured strains the belt. A motor that skips
//! later has displaced the tool when the switches are met.

use super::switch::touch;
use crate::kinematics::Residuals;
use crate::machine::belt::align::{BeltError, measure_again};
use crate::machine::belt::align_error::AlignError;
use crate::machine::belt::diagnosis::ways_aside;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::numbers::Thousandths;
use crate::machine::ports::PortSet;
use crate::port::Wake;
use crate::settings::HomedAxis;

/// Proves that motors which were just aligned are so, and x and y just homed where the steps say. Only then do they
/// count as aligned; until the proof succeeds, alignment and position count as unknown. Returns the distance in steps
/// of the switches from their expected positions.
pub(in crate::machine) async fn prove<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<[i32; 2], BeltError> {
    let homed = main_loop.homed;
    let (residuals, mechanism) = (main_loop.settings.residuals(), main_loop.motion.groups().mechanism());
    main_loop.homed.release(residuals.motors(), mechanism);
    let result = look_again(main_loop, &residuals).await;
    if result.is_ok() {
        main_loop.homed.believe(&homed);
        main_loop.trimming.align();
    } else {
        main_loop.trimming.forget();
    }
    result
}

async fn look_again<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    residuals: &Residuals,
) -> Result<[i32; 2], BeltError> {
    measure_again(main_loop, residuals).await?;
    let aside = touch_both(main_loop).await?;
    if is_anywhere_aside(main_loop, aside) {
        tell_touched(main_loop, aside);
        return Err(AlignError::Changed.into());
    }
    if main_loop.power.is_on(residuals.motors()) { Ok(aside) } else { Err(AlignError::Changed.into()) }
}

/// Meets the switches of x and y, and backs off. Returns their distance in steps from the expected positions.
pub(in crate::machine) async fn touch_both<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<[i32; 2], Interrupt> {
    Ok([touch(main_loop, HomedAxis::X).await?, touch(main_loop, HomedAxis::Y).await?])
}

/// Tells the distance of the switches in steps from their expected positions.
pub(in crate::machine) fn tell_touched<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, aside: [i32; 2]) {
    let [x, y] = lengths(main_loop, aside);
    main_loop.say(text!("echo:the tool is off its position by X{x} Y{y} mm"));
}

/// Steps of x and y in mm.
pub(in crate::machine) fn lengths<P: PortSet, W: Wake>(
    main_loop: &MainLoop<'_, P, W>,
    steps: [i32; 2],
) -> [Thousandths; 2] {
    let per_mm = main_loop.settings.axes.x.steps_per_mm;
    steps.map(|steps| Thousandths(per_mm.length_of(steps.into())))
}

/// Whether a tool that is this many steps off is outside its tolerance.
pub(in crate::machine) fn is_anywhere_aside<P: PortSet, W: Wake>(
    main_loop: &MainLoop<'_, P, W>,
    aside: [i32; 2],
) -> bool {
    let full_step = i32::from(main_loop.settings.drivers.belt.microsteps);
    ways_aside(&main_loop.settings.mechanism, aside, full_step) != [0, 0]
}
