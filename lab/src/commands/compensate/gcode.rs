//! Compensates G-code for the tool's lag in advance, for the unchanged firmware.
//!
//! The file goes through the firmware once. Each stretch of motion between two rests is then a path in time. It is sent
//! ahead ([`crate::compensation`]) and written as chords, each with a feed that keeps its duration. The planner
//! must not slow them down: accelerations and corners are set so high that belt motors alone limit them
//! (`motor_max_acceleration` of the machine). The durations of the chords already contain the file's own limits.

use super::sections::{Kind, Line, Modes, Section, is_kept, is_origin, sections};
use crate::compensation::chords::vertices;
use crate::compensation::path::{RATE, sampled};
use crate::compensation::{Lead, lead_of};
use anyhow::{Context as _, Result, bail, ensure};
use corehbot::motors::{MOTORS, MotorSet};
use corehbot::settings::{CornerRule, Settings, ShaperKind};
use corehbot_host::printer::Printer;
use corehbot_host::progress::Watched;
use corehbot_host::stop::Stop;
use corehbot_questions::source::Log;
use corehbot_sim::host::FileHost;
use corehbot_sim::moves::{MadeMove, ShaperChange};
use corehbot_sim::trace::Header;
use corehbot_sim::world::{self, Host, Sink};
use corehbot_twin::math::{hypot, powi};
use corehbot_twin::params::Params;
use corehbot_twin::routing::{Machine, Place};
use corehbot_twin::steps::{Planned, StepTrace, TICKS_PER_SECOND};
use std::cell::Cell;
use std::fmt::Write as _;

/// The command that ends a section, so that its end is known.
const REST: &str = "M400";

/// Time before the first step and after the last in which the motors are sent ahead, in ticks: five widths of 4 ms and
/// more.
const MARGIN: u64 = 300_000;

/// Decimals of a way: 0.01 um.
const DECIMALS: i32 = 5;

/// Ways of the tool shorter than this, 2 um, wait. The firmware counts less than 0.5 um as no way, and filament that
/// goes with them would get their speed.
const LEAST_WAY: i64 = 200;

/// The limits for planning the chords: the greatest legal values, so that motors limit x and y alone. From chord to
/// chord the speed of filament changes by less than this jerk.
const LIMITS: &str = "M201 X100000 Y100000 Z100000 E100000\nM204 P100000 R100000 T100000\nM205 J1 E20\n";

/// A file that was played, in sections.
pub(super) struct Played {
    settings: Settings,
    sections: Vec<(Section, Modes)>,
    /// The events of each section.
    ends: Vec<usize>,
    pub steps: StepTrace,
}

/// A compensated file.
pub(super) struct Compensated {
    pub text: String,
    /// The most that the tool is sent ahead, along x and y.
    pub ahead_mm: [f64; 2],
    pub chords: usize,
}

impl Played {
    /// Runs a file through the firmware; shapers are off, for both do the same.
    pub(super) fn new(gcode: &str, printer: &Printer, stop: &Stop) -> Result<Self> {
        let settings = printer.machine()?.settings;
        let sections = sections(gcode);
        let mut text = String::from("M593 F0\n");
        for (section, _) in &sections {
            match section {
                Section::Motion(lines) => {
                    let sent = lines.iter().filter(|line| !is_shaper(&line.text));
                    sent.for_each(|line| text.extend([&line.text, "\n"]));
                }
                Section::Still(command) if command == REST => {}
                Section::Still(command) => text.extend([command, "\n"]),
            }
            text.extend([REST, "\n"]);
        }
        let (steps, ends) = run(&text, printer, stop)?;
        ensure!(ends.len() > sections.len(), "the print ended before the file");
        Ok(Self { settings, sections, ends, steps })
    }

