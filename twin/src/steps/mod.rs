//! Steps: the commanded steps, as a row of instants in which motors step.
//!
//! [`csv`] reads a trace of `corehbot run --trace` (docs/reference/trace.md). A simulator may also pass its steps on as
//! they come. [`drive`] assigns the columns of a trace to the motors of the twin.

pub mod csv;
pub mod drive;

/// Ticks of a trace in a second.
pub const TICKS_PER_SECOND: f64 = 1e7;

/// A column of a trace: a motor of the traced machine.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// Steps per step of x, of y and of z.
    pub row: [i8; 3],
    /// A step of its axes, as a part of the trace's `step_mm`: other than 1 where axes have other steps than x.
    pub axis_step: f64,
}

/// An instant in which motors step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event {
    /// Ticks since the previous event. Events without steps divide longer times.
    pub gap: u32,
    /// The columns that step, a bit each.
    pub steps: u8,
    /// Those that step forward.
    pub forward: u8,
}

/// A planned move of the tool over the bed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planned {
    /// When it begins and ends, in ticks; a shaper's mean delay is in them.
    pub ticks: [u64; 2],
    /// Its way in mm.
    pub way_mm: [f64; 2],
    /// Where it begins.
    pub begins: Begins,
    /// Whether a switch or a probe may end it.
    pub is_touch: bool,
    /// Its type of line, an index into [`StepTrace::line_types`].
    pub line_type: u16,
}

/// A type of line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LineType {
    /// Its name by the slicer, or the word for other moves.
    pub name: String,
    /// Whether such lines are a part of the print: they lay filament, and not to clean the nozzle.
    pub is_printed: bool,
}

/// Where a planned move begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Begins {
    /// At the end of the move before.
    AtTheEnd,
    /// There, or where the motors stand if this is more than a step away: a stop may have ended the move before.
    NearTheEnd,
    /// Where the motors stand: a switch ended the move before.
    AtTheMotors,
}

/// A row of instants.
#[derive(Clone, Debug, PartialEq)]
pub struct StepTrace {
    /// Its columns, at most eight.
    pub columns: Vec<Column>,
    /// Belt per step, in mm.
    pub step_mm: f64,
    /// The instants, in order.
    pub events: Vec<Event>,
    /// The planned moves in order; empty if only the steps are known.
    pub plan: Vec<Planned>,
    /// The types of lines in the plan; empty if they are not known.
    pub line_types: Vec<LineType>,
    last: u64,
}

impl StepTrace {
    /// A trace without steps.
    #[must_use]
    pub const fn new(columns: Vec<Column>, step_mm: f64) -> Self {
        Self { columns, step_mm, events: Vec::new(), plan: Vec::new(), line_types: Vec::new(), last: 0 }
    }

    /// Adds an instant; one before the last counts as the last.
    pub fn add(&mut self, tick: u64, steps: u8, forward: u8) {
        let mut gap = tick.saturating_sub(self.last);
        while gap > u64::from(u32::MAX) {
            self.events.push(Event { gap: u32::MAX, steps: 0, forward: 0 });
            gap -= u64::from(u32::MAX);
        }
        self.events.push(Event { gap: gap as u32, steps, forward });
        self.last = self.last.max(tick);
    }

    /// Its length in s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.last as f64 / TICKS_PER_SECOND
    }

    /// Its events with their times and the columns' counts after each.
    pub fn counted(&self) -> impl Iterator<Item = (u64, [i64; 8])> + '_ {
        let start = (0_u64, [0_i64; 8]);
        self.events.iter().scan(start, |(tick, counts), event| {
            *tick += u64::from(event.gap);
            for (column, count) in counts.iter_mut().enumerate() {
                let steps = i64::from(event.steps >> column & 1);
                *count += steps * (2 * i64::from(event.forward >> column & 1) - 1);
            }
            Some((*tick, *counts))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pause_of_any_length_is_kept() {
        let mut trace = StepTrace::new(Vec::new(), 0.0125);
        trace.add(10, 1, 1);
        trace.add(20_000_000_000, 3, 1);
        let counted: Vec<_> = trace.counted().collect();
        assert_eq!(counted.first(), Some(&(10, [1, 0, 0, 0, 0, 0, 0, 0])));
        assert_eq!(counted.last(), Some(&(20_000_000_000, [2, -1, 0, 0, 0, 0, 0, 0])));
        assert!((trace.duration_s() - 2000.0).abs() < 1e-9);
    }
}
