//! Tap: follows every move from the line that caused it to the end of its motion.

use super::observer::Observer;
use super::program::Program;
use super::rules::Motors;
use super::trapezoid::Trapezoid;
use super::{Limit, MadeMove, ShaperChange, Source};
use crate::queue_log::QueueLog;
use crate::slicer;
use corehbot::kinematics::Grouping;
use corehbot::motion::{Entry, Move, Taps, WHOLE, Work};
use corehbot::settings::{Axes, HomedAxis, Settings};
use corehbot::status::Status;
use corehbot::units::{Mm, Steps, TICKS_PER_SECOND};
use corehbot_twin::math::powi;
use std::collections::VecDeque;

/// A new name of a place that is no further from the place in mm is what a stop has left open; a greater difference is
/// another zero.
const SAME_PLACE: f64 = 2.0;

/// Filament that is laid no further than this from the edge of the bed, in mm, before anything else is, is a purge
/// line. Slicers' start code draws it 0 to 10 mm from the edge, and objects are kept further inside by their skirts.
const EDGE: f64 = 15.0;

/// What was queued for the generator.
enum What {
    /// With the moves that waited in the look-ahead then, and whether the stream was dry after it.
    Move(Box<Move>, Source, u32, bool),
    Position([Steps; 4]),
    /// Whether the third coordinate is z.
    Regroup(bool),
    Pause(u64),
    /// The taps of x (0) or y (1).
    Follow(usize, Taps),
    /// Whether z follows a mesh.
    Surface(bool),
    Nothing,
}

struct Queued {
    epoch: u8,
    what: What,
}

/// Follows the moves.
pub(crate) struct Tap {
    program: Program,
    /// mm a step of x, y, z and e.
    step: [f64; 4],
    /// Least and greatest x and y in mm.
    bed: [[f64; 2]; 2],
    /// Planned moves seen so far, wrapping.
    planned: u32,
    /// Moves that are planned and not queued, by their number.
    expected: VecDeque<(u32, Source)>,
    /// What is queued and not begun, and the number of the first of it, wrapping.
    queued: VecDeque<Queued>,
    first: u32,
    /// Moves that have begun, and not ended.
    running: VecDeque<MadeMove>,
    epoch: u8,
    /// Where the firmware counts the tool at the end of what has begun.
    counted: [Steps; 4],
    /// Where it is, in mm.
    at: [f64; 3],
    /// The place has another name since the last move.
    is_apart: bool,
    /// Whether the third coordinate of moves is z, and whether z follows a mesh.
    has_z: bool,
    is_on_mesh: bool,
    observer: Observer,
    /// Underruns seen so far.
    underruns: u32,
    /// When the last move ends, in ticks.
    end: u64,
    /// Filament was laid away from the edge, or under a slicer's name.
    has_printed: bool,
    /// What x and y follow, and the changes of it that nobody has taken.
    taps: [Taps; 2],
    shaper_changes: VecDeque<ShaperChange>,
}

impl Tap {
    /// The moves of a tool that stands at `place`, in mm.
    pub fn new(settings: &Settings, place: [f64; 3]) -> Self {
        let Axes { x, y, z, e } = settings.axes;
        Self {
            program: Program::new(settings),
            step: [x, y, z, e].map(|axis| 1.0 / axis.steps_per_mm.to_num::<f64>()),
            bed: [HomedAxis::X, HomedAxis::Y].map(|axis| {
                let reach = settings.reach(axis);
                [reach.least, reach.most].map(Mm::to_num)
            }),
            planned: 0,
            expected: VecDeque::new(),
            queued: VecDeque::new(),
            first: 0,
            running: VecDeque::new(),
            epoch: 0,
            counted: [Steps::ZERO; 4],
            at: place,
            is_apart: true,
            has_z: true,
            is_on_mesh: false,
            observer: Observer::new(Motors::new(settings)),
            underruns: 0,
            end: 0,
            has_printed: false,
            taps: [const { Taps::new() }; 2],
            shaper_changes: VecDeque::new(),
        }
    }

    /// A line is sent to the printer.
    pub fn read(&mut self, line: u32, kind: u16, command: &str) {
        self.program.read(line, kind, command);
    }

    /// The Console has had a turn, and this is queued since the last one. Mostly nothing has happened.
    #[inline]
    pub fn after_console(&mut self, status: &Status, queued: &QueueLog) {
        let (planned, underruns) = (status.planned().0, status.overload().underruns);
        let entries = queued.take();
        if planned != self.planned || underruns != self.underruns || !entries.is_empty() {
            self.note_turn(planned, underruns, entries);
        }
    }

