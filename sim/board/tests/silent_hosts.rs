//! Hosts that fall silent in the middle of a print: a host that pauses gets no request, and a host that waits gets on.

use crate::common::deaf::Deaf;
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot::units::{Mm, TICKS_PER_MS};
use corehbot_sim::drivers::Drivers;
use corehbot_sim::world::{Desk, Outcome, World};

/// The fate of a line.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Fate {
    Sent,
    /// It is lost on its way, line end and all.
    Lost,
    /// A bit of it is turned over.
    Damaged,
    /// The host pauses for a minute before it.
    Paused,
}

/// Sends numbered lines as printcore and OctoPrint do: one for each `ok`, and again from the requested line, unless it
/// has not sent that line yet. Returns the replies, in order.
fn stream(lines: &[&str], fates: &[(usize, Fate)]) -> (Outcome, Vec<String>) {
    let (mut sink, drivers, mut desk) = (Deaf, Drivers::new(), Desk::new(1));
    let start = Some([100, 100, 10].map(Mm::from_num));
    let settings = Settings::prototype();
    let mut world = World::new(&mut desk, &settings, start, NoStorage, &drivers, &mut sink);
    let minute = 60_000 * u64::from(TICKS_PER_MS);
    let mut fates = fates.to_vec();
    let (mut next, mut first_unsent, mut may_send, mut resumes_at) = (0, 0, true, 0);
    let (mut text, mut heard) = (String::new(), Vec::new());
    while next < lines.len() || !may_send {
        assert!(world.now() < 20 * minute, "it stalls: {heard:?}");
        world.poll();
        text.push_str(&String::from_utf8(world.wires()[0].heard()).unwrap());
        while let Some(end) = text.find('\n') {
            let line: String = text.drain(..=end).collect();
            may_send |= line.starts_with("ok");
            if let Some(number) = line.strip_prefix("Resend: ") {
                let number: usize = number.trim().parse().unwrap();
                next = if number < first_unsent { number } else { next };
            }
            heard.push(line.trim().to_owned());
        }
        if !may_send || next == lines.len() || world.now() < resumes_at {
            world.advance();
            continue;
        }
        let fate = fates.iter().position(|(line, _)| *line == next).map_or(Fate::Sent, |at| fates.remove(at).1);
        if fate == Fate::Paused {
            resumes_at = world.now() + minute;
            continue;
        }
        let body = format!("N{next} {}", lines[next]);
        let sum = body.bytes().fold(0, |sum, byte| sum ^ byte) ^ u8::from(fate == Fate::Damaged);
        if fate != Fate::Lost {
            world.wires()[0].put(format!("{body}*{sum}\n").bytes());
        }
        next += 1;
        first_unsent = first_unsent.max(next);
        may_send = false;
    }
    (world.outcome(), heard)
}

fn resends(heard: &[String]) -> usize {
    heard.iter().filter(|line| line.starts_with("Resend")).count()
}

/// Forty moves of 5 mm at 50 mm/s; at line 30 two seconds of them wait.
fn lines(command_in_between: &'static str) -> Vec<&'static str> {
    let mut lines = vec!["M110 N0", "G91", "G1 F3000"];
    lines.extend(std::iter::repeat_n(["G1 X5", "G1 Y5", "G1 X-5", "G1 Y-5"], 10).flatten());
    lines[29] = command_in_between;
    lines.push("M400");
    lines
}

/// Pronsole is silent when it pauses. Queued moves are printed, then the machine rests.
#[test]
fn a_paused_pronsole_is_asked_for_nothing() {
    let (outcome, heard) = stream(&lines("G1 X5"), &[(30, Fate::Paused)]);
    assert_eq!((resends(&heard), outcome.moves), (0, 40), "{heard:?}");
}

/// OctoPrint waits for the motion and asks for the position; it hears nothing at all until it resumes.
#[test]
fn a_paused_octoprint_hears_nothing() {
    let mut lines = lines("M400");
    lines[30] = "M114";
    let (outcome, heard) = stream(&lines, &[(31, Fate::Paused)]);
    assert_eq!((resends(&heard), outcome.moves), (0, 38), "{heard:?}");
    let oks = heard.iter().filter(|line| line.starts_with("ok")).count();
    assert_eq!(oks, lines.len(), "{heard:?}");
}

/// M25 in the stream; it asks the host to pause.
#[test]
fn a_print_that_pauses_itself_hears_nothing() {
    let lines = lines("M25");
    let (_, heard) = stream(&lines, &[(30, Fate::Paused)]);
    let oks = heard.iter().filter(|line| line.starts_with("ok")).count();
    assert_eq!((resends(&heard), oks), (0, lines.len()), "{heard:?}");
}

/// On a line that has lost something a question is in place, but two at most, and only while there is motion.
#[test]
fn a_pause_on_a_bad_line_costs_two_questions_at_most() {
    let (outcome, heard) = stream(&lines("G1 X5"), &[(20, Fate::Damaged), (30, Fate::Paused)]);
    assert_eq!(outcome.moves, 40);
    assert!((2..=3).contains(&resends(&heard)), "one for the damage: {heard:?}");
    let (_, heard) = stream(&lines("M400"), &[(20, Fate::Damaged), (30, Fate::Paused)]);
    assert_eq!(resends(&heard), 1, "{heard:?}");
}

/// A lost line is printed before the machine has come to rest: the loss leaves no trace.
#[test]
fn a_lost_line_costs_one_resend_and_no_stop() {
    for lost in [&[30][..], &[25, 30], &[25, 26, 36]] {
        let fates: Vec<_> = lost.iter().map(|line| (*line, Fate::Lost)).collect();
        let (outcome, heard) = stream(&lines("G1 X5"), &fates);
        assert_eq!((outcome.moves, outcome.underruns), (40, 0), "{heard:?}");
        assert!((1..=lost.len()).contains(&resends(&heard)), "{heard:?}");
    }
}
