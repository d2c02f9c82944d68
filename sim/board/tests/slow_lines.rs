//! Slow serial lines: a long answer waits for room, lines that a command says on its way do not, and prints go on.

use crate::common::trace::Trace;
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot::units::{Mm, TICKS_PER_SECOND};
use corehbot_sim::drivers::Drivers;
use corehbot_sim::host::FileHost;
use corehbot_sim::world::{Desk, Host, Outcome, run_at};

/// Bytes a second at 115,200 baud, and at the slowest rate (`settings::ranges::BAUD`).
const USUAL: u32 = 11_520;
const SLOWEST: u32 = 960;

/// Sends a line when the one before is answered and so many ticks are over, and keeps everything it hears.
struct Asker {
    lines: Vec<String>,
    every: u64,
    now: u64,
    due: u64,
    next: usize,
    awaiting: bool,
    heard: Vec<String>,
}

impl Asker {
    fn new(every_s: u32, lines: impl IntoIterator<Item = impl Into<String>>) -> Self {
        let (lines, every) = (lines.into_iter().map(Into::into).collect(), u64::from(every_s * TICKS_PER_SECOND));
        Self { lines, every, now: 0, due: 0, next: 0, awaiting: false, heard: Vec::new() }
    }

    /// The answers that have a line with this part, without lines that come by themselves.
    fn answers(&self, part: &str) -> Vec<Vec<&str>> {
        let is_report = |line: &&str| [" T:", "X:", "E0:", "echo:busy"].iter().any(|begin| line.starts_with(begin));
        let said: Vec<&str> = self.heard.iter().map(String::as_str).filter(|line| !is_report(line)).collect();
        let answers = said.split(|line| *line == "ok").filter(|answer| answer.iter().any(|line| line.contains(part)));
        answers.map(<[&str]>::to_vec).collect()
    }

    fn count(&self, part: &str) -> usize {
        self.heard.iter().filter(|line| line.contains(part)).count()
    }
}

impl Host for Asker {
    fn send(&mut self, out: &mut Vec<u8>) {
        self.interject(out);
    }

    fn interject(&mut self, out: &mut Vec<u8>) {
        if let Some(line) = self.lines.get(self.next).filter(|_| !self.awaiting && self.now >= self.due) {
            out.extend(format!("{line}\n").as_bytes());
            (self.next, self.awaiting, self.due) = (self.next + 1, true, self.now + self.every);
        }
    }

    fn clock(&mut self, tick: u64) {
        self.now = tick;
    }

    fn hear(&mut self, line: &str) {
        self.awaiting &= !line.starts_with("ok");
        self.heard.push(line.to_owned());
    }

    fn is_done(&self) -> bool {
        self.next == self.lines.len() && !self.awaiting
    }
}

fn run(settings: &Settings, bytes_a_second: u32, hosts: &mut [&mut dyn Host]) -> (Outcome, u64) {
    let mut desk = Desk::new(hosts.len());
    desk.slow_down(bytes_a_second);
    let (start, mut trace) = (Some([100, 100, 10].map(Mm::from_num)), Trace::default());
    let outcome = run_at(&mut desk, settings, start, NoStorage, &Drivers::new(), hosts, &mut trace).unwrap();
    (outcome, trace.hash())
}

/// While a long answer waits for room no other line is carried out, so a print needs moves for half a second then.
#[test]
fn two_hosts_with_reports_and_long_answers_lose_nothing_and_stall_no_print_of_a_third() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/tiny.gcode");
    let gcode = std::fs::read_to_string(file).unwrap();
    let settings = Settings::prototype();
    let (_, alone) = run(&settings, USUAL, &mut [&mut FileHost::new(&gcode)]);
    let reports = ["M154 S1", "M155 S1", "M123 S1"];
    let asker = || Asker::new(3, reports.into_iter().chain(["M503", "M122", "M115"].repeat(3)));
    let (mut printing, mut a, mut b) = (FileHost::new(&gcode), asker(), asker());
    let (outcome, hash) = run(&settings, USUAL, &mut [&mut printing, &mut a, &mut b]);
    assert_eq!((outcome.underruns, hash), (0, alone));
    for asker in [&a, &b] {
        assert!(asker.count("X:") > 5 && asker.count(" T:") > 5, "{:?}", asker.heard);
        // All answers to M503 are the same.
        let answers = asker.answers("  M92 ");
        assert_eq!(answers.len(), 3);
        assert!(answers.iter().all(|answer| *answer == answers[0]), "{answers:?}");
    }
}

/// Each of them is said at once, behind an answer that is longer than a line has room for.
#[test]
fn values_out_of_range_are_all_told_on_the_slowest_line() {
    let mut settings = Settings::prototype();
    settings.accelerometer.kind = Some(corehbot::accelerometer::SensorKind::Adxl345);
    settings.thermal.heaters.hotend.is_fitted = true;
    let most = "-9999999.999";
    let sweep = ["FREQ_START", "FREQ_END", "ACCEL_PER_HZ", "HZ_PER_SEC", "SWEEPING_ACCEL", "SWEEPING_PERIOD"];
    let words = |names: &[&str], number: &str| names.iter().map(|name| format!(" {name}{number}")).collect::<String>();
    let lines = [
        format!("TEST_RESONANCES AXIS=X{}", words(&sweep, &format!("={most}"))),
        format!("M306 E0{}", words(&["P", "C", "A", "F", "R", "L", "H"], most)),
        format!("M203{}", words(&["X", "Y", "Z", "E"], "9999999.999")),
        format!("M201{}", words(&["X", "Y", "Z", "E"], most)),
    ];
    let mut asker = Asker::new(0, lines.into_iter().flat_map(|line| ["M503".to_owned(), line]));
    run(&settings, SLOWEST, &mut [&mut asker]);
    let told = ["TEST_RESONANCES ignored", "M306 ignored", "M203 ignored", "M201 ignored"];
    assert_eq!(told.map(|told| asker.count(told)), [6, 7, 4, 4], "{:#?}", asker.heard);
}
