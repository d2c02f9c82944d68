//! When reports come by themselves: M123, M154 and M155, to the host that requested them and at its interval.
//!
//! A report is a whole line, and it is queued only after all earlier output has left. So it comes neither inside a line
//! nor between the lines of one answer, and it does not fill the buffer of a host that does not read.

use crate::settings::Range;
use crate::units::Instant;

/// Seconds between two reports, 0 for never; Marlin's longest time is as long.
pub(in crate::machine) const PERIOD_S: Range<u16> = Range { least: 0, most: 60 };

/// A report that a host may have sent periodically.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum Report {
    /// Where the tool is.
    Position,
    /// How hot everything is.
    Temperatures,
    /// How fast fans turn.
    FanTurns,
}

impl Report {
    /// Its command.
    pub const fn code(self) -> &'static str {
        match self {
            Self::Position => "M154",
            Self::Temperatures => "M155",
            Self::FanTurns => "M123",
        }
    }
}

/// The interval of each [`Report`] for a host.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) struct Schedule {
    /// The period in seconds, 0 for never; and when the next report is due.
    reports: [(u8, Instant); 3],
}

impl Schedule {
    /// Nothing.
    pub const fn new() -> Self {
        Self { reports: [(0, Instant(0)); 3] }
    }

    const fn of(&mut self, report: Report) -> &mut (u8, Instant) {
        let [position, temperatures, fan_turns] = &mut self.reports;
        match report {
            Report::Position => position,
            Report::Temperatures => temperatures,
            Report::FanTurns => fan_turns,
        }
    }

    /// Whether no report is scheduled.
    pub fn is_empty(&self) -> bool {
        self.reports.iter().all(|(period_s, _)| *period_s == 0)
    }

    /// From `now` on every `period_s`.
    pub fn set(&mut self, report: Report, period_s: u8, now: Instant) {
        *self.of(report) = (period_s, now.after_ms(u32::from(period_s) * 1000));
    }

    /// Whether it is time for a report.
    pub fn is_due(&mut self, report: Report, now: Instant) -> bool {
        let (period_s, due) = *self.of(report);
        period_s > 0 && now >= due
    }

    /// A report was made, and the next one is due when its time has passed again.
    pub fn note_told(&mut self, report: Report, now: Instant) {
        let (period_s, _) = *self.of(report);
        self.set(report, period_s, now);
    }
}
