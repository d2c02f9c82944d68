//! M593: the input shapers of x and y.

use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{AxisFlags, Grammar, Nature, Number};
use crate::machine::numbers::SHAPERS;
use crate::machine::reports::setting::Setting;
use crate::machine::reports::settings_report::report_setting;
use crate::machine::state::clamps::Clamps;
use crate::settings::{Shaper, ShaperKind, Shapers, ranges};
use crate::text::{Packed, is_word};
use crate::units::{Hertz, Ratio};

pub(in crate::machine) const ENTRY: Entry = Entry::m("Settings", &[593])
    .nature(Nature::Mode)
    .grammar(&Grammar::numbers(b"FDTS").not_negative(b"F"))
    .does("X Y F D T S P", "input shaper: frequency, damping (D or S), kind; or reports")
    .examples(&[
        ("M593 F40", &[]),
        ("M593", &["  M593 X F0", "  M593 Y F0"]),
        ("M593 X F60 T5", &["echo:M593 ignored: T is 0 (ZV), 1 (ZVD), 2 (MZV), 3 (EI) or 4 (2HUMP_EI), *"]),
        ("M593 P\"mzv\" F60", &[]),
        ("M593 P\"zvdd\" F60", &["echo:M593 ignored: *"]),
        (
            "M593 F5 D2",
            &["echo:M593 ignored: F5 is out of range (10 to 500)", "echo:M593 ignored: D2 is out of range (0 to 0.5)"],
        ),
    ]);

/// The answer to an unknown kind.
const NO_SUCH_KIND: Packed =
    packed!("echo:M593 ignored: T is 0 (ZV), 1 (ZVD), 2 (MZV), 3 (EI) or 4 (2HUMP_EI), or P one of these names");

/// The names in RepRapFirmware's M593 P. Its `ei2` has two humps.
const NAMES: [(&[u8], ShaperKind); 6] = [
    (b"zv", ShaperKind::Zv),
    (b"zvd", ShaperKind::Zvd),
    (b"mzv", ShaperKind::Mzv),
    (b"ei", ShaperKind::Ei),
    (b"2hump_ei", ShaperKind::TwoHumpEi),
    (b"ei2", ShaperKind::TwoHumpEi),
];

/// Its words.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
struct Words {
    /// X and Y, both if none is named.
    axes: [bool; 2],
    /// F, in Hz; 0 is off.
    frequency: Option<Number>,
    /// D, or RepRapFirmware's S: a ratio.
    damping: Option<Number>,
    /// T, or the name in P: the kind, if there is such a one.
    kind: Option<Option<ShaperKind>>,
}

impl Words {
    fn read(command: &TableCommand<'_>) -> Self {
        let AxisFlags { x, y, .. } = command.flags();
        let mut words = Self { axes: if x || y { [x, y] } else { [true; 2] }, ..Self::default() };
        let mut name = None;
        for word in command.words() {
            match word.letter {
                b'F' => words.frequency = word.number,
                b'D' | b'S' => words.damping = word.number,
                b'T' => words.kind = word.number.map(numbered),
                b'P' => name = Some(word.quoted.unwrap_or_default()),
                _ => {}
            }
        }
        if let Some(name) = name {
            let known = NAMES.iter().find(|(other, _)| is_word(name, other));
            words.kind = Some(known.map(|(_, kind)| *kind));
            if is_word(name, b"none") {
                (words.frequency, words.kind) = (Some(Number::ZERO), None);
            }
        }
        words
    }

    /// Whether they change nothing and ask for a report.
    const fn are_a_question(&self) -> bool {
        self.frequency.is_none() && self.damping.is_none() && self.kind.is_none()
    }

