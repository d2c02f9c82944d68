//! Plan: the line of the tool from planned moves, which need no rounding to steps.
//!
//! Ways add up from the place where the trace begins. A switch ends a move somewhere; then the next one begins where
//! the motors stand.

use super::line_types::NO_TYPE;
use super::path::Vertex;
use crate::math::hypot;
use crate::steps::{Begins, Planned};

/// A line under construction.
#[derive(Clone, Debug)]
pub struct PlanBuilder<'p> {
    moves: std::iter::Peekable<std::slice::Iter<'p, Planned>>,
    step_mm: f64,
    /// Where the motors stand.
    sent: [f64; 2],
    vertices: Vec<Vertex>,
    /// The type of the line that ends at each of them.
    line_types: Vec<u16>,
}

impl<'p> PlanBuilder<'p> {
    /// A line from a place on.
    #[must_use]
    pub fn new(at: [f64; 2], plan: &'p [Planned], step_mm: f64) -> Self {
        let vertices = vec![Vertex { at, tick: 0 }];
        Self { moves: plan.iter().peekable(), step_mm, sent: at, vertices, line_types: vec![NO_TYPE] }
    }

    /// The motors are sent to a place.
    pub fn add(&mut self, at: [f64; 2], tick: u64) {
        while let Some(planned) = self.moves.next_if(|planned| planned.ticks[0] < tick) {
            self.take(planned);
        }
        self.sent = at;
    }

    fn take(&mut self, planned: &Planned) {
        let Some(last) = self.vertices.last().copied() else { return };
        let off = hypot(self.sent[0] - last.at[0], self.sent[1] - last.at[1]);
        let is_elsewhere = match planned.begins {
            Begins::AtTheEnd => false,
            Begins::NearTheEnd => off > self.step_mm,
            Begins::AtTheMotors => off > 0.0,
        };
        let from = if is_elsewhere { self.sent } else { last.at };
        if is_elsewhere {
            self.vertices.push(Vertex { at: from, tick: planned.ticks[0] });
            self.line_types.push(NO_TYPE);
        }
        let [x, y] = planned.way_mm;
        if [x, y] != [0.0; 2] {
            self.vertices.push(Vertex { at: [from[0] + x, from[1] + y], tick: planned.ticks[1] });
            self.line_types.push(planned.line_type);
        }
    }

    /// The whole line, and the type of the part that ends at each vertex.
    #[must_use]
    pub fn finish(mut self) -> (Vec<Vertex>, Vec<u16>) {
        while let Some(planned) = self.moves.next() {
            self.take(planned);
        }
        (self.vertices, self.line_types)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn planned(ticks: [u64; 2], way_mm: [f64; 2], begins: Begins) -> Planned {
        Planned { ticks, way_mm, begins, is_touch: false, line_type: 1 }
    }

    #[test]
    fn a_plan_is_not_rounded_and_begins_again_behind_a_switch() {
        let plan = [
            planned([0, 100], [0.3001, 0.0], Begins::AtTheEnd),
            planned([100, 150], [0.0, 0.0], Begins::AtTheEnd),
            planned([150, 200], [5.0, 0.0], Begins::NearTheEnd),
            planned([400, 500], [0.0, 1.0001], Begins::AtTheMotors),
        ];
        let mut line = PlanBuilder::new([1.0, 2.0], &plan, 0.0125);
        for (x, y, tick) in [(1.1, 2.0, 50), (1.3, 2.0, 99), (2.5, 2.0, 180), (2.5, 2.5, 450), (2.5, 3.0, 490)] {
            line.add([x, y], tick);
        }
        let (line, types) = line.finish();
        let found: Vec<[f64; 2]> = line.iter().map(|vertex| vertex.at).collect();
        let known = [[1.0, 2.0], [1.3001, 2.0], [6.3001, 2.0], [2.5, 2.0], [2.5, 3.0001]];
        assert!(found.iter().flatten().zip(known.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
        assert_eq!(types, [NO_TYPE, 1, 1, NO_TYPE, 1]);
    }
}
