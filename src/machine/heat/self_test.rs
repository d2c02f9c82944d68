//! SELF_TEST, and the wait for a self-test of the heaters that is under way. The one before the first heating after an
//! update begins in `main_loop::heaters` (`test_before_heating`).

use super::heating::{LINE_MS, report_wait};
use crate::machine::answers::answer::Answer;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::state::waiting::Waiting;
use crate::port::{Storage, Wake};

/// SELF_TEST.
pub(in crate::machine) async fn test_heaters<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<Answer<'static>, Interrupt> {
    main_loop.finish().await?;
    let image = main_loop.storage.image();
    main_loop.heat.begin_asked_test(&main_loop.settings.thermal, image);
    main_loop.pauses.begin(Waiting::SelfTest);
    let is_early = await_self_test(main_loop).await?;
    main_loop.pauses.end();
    Ok(if is_early { Answer::Line(packed!("echo:Self-test ended")) } else { Answer::Nothing })
}

/// Waits for the end of a self-test that is under way. M108, M410 and M524 end both; returns whether M108 has.
pub(in crate::machine) async fn await_self_test<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<bool, Interrupt> {
    let done = follow_self_test(main_loop).await;
    let is_early = main_loop.heat.stop_test();
    done.map(|()| is_early)
}

/// Tells the temperatures until its end, or M108.
async fn follow_self_test<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>) -> Result<(), Interrupt> {
    let mut next_line = main_loop.now();
    while main_loop.heat.is_testing() && !main_loop.pauses.is_over() {
        if main_loop.now() >= next_line {
            next_line = next_line.after_ms(LINE_MS);
            main_loop.reply(Answer::words(&|to, facts| report_wait(to, facts, None))).await?;
        }
        main_loop.poll().await?;
    }
    Ok(())
}
