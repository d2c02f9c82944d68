//! M401, M402: puts the probe out, and takes it in.

use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Mark};
use crate::machine::probe::touch::{AfterTouch, set_out};

/// S, H: whether a BLTouch stays out between touches, or report.
pub(in crate::machine) const OUT: Entry = Entry::m("Z probe", &[401])
    .works_if(|command| !is_about_quick(command))
    .mark(Mark::NeedsProbe)
    .grammar(&Grammar::numbers(b""))
    .does("S H", "puts the probe out; S1 leaves a BLTouch without orders to go in between touches, H reports that")
    .examples(&[("M401", &["echo:no probe configured, ignored"])]);

pub(in crate::machine) const IN: Entry = Entry::m("Z probe", &[402])
    .mark(Mark::NeedsProbe)
    .grammar(&Grammar::numbers(b""))
    .does("", "takes the probe in")
    .examples(&[("M402", &["echo:no probe configured, ignored"])]);

fn is_about_quick(command: &TableCommand<'_>) -> bool {
    command.code() == 401 && (command.has(b'S') || command.has(b'H'))
}

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    _: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    if is_about_quick(command) {
        main_loop.probing.set_quick(command.switch().unwrap_or(main_loop.probing.is_quick()));
        return Ok(Answer::Line(if main_loop.probing.is_quick() {
            packed!("echo:BLTouch HS mode ON")
        } else {
            packed!("echo:BLTouch HS mode OFF")
        }));
    }
    main_loop.finish().await?;
    set_out(main_loop, if command.code() == 401 { AfterTouch::Out } else { AfterTouch::In }).await?;
    Ok(Answer::Nothing)
}
