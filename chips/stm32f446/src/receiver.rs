//! The receiver: DMA carries bytes from a USART into a ring, and nobody is disturbed until the line rests.
//!
//! The DMA writes; the Console reads. Where a byte was damaged or lost, a bit of a second ring says so, and the
//! Console gets [`Received::Lost`] in that place.

use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};

use corehbot::port::Received;
use embassy_stm32::pac::dma::Dma;
use embassy_stm32::pac::dma::vals::{Dir, Pl, Size};
use embassy_stm32::pac::usart::Usart as Registers;

use crate::contexts::wake_console;

/// USART1 on DMA2 and USART2 on DMA1 both have channel 4 (RM0390, tables of DMA1 and DMA2 requests).
const CHANNEL: u8 = 4;

/// Bytes in the ring: 80 ms at 250,000 bits a second, 20 ms at a million.
const SIZE: u32 = 2048;

/// Bytes that the DMA has written. Empty it is all zeros, so it costs no flash.
pub struct Ring {
    bytes: [AtomicU8; SIZE as usize],
    /// A bit for every byte: damaged.
    damaged: [AtomicU32; SIZE as usize / 32],
    /// How often the DMA has come to the end; written by [`Receiver::on_interrupt`].
    laps: AtomicU32,
}

impl Ring {
    /// An empty ring.
    pub const fn new() -> Self {
        Self {
            bytes: [const { AtomicU8::new(0) }; SIZE as usize],
            damaged: [const { AtomicU32::new(0) }; SIZE as usize / 32],
            laps: AtomicU32::new(0),
        }
    }
}

/// A DMA stream.
#[derive(Clone, Copy)]
pub struct Stream {
    dma: Dma,
    number: usize,
}

impl Stream {
    /// Stream `number` of `dma`.
    pub const fn new(dma: Dma, number: usize) -> Self {
        Self { dma, number }
    }
}

/// A ring, the stream that fills it, and how far it was read. The interrupt handlers have one that never reads.
pub struct Receiver {
    stream: Stream,
    ring: &'static Ring,
    /// Bytes ever read, wrapping.
    read: u32,
}

impl Receiver {
    /// Nothing was read so far.
    pub const fn new(stream: Stream, ring: &'static Ring) -> Self {
        Self { stream, ring, read: 0 }
    }

    /// Lets the DMA, which has its clock, wait for bytes of `usart`.
    pub fn start(&self, usart: Registers) {
        let stream = self.stream.dma.st(self.stream.number);
        stream.par().write_value(usart.dr().as_ptr() as u32);
        stream.m0ar().write_value(self.ring.bytes.as_ptr() as u32);
        stream.ndtr().write(|w| w.set_ndt(SIZE as u16));
        stream.cr().write(|w| {
            w.set_chsel(CHANNEL);
            w.set_dir(Dir::PERIPHERAL_TO_MEMORY);
            w.set_psize(Size::BITS8);
            w.set_msize(Size::BITS8);
            w.set_minc(true);
            w.set_circ(true);
            w.set_pl(Pl::HIGH);
            w.set_htie(true);
            w.set_tcie(true);
        });
        stream.cr().modify(|w| w.set_en(true));
    }

    /// Bytes ever written into the ring, wrapping. Within a few cycles after the end of a lap it may be a lap behind.
    fn written(&self) -> u32 {
        loop {
            let laps = self.ring.laps.load(Ordering::Acquire);
            let left = u32::from(self.stream.dma.st(self.stream.number).ndtr().read().ndt());
            if self.ring.laps.load(Ordering::Acquire) == laps {
                return laps.wrapping_mul(SIZE).wrapping_add(SIZE - left);
            }
        }
    }

    /// Marks the byte that came last as damaged. A lost byte followed it, so it is in the damaged line as well.
    pub fn mark_damage(&self) {
        let position = (self.written().wrapping_sub(1) % SIZE) as usize;
        self.ring.damaged[position / 32].fetch_or(1 << (position % 32), Ordering::Release);
    }

    /// The DMA has come to the ring's middle or end.
    pub fn on_interrupt(&self) {
        let (group, place) = (self.stream.number / 4, self.stream.number % 4);
        let flags = self.stream.dma.isr(group).read();
        self.stream.dma.ifcr(group).write(|w| {
            w.set_htif(place, true);
            w.set_tcif(place, true);
        });
        if flags.tcif(place) {
            let laps = &self.ring.laps;
            laps.store(laps.load(Ordering::Relaxed).wrapping_add(1), Ordering::Release);
        }
        wake_console();
    }

    /// The next byte, if one has come.
    pub fn recv(&mut self) -> Option<Received> {
        let waiting = self.written().wrapping_sub(self.read);
        // A lap behind is a negative number.
        if waiting == 0 || waiting.cast_signed() < 0 {
            return None;
        }
        if waiting > SIZE {
            // The DMA has overtaken us: what lies in the ring is of many lines.
            self.read = self.read.wrapping_add(waiting);
            self.ring.damaged.iter().for_each(|bits| bits.store(0, Ordering::Release));
            return Some(Received::Lost);
        }
        let position = (self.read % SIZE) as usize;
        let byte = self.ring.bytes[position].load(Ordering::Acquire);
        let bit = 1 << (position % 32);
        let is_damaged = self.ring.damaged[position / 32].fetch_and(!bit, Ordering::AcqRel) & bit != 0;
        self.read = self.read.wrapping_add(1);
        Some(if is_damaged { Received::Lost } else { Received::Byte(byte) })
    }
}
