//! Waits: the next steps of commands of the table, and time (G4). Waits for the user are in [`pause`](super::pause).

use super::heating::await_heat;
use super::self_test::test_heaters;
use super::states::States;
use super::tuning::tune;
use crate::machine::answers::answer::Answer;
use crate::machine::answers::next_step::NextStep;
use crate::machine::apart::apart;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::port::Wake;
use core::pin::pin;

/// Awaits the next step of a command, and returns its answer.
pub(super) async fn take_step<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    step: NextStep,
) -> Result<Answer<'static>, Interrupt> {
    match step {
        NextStep::Rest => main_loop.finish().await?,
        NextStep::Fan(fan, duty) => main_loop.set_fan(fan, duty).await?,
        NextStep::Heat { heaters, cools } => apart(pin!(await_heat(main_loop, heaters, cools))).await?,
        NextStep::Tune(ref words) => return apart(pin!(tune(main_loop, &mut states.clamps, words))).await,
        NextStep::SelfTest => return test_heaters(main_loop).await,
        NextStep::EndJob => return Err(Interrupt::EndJob),
    }
    Ok(Answer::Nothing)
}

/// G4: lets time pass in the motion itself; M108 ends it.
pub(in crate::machine) async fn dwell<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    ms: u32,
) -> Result<(), Interrupt> {
    main_loop.finish().await?;
    if ms == 0 {
        return Ok(());
    }
    main_loop.let_pass(ms).await
}
