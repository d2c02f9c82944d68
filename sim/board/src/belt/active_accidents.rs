//! ActiveAccidents: what accidents do to the machine in motion, and since when.

use super::accident::{AccidentState, Accidents, Hit};
use super::find::BrokenPart;
use super::layout::{Layout, LayoutError};
use crate::accident::Accident;
use crate::accident::table::{Does, Wear};
use corehbot_twin::routing::Place;
use corehbot_twin::stepped_machine::Live;
use corehbot_twin::stepped_machine::failing::seized_idler_n;

/// Friction in N of a motor's pulley that does not turn, unless the accident says another one: sixteen times the
/// holding torque of a nominal motor.
const STALLS_N: f64 = 1000.0;

/// What an accident changes.
#[derive(Clone, Debug)]
enum Effect {
    /// These rotors are braked.
    Rub(Vec<usize>, f64),
    /// These idlers are, by their places among those that turn by themselves, each by its own force.
    Seize(Vec<(usize, f64)>),
    /// The screw of a motor's pulley holds so much, clockwise and counter-clockwise.
    Loosen(usize, [f64; 2]),
    /// The belt jumps so many teeth ahead of a motor.
    Jump(usize, f64),
    /// This part of a belt's stiffness is left.
    Weaken(usize, f64),
}

/// An accident of a part.
#[derive(Clone, Debug)]
struct Failing {
    effect: Effect,
    /// When it begins, in s of motion time.
    from_s: f64,
    ms: Option<f64>,
    state: AccidentState,
    /// The instant at which it begins, in ticks, as soon as that is known.
    due: Option<u64>,
    /// The accident as it was written.
    text: String,
}

/// The accidents of a machine.
#[derive(Clone, Debug, Default)]
pub(super) struct ActiveAccidents {
    hits: Vec<(Hit, AccidentState)>,
    parts: Vec<Failing>,
}

impl ActiveAccidents {
    /// These accidents, and the idlers that they need: stops by their indices.
    ///
    /// # Errors
    /// The machine has no such part.
    pub(super) fn new(accidents: Accidents, layout: &Layout, start: Place) -> Result<(Self, Vec<usize>), LayoutError> {
        let Accidents { hits, parts } = accidents;
        let (mut failing, mut idlers) = (Vec::new(), Vec::new());
        for part in parts {
            let Does::Belts(wear) = part.row.does else { continue };
            let effect = effect_of(wear, &part, layout, start, &mut idlers)?;
            let ms = part.lasts_s.map(|seconds| 1000.0 * seconds);
            failing.push(Failing::new(effect, part.at_s, ms, part.text));
        }
        // The plant has its idlers in the order of their stops.
        let mut stops = idlers.clone();
        stops.sort_unstable();
        for failing in &mut failing {
            if let Effect::Seize(seized) = &mut failing.effect {
                for (idler, _) in seized {
                    let place = idlers.get(*idler).and_then(|stop| stops.iter().position(|other| other == stop));
                    *idler = place.unwrap_or_default();
                }
            }
        }
        let hits = hits.into_iter().map(|hit| (hit, AccidentState::Waiting)).collect();
        Ok((Self { hits, parts: failing }, stops))
    }

    /// When the next of them begins or ends, if that is known.
    pub(super) fn next_change(&self) -> Option<u64> {
        let parts = self.parts.iter().map(|part| &part.state);
        let ends = self.hits.iter().map(|(_, state)| state).chain(parts).filter_map(AccidentState::end);
        ends.chain(self.parts.iter().filter_map(Failing::begin)).min()
    }

    /// Parts that fail by a motion time get the instant of it: motors that step tell motion time, and those of the belt
    /// may rest meanwhile.
    pub(super) fn date(&mut self, motion_s: f64, instant: impl Fn(f64) -> u64) {
        for part in self.parts.iter_mut().filter(|part| part.due.is_none() && part.from_s <= motion_s) {
            part.due = Some(instant(part.from_s));
        }
    }

    /// Parts fail and mend that are due at `now`.
    pub(super) fn change(&mut self, now: u64, live: &mut Live) {
        self.fail(now, live);
        self.end_all(now, live);
    }

    /// Ends those that act no longer than to `now`.
    fn end_all(&mut self, now: u64, live: &mut Live) {
        for (_, state) in &mut self.hits {
            state.end_at(now);
        }
        let mut is_tightened = false;
        for part in &mut self.parts {
            if let (true, Effect::Loosen(motor, _)) = (part.state.end_at(now), &part.effect) {
                live.tighten(*motor);
                is_tightened = true;
            }
        }
        // Another accident may still hold the same screw loose.
        if is_tightened {
            for part in self.parts.iter().filter(|part| part.state.end().is_some()) {
                if let Effect::Loosen(motor, most_n) = part.effect {
                    live.loosen(motor, most_n);
                }
            }
        }
        self.act(live);
    }

