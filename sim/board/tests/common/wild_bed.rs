//! Properties of a bed, its probe and its screws whatever a host says and whatever breaks: one body for the fuzzer and
//! for tests by seed.

use corehbot::connectors::{ConnectorName, Heater};
use corehbot::motors::MotorSet;
use corehbot::settings::{OnFailure, ProbeKind, Settings};
use corehbot::units::{Celsius, Mm, TICKS_PER_MS};
use corehbot_rig::bed::probe::ProbeFault;
use corehbot_rig::bed::screws::ScrewSetup;
use corehbot_rig::bed::{BedPlant, BedSetup};
use corehbot_sim::drivers::Drivers;
use corehbot_sim::eeprom::Eeprom;
use corehbot_sim::world::{Desk, Sink, World};

/// A line may take so long, with all that it waits for, in ms.
const PATIENCE_MS: u64 = 1_500_000;

/// A kept line waits for its user that long, in ms.
const HELD_MS: u64 = 3_000;

/// So far the nozzle may be below the expected touch (`LOW` of `machine/probe/touch.rs`), in mm.
const FLOOR_MM: f64 = 2.0;

/// A position is told to 0.01 mm, and a step of z is 1.25 um.
const TOLD_MM: f64 = 0.005 + 0.0015;

/// Where a probe's trigger is seen from the nozzle, in mm.
const SWITCH_Z: f64 = -1.5;

/// Heights that M851 may name: near the true ones.
const HIGHEST_OFFSET: f64 = 0.2;

/// Lines about the bed, and those that users mix with them. `x`, `y`, `z`, `f` and `?` stand for numbers.
const LINES: &str = "\
    G28 | G28 | G28 Z | G28 X Y | G28 O | G28 W | G28 L0 | G28 R5 Z | G29 | G29 | G29 V4 E | G29 O | G29 D | G29 N |\
    G29 J | G29 A | G29 L60 R160 F60 B160 | G29 P1 Xx Yy W60 H60 C | G29 P3.2 | G29 P9 | G29 H50 | G29 W I1 J1 Z0.1 |\
    G29 W X100 Y100 Z-0.1 | G29 L900 | G30 | G30 Xx Yy | G30 Xx Yy E0 | G30 X1 Y1 | G34 | G34 I2 T0.05 A0.9 | G34 E |\
    G34 I99 | Z_TILT_ADJUST | QUAD_GANTRY_LEVEL RETRIES=2 RETRY_TOLERANCE=0.05 | G35 | G35 S41 | G35 S99 |\
    G42 I1 J1 Ff | G42 I0 J2 P | G42 I9 J9 | G80 | M48 P4 | M48 P4 Xx Yy V2 | M48 P5 E V4 | M48 P4 L2 S1 | M48 P999 |\
    M280 | M280 P0 S10 | M280 P0 S60 | M280 P0 S90 | M280 P0 S160 | M280 P0 S1472 | M280 P0 S-1 | M280 P7 S9999 |\
    M290 Z0.05 | M290 Z-0.05 | M290 | M401 | M401 S1 | M401 S0 | M401 H | M402 | M420 | M420 S0 | M420 S1 |\
    M420 S1 Z5 | M420 Z0 | M420 V1 T1 | M420 C | M420 L0 | M421 I0 J0 Z0.1 | M421 I1 J1 Q-0.05 | M421 C Q0.05 |\
    M421 I9 J0 N | M422 | M422 S1 X60 Y200 | M422 S2 X320 Y200 | M422 W1 X-25 Y200 | M422 R | M851 | M851 X-20 Y5 |\
    M851 Z? | M851 Z-99 | BED_MESH_CALIBRATE | BED_MESH_CALIBRATE ADAPTIVE=1 | BED_MESH_CLEAR | BED_MESH_OUTPUT |\
    BED_MESH_PROFILE LOAD=a | BED_MESH_PROFILE SAVE=a |\
    EXCLUDE_OBJECT_DEFINE NAME=a POLYGON=[[150,180],[230,180],[230,215]] | M555 Xx Yy W50 H50 | M500 | M501 | M119 |\
    M75 | G1 Xx Yy Zz Ff | G1 Xx Yy Zz Ff | G1 Xx Yy Zz Ff | M104 S200 | M140 S60 | M84 | M25 | M24 | M110 N0";

/// Said while a line is under way.
const SHOUTS: [&str; 8] = ["M410", "M410", "M410", "M108", "M108", "M112", "M524", "M114"];

