//! Stepping: steps of paths with an added lead, among the steps of all other motors.

use super::CompensationError;
use super::path::{Path, RATE, Walk};
use corehbot_twin::steps::{Event, StepTrace, TICKS_PER_SECOND};

/// Ticks between two samples: 10 us. A motor steps at most once per sample.
const LOOK: u64 = 100;

/// A motor this many steps away from its intended place does not keep up.
const LEFT_BEHIND: f64 = 3.0;

/// A motor steps when it is this much of a step away, so that it does not oscillate.
const STEP_AT: f64 = 0.55;

impl Path {
    /// The steps of the path, in the columns of its trace. Columns without a part in the path step as before.
    ///
    /// # Errors
    /// A motor would have to step faster than once per sample.
    pub(super) fn steps(&self, trace: &StepTrace, added: &[Vec<f64>]) -> Result<StepTrace, CompensationError> {
        let mut steps = StepTrace::new(trace.columns.clone(), trace.step_mm);
        let mut walks: Vec<Walk> = self.motors.iter().map(|knots| Walk::new(knots)).collect();
        let mut counts = vec![0_i64; walks.len()];
        let own = self.columns.iter().fold(0_u8, |own, (column, _)| own | 1 << column);
        let mut others = others(trace, own).peekable();
        let looks = (self.duration_s * TICKS_PER_SECOND) as u64 / LOOK;
        for look in 0..=looks {
            let time = (look * LOOK) as f64 / TICKS_PER_SECOND;
            while let Some((tick, event)) = others.next_if(|(tick, _)| *tick < look * LOOK) {
                steps.add(tick, event.steps & !own, event.forward & !own);
            }
            let (mut stepping, mut forward) = (0_u8, 0_u8);
            for (motor, (walk, count)) in walks.iter_mut().zip(&mut counts).enumerate() {
                let meant = walk.at(time) + added.get(motor).map_or(0.0, |added| between(added, time));
                let away = meant - *count as f64;
                let Some((column, sense)) = self.columns.get(motor).filter(|_| away.abs() > STEP_AT) else { continue };
                if away.abs() > LEFT_BEHIND {
                    return Err(CompensationError::TooFast(time));
                }
                let is_up = away > 0.0;
                *count += if is_up { 1 } else { -1 };
                stepping |= 1 << column;
                forward |= u8::from(is_up == (*sense > 0)) << column;
            }
            if stepping != 0 {
                steps.add(look * LOOK, stepping, forward);
            }
        }
        for (tick, event) in others {
            steps.add(tick, event.steps & !own, event.forward & !own);
        }
        Ok(steps)
    }
}

/// Instants in which other columns step.
fn others(trace: &StepTrace, own: u8) -> impl Iterator<Item = (u64, Event)> + '_ {
    let timed = trace.events.iter().scan(0_u64, |tick, event| {
        *tick += u64::from(event.gap);
        Some((*tick, *event))
    });
    timed.filter(move |(_, event)| event.steps & !own != 0)
}

/// Between two samples.
fn between(samples: &[f64], time: f64) -> f64 {
    let at = time * RATE;
    let value = |i: usize| samples.get(i).or(samples.last()).copied().unwrap_or(0.0);
    let index = at as usize;
    value(index) + (value(index + 1) - value(index)) * at.fract()
}
