//! Touches: the times at which a switch or a probe ends moves. Their stops ring, and no print is made in them.

use crate::steps::StepTrace;

/// Time to ring out after a stop, in ticks: 0.2 s.
pub const RING_OUT: u64 = 2_000_000;

/// Times in order, each from its begin to its end, in ticks.
#[derive(Clone, Debug, Default)]
pub struct Touches(Vec<[u64; 2]>);

impl Touches {
    /// Those of a trace, until their stops have rung out. A switch ends a move before its planned end; then the next
    /// one begins. None if only the steps are known.
    #[must_use]
    pub fn of(trace: &StepTrace) -> Self {
        let next = trace.plan.iter().skip(1).map(|planned| planned.ticks[0]).chain([u64::MAX]);
        let moves = trace.plan.iter().zip(next).filter(|(planned, _)| planned.is_touch);
        Self(moves.map(|(touch, next)| [touch.ticks[0], touch.ticks[1].min(next) + RING_OUT]).collect())
    }

    /// Whether a time is in one of them.
    #[must_use]
    pub fn has(&self, tick: u64) -> bool {
        let begun = self.0.partition_point(|[from, _]| *from <= tick);
        self.0.get(..begun).and_then(<[_]>::last).is_some_and(|[_, to]| tick <= *to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::steps::{Begins, Planned};

    #[test]
    fn a_touch_ends_where_the_next_move_begins_and_rings_out() {
        let planned = |from, to, is_touch| Planned {
            ticks: [from, to],
            way_mm: [1.0, 0.0],
            begins: Begins::AtTheEnd,
            is_touch,
            line_type: 0,
        };
        let mut trace = StepTrace::new(Vec::new(), 0.0125);
        trace.plan = vec![planned(0, 1000, false), planned(1000, 90_000_000, true), planned(5000, 6000, false)];
        let touches = Touches::of(&trace);
        assert!([1000, 3000, 5000, 2_005_000].iter().all(|tick| touches.has(*tick)));
        assert!([0, 999, 2_005_001, 80_000_000].iter().all(|tick| !touches.has(*tick)));
        assert!(!Touches::default().has(0));
    }
}
