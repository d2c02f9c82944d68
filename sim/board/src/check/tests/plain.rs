//! The checker without any of its short cuts: everything is compared at every event and at every sample, and positions
//! come from the forward kinematics. Both must find the same, in the same words, in sound streams and in faulty ones.

use super::super::gauge::Coordinate;
use super::super::*;
use crate::limits::Limit;
use corehbot::kinematics::{ForwardKinematics, Group, Groups, Residuals};
use corehbot::motion::MIN_STEP_INTERVAL;
use corehbot::motors::Motor;
use corehbot_machine_file as machine_file;
use proptest::prelude::*;
use std::path::Path;

/// A motor between two of its steps: from, to, and its speed in steps a tick.
type Piece = (u64, u64, f64);

/// A coordinate of motors.
struct Line {
    group: Group,
    count: i64,
    /// When it last passed the middle between two steps, and which.
    last: Option<(u64, f64)>,
    pieces: Vec<Piece>,
}

struct Plain {
    settings: Settings,
    limits: Limits,
    sampler: Sampler,
    back: ForwardKinematics<{ MOTORS }>,
    /// Each with its quiet samples.
    coordinates: Vec<(Coordinate, u32)>,
    last_tick: u64,
    latest: u64,
    last_pulse: [Option<u64>; MOTORS],
    trimmed: [i64; MOTORS],
    is_consistent: bool,
    lines: Vec<Line>,
    /// Motors of z that turn alone, and are not all of z.
    screws: Vec<Line>,
    /// Of each limit, and of each such motor: the last speeds, and the quiet samples.
    speeds: Vec<(Vec<f64>, u32)>,
    next: u64,
    findings: Findings,
}

/// Two steps farther apart than this are a rest: 20 ms.
const REST: u64 = 200_000;

impl Plain {
    fn new(s: &Settings, limits: &Limits) -> Self {
        let groups = Groups::new(&s.mechanism);
        let lines = groups.iter().filter(|group| !group.motors().is_empty());
        let line = |group: Group| Line { group, count: 0, last: None, pieces: Vec::new() };
        let lines: Vec<Line> = lines.map(|group| line(*group)).collect();
        let leads: Vec<Motor> =
            lines.iter().filter(|line| line.group.row[2] != 0).map(|line| line.group.lead).collect();
        let screws = s.screw_motors().into_iter().filter(|motor| limits.levels && leads != [*motor]);
        let screws: Vec<Line> = screws.map(|lead| line(Group { lead, ..lines[0].group })).collect();
        let count = limits.of.len() + screws.len();
        Self {
            settings: *s,
            limits: limits.clone(),
            sampler: Sampler::new(&s.mechanism),
            back: s.mechanism.forward_kinematics().unwrap(),
            coordinates: Gauge::new(s, limits).coordinates.into_iter().map(|coordinate| (coordinate, 0)).collect(),
            last_tick: 0,
            latest: 0,
            last_pulse: [None; MOTORS],
            trimmed: [0; MOTORS],
            is_consistent: true,
            lines,
            screws,
            speeds: vec![(Vec::new(), 0); count],
            next: 0,
            findings: Findings::default(),
        }
    }

    fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        if tick < self.last_tick {
            let text = format!("time falls from tick {}", self.last_tick);
            self.findings.add(tick, || text);
        }
        self.last_tick = tick;
        let tick = tick.max(self.latest);
        self.latest = tick;
        for (motor, name) in steps.iter().zip(steps.iter().map(|motor| self.settings.name_of(motor))) {
            let before = self.last_pulse[motor.index()].replace(tick);
            if let Some(gap) = before.map(|before| tick.saturating_sub(before)).filter(|gap| *gap < MIN_STEP_INTERVAL) {
                let text = format!("two pulses of {name} are {gap} ticks apart, {MIN_STEP_INTERVAL} is the least");
                self.findings.add(tick, || text);
            }
        }
        self.change(tick);
        for Line { group, count, last, pieces } in self.lines.iter_mut().chain(&mut self.screws) {
            if steps.has(group.lead) {
                let way = if forward.has(group.lead) { 1 } else { -1 };
                let middle = *count as f64 + 0.5 * f64::from(way);
                *count += i64::from(way);
                if let Some((from, before)) = last.replace((tick, middle))
                    && (1..=REST).contains(&tick.saturating_sub(from))
                {
                    pieces.push((from, tick, (middle - before) / (tick - from) as f64));
                }
            }
        }
        self.sample(tick);
        let way = |motor: usize| i64::from(steps.0 >> motor & 1) * (2 * i64::from(forward.0 >> motor & 1) - 1);
        let mut sampler = self.sampler.clone();
        sampler.event(tick, steps, forward, |_| {});
        self.sampler = sampler;
        let belt = Residuals::new(&self.settings.mechanism, self.settings.belt.is_closed).motors();
        for motor in steps.iter().filter(|motor| steps == MotorSet::of(*motor)) {
            let is_trim = self.limits.trims && belt.has(motor)
                || self.limits.levels && self.settings.screw_motors().into_iter().any(|screw| screw == motor);
            self.trimmed[motor.index()] += if is_trim { way(motor.index()) } else { 0 };
        }
        self.mechanism(tick);
    }

    fn untrimmed(&self) -> [i64; MOTORS] {
        std::array::from_fn(|motor| self.sampler.counts()[motor] - self.trimmed[motor])
    }

    fn residual(&self) -> i64 {
        if !self.limits.circulates {
            return 0;
        }
        let (counts, residuals) = (self.untrimmed(), Residuals::new(&self.settings.mechanism, true));
        let sums = residuals.iter().map(|row| row.iter().zip(counts).map(|(times, n)| i64::from(*times) * n).sum());
        sums.map(i64::abs).max().unwrap_or_default()
    }

    fn strain(&self) -> Option<(i64, i64)> {
        let (groups, counts) = (Groups::new(&self.settings.mechanism), self.untrimmed());
        let constraint = groups.constraint()?;
        let sum = groups.iter().zip(constraint).map(|(group, times)| i64::from(times) * counts[group.lead.index()]);
        Some((sum.sum(), constraint.iter().map(|times| i64::from(times.abs())).sum::<i64>() / 2))
    }

    fn mechanism(&mut self, tick: u64) {
        let counts = self.untrimmed();
        let mut is_consistent = self.residual() <= 2;
        if !self.limits.circulates {
            is_consistent = self.strain().is_none_or(|(sum, most)| sum.abs() <= most);
            for group in Groups::new(&self.settings.mechanism).iter() {
                let at = counts[group.lead.index()];
                is_consistent &= group.with.iter().all(|motor| counts[motor.index()] == at);
                is_consistent &= group.against.iter().all(|motor| counts[motor.index()] == -at);
            }
        }
        if self.is_consistent && !is_consistent {
            let named = self.settings.motor_names.iter().zip(counts).filter(|(name, _)| !name.is_none());
            let text: String = named.map(|(name, count)| format!(" {name} {count}")).collect();
            self.findings.add(tick, || format!("motors out of step:{text}"));
        }
        self.is_consistent = is_consistent;
    }

    /// Shows the coordinates every sample before `tick`.
    fn sample(&mut self, tick: u64) {
        let Self { sampler, coordinates, back, findings, settings, .. } = self;
        let belts = crate::limits::belts(settings);
        sampler.advance(tick, |sample| {
            let axes = back.fractions(&sample.counts).map(|(sum, _)| sum);
            let places = axes.into_iter().chain(belts.iter().map(|belt| sample.counts[belt.lead.index()]));
            for ((coordinate, quiet), at) in coordinates.iter_mut().zip(places) {
                coordinate.put(at);
                let excess = coordinate.excess(Stops::default(), sample.tick);
                let is_new = *quiet == 0;
                *quiet = if excess.is_some() { EPISODE } else { quiet.saturating_sub(1) };
                if let Some(excess) = excess.filter(|_| is_new) {
                    findings.add(sample.tick, || excess.to_string());
                }
            }
        });
    }

    /// Looks at the changes of speed in every sample that is known at `tick`.
    fn change(&mut self, tick: u64) {
        while self.next + SAMPLE_TICKS + REST < tick {
            let ended = self.next.checked_sub(10 * SAMPLE_TICKS);
            let rests = |pieces: &[Piece]| pieces.iter().all(|(_, to, _)| ended.is_some_and(|ended| *to <= ended));
            if self.lines.iter().chain(&self.screws).all(|line| rests(&line.pieces)) {
                let rest = (tick - REST - self.next) / SAMPLE_TICKS;
                self.next += rest.saturating_sub(8) * SAMPLE_TICKS;
                for (_, quiet) in &mut self.speeds {
                    *quiet -= rest.saturating_sub(8).min(u64::from(*quiet)) as u32;
                }
            }
            let (from, to) = (self.next, self.next + SAMPLE_TICKS);
            self.next = to;
            let mut ways = [0.0; 4];
            let mut of_belts = Vec::new();
            let way_of = |pieces: &[Piece]| -> f64 {
                let within = pieces.iter().filter(|(begin, end, _)| *begin < to && *end > from);
                within.map(|(begin, end, speed)| ((*end).min(to) - (*begin).max(from)) as f64 * speed).sum()
            };
            for Line { group, pieces, .. } in &self.lines {
                let way = way_of(pieces);
                let axes = [self.settings.axes.x, self.settings.axes.y, self.settings.axes.z, self.settings.axes.e];
                for ((sum, weight), axis) in ways.iter_mut().zip(self.shares(group)).zip(axes) {
                    *sum += weight / axis.steps_per_mm.to_num::<f64>() * way;
                }
                let is_belt = crate::limits::belts(&self.settings).iter().any(|belt| belt.lead == group.lead);
                if is_belt {
                    of_belts.push(way / self.settings.steps_per_mm(group.lead).to_num::<f64>());
                }
            }
            let of_screws = self.screws.iter().map(|Line { group, pieces, .. }| {
                way_of(pieces) / self.settings.steps_per_mm(group.lead).to_num::<f64>()
            });
            let all: Vec<f64> = ways.into_iter().chain(of_belts).chain(of_screws).collect();
            self.judge_speeds(to, &all);
        }
    }

    /// Steps of each axis for a step of the motors of a group.
    fn shares(&self, group: &Group) -> [f64; 4] {
        let counts = Motor::ALL.map(|motor| i64::from(group.with.has(motor)) - i64::from(group.against.has(motor)));
        self.back.fractions(&counts).map(|(part, over)| part as f64 / over as f64)
    }

    /// The limit of a coordinate, or of a motor that turns alone.
    fn limit(&self, place: usize) -> Limit {
        let screw = |motor: Motor| Limit {
            name: self.settings.name_of(motor).as_str().to_owned(),
            step: 1.0 / self.settings.steps_per_mm(motor).to_num::<f64>(),
            ..self.limits.of[2].clone()
        };
        let of = &self.limits.of;
        of.get(place).cloned().unwrap_or_else(|| screw(self.screws[place - of.len()].group.lead))
    }

    /// The factor of the acceleration and the hidden speed of a coordinate; `None` for a belt that is an axis.
    fn kept(&self, place: usize) -> Option<(f64, f64)> {
        let limit = self.limit(place);
        let own = (limit.acceleration * limit.step).sqrt();
        let moved = |group: &Group| self.shares(group).iter().filter(|share| **share != 0.0).count();
        match place {
            2 => {
                let belt = self.limits.of.get(4).unwrap_or(&limit).acceleration;
                let of_z = self.lines.iter().filter(|line| self.shares(&line.group)[2] != 0.0);
                let hidden = of_z.clone().map(|line| {
                    let mm = 1.0 / self.settings.steps_per_mm(line.group.lead).to_num::<f64>();
                    let z = self.shares(&line.group)[2].abs() / self.settings.axes.z.steps_per_mm.to_num::<f64>();
                    z / mm * (belt * mm).sqrt()
                });
                Some((1.05, if of_z.count() > 1 { hidden.sum::<f64>().max(own) } else { own }))
            }
            3 => Some((1.05, own)),
            0 | 1 => Some((1.3, own)),
            _ => match crate::limits::belts(&self.settings).get(place - 4) {
                Some(belt) => (moved(belt) > 1).then_some((1.3, own)),
                None => Some((1.05, own)),
            },
        }
    }

    fn judge_speeds(&mut self, tick: u64, ways: &[f64]) {
        if !self.limits.is_judged {
            return;
        }
        for (place, way) in ways.iter().enumerate() {
            let (kept, limit) = (self.kept(place), self.limit(place));
            let (speeds, quiet) = &mut self.speeds[place];
            speeds.push(way * f64::from(TICKS_PER_SECOND) / SAMPLE_TICKS as f64);
            let last = &speeds[speeds.len().saturating_sub(8)..];
            let change = last.iter().copied().fold(f64::MIN, f64::max) - last.iter().copied().fold(f64::MAX, f64::min);
            let Some((factor, hidden)) = kept else { continue };
            let most = factor * limit.acceleration * 0.004 + limit.jump + hidden;
            let (is_over, is_new) = (change > most, *quiet == 0);
            *quiet = if is_over { EPISODE } else { quiet.saturating_sub(1) };
            if is_over && is_new {
                let name = &limit.name;
                self.findings.add(tick, || {
                    format!("{name} changes its speed by {change:.1} mm/s within 4 ms, {most:.1} is the most")
                });
            }
        }
    }

    fn finish(mut self, expected: [i32; MOTORS]) -> Findings {
        let (strain, residual, last_tick) = (self.strain(), self.residual(), self.latest);
        if residual != 0 {
            self.findings.add(last_tick, || format!("motors rest {residual} steps against each other"));
        }
        let rest = last_tick + LONGEST_WINDOW as u64 * SAMPLE_TICKS;
        self.change(rest);
        self.sample(rest);
        if let Some((sum, _)) = strain.filter(|(sum, most)| sum.abs() >= *most) {
            self.findings.add(last_tick, || format!("motors rest {sum} steps against each other"));
        }
        for ((name, counted), due) in self.settings.motor_names.iter().zip(*self.sampler.counts()).zip(expected) {
            if counted != i64::from(due) {
                self.findings.add(last_tick, || format!("{name} ends at step {counted} instead of {due}"));
            }
        }
        self.findings
    }
}