    /// Rewrites it for a machine that begins with its tool at `start`, with the stiffness and masses of `believed`.
    pub(super) fn compensated(
        &self,
        (machine, believed): (Machine, &Params),
        start: Place,
        width_s: f64,
    ) -> Result<Compensated> {
        let mut done = Compensated { text: head(), ahead_mm: [0.0; 2], chords: 0 };
        let mut at = Cursor::new(&self.settings);
        let mut events = self.steps.events.iter();
        let mut begin = 0;
        let mut limits = limits(&self.settings);
        for ((section, modes), end) in self.sections.iter().zip(&self.ends) {
            let some = events.by_ref().take(end - begin);
            begin = *end;
            match section {
                Section::Still(command) => {
                    some.for_each(|event| at.step(event));
                    if command != REST {
                        done.text.extend([command, "\n"]);
                    }
                }
                Section::Motion(lines) => {
                    let place = at.place(start);
                    let stretch = Stretch::new(&self.steps, some, &mut at);
                    let planned = lines.iter().filter(|line| line.kind == Kind::Plan && !is_shaping(&line.text));
                    planned.for_each(|line| limits.extend([&line.text, "\n"]));
                    if stretch.steps.events.is_empty() {
                        lines.iter().filter(|line| line.kind != Kind::Move).for_each(|line| pass(line, &mut done.text));
                        done.text.push_str(&modes.text(lines));
                        done.text.push_str(&limits);
                        done.text.extend([REST, "\n"]);
                        continue;
                    }
                    done.text.push_str(LIMITS);
                    let lead = lead_of(machine, believed, place, &stretch.steps, width_s)?;
                    for (most, ahead) in done.ahead_mm.iter_mut().zip(lead.ahead_mm) {
                        *most = most.max(ahead);
                    }
                    done.chords += stretch.write(&lead, lines, &mut done.text);
                    done.text.push_str(&modes.text(lines));
                    done.text.push_str(&limits);
                }
            }
            done.text.extend([REST, "\n"]);
        }
        done.text.push_str(&tail(&self.settings, &self.sections));
        Ok(done)
    }

    /// Steps after the last homing, of the played file or of its compensated version, and the tool's place then.
    pub(super) fn after_homing(&self, steps: &StepTrace, ends: &[usize], start: Place) -> (StepTrace, Place) {
        let is_homing =
            |(section, _): &(Section, Modes)| matches!(section, Section::Still(text) if text.starts_with("G28"));
        let homed = self.sections.iter().rposition(is_homing);
        let first = homed.and_then(|section| ends.get(section)).copied().unwrap_or(0);
        let mut at = Cursor::new(&self.settings);
        let (before, after) = steps.events.split_at(first.min(steps.events.len()));
        before.iter().for_each(|event| at.step(event));
        let (place, begin) = (at.place(start), at.tick);
        let mut rest = StepTrace::new(steps.columns.clone(), steps.step_mm);
        for event in after {
            at.step(event);
            rest.add(at.tick - begin, event.steps, event.forward);
        }
        let later = steps.plan.iter().filter(|planned| planned.ticks[0] >= begin);
        rest.plan = later.map(|one| Planned { ticks: one.ticks.map(|tick| tick - begin), ..*one }).collect();
        (rest, place)
    }

    /// The events of each section.
    pub(super) fn ends(&self) -> &[usize] {
        &self.ends
    }
}

/// Runs G-code, and says after how many events each [`REST`] was over.
pub(super) fn run(gcode: &str, printer: &Printer, stop: &Stop) -> Result<(StepTrace, Vec<usize>)> {
    let machine = printer.machine()?;
    let count = Cell::new(0);
    let mut log = Counted { log: Log::new(&machine.settings), count: &count };
    let host = Watched::new(FileHost::new(gcode), stop);
    let mut host = Marked { host, count: &count, ends: Vec::new(), is_resting: false };
    let outcome = match &mut printer.eeprom()? {
        Some(eeprom) => world::run_with(&machine.settings, printer.assume_homed, eeprom, &mut [&mut host], &mut log),
        None => world::run(&machine.settings, printer.assume_homed, &mut host, &mut log),
    };
    let Marked { host, mut ends, .. } = host;
    let host = host.finish();
    let outcome = outcome.context("the simulation failed")?;
    if stop.is_set() {
        bail!("interrupted after {} of {} commands", host.answered(), host.commands());
    }
    if let Some(failure) = host.failure() {
        bail!("the print failed: {failure}");
    }
    ensure!(!outcome.halted, "the print failed: an emergency stop holds");
    ends.push(count.get());
    Ok((log.log.steps, ends))
}

/// A host that notes where rests are.
struct Marked<'s, 'c> {
    host: Watched<'s>,
    count: &'c Cell<usize>,
    ends: Vec<usize>,
    is_resting: bool,
}

impl Host for Marked<'_, '_> {
    fn send(&mut self, out: &mut Vec<u8>) {
        let before = out.len();
        self.host.send(out);
        let Some(sent) = out.get(before..).filter(|sent| !sent.is_empty()) else { return };
        // All earlier lines have been answered.
        if self.is_resting {
            self.ends.push(self.count.get());
        }
        let command = sent.split(|byte| *byte == b' ').nth(1).unwrap_or_default();
        self.is_resting = command.starts_with(REST.as_bytes());
    }

    fn clock(&mut self, tick: u64) {
        self.host.clock(tick);
    }

