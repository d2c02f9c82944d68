//! Touches: the height of the bed at a place.
//!
//! The first approach is fast and only finds the bed. The touches that count are slow, and the height is their mean.
//! The time from contact to the last step is the same for all of them, so the offset has it in. A fast touch in the
//! mean, as in Marlin's (3 slow + 2 fast) / 5, would add a share of a longer way.
//!
//! The bed is known from the moment when z was homed, or found, until a motor of z loses its power; touches that failed
//! do not change that ([`expected`]). It bounds every touch from above and below.
//!
//! Every function that another room calls ends a touch that failed: the probe is taken in, and the job ends.

use super::approach::{approach, raise_by, travel, up_to};
use super::deploy::{goes_in_by_itself, is_triggered, put_out, take_in, take_in_at_once};
use super::error::failed;
use super::reach::nozzle_for;
use crate::machine::apart::apart;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::offsets::z_reach;
use crate::machine::main_loop::surface::leave_surface;
use crate::machine::ports::PortSet;
use crate::machine::state::job::{JobEnd, ProbeFailure};
use crate::port::Wake;
use crate::settings::{HomedAxis, Probe};
use crate::units::{Mm, MmPerSec, Seconds};
use core::pin::pin;

/// A touch this far above the bed is none: something else has met the probe (Marlin's `Z_PROBE_ERROR_TOLERANCE`,
/// Configuration_adv.h 2.1).
const TOO_EARLY: Mm = Mm::const_from_int(3);

/// A touch is given up so far below the place where it should have been (Marlin's `Z_PROBE_LOW_POINT`, Configuration.h
/// 2.1).
const LOW: Mm = Mm::const_from_int(2);

/// And so much farther if the place of z is not known (Marlin, probe.cpp).
const BEYOND: Mm = Mm::const_from_int(10);

/// What becomes of the probe after a touch.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum AfterTouch {
    /// It stays out, as another touch follows.
    Out,
    /// It is taken in.
    In,
}

/// Work of the probe.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Work {
    /// The height by a fast touch and those that count.
    Measure,
    /// A fast touch alone.
    Find,
    /// One slow touch where the bed was found.
    TouchAgain,
    /// The height where z is to be homed.
    FindZero,
    /// Putting the probe out, or taking it in, above a bed that is known.
    Set,
}

/// The height of the bed below the probe, which goes `at` a place first if there is one. All axes are homed. If it
/// fails, the tool is raised, the probe taken in, and the job ends.
pub(in crate::machine) fn touch_bed<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    at: Option<[Mm; 2]>,
    end: AfterTouch,
) -> impl Future<Output = Result<Mm, Interrupt>> {
    conclude(main_loop, Work::Measure, at, end)
}

/// Finds the bed at a place by the fast touch alone; the probe stays out.
pub(in crate::machine) fn find_bed<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    at: Option<[Mm; 2]>,
) -> impl Future<Output = Result<Mm, Interrupt>> {
    conclude(main_loop, Work::Find, at, AfterTouch::Out)
}

/// The height by one slow touch where the bed was found; the probe stays out.
pub(in crate::machine) fn touch_again<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> impl Future<Output = Result<Mm, Interrupt>> {
    conclude(main_loop, Work::TouchAgain, None, AfterTouch::Out)
}

/// Puts the probe out by itself (M401), or takes it in (M402). The result says nothing.
pub(in crate::machine) fn set_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    end: AfterTouch,
) -> impl Future<Output = Result<Mm, Interrupt>> {
    conclude(main_loop, Work::Set, None, end)
}

/// Finds the bed where z is to be homed, and returns z of the nozzle as it is then. X and y are homed; z is not, so
/// the tool may go down by all of z unless the place of the bed is known.
pub(in crate::machine) async fn find_zero<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<Mm, Interrupt> {
    let home = main_loop.settings.probe_home();
    let height = conclude(main_loop, Work::FindZero, Some(home), AfterTouch::In).await?;
    let [.., z, _] = main_loop.motion.end_mm();
    Ok(z.saturating_sub(height))
}

