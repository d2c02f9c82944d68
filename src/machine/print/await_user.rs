//! M0, M1, M600, M601: pause the print, and wait for the user.

use super::park_words::ParkWords;
use super::pause::await_user;
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Nature, Number};

/// What hosts hear of a pause that a host ends.
const PAUSED: &[&str] = &[
    "//action:paused",
    "//action:prompt_begin Paused",
    "//action:prompt_button Continue",
    "//action:prompt_show",
    "echo:busy: paused for user",
    "//action:prompt_end",
    "//action:resumed",
];

/// Without a grammar: a message for people stands behind it.
pub(in crate::machine) const WAIT: Entry = Entry::m("Jobs, pauses and waits", &[0, 1])
    .nature(Nature::Work)
    .does("S P", "pauses until the user answers, or for S s and P ms")
    .examples(&[
        ("M0", PAUSED),
        ("M0 Press the button", PAUSED),
        ("M1", PAUSED),
        ("M1 S1", &["//action:paused", "*", "*", "*", "//action:prompt_end", "//action:resumed"]),
    ]);

/// Without a grammar: a name may stand behind it.
pub(in crate::machine) const CHANGE: Entry = Entry::m("Jobs, pauses and waits", &[600, 601])
    .nature(Nature::Work)
    .does("X Y Z E R U L", "pauses; M600 asks for a filament change")
    .examples(&[
        ("M600 E10", &["//action:paused", "//action:prompt_begin Change the filament", "*", "*", "*", "*", "*"]),
        ("M600 N9", &["*", "*", "*", "*", "echo:M600 N is not supported by this firmware", "*", "*", "*"]),
        ("M601", PAUSED),
    ]);

/// M0, M1: S and P in front, in any order, then a message that is not shown. 0 is for ever.
fn wait_ms(command: &TableCommand<'_>) -> u32 {
    let mut ms = 0u64;
    let timed = command.words().map_while(|word| word.number.map(|number| (word.letter, number)));
    for (letter, number) in timed.take_while(|(letter, _)| matches!(letter, b'S' | b'P')) {
        ms += if letter == b'S' { number.to_thousandths().max(0) as u64 } else { u64::from(number.to_u32()) };
    }
    ms.min(Number::LIMIT as u64) as u32
}

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let (ms, park) = match command.code() {
        0 | 1 => (wait_ms(command), ParkWords::default()),
        _ => (0, ParkWords::of_wait(command)),
    };
    await_user(main_loop, states, (ms, command.code() == 600), &park).await
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gcode::Command;
    use crate::machine::commands::table::parse;

    fn of<T>(line: &str, read: fn(&TableCommand<'_>) -> T) -> T {
        match parse(line.as_bytes()) {
            Command::Table(command) => read(&command),
            other => panic!("{line}: {other:?}"),
        }
    }

    #[test]
    fn a_wait_is_as_long_as_the_words_in_front_say() {
        assert_eq!(of("M0", wait_ms), 0);
        assert_eq!(of("M1 S1.5 P20", wait_ms), 1520);
        assert_eq!(of("M0 S10 Press the button", wait_ms), 10_000);
        assert_eq!(of("M0 Remove plate S5", wait_ms), 0);
    }

    #[test]
    fn the_tool_waits_where_the_words_say() {
        let none = ParkWords::default();
        assert_eq!(of("M601", ParkWords::of_wait), none);
        let park = ParkWords { x: Some(Number::from(10)), e: Some(Number::from(-5)), ..none };
        assert_eq!(of("M600 X10 E-5 T0 B3", ParkWords::of_wait), park);
        let park = ParkWords { unload: Some(Number::from(80)), load: Some(Number::from(-2)), ..none };
        assert_eq!(of("M600 U80 L-2", ParkWords::of_wait), park);
        assert_eq!(of("M125 U80", ParkWords::of_pause), ParkWords { other: Some(b'U'), ..none });
        assert_eq!(of("M600 AUTO", ParkWords::of_wait), none);
        let park = ParkWords { e: Some(Number::from(3)), z: Some(Number::from(20)), ..none };
        assert_eq!(of("M125 L3 Z20 P1", ParkWords::of_pause), park);
    }
}
