//! The receiver: DMA carries bytes from USART2 into a ring, and nobody is disturbed until the line rests.
//!
//! DMA1 stream 5, channel 4 (RM0390, table of DMA1 requests) writes; the Console reads. Where a byte was
//! damaged or lost, a bit of a second ring says so, and the Console gets [`Received::Lost`] in that place.

use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};

use corehbot::port::Received;
use embassy_stm32::interrupt;
use embassy_stm32::pac::dma::vals::{Dir, Pl, Size};
use embassy_stm32::pac::{DMA1, Interrupt, RCC, USART2};

use crate::contexts::wake_console;

/// The interrupt at both ends and the middle of the ring.
pub const IRQ: Interrupt = Interrupt::DMA1_STREAM5;

/// DMA1 stream 5 is connected to USART2's receiver by channel 4.
const STREAM: usize = 5;
const CHANNEL: u8 = 4;

/// Bytes in the ring: 80 ms at 250,000 bits a second, 20 ms at a million.
const SIZE: u32 = 2048;

static RING: [AtomicU8; SIZE as usize] = [const { AtomicU8::new(0) }; SIZE as usize];

/// A bit for every byte of the ring: damaged.
static DAMAGED: [AtomicU32; SIZE as usize / 32] = [const { AtomicU32::new(0) }; SIZE as usize / 32];

/// How often the DMA has come to the ring's end; written by [`DMA1_STREAM5`].
static LAPS: AtomicU32 = AtomicU32::new(0);

/// Lets the DMA wait for bytes.
pub fn start() {
    RCC.ahb1enr().modify(|w| w.set_dma1en(true));
    let _ = RCC.ahb1enr().read();
    let stream = DMA1.st(STREAM);
    stream.par().write_value(USART2.dr().as_ptr() as u32);
    stream.m0ar().write_value(RING.as_ptr() as u32);
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
fn written() -> u32 {
    loop {
        let laps = LAPS.load(Ordering::Acquire);
        let left = u32::from(DMA1.st(STREAM).ndtr().read().ndt());
        if LAPS.load(Ordering::Acquire) == laps {
            return laps.wrapping_mul(SIZE).wrapping_add(SIZE - left);
        }
    }
}

/// Marks the byte that came last as damaged. A lost byte followed it, so it is in the damaged line as well.
pub fn mark_damage() {
    let position = (written().wrapping_sub(1) % SIZE) as usize;
    DAMAGED[position / 32].fetch_or(1 << (position % 32), Ordering::Release);
}

/// The Console's end of the ring.
pub struct Receiver {
    /// Bytes ever read, wrapping.
    read: u32,
}

impl Receiver {
    /// Nothing was read so far.
    pub const fn new() -> Self {
        Self { read: 0 }
    }

    /// The next byte, if one has come.
    pub fn recv(&mut self) -> Option<Received> {
        let waiting = written().wrapping_sub(self.read);
        // A lap behind is a negative number.
        if waiting == 0 || waiting.cast_signed() < 0 {
            return None;
        }
        if waiting > SIZE {
            // The DMA has overtaken us: what lies in the ring is of many lines.
            self.read = self.read.wrapping_add(waiting);
            return Some(Received::Lost);
        }
        let position = (self.read % SIZE) as usize;
        let byte = RING[position].load(Ordering::Acquire);
        let bit = 1 << (position % 32);
        let is_damaged = DAMAGED[position / 32].fetch_and(!bit, Ordering::AcqRel) & bit != 0;
        self.read = self.read.wrapping_add(1);
        Some(if is_damaged { Received::Lost } else { Received::Byte(byte) })
    }
}

#[interrupt]
fn DMA1_STREAM5() {
    let flags = DMA1.isr(STREAM / 4).read();
    DMA1.ifcr(STREAM / 4).write(|w| {
        w.set_htif(STREAM % 4, true);
        w.set_tcif(STREAM % 4, true);
    });
    if flags.tcif(STREAM % 4) {
        LAPS.store(LAPS.load(Ordering::Relaxed).wrapping_add(1), Ordering::Release);
    }
    wake_console();
}
