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

/// From so many entries on room is short. The rest is for the beginning of one more line, which shows what it is.
pub(super) const SHORT: usize = CAPACITY - 1 - HEAD - 8;

/// Bytes of a line that show what it is.
pub(super) const HEAD: usize = 24;

/// A line that is held, or its beginning.
pub(super) struct Line {
    head: [u8; HEAD],
    shown: usize,
    /// Its entries, with its end.
    pub length: usize,
    /// Whether its end is held too.
    pub is_whole: bool,
    /// Whether it has a `*` or damage: it may be another line than it seems.
    pub is_doubtful: bool,
}

impl Line {
    /// Its first bytes, without its end.
    pub(super) fn head(&self) -> &[u8] {
        self.head.get(..self.shown).unwrap_or(&self.head)
    }
}

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

    /// Entries before a place, as of [`places`](Self::places); none if they are all taken out.
    pub(super) const fn entries_up_to(&self, place: u32) -> usize {
        let entries = place.wrapping_sub(self.places().1) as usize;
        if entries <= self.length { entries } else { 0 }
    }

    /// Takes received bytes or damage.
    pub(super) fn push(&mut self, received: Received) {
        match received {
            Received::Byte(byte) => self.push_byte(byte),
            Received::Lost | Received::Opened => self.mark(),
        }
    }

    /// Takes a received byte.
    #[inline]
    pub(super) fn push_byte(&mut self, byte: u8) {
        match byte {
            0 => {}
            byte if self.has_room() => self.append(byte),
            _ => self.mark(),
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

    /// Entries held.
    pub(super) const fn length(&self) -> usize {
        self.length
    }

    fn at(&self, place: usize) -> Option<u8> {
        let byte = self.bytes.get((self.first + place) % CAPACITY);
        byte.copied().filter(|_| place < self.length)
    }

    /// The line that begins at an entry. Inlined, it would be repeated in each of its four places.
    #[inline(never)]
    pub(super) fn line(&self, from: usize) -> Line {
        let mut line = Line { head: [0; HEAD], shown: 0, length: 0, is_whole: false, is_doubtful: false };
        while let Some(byte) = self.at(from + line.length)
            && !line.is_whole
        {
            line.length += 1;
            line.is_whole = matches!(byte, b'\n' | b'\r');
            line.is_doubtful |= matches!(byte, b'*' | DAMAGE);
            if let Some(place) = line.head.get_mut(line.shown).filter(|_| !line.is_whole) {
                *place = byte;
                line.shown += 1;
            }
        }
        line
    }

    /// Takes out the lines from an entry on for which `stays` is false; it gets the line, and its entry when the lines
    /// before it are out. `overtaken` stays behind the same line.
    pub(super) fn retain(
        &mut self,
        from: usize,
        overtaken: &mut Option<u32>,
        mut stays: impl FnMut(usize, &Line) -> bool,
    ) {
        let (_, oldest) = self.places();
        let (mut read, mut kept, mut before) = (from, from, 0);
        while read < self.length {
            let line = self.line(read);
            let end = read + line.length;
            if stays(kept, &line) {
                for place in read..end {
                    let (to, byte) = ((self.first + kept) % CAPACITY, self.at(place));
                    if let Some((to, byte)) = self.bytes.get_mut(to).zip(byte) {
                        *to = byte;
                    }
                    kept += 1;
                }
            } else if overtaken.is_some_and(|place| place.wrapping_sub(oldest.wrapping_add(end as u32)) as i32 >= 0) {
                // It lies before the stop's place, which comes nearer by its length.
                before += line.length as u32;
            }
            read = end;
        }
        self.taken = self.taken.wrapping_sub((self.length - kept) as u32);
        self.length = kept;
        *overtaken = overtaken.map(|place| place.wrapping_sub(before));
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
