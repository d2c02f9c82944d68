//! An exchange on one wire: a request's bits out, a reply's bits in, tick by tick.
//!
//! Plain code without a clock: a timer ticks, and this code says the wire's next action and the time of the next tick.
//! While sending, a bit is one tick. While listening, the line is sampled [`OVERSAMPLING`] times a bit until a start
//! bit is seen, and then once in the middle of each bit. Every exchange ends by itself after a time that is known at
//! its begin, regardless of the line. The exception is a masked interrupt (`interrupt_storm`):
//! the machine has stopped then.
//!
//! A bit at [`BAUD`] lasts 52 us. A tick that is late by J moves one edge or sample, but no later tick, because the
//! timer runs on. The budget is half a bit, 26 us:
//!
//! - Sending: the driver measures the bit length over four bits of the sync nibble, so a late tick makes it wrong by J
//!   / 4. Its last sample comes 9.5 bits later and is wrong by 9.5 J / 4 = 2.4 J. This byte's start bit and the edge
//!   next to the sample may each be late by another J, but only one of them counts. The sum is 3.4 J, so J may be 7.7
//!   us.
//! - Listening: the driver sends with the bit length that it measured, so a stop bit may end 2.5 J early. A start bit
//!   is detected within a tick, and half a tick counts, 5.2 us. The sample is late by J. The sum is 5.2 us + 3.5 J, so
//!   J may be 5.9 us.
//!
//! A clock difference of 2 %, in addition to the effect of J, leaves 2.9 us. In the emulator, which has no flash wait
//! states, J is 2 us at rest, 3 us in a print and 5 us at 100,000 step events a second. The stop bit or the datagram's
//! checksum detects data that is garbled anyway.

use corehbot::port::{BusError, Frame};

/// Bits a second. TMC2209 datasheet rev 1.09, section 4.1.1: 9,000 at the least. Twice as many would halve how late a
/// tick may be, half as many would take 13 ms instead of 7 to read a register.
pub const BAUD: u32 = 19_200;

/// Samples in a bit while a start bit is waited for. Odd, so that the middle of a bit is a whole number of samples
/// after the middle of the time between two samples in which its edge was. Three would spend 3.5 us more of half a bit.
pub const OVERSAMPLING: u8 = 5;

/// From the first low sample to the middle of the start bit, in samples.
const TO_MIDDLE: u8 = OVERSAMPLING / 2;

/// Bit times of an idle line before a request. TMC2209 datasheet rev 1.09, sections 4.1.1 and 4.1.2: a driver releases
/// the line four bit times after its reply. After 12 idle bit times it resets its receiver.
const REST: u8 = 12;

/// The same after an exchange that failed or was given up. The driver may still send the eight bytes of a reply. Or it
/// may wait for the rest of a request, which it gives up after 63 bit times (section 4.1.1).
const LONG_REST: u8 = 80 + REST;

/// Bit times that a reply may take longer than its bits, and in which it must have begun. It begins after eight
/// (TMC2209 datasheet rev 1.09, section 4.1.2, SENDDELAY as it is after reset, and as the firmware sets it before it
/// asks anything).
const LATE: u16 = 24;

/// Bits of a byte with its start and stop bit.
const BYTE: u16 = 10;

/// Remainder of a byte after all its bits were sent.
const SENT: u16 = 1;

/// The stop bit of a byte to be sent, and the mark that ends up as [`SENT`].
const STOP: u16 = 0b11 << 9;

/// No start bit was seen.
const WAITING: u16 = 0;

/// A byte's first sample is due. Samples are shifted in from above, and after ten of them this bit is [`TAKEN`].
const STARTED: u16 = 1 << 15;

/// Says that all ten samples were taken: start bit in bit 6, stop bit in bit 15.
const TAKEN: u16 = 1 << 5;

/// The start bit was high in its middle: it was a pulse.
const FALSE_START: u16 = 1 << 15 | STARTED >> 1;

/// The next action of the line.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Action {
    /// The line stays as it is.
    Stay,
    /// The line is driven high, after it was released.
    Take,
    /// The level of a bit.
    Drive {
        /// Whether it is high.
        is_high: bool,
    },
    /// The line is released, and from now on ticks come [`OVERSAMPLING`] times a bit.
    Listen,
    /// The line stays as it is. From this tick on, ticks come this many samples apart.
    Sample(u8),
    /// The line is released, and no more ticks are needed: there is an outcome.
    End,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Phase {
    Idle,
    Resting,
    Sending,
    Listening,
}

/// The current exchange, or its outcome.
#[derive(Debug)]
pub struct Exchange {
    phase: Phase,
    /// Bit times of rest, or samples from the tick before to this one.
    count: u8,
    /// The byte under way, as bits to be sent or samples taken.
    bits: u16,
    request: Frame,
    sent: usize,
    wanted: usize,
    reply: Frame,
    /// Samples until the reply must be complete.
    patience: u16,
    outcome: Option<Result<Frame, BusError>>,
    is_clean: bool,
}

