//! G10, G11: filament back, and forth again.

use super::moves::Moves;
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Nature, Verdict, Words};

/// With P or L it sets a tool's temperatures or offsets (RepRapFirmware).
pub(in crate::machine) const AWAY: Entry = Entry::g("Motion", &[10])
    .nature(Nature::Move)
    .grammar(&Grammar::numbers(b""))
    .judge(|_, text| {
        let is_foreign = Words::new(text).any(|word| matches!(word.letter, b'P' | b'L'));
        if is_foreign { Verdict::Unknown } else { Verdict::InOrder }
    })
    .does("", "retracts as M207 says; with P or L it is another firmware's command and unknown")
    .examples(&[("G10", &[]), ("G10 S1", &[])]);

pub(in crate::machine) const BACK: Entry = Entry::g("Motion", &[11])
    .nature(Nature::Move)
    .grammar(&Grammar::numbers(b""))
    .does("", "undoes G10")
    .examples(&[("G11", &[])]);

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    Moves { main_loop, states }.retract(command.code() == 11).await
}