    /// Hits begin where the tool is on its way near them.
    pub(super) fn meet(&mut self, now: u64, tool_mm: [f64; 2], live: &mut Live) {
        for (hit, state) in &mut self.hits {
            state.begin(hit, now, tool_mm, live.velocity_mm_s());
        }
        self.act(live);
    }

    /// Parts fail that are due at `now`.
    fn fail(&mut self, now: u64, live: &mut Live) {
        let mut is_changed = false;
        for part in &mut self.parts {
            let Some(begin) = part.begin().filter(|begin| *begin <= now) else { continue };
            is_changed = true;
            let force_n = if let Effect::Rub(_, force_n) = part.effect { force_n } else { 0.0 };
            part.state.start(force_n, part.ms, begin);
            match part.effect {
                Effect::Loosen(motor, most_n) => live.loosen(motor, most_n),
                Effect::Jump(motor, teeth) => live.jump(motor, teeth),
                Effect::Weaken(belt, left) => live.weaken(belt, left),
                Effect::Rub(..) | Effect::Seize(_) => {}
            }
        }
        if is_changed {
            self.act(live);
        }
    }

    /// Obstacles and friction are as hard as they are now.
    fn act(&self, live: &mut Live) {
        live.obstruct(self.hits.iter().map(|(_, state)| state.force_n()).sum());
        let acting = || self.parts.iter().filter(|part| part.state.end().is_some());
        for motor in 0..live.counts().len() {
            let rubs = acting().filter_map(|part| match &part.effect {
                Effect::Rub(motors, force_n) if motors.contains(&motor) => Some(*force_n),
                _ => None,
            });
            live.brake(motor, rubs.sum());
        }
        for idler in self.parts.iter().flat_map(Failing::idlers) {
            let all = acting().flat_map(Failing::idlers).filter(|(other, _)| *other == idler.0);
            live.seize(idler.0, all.map(|(_, force_n)| *force_n).fold(0.0, f64::max));
        }
    }

    /// Hits at places that the tool never reached.
    pub(super) fn missed_hits(&self) -> usize {
        self.hits.iter().filter(|(_, state)| *state == AccidentState::Waiting).count()
    }

    /// Each accident of a part: its text, when it began, and the motor with a belt that it moves on.
    pub(super) fn of_parts(&self) -> impl Iterator<Item = (&str, Option<f64>, Option<usize>)> {
        self.parts.iter().map(|part| {
            let motor = match part.effect {
                Effect::Loosen(motor, _) | Effect::Jump(motor, _) => Some(motor),
                _ => None,
            };
            let began_s = (part.state != AccidentState::Waiting).then_some(part.from_s);
            (part.text.as_str(), began_s, motor)
        })
    }
}

impl Failing {
    const fn new(effect: Effect, from_s: f64, ms: Option<f64>, text: String) -> Self {
        Self { effect, from_s, ms, state: AccidentState::Waiting, due: None, text }
    }

    /// When it begins, if that is known and it has not.
    fn begin(&self) -> Option<u64> {
        self.due.filter(|_| self.state == AccidentState::Waiting)
    }

    /// The idlers that it seizes.
    fn idlers(&self) -> impl Iterator<Item = &(usize, f64)> {
        let idlers: &[(usize, f64)] = if let Effect::Seize(idlers) = &self.effect { idlers } else { &[] };
        idlers.iter()
    }
}

/// The effect of an accident on its part. Idlers that it seizes are added to `idlers`.
fn effect_of(
    wear: Wear,
    part: &Accident,
    layout: &Layout,
    start: Place,
    idlers: &mut Vec<usize>,
) -> Result<Effect, LayoutError> {
    let how = part.how.unwrap_or_default();
    let motor = || layout.motor_part(part);
    Ok(match wear {
        Wear::Rub => Effect::Rub(layout.motors_of(part)?, how),
        Wear::Seize => match layout.part(part)? {
            BrokenPart::Motor(motor) => Effect::Rub(vec![motor], part.how.unwrap_or(STALLS_N)),
            BrokenPart::Idlers(stops) => {
                let force_n = |stop| {
                    let slides_n = || seized_idler_n(layout.machine, &layout.params, start, stop);
                    part.how.unwrap_or_else(slides_n)
                };
                let mut place_of = |stop: usize| {
                    idlers.iter().position(|other| *other == stop).unwrap_or_else(|| {
                        idlers.push(stop);
                        idlers.len() - 1
                    })
                };
                Effect::Seize(stops.into_iter().map(|stop| (place_of(stop), force_n(stop))).collect())
            }
        },
        Wear::Loosen => {
            let motor = motor()?;
            let held = |holds: bool| if holds { f64::INFINITY } else { how.abs() };
            // A motor that drives forward is pulled back.
            let [back, forward] = [held(part.direction < 0), held(part.direction > 0)];
            Effect::Loosen(motor, if layout.sense(motor) > 0.0 { [back, forward] } else { [forward, back] })
        }
        Wear::Jump => {
            let motor = motor()?;
            Effect::Jump(motor, how * layout.sense(motor))
        }
        Wear::Weaken => Effect::Weaken(layout.belt_of(motor()?), how / 100.0),
    })
}
