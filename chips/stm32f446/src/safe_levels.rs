//! Safe levels: drivers off, heaters and fans off, in any context and at any time.

use core::sync::atomic::{AtomicU32, Ordering};

use crate::ports::{self, Speed};
use crate::wiring::{Board, HEATER_PORTS, Plugged, Port, Slot};

/// The words for BSRR. Until a board is known they are 0, and its pins are inputs, which its resistors make safe.
static WORDS: [AtomicU32; Port::ALL.len()] = [const { AtomicU32::new(0) }; Port::ALL.len()];

/// The lower of the two bits of each heater's pin in the mode registers of their ports.
static HEATER_OUTPUTS: [AtomicU32; HEATER_PORTS.len()] = [const { AtomicU32::new(0) }; HEATER_PORTS.len()];

/// Makes the board's outputs outputs, safe from the first instant on. Heaters come first.
pub fn adopt(board: &Board) {
    for port in Port::ALL {
        WORDS[port as usize].store(board.safe_levels(port), Ordering::Relaxed);
    }
    for (place, port) in HEATER_OUTPUTS.iter().zip(HEATER_PORTS) {
        place.store(board.heater_outputs(port), Ordering::Relaxed);
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

/// Sets the heaters' pins low, whatever their timers do: for each of their ports the safe level of all outputs first,
/// then the heaters' pins are taken from the timers. Two dozen instructions without a branch or a lock. Code that
/// changes modes at that time must not continue afterwards.
// A function by itself, so that `cargo xtask build` can count how many instructions lead to its end.
#[inline(never)]
pub fn lower_heaters() {
    const { assert!(matches!(HEATER_PORTS, [Port::A, Port::B, Port::C])) };
    let [a, b, c, ..] = &WORDS;
    let [in_a, in_b, in_c] = &HEATER_OUTPUTS;
    lower_on::<{ Port::A as usize }>(a, in_a);
    lower_on::<{ Port::B as usize }>(b, in_b);
    lower_on::<{ Port::C as usize }>(c, in_c);
}

/// Does that for one of the ports, by an address that is known when this is compiled.
#[inline(always)]
fn lower_on<const PORT: usize>(word: &AtomicU32, heaters: &AtomicU32) {
    for_port::<PORT>(word);
    let outputs = heaters.load(Ordering::Relaxed);
    let port = const { ports::registers(Port::ALL[PORT]) };
    port.moder().modify(|w| w.0 = (w.0 | outputs) & !(outputs << 1));
}

/// Sets all outputs to their safe levels, heaters first. Fans on a timer run on until the reset.
#[inline(always)]
pub fn assume() {
    lower_heaters();
    // Port after port and no loop, which would take five times as many instructions.
    let [_, _, _, d, e, f, g] = &WORDS;
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