impl Exchange {
    /// No exchange yet.
    #[must_use]
    #[allow(clippy::new_without_default, reason = "boards make it in a `const`")]
    pub const fn new() -> Self {
        Self {
            phase: Phase::Idle,
            count: 0,
            bits: SENT,
            request: Frame::new(),
            sent: 0,
            wanted: 0,
            reply: Frame::new(),
            patience: 0,
            outcome: None,
            // A reset may have cut a request short.
            is_clean: false,
        }
    }

    /// Begins an exchange, and drops the previous one. The line is released, and ticks come once a bit.
    pub fn begin(&mut self, request: &Frame, reply: usize) {
        let was_clean = self.is_clean && self.phase == Phase::Idle;
        self.count = if was_clean { REST } else { LONG_REST };
        self.bits = SENT;
        self.request.clone_from(request);
        self.sent = 0;
        self.wanted = reply.min(self.reply.capacity());
        self.reply.clear();
        self.patience = (LATE + self.wanted as u16 * BYTE) * u16::from(OVERSAMPLING);
        self.outcome = None;
        self.phase = Phase::Resting;
    }

    /// Aborts the current exchange, if any, without an outcome.
    pub fn fail(&mut self) {
        let _ = self.end(Err(BusError::Silent));
    }

    /// How it ended, said once.
    pub fn outcome(&mut self) -> Option<Result<Frame, BusError>> {
        self.outcome.take()
    }

    /// A tick, at which the line is high or not.
    #[inline]
    pub fn tick(&mut self, is_high: bool) -> Action {
        match self.phase {
            Phase::Idle => Action::End,
            Phase::Resting => self.rest(),
            Phase::Sending => self.send(),
            Phase::Listening => self.listen(is_high),
        }
    }

    fn rest(&mut self) -> Action {
        self.count -= 1;
        if self.count > 0 {
            return Action::Stay;
        }
        self.phase = Phase::Sending;
        Action::Take
    }

    fn send(&mut self) -> Action {
        if self.bits == SENT {
            let Some(byte) = self.request.get(self.sent) else { return self.end_of_request() };
            self.bits = STOP | u16::from(*byte) << 1;
            self.sent += 1;
        }
        let is_high = self.bits & 1 != 0;
        self.bits >>= 1;
        Action::Drive { is_high }
    }

    fn end_of_request(&mut self) -> Action {
        if self.wanted == 0 {
            return self.end(Ok(()));
        }
        self.phase = Phase::Listening;
        self.bits = WAITING;
        self.count = 1;
        Action::Listen
    }

    fn listen(&mut self, is_high: bool) -> Action {
        self.patience = self.patience.saturating_sub(u16::from(self.count));
        if self.patience == 0 || self.is_unanswered() {
            return self.end(Err(BusError::Silent));
        }
        if self.bits == WAITING {
            if is_high {
                return Action::Stay;
            }
            self.bits = STARTED;
            return self.sample_after(TO_MIDDLE);
        }
        self.bits = self.bits >> 1 | u16::from(is_high) << 15;
        if self.bits == FALSE_START {
            self.bits = WAITING;
            self.sample_after(1)
        } else if self.bits & TAKEN != 0 {
            self.take_byte()
        } else {
            self.sample_after(OVERSAMPLING)
        }
    }

    /// Whether no reply has begun while a reply could still begin: the remaining time is the length of a reply.
    fn is_unanswered(&self) -> bool {
        let of_reply = self.wanted as u16 * BYTE * u16::from(OVERSAMPLING);
        self.bits == WAITING && self.reply.is_empty() && self.patience <= of_reply
    }

    /// The next tick comes this many samples after the current one.
    const fn sample_after(&mut self, samples: u8) -> Action {
        if self.count == samples {
            return Action::Stay;
        }
        self.count = samples;
        Action::Sample(samples)
    }

    fn take_byte(&mut self) -> Action {
        let (byte, is_whole) = ((self.bits >> 7) as u8, self.bits >> 15 != 0);
        self.bits = WAITING;
        if !is_whole || self.reply.push(byte).is_err() {
            return self.end(Err(BusError::Garbled));
        }
        if self.reply.len() < self.wanted { self.sample_after(1) } else { self.end(Ok(())) }
    }

    fn end(&mut self, result: Result<(), BusError>) -> Action {
        self.phase = Phase::Idle;
        self.is_clean = result.is_ok();
        self.outcome = Some(result.map(|()| self.reply.clone()));
        Action::End
    }
}

#[cfg(test)]
mod tests;
