//! Homing: each axis finds its endstop fast, backs off, and finds it again slowly ([`switch`](super::switch)).
//!
//! The endstops are switches at one end of their axes ([`Endstop`]), and stay pressed beyond the place where they are
//! met. The rig presses them in the same way (`sim/rig/src/lib.rs`). The position of that place is a setting; so is the
//! order of the axes.
//!
//! If the settings say so, the Z probe homes z ([`find_zero`]), or its switch at a place
//! ([`SafeZHome`](crate::settings::SafeZHome)). That comes after x and y, and only where both are homed: elsewhere the
//! bed or the switch may not be below. docs/explanation/probing.md has the rules.
//!
//! A probe that is low when it triggers reads as not triggered if its wire is cut: the floor alone ends its descent.

use super::proof::prove;
use super::shift_z::{go_to, shift_z};
use super::switch::{home_named, stand_at, switch_of};
use crate::gcode::AxisFlags;
use crate::machine::apart::apart;
use crate::machine::belt::align::{BeltError, align, lacks_alignment};
use crate::machine::belt::circulate::advance_belt;
use crate::machine::belt::report::{tell_aligned, tell_not_aligned};
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::offsets::{name_home, z_reach};
use crate::machine::main_loop::phase::keep_findings;
use crate::machine::main_loop::surface::leave_surface;
use crate::machine::ports::PortSet;
use crate::machine::probe::touch::{clear_of_bed, find_zero};
use crate::machine::setup::stored::note_belt_loads;
use crate::machine::state::job::{HomingFailure, JobEnd};
use crate::machine::state::notices::{Notice, Notices};
use crate::machine::travel::retraction::forget_retraction;
use crate::port::{EndstopSet, Wake};
use crate::settings::{Alignment, AxisEnd, HomedAxis};
use crate::units::Mm;
use core::pin::pin;

/// What is to be homed.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::machine) struct HomeWords {
    /// The axes, all if none is named.
    pub axes: AxisFlags,
    /// Axes that are homed stay where they are.
    pub only_lost: bool,
}

/// The axes that a line means: all if it names none.
const fn meant(AxisFlags { x, y, z, .. }: AxisFlags) -> [bool; 3] {
    if x || y || z { [x, y, z] } else { [true; 3] }
}

/// G28. If any axis fails, the job ends. Z rises by `raise` first, as far as it can: the nozzle may stand on a print.
/// Without that word it rises as the settings say, and for the probe in any case.
pub(in crate::machine) async fn home<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    notices: &mut Notices,
    words: HomeWords,
    raise: Option<Mm>,
) -> Result<(), Interrupt> {
    let mut wanted = meant(words.axes);
    if words.only_lost {
        for (wanted, is_homed) in wanted.iter_mut().zip(main_loop.homed.axes()) {
            *wanted &= !is_homed;
        }
        if wanted == [false; 3] {
            main_loop.job.forgive();
            return Ok(());
        }
    }
    refuse_in_vain(main_loop, wanted)?;
    main_loop.job.forgive();
    power_up(main_loop).await?;
    let raise = raise.unwrap_or_else(|| usual_raise(main_loop, wanted));
    raise_z(main_loop, raise).await?;
    // As motors got power they may have been aligned by their phases.
    let aligns = main_loop.settings.belt.alignment == Alignment::Automatic && lacks_alignment(main_loop);
    apart(pin!(home_axes(main_loop, notices, wanted, aligns))).await
}

