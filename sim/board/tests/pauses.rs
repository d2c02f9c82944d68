//! Pauses: who is told, who ends them, and which work continues.

use crate::common::deaf::Deaf;
use corehbot::port::NoStorage;
use corehbot::protocol::{BUSY, BUSY_PAUSED};
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::world::{Host, Outcome, run_with};

/// Sends the next text when it hears a line that begins as awaited.
struct Talker {
    script: Vec<(&'static str, &'static str)>,
    next: usize,
    heard: Vec<String>,
    asked: usize,
}

impl Talker {
    fn new(script: &[(&'static str, &'static str)]) -> Self {
        Self { script: script.to_vec(), next: 0, heard: Vec::new(), asked: 0 }
    }

    fn count(&self, line: &str) -> usize {
        self.heard.iter().filter(|heard| heard.starts_with(line)).count()
    }

    fn place(&self, line: &str) -> usize {
        self.heard.iter().position(|heard| heard.starts_with(line)).unwrap()
    }
}

impl Host for Talker {
    fn send(&mut self, _out: &mut Vec<u8>) {}

    fn interject(&mut self, out: &mut Vec<u8>) {
        while let Some((awaited, text)) = self.script.get(self.next)
            && self.heard.last().is_some_and(|line| line.starts_with(awaited))
        {
            out.extend(text.as_bytes());
            self.asked += text.matches('\n').count();
            self.next += 1;
            self.heard.push(String::new());
        }
    }

    fn hear(&mut self, line: &str) {
        self.heard.push(line.to_owned());
    }

    fn is_done(&self) -> bool {
        self.next == self.script.len() && self.count("ok") >= self.asked
    }
}

fn talk(a: &mut Talker, b: &mut Talker) -> Outcome {
    let start = Some([100, 100, 10].map(Mm::from_num));
    run_with(&Settings::prototype(), start, NoStorage, &mut [a, b], &mut Deaf).unwrap()
}

#[test]
fn every_answer_ends_a_wait_for_the_user() {
    for answer in ["M108\n", "M24\n", "M602\n", "M876 S0\n", "N1 M108*43\n"] {
        let mut a = Talker::new(&[
            ("echo:corehbot", "G1 X110 F6000\nM600\n"),
            (BUSY_PAUSED, answer),
            ("ok", "G1 X120\nM400\nM114 R\n"),
        ]);
        let outcome = talk(&mut a, &mut Talker::new(&[]));
        assert_eq!((a.count("//action:paused"), a.count("//action:resumed")), (1, 1), "{answer}: {:?}", a.heard);
        assert_eq!((a.count("X:120.00"), outcome.moves), (1, 2), "{answer}");
        assert!(
            a.place("//action:paused") < a.place(BUSY_PAUSED) && a.place(BUSY_PAUSED) < a.place("//action:prompt_end")
        );
    }
}

#[test]
fn an_answer_in_the_same_packet_is_not_lost() {
    let mut a = Talker::new(&[("echo:corehbot", "M601\nM602\nG1 X120 F6000\nM400\n")]);
    let outcome = talk(&mut a, &mut Talker::new(&[]));
    assert_eq!((a.count("ok"), outcome.moves, a.count("//action:resumed")), (4, 1, 1), "{:?}", a.heard);
}

#[test]
fn what_only_says_that_a_host_can_ask_is_no_answer() {
    let mut a = Talker::new(&[("echo:corehbot", "M0 S9\n"), (BUSY_PAUSED, "M876 P1\n")]);
    talk(&mut a, &mut Talker::new(&[]));
    assert!(a.count(BUSY_PAUSED) >= 4, "{:?}", a.heard);
    assert_eq!(a.count("ok"), 2);
}

#[test]
fn a_resume_does_not_end_a_dwell() {
    let mut a = Talker::new(&[("echo:corehbot", "G4 S9\n"), ("echo:busy", "M24\n")]);
    talk(&mut a, &mut Talker::new(&[]));
    assert!(a.count(BUSY) >= 4, "{:?}", a.heard);
}

#[test]
fn all_hosts_are_asked_and_each_may_answer() {
    let mut a = Talker::new(&[("echo:corehbot", "M600\n")]);
    let mut b = Talker::new(&[("//action:prompt_show", "M24\n")]);
    talk(&mut a, &mut b);
    for line in ["//action:paused", "//action:prompt_begin Change the filament", "//action:prompt_button Continue"] {
        assert_eq!((a.count(line), b.count(line)), (1, 1), "{line}");
    }
    assert_eq!((a.count("//action:resumed"), b.count("//action:resumed")), (1, 1), "{:?}", b.heard);
    assert_eq!((a.count("ok"), b.count("ok")), (1, 1));
}

#[test]
fn a_pause_of_the_host_ends_the_motion_and_holds_nothing_up() {
    let mut a = Talker::new(&[
        ("echo:corehbot", "G1 X150 F3000\nG1 Y150\nM25\n"),
        ("//action:paused", "M114 R\nG1 X160\nM400\nM114 R\nM24\n"),
    ]);
    let mut b = Talker::new(&[("//action:paused", "M119\n")]);
    talk(&mut a, &mut b);
    // The print comes to rest before anything else is carried out.
    assert_eq!((a.count("X:150.00 Y:150.00"), a.count("X:160.00 Y:150.00")), (1, 1), "{:?}", a.heard);
    assert_eq!((a.count("//action:resumed"), b.count("//action:resumed")), (1, 1));
    assert_eq!((a.count("ok"), b.count("ok")), (8, 1));
}

#[test]
fn a_resume_without_a_pause_says_nothing() {
    let mut a = Talker::new(&[("echo:corehbot", "M24\nM602\n")]);
    talk(&mut a, &mut Talker::new(&[]));
    assert_eq!((a.count("//"), a.count("ok")), (0, 2));
}

#[test]
fn a_long_wait_takes_no_power_from_the_motors() {
    // Power goes after 5 s without motion, and with it the position that homing found.
    let mut a = Talker::new(&[("echo:corehbot", "M84 S5\nG1 X110 F6000\nM0 S60\nG1 X900\nM400\nM114\n")]);
    talk(&mut a, &mut Talker::new(&[]));
    assert!(a.count(BUSY_PAUSED) >= 29, "{}", a.count(BUSY_PAUSED));
    // The edge is known only to an axis that is homed.
    assert_eq!(a.count("X:390.00"), 1, "{:?}", a.heard);
}

#[test]
fn stops_end_a_wait_for_the_user() {
    let mut a = Talker::new(&[("echo:corehbot", "M600\nG1 X110\n"), (BUSY_PAUSED, "M410\n"), ("ok", "M114 R\n")]);
    let outcome = talk(&mut a, &mut Talker::new(&[]));
    assert_eq!((a.count("ok"), outcome.moves, outcome.halted), (4, 0, false), "{:?}", a.heard);
    assert_eq!((a.count("//action:prompt_end"), a.count("//action:resumed")), (1, 0), "{:?}", a.heard);
    let mut a = Talker::new(&[("echo:corehbot", "M600\n"), (BUSY_PAUSED, "M112\n")]);
    let outcome = talk(&mut a, &mut Talker::new(&[]));
    assert!(outcome.halted && a.count("ok") == 0 && a.count("Error:Printer halted") > 0);
}
