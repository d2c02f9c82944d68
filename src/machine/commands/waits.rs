//! Commands that wait: for the user (M0, M1, M600, M601), for time (G4), and the pause of a print (M24, M25, M602).

use super::heating::heat_again;
use crate::machine::answers::answer::Answer;
use crate::machine::crank::Crank;
use crate::machine::interrupt::Interrupt;
use crate::machine::ports::PortSet;
use crate::port::Pend;
use crate::protocol::Action;

/// What the user is asked.
const PAUSED: &str = "Paused";
const FILAMENT: &str = "Change the filament";

/// Says the same to all hosts. One that is not being served and has no room for it misses it.
async fn announce<P: PortSet, W: Pend>(
    crank: &mut Crank<'_, P, W>,
    actions: &[Action<'static>],
) -> Result<(), Interrupt> {
    for &action in actions {
        crank.tell_others(format_args!("{action}"));
        crank.tell(Answer::Action(action)).await?;
    }
    Ok(())
}

/// M0, M1, M600, M601: lets the motion end, and waits for M108, M24, M602 or an answer, or for `ms`; 0 is for ever.
pub(in crate::machine) async fn await_user<P: PortSet, W: Pend>(
    crank: &mut Crank<'_, P, W>,
    ms: u32,
    filament: bool,
) -> Result<(), Interrupt> {
    crank.finish().await?;
    let question = Action::PromptBegin(if filament { FILAMENT } else { PAUSED });
    announce(crank, &[Action::Paused, question, Action::PromptButton("Continue"), Action::PromptShow]).await?;
    let deadline = crank.now().after_ms(ms);
    let _ = crank.take_targets_before();
    crank.pauses_mut().begin_for_user();
    while !(crank.pauses().is_over() || (ms > 0 && crank.now() >= deadline)) {
        if let Err(interrupt) = crank.turn().await {
            crank.pauses_mut().end();
            crank.tell_all(format_args!("{}", Action::PromptEnd));
            return Err(interrupt);
        }
    }
    crank.pauses_mut().end();
    announce(crank, &[Action::PromptEnd]).await?;
    heat_again(crank).await?;
    announce(crank, &[Action::Resumed]).await
}

/// M25. The hosts are told first, so that they stop sending while the motion ends.
pub(in crate::machine) async fn pause<P: PortSet, W: Pend>(crank: &mut Crank<'_, P, W>) -> Result<(), Interrupt> {
    crank.pauses_mut().pause_print();
    announce(crank, &[Action::Paused]).await?;
    crank.finish().await
}

/// M24, M602. Where it has ended another command's wait, that command has told the hosts.
pub(in crate::machine) async fn resume<P: PortSet, W: Pend>(crank: &mut Crank<'_, P, W>) -> Result<(), Interrupt> {
    if crank.pauses_mut().resume_print() {
        announce(crank, &[Action::Resumed]).await?;
    }
    Ok(())
}

/// G4: lets time pass in the motion itself; M108 ends it.
pub(in crate::machine) async fn dwell<P: PortSet, W: Pend>(
    crank: &mut Crank<'_, P, W>,
    ms: u32,
) -> Result<(), Interrupt> {
    crank.finish().await?;
    if ms == 0 {
        return Ok(());
    }
    crank.let_pass(ms).await
}
