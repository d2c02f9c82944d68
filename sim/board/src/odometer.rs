//! Odometer: the path of the tool; the firmware's counter of it wraps at 4.3 km, this one does not.

#[derive(Default)]
pub(crate) struct Odometer {
    seen: u32,
    um: u64,
}

impl Odometer {
    /// The firmware's counter stands at `counter` um.
    pub const fn follow(&mut self, counter: u32) {
        // It also falls, when a move ends early.
        self.um = self.um.wrapping_add_signed(counter.wrapping_sub(self.seen).cast_signed() as i64);
        self.seen = counter;
    }

    /// The path in um.
    pub const fn um(&self) -> u64 {
        self.um
    }
}
