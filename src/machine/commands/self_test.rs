//! SELF_TEST, and the wait for a self-test of the heaters that is under way. The one before the first heating after an update begins in
//! `crank::heat_door` (`test_before_heating`).
//!
//! No firmware has an M-code for it, so it has a name, as Klipper's commands do.

use super::heating::LINE_MS;
use crate::machine::answers::answer::Answer;
use crate::machine::crank::Crank;
use crate::machine::interrupt::Interrupt;
use crate::machine::ports::PortSet;
use crate::machine::state::waiting::Waiting;
use crate::port::Pend;

/// SELF_TEST.
pub(in crate::machine) async fn test_heaters<P: PortSet, W: Pend>(
    crank: &mut Crank<'_, P, W>,
) -> Result<Answer<'static>, Interrupt> {
    if !crank.settings().thermal.has_heater() {
        return Ok(Answer::Line("echo:no heaters configured, ignored"));
    }
    crank.finish().await?;
    crank.begin_asked_test();
    crank.pauses_mut().begin(Waiting::SelfTest);
    await_self_test(crank).await?;
    crank.pauses_mut().end();
    Ok(Answer::Nothing)
}

/// Waits for the end of a self-test that is under way, or for M108.
pub(in crate::machine) async fn await_self_test<P: PortSet, W: Pend>(
    crank: &mut Crank<'_, P, W>,
) -> Result<(), Interrupt> {
    let mut next_line = crank.now();
    while crank.is_testing() && !crank.pauses().is_over() {
        if crank.now() >= next_line {
            next_line = next_line.after_ms(LINE_MS);
            crank.tell(Answer::Heating(None)).await?;
        }
        crank.turn().await?;
    }
    Ok(())
}
