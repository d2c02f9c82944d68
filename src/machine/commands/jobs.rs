//! Jobs, pauses and waits, each by its command. [`job`](super::job) has the ends of a print.

use super::job::end_by_line;
use super::pause::{await_user, pause, resume};
use super::states::States;
use crate::gcode::JobCommand;
use crate::machine::answers::answer::Answer;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::port::Wake;

/// Carries out a command about the job.
pub(super) async fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &JobCommand<'a>,
) -> Result<Answer<'a>, Interrupt> {
    match *command {
        JobCommand::AwaitUser { ms, filament, ref park } => {
            return await_user(main_loop, states, (ms, filament), park).await;
        }
        JobCommand::Pause { parks, ref park } => return pause(main_loop, states, parks, park).await,
        JobCommand::Resume => return resume(main_loop, states).await,
        JobCommand::BeginJob => {
            let host = main_loop.hosts.serving();
            main_loop.job.begin(host);
        }
        JobCommand::EndJob => end_by_line(main_loop, &mut states.modal).await?,
        // The receive path has acted on them.
        JobCommand::Cancel | JobCommand::Continue | JobCommand::Answer => {}
        JobCommand::BeginUpload(name) => {
            main_loop.hosts.begin_upload(main_loop.now());
            return Ok(Answer::NoCard(name));
        }
        JobCommand::EndUpload => return Ok(main_loop.hosts.end_upload().map_or(Answer::Nothing, Answer::UploadEnded)),
        JobCommand::Object(number) => {
            let object = number.to_thousandths().div_euclid(1000) as i32;
            main_loop.status.print_progress.set_object(object);
        }
        JobCommand::CancelObject => {
            return Ok(Answer::Line(packed!("echo:this firmware cannot leave out objects, ignored")));
        }
        JobCommand::EmergencyStop => return Err(Interrupt::Halt),
        // It has no effect unless the machine is halted.
        JobCommand::Restart => {}
    }
    Ok(Answer::Nothing)
}
