//! The byte ring: holds received bytes while a command is carried out.
//!
//! Damage is stored among the bytes, so that it affects only its own line. Its mark is the NUL byte, which has no
//! meaning in this protocol and is dropped on arrival.
//!
//! Full: the byte is lost, which is marked as damage; one place is kept free for the mark. Empty: there is nothing to
//! do.

use crate::port::Received;

/// Bytes held: some thirty lines, or 89 ms at 115200 baud. A power of two, so that a mask gives the place; this runs
/// for every byte.
const CAPACITY: usize = 1024;

/// The mark of damage.
const DAMAGE: u8 = 0;

/// Received bytes in order.
pub(super) struct Ring {
    bytes: [u8; CAPACITY],
    /// Place of the oldest byte.
    first: usize,
    length: usize,
    /// Entries ever put in, wrapping.
    taken: u32,
}

impl Ring {
    /// An empty ring.
    pub(super) const fn new() -> Self {
        Self { bytes: [0; CAPACITY], first: 0, length: 0, taken: 0 }
    }

    /// Whether another byte can be taken without loss.
    pub(super) const fn has_room(&self) -> bool {
        self.length < CAPACITY - 1
    }

    /// Bytes that can be taken without loss.
    pub(super) const fn room(&self) -> usize {
        CAPACITY - 1 - self.length
    }

    /// Whether nothing is held.
    pub(super) const fn is_empty(&self) -> bool {
        self.length == 0
    }

    /// Entries ever put in, and ever taken out; both wrap.
    pub(super) const fn places(&self) -> (u32, u32) {
        (self.taken, self.taken.wrapping_sub(self.length as u32))
    }

    /// Takes received bytes or damage.
    pub(super) fn push(&mut self, received: Received) {
        match received {
            Received::Byte(0) => {}
            Received::Byte(byte) if self.has_room() => self.append(byte),
            Received::Byte(_) | Received::Lost | Received::Opened => self.mark(),
        }
    }

    /// The oldest bytes, as many as are contiguous; a NUL among them is damage.
    pub(super) fn together(&self) -> &[u8] {
        let end = (self.first + self.length).min(CAPACITY);
        self.bytes.get(self.first..end).unwrap_or_default()
    }

    /// Removes the oldest bytes, at most those of [`together`](Self::together).
    pub(super) fn skip(&mut self, count: usize) {
        self.first = (self.first + count) % CAPACITY;
        self.length = self.length.saturating_sub(count);
    }

    /// Removes the oldest entry.
    pub(super) fn pop(&mut self) -> Option<Received> {
        self.length = self.length.checked_sub(1)?;
        let byte = *self.bytes.get(self.first)?;
        self.first = (self.first + 1) % CAPACITY;
        Some(if byte == DAMAGE { Received::Lost } else { Received::Byte(byte) })
    }

    /// Marks damage. A second mark next to the first adds nothing, so there is always a place.
    fn mark(&mut self) {
        let newest = (self.first + self.length + CAPACITY - 1) % CAPACITY;
        if self.length == 0 || self.bytes.get(newest) != Some(&DAMAGE) {
            self.append(DAMAGE);
        }
    }

    fn append(&mut self, byte: u8) {
        if let Some(place) = self.bytes.get_mut((self.first + self.length) % CAPACITY) {
            *place = byte;
        }
        self.length += 1;
        self.taken = self.taken.wrapping_add(1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_ring_marks_the_loss_where_it_happened() {
        let mut ring = Ring::new();
        let mut taken = 0;
        while ring.has_room() {
            ring.push(Received::Byte(b'x'));
            taken += 1;
        }
        assert_eq!(taken, CAPACITY - 1);
        ring.push(Received::Byte(b'y'));
        ring.push(Received::Byte(b'y'));
        ring.push(Received::Lost);
        for _ in 0..taken {
            assert_eq!(ring.pop(), Some(Received::Byte(b'x')));
        }
        ring.push(Received::Byte(b'z'));
        assert_eq!(ring.pop(), Some(Received::Lost));
        assert_eq!(ring.pop(), Some(Received::Byte(b'z')));
        assert_eq!(ring.pop(), None);
    }

    #[test]
    fn a_mark_in_the_last_place_but_one_leaves_no_gap() {
        let mut ring = Ring::new();
        for _ in 0..CAPACITY - 2 {
            ring.push(Received::Byte(b'x'));
        }
        ring.push(Received::Lost);
        assert!(!ring.has_room());
        ring.push(Received::Byte(b'y'));
        for _ in 0..CAPACITY - 2 {
            ring.pop();
        }
        assert_eq!(ring.pop(), Some(Received::Lost));
        assert_eq!(ring.pop(), None);
    }

    #[test]
    fn bytes_lie_together_as_far_as_the_end_of_the_memory() {
        let mut ring = Ring::new();
        // The oldest byte is the third from the end.
        for _ in 0..CAPACITY - 3 {
            ring.push(Received::Byte(b'x'));
            ring.skip(1);
        }
        assert_eq!((ring.is_empty(), ring.together(), ring.room()), (true, &b""[..], CAPACITY - 1));
        b"abcde".iter().for_each(|byte| ring.push(Received::Byte(*byte)));
        assert_eq!((ring.is_empty(), ring.together(), ring.room()), (false, &b"abc"[..], CAPACITY - 6));
        ring.skip(2);
        assert_eq!((ring.together(), ring.room()), (&b"c"[..], CAPACITY - 4));
        assert_eq!(ring.pop(), Some(Received::Byte(b'c')));
        assert_eq!(ring.together(), b"de");
        assert_eq!(ring.places(), (CAPACITY as u32 + 2, CAPACITY as u32));
    }

    #[test]
    fn nul_is_nothing() {
        let mut ring = Ring::new();
        ring.push(Received::Byte(0));
        assert_eq!(ring.pop(), None);
    }
}
