//! A touch: the height of the bed at a place.
//!
//! The first approach is fast and only finds the bed. The touches that count are slow, and the height is their mean. The
//! time from contact to the last step is the same for all of them, so the offset has it in; a fast touch in the mean, as
//! in Marlin's (3 slow + 2 fast) / 5, would add a share of a longer way.

use super::approach::{approach, is_triggered, raise_by, raise_to, travel};
use super::deploy::{put_out, take_in};
use super::error::ProbeError;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::state::job::{JobEnd, ProbeFailure};
use crate::port::Pend;
use crate::settings::Probe;
use crate::units::{Mm, MmPerSec, Seconds};

/// A touch this far above the bed is none: something else has met the probe (Marlin's `Z_PROBE_ERROR_TOLERANCE`,
/// Configuration_adv.h 2.1).
const TOO_EARLY: Mm = Mm::const_from_int(3);

/// A touch is given up so far below the place where it should have been (Marlin's `Z_PROBE_LOW_POINT`, Configuration.h
/// 2.1).
const LOW: Mm = Mm::const_from_int(2);

/// What becomes of the probe after a touch.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum AfterTouch {
    /// It stays out.
    Out,
    /// It is taken in.
    In,
}

/// The height of the bed below the probe, which goes `at` a place first if there is one. All axes are homed, and the
/// place is within [`reach`](super::reach::reach). If it fails, the tool is raised, the probe taken in, and the job ends.
pub(in crate::machine) async fn touch_bed<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    at: Option<[Mm; 2]>,
    end: AfterTouch,
) -> Result<Mm, Interrupt> {
    main_loop.finish().await?;
    let height = height_at(main_loop, at).await;
    let end = if height.is_err() { AfterTouch::In } else { end };
    let ended = leave(main_loop, height.err(), end).await;
    main_loop.commanded.stand_at(main_loop.motion.end_mm());
    match height.and_then(|height| ended.map(|()| height)) {
        Ok(height) => Ok(height),
        Err(ProbeError::Interrupted(interrupt)) => Err(interrupt),
        Err(ProbeError::Failed(why)) => {
            give_up(main_loop, why);
            Err(Interrupt::EndJob)
        }
    }
}

/// A nozzle that has gone to the floor may have pressed the bed: z may have skipped steps.
fn give_up<P: PortSet, W: Pend>(main_loop: &mut MainLoop<'_, P, W>, why: ProbeFailure) {
    if let ProbeFailure::NotMet { .. } = why {
        let mechanism = main_loop.motion.groups().mechanism();
        main_loop.homed.fail(2, mechanism.motors_of(2), mechanism);
    }
    main_loop.job.note_end(JobEnd::ProbeFailed { why });
}

/// Takes the probe in if it is to be. An emergency has taken over already.
async fn leave<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    error: Option<ProbeError>,
    end: AfterTouch,
) -> Result<(), ProbeError> {
    match (error, end) {
        (Some(ProbeError::Interrupted(interrupt)), _) => Err(interrupt.into()),
        (_, AfterTouch::Out) => Ok(()),
        (_, AfterTouch::In) => take_in(main_loop).await,
    }
}

/// The height at a place, found with the probe out. The tool ends above the bed.
async fn height_at<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    at: Option<[Mm; 2]>,
) -> Result<Mm, ProbeError> {
    let probe = main_loop.settings.probe;
    let clearance = if main_loop.probing.is_out() { probe.clearance } else { probe.deploy_clearance };
    raise_to(main_loop, probe.nozzle_at(clearance)).await?;
    put_out(main_loop).await?;
    if let Some([x, y]) = at {
        travel(main_loop, [x.saturating_sub(probe.offset.x), y.saturating_sub(probe.offset.y)]).await?;
    }
    let floor = probe.trigger_height().saturating_sub(LOW);
    let mut height = touch_once(main_loop, &probe, floor, probe.fast).await?;
    if height > TOO_EARLY {
        height = touch_once(main_loop, &probe, floor, probe.fast).await?;
    }
    if height > TOO_EARLY {
        return Err(ProbeFailure::Early { height, expected: probe.trigger_height() }.into());
    }
    mean_of_touches(main_loop, &probe, floor).await
}

/// The mean of the touches that count.
async fn mean_of_touches<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    probe: &Probe,
    floor: Mm,
) -> Result<Mm, ProbeError> {
    let mut tries = 0;
    loop {
        let (mut sum, mut least, mut most) = (Mm::ZERO, Mm::MAX, Mm::MIN);
        for _ in 0..probe.samples {
            let height = touch_once(main_loop, probe, floor, probe.slow).await?;
            (sum, least, most) = (sum.saturating_add(height), least.min(height), most.max(height));
        }
        let spread = most.saturating_sub(least);
        if spread <= probe.tolerance {
            return Ok(sum / i64::from(probe.samples.max(1)));
        }
        if tries == probe.retries {
            return Err(ProbeFailure::Spread { spread, tolerance: probe.tolerance }.into());
        }
        tries += 1;
    }
}

/// Touches the bed once, and raises the tool. The nozzle goes down to `floor` at most.
async fn touch_once<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    probe: &Probe,
    floor: Mm,
    speed: MmPerSec,
) -> Result<Mm, ProbeError> {
    let rest_ms = (u64::from(probe.quiet.to_bits()) * 1000) >> Seconds::FRAC_NBITS;
    main_loop.settle(main_loop.now().after_ms(rest_ms as u32)).await?;
    if is_triggered(main_loop).await? {
        return Err(ProbeFailure::Triggered.into());
    }
    let [.., from, _] = main_loop.motion.end_mm();
    let has_met = approach(main_loop, from.saturating_sub(floor), speed).await?;
    let [.., to, _] = main_loop.motion.end_mm();
    if has_met && to == from {
        return Err(ProbeFailure::Triggered.into());
    }
    raise_by(main_loop, probe.clearance).await?;
    if has_met {
        Ok(to.saturating_add(probe.offset.z))
    } else {
        Err(ProbeFailure::NotMet { floor, expected: probe.trigger_height() }.into())
    }
}
