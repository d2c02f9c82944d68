//! A BLTouch: a pin that orders put out and take in, and that goes in by itself when it touches.
//!
//! | state | its output | ends |
//! |---|---|---|
//! | in | low; high in touch mode | by the order to put the pin out, [`WAY`] later |
//! | out | low | by a touch, or the order to take the pin in |
//! | touched | high for a pulse; in touch mode until the next order | with the pulse: in |
//! | alarm | high | by the order to reset |
//!
//! The orders are lengths of a servo's pulses (Marlin, `bltouch.h`; Klipper, `bltouch.py`, has them 5 us longer or
//! shorter). In touch mode the output says whether the pin is in, by which Klipper verifies a raise. A pin that meets
//! the bed on its way out goes to alarm (ANTClabs, BLTouch V3.1, "Alarm").

use corehbot::units::TICKS_PER_MS;

/// Ticks in a millisecond.
const MS: u64 = TICKS_PER_MS as u64;

/// The pin's way in or out: 0.2 s. Firmwares wait for 0.68 s and more.
pub const WAY: u64 = 200 * MS;

/// An order is obeyed after three of its pulses: 60 ms.
pub const HEARD: u64 = 60 * MS;

/// A pulse that is so far from an order, in us, is still that order: two are 100 us apart at least.
const TOLERANCE: u16 = 20;

/// An order.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Order {
    /// The pin goes out.
    Deploy,
    /// Touch mode begins.
    Touch,
    /// The pin goes in, and touch mode ends.
    Stow,
    /// The pin goes out and in by itself, and ends in.
    SelfTest,
    /// Ends an alarm, and touch mode; the pin goes in.
    Reset,
}

/// The orders, by the length of a pulse in us.
pub const ORDERS: [(u16, Order); 5] =
    [(647, Order::Deploy), (1163, Order::Touch), (1472, Order::Stow), (1781, Order::SelfTest), (2194, Order::Reset)];

/// The order of pulses of so many us, if it is one.
#[must_use]
pub fn order_of(micros: u16) -> Option<Order> {
    ORDERS.into_iter().find(|(known, _)| known.abs_diff(micros) <= TOLERANCE).map(|(_, order)| order)
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum State {
    /// The pin is in.
    In,
    /// It is on its way out, until that time.
    GoingOut(u64),
    /// It is out.
    Out,
    /// It has touched; the pulse ends at that time.
    Touched(u64),
    Alarm,
}

/// The probe.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BlTouch {
    state: State,
    is_touch_mode: bool,
    /// Length of the pulse of a touch, in ticks.
    pulse: u64,
    /// An order that it has begun to hear, and when it obeys.
    heard: Option<(Order, u64)>,
}

impl BlTouch {
    /// One with its pin in, and with such a pulse in ticks.
    #[must_use]
    pub const fn new(pulse: u64) -> Self {
        Self { state: State::In, is_touch_mode: false, pulse, heard: None }
    }

    /// From `now` on pulses of so many us come, or none. An order that is not heard out is not obeyed.
    pub fn hear(&mut self, now: u64, micros: Option<u16>, is_touching: bool) {
        self.pass(now, is_touching);
        self.heard = micros.and_then(order_of).map(|order| (order, now + HEARD));
    }

    /// Time has come to `now`; `is_touching` is whether a pin that is out touches the bed.
    pub fn pass(&mut self, now: u64, is_touching: bool) {
        if let Some((order, at)) = self.heard.filter(|(_, at)| *at <= now) {
            self.heard = None;
            self.obey(order, at);
        }
        match self.state {
            State::GoingOut(at) if at <= now => self.state = if is_touching { State::Alarm } else { State::Out },
            State::Touched(end) if end <= now && !self.is_touch_mode => self.state = State::In,
            State::Out if is_touching => self.state = State::Touched(now + self.pulse),
            _ => {}
        }
    }