/// Refuses axes that cannot be homed, before anything moves. Z is homed at a place only if X and Y are known then.
fn refuse_in_vain<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, wanted: [bool; 3]) -> Result<(), Interrupt> {
    let by_probe = main_loop.settings.homes_z_by_probe();
    for axis in HomedAxis::ALL {
        if !wanted[axis as usize] {
            continue;
        }
        let is_probed = by_probe && axis == HomedAxis::Z;
        let input = if is_probed { EndstopSet::PROBE } else { switch_of(axis) };
        let (s, at) = (&*main_loop.settings, main_loop.settings.probe_home());
        let is_placed = axis == HomedAxis::Z && (by_probe || s.homes_z_at_place());
        let [x, y, _] = wanted;
        let lacks_others = is_placed && main_loop.homed.lacks_one_of([!x, !y, false]);
        let unreached = s.unreached_z_home().filter(|_| is_placed);
        let why = match main_loop.status.inputs().has(input) {
            false => HomingFailure::NotConnected,
            true if lacks_others => HomingFailure::NeedsOthers,
            true if is_probed && !s.can_touch(at) => HomingFailure::OutOfReach { at },
            true => match unreached {
                Some(at) => HomingFailure::NozzleOutOfReach { at },
                None => continue,
            },
        };
        main_loop.homed.note_sought(axis as usize);
        main_loop.job.note_end(JobEnd::NotHomed { axis, why });
        return Err(Interrupt::EndJob);
    }
    Ok(())
}

/// How far z rises if no word says it: the hop of the settings, and the probe must clear the bed on its way.
fn usual_raise<P: PortSet, W: Wake>(main_loop: &MainLoop<'_, P, W>, [.., is_meant]: [bool; 3]) -> Mm {
    let probe = main_loop.first_layer.probe(&main_loop.settings);
    let hop = hop(main_loop);
    if !(is_meant && main_loop.settings.homes_z_by_probe()) {
        return hop;
    }
    let [.., z, _] = main_loop.motion.end_mm();
    let clear = clear_of_bed(main_loop, probe.deploy_clearance);
    clear.map_or(probe.deploy_clearance, |clear| clear.saturating_sub(z)).max(hop)
}

/// How far z is below the height of the hop; all of it if the place of z is not known.
fn hop<P: PortSet, W: Wake>(main_loop: &MainLoop<'_, P, W>) -> Mm {
    let hop = main_loop.settings.safe_z_home.z_hop;
    let ([.., is_known], [_, _, at, _]) = (main_loop.homed.axes(), main_loop.motion.end_mm());
    if is_known && hop > Mm::ZERO { hop.saturating_sub(at) } else { hop }
}

/// Raises z, as far as it can. If its place is not known, a switch at its upper end stops it.
async fn raise_z<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, raise: Mm) -> Result<(), Interrupt> {
    let s = &*main_loop.settings;
    let ([.., is_known], [_, _, at, _]) = (main_loop.homed.axes(), main_loop.motion.end_mm());
    let reach = z_reach(main_loop);
    let room = if is_known { reach.most.saturating_sub(at) } else { reach.most.saturating_sub(reach.least) };
    let is_above = s.endstops.of(HomedAxis::Z).end == AxisEnd::Max;
    let watch = if is_above && !is_known { EndstopSet::Z } else { EndstopSet::NONE };
    let home = &s.safe_z_home;
    let speed = if home.z_hop > Mm::ZERO { home.z_hop_speed } else { s.axes.z.max_speed };
    shift_z(main_loop, raise.min(room).max(Mm::ZERO), speed, watch).await
}

/// Homes these axes; with `aligns` the motors of a belt are aligned as soon as x and y are home, which are homed
/// again then.
pub(in crate::machine) async fn home_and_align<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    notices: &mut Notices,
    wanted: [bool; 3],
    aligns: bool,
) -> Result<(), Interrupt> {
    power_up(main_loop).await?;
    apart(pin!(home_axes(main_loop, notices, wanted, aligns))).await
}

/// Power first: without it, nothing is homed and the axes stay homed.
async fn power_up<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>) -> Result<(), Interrupt> {
    main_loop.finish().await?;
    // Switches and the probe are met at real places.
    leave_surface(main_loop).await?;
    main_loop.power_up(main_loop.motion.groups().fitted()).await?;
    forget_retraction(main_loop);
    Ok(())
}