/// Ends a touch that something has interrupted: motion rests. The tool rises from the bed, not above the place where
/// the touch began, and the probe is to go in. A second interrupt ends the rise.
pub(in crate::machine) async fn end_touch<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<(), Interrupt> {
    let mut risen = Ok(());
    if let Some(from) = main_loop.probing.take_touch() {
        let [.., at, _] = main_loop.motion.end_mm();
        let clearance = main_loop.settings.probe.clearance;
        risen = raise_by(main_loop, from.saturating_sub(at).min(clearance)).await;
        main_loop.commanded.stand_at(main_loop.motion.end_mm());
    }
    take_in_at_once(main_loop);
    match risen {
        // Without power nothing rises, and the reason was told.
        Err(Interrupt::NoPower | Interrupt::EndJob) => Ok(()),
        risen => risen,
    }
}

/// Does such work and ends it, with its result or for a reason. An interrupt leaves the tool and the probe to
/// [`end_touch`].
async fn conclude<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    work: Work,
    at: Option<[Mm; 2]>,
    end: AfterTouch,
) -> Result<Mm, Interrupt> {
    let mut result = apart(pin!(carry_out(main_loop, work, at, end))).await;
    if result.is_err() && !main_loop.probing.has_failed() {
        return result;
    }
    main_loop.probing.take_touch();
    let is_over = end == AfterTouch::In || result.is_err();
    main_loop.probing.note_series(!is_over);
    if is_over && let Err(interrupt) = take_in(main_loop).await {
        result = result.and(Err(interrupt));
    }
    main_loop.commanded.stand_at(main_loop.motion.end_mm());
    if let Some(why) = main_loop.probing.take_failure() {
        give_up(main_loop, why);
    }
    result
}

/// A nozzle that has gone to the floor may have pressed the bed: z may have skipped steps.
fn give_up<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, why: ProbeFailure) {
    use ProbeFailure::{NotFound, NotMet, NotWhereItWas};
    if let NotMet { .. } | NotWhereItWas { .. } | NotFound { .. } = why {
        let mechanism = main_loop.motion.groups().mechanism();
        let z = HomedAxis::Z as usize;
        main_loop.homed.fail(z, mechanism.motors_of(z), mechanism);
    }
    main_loop.job.note_end(JobEnd::ProbeFailed { why });
}

/// Height of the nozzle (z) at which the probe is to trigger, as far as the place of the bed is known.
fn expected<P: PortSet, W: Wake>(main_loop: &MainLoop<'_, P, W>) -> Option<Mm> {
    let found = main_loop.homed.found_bed().map(|z| {
        let [.., z, _] = main_loop.motion.to_mm([z; 4]);
        z
    });
    let [.., is_homed] = main_loop.homed.axes();
    found.or_else(|| is_homed.then(|| main_loop.first_layer.probe(&main_loop.settings).trigger_height()))
}

/// The height of the bed by a touch with the nozzle at this z.
fn height_of(probe: &Probe, z: Mm) -> Mm {
    z.saturating_add(probe.offset.z)
}

/// Height of the nozzle (z) at which it clears the bed by so much, and so does the probe. `None` if the bed may be
/// anywhere.
pub(in crate::machine) fn clear_of_bed<P: PortSet, W: Wake>(
    main_loop: &MainLoop<'_, P, W>,
    clearance: Mm,
) -> Option<Mm> {
    let probe = &main_loop.first_layer.probe(&main_loop.settings);
    expected(main_loop).map(|z| height_of(probe, z).saturating_add(probe.nozzle_at(clearance)))
}

/// Raises the tool, takes the probe over a place where it can touch, and touches the bed. The tool ends above it.
async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    work: Work,
    at: Option<[Mm; 2]>,
    end: AfterTouch,
) -> Result<Mm, Interrupt> {
    let is_from_afar = matches!(work, Work::Measure | Work::Find);
    if is_from_afar {
        main_loop.finish().await?;
        leave_surface(main_loop).await?;
    }
    let mut probe = if work == Work::FindZero {
        main_loop.settings.probe_in_program()
    } else {
        main_loop.first_layer.probe(&main_loop.settings)
    };
    let [.., is_homed] = main_loop.homed.axes();
    if is_from_afar || work == Work::Set && is_homed {
        let is_in_series = is_from_afar && main_loop.probing.is_in_series();
        let clearance = if is_in_series { probe.clearance } else { probe.deploy_clearance };
        let by = clear_of_bed(main_loop, clearance).map_or(Mm::ZERO, |z| up_to(main_loop, z));
        raise_by(main_loop, by).await?;
    }
    if let Some(at) = at {
        let Ok(nozzle) = nozzle_for(&main_loop.settings, at) else {
            return Err(failed(main_loop, ProbeFailure::OutOfReach { at }));
        };
        travel(main_loop, nozzle).await?;
    }
    match work {
        Work::Set if end == AfterTouch::Out => put_out(main_loop).await?,
        Work::Set => {}
        Work::Measure | Work::Find | Work::FindZero => {
            let height = find(main_loop, &probe).await?;
            if work == Work::Find {
                return Ok(height);
            }
        }
        Work::TouchAgain => probe.samples = 1,
    }
    if work == Work::Set { Ok(Mm::ZERO) } else { mean_of_touches(main_loop, &probe).await }
}

