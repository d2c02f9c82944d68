//! M303: finds out how a heater behaves.

use super::heater_settings::heater_of;
use super::tuning::{TuningWords, tune};
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Nature, Number, Part};
use crate::machine::apart::apart;
use core::pin::pin;

pub(in crate::machine) const ENTRY: Entry = Entry::m("Heat and fans", &[303])
    .nature(Nature::Work)
    .grammar(&Grammar::numbers(b"ECS").parts(&[(b'T', Part::Tool), (b'H', Part::Heater)]))
    .does("E C S U", "finds gains and model by C swings around S; U1 uses them")
    .examples(&[("M303 E0 S200", &["echo:no heaters configured, ignored"])]);

/// U alone is U1.
pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { clamps, .. }: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let words = TuningWords {
        heater: heater_of(command),
        target: command.number(b'S'),
        cycles: command.number(b'C'),
        applies: command.has(b'U') && command.number(b'U') != Some(Number::ZERO),
    };
    apart(pin!(tune(main_loop, clamps, &words))).await
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::connectors::Heater;
    use crate::gcode::Command;
    use crate::machine::commands::table::parse;

    #[test]
    fn e_names_the_heater() {
        let of = |line: &'static [u8]| match parse(line) {
            Command::Table(command) => heater_of(&command),
            other => panic!("{other:?}"),
        };
        assert_eq!(of(b"M303 S200"), Some(Heater::Hotend));
        assert_eq!(of(b"M303 E-1 S60 C8 U"), Some(Heater::Bed));
        assert_eq!(of(b"M306 E-2 A.07"), Some(Heater::Chamber));
        assert_eq!(of(b"M303 E7 U0"), None);
    }
}