    /// So many moves are planned, the stream was dry so often, and this is queued.
    fn note_turn(&mut self, planned: u32, underruns: u32, entries: Vec<Entry>) {
        if std::mem::replace(&mut self.underruns, underruns) != underruns {
            self.note_dry();
        }
        let before = self.expected.len();
        let fresh = planned.wrapping_sub(self.planned);
        if fresh > 0 {
            self.planned = planned;
            self.expected.push_back((fresh, self.program.source()));
        }
        let mut dropped = before;
        for Entry { epoch, work } in entries {
            let what = match work {
                Work::Move(m) => {
                    let source = self.next_source();
                    let ahead = self.expected.iter().map(|(count, _)| count).sum();
                    What::Move(Box::new(m), source, ahead, false)
                }
                // The machine stands, so moves planned earlier were made or dropped.
                Work::Position(position) => {
                    self.expected.drain(..std::mem::take(&mut dropped).min(self.expected.len()));
                    What::Position(position)
                }
                Work::Regroup(grouping) => What::Regroup(grouping == Grouping::Tool),
                Work::Surface(frame) => What::Surface(!frame.is_none()),
                Work::Dwell(time) => What::Pause(time.whole_ticks()),
                Work::Follow(axis @ 0..=1, taps) => What::Follow(axis.into(), taps),
                _ => What::Nothing,
            };
            self.queued.push_back(Queued { epoch, what });
        }
    }

    /// The last move that left has stopped, or slowed down, because none followed in time.
    fn note_dry(&mut self) {
        self.observer.share_feed();
        let queued = self.queued.iter_mut().rev().find_map(|queued| match &mut queued.what {
            What::Move(.., is_dry) => Some(is_dry),
            _ => None,
        });
        match (queued, self.running.back_mut()) {
            (Some(is_dry), _) => *is_dry = true,
            (None, Some(last)) => last.is_dry = true,
            (None, None) => self.observer.note_dry(),
        }
    }

    /// The source of the next move that leaves the look-ahead.
    fn next_source(&mut self) -> Source {
        let Some((count, source)) = self.expected.front_mut() else { return self.program.source() };
        let source = *source;
        *count -= 1;
        if *count == 0 {
            self.expected.pop_front();
        }
        Source { feed: source.feed.map(|feed| feed * self.program.share()), ..source }
    }

    /// The generator has had a turn at motion time `now`: so many entries are done, and a move began at that tick,
    /// wrapping. An epoch, or an endstop that was met, ends all motion.
    pub fn after_generator(&mut self, (done, begin): (u32, Option<u32>), now: u64, epoch: u8, is_met: bool) {
        if epoch != self.epoch {
            self.epoch = epoch;
            self.break_off(now);
        }
        let begin = begin.map(|tick| now.saturating_add_signed(tick.wrapping_sub(now as u32).cast_signed().into()));
        while self.first != done {
            let Some(next) = self.queued.pop_front() else { break };
            self.first = self.first.wrapping_add(1);
            self.take(next, now, None, is_met);
        }
        // The present move stays queued until it is done, but it has begun.
        if let (Some(begin), Some(Queued { what, .. })) = (begin, self.queued.front_mut())
            && let What::Move(..) = what
        {
            let what = std::mem::replace(what, What::Nothing);
            self.take(Queued { epoch, what }, now, Some(begin), is_met);
        }
    }

    /// The generator has begun what was queued.
    fn take(&mut self, Queued { epoch, what }: Queued, now: u64, begin: Option<u64>, is_met: bool) {
        let is_dropped = epoch != self.epoch || is_met;
        match what {
            _ if is_dropped => {}
            What::Move(m, source, ahead, is_dry) => {
                self.begin(&m, source, begin.unwrap_or(self.end));
                if let Some(last) = self.running.back_mut() {
                    (last.ahead, last.is_dry) = (ahead, is_dry);
                }
            }
            What::Position(position) => self.stand_at(position),
            What::Regroup(has_z) => self.has_z = has_z,
            What::Surface(is_on_mesh) => self.is_on_mesh = is_on_mesh,
            What::Pause(ticks) => self.end += ticks,
            What::Follow(axis, taps) => self.reshape(now, axis, taps),
            What::Nothing => {}
        }
    }

    /// An axis follows these taps. The Console says so whenever a setting changes, and mostly they are the same.
    fn reshape(&mut self, tick: u64, axis: usize, taps: Taps) {
        if self.taps[axis] != taps {
            self.taps[axis].clone_from(&taps);
            self.shaper_changes.push_back(ShaperChange { tick, axis, taps });
        }
    }

