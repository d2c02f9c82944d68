//! Putting the probe out, and taking it in.
//!
//! A BLTouch gets its orders as pulses of a servo's line. In an alarm its output stays high, which reads as triggered:
//! after it was put out or taken in it must not. Then it is reset. Nothing asks it at the start, so a pin that rests on
//! the bed stops no machine.

use super::approach::is_triggered;
use super::error::ProbeError;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::state::job::ProbeFailure;
use crate::port::Pend;
use crate::settings::ProbeKind;

/// An order to a BLTouch: the length of the pulses in us, and the ms until it is obeyed (Marlin, `bltouch.h`).
struct Order(u16, u32);

const DEPLOY: Order = Order(647, 750);
const STOW: Order = Order(1472, 750);
const RESET: Order = Order(2194, 500);

/// How often a pin that does not go in is reset (Klipper, `bltouch.py`: `retries`).
const STOW_TRIES: usize = 3;

/// Puts the probe out, if it is not. One without a servo is always out.
pub(super) async fn put_out<P: PortSet, W: Pend>(main_loop: &mut MainLoop<'_, P, W>) -> Result<(), ProbeError> {
    let was_out = main_loop.probing.is_out();
    // Before the order: whatever ends it has the probe taken in.
    main_loop.probing.note_out(true);
    if is_bltouch(main_loop) && !was_out {
        order(main_loop, DEPLOY).await?;
        if is_triggered(main_loop).await? {
            for again in [RESET, STOW, DEPLOY] {
                order(main_loop, again).await?;
            }
        }
    }
    if is_triggered(main_loop).await? { Err(ProbeFailure::Triggered.into()) } else { Ok(()) }
}

/// Takes it in: it reads as not triggered then, or its pin may still be out.
pub(super) async fn take_in<P: PortSet, W: Pend>(main_loop: &mut MainLoop<'_, P, W>) -> Result<(), ProbeError> {
    main_loop.probing.note_out(false);
    if !is_bltouch(main_loop) {
        return Ok(());
    }
    order(main_loop, STOW).await?;
    for _ in 0..STOW_TRIES {
        if !is_triggered(main_loop).await? {
            return Ok(());
        }
        order(main_loop, RESET).await?;
        order(main_loop, STOW).await?;
    }
    if is_triggered(main_loop).await? { Err(ProbeFailure::NotTakenIn.into()) } else { Ok(()) }
}

/// The probe has touched: the pin of a BLTouch goes in by itself. Between touches it is told so too, unless that takes
/// too long for the user.
pub(super) async fn after_touch<P: PortSet, W: Pend>(main_loop: &mut MainLoop<'_, P, W>) -> Result<(), ProbeError> {
    if !is_bltouch(main_loop) {
        return Ok(());
    }
    main_loop.probing.note_out(false);
    if main_loop.probing.is_quick() { Ok(()) } else { take_in(main_loop).await }
}

/// Has the probe go in, without waiting for it: a command that had put it out was ended.
pub(super) fn take_in_at_once<P: PortSet, W: Pend>(main_loop: &mut MainLoop<'_, P, W>) {
    let is_out = main_loop.probing.is_out();
    main_loop.probing.note_out(false);
    main_loop.probing.note_series(false);
    if is_out && is_bltouch(main_loop) {
        set_servo(main_loop, Some(STOW.0));
    }
}

/// Gives the servo an order.
pub(in crate::machine) fn set_servo<P: PortSet, W: Pend>(main_loop: &mut MainLoop<'_, P, W>, micros: Option<u16>) {
    main_loop.probing.note_servo(micros);
    main_loop.power.servo(micros);
}

fn is_bltouch<P: PortSet, W: Pend>(main_loop: &MainLoop<'_, P, W>) -> bool {
    main_loop.settings.probe.kind == ProbeKind::BlTouch
}

async fn order<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    Order(micros, ms): Order,
) -> Result<(), Interrupt> {
    set_servo(main_loop, Some(micros));
    main_loop.settle(main_loop.now().after_ms(ms)).await
}