    /// `shapers` as these words want them; `None` if there is no such kind of shaper.
    fn change(&self, mut shapers: Shapers, clamps: &mut Clamps) -> Option<Shapers> {
        let kind = match self.kind {
            Some(None) => return None,
            Some(kind) => kind,
            None => None,
        };
        // 0 is off.
        let frequency = self.frequency.map(|number| {
            (number > Number::ZERO).then(|| clamps.near_of(["M593", "F"], number, ranges::FREQUENCY, None)).flatten()
        });
        let damping = self.damping.and_then(|number| clamps.near_of(["M593", "D"], number, ranges::DAMPING, None));
        for (shaper, is_named) in [&mut shapers.x, &mut shapers.y].into_iter().zip(self.axes) {
            if is_named {
                change(shaper, kind, frequency, damping);
            }
        }
        Some(shapers)
    }
}

/// The shaper of a number in T.
fn numbered(number: Number) -> Option<ShaperKind> {
    (0..).zip(SHAPERS).find(|(place, _)| Number::from(*place) == number).map(|(_, kind)| kind)
}

fn change(shaper: &mut Shaper, kind: Option<ShaperKind>, frequency: Option<Option<Hertz>>, damping: Option<Ratio>) {
    shaper.kind = kind.unwrap_or(shaper.kind);
    shaper.damping = damping.unwrap_or(shaper.damping);
    match frequency {
        Some(Some(frequency)) => {
            shaper.frequency = frequency;
            if shaper.kind == ShaperKind::None {
                shaper.kind = ShaperKind::Zv;
            }
        }
        Some(None) => shaper.kind = ShaperKind::None,
        None => {}
    }
}

/// Motion comes to rest before a shaper changes.
pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { clamps, .. }: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let words = Words::read(command);
    if words.are_a_question() {
        return Ok(Answer::words(&|to, facts| report_setting(to, Setting::Shapers, facts.settings)));
    }
    let mut wanted = *main_loop.settings;
    let Some(shapers) = words.change(wanted.shapers, clamps) else {
        return Ok(Answer::Line(NO_SUCH_KIND));
    };
    wanted.shapers = shapers;
    if !clamps.refuses_line() && wanted.shapers != main_loop.settings.shapers {
        main_loop.finish().await?;
        main_loop.use_settings(&wanted).await?;
    }
    Ok(Answer::Nothing)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gcode::Command;
    use crate::machine::commands::table::parse;

    fn number(text: &str) -> Option<Number> {
        Number::read(text.as_bytes()).map(|(number, _)| number)
    }

    fn words(line: &str) -> Words {
        match parse(line.as_bytes()) {
            Command::Table(command) => Words::read(&command),
            other => panic!("{line}: {other:?}"),
        }
    }

    #[test]
    fn shapers_of_one_axis_or_both() {
        let shaper = |axes, frequency, damping, kind| Words {
            axes,
            frequency: number(frequency),
            damping: number(damping),
            kind,
        };
        let kind = |kind| Some(Some(kind));
        assert_eq!(words("M593 X F60 D.1 T2"), shaper([true, false], "60", "0.1", kind(ShaperKind::Mzv)));
        assert_eq!(words("M593 F0"), shaper([true; 2], "0", "", None));
        assert_eq!(words("M593 Y Z E T1"), shaper([false, true], "", "", kind(ShaperKind::Zvd)));
        assert_eq!(words("M593 P\"mzv\" F60"), shaper([true; 2], "60", "", kind(ShaperKind::Mzv)));
        assert_eq!(words("M593 X P \"EI2\" F60 S0.1"), shaper([true, false], "60", "0.1", kind(ShaperKind::TwoHumpEi)));
        assert_eq!(words("M593 P\"none\""), shaper([true; 2], "0", "", None));
        for line in ["M593 P\"zvdd\" F60", "M593 P F60", "M593 P2 F60", "M593 T-1 F60", "M593 T5 F60", "M593 T1.5 F60"]
        {
            assert_eq!(words(line), shaper([true; 2], "60", "", Some(None)), "{line}");
        }
        for line in ["M593", "M593 X"] {
            assert!(words(line).are_a_question(), "{line}");
        }
    }
}