    fn interject(&mut self, out: &mut Vec<u8>) {
        self.host.interject(out);
    }

    fn hear(&mut self, line: &str) {
        self.host.hear(line);
    }

    fn is_done(&self) -> bool {
        self.host.is_done()
    }
}

/// Keeps the steps and counts them.
struct Counted<'c> {
    log: Log,
    count: &'c Cell<usize>,
}

impl Sink for Counted<'_> {
    fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        self.log.event(tick, steps, forward);
        self.count.set(self.log.steps.events.len());
    }

    fn wants_moves(&self) -> bool {
        self.log.wants_moves()
    }

    fn moved(&mut self, made: &MadeMove) {
        self.log.moved(made);
    }

    fn reshaped(&mut self, change: &ShaperChange) {
        self.log.reshaped(change);
    }
}

/// Where motors and tool are.
struct Cursor {
    back: corehbot::kinematics::ForwardKinematics<{ MOTORS }>,
    /// mm a step of x, y, z and e.
    step: [f64; 4],
    counts: [i64; MOTORS],
    tick: u64,
}

impl Cursor {
    fn new(settings: &Settings) -> Self {
        let resolution = Header::from(settings).steps_per_mm;
        let back = settings.mechanism.forward_kinematics().unwrap_or(corehbot::kinematics::ForwardKinematics::NONE);
        let step = resolution.map(|steps| 1.0 / steps.to_num::<f64>());
        Self { back, step, counts: [0; MOTORS], tick: 0 }
    }

    fn step(&mut self, event: &corehbot_twin::steps::Event) {
        self.tick += u64::from(event.gap);
        for (motor, count) in self.counts.iter_mut().enumerate() {
            let steps = i64::from(event.steps >> motor & 1);
            *count += steps * (2 * i64::from(event.forward >> motor & 1) - 1);
        }
    }

    /// x, y, z and e in mm since power-up.
    fn at(&self) -> [f64; 4] {
        let parts = self.back.fractions(&self.counts);
        std::array::from_fn(|i| parts[i].0 as f64 / parts[i].1 as f64 * self.step[i])
    }

    fn place(&self, start: Place) -> Place {
        let [x, y, ..] = self.at();
        Place::flat(start.x + x, start.y + y)
    }
}

/// Motion from rest to rest.
struct Stretch {
    steps: StepTrace,
    /// Times in s at which z and e in mm from the begin became something else.
    zs: Vec<(f64, f64)>,
    es: Vec<(f64, f64)>,
}

impl Stretch {
    fn new<'e>(
        whole: &StepTrace,
        events: impl Iterator<Item = &'e corehbot_twin::steps::Event>,
        at: &mut Cursor,
    ) -> Self {
        let [_, _, z, e] = at.at();
        let mut stretch =
            Self { steps: StepTrace::new(whole.columns.clone(), whole.step_mm), zs: Vec::new(), es: Vec::new() };
        let mut begin = None;
        for event in events {
            at.step(event);
            let tick = MARGIN + at.tick - *begin.get_or_insert(at.tick);
            stretch.steps.add(tick, event.steps, event.forward);
            let time = tick as f64 / TICKS_PER_SECOND;
            let [_, _, now_z, now_e] = at.at();
            stretch.zs.push((time, now_z - z));
            stretch.es.push((time, now_e - e));
        }
        stretch
    }

    /// Writes its chords and the commands under way; returns the number of chords.
    fn write(self, lead: &Lead, lines: &[Line], text: &mut String) -> usize {
        let count = lead.meant.len();
        let (zs, es) = (sampled(self.zs, count), sampled(self.es, count));
        let sample = |i: usize| {
            let ([x, y], [ahead_x, ahead_y]) = (lead.meant[i], lead.added[i]);
            [x + ahead_x, y + ahead_y, zs[i], es[i]]
        };
        let samples: Vec<[f64; 4]> = (0..count).map(sample).collect();
        let ways: Vec<f64> = std::iter::once(0.0)
            .chain(lead.meant.windows(2).scan(0.0, |sum, pair| {
                *sum += hypot(pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]);
                Some(*sum)
            }))
            .collect();
        let whole = ways.last().copied().unwrap_or(0.0).max(f64::MIN_POSITIVE);
        let mut asides = lines.iter().filter(|line| line.kind != Kind::Move).peekable();
        text.push_str("G21\nG91\nM83\n");
        let (mut sent, mut chords) = ([0_i64; 4], 0);
        for pair in vertices(&samples).windows(2) {
            let [begin, end] = [pair[0], pair[1]];
            while let Some(line) = asides.next_if(|line| line.part * whole <= ways[begin]) {
                pass(line, text);
            }
            let to = samples[end].map(|mm| (mm * powi(10.0, DECIMALS)).round() as i64);
            let way = made(std::array::from_fn(|i| to[i] - sent[i]), end + 1 == count);
            chords += usize::from(chord(way, (end - begin) as f64 / RATE, text));
            sent = std::array::from_fn(|i| sent[i] + way[i]);
        }
        asides.for_each(|line| pass(line, text));
        chords
    }
}

