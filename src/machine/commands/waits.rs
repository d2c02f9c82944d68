//! Waits: the next steps of commands of the table. Waits for the user are in [`pause`](crate::machine::print::pause).

use crate::machine::answers::answer::Answer;
use crate::machine::answers::next_step::NextStep;
use crate::machine::apart::apart;
use crate::machine::heat::heating::await_heat;
use crate::machine::heat::self_test::test_heaters;
use crate::machine::heat::tuning::tune;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::states::States;
use crate::port::Wake;
use core::pin::pin;

/// Awaits the next step of a command, and returns its answer.
pub(in crate::machine) async fn take_step<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    step: NextStep,
) -> Result<Answer<'static>, Interrupt> {
    match step {
        NextStep::Feed(percent) => main_loop.override_feed(percent).await?,
        NextStep::LetPass(ms) => main_loop.let_pass(ms).await?,
        NextStep::Fan(fan, duty) => main_loop.set_fan(fan, duty).await?,
        NextStep::Heat { heaters, cools } => apart(pin!(await_heat(main_loop, heaters, cools))).await?,
        NextStep::Tune(ref words) => return apart(pin!(tune(main_loop, &mut states.clamps, words))).await,
        NextStep::SelfTest => return test_heaters(main_loop).await,
        NextStep::EndJob => return Err(Interrupt::EndJob),
        NextStep::Halt => return Err(Interrupt::Halt),
    }
    Ok(Answer::Nothing)
}
