//! The bus of the EEPROM: I2C1 as its only master.
//!
//! Transfers are polled, without interrupts or DMA. 32 bytes take 0.9 ms in the lowest context, and only the Console
//! waits for them. Every wait ends. A line held low, an arbitration lost against noise and a missing chip each give an
//! error. With embassy-stm32's driver a stuck bus stays stuck. Its waits use time alone, which a long interrupt
//! consumes.

use corehbot::port::StorageError;
use embassy_stm32::pac::gpio::vals::Ot;
use embassy_stm32::pac::i2c::regs::Sr1;
use embassy_stm32::pac::i2c::vals::{Duty, FS};
use embassy_stm32::pac::{I2C1, RCC};

use crate::clocks::APB1_HZ;
use crate::ports;
use crate::resources::I2C_FUNCTION;
use crate::wiring::Pin;

/// APB1 in MHz, which the unit wants to know.
const APB1_MHZ: u32 = APB1_HZ / 1_000_000;

/// Clock periods of APB1 in a third of the bus's period: low for two of them, high for one (RM0390, 24.6.8). Rounded
/// up they make 395 kHz, low for 1.7 us and high for 0.8 us. The chip wants 1.3 and 0.6 us (AT24C32E datasheet 8905F,
/// 400 kHz from 1.7 V on).
const THIRD: u32 = APB1_HZ.div_ceil(3 * 400_000);

/// The slowest edge at 400 kHz, 300 ns, in clock periods and one more (RM0390, 24.6.9).
const RISE: u32 = APB1_MHZ * 300 / 1000 + 1;

/// Polls of the status before a wait is given up. A poll takes 10 to 40 cycles of 180 MHz, so the wait is 0.6 to 2.2
/// ms; a byte takes 23 us. The limit counts polls and not time, because time also passes during interrupts, without a
/// poll.
const LOOKS: u32 = 10_000;

/// Half a period of the clock that frees a stuck bus, in cycles of 180 MHz: 5 us, as at 100 kHz.
const HALF: u32 = 900;

/// Clocks after which any chip has sent its byte to the end (I2C specification UM10204, 3.1.16).
const CLOCKS: u32 = 9;

/// Reading begins and ends by special rules; for this many bytes there is but one (RM0390, 24.3.3).
const FEWEST: usize = 3;

/// The bus.
pub struct Bus {
    scl: Pin,
    sda: Pin,
    /// Nothing has gone wrong since it was freed.
    is_sound: bool,
}

/// The chip's acknowledgement of its address.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Answer {
    /// Here I am.
    Here,
    /// Nothing: it is busy, or not there.
    Nothing,
}

type Outcome<T> = Result<T, StorageError>;

impl Bus {
    /// The bus on two pins of I2C1.
    pub fn new(scl: Pin, sda: Pin) -> Self {
        RCC.apb1enr().modify(|w| w.set_i2c1en(true));
        let _ = RCC.apb1enr().read();
        // Free the bus first: a reset in mid-transfer leaves a chip that waits for clocks.
        Self { scl, sda, is_sound: false }
    }