/// The machines that differ in what is checked: by their files.
const MACHINES: [&str; 6] = ["prototype", "corexy", "cartesian", "core-unequal", "corexyz", "corehbot-three-screws"];

fn machine(name: &str) -> Settings {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/machines");
    let text = std::fs::read_to_string(folder.join(name).with_extension("toml")).unwrap();
    machine_file::parse(&text).unwrap().settings
}

/// Events in a row: how many, ticks between two, groups that step, and their directions.
type Stretch = (usize, u64, u8, u8);

/// What goes wrong at the begin of a stretch.
#[derive(Clone, Copy, Debug)]
enum Fault {
    Nothing,
    /// Motors step alone, whatever their group.
    Alone(u8, u8),
    /// Time goes on by so many ticks, or back.
    Pause(u64),
    Back(u64),
}

fn faults() -> impl Strategy<Value = Fault> {
    prop_oneof![
        6 => Just(Fault::Nothing),
        1 => (any::<u8>(), any::<u8>()).prop_map(|(steps, forward)| Fault::Alone(steps, forward)),
        1 => (0..8u8, any::<u8>()).prop_map(|(motor, forward)| Fault::Alone(1 << motor, forward)),
        2 => prop_oneof![0..500_000u64, 0..200_000_000u64].prop_map(Fault::Pause),
        1 => prop_oneof![0..40u64, 0..300_000u64].prop_map(Fault::Back),
    ]
}

