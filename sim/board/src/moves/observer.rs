//! Observer: says of every move what keeps it from being faster. It sees moves as they were made and the rules in
//! force, nothing of the planner.
//!
//! 1. A move with a cruise, or a top at the least of its bounds, is limited by that bound. The bound is its commanded
//!    speed, the firmware's own speed if the line commands none, an axis, a motor or the extruder. If none of them
//!    fits, the mesh or pressure advance has taken the rest, or the share of the feed that a slow host gets.
//! 2. Any other move only ramps, or cruises over just the minimum cruise ratio, at the speed where ramps over the rest
//!    of the length meet. If its acceleration is less than M204 says, the reason for that is its limit.
//! 3. Else a cruise is the ratio's work.
//! 4. Otherwise it ramps from one speed to another, and the reason is where its longer ramp leads: the next junction
//!    before or after it that is not on a ramp itself. There speeds are held down by
//!
//! | by | which is known by |
//! |---|---|
//! | the slower of two moves | the speed is the one of that move, and its reason counts |
//! | the look-ahead | the speed is the one from which the last moves of a full look-ahead brake to rest |
//! | a slow host | the motion stopped, and the firmware counted an underrun when the next move came |
//! | a corner or a stop | it is none of these |

use super::rules::{Bounds, Motors, Rules};
use super::{Limit, MadeMove};
use corehbot::motion::{LOOKAHEAD_MOVES, WHOLE_SHARE};
use std::collections::VecDeque;

/// Speeds are equal within this part: moves are planned in single precision, and limits are numbers of 16 bits.
const EQUAL: f64 = 2e-3;

/// Moves are judged when so many are known after them, and so many are kept before: a ramp over more moves is cut.
const KNOWN: usize = 512;

/// A full look-ahead has forced a move if nearly all of its places were taken.
const NEARLY_FULL: usize = 32;

/// A move, and what is known of it.
#[derive(Clone, Copy)]
struct Judged {
    made: MadeMove,
    /// Its limit by its own bounds; `None` if it only ramps.
    own: Option<Limit>,
    /// The speed that its bounds allow, and the reason.
    most: (Limit, f64),
    /// Why the ramp at its begin, and the ramp at its end, is.
    reasons: [Limit; 2],
}

/// Judges moves.
pub(super) struct Observer {
    motors: Motors,
    waiting: VecDeque<Judged>,
    /// Of these the limits are known.
    known: usize,
    /// The reason of the last junction before the waiting moves.
    reason: Limit,
    /// Whether the stream was ever dry: only then the feed may have been shared.
    was_dry: bool,
}

impl Observer {
    pub fn new(motors: Motors) -> Self {
        Self { motors, waiting: VecDeque::new(), known: 0, reason: Limit::Corner, was_dry: false }
    }

    /// The next move, with the rules in force for it.
    pub fn add(&mut self, made: &MadeMove, rules: &Rules) {
        let named = |limit| if limit == Limit::Feed && made.source.feed.is_none() { Limit::Firmware } else { limit };
        let (own, (limit, speed)) = self.judge(made, rules);
        let (own, most) = (own.map(named), (named(limit), speed));
        self.waiting.push_back(Judged { made: *made, own, most, reasons: [Limit::Corner; 2] });
        if self.waiting.len() >= 2 * KNOWN {
            self.know(KNOWN);
        }
    }

    /// Nothing follows.
    pub fn finish(&mut self) {
        self.know(self.waiting.len());
    }

    /// The stream was dry.
    pub const fn share_feed(&mut self) {
        self.was_dry = true;
    }

    /// It was dry after the last move.
    pub fn note_dry(&mut self) {
        if let Some(last) = self.waiting.back_mut() {
            last.made.is_dry = true;
        }
    }

    /// The next move with its limit.
    pub fn next(&mut self) -> Option<MadeMove> {
        self.known = self.known.checked_sub(1)?;
        self.waiting.pop_front().map(|judged| MadeMove { limit: judged.limit(), ..judged.made })
    }

    /// The limit of a move by its own bounds, and the speed that they allow.
    fn judge(&self, made: &MadeMove, rules: &Rules) -> (Option<Limit>, (Limit, f64)) {
        let [_, top, _] = made.speeds;
        let speeds = Bounds::new(made.way, made.length, &rules.speeds, &self.motors, self.motors.speed);
        let feed = made.source.feed.unwrap_or(top);
        let bound = speeds.least();
        let has_cruise = made.cruise > 0.0 && made.phases[1] > 0;
        let is_at = |speed: f64| top >= speed * (1.0 - EQUAL);
        let named = |speed: f64| if is_same(speed, feed) { Limit::Feed } else { self.reduced(made, rules, &speeds) };
        let most = if feed <= bound {
            (Limit::Feed, feed)
        } else {
            (speeds.equal_to(bound, EQUAL).unwrap_or(Limit::Axis), bound)
        };
        if is_at(most.1) {
            return (Some(most.0), most);
        }
        if has_cruise && !self.is_by_ratio(made, rules) {
            let limit = named(top);
            return (Some(limit), (limit, top));
        }
        // More acceleration than the ratio leaves would help more than a smaller ratio.
        let slow = self.slow_acceleration(made, rules);
        (slow.or(has_cruise.then_some(Limit::CruiseRatio)), most)
    }

