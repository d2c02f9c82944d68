//! The probe's state: whether it is out, its servo, and the touch that is under way.

use super::job::ProbeFailure;
use crate::units::Mm;

/// The probe, as far as the firmware has given it orders.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) struct Probing {
    is_out: bool,
    is_in_series: bool,
    is_quick: bool,
    servo: Option<u16>,
    /// z of the nozzle at the begin of the touch that is under way.
    touch_from: Option<Mm>,
    /// Where the probe is to trigger then, if the bed is known.
    awaited: Option<Mm>,
    /// Why the touch that is under way has failed.
    failure: Option<ProbeFailure>,
}

impl Probing {
    /// As after a reset: it is in.
    pub const fn new() -> Self {
        Self {
            is_out: false,
            is_in_series: false,
            is_quick: false,
            servo: None,
            touch_from: None,
            awaited: None,
            failure: None,
        }
    }

    /// Whether it is out.
    pub const fn is_out(&self) -> bool {
        self.is_out
    }

    /// It was put out, or taken in.
    pub const fn note_out(&mut self, is_out: bool) {
        self.is_out = is_out;
    }

    /// Whether other touches came before: the tool is above the bed by the clearance between touches.
    pub const fn is_in_series(&self) -> bool {
        self.is_in_series
    }

    /// Another touch follows, or none.
    pub const fn note_series(&mut self, goes_on: bool) {
        self.is_in_series = goes_on;
    }

    /// A touch begins with the nozzle at this z; `awaited` is z at which the probe is to trigger, if that is known.
    pub const fn begin_touch(&mut self, from: Mm, awaited: Option<Mm>) {
        (self.touch_from, self.awaited) = (Some(from), awaited);
    }

    /// No touch is under way any more. Returns where it began, if one was.
    pub const fn take_touch(&mut self) -> Option<Mm> {
        self.awaited = None;
        self.touch_from.take()
    }

    /// Z of the nozzle at which the probe is to trigger, in a touch of a bed that is known.
    pub const fn awaited(&self) -> Option<Mm> {
        self.awaited
    }

    /// Whether a touch is under way.
    pub const fn is_touching(&self) -> bool {
        self.touch_from.is_some()
    }

    /// The touch that is under way has failed; the first reason counts.
    pub const fn note_failure(&mut self, why: ProbeFailure) {
        if self.failure.is_none() {
            self.failure = Some(why);
        }
    }

    /// Whether it has.
    pub const fn has_failed(&self) -> bool {
        self.failure.is_some()
    }

    /// Why it has, which counts once.
    pub const fn take_failure(&mut self) -> Option<ProbeFailure> {
        self.failure.take()
    }

    /// Whether a BLTouch is not taken in between touches (M401 S1).
    pub const fn is_quick(&self) -> bool {
        self.is_quick
    }

    /// M401 S.
    pub const fn set_quick(&mut self, is_quick: bool) {
        self.is_quick = is_quick;
    }

    /// The servo's last order, in us.
    pub const fn servo(&self) -> Option<u16> {
        self.servo
    }

    /// The servo gets an order.
    pub const fn note_servo(&mut self, micros: Option<u16>) {
        self.servo = micros;
    }
}
