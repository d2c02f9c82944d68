//! A memory with one context that stores and an interrupt that reads.
//!
//! Between two fences the compiler may give the stores any order. So an interrupt may find any of those since the last
//! fence done or not done, and all before. The context itself sees its own stores.

use super::explore::choose;
use std::cell::{Cell, RefCell};

/// The orders that the queue's files name.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Ordering {
    Relaxed,
    AcqRel,
}

/// Words of an array that has been used before: an event of one step, 16 ticks after another.
const STALE: u32 = 16;

#[derive(Default)]
struct Memory {
    words: Vec<u32>,
    /// Stores that an interrupt may or may not see.
    pending: Vec<(usize, u32)>,
    /// Words from here on belong to the context alone.
    shared: usize,
    /// Interrupts that may still come.
    interrupts: u32,
    in_interrupt: bool,
    is_stale: bool,
}

thread_local! {
    static MEMORY: RefCell<Memory> = RefCell::default();
    static INTERRUPT: RefCell<Option<Box<dyn FnMut()>>> = const { RefCell::new(None) };
}

/// From now on up to `interrupts` interrupts come, at any place; each runs `interrupt`.
pub fn begin(interrupts: u32, interrupt: Box<dyn FnMut()>) {
    INTERRUPT.set(Some(interrupt));
    MEMORY.with_borrow_mut(|m| (m.interrupts, m.shared) = (interrupts, m.words.len()));
}

/// An interrupt comes here.
pub fn interrupt() {
    compiler_fence(Ordering::AcqRel);
    run_interrupt();
}

/// The last interrupt comes here.
pub fn end() {
    MEMORY.with_borrow_mut(|m| m.interrupts = 0);
    interrupt();
}

/// Forgets everything. From now on words that were not stored are stale.
pub fn reset() {
    INTERRUPT.set(None);
    MEMORY.set(Memory { is_stale: true, ..Memory::default() });
}

fn run_interrupt() {
    MEMORY.with_borrow_mut(|m| m.in_interrupt = true);
    INTERRUPT.with_borrow_mut(|interrupt| interrupt.as_mut().map(|run| run()));
    MEMORY.with_borrow_mut(|m| m.in_interrupt = false);
}

/// A moment at which interrupts may come, each with some of the pending stores done.
fn moment() {
    loop {
        let pending = MEMORY.with_borrow(|m| (!m.in_interrupt && m.interrupts > 0).then_some(m.pending.len()));
        let Some(pending) = pending else { return };
        let Some(done) = choose(1 + (1 << pending)).checked_sub(1) else { return };
        MEMORY.with_borrow_mut(|m| {
            m.interrupts -= 1;
            for (at, (word, value)) in std::mem::take(&mut m.pending).into_iter().enumerate() {
                if done >> at & 1 == 1 {
                    // Stores to one word keep their order, so the ones before are done too.
                    m.pending.retain(|(other, _)| *other != word);
                    m.words[word] = value;
                } else {
                    m.pending.push((word, value));
                }
            }
        });
        run_interrupt();
    }
}

/// Keeps the stores before it before those after it.
pub fn compiler_fence(_: Ordering) {
    moment();
    MEMORY.with_borrow_mut(|m| {
        for (word, value) in std::mem::take(&mut m.pending) {
            m.words[word] = value;
        }
    });
}

/// A word of that memory.
pub struct AtomicU32 {
    first: u32,
    /// Its place, beyond 0.
    place: Cell<u32>,
}

impl AtomicU32 {
    pub const fn new(first: u32) -> Self {
        Self { first, place: Cell::new(0) }
    }

    fn place(&self) -> usize {
        if self.place.get() == 0 {
            let place = MEMORY.with_borrow_mut(|m| {
                // The count of events comes first.
                m.words.push(if m.is_stale && !m.words.is_empty() { STALE } else { self.first });
                m.words.len() as u32
            });
            self.place.set(place);
        }
        self.place.get() as usize - 1
    }

    pub fn load(&self, _: Ordering) -> u32 {
        let place = self.place();
        if MEMORY.with_borrow(|m| place < m.shared) {
            moment();
        }
        MEMORY.with_borrow(|m| {
            let own = m.pending.iter().rev().find(|(word, _)| *word == place && !m.in_interrupt);
            own.map_or(m.words[place], |(_, value)| *value)
        })
    }

    pub fn store(&self, value: u32, _: Ordering) {
        let place = self.place();
        MEMORY.with_borrow_mut(|m| {
            if m.in_interrupt || m.interrupts == 0 || place >= m.shared {
                m.words[place] = value;
            } else {
                m.pending.push((place, value));
            }
        });
    }
}
