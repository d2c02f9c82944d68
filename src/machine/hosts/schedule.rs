//! Reports that come by themselves: M154 and M155, to the host that asked for them and as often as it asked.
//!
//! A report is a whole line, and it is put in only where everything said before has left. So it stands neither inside
//! a line nor between the lines of one answer, and a host that does not read is not filled with it.

use crate::gcode::Number;
use crate::machine::console::{Console, PortSet};
use crate::machine::hosts::serving::Hosts;
use crate::machine::reports::report::Temperatures;
use crate::port::{Clock, Pend, Serial};
use crate::settings::Range;
use crate::units::Instant;
use core::fmt;

/// The longest time between two reports; Marlin's is as long.
const LONGEST_S: u16 = 60;

/// What a host may have told by itself.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum Report {
    /// Where the tool is.
    Position,
    /// How hot everything is.
    Temperatures,
}

/// How often a host is told each [`Report`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) struct Schedule {
    /// Seconds, 0 for never; and when it is due.
    reports: [(u8, Instant); 2],
}

impl Schedule {
    /// Nothing.
    pub const fn new() -> Self {
        Self { reports: [(0, Instant(0)); 2] }
    }

    const fn of(&mut self, report: Report) -> &mut (u8, Instant) {
        let [position, temperatures] = &mut self.reports;
        match report {
            Report::Position => position,
            Report::Temperatures => temperatures,
        }
    }

    /// From `now` on every `seconds`.
    pub fn set(&mut self, report: Report, seconds: u8, now: Instant) {
        *self.of(report) = (seconds, now.after_ms(u32::from(seconds) * 1000));
    }

    fn is_due(&mut self, report: Report, now: Instant) -> bool {
        let (seconds, due) = *self.of(report);
        seconds > 0 && now >= due
    }
}

impl<S: Serial> Hosts<S> {
    /// Whether a host is to be told, and has heard everything else.
    fn is_due(&mut self, report: Report, now: Instant) -> bool {
        self.iter_mut().any(|host| host.schedule.is_due(report, now) && host.replies.pending().is_empty())
    }

    fn report(&mut self, report: Report, now: Instant, line: fmt::Arguments<'_>) {
        for host in self.iter_mut() {
            if host.schedule.is_due(report, now) && host.replies.pending().is_empty() && host.replies.line(line).is_ok()
            {
                let (seconds, _) = *host.schedule.of(report);
                host.schedule.set(report, seconds, now);
            }
        }
    }
}

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// M154, M155. Without S nothing changes.
    pub(in crate::machine) fn report_every(&mut self, report: Report, seconds: Option<Number>) {
        if let Some(seconds) = seconds {
            let code = match report {
                Report::Position => "M154",
                Report::Temperatures => "M155",
            };
            let seconds = self.clamps.whole([code, "S"], seconds, Range { least: 0, most: LONGEST_S });
            self.hosts.schedule(report, seconds as u8, self.ports.clock.now());
        }
    }

    /// Tells hosts what they want to be told by itself.
    pub(in crate::machine) fn report_unasked(&mut self) {
        let now = self.ports.clock.now();
        if self.hosts.is_due(Report::Temperatures, now) {
            self.hosts.report(Report::Temperatures, now, format_args!(" {Temperatures}"));
        }
        if self.hosts.is_due(Report::Position, now) {
            let position = self.position(true);
            self.hosts.report(Report::Position, now, format_args!("{position}"));
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use crate::port::{Lines, Received};
    use std::cell::RefCell;
    use std::string::String;
    use std::vec::Vec;

    /// A wire that takes three bytes at a time.
    struct Slow<'a>(&'a RefCell<Vec<u8>>);

    impl Serial for Slow<'_> {
        fn recv(&mut self) -> Option<Received> {
            None
        }

        fn send(&mut self, bytes: &[u8]) -> usize {
            let mut heard = self.0.borrow_mut();
            if heard.len() % 4 == 3 {
                heard.push(b'~');
                return 0;
            }
            heard.extend(bytes.iter().take(1));
            bytes.len().min(1)
        }
    }

    #[test]
    fn a_report_stands_neither_in_a_line_nor_in_an_answer() {
        let heard = RefCell::new(Vec::new());
        let lines: Lines<Slow<'_>> = core::iter::once(Slow(&heard)).collect();
        let mut hosts = Hosts::new(lines, Instant(0));
        hosts.turn_to(0);
        hosts.schedule(Report::Temperatures, 1, Instant(0));
        let mut now = Instant(0);
        for n in 0..200 {
            // An answer of three lines, of which each leaves in many pieces, and a report that is always due.
            for part in ["one", "two", "three"] {
                if let Some(replies) = hosts.replies() {
                    let _ = replies.line(format_args!("{part} {n}"));
                }
                hosts.send();
                now = now.after_ms(700);
                hosts.report(Report::Temperatures, now, format_args!(" T:1 /2"));
            }
            for _ in 0..60 {
                hosts.send();
            }
            now = now.after_ms(700);
            hosts.report(Report::Temperatures, now, format_args!(" T:1 /2"));
            for _ in 0..60 {
                hosts.send();
            }
        }
        drop(hosts);
        let text = String::from_utf8(heard.into_inner()).unwrap_or_default().replace('~', "");
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(lines.len(), 800);
        for (n, answer) in lines.chunks(4).enumerate() {
            let expected = [std::format!("one {n}"), std::format!("two {n}"), std::format!("three {n}")];
            assert_eq!(answer[..3], expected);
            assert_eq!(answer[3], " T:1 /2");
        }
    }
}