    fn obey(&mut self, order: Order, at: u64) {
        if self.state == State::Alarm && order != Order::Reset {
            return;
        }
        match order {
            Order::Deploy if self.state == State::Out => self.is_touch_mode = false,
            Order::Deploy => (self.state, self.is_touch_mode) = (State::GoingOut(at + WAY), false),
            Order::Touch => self.is_touch_mode = true,
            Order::Stow | Order::SelfTest | Order::Reset => (self.state, self.is_touch_mode) = (State::In, false),
        }
    }

    /// An alarm begins.
    pub const fn alarm(&mut self) {
        self.state = State::Alarm;
    }

    /// Whether its output is high.
    #[must_use]
    pub const fn is_high(&self) -> bool {
        match self.state {
            State::In => self.is_touch_mode,
            State::GoingOut(_) | State::Out => false,
            State::Touched(_) | State::Alarm => true,
        }
    }

    /// Whether its pin is out.
    #[must_use]
    pub const fn is_out(&self) -> bool {
        matches!(self.state, State::GoingOut(_) | State::Out)
    }

    /// When its output may change by itself, if it may.
    #[must_use]
    pub fn next(&self) -> Option<u64> {
        let own = match self.state {
            State::GoingOut(at) | State::Touched(at) => Some(at),
            State::In | State::Out | State::Alarm => None,
        };
        self.heard.map(|(_, at)| at).into_iter().chain(own).min()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(probe: &mut BlTouch, now: &mut u64, micros: u16) {
        probe.hear(*now, Some(micros), false);
        *now += 700 * MS;
        probe.pass(*now, false);
    }

    #[test]
    fn a_touch_is_a_pulse_and_takes_the_pin_in() {
        for pulse in [10 * MS, 5 * MS] {
            let (mut probe, mut now) = (BlTouch::new(pulse), 0);
            after(&mut probe, &mut now, 650);
            assert!(probe.is_out() && !probe.is_high());
            probe.pass(now, true);
            assert!(probe.is_high() && !probe.is_out());
            assert_eq!(probe.next(), Some(now + pulse));
            probe.pass(now + pulse - 1, true);
            assert!(probe.is_high());
            probe.pass(now + pulse, true);
            assert!(!probe.is_high() && !probe.is_out());
        }
    }

    #[test]
    fn touch_mode_says_whether_the_pin_is_in() {
        let (mut probe, mut now) = (BlTouch::new(10 * MS), 0);
        after(&mut probe, &mut now, 1163);
        assert!(probe.is_high());
        after(&mut probe, &mut now, 647);
        after(&mut probe, &mut now, 1163);
        assert!(!probe.is_high() && probe.is_out());
        probe.pass(now, true);
        now += 50 * MS;
        probe.pass(now, true);
        assert!(probe.is_high());
        after(&mut probe, &mut now, 1472);
        assert!(!probe.is_high());
    }

    #[test]
    fn a_pin_that_meets_the_bed_on_its_way_is_an_alarm_until_a_reset() {
        let (mut probe, mut now) = (BlTouch::new(10 * MS), 0);
        probe.hear(now, Some(647), true);
        now += 700 * MS;
        probe.pass(HEARD, true);
        probe.pass(now, true);
        assert!(probe.is_high());
        after(&mut probe, &mut now, 1472);
        assert!(probe.is_high());
        after(&mut probe, &mut now, 2190);
        assert!(!probe.is_high() && !probe.is_out());
    }

    #[test]
    fn an_order_is_heard_in_three_pulses_and_others_are_none() {
        let mut probe = BlTouch::new(10 * MS);
        probe.hear(0, Some(647), false);
        probe.hear(HEARD - 1, None, false);
        probe.pass(10 * HEARD, false);
        assert!(!probe.is_out());
        assert_eq!(
            [600, 627, 667, 1000, 1884].map(order_of),
            [None, Some(Order::Deploy), Some(Order::Deploy), None, None]
        );
    }
}