    fn mm(&self, position: [Steps; 4]) -> [f64; 3] {
        std::array::from_fn(|i| position[i].to_num::<f64>() * self.step[i])
    }

    /// The firmware counts the place of the tool, which stands, as `position`.
    fn stand_at(&mut self, position: [Steps; 4]) {
        self.counted = position;
        let named = self.mm(position);
        for (at, named) in self.at.iter_mut().zip(named) {
            if (named - *at).abs() <= SAME_PLACE {
                *at = named;
            }
        }
        self.is_apart = true;
    }

    fn begin(&mut self, m: &Move, source: Source, begin: u64) {
        let ways: [f64; 4] =
            std::array::from_fn(|i| m.end[i].wrapping_sub(self.counted[i]).to_num::<f64>() * self.step[i]);
        let [x, y, z, e] = ways;
        let way = [x, y, if self.has_z { z } else { 0.0 }, e];
        self.counted = m.end;
        let Trapezoid { times, speeds } = Trapezoid::of(m);
        let phases = times.map(|time| (time * f64::from(TICKS_PER_SECOND)).round() as u64);
        let mut made = MadeMove {
            source,
            begin: begin.max(self.end),
            phases,
            speeds,
            from: self.at,
            way,
            is_apart: std::mem::take(&mut self.is_apart),
            is_watched: !m.watch.is_empty(),
            length: m.length.0 as f64 / powi(2.0, 32),
            acceleration: m.acceleration.to_num(),
            cruise: f64::from(m.cruised - m.accelerated) / f64::from(WHOLE),
            ahead: 0,
            is_on_mesh: self.is_on_mesh,
            is_dry: false,
            limit: Limit::default(),
        };
        made.source.kind = self.kind_of(&made);
        self.at = std::array::from_fn(|i| self.at[i] + way[i]);
        self.end = made.end();
        self.running.push_back(made);
    }

    /// Its type: the slicer's for a line that is laid.
    fn kind_of(&mut self, made: &MadeMove) -> u16 {
        if !made.is_printing() {
            return match (made.plane_length() == 0.0, made.way[3]) {
                (true, ..0.0) => slicer::RETRACT,
                (false, ..0.0) => slicer::WIPE,
                (true, filament) if filament > 0.0 => slicer::PRIME,
                _ => slicer::TRAVEL,
            };
        }
        let kind = made.source.kind;
        if kind == slicer::UNNAMED && !self.has_printed {
            let is_near = |[x, y]: [f64; 2]| {
                [x, y].iter().zip(self.bed).any(|(at, [least, most])| (at - least).min(most - at) <= EDGE)
            };
            let [x, y, _] = made.from;
            if is_near([x, y]) && is_near([x + made.way[0], y + made.way[1]]) {
                return slicer::PURGE;
            }
        }
        self.has_printed |= kind != slicer::PURGE;
        kind
    }

    /// All motion ends at `now`: moves that have not begun are dropped, and one that has is shortened.
    fn break_off(&mut self, now: u64) {
        while let Some(last) = self.running.back_mut()
            && last.end() > now
        {
            let seconds = |ticks: u64| ticks as f64 / f64::from(TICKS_PER_SECOND);
            let whole = Trapezoid { times: last.phases.map(seconds), speeds: last.speeds };
            let (part, share) = whole.cut(seconds(now.saturating_sub(last.begin)));
            last.phases = part.times.map(|time| (time * f64::from(TICKS_PER_SECOND)).round() as u64);
            last.speeds = part.speeds;
            last.way = last.way.map(|way| way * share);
            self.at = std::array::from_fn(|i| last.from[i] + last.way[i]);
            if last.begin >= now {
                self.running.pop_back();
            } else {
                break;
            }
        }
        self.end = now;
    }

    /// Moves that have ended by `now` are judged.
    pub fn end(&mut self, now: u64) {
        while let Some(made) = self.running.pop_front_if(|first| first.end() <= now) {
            self.observer.add(&made, self.program.rules(&made.source));
        }
    }

    /// Nothing follows: all that is left is judged.
    pub fn finish(&mut self, now: u64) {
        self.break_off(now);
        self.end(now);
        self.observer.finish();
    }

    /// The next change of a shaper.
    pub fn reshaped(&mut self) -> Option<ShaperChange> {
        self.shaper_changes.pop_front()
    }

    /// The next move that is judged.
    pub fn judged(&mut self) -> Option<MadeMove> {
        self.observer.next()
    }
}