/// Touches the bed fast below the tool. A touch far above a bed that is known is tried again.
async fn find<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, probe: &Probe) -> Result<Mm, Interrupt> {
    let bed = expected(main_loop);
    let mut is_again = false;
    loop {
        let z = touch_once(main_loop, probe, probe.fast).await?;
        let Some(expected) = bed else {
            let [.., steps, _] = main_loop.motion.to_steps([z; 4]);
            main_loop.homed.note_bed(Some(steps));
            return Ok(height_of(probe, z));
        };
        if z <= expected.saturating_add(TOO_EARLY) {
            return Ok(height_of(probe, z));
        }
        if is_again {
            return Err(failed(main_loop, ProbeFailure::Early { height: z.saturating_sub(expected), expected }));
        }
        is_again = true;
    }
}

/// The mean of the touches that count.
async fn mean_of_touches<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    probe: &Probe,
) -> Result<Mm, Interrupt> {
    let mut tries = 0;
    loop {
        let (mut sum, mut least, mut most) = (Mm::ZERO, Mm::MAX, Mm::MIN);
        for _ in 0..probe.samples {
            let height = height_of(probe, touch_once(main_loop, probe, probe.slow).await?);
            (sum, least, most) = (sum.saturating_add(height), least.min(height), most.max(height));
        }
        let spread = most.saturating_sub(least);
        if spread <= probe.tolerance {
            return Ok(sum / i64::from(probe.samples.max(1)));
        }
        if tries == probe.retries {
            return Err(failed(main_loop, ProbeFailure::Spread { spread, tolerance: probe.tolerance }));
        }
        tries += 1;
    }
}

/// Touches the bed once, and raises the tool. Returns z of the nozzle at the touch. It goes hardly below a bed that is
/// known; else, by all of z and a little more.
async fn touch_once<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    probe: &Probe,
    speed: MmPerSec,
) -> Result<Mm, Interrupt> {
    put_out(main_loop).await?;
    let [.., from, _] = main_loop.motion.end_mm();
    let bed = expected(main_loop);
    main_loop.probing.begin_touch(from, bed);
    let rest_ms = (u64::from(probe.quiet.to_bits()) * 1000) >> Seconds::FRAC_NBITS;
    main_loop.settle(main_loop.now().after_ms(rest_ms as u32)).await?;
    if is_triggered(main_loop).await? {
        return Err(failed(main_loop, ProbeFailure::Triggered));
    }
    let reach = main_loop.settings.reach(HomedAxis::Z);
    let axis = reach.most.saturating_sub(reach.least);
    let (way, unmet) = match bed {
        Some(expected) => {
            let floor = expected.saturating_sub(LOW);
            let unmet = match main_loop.homed.axes() {
                [.., true] => ProbeFailure::NotMet { floor, expected },
                _ => ProbeFailure::NotWhereItWas { floor, expected },
            };
            (from.saturating_sub(floor).max(Mm::ZERO), unmet)
        }
        None => {
            let way = axis.saturating_add(LOW).saturating_add(BEYOND);
            (way, ProbeFailure::NotFound { way })
        }
    };
    let has_met = approach(main_loop, way, speed).await?;
    let [.., to, _] = main_loop.motion.end_mm();
    // Where the axis is short its end is nearer.
    let top = height_of(probe, bed.unwrap_or(to)).saturating_add(z_reach(main_loop).most);
    raise_by(main_loop, probe.clearance.min(top.saturating_sub(to))).await?;
    main_loop.probing.take_touch();
    if !has_met {
        return Err(failed(main_loop, unmet));
    }
    if goes_in_by_itself(main_loop) {
        take_in(main_loop).await?;
    }
    Ok(to)
}
