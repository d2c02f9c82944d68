//! Several hosts on one machine: each has a serial line, and each is answered on its own.

use crate::common::deaf::Deaf;
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::world::{Host, Outcome, run_with};

/// Sends whatever the script has for the number of lines heard so far, whether the printer is busy or not.
#[derive(Default)]
struct Talker {
    /// Text, and the line that must have been heard before it leaves.
    script: Vec<(&'static str, &'static str)>,
    next: usize,
    opens_before: Option<usize>,
    heard: Vec<String>,
    /// Lines sent that want an `ok`.
    asked: usize,
}

impl Talker {
    fn new(script: &[(&'static str, &'static str)]) -> Self {
        Self { script: script.to_vec(), ..Self::default() }
    }

    fn count(&self, line: &str) -> usize {
        self.heard.iter().filter(|heard| heard.starts_with(line)).count()
    }
}

impl Host for Talker {
    fn send(&mut self, _out: &mut Vec<u8>) {}

    fn interject(&mut self, out: &mut Vec<u8>) {
        while let Some((awaited, text)) = self.script.get(self.next)
            && self.opens_before != Some(self.next)
            && self.heard.last().is_some_and(|line| line.starts_with(awaited))
        {
            out.extend(text.as_bytes());
            self.asked += text.matches('\n').count();
            self.next += 1;
        }
    }

    fn opens(&mut self) -> bool {
        let opens = self.opens_before == Some(self.next) && self.asked > 0;
        if opens {
            self.opens_before = None;
            self.heard.push("opened".to_owned());
            self.asked = 0;
        }
        opens
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
fn each_host_hears_its_own_answers_and_no_others() {
    let mut a = Talker::new(&[("echo:", "M114\nG1 X90 F6000\nM220\nM400\nM114\n")]);
    let mut b = Talker::new(&[("echo:", "N1 M115*39\nM119\nM119\n")]);
    let outcome = talk(&mut a, &mut b);
    assert_eq!((a.count("start"), b.count("start")), (1, 1));
    assert_eq!((a.count("ok"), b.count("ok")), (5, 3));
    assert_eq!((a.count("X:"), b.count("X:")), (2, 0), "{a:?} {b:?}", a = a.heard, b = b.heard);
    assert_eq!((a.count("x_min"), b.count("x_min")), (0, 2));
    assert_eq!((a.count("FIRMWARE_NAME"), b.count("FIRMWARE_NAME")), (0, 1));
    assert_eq!((outcome.moves, outcome.halted), (1, false));
}

#[test]
fn every_host_has_line_numbers_of_its_own() {
    let mut a = Talker::new(&[("echo:", "N1 M115*39\nN2 M115*36\n")]);
    let mut b = Talker::new(&[("echo:", "N1 M115*39\nN3 M115*37\n")]);
    talk(&mut a, &mut b);
    assert_eq!((a.count("Resend"), b.count("Resend: 2")), (0, 1), "{:?}", b.heard);
}

#[test]
fn a_host_that_waits_for_the_other_ones_command_hears_that_somebody_is_there() {
    let mut a = Talker::new(&[("echo:", "G4 S9\n")]);
    let mut b = Talker::new(&[("echo:", "G4 S1\nM114\n")]);
    talk(&mut a, &mut b);
    assert!(a.count("echo:busy") >= 4 && b.count("echo:busy") >= 4, "{:?} {:?}", a.heard, b.heard);
    assert_eq!((a.count("ok"), b.count("ok")), (1, 2));
}

#[test]
fn an_emergency_stop_from_either_host_is_reported_to_both() {
    let mut a = Talker::new(&[("echo:", "G4 S60\n")]);
    let mut b = Talker::new(&[("echo:", "M112\n")]);
    let outcome = talk(&mut a, &mut b);
    assert!(outcome.halted);
    assert!(a.count("Error:Printer halted") > 0 && b.count("Error:Printer halted") > 0);
    assert_eq!((a.count("ok"), b.count("ok")), (0, 0));
}

#[test]
fn a_quick_stop_forgets_the_lines_of_both_and_answers_them() {
    let mut a = Talker::new(&[("echo:", "G1 X150 F600\nM400\nG1 X20\nG1 X30\n")]);
    let mut b = Talker::new(&[("echo:", "M119\n"), ("ok", "G1 Y20\nM410\n"), ("ok", "M400\n")]);
    let outcome = talk(&mut a, &mut b);
    assert_eq!((a.count("ok"), b.count("ok")), (4, 4), "{:?} {:?}", a.heard, b.heard);
    assert!(outcome.moves <= 1, "{outcome:?}");
}

#[test]
fn whoever_opens_a_line_does_not_inherit_what_was_under_way_on_it() {
    // The dwell and half a line belong to a host that has gone.
    let mut a = Talker::new(&[("echo:", "G4 S5\nN1 G1 X"), ("start", "N1 M115*39\n")]);
    a.opens_before = Some(1);
    let mut b = Talker::new(&[("echo:", "M114\n")]);
    let outcome = talk(&mut a, &mut b);
    let after: Vec<_> = a.heard.iter().skip_while(|line| *line != "opened").skip(1).collect();
    assert_eq!(after[0], "start", "{:?}", a.heard);
    let oks = after.iter().filter(|line| line.starts_with("ok")).count();
    assert_eq!((oks, a.count("Resend"), outcome.moves), (1, 0, 0), "{after:?}");
    assert!(after.iter().any(|line| line.starts_with("FIRMWARE_NAME")));
}