/// Faults of a probe, the sound one most often.
const FAULTS: [ProbeFault; 8] = [
    ProbeFault::None,
    ProbeFault::None,
    ProbeFault::None,
    ProbeFault::Stuck,
    ProbeFault::Dead,
    ProbeFault::Early,
    ProbeFault::Noisy,
    ProbeFault::Alarm,
];

/// Numbers out of bytes; 0 after the last one.
struct Choices<'d>(&'d [u8]);

impl Choices<'_> {
    fn below(&mut self, most: usize) -> usize {
        let Some((first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        usize::from(*first) % most
    }

    fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())]
    }

    fn is_over(&self) -> bool {
        self.0.is_empty()
    }
}

/// Steps are followed by the bed.
struct Deaf;

impl Sink for Deaf {
    fn event(&mut self, _tick: u64, _steps: MotorSet, _forward: MotorSet) {}
}

/// A prototype with a hotend and a bed, and one of these probes: a switch, a switch or a BLTouch that homes z, a
/// nozzle.
fn machine(choices: &mut Choices<'_>) -> (Settings, BedSetup) {
    let mut s = Settings::prototype();
    for heater in [Heater::Hotend, Heater::Bed] {
        s.thermal.heater_mut(heater).is_fitted = true;
    }
    s.probe_plug.connector = ConnectorName::lit("PROBE");
    (s.probe.kind, s.probe.homes_z) = choices.pick(&[
        (ProbeKind::Switch, false),
        (ProbeKind::Switch, true),
        (ProbeKind::BlTouch, true),
        (ProbeKind::Nozzle, false),
    ]);
    if s.probe.kind != ProbeKind::Nozzle {
        (s.probe.offset.x, s.probe.offset.z) = (Mm::from_num(-30), Mm::from_num(SWITCH_Z));
    }
    s.probe.samples = 1 + choices.below(2) as u8;
    (s.mesh.columns, s.mesh.rows) = (3, 3);
    s.job.on_failure = choices.pick(&[OnFailure::Cancel, OnFailure::Pause]);
    let mut bed = BedSetup::of(&s);
    bed.surface.tilt = [0.0, 0.0004];
    bed.surface.bowl = choices.pick(&[0.0, 0.15, -0.1]);
    bed.probe.noise = choices.pick(&[0.0, 0.003]);
    let lean = choices.pick(&[0.0, 0.3, -0.2]);
    for (screw, height) in s.screws.iter().zip([lean, -lean]) {
        let at = [screw.place.x, screw.place.y].map(f64::from);
        bed.screws.push(ScrewSetup { at, height, play: 0.0 }).unwrap();
    }
    (s, bed)
}

/// A machine, and what is known of it.
struct Watched<'w> {
    world: World<'w>,
    settings: Settings,
    /// The place of the tool over the bed whose height G34 keeps.
    reference: [f64; 2],
    /// Real z over the bed there, less z as it is told, since z was homed.
    zero: Option<f64>,
    partial: Vec<u8>,
    heard: Vec<String>,
    /// All that was said and heard, with its time in ms, and what broke.
    log: Vec<String>,
    /// Lines, and their answers.
    sent: usize,
    oks: usize,
    /// The probe never triggers.
    is_dead: bool,
}

