//! Requests: a line was asked for, and lines that were already on their way are passed over.
//!
//! After a refusal, a host that sends several lines ahead still sends stale lines. They get only an `ok`, because every
//! request makes such a host send everything again.

use crate::units::Instant;

/// A request is repeated after this time, in case it was lost. For the same time, no line without a number is trusted,
/// because the pieces of a line that false line ends cut follow each other at once. It is independent of the patience
/// of `silence`.
const ASK_AGAIN_MS: u32 = 1000;

/// Stale lines that get only an `ok`. OctoPrint can repeat only its last 50 lines (comm.py, lastLineBufferSize), so the
/// request must be repeated well before that.
pub(super) const STALE_LINES: u8 = 20;

/// An open request for a line.
#[derive(Clone, Copy)]
pub(super) struct Request {
    at: Instant,
    /// The number of the line that was refused last. The numbers of stale lines in one burst rise.
    refused: i32,
    /// Lines passed over since.
    stale: u8,
}

impl Request {
    /// A request made now, because line `refused` came instead.
    pub(super) const fn new(refused: i32, now: Instant) -> Self {
        Self { at: now, refused, stale: 0 }
    }

    /// Whether it was made or repeated recently.
    pub(super) fn is_recent(&self, now: Instant) -> bool {
        now < self.at.after_ms(ASK_AGAIN_MS)
    }

    /// Whether line `number`, which is not the next one, was already on its way when the request was made.
    pub(super) fn passes_over(&mut self, number: i32, now: Instant) -> bool {
        let is_stale = number > self.refused && self.stale < STALE_LINES && self.is_recent(now);
        if is_stale {
            self.refused = number;
            self.stale += 1;
        }
        is_stale
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_that_rise_are_stale() {
        let mut request = Request::new(20, Instant(0));
        assert!((21..=26).all(|number| request.passes_over(number, Instant(0))));
        assert!(!request.passes_over(26, Instant(0)), "the host started over");
        assert!(!request.passes_over(20, Instant(0)));
    }

    #[test]
    fn a_request_lasts_for_a_second_and_for_some_lines() {
        let mut request = Request::new(0, Instant(0));
        assert!(request.passes_over(1, Instant(0).after_ms(ASK_AGAIN_MS - 1)));
        assert!(!request.passes_over(2, Instant(0).after_ms(ASK_AGAIN_MS)));
        let mut request = Request::new(0, Instant(0));
        let refused = (1..).find(|&number| !request.passes_over(number, Instant(0)));
        assert_eq!(refused, Some(i32::from(STALE_LINES) + 1));
    }
}
