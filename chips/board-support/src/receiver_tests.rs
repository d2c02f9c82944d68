//! A USART, its DMA and the Console, in steps as small as an access to a register, and a byte at every instant.
//!
//! The registers follow RM0390, 25.6.1 and 25.4.3. Where the manual leaves something open, the tests run both variants.
//! One: whether the DMA's read of the data register counts when flags are cleared. Two: whether the DMA forgets a
//! request that it has seen when we read the byte instead.

use std::collections::VecDeque;

use corehbot::port::Received;

use super::*;
use crate::ring::{Ring, SIZE};

/// A byte takes this many steps on the wire; the processor's accesses take one. At a million bits a second an access to
/// APB1 is a fiftieth of a byte, so this test is harder than the hardware.
const BYTE: u32 = 20;

/// The Console looks for bytes this often: fifteen bytes at 250,000 bits a second are more than half a millisecond.
const POLL: u32 = 15 * BYTE;

/// The variants that the manual leaves open, and the speeds of the parts.
#[derive(Clone, Copy, Debug)]
struct Chip {
    does_dma_take_flags_back: bool,
    does_dma_keep_requests: bool,
    /// Steps from a byte to the DMA's reading.
    dma: u32,
    /// Steps from an interrupt to its first instruction, and between its instructions.
    handler: u32,
}

/// A byte on the wire: when it is complete, and whether it is sound.
#[derive(Clone, Copy, Debug)]
struct Arrival {
    at: u32,
    byte: u8,
    is_sound: bool,
}

struct Usart {
    chip: Chip,
    now: u32,
    wire: VecDeque<Arrival>,
    data: u8,
    has_byte: bool,
    is_at_rest: bool,
    is_damaged: bool,
    /// Flags seen by a read of the status; the next read of the data clears them.
    seen: Flags,
    /// When the line will have rested for a frame.
    rests: Option<u32>,
    watches_rest: bool,
    request: Option<u32>,
    ring: Ring,
    written: u32,
    woken: u32,
    answered: u32,
}

const NOTHING: Flags = Flags { is_at_rest: false, is_damaged: false };

impl Usart {
    fn new(chip: Chip, wire: &[Arrival]) -> Self {
        let ring = Ring::new();
        let wire = wire.iter().copied().collect();
        Self {
            chip,
            now: 0,
            wire,
            data: 0,
            has_byte: false,
            is_at_rest: false,
            is_damaged: false,
            seen: NOTHING,
            rests: None,
            watches_rest: true,
            request: None,
            ring,
            written: 0,
            woken: 0,
            answered: 0,
        }
    }

    /// Advances the time by a step.
    fn step(&mut self) {
        self.now += 1;
        if self.request.is_some_and(|due| self.now >= due) {
            self.request = None;
            if self.has_byte || self.chip.does_dma_keep_requests {
                let byte = self.read_data(self.chip.does_dma_take_flags_back);
                self.ring.bytes[(self.written % SIZE) as usize].store(byte, core::sync::atomic::Ordering::Relaxed);
                self.written += 1;
            }
        }
        if self.rests.is_some_and(|at| self.now >= at) {
            self.rests = None;
            self.is_at_rest = true;
        }
        if let Some(arrival) = self.wire.pop_front_if(|arrival| self.now >= arrival.at) {
            // The chip says so when no byte has begun for a frame, so the next one is complete another frame later.
            // Here it may be complete at the next step: a handler that comes late finds it so.
            let is_followed = self.wire.front().is_some_and(|next| next.at <= self.now + BYTE);
            self.rests = (!is_followed).then_some(self.now + BYTE);
            if self.has_byte {
                // Overrun: the new byte is lost.
                self.is_damaged = true;
            } else {
                self.data = if arrival.is_sound { arrival.byte } else { arrival.byte ^ 0x55 };
                self.is_damaged |= !arrival.is_sound;
                self.has_byte = true;
                self.request = Some(self.now + self.chip.dma);
            }
        }
    }

