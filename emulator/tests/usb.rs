//! A computer on the USB cable: it finds the board, opens the port, and prints through it.

use crate::common::{Bench, MS, bench_of, firmware, heated, print, print_on};
use corehbot_emulator::line::Manner;
use corehbot_emulator::run::Seen;
use corehbot_emulator::usb_habits::UsbHabits;
use corehbot_emulator::watch::End;

const PRINT: &str = "G92 X0 Y0 Z0\nM17\nG1 X20 Y5 F6000\nG1 X3 Y9\nG1 X0 Y0\nM400\nM115\nM18\n";

fn on_usb(usb: UsbHabits) -> Manner {
    Manner { usb: Some(usb), ..Manner::default() }
}

/// The motors of all step events, in their order.
fn steps(seen: &Seen) -> Vec<corehbot::motors::MotorSet> {
    seen.recorder.events.iter().map(|event| event.steps).collect()
}

#[test]
fn a_print_over_usb_has_the_steps_that_it_has_over_the_serial_line() {
    let firmware = firmware();
    let serial = print(&firmware, PRINT, None);
    // A program that opens the port and closes it again and again changes nothing.
    for openings in [0, 20] {
        let manner = on_usb(UsbHabits { openings, pulled: None });
        let seen = print_on(&firmware, PRINT, &Bench { manner, ..Bench::default() });
        let said = &seen.line.said;
        assert_eq!((seen.end, &seen.line.failure, seen.line.resends), (End::Done, &None, 0), "{said:?}");
        assert!(said.iter().any(|line| line.starts_with("FIRMWARE_NAME:CoreH-bot")), "{said:?}");
        assert_eq!(said.iter().filter(|line| *line == "start").count(), 1, "{said:?}");
        assert_eq!(steps(&seen), steps(&serial));
        assert!(seen.recorder.events.len() > 1000);
    }
}

#[test]
fn a_cable_that_is_pulled_while_it_heats_and_moves_stops_nothing_and_the_next_session_is_clean() {
    let gcode = "G92 X0 Y0 Z0\nM17\nM104 S60\nG1 X40 F600\nG1 X0\nG1 X40\nM400\nM115\n";
    let manner = on_usb(UsbHabits { openings: 0, pulled: Some((3_000 * MS, 4_000 * MS)) });
    let bench = Bench { manner, second: Some("M115\nM105\nM104 S0\nM18\n"), ..bench_of(heated()) };
    let seen = print_on(&firmware(), gcode, &bench);
    let said = &seen.line.said;
    assert_eq!((seen.end, &seen.line.failure, seen.resets.len()), (End::Done, &None, 0), "{said:?}");
    assert!(seen.safety.dangers.is_empty(), "{:?}", seen.safety.dangers);
    assert_eq!(said.iter().filter(|line| *line == "start").count(), 1, "{said:?}");
    assert!(said.iter().any(|line| line.starts_with("FIRMWARE_NAME:CoreH-bot")), "{said:?}");
    assert!(said.iter().any(|line| line.contains("/60.00")), "it still heats: {said:?}");
    let last = seen.recorder.events.last().unwrap().at;
    assert!(last > 4_000 * MS, "it moved on without the computer, until {last} ns");
}