    /// Why a move cruises below all bounds.
    fn reduced(&self, made: &MadeMove, rules: &Rules, speeds: &Bounds) -> Limit {
        let top = made.speeds[1];
        let feed = made.source.feed.unwrap_or(top);
        let shares = (1..WHOLE_SHARE).map(|share| feed * f64::from(share) / f64::from(WHOLE_SHARE));
        if let Some(limit) = speeds.equal_to(top, EQUAL) {
            limit
        } else if self.was_dry && shares.into_iter().any(|speed| is_same(speed, top)) {
            Limit::SlowHost
        } else if rules.has_advance && made.way[3] != 0.0 && !made.is_on_mesh {
            Limit::Extruder
        } else if made.is_on_mesh {
            Limit::Mesh
        } else {
            Limit::Axis
        }
    }

    /// Whether it cruises over no more than it must, where ramps over the rest meet.
    fn is_by_ratio(&self, made: &MadeMove, rules: &Rules) -> bool {
        let [entry, top, exit] = made.speeds;
        let ramps = (1.0 - rules.cruise_ratio) * made.length;
        let meet = ((entry * entry + exit * exit) / 2.0 + made.acceleration * ramps).sqrt();
        rules.cruise_ratio > 0.0 && is_same(meet, top) && (made.cruise - rules.cruise_ratio).abs() < 0.01
    }

    /// Why its acceleration is less than the one for its purpose, if it is.
    fn slow_acceleration(&self, made: &MadeMove, rules: &Rules) -> Option<Limit> {
        let [print, retract, travel] = rules.purposes;
        let wanted = if made.way[..3] == [0.0; 3] {
            retract
        } else if made.way[3] != 0.0 {
            print
        } else {
            travel
        };
        if made.acceleration >= wanted * (1.0 - EQUAL) {
            return None;
        }
        let bounds = Bounds::new(made.way, made.length, &rules.accelerations, &self.motors, self.motors.acceleration);
        // If nothing fits, M204 has changed since the move was planned.
        let rest = if made.is_on_mesh {
            Some(Limit::Mesh)
        } else {
            Some(Limit::Extruder).filter(|_| rules.has_advance && made.way[3] != 0.0)
        };
        bounds.equal_to(made.acceleration, EQUAL).or(rest)
    }

    /// Finds the reasons of ramps, and lets the first `count` go.
    fn know(&mut self, count: usize) {
        for index in self.known..self.waiting.len() {
            let before = index.checked_sub(1);
            let reason = before.map_or(self.reason, |before| self.junction(before));
            let is_risen = before.is_some_and(|before| self.waiting[before].made.only_accelerates());
            let reason = before.filter(|_| is_risen).map_or(reason, |before| self.waiting[before].reasons[0]);
            self.waiting[index].reasons[0] = reason;
        }
        let mut following = Limit::Corner;
        for index in (self.known..self.waiting.len()).rev() {
            let next = self.waiting.get(index + 1);
            let is_falling = next.is_some_and(|next| next.made.only_decelerates());
            let reason = if is_falling { following } else { self.junction(index) };
            self.waiting[index].reasons[1] = reason;
            following = reason;
        }
        self.known = self.known.max(count);
        if let Some(last) = self.known.checked_sub(1) {
            let last = self.waiting[last];
            self.reason = if last.made.only_accelerates() { last.reasons[0] } else { last.reasons[1] };
        }
    }

    /// What holds down the speed between a move and the next.
    fn junction(&self, index: usize) -> Limit {
        let Some(this) = self.waiting.get(index) else { return Limit::Corner };
        let speed = this.made.speeds[2];
        if speed == 0.0 {
            return if this.made.is_dry { Limit::SlowHost } else { Limit::Corner };
        }
        let Some(next) = self.waiting.get(index + 1) else { return Limit::Corner };
        let slower = if next.most.1 < this.most.1 { next.most } else { this.most };
        if speed >= slower.1 * (1.0 - EQUAL) {
            return slower.0;
        }
        if self.is_end_of_look_ahead(index, speed) { Limit::LookAhead } else { Limit::Corner }
    }

    /// Whether that is the speed from which the moves after it, up to the end of a full look-ahead, brake to rest.
    fn is_end_of_look_ahead(&self, index: usize, speed: f64) -> bool {
        let Some(this) = self.waiting.get(index) else { return false };
        let ahead = this.made.ahead as usize;
        if ahead + NEARLY_FULL < LOOKAHEAD_MOVES {
            return false;
        }
        // Moves may have been added after it was forced, as many as a batch has.
        let mut sum = 0.0;
        for (count, next) in self.waiting.iter().skip(index + 1).take(ahead + 1).enumerate() {
            sum += 2.0 * next.made.acceleration * next.made.length;
            if count + 1 + NEARLY_FULL >= ahead && (sum / (speed * speed) - 1.0).abs() < EQUAL * 0.5 {
                return true;
            }
        }
        false
    }
}

impl Judged {
    fn limit(&self) -> Limit {
        let [rise, _, fall] = self.made.phases;
        self.own.unwrap_or(self.reasons[usize::from(fall >= rise)])
    }
}

fn is_same(a: f64, b: f64) -> bool {
    (a - b).abs() <= EQUAL * b
}