    /// Writes `bytes` to the chip at `address`; without bytes, only asks whether the chip is there.
    ///
    /// # Errors
    /// If the bus does not work, or the chip refuses a byte.
    pub fn write<'a>(&mut self, address: u8, bytes: impl Iterator<Item = &'a u8>) -> Outcome<Answer> {
        self.ready()?;
        let result = Self::send(address, bytes);
        Self::stop();
        self.note(result)
    }

    /// Writes `head`, and reads `into` from there.
    ///
    /// # Errors
    /// If the bus does not work, or the chip refuses a byte.
    pub fn read(&mut self, address: u8, head: [u8; 2], into: &mut [u8]) -> Outcome<Answer> {
        let mut few = [0; FEWEST];
        let few = few.get_mut(..FEWEST).unwrap_or_default();
        self.ready()?;
        let result = match Self::send(address, head.iter()) {
            Ok(Answer::Here) if into.len() < FEWEST => Self::receive(address, few),
            Ok(Answer::Here) => Self::receive(address, into),
            other => {
                Self::stop();
                other
            }
        };
        if into.len() < FEWEST {
            into.iter_mut().zip(few).for_each(|(byte, read)| *byte = *read);
        }
        self.note(result)
    }

    /// Makes the bus ready for a transfer.
    fn ready(&mut self) -> Outcome<()> {
        // A stop may still be on its way, and a line may have been pulled down since.
        let is_free = wait(|_| !I2C1.cr1().read().stop() && !I2C1.sr2().read().busy()).is_ok();
        if !(self.is_sound && is_free && self.is_idle()) {
            self.free()?;
        }
        Ok(())
    }

    /// After an error the bus is freed before it is used again.
    fn note<T>(&mut self, result: Outcome<T>) -> Outcome<T> {
        self.is_sound = result.is_ok();
        result
    }

    /// Whether both lines are released.
    fn is_idle(&self) -> bool {
        ports::is_high(self.scl) && ports::is_high(self.sda)
    }

    /// Clocks a chip to the end of its byte, then sends a stop and restarts the unit. The edges also release a stuck
    /// input filter. The STM32F1 errata sheets describe this fault; we found no such entry for the F446.
    fn free(&mut self) -> Outcome<()> {
        self.is_sound = false;
        for pin in [self.scl, self.sda] {
            // The level first, then open drain, then output: so no line is driven against the chip.
            drive(pin, true);
            ports::registers(pin.port).otyper().modify(|w| w.set_ot(pin.number(), Ot::OPEN_DRAIN));
            ports::make_output(pin);
        }
        pause();
        for _ in 0..CLOCKS {
            // Data that is released can be pulled down by the start below, which ends any transfer.
            if ports::is_high(self.sda) {
                break;
            }
            self.clock();
        }
        // Start and stop: data falls and rises while the clock is high.
        drive(self.sda, false);
        pause();
        self.clock();
        drive(self.sda, true);
        pause();
        [self.scl, self.sda].iter().for_each(|pin| ports::make_alternate(*pin, I2C_FUNCTION));
        // After the lines are released: on a held line BUSY would be set again (RM0390, I2C_CR1, SWRST).
        I2C1.cr1().write(|w| w.set_swrst(true));
        I2C1.cr1().write(|_| ());
        I2C1.cr2().write(|w| w.set_freq(APB1_MHZ as u8));
        // Timing can be set only while the unit is off (RM0390, 24.6.8 and 24.6.9).
        I2C1.ccr().write(|w| {
            w.set_f_s(FS::FAST);
            w.set_duty(Duty::DUTY2_1);
            w.set_ccr(THIRD as u16);
        });
        I2C1.trise().write(|w| w.set_trise(RISE as u8));
        I2C1.cr1().write(|w| w.set_pe(true));
        self.is_sound = self.is_idle();
        if self.is_sound { Ok(()) } else { Err(StorageError::Failed) }
    }

    /// One clock by hand.
    fn clock(&self) {
        drive(self.scl, false);
        pause();
        drive(self.scl, true);
        pause();
    }

    /// Start, address and bytes, without a stop.
    fn send<'a>(address: u8, bytes: impl Iterator<Item = &'a u8>) -> Outcome<Answer> {
        if begin(address << 1)? == Answer::Nothing {
            return Ok(Answer::Nothing);
        }
        for byte in bytes {
            wait(Sr1::txe)?;
            I2C1.dr().write(|w| w.set_dr(*byte));
            // TXE would come earlier, but with BTF a refusal by the chip belongs to its own byte.
            wait(Sr1::btf)?;
        }
        Ok(Answer::Here)
    }

    /// Repeated start, address and at least [`FEWEST`] bytes, then a stop. Where the order matters, the unit holds the
    /// clock low, so that no interrupt comes in between (RM0390, 24.3.3, closing the communication).
    fn receive(address: u8, into: &mut [u8]) -> Outcome<Answer> {
        match begin(address << 1 | 1) {
            Ok(Answer::Here) => {}
            other => {
                Self::stop();
                return other;
            }
        }
        let last = into.len().saturating_sub(FEWEST);
        for (place, byte) in into.iter_mut().enumerate() {
            let has_come = match place {
                _ if place < last => wait(Sr1::rxne),
                // This one and the next have come: from here on no more bytes are wanted.
                _ if place == last => {
                    let come = wait(Sr1::btf);
                    I2C1.cr1().modify(|w| w.set_ack(false));
                    come
                }
                _ if place == last + 1 => {
                    let come = wait(Sr1::btf);
                    Self::stop();
                    come
                }
                _ => wait(Sr1::rxne),
            };
            if has_come.is_err() {
                Self::stop();
                has_come?;
            }
            *byte = I2C1.dr().read().dr();
        }
        Ok(Answer::Here)
    }

    fn stop() {
        I2C1.cr1().modify(|w| w.set_stop(true));
    }
}

/// A start, or another one, and the address with the direction.
fn begin(address: u8) -> Outcome<Answer> {
    I2C1.cr1().modify(|w| {
        w.set_ack(true);
        w.set_start(true);
    });
    wait(Sr1::start)?;
    I2C1.dr().write(|w| w.set_dr(address));
    wait(|status| status.addr() || status.af())?;
    if I2C1.sr1().read().af() {
        I2C1.sr1().write(clear_errors);
        return Ok(Answer::Nothing);
    }
    // Reading both status registers clears the flag, and the transfer continues.
    let _ = I2C1.sr2().read();
    Ok(Answer::Here)
}

/// Waits for `what`. A bus error that the unit reports as master is ignored (ES0298, spurious bus error in master
/// mode).
fn wait(what: impl Fn(&Sr1) -> bool) -> Outcome<()> {
    for _ in 0..LOOKS {
        let status = I2C1.sr1().read();
        if what(&status) {
            return Ok(());
        }
        if status.arlo() || status.af() {
            break;
        }
    }
    I2C1.sr1().write(clear_errors);
    Err(StorageError::Failed)
}

/// Writing 0 clears errors; writing 1 to a flag has no effect.
const fn clear_errors(w: &mut Sr1) {
    w.0 = 0;
}

fn drive(pin: Pin, is_high: bool) {
    ports::store(ports::registers(pin.port), if is_high { pin.mask() } else { pin.mask() << 16 });
}

fn pause() {
    cortex_m::asm::delay(HALF);
}