    fn look(&mut self) -> Flags {
        self.step();
        self.seen = Flags { is_at_rest: self.is_at_rest, is_damaged: self.is_damaged };
        self.seen
    }

    fn read_data(&mut self, takes_flags_back: bool) -> u8 {
        self.has_byte = false;
        if takes_flags_back {
            self.is_at_rest &= !self.seen.is_at_rest;
            self.is_damaged &= !self.seen.is_damaged;
            self.seen = NOTHING;
        }
        self.data
    }

    fn is_interrupting(&self) -> bool {
        self.is_damaged || self.is_at_rest && self.watches_rest
    }

    fn take(&mut self, news: News) {
        match news {
            News::None => return,
            News::Rest => {}
            News::Damage => self.ring.mark_damage(self.written),
        }
        self.woken += 1;
    }

    /// Runs until everything has come and was looked for; returns the bytes that the Console received.
    fn run(&mut self, poll: u32) -> Vec<Received> {
        let (mut received, mut read) = (Vec::new(), 0);
        let (mut next_poll, mut woken) = (poll, 0);
        let end = self.wire.back().map_or(0, |last| last.at) + 3 * POLL;
        while self.now < end {
            self.step();
            if self.is_interrupting() {
                (0..self.chip.handler).for_each(|_| self.step());
                let flags = self.look();
                (0..self.chip.handler).for_each(|_| self.step());
                let news = answer(flags, self);
                self.take(news);
                self.answered += 1;
            }
            if self.now >= next_poll || self.woken != woken {
                woken = self.woken;
                next_poll = self.now + POLL;
                while let Some(byte) = self.ring.take(&mut read, self.written) {
                    received.push(byte);
                    self.step();
                }
                let news = watch_again(self, Self::look);
                self.take(news);
            }
        }
        received
    }
}

impl Receiving for Usart {
    fn discard(&mut self) {
        self.step();
        self.read_data(true);
    }

    fn is_watching(&mut self) -> bool {
        self.step();
        self.watches_rest
    }

    fn watch(&mut self, rest: bool) {
        self.step();
        self.watches_rest = rest;
    }
}

/// Every kind of chip, with a handler that is quicker than a byte.
fn chips() -> impl Iterator<Item = Chip> {
    let flags = [false, true].into_iter().flat_map(|a| [false, true].map(|b| (a, b)));
    flags.flat_map(|(does_dma_take_flags_back, does_dma_keep_requests)| {
        [(1, 0), (1, 3), (2, 1), (4, 6), (6, 2)].map(|(dma, handler)| Chip {
            does_dma_take_flags_back,
            does_dma_keep_requests,
            dma,
            handler,
        })
    })
}

/// Lines, one after the other without a rest, except for a rest of `pause` steps after the first.
fn wire(lines: &[&[u8]], pause: u32, damaged: Option<usize>) -> Vec<Arrival> {
    let mut at = 0;
    let mut wire = Vec::new();
    for (n, line) in lines.iter().enumerate() {
        for byte in *line {
            at += BYTE;
            wire.push(Arrival { at, byte: *byte, is_sound: damaged != Some(wire.len()) });
        }
        at += if n == 0 { pause } else { 0 };
    }
    wire
}

/// The lines that came whole, as the core sees them: nothing of one in which something was lost.
fn whole(received: &[Received]) -> Vec<Vec<u8>> {
    let mut lines = Vec::new();
    for part in received.split_inclusive(|r| *r == Received::Byte(b'\n')) {
        let bytes: Option<Vec<u8>> =
            part.iter().map(|r| if let Received::Byte(b) = r { Some(*b) } else { None }).collect();
        lines.extend(bytes.filter(|bytes| bytes.ends_with(b"\n")));
    }
    lines
}

const LINES: [&[u8]; 3] = [b"ab\n", b"cde\n", b"fg\n"];

