//! G4: waits after the motion so far; M108 ends it.

use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Mark, Nature, Number};

pub(in crate::machine) const ENTRY: Entry = Entry::g("Motion", &[4])
    .nature(Nature::Move)
    .grammar(&Grammar::numbers(b"PS").not_negative(b"PS"))
    .does("P S", "waits for the motion, then P ms and S s")
    .mark(Mark::AfterRest)
    .examples(&[("G4 P10", &[]), ("G4 ; wait", &[]), ("G4 P-5", &["echo:line ignored: P-5 is out of range"])]);

/// The sum stays below the largest number, so that it can be printed and read again.
fn wait_ms(command: &TableCommand<'_>) -> u32 {
    let [milliseconds, seconds] = command.numbers(b"PS").map(Option::unwrap_or_default);
    let sum = u64::from(milliseconds.to_u32()) + seconds.to_thousandths().max(0) as u64;
    sum.min(Number::LIMIT as u64) as u32
}

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    _: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let ms = wait_ms(command);
    if ms > 0 {
        main_loop.let_pass(ms).await?;
    }
    Ok(Answer::Nothing)
}