/// The part of a way that is moved now; the rest waits for the next chord.
fn made(way: [i64; 4], is_last: bool) -> [i64; 4] {
    let [x, y, z, e] = way;
    let is_short = x.pow(2) + y.pow(2) + z.pow(2) < LEAST_WAY * LEAST_WAY;
    if is_short && !is_last { [0, 0, 0, e] } else { way }
}

/// Writes a move of `way` units of the last decimal in `duration_s`, if it is one.
fn chord(way: [i64; 4], duration_s: f64, text: &mut String) -> bool {
    let mm = way.map(|units| units as f64 / powi(10.0, DECIMALS));
    let tool = mm[..3].iter().map(|way| way * way).sum::<f64>().sqrt();
    let length = if tool > 0.0 { tool } else { mm[3].abs() };
    if length == 0.0 {
        return false;
    }
    text.push_str("G1");
    for (letter, (units, mm)) in ['X', 'Y', 'Z', 'E'].into_iter().zip(way.into_iter().zip(mm)) {
        if units != 0 {
            let _ = write!(text, " {letter}{mm}");
        }
    }
    let _ = writeln!(text, " F{:.1}", (60.0 * length / duration_s).max(0.6));
    true
}

/// Writes the rest of a command, without moves, which are planned elsewhere.
fn pass(line: &Line, text: &mut String) {
    match line.kind {
        // Places get their names where the stretch ends.
        Kind::Aside if is_origin(&line.text) => {}
        Kind::Aside => text.extend([&line.text, "\n"]),
        Kind::Plan if is_kept(&line.text) => text.extend([&line.text, "\n"]),
        Kind::Plan | Kind::Move | Kind::Mode | Kind::Still => {}
    }
}

fn head() -> String {
    "; compensated by corehbot-lab compensate: the limits of its motion are in the feeds\nM593 F0\nM900 K0\n".to_owned()
}

/// The machine's limits for commands between stretches, such as homing.
fn limits(s: &Settings) -> String {
    let [x, y, z, e] = s.axes.to_array().map(|axis| axis.max_acceleration);
    let (print, retract, travel) = (s.print_acceleration, s.retract_acceleration, s.travel_acceleration);
    let corner = match s.corner {
        CornerRule::JunctionDeviation(mm) => format!("J{mm}"),
        CornerRule::SquareCorner(speed) => format!("X{speed}"),
    };
    let jerk = s.extruder_jerk;
    format!("M201 X{x} Y{y} Z{z} E{e}\nM204 P{print} R{retract} T{travel}\nM205 {corner} E{jerk}\n")
}

/// Shapers and advance, as they are on the machine or as the file set them.
fn tail(s: &Settings, sections: &[(Section, Modes)]) -> String {
    let mut text = format!("M900 K{}\n", s.advance.time);
    for (letter, shaper) in [('X', s.shapers.x), ('Y', s.shapers.y)] {
        // Numbered from 0 on as `all` has them, without the kind "none".
        let kinds = ShaperKind::all().filter(|kind| *kind != ShaperKind::None);
        if let Some((number, _)) = kinds.enumerate().find(|(_, kind)| *kind == shaper.kind) {
            let _ = writeln!(text, "M593 {letter} F{} D{} T{number}", shaper.frequency, shaper.damping);
        }
    }
    for (section, _) in sections {
        let Section::Motion(lines) = section else { continue };
        let planned = lines.iter().filter(|line| line.kind == Kind::Plan && is_shaping(&line.text));
        planned.for_each(|line| text.extend([&line.text, "\n"]));
    }
    text
}

fn is_shaper(text: &str) -> bool {
    matches!(corehbot_sim::file_line::words(text).next(), Some(('M', Some(593.0))))
}

/// Commands that shape the motion of tool or filament; their effect is in the chords.
fn is_shaping(text: &str) -> bool {
    is_shaper(text)
        || matches!(corehbot_sim::file_line::words(text).next(), Some(('M', Some(572.0 | 900.0))))
        || text.starts_with("SET_PRESSURE_ADVANCE")
}