#[test]
fn a_byte_that_comes_at_any_instant_round_a_rest_is_not_lost() {
    for chip in chips() {
        for pause in 0..4 * BYTE {
            for poll in [1, 7, 13, 2 * BYTE, POLL] {
                let mut usart = Usart::new(chip, &wire(&LINES, pause, None));
                let received = usart.run(poll);
                let expected: Vec<_> = LINES.concat().into_iter().map(Received::Byte).collect();
                assert_eq!(received, expected, "{chip:?}, a pause of {pause}, first look at {poll}");
                // At most one interrupt for each idle line, and no repeated ones.
                assert!(usart.answered <= 2, "{} interrupts", usart.answered);
            }
        }
    }
}

#[test]
fn each_rest_is_reported_if_somebody_has_looked_in_between() {
    for chip in chips().filter(|chip| chip.does_dma_take_flags_back) {
        // Looks in the middle of the second line, when the flag of the first rest has gone.
        let long = [b'x'; 40];
        let mut usart = Usart::new(chip, &wire(&[b"ab\n", &long, b"\n"], 3 * BYTE, None));
        usart.run(POLL);
        assert_eq!((usart.woken, usart.answered), (2, 2), "{chip:?}");
    }
}

#[test]
fn no_line_is_taken_for_whole_in_which_a_byte_was_damaged_swallowed_or_overrun() {
    let sent: Vec<Vec<u8>> = LINES.iter().map(|line| line.to_vec()).collect();
    let slow = chips().map(|chip| Chip { dma: BYTE + 3, ..chip });
    for chip in chips().chain(slow) {
        for damaged in 0..LINES.concat().len() {
            for pause in 0..3 * BYTE {
                let received = Usart::new(chip, &wire(&LINES, pause, Some(damaged))).run(7);
                let lines = whole(&received);
                let mut left = sent.iter();
                let are_sent = lines.iter().all(|line| left.any(|sent| sent == line));
                assert!(are_sent, "{chip:?}, byte {damaged}, pause {pause}: {received:?}");
                if chip.dma < BYTE {
                    // The line itself, and one more if its end was lost.
                    assert!(lines.len() + 2 >= sent.len(), "{chip:?}, byte {damaged}, pause {pause}: {received:?}");
                    assert!(lines.len() < sent.len() || damaged >= 9, "{received:?}");
                }
            }
        }
    }
}

#[test]
fn bytes_are_counted_over_the_end_of_the_ring() {
    let ring = Ring::new();
    assert_eq!(ring.written(|| SIZE), 0);
    assert_eq!(ring.written(|| 1), SIZE - 1);
    ring.end_lap();
    assert_eq!(ring.written(|| SIZE), SIZE);
    // The DMA has wrapped around, and its interrupt has not come yet: the result is nothing new, rather than a lap too
    // few.
    let mut read = SIZE + 5;
    assert_eq!(ring.take(&mut read, ring.written(|| SIZE)), None);
    // The DMA has overtaken the reader.
    assert_eq!(ring.take(&mut read, 3 * SIZE), Some(Received::Lost));
    assert_eq!(read, 3 * SIZE);
}

#[test]
fn bytes_are_overheard_once_and_read_all_the_same() {
    let (ring, text) = (Ring::new(), b"G1 X5\nM112\n");
    for (place, byte) in ring.bytes.iter().zip(text) {
        place.store(*byte, core::sync::atomic::Ordering::Relaxed);
    }
    ring.mark_damage(3);
    let (written, mut heard, mut read) = (text.len() as u32, 0, 0);
    let overheard: Vec<_> = std::iter::from_fn(|| ring.overhear(&mut heard, written)).collect();
    assert_eq!((overheard.len(), overheard[2], overheard[6]), (11, Received::Lost, Received::Byte(b'M')));
    let received: Vec<_> = std::iter::from_fn(|| ring.take(&mut read, written)).collect();
    assert_eq!(received, overheard);
    // The DMA has overtaken the listener.
    let far = written + SIZE + 1;
    assert_eq!((ring.overhear(&mut heard, far), heard), (Some(Received::Lost), far));
    assert_eq!(ring.overhear(&mut heard, far), None);
}