fn stretches() -> impl Strategy<Value = (Fault, Stretch)> {
    let interval = prop_oneof![1 => 0..40u64, 4 => 300..3000u64, 4 => 1500..20_000u64, 1 => 20_000..400_000u64];
    (faults(), (1..120usize, interval, 1..32u8, 0..32u8))
}

/// Whether both are the same findings. A speed that lies between two decimals may be rounded to either.
fn are_alike(a: &Findings, b: &Findings) -> bool {
    let is_same = |(a, b): (&str, &str)| match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(a), Ok(b)) => (a - b).abs() < 0.11,
        _ => a == b,
    };
    let words = |violation: &Violation| violation.text.split(' ').map(str::to_owned).collect::<Vec<_>>();
    a.total == b.total
        && a.first.len() == b.first.len()
        && a.first.iter().zip(&b.first).all(|(a, b)| {
            let (left, right) = (words(a), words(b));
            let are_same = left.iter().zip(&right).all(|(left, right)| is_same((left, right)));
            a.tick == b.tick && left.len() == right.len() && are_same
        })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn short_cuts_change_no_finding(
        name in proptest::sample::select(&MACHINES[..]),
        flags: [bool; 4],
        stretches in prop::collection::vec(stretches(), 1..30),
        is_counted: bool,
    ) {
        let s = machine(name);
        let mut limits = Limits::new(&s, None, "");
        (limits.circulates, limits.trims) = (flags[0] && flags[3], flags[1]);
        (limits.levels, limits.is_judged) = (flags[2], flags[0] || flags[3]);
        let (mut checker, mut plain) = (Checker::new(&s, &limits), Plain::new(&s, &limits));
        let (mut tick, mut counts) = (0u64, [0i32; MOTORS]);
        let mut event = |tick: u64, steps: u8, forward: u8| {
            checker.event(tick, MotorSet(steps), MotorSet(forward));
            plain.event(tick, MotorSet(steps), MotorSet(forward));
            for (motor, count) in counts.iter_mut().enumerate() {
                *count += i32::from(steps >> motor & 1) * (2 * i32::from(forward >> motor & 1) - 1);
            }
        };
        for (fault, (times, interval, groups, directions)) in stretches {
            match fault {
                Fault::Nothing => {}
                Fault::Alone(steps, forward) => event(tick, steps, forward),
                Fault::Pause(ticks) => tick += ticks,
                Fault::Back(ticks) => tick = tick.saturating_sub(ticks),
            }
            let (mut steps, mut forward) = (0, 0);
            for (place, group) in Groups::new(&s.mechanism).iter().enumerate().filter(|(place, _)| groups >> place & 1 != 0) {
                steps |= group.motors().0;
                forward |= if directions >> place & 1 != 0 { group.with.0 } else { group.against.0 };
            }
            for _ in 0..times {
                tick += interval;
                event(tick, steps, forward);
            }
        }
        let expected = if is_counted { counts } else { [3; MOTORS] };
        let (found, due) = (checker.finish(Some(expected)), plain.finish(expected));
        prop_assert!(are_alike(&found, &due), "{found:?}\ninstead of {due:?}");
    }
}
