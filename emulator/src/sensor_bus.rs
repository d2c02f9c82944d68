//! SPI3 with its two DMA streams: rules of the manual that the crate's model does not enforce.
//!
//! The crate models the bus, the streams and the time that a byte takes; [`Sensor`](crate::sensor::Sensor) is at its
//! end. This file has the rules for the order of writes and for pins. Their sources are RM0390 rev 6 (chapters of the
//! SPI, the DMA and the ports) and the data sheets of both sensors.
//!
//! | rule | source |
//! |---|---|
//! | a sensor is selected only while the bus is on as its master | serial communications of both sensors |
//! | the bus is in mode 3 then, with frames of eight bits, the highest first | the same |
//! | the clock is 5 MHz at most | ADXL345, f_SCLK; a LIS2DW12 takes 10 MHz |
//! | the pins belong to the bus, and the sensor's line is pulled up | ports: MODER, PUPDR |
//! | the clock's edges are the steepest | errata: data corrupted by delayed SCK feedback |
//! | the sensor is let go when the bus is at rest | BSY flag |
//! | nothing of the bus changes while it is on | SPI_CR1 |
//! | the bus is switched off while both streams are | communication using DMA |
//! | a stream starts with cleared flags and a count; the input starts first | stream configuration procedure |
//! | a stream keeps its configuration while it runs | DMA_SxCR |
//! | no byte is lost | OVR flag |

use crate::board::{Emulated, Port};
use crate::wiring::{Pin, SensorPins};
use rigless::emulator::Access;
use rigless::mcu::Operate;
use rigless::soc::Width;
use rigless::time::VirtualNanos;

/// Where the registers are (RM0390 rev 6, section 2.2.2 and the register maps).
const SPI: u64 = 0x4000_3C00;
const CR1: u64 = SPI;
const SR: u64 = SPI + 8;
const DMA: u64 = 0x4002_6000;
const LISR: u64 = DMA;
const HISR: u64 = DMA + 4;
const INPUT: u64 = DMA + 0x10;
const OUTPUT: u64 = DMA + 0x10 + 7 * 0x18;
/// From a stream's control register to its counter.
const COUNT: u64 = 4;

/// SPI_CR1: CPHA, CPOL, MSTR, BR, SPE, LSBFIRST, DFF.
const MODE_3: u64 = 3;
const MASTER: u64 = 1 << 2;
const ENABLE: u64 = 1 << 6;
const LAST_FIRST: u64 = 1 << 7;
const SIXTEEN: u64 = 1 << 11;

/// SPI_SR.
const OVERRUN: u64 = 1 << 6;
const BUSY: u64 = 1 << 7;

/// The fastest clock in Hz.
const FASTEST: u64 = 5_000_000;

/// SPI3's alternate function on these pins (STM32F446 datasheet, table of alternate functions).
const FUNCTION: u64 = 6;

/// The bus, if the board has a connector for it.
#[derive(Clone, Default, Debug)]
pub struct SensorBus {
    pins: Option<SensorPins>,
    is_selected: bool,
    /// CR1 as it was written last, and the control registers of both streams.
    control: u64,
    streams: [u64; 2],
    /// What the firmware did against the manual, each once.
    pub breaches: Vec<&'static str>,
}

impl SensorBus {
    /// A bus that was never used.
    #[must_use]
    pub fn new(pins: Option<SensorPins>) -> Self {
        Self { pins, ..Self::default() }
    }

    /// The chip was reset.
    pub fn reset(&mut self) {
        (self.is_selected, self.control, self.streams) = (false, 0, [0; 2]);
    }

    fn check(&mut self, is_kept: bool, rule: &'static str) {
        if !is_kept && !self.breaches.contains(&rule) {
            self.breaches.push(rule);
        }
    }

