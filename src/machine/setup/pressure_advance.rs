//! M900, M572, SET_PRESSURE_ADVANCE: pressure advance, in the words of three firmwares.

use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Flaw, Grammar, Nature, Number, Part, Words, absent_extruder, flaw_of_pairs, times_ten_to};
use crate::machine::answers::reply_writer::ReplyWriter;
use crate::machine::answers::words::Facts;
use crate::machine::numbers::shortest;
use crate::machine::state::clamps::Clamps;
use crate::motion::advance_window;
use crate::settings::{Advance, Settings, ranges};

const NAME: &str = "SET_PRESSURE_ADVANCE";

/// Marlin.
pub(in crate::machine) const LINEAR_ADVANCE: Entry = Entry::m("Settings", &[900])
    .nature(Nature::Mode)
    .grammar(&Grammar::numbers(b"KT").parts(&[(b'T', Part::Extruder), (b'S', Part::Slot), (b'L', Part::Other)]))
    .does("K T", "pressure advance in s; or reports")
    .examples(&[
        ("M900 K.05", &[]),
        ("M900", &["echo:Advance K=0"]),
        (
            "M900 K30",
            &["echo:M900 ignored: K30 is out of range (0 to 4), stays 0; K is in seconds (Linear Advance 1.5); *"],
        ),
    ]);

/// RepRapFirmware, Prusa.
pub(in crate::machine) const PRESSURE_ADVANCE: Entry = Entry::m("Settings", &[572])
    .nature(Nature::Mode)
    .grammar(&Grammar::numbers(b"SWD").parts(&[(b'D', Part::Extruder)]))
    .does("S W D", "pressure advance in s (S), its window (W); or reports")
    .examples(&[
        ("M572 D0 S0.05", &[]),
        ("M572", &["echo:Advance K=0"]),
        ("M572 W9", &["echo:M572 ignored: W9 is out of range (0.005 to 0.2), stays 0.012"]),
    ]);

/// Klipper.
pub(in crate::machine) const BY_NAME: Entry = Entry::name("Settings", &[NAME])
    .nature(Nature::Mode)
    .judge(|_, text| by_name(text).err().into())
    .does("ADVANCE= SMOOTH_TIME=", "M572 in Klipper's words")
    .examples(&[("SET_PRESSURE_ADVANCE ADVANCE=0.05", &[]), ("SET_PRESSURE_ADVANCE", &["echo:Advance K=0"])]);

/// The time of M900. Slicers that are programs in Python write small numbers as `K1e-05`, which are two words.
fn linear_advance(words: Words<'_>) -> Option<Number> {
    let mut time: Option<Number> = None;
    for word in words {
        match word.letter {
            b'K' => time = word.number,
            b'E' => time = time.map(|k| times_ten_to(k, word.number.unwrap_or_default())),
            _ => {}
        }
    }
    time
}

/// Time and window of SET_PRESSURE_ADVANCE. EXTRUDER names the extruder; there is only one.
#[inline(never)]
fn by_name(text: &[u8]) -> Result<[Option<Number>; 2], Flaw<'_>> {
    const NAMES: [&str; 3] = ["ADVANCE", "SMOOTH_TIME", "EXTRUDER"];
    let mut numbers = [None; 2];
    let flaw = flaw_of_pairs(text, &NAMES, &mut |pair| match pair.place {
        2 => absent_extruder(NAME, pair.value).map(Flaw::Absent),
        _ => pair.put_number(&mut numbers),
    });
    flaw.map_or(Ok(numbers), Err)
}

/// The time and the window, in s.
fn words(command: &TableCommand<'_>) -> [Option<Number>; 2] {
    match command.code() {
        900 => [linear_advance(command.words()), None],
        572 => command.numbers(b"SW"),
        _ => by_name(command.text()).unwrap_or_default(),
    }
}

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { clamps, .. }: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let [time, window] = words(command);
    if time.or(window).is_none() {
        return Ok(Answer::words(&say_advance));
    }
    let advance = wanted_advance(time, window, &main_loop.settings, clamps);
    if !clamps.refuses_line() {
        main_loop.use_advance(advance).await?;
    }
    Ok(Answer::Nothing)
}

/// The advance that the words want, if they are in range; W0 is the window that suits the shapers.
fn wanted_advance(time: Option<Number>, window: Option<Number>, s: &Settings, clamps: &mut Clamps) -> Advance {
    let mut wanted = *s;
    if let Some(time) = time {
        clamps.near(["M900", "K"], time, ranges::ADVANCE, &mut wanted.advance.time);
    }
    if window == Some(Number::ZERO) {
        wanted.advance.window = None;
    } else if let Some(window) = window {
        let mut seconds = advance_window(&wanted);
        clamps.near(["M572", "W"], window, ranges::ADVANCE_WINDOW, &mut seconds);
        wanted.advance.window = Some(seconds);
    }
    wanted.advance
}

fn say_advance(to: &mut ReplyWriter<'_>, facts: &Facts<'_>) {
    to.say(text!("echo:Advance K={}", shortest(facts.settings.advance.time)));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gcode::Command;
    use crate::machine::commands::table::parse;

    fn number(text: &str) -> Option<Number> {
        Number::read(text.as_bytes()).map(|(number, _)| number)
    }

    fn advance(line: &str) -> [Option<Number>; 2] {
        match parse(line.as_bytes()) {
            Command::Table(command) => words(&command),
            other => panic!("{line}: {other:?}"),
        }
    }

    #[test]
    fn pressure_advance_in_three_dialects() {
        assert_eq!(advance("M900 K.05"), [number("0.05"), None]);
        assert_eq!(advance("M572 D0 S0.05 W.03"), [number("0.05"), number("0.03")]);
        let line = "SET_PRESSURE_ADVANCE EXTRUDER=extruder ADVANCE=0.05 SMOOTH_TIME=0.03";
        assert_eq!(advance(line), [number("0.05"), number("0.03")]);
        assert_eq!(advance("set_pressure_advance advance=0.05; SMOOTH_TIME=2"), [number("0.05"), None]);
        for line in ["M900", "M572", "M572 D0", "M900 W0.4", "SET_PRESSURE_ADVANCE"] {
            assert_eq!(advance(line), [None; 2], "{line}");
        }
        for word in ["ADVANCE=", "ADVANCE=x", "ADVANCE=5,5", "ADVANCE", "=5", "ADVANCE=1e", "ADVANCE=1-2"] {
            assert!(matches!(by_name(word.as_bytes()), Err(Flaw::NoPair(_))), "{word}");
        }
    }

    #[test]
    fn a_small_number_may_have_an_exponent() {
        for line in ["M900 K1e-05", "M900 K1E-5", "SET_PRESSURE_ADVANCE ADVANCE=1e-05"] {
            assert_eq!(advance(line), [number("0.00001"), None], "{line}");
        }
        assert_eq!(advance("M900 K-1e-05"), [number("-0.00001"), None]);
        assert_eq!(advance("M900 K1.5e+1"), [number("15"), None]);
        assert_eq!(advance("M900 K1.5e0"), [number("1.5"), None]);
        assert_eq!(advance("M900 K1e-999"), [number("0"), None]);
        assert_eq!(advance("M900 K1e999"), [number("1000000000"), None]);
        assert_eq!(advance("M900 E-5"), [None; 2]);
    }
}
