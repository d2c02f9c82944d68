//! Putting the probe out, and taking it in.
//!
//! A BLTouch gets its orders as pulses of a servo's line. In an alarm its output stays high, which reads as triggered:
//! after it was put out or taken in it must not. Then it is reset. Nothing asks it at the start, so a pin that rests on
//! the bed stops no machine.

use super::error::failed;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::state::job::ProbeFailure;
use crate::port::{EndstopSet, Servo, Wake};
use crate::settings::ProbeKind;

/// An order to a BLTouch: the length of the pulses in us, and the ms until it is obeyed (Marlin, `bltouch.h`).
struct Order(u16, u32);

const DEPLOY: Order = Order(647, 750);
const STOW: Order = Order(1472, 750);
const RESET: Order = Order(2194, 500);

/// How often a pin that does not go in is reset (Klipper, `bltouch.py`: `retries`).
const STOW_TRIES: usize = 3;

/// Puts the probe out, if it is not. One without a servo is always out.
pub(super) async fn put_out<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>) -> Result<(), Interrupt> {
    let was_out = main_loop.probing.is_out();
    // Before the order: whatever ends it has the probe taken in.
    main_loop.probing.note_out(true);
    let mut orders: &[Order] = &[];
    if is_bltouch(main_loop) && !was_out && is_triggered_after(main_loop, &[DEPLOY]).await? {
        orders = &[RESET, STOW, DEPLOY];
    }
    if is_triggered_after(main_loop, orders).await? {
        return Err(failed(main_loop, ProbeFailure::Triggered));
    }
    Ok(())
}

/// Takes it in: it reads as not triggered then, or its pin may still be out.
pub(super) async fn take_in<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>) -> Result<(), Interrupt> {
    main_loop.probing.note_out(false);
    if !is_bltouch(main_loop) {
        return Ok(());
    }
    let mut orders: &[Order] = &[STOW];
    for _ in 0..=STOW_TRIES {
        if !is_triggered_after(main_loop, orders).await? {
            return Ok(());
        }
        orders = &[RESET, STOW];
    }
    Err(failed(main_loop, ProbeFailure::NotTakenIn))
}

/// Whether the probe, which has touched, is to be taken in: the pin of a BLTouch goes in by itself. Between touches it
/// is told so too, unless that takes too long for the user.
pub(super) fn goes_in_by_itself<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>) -> bool {
    let goes_in = is_bltouch(main_loop);
    if goes_in {
        main_loop.probing.note_out(false);
    }
    goes_in && !main_loop.probing.is_quick()
}

/// Has the probe go in, without waiting for it: a command that had put it out was ended.
pub(super) fn take_in_at_once<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>) {
    let is_out = main_loop.probing.is_out();
    main_loop.probing.note_out(false);
    main_loop.probing.note_series(false);
    if is_out && is_bltouch(main_loop) {
        set_servo(main_loop, Some(STOW.0));
    }
}

/// Gives the servo an order.
pub(in crate::machine) fn set_servo<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, micros: Option<u16>) {
    main_loop.probing.note_servo(micros);
    main_loop.servo.order(micros);
}

fn is_bltouch<P: PortSet, W: Wake>(main_loop: &MainLoop<'_, P, W>) -> bool {
    main_loop.settings.probe.kind == ProbeKind::BlTouch
}

/// Whether the probe reads as triggered now.
pub(super) fn is_triggered<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> impl Future<Output = Result<bool, Interrupt>> {
    is_triggered_after(main_loop, &[])
}

/// Gives orders. Whether the probe reads as triggered then.
async fn is_triggered_after<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    orders: &'static [Order],
) -> Result<bool, Interrupt> {
    for Order(micros, ms) in orders {
        set_servo(main_loop, Some(*micros));
        main_loop.settle(main_loop.now().after_ms(*ms)).await?;
    }
    let before = main_loop.status.stepper_beat();
    main_loop.motion.look_at_endstops();
    loop {
        main_loop.poll().await?;
        // In a simulation the main loop may go round before the Stepper has its turn.
        if main_loop.status.stepper_beat() != before {
            return Ok(main_loop.status.endstops().has(EndstopSet::PROBE));
        }
    }
}
