//! Safe levels: drivers off, heaters and fans off, in any context and at any time.

use core::sync::atomic::{AtomicU32, Ordering};

use crate::ports::{self, Speed};
use crate::wiring::{Board, HEATER_PORTS, Plugged, Port, Slot};

/// The words for BSRR. Until a board is known they are 0, and its pins are inputs, which its resistors make safe.
static WORDS: [AtomicU32; Port::ALL.len()] = [const { AtomicU32::new(0) }; Port::ALL.len()];

/// The bits of the heaters' pins in the mode register of each of their ports, and the value that makes them outputs
/// again.
static HEATER_MODES: [[AtomicU32; 2]; HEATER_PORTS.len()] =
    [const { [const { AtomicU32::new(0) }; 2] }; HEATER_PORTS.len()];

/// Makes the board's outputs outputs, safe from the first instant on. Heaters come first.
pub fn adopt(board: &Board) {
    for port in Port::ALL {
        WORDS[port as usize].store(board.safe_levels(port), Ordering::Relaxed);
    }
    for (places, port) in HEATER_MODES.iter().zip(HEATER_PORTS) {
        for (place, word) in places.iter().zip(board.heater_modes(port)) {
            place.store(word, Ordering::Relaxed);
        }
    }
    assume();
    for pin in board.loads {
        ports::make_output(*pin);
    }
    for slot in board.sockets {
        ports::make_output(slot.enable);
    }
    board.sockets.iter().filter(|slot| !slot.is_of_debug_port()).for_each(drive);
}

/// Takes the debug port's pins if a motor of the machine needs one. From then on no probe is heard, until the next
/// reset.
pub fn take_debug_pins(plugged: &Plugged) {
    plugged.slots.iter().flatten().filter(|slot| slot.is_of_debug_port()).for_each(drive);
}

/// Makes outputs of a driver's step and direction pins; their levels were chosen before.
fn drive(slot: &Slot) {
    for pin in [slot.step, slot.dir] {
        if !pin.is_slow() {
            ports::speed_up(pin, Speed::Medium);
        }
        ports::make_output(pin);
    }
}

/// Sets the heaters' pins low, whatever their timers do: for each port the level first, then the pins are taken from
/// the timers. Some three dozen instructions without a branch or a lock. Code that changes modes at that time must not
/// continue afterwards.
// A function by itself, so that `cargo xtask build` can count how many instructions lead to its end.
#[inline(never)]
pub fn lower_heaters() {
    lower_on::<0>();
    lower_on::<1>();
    lower_on::<2>();
}

/// Does that for one of the ports, by an address that is known when this is compiled.
#[inline(always)]
fn lower_on<const PLACE: usize>() {
    const { assert!(HEATER_PORTS.len() == 3) };
    let port = const { ports::registers(HEATER_PORTS[PLACE]) };
    let [bits, outputs] = &HEATER_MODES[PLACE];
    ports::store(port, WORDS[const { HEATER_PORTS[PLACE] as usize }].load(Ordering::Relaxed));
    port.moder().modify(|w| w.0 = w.0 & !bits.load(Ordering::Relaxed) | outputs.load(Ordering::Relaxed));
}

/// Sets all outputs to their safe levels, heaters first. Fans on a timer run on until the reset.
#[inline(always)]
pub fn assume() {
    lower_heaters();
    // Port after port and no loop, which would take five times as many instructions.
    let [a, b, c, d, e, f, g] = &WORDS;
    for_port::<{ Port::A as usize }>(a);
    for_port::<{ Port::B as usize }>(b);
    for_port::<{ Port::C as usize }>(c);
    for_port::<{ Port::D as usize }>(d);
    for_port::<{ Port::E as usize }>(e);
    for_port::<{ Port::F as usize }>(f);
    for_port::<{ Port::G as usize }>(g);
}

/// Stores a port's word, by an address that is known when this is compiled.
#[inline(always)]
fn for_port<const PORT: usize>(word: &AtomicU32) {
    ports::store(const { ports::registers(Port::ALL[PORT]) }, word.load(Ordering::Relaxed));
}
