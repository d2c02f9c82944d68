//! States of the program that lines have saved: G60 by a number, SAVE_GCODE_STATE by a name.

use super::commanded::Commanded;
use super::modal::Modal;
use crate::units::Mm;
use heapless::Vec;

/// How many are kept. Files use one or two; the oldest one makes room for another.
const MOST: usize = 4;

/// The name or the number of a saved state.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) struct Key(u32);

impl Key {
    /// The slot of G60.
    pub const fn of_slot(slot: u16) -> Self {
        Self(slot as u32)
    }

    /// A name, in any letters: FNV-1a (Fowler, Noll and Vo; 32 bits). It is none of a slot.
    pub fn of_name(name: &[u8]) -> Self {
        let step = |hash: u32, byte: &u8| (hash ^ u32::from(byte.to_ascii_uppercase())).wrapping_mul(0x0100_0193);
        Self(name.iter().fold(0x811c_9dc5, step) | 1 << 31)
    }
}

/// A saved state of the program.
#[derive(Clone, Copy, Debug)]
pub(in crate::machine) struct SavedState {
    /// Absolute or relative, units, plane, F.
    pub modal: Modal,
    /// The place, in machine coordinates.
    pub place: [Mm; 3],
    /// The zero of the program (G92).
    zero: [Mm; 3],
    /// E as it counts it.
    extrusion: Mm,
}

/// The zero of a program.
fn zero_of(commanded: &Commanded) -> [Mm; 3] {
    let ([x, y, z, _], [named_x, named_y, named_z, _]) = (commanded.position(), commanded.named(commanded.position()));
    [x.saturating_sub(named_x), y.saturating_sub(named_y), z.saturating_sub(named_z)]
}

impl SavedState {
    /// The present one.
    pub fn of(modal: &Modal, commanded: &Commanded) -> Self {
        let ([x, y, z, _], extrusion) = (commanded.position(), commanded.extrusion());
        Self { modal: *modal, place: [x, y, z], zero: zero_of(commanded), extrusion }
    }

    /// The program counts from there again. Nothing moves.
    pub fn put_counts(&self, commanded: &mut Commanded) {
        let ([x, y, z], [x_now, y_now, z_now]) = (self.zero, zero_of(commanded));
        commanded.move_origin([x.saturating_sub(x_now), y.saturating_sub(y_now), z.saturating_sub(z_now)]);
        commanded.count_extrusion(self.extrusion);
    }
}

/// The saved states, the oldest first.
pub(in crate::machine) struct SavedStates(Vec<(Key, SavedState), MOST>);

impl SavedStates {
    pub const fn new() -> Self {
        Self(Vec::new())
    }

    /// Saves a state, in the place of one with its key.
    pub fn save(&mut self, key: Key, state: SavedState) {
        self.forget(key);
        if self.0.is_full() {
            self.0.remove(0);
        }
        let _ = self.0.push((key, state));
    }

    /// The state with that key.
    pub fn get(&self, key: Key) -> Option<SavedState> {
        self.0.iter().find(|(its, _)| *its == key).map(|(_, state)| *state)
    }

    /// Forgets the one with that key.
    pub fn forget(&mut self, key: Key) {
        self.0.retain(|(its, _)| *its != key);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_is_found_by_its_key_until_newer_ones_need_its_place() {
        let (mut states, mut commanded) = (SavedStates::new(), Commanded::new([Mm::ZERO; 3], [Mm::ZERO; 3]));
        let mut at = |x: i32| {
            commanded.go_to([Mm::from_num(x), Mm::ZERO, Mm::ZERO, Mm::ZERO]);
            SavedState::of(&Modal::new(), &commanded)
        };
        let x_of = |states: &SavedStates, key| states.get(key).map(|state| state.place[0].to_num::<i32>());
        states.save(Key::of_slot(0), at(1));
        states.save(Key::of_name(b"PAUSE_state"), at(2));
        states.save(Key::of_slot(0), at(3));
        assert_eq!(x_of(&states, Key::of_slot(0)), Some(3));
        assert_eq!(x_of(&states, Key::of_name(b"pause_STATE")), Some(2));
        assert_eq!([x_of(&states, Key::of_slot(1)), x_of(&states, Key::of_name(b"PAUSE"))], [None; 2]);
        for slot in 5..8 {
            states.save(Key::of_slot(slot), at(slot.into()));
        }
        // The name was the oldest.
        assert_eq!(x_of(&states, Key::of_name(b"pause_STATE")), None);
        assert_eq!(x_of(&states, Key::of_slot(0)), Some(3));
        states.forget(Key::of_slot(0));
        assert_eq!(x_of(&states, Key::of_slot(0)), None);
    }
}
