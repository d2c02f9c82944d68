//! The receiver: DMA carries bytes from a USART into a ring, without an interrupt until the line is idle.
//!
//! Where a byte was damaged or lost, the Console gets [`Received::Lost`] in that place.

use corehbot::port::Received;
use embassy_stm32::pac::dma::Dma;
use embassy_stm32::pac::dma::vals::{Dir, Pl, Size};
use embassy_stm32::pac::usart::Usart as Registers;

use crate::console_waker::wake_console;
use crate::resources::Channel;
use corehbot_board_support::ring::{Ring, SIZE};

/// A ring, the DMA stream that fills it, and the read position. The interrupt handlers have one that never reads.
pub struct Receiver {
    dma: Dma,
    channel: Channel,
    ring: &'static Ring,
    /// Bytes ever read, wrapping.
    read: u32,
    /// The same of bytes ever overheard; less than `read` if none after these were.
    heard: u32,
}

impl Receiver {
    /// Nothing was read so far.
    pub const fn new(dma: Dma, channel: Channel, ring: &'static Ring) -> Self {
        Self { dma, channel, ring, read: 0, heard: 0 }
    }

    /// Lets the DMA, which has its clock, wait for bytes of `usart`.
    pub fn start(&self, usart: Registers) {
        let stream = self.dma.st(self.channel.stream);
        stream.par().write_value(usart.dr().as_ptr() as u32);
        stream.m0ar().write_value(self.ring.bytes.as_ptr() as u32);
        stream.ndtr().write(|w| w.set_ndt(SIZE as u16));
        stream.cr().write(|w| {
            w.set_chsel(self.channel.request);
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

    fn written(&self) -> u32 {
        self.ring.written(|| u32::from(self.dma.st(self.channel.stream).ndtr().read().ndt()))
    }

    /// A byte was damaged, or cleared with an error.
    pub fn mark_damage(&self) {
        self.ring.mark_damage(self.written());
    }

    /// The DMA has reached the ring's middle or end.
    pub fn on_interrupt(&self) {
        let (group, place) = (self.channel.stream / 4, self.channel.stream % 4);
        let flags = self.dma.isr(group).read();
        self.dma.ifcr(group).write(|w| {
            w.set_htif(place, true);
            w.set_tcif(place, true);
        });
        if flags.tcif(place) {
            self.ring.end_lap();
        }
        wake_console();
    }

    /// Whether the next byte was overheard.
    pub const fn was_overheard(&self) -> bool {
        self.heard.wrapping_sub(self.read).cast_signed() > 0
    }

    /// The next byte that has come and was neither read nor overheard.
    pub fn overhear(&mut self) -> Option<Received> {
        if !self.was_overheard() {
            self.heard = self.read;
        }
        let written = self.written();
        self.ring.overhear(&mut self.heard, written)
    }

    /// The next byte, if one has come.
    pub fn recv(&mut self) -> Option<Received> {
        let written = self.written();
        self.ring.take(&mut self.read, written)
    }
}
