//! What the interrupt and the task share.

use crate::shape::PACKET;
use core::cell::{Cell, RefCell};
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_sync::waitqueue::AtomicWaker;

/// A packet from the host.
pub(crate) struct Packet {
    bytes: [u8; PACKET],
    /// Its length, if there is one.
    length: Option<usize>,
    /// The transfer that it ends is over, so that another one may begin.
    is_over: bool,
}

/// What the interrupt and the task share, for `N` endpoints of each direction. `M` holds the interrupt off.
pub struct State<M: RawMutex, const N: usize> {
    pub(crate) bus: AtomicWaker,
    pub(crate) ins: [AtomicWaker; N],
    pub(crate) outs: [AtomicWaker; N],
    packets: [Mutex<M, RefCell<Packet>>; N],
    request: Mutex<M, Cell<Request>>,
    section: M,
}

/// A request that the task has not taken.
#[derive(Clone, Copy)]
enum Request {
    /// There is none.
    None,
    /// Its SETUP packet came; it counts when the stage is over, because another one may follow.
    Arriving([u32; 2]),
    /// It waits for the task.
    Arrived([u32; 2]),
    /// The bus was reset, which ends all requests; the task has not seen it yet.
    Reset,
}

impl<M: RawMutex, const N: usize> Default for State<M, N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<M: RawMutex, const N: usize> State<M, N> {
    /// Nothing has happened yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            bus: AtomicWaker::new(),
            ins: [const { AtomicWaker::new() }; N],
            outs: [const { AtomicWaker::new() }; N],
            packets: [const { Mutex::new(RefCell::new(Packet { bytes: [0; PACKET], length: None, is_over: false })) };
                N],
            request: Mutex::new(Cell::new(Request::None)),
            section: M::INIT,
        }
    }

    /// Does something that the interrupt must not come into.
    pub(crate) fn alone<T>(&self, work: impl FnOnce() -> T) -> T {
        self.section.lock(work)
    }

    /// Keeps the packet of `length` bytes that `words` gives, if there is room for it. All words are read in any case.
    pub(crate) fn keep(&self, n: usize, length: usize, mut word: impl FnMut() -> u32) {
        let count = length.div_ceil(4);
        let Some(packet) = self.packets.get(n).filter(|_| length <= PACKET) else {
            return (0..count).for_each(|_| _ = word());
        };
        packet.lock(|packet| {
            let mut packet = packet.borrow_mut();
            let is_free = packet.length.is_none();
            let mut chunks = packet.bytes.chunks_mut(4);
            for _ in 0..count {
                let bytes = word().to_le_bytes();
                if let Some(chunk) = chunks.next().filter(|_| is_free) {
                    chunk.iter_mut().zip(bytes).for_each(|(place, byte)| *place = byte);
                }
            }
            if is_free {
                (packet.length, packet.is_over) = (Some(length), false);
            }
        });
    }

    /// The transfer of an OUT endpoint is over.
    pub(crate) fn complete(&self, n: usize) {
        if let Some(packet) = self.packets.get(n) {
            packet.lock(|packet| packet.borrow_mut().is_over = true);
        }
    }

    /// Takes the packet of an endpoint into `buffer`: its length, or `Err` if it is longer, which loses it.
    pub(crate) fn take(&self, n: usize, buffer: &mut [u8]) -> Option<Result<usize, ()>> {
        self.packets.get(n)?.lock(|packet| {
            let mut packet = packet.borrow_mut();
            let length = packet.length.filter(|_| packet.is_over)?;
            packet.length = None;
            let taken = buffer.get_mut(..length).zip(packet.bytes.get(..length));
            Some(taken.map_or(Err(()), |(to, from)| {
                to.copy_from_slice(from);
                Ok(length)
            }))
        })
    }

    /// Forgets the packet of an endpoint.
    pub(crate) fn forget(&self, n: usize) {
        if let Some(packet) = self.packets.get(n) {
            packet.lock(|packet| packet.borrow_mut().length = None);
        }
    }

    /// A SETUP packet came.
    pub(crate) fn begin_request(&self, words: [u32; 2]) {
        self.request.lock(|request| request.set(Request::Arriving(words)));
        // The packets of the request before are void.
        self.forget(0);
    }

    /// The SETUP stage is over.
    pub(crate) fn publish(&self) {
        self.request.lock(|request| {
            if let Request::Arriving(words) = request.get() {
                request.set(Request::Arrived(words));
            }
        });
    }

    /// Whether the host has sent another request than the one that the task handles, or has reset the bus.
    pub(crate) fn has_request(&self) -> bool {
        self.request.lock(|request| !matches!(request.get(), Request::None))
    }

    /// Takes a request.
    pub(crate) fn take_request(&self) -> Option<[u8; 8]> {
        let [low, high] = self.request.lock(|request| match request.get() {
            Request::Arrived(words) => {
                request.set(Request::None);
                Some(words.map(u32::to_le_bytes))
            }
            Request::None | Request::Arriving(_) | Request::Reset => None,
        })?;
        let mut bytes = [0; 8];
        bytes.iter_mut().zip(low.into_iter().chain(high)).for_each(|(place, byte)| *place = byte);
        Some(bytes)
    }

    /// The bus was reset: whoever waits for the host in the middle of a request waits in vain.
    pub(crate) fn end_requests(&self) {
        self.request.lock(|request| request.set(Request::Reset));
        self.ins.iter().chain(&self.outs).for_each(AtomicWaker::wake);
    }

    /// The task has seen the reset of the bus.
    pub(crate) fn forget_all(&self) {
        (0..N).for_each(|n| self.forget(n));
        self.request.lock(|request| request.set(Request::None));
    }
}
