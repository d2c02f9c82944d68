//! G27: the tool goes to the parking place of pauses. The program goes on from there.

use super::moves::Moves;
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Nature, Number};
use crate::machine::main_loop::offsets::z_reach;
use crate::settings::HomedAxis;

/// Marlin's P1 means a height of z, which is no setting here.
pub(in crate::machine) const ENTRY: Entry = Entry::g("Motion", &[27])
    .nature(Nature::Move)
    .grammar(&Grammar::numbers(b"P"))
    .does("P", "up by pause.lift, and to the parking place (pause.x, pause.y); P3 up alone, P4 aside alone")
    .examples(&[
        ("G27", &[]),
        ("G27 P4", &[]),
        ("G27 P1", &["echo:G27 P1 is not supported by this firmware"]),
        ("G27 P", &["echo:line ignored: P needs a number"]),
    ]);

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let way = command.number(b'P').map_or(0, Number::to_int);
    if way == 1 {
        return Ok(Answer::NotObeyed("G27", b"P1"));
    }
    if main_loop.homed.lacks_one_of([true; 3]) {
        return Ok(Answer::NotHomed);
    }
    let s = &main_loop.settings;
    let (pause, [.., z, _]) = (s.pause, main_loop.commanded.position());
    let aside = |place, axis| (way != 3).then(|| s.reach(axis).clamp(place));
    let up = z.saturating_add(pause.lift).min(z_reach(main_loop).most).max(z);
    let place = [aside(pause.x, HomedAxis::X), aside(pause.y, HomedAxis::Y), (way != 4).then_some(up)];
    Moves { main_loop, states }.visit(place, pause.travel_speed.into()).await
}
