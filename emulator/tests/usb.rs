//! A computer on the USB cable: it finds the board, opens the port, and prints through it.

use crate::common::{Bench, firmware, print, print_on};
use corehbot_emulator::line::Manner;
use corehbot_emulator::steps::StepEvent;
use corehbot_emulator::watch::End;

const ON_USB: Manner = Manner { baud: None, damaged: 0, is_impatient: false, is_on_usb: true, insists: false };

#[test]
fn a_print_over_usb_has_the_steps_that_it_has_over_the_serial_line() {
    let gcode = "G92 X0 Y0 Z0\nM17\nG1 X20 Y5 F6000\nG1 X3 Y9\nG1 X0 Y0\nM400\nM115\nM18\n";
    let firmware = firmware();
    let seen = print_on(&firmware, gcode, &Bench { manner: ON_USB, ..Bench::default() });
    let said = &seen.line.said;
    assert_eq!((seen.end, &seen.line.failure), (End::Done, &None), "{said:?}");
    assert!(said.iter().any(|line| line.contains("FIRMWARE_NAME:CoreH-bot")), "{said:?}");
    assert!(seen.line.warnings.is_empty() && seen.line.resends == 0, "{:?}", seen.line.warnings);
    let serial = print(&firmware, gcode, None);
    let steps = |events: &[StepEvent]| events.iter().map(|event| event.steps).collect::<Vec<_>>();
    assert_eq!(steps(&seen.recorder.events), steps(&serial.recorder.events));
    assert!(seen.recorder.events.len() > 1000);
}
