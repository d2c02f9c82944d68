//! M280: an order to the servo of a BLTouch, or a report.

use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Mark, Number};
use crate::machine::probe::deploy::set_servo;
use crate::settings::{ProbeKind, Range};

/// S is an angle, from 544 on a length of pulses in us, or -1 for none.
pub(in crate::machine) const ENTRY: Entry = Entry::m("Z probe", &[280])
    .mark(Mark::NeedsProbe)
    .grammar(&Grammar::numbers(b"PS"))
    .does("P S", "order to the servo of a BLTouch: an angle, or us from 544 on; S-1 ends it; or reports")
    .examples(&[("M280 P0 S90", &["echo:no probe configured, ignored"])]);

/// The shortest pulse of a servo in us, at 0 degrees, and the length of 180 degrees in addition. From the first on, a
/// number is a length (Marlin, servo.h).
const SHORTEST: u16 = 544;
const HALF_TURN: u16 = 1856;

/// Angles and lengths of a servo.
const SERVO: Range<u16> = Range { least: 0, most: SHORTEST + HALF_TURN };

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { clamps, .. }: &mut States,
    command: &TableCommand<'a>,
) -> Answer<'a> {
    let [servo, order] = command.numbers(b"PS");
    if main_loop.settings.probe.kind != ProbeKind::BlTouch || servo.is_some_and(|servo| servo != Number::ZERO) {
        return Answer::Line(packed!("echo:M280 ignored: the only servo is P0, of a BLTouch"));
    }
    let Some(order) = order else {
        let angle = |micros: u16| ((u32::from(micros - SHORTEST) * 180 + 928) / u32::from(HALF_TURN)) as u16;
        match main_loop.probing.servo().map(angle) {
            Some(angle) => main_loop.say(text!("echo: Servo 0: {angle}")),
            None => main_loop.say(text!("echo: Servo 0: off")),
        }
        return Answer::Said;
    };
    if order == Number::from(-1) {
        set_servo(main_loop, None);
    } else if let Some(order) = clamps.whole_of(["M280", "S"], order, SERVO, None) {
        let of_angle = |angle: u16| SHORTEST + (u32::from(angle.min(180)) * u32::from(HALF_TURN) / 180) as u16;
        set_servo(main_loop, Some(if order < SHORTEST { of_angle(order) } else { order }));
        // Its pin may be out or in now: the next touch puts it out again.
        main_loop.probing.note_out(false);
    }
    Answer::Nothing
}