    /// Port `n` was written to.
    pub fn store(&mut self, board: &mut Emulated, at: VirtualNanos, n: usize, port: Port) {
        let Some(pins) = self.pins.filter(|pins| pins.select.port == n) else { return };
        let is_selected = port.low() & pins.select.mask() != 0;
        if std::mem::replace(&mut self.is_selected, is_selected) == is_selected {
            return;
        }
        let status = peek(board, at, SR);
        self.check(status & BUSY == 0, "the sensor is selected or let go in the middle of a byte");
        self.check(status & OVERRUN == 0, "a byte was lost");
        if !is_selected {
            return;
        }
        let wanted = ENABLE | MASTER | MODE_3;
        let is_mode = self.control & (wanted | LAST_FIRST | SIXTEEN) == wanted;
        self.check(is_mode, "the sensor is selected while the bus is off or in another mode");
        let [_, apb1, _] = board.mcu.rates();
        self.check(apb1 >> (1 + (self.control >> 3 & 7)) <= FASTEST, "the clock is too fast for the sensor");
        for pin in [pins.clock, pins.miso, pins.mosi] {
            let is_connected = field(board, at, pin, MODER, 2) == 2 && function(board, at, pin) == FUNCTION;
            self.check(is_connected, "a pin does not belong to the bus");
        }
        self.check(field(board, at, pins.miso, PUPDR, 2) == 1, "the line from the sensor is not pulled up");
        self.check(field(board, at, pins.clock, OSPEEDR, 2) == 3, "the edges of the clock are not the steepest");
    }

    /// The firmware wrote to a register.
    pub fn written(&mut self, board: &mut Emulated, access: &Access) {
        let (at, value) = (access.virtual_time, access.value);
        match access.address {
            CR1 => {
                let before = std::mem::replace(&mut self.control, value);
                let is_running = self.streams_run(board, at);
                self.check(before & value & ENABLE == 0 || before == value, "the bus changes while it is on");
                self.check(before & !value & ENABLE == 0 || !is_running, "the bus is switched off before its streams");
            }
            INPUT | OUTPUT => {
                let which = usize::from(access.address == OUTPUT);
                let before = std::mem::replace(&mut self.streams[which], value);
                if value & 1 == 0 {
                    return;
                }
                let was_running = before & 1 != 0 && before == value;
                self.check(was_running || before & !1 == value & !1, "a stream starts and changes in one write");
                if which == 1 {
                    // It is on until the last byte has come, which takes time.
                    self.check(peek(board, at, INPUT) & 1 != 0, "the output starts before the input");
                    return;
                }
                let flags = peek(board, at, LISR) & 0x3D | peek(board, at, HISR) >> 22 & 0x3D;
                self.check(flags == 0, "a stream starts with flags of its last transfer");
                self.check(peek(board, at, INPUT + COUNT) != 0, "a stream starts without a count");
            }
            _ => {}
        }
    }

    fn streams_run(&self, board: &mut Emulated, at: VirtualNanos) -> bool {
        self.pins.is_some() && (peek(board, at, INPUT) | peek(board, at, OUTPUT)) & 1 != 0
    }
}

/// Registers of a port (RM0390 rev 6, section 7.4).
const MODER: u64 = 0;
const OSPEEDR: u64 = 8;
const PUPDR: u64 = 0x0C;
const AFRL: u64 = 0x20;

fn field(board: &mut Emulated, at: VirtualNanos, pin: Pin, register: u64, bits: u8) -> u64 {
    peek(board, at, 0x4002_0000 + 0x400 * pin.port as u64 + register) >> (bits * pin.bit) & ((1 << bits) - 1)
}

fn function(board: &mut Emulated, at: VirtualNanos, pin: Pin) -> u64 {
    let half = Pin { bit: pin.bit % 8, ..pin };
    field(board, at, half, AFRL + 4 * u64::from(pin.bit / 8), 4)
}

fn peek(board: &mut Emulated, at: VirtualNanos, address: u64) -> u64 {
    board.mcu.peek(at, address, Width::W32).unwrap_or(0)
}