async fn home_axes<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    notices: &mut Notices,
    wanted: [bool; 3],
    aligns: bool,
) -> Result<(), Interrupt> {
    let [is_x, is_y, is_z] = wanted;
    let mut aligns = aligns && is_x && is_y;
    let mut left = [is_x, is_y, false];
    let is_placed = main_loop.settings.homes_z_by_probe() || main_loop.settings.homes_z_at_place();
    for axis in main_loop.settings.homing_order {
        if !wanted[axis as usize] || is_placed && axis == HomedAxis::Z {
            continue;
        }
        home_named(main_loop, axis).await?;
        left[axis as usize] = false;
        if left == [false; 3] && core::mem::take(&mut aligns) {
            apart(pin!(align_at_home(main_loop))).await?;
        }
    }
    if is_x && is_y {
        advance_belt(main_loop).await?;
    }
    if is_z {
        // The probe needs its place over the bed, and the switch its own, so z is the last.
        if is_placed {
            home_z_at_place(main_loop).await?;
        }
        // Without a place too.
        raise_z(main_loop, hop(main_loop)).await?;
    }
    notices.renew(Notice::Edge);
    Ok(())
}

/// Z is homed at its place, by the probe or by its switch. It does not go down where neither may be.
async fn home_z_at_place<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>) -> Result<(), Interrupt> {
    if main_loop.homed.lacks_one_of([true, true, false]) {
        main_loop.job.note_end(JobEnd::NotHomed { axis: HomedAxis::Z, why: HomingFailure::NeedsOthers });
        return Err(Interrupt::EndJob);
    }
    let (home, [x, y, ..]) = (main_loop.settings.safe_z_home, main_loop.motion.end_mm());
    if main_loop.settings.homes_z_by_probe() {
        home_z_by_probe(main_loop).await?;
    } else {
        go_over(main_loop, home.place_from([x, y])).await?;
        home_named(main_loop, HomedAxis::Z).await?;
    }
    raise_z(main_loop, hop(main_loop)).await?;
    if home.move_to_previous { go_over(main_loop, [x, y]).await } else { Ok(()) }
}

/// Takes the nozzle over a place of z's homing. A switch may be beyond the end of its axis, and an axis stands there.
async fn go_over<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, [x, y]: [Mm; 2]) -> Result<(), Interrupt> {
    let [x, y] = [(HomedAxis::X, x), (HomedAxis::Y, y)].map(|(axis, at)| main_loop.settings.reach(axis).clamp(at));
    let ([.., z, e], speed) = (main_loop.motion.end_mm(), main_loop.settings.safe_z_home.speed);
    go_to(main_loop, [x, y, z, e], speed, EndstopSet::NONE).await
}

async fn home_z_by_probe<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>) -> Result<(), Interrupt> {
    let z = HomedAxis::Z as usize;
    main_loop.homed.begin(z);
    let place = find_zero(main_loop).await;
    if !matches!(place, Err(interrupt) if interrupt != Interrupt::EndJob) {
        main_loop.homed.stop();
    }
    stand_at(main_loop, z, place?).await?;
    main_loop.homed.arrive(z);
    name_home(main_loop, z);
    let trigger = main_loop.first_layer.probe(&main_loop.settings).trigger_height();
    let [.., trigger, _] = main_loop.motion.to_steps([trigger; 4]);
    main_loop.homed.note_bed(Some(trigger));
    Ok(())
}

/// X and y are home: the motors of their belt are aligned, both homed again, and that is proved. The result is
/// reported.
async fn align_at_home<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>) -> Result<(), Interrupt> {
    let aligned = align(main_loop).await;
    if let Err(BeltError::Interrupted(interrupt)) = aligned {
        return Err(interrupt);
    }
    home_both(main_loop).await?;
    let proved = match aligned {
        Ok(()) => apart(pin!(prove(main_loop))).await.map(|_| ()),
        error => error,
    };
    match proved {
        Ok(()) => {
            keep_findings(main_loop, true);
            note_belt_loads(main_loop).await?;
            tell_aligned(main_loop);
            Ok(())
        }
        Err(BeltError::Interrupted(interrupt)) => Err(interrupt),
        Err(BeltError::Align(error)) => {
            if !matches!(main_loop.homed.axes(), [true, true, _]) {
                home_both(main_loop).await?;
            }
            tell_not_aligned(main_loop, error);
            Ok(())
        }
    }
}

async fn home_both<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>) -> Result<(), Interrupt> {
    home_named(main_loop, HomedAxis::X).await?;
    home_named(main_loop, HomedAxis::Y).await
}