impl Watched<'_> {
    fn ms(&self) -> u64 {
        self.world.now() / u64::from(TICKS_PER_MS)
    }

    fn story(&self) -> String {
        self.log[self.log.len().saturating_sub(60)..].join("\n")
    }

    fn turn(&mut self) {
        self.world.poll();
        self.partial.extend(self.world.wires()[0].heard());
        while let Some(end) = self.partial.iter().position(|byte| *byte == b'\n') {
            let line: Vec<u8> = self.partial.drain(..=end).collect();
            let line = String::from_utf8_lossy(&line).trim_end().to_owned();
            self.oks += usize::from(line == "ok" || line.starts_with("ok "));
            if !line.starts_with("echo:busy") && !line.is_empty() {
                self.log.push(format!("{:>8} < {line}", self.ms()));
                self.heard.push(line);
            }
        }
        self.world.advance();
        self.look();
    }

    /// The nozzle is no deeper than the floor of a touch. The place of z may be wrong by what was told to it.
    fn look(&mut self) {
        let [x, y, z] = self.world.nozzle();
        let deepest = FLOOR_MM + self.settings.probe.offset.z.to_num::<f64>() + HIGHEST_OFFSET;
        let bed = self.world.bed().unwrap();
        let is_deep = self.zero.is_some_and(|zero| z - bed.height(self.reference) - zero < -deepest - 0.01);
        let depth = bed.height([x, y]) - z;
        assert!(!is_deep && depth < FLOOR_MM + 1.5, "{depth} mm deep in the bed\n{}", self.story());
    }

    fn rest(&mut self, ms: u64) {
        let until = self.ms() + ms;
        while self.ms() < until && !self.world.has_ended() {
            self.turn();
        }
    }

    fn put(&mut self, line: &str) {
        self.log.push(format!("{:>8} > {line}", self.ms()));
        self.sent += 1;
        self.world.wires()[0].put(format!("{line}\n").into_bytes());
    }

    fn fail(&mut self, fault: ProbeFault) {
        self.log.push(format!("{:>8} ! {fault:?}", self.ms()));
        self.is_dead = fault == ProbeFault::Dead;
        self.world.bed().unwrap().fail(fault);
    }

    fn is_halted(&self) -> bool {
        self.world.status().is_halted()
    }

    /// Sends a line, shouts or breaks the probe meanwhile if the choices say so, and helps it on if it is kept.
    fn say(&mut self, line: &str, choices: &mut Choices<'_>) {
        let homes = line.starts_with("G28") || line == "G29 N";
        if homes || line.starts_with("M851") || line == "M501" {
            self.zero = None;
        }
        // A probe that is dead is not found while z is homed by it: no floor is known.
        let must_live = self.settings.probe.homes_z && homes;
        if must_live && self.is_dead {
            self.fail(ProbeFault::None);
        }
        let before = self.heard.len();
        self.put(line);
        if choices.below(5) == 0 {
            self.rest(1 + 37 * choices.below(256) as u64);
            let shout = choices.pick(&SHOUTS);
            self.put(shout);
        } else if choices.below(6) == 0 && !must_live {
            self.rest(1 + 53 * choices.below(256) as u64);
            let fault = choices.pick(&FAULTS);
            self.fail(fault);
        }
        self.await_oks(choices);
        self.rest(60);
        // Where z is, nothing knows.
        if self.heard[before..].iter().any(|line| line.starts_with("echo:homing was interrupted")) {
            self.zero = None;
        }
        let is_over = |line: &String| line.contains("heaters are off");
        if self.heard[before..].iter().any(is_over) || self.is_halted() {
            let heat = self.world.status().heat();
            let is_cold = Heater::ALL.iter().all(|heater| heat.target(*heater) == Celsius::ZERO);
            assert!(is_cold || line.starts_with("M1"), "heaters stay on after an end\n{}", self.story());
        }
    }

    fn await_oks(&mut self, choices: &mut Choices<'_>) {
        let begin = self.ms();
        let (mut held, mut helps) = (begin + HELD_MS, 0);
        while self.oks < self.sent && !self.is_halted() && !self.world.has_ended() {
            self.turn();
            assert!(self.ms() < begin + PATIENCE_MS, "no answer\n{}", self.story());
            let is_kept = self.heard.iter().rev().take(12).any(|line| line.starts_with("echo:print held"));
            if is_kept && self.ms() > held {
                held = self.ms() + HELD_MS;
                helps += 1;
                if helps > 2 || choices.below(2) == 0 {
                    self.fail(ProbeFault::None);
                }
                self.zero = None;
                let help = if helps > 4 { "M524" } else { choices.pick(&["M24", "M24", "G28", "M108", "M524"]) };
                // The kept line may home z.
                if self.settings.probe.homes_z && self.is_dead {
                    self.fail(ProbeFault::None);
                }
                self.put(help);
            }
        }
        assert!(self.oks <= self.sent, "more answers than lines\n{}", self.story());
    }

    /// The position that is told is the real one, and z is over the bed as it was after z was homed.
    fn check_position(&mut self) {
        self.quietly("M400");
        let is_on = self.answer("M420", "echo:Bed Leveling") == "echo:Bed Leveling ON";
        self.quietly("M420 S0");
        // Positions do not tell shifts by M290.
        let [place, shift] =
            [("M114 R", "X:"), ("M290", "echo:Babystep")].map(|(line, begin)| self.answer(line, begin));
        let number = |told: &str, letter: &str| -> f64 {
            let after = told.split(letter).nth(1).and_then(|rest| rest.split_whitespace().next());
            after.and_then(|text| text.parse().ok()).unwrap_or(f64::NAN)
        };
        let [x, y, z] = self.world.nozzle();
        let off = [number(&place, "X:") - x, number(&place, "Y:") - y];
        assert!(off.iter().all(|off| off.abs() < TOLD_MM), "{place}, real X{x} Y{y}\n{}", self.story());
        let told = number(&place, "Z:") + number(&shift, "Babystep Z");
        let zero = z - self.world.bed().unwrap().height(self.reference) - told;
        let was = *self.zero.get_or_insert(zero);
        let is_there = (zero - was).abs() < 2.0 * TOLD_MM;
        assert!(is_there, "{place}, {shift}: z was {was} over the bed, is {zero}\n{}", self.story());
        if is_on {
            self.quietly("M420 S1");
        }
    }

    /// The line of the answer that begins so.
    fn answer(&mut self, line: &str, begin: &str) -> String {
        let before = self.heard.len();
        self.quietly(line);
        self.heard[before..].iter().find(|line| line.starts_with(begin)).cloned().unwrap_or_default()
    }

    /// Says a line without any accident.
    fn quietly(&mut self, line: &str) {
        self.put(line);
        self.await_oks(&mut Choices(&[]));
    }
}

