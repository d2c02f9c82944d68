//! Fan speeds in their turn: each holds from the end of the move that was planned last before it.
//!
//! ```text
//!   M106 ──▶ after move n ── n has left the look-ahead ──▶ after entry e ── e is done ──▶ the fan
//! ```
//!
//! Done means that the generator has put all steps of the entry into the StepQueue. They are played up to 10 ms later
//! (`AHEAD` in `motion::stepgen`), and an input shaper delays the end further. A fan needs far longer than that to
//! change its speed.

use crate::connectors::FANS;
use heapless::Deque;

/// Speeds that may wait. A file with fan speeds by overhang has one every few moves.
const MOST: usize = 64;

/// A fan's speed that waits.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    /// The number of moves planned before it, or of entries put into the MoveQueue before it; wraps.
    after: u32,
    /// Its moves have left the look-ahead, and entries count.
    has_left: bool,
    fan: u8,
    speed: u16,
}

const _: () = assert!(size_of::<Waiting>() <= 8);

/// Fan speeds that wait for moves, in order, and the last commanded speeds.
pub(in crate::machine) struct FanSchedule {
    queue: Deque<Waiting, MOST>,
    commanded: [u16; FANS],
}

impl FanSchedule {
    pub const fn new() -> Self {
        Self { queue: Deque::new(), commanded: [0; FANS] }
    }

    /// A line has commanded a fan's speed, of 65,535, whenever it comes to hold.
    pub fn note_commanded(&mut self, fan: u8, speed: u16) {
        if let Some(place) = self.commanded.get_mut(usize::from(fan)) {
            *place = speed;
        }
    }

    /// The speed of each fan that was commanded last, of 65,535.
    pub const fn commanded(&self) -> [u16; FANS] {
        self.commanded
    }

    /// Whether it takes another speed.
    pub fn has_room(&self) -> bool {
        !self.queue.is_full()
    }

    /// Sets a fan to `speed` after `moves` moves. Without room, it takes the place of the last speed.
    pub fn add(&mut self, moves: u32, fan: u8, speed: u16) {
        if let Some(last) = self.queue.back_mut()
            && (last.fan, last.after, last.has_left) == (fan, moves, false)
        {
            last.speed = speed;
            return;
        }
        if !self.has_room() {
            let _ = self.queue.pop_back();
        }
        let _ = self.queue.push_back(Waiting { after: moves, has_left: false, fan, speed });
    }

    /// Takes the number of moves that have left the look-ahead, and of entries put into the MoveQueue: called after
    /// each.
    pub fn note_left(&mut self, moves: u32, entries: u32) {
        for waiting in &mut self.queue {
            if !waiting.has_left {
                if !is_past(waiting.after, moves) {
                    return;
                }
                (waiting.after, waiting.has_left) = (entries, true);
            }
        }
    }

    /// The next fan and its speed that are due after `done` entries.
    pub fn take(&mut self, done: u32) -> Option<(u8, u16)> {
        let Waiting { after, has_left, fan, speed } = *self.queue.front()?;
        if !has_left || !is_past(after, done) {
            return None;
        }
        let _ = self.queue.pop_front();
        Some((fan, speed))
    }

    /// Whether no speed waits.
    pub fn is_empty(&self) -> bool {
        self.queue.is_empty()
    }

    /// All fans are off, and nothing waits any more.
    pub fn clear(&mut self) {
        self.queue.clear();
        self.commanded = [0; FANS];
    }
}

/// Whether a count that wraps has come to `mark`.
const fn is_past(mark: u32, count: u32) -> bool {
    count.wrapping_sub(mark).cast_signed() >= 0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speeds_wait_for_their_moves() {
        let mut fans = FanSchedule::new();
        fans.add(u32::MAX, 0, 1);
        fans.add(1, 0, 2);
        fans.add(1, 0, 3);
        fans.add(1, 4, 4);
        assert_eq!(fans.take(100), None, "the move is in the look-ahead");
        fans.note_left(0, 10);
        assert_eq!(fans.take(9), None);
        assert_eq!((fans.take(10), fans.take(10)), (Some((0, 1)), None));
        fans.note_left(2, 12);
        fans.note_left(3, 13);
        assert_eq!(fans.take(11), None);
        assert_eq!([fans.take(12), fans.take(12), fans.take(12)], [Some((0, 3)), Some((4, 4)), None]);
    }

    #[test]
    fn without_room_the_last_speed_gives_way() {
        let mut fans = FanSchedule::new();
        for count in 0..100 {
            fans.add(u32::from(count), 0, count);
        }
        fans.note_left(1000, 0);
        let first = core::iter::from_fn(|| fans.take(0)).map(|(_, speed)| speed);
        assert!(first.eq((0..63).chain([99])));
    }
}