/// A line with numbers for its letters.
fn fill(line: &str, choices: &mut Choices<'_>, probe_z: f64) -> String {
    let mut filled = String::new();
    for letter in line.chars() {
        match letter {
            'x' | 'y' => filled += &(60 + choices.below(256)).to_string(),
            'z' => filled += &format!("{:.1}", 6.0 + choices.below(100) as f64 / 10.0),
            'f' => filled += &(3000 + 40 * choices.below(256)).to_string(),
            '?' => filled += &format!("{:.2}", probe_z + (choices.below(41) as f64 - 20.0) / 100.0),
            letter => filled.push(letter),
        }
    }
    filled
}

/// Two lives of a machine out of `data`: the second one keeps its bed and its storage, and begins unhomed.
pub fn bed_gcode(data: &[u8]) {
    let known: Vec<_> = LINES.split('|').map(str::trim).collect();
    let mut choices = Choices(data);
    let (settings, bed) = machine(&mut choices);
    let (mut storage, mut bed) = (Eeprom::blank(), Box::new(BedPlant::new(&settings, &bed)));
    let (first, second) = choices.0.split_at(choices.0.len() / 2);
    for (life, data) in [first, second].into_iter().enumerate() {
        let mut choices = Choices(data);
        let mut desk = Desk::new(1);
        desk.bed = Some(bed);
        let (drivers, mut sink) = (Drivers::new(), Deaf);
        let place = Some([100, 100, 20].map(Mm::from_num));
        let start = if life == 0 { place } else { None };
        let world = World::standing(&mut desk, &settings, place, start, &mut storage, &drivers, &mut sink);
        let reference = middle(&settings);
        let mut watched = Watched {
            world,
            settings,
            reference,
            zero: None,
            partial: Vec::new(),
            heard: Vec::new(),
            log: Vec::new(),
            sent: 0,
            oks: 0,
            is_dead: false,
        };
        watched.rest(200);
        watched.fail(ProbeFault::None);
        watched.quietly("G28");
        let mut number = 0;
        while !(choices.is_over() || watched.is_halted() || watched.world.has_ended()) {
            number += 1;
            if choices.below(6) == 0 {
                let fault = choices.pick(&FAULTS);
                watched.fail(fault);
            }
            let line = fill(
                choices.pick(&known),
                &mut choices,
                if settings.probe.kind == ProbeKind::Nozzle { 0.0 } else { SWITCH_Z },
            );
            watched.say(&line, &mut choices);
            if number % 3 == 0 && !watched.is_halted() {
                watched.check_position();
            }
        }
        if watched.is_halted() {
            watched.rest(100);
            let heat = watched.world.heat();
            let is_off = Heater::ALL.iter().all(|heater| heat.duty(*heater).is_none_or(|duty| duty == 0));
            assert!(is_off, "power after a stop\n{}", watched.story());
        }
        drop(watched);
        bed = desk.bed.take().unwrap();
    }
}

/// The middle of the bed, where z is homed and the screws keep its height.
fn middle(s: &Settings) -> [f64; 2] {
    let bed = s.bed;
    [
        bed.left.to_num::<f64>() + bed.width.to_num::<f64>() / 2.0,
        bed.front.to_num::<f64>() + bed.depth.to_num::<f64>() / 2.0,
    ]
}
