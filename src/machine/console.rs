//! The Console: lines in, replies out, one command after the other.
//!
//! Its loop is `serve`: take a line, carry it out, tell the answer, say `ok`. It owns two things: the crank, which turns in every wait
//! of every command, and the states of commands, which no turn of the crank needs. A command gets the crank and the states that it names;
//! no file but this one knows the Console.
//!
//! M410 ends whatever is awaited by an error, which comes up to here: `quick_stop` brakes, drops the motion and puts right what a
//! command had changed for a while (grouping, trim, drivers that measure, an axis that was being homed); then the line is answered. A
//! command that must tidy up by itself catches the error where it waits (`tune`, `settings::stored`). A line that is kept without `ok`
//! (`state::job`) waits here, while other hosts are served; it is taken up again when its user answers.

use crate::gcode;
use crate::kinematics::Groupings;
use crate::machine::answers::answer::Answer;
use crate::machine::belt::align::end_measuring;
use crate::machine::belt::circulate::end_circulation;
use crate::machine::commands::dispatch::{carry_out, go_on_with};
use crate::machine::commands::job::{begin_another, end_job};
use crate::machine::commands::settings::stored::{load_at_start, note_self_test};
use crate::machine::commands::states::States;
use crate::machine::crank::Crank;
use crate::machine::hosts::asked::Asked;
use crate::machine::hosts::host::Text;
use crate::machine::interrupt::{Interrupt, JobEnd, Restart};
pub use crate::machine::ports::{PortSet, Ports};
use crate::machine::state::job::Answered;
use crate::motion::{Link, MoveMemory};
use crate::port::{Clock, DriverBus, Pend, Serial, Storage};
use crate::protocol::Action;
use crate::settings::Settings;
use crate::thermal::Orders;
use crate::units::Mm;
use core::convert::Infallible;

/// The Console.
pub struct Console<'m, P: PortSet, W: Pend> {
    crank: Crank<'m, P, W>,
    states: States,
}

impl<'m, S: Serial, D: DriverBus, K: Clock, T: Storage, W: Pend> Console<'m, Ports<S, D, K, T>, W> {
    /// A Console of a machine with these groups of motors that stands at `start` if that is known, as if homed.
    pub fn new(
        settings: Settings,
        start: Option<[Mm; 3]>,
        memory: &'m mut MoveMemory,
        orders: Orders<'m>,
        groupings: &'m Groupings,
        link: Link<'m, W>,
        ports: Ports<S, D, K, T>,
    ) -> Self {
        Self { crank: Crank::new(settings, start, memory, orders, groupings, link, ports), states: States::new() }
    }
}

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// The settings as they are now.
    pub fn settings(&self) -> &Settings {
        self.crank.settings()
    }

    /// Serves the hosts. Poll it when bytes arrived, when a queue moved, and every millisecond.
    /// It ends when the machine is to begin anew, after a stop: have the board reset then.
    pub async fn run(&mut self) -> Restart {
        self.crank.begin();
        loop {
            let mut stopped = match self.start_and_serve().await {
                Ok(never) => match never {},
                Err(interrupt) => Err(interrupt),
            };
            while stopped == Err(Interrupt::QuickStop) {
                stopped = self.quick_stop().await;
            }
            if stopped == Err(Interrupt::Limp) {
                self.crank.limp().await;
            }
            if stopped.is_err() {
                return self.crank.stay_halted().await;
            }
        }
    }

    async fn start_and_serve(&mut self) -> Result<Infallible, Interrupt> {
        let crank = &mut self.crank;
        if crank.is_fresh() {
            let found = load_at_start(crank).await?;
            crank.adopt_position(crank.planned_end()).await?;
            for host in 0..crank.hosts() {
                crank.turn_to(host);
                crank.tell(Answer::Start).await?;
                if let Some(why) = crank.refusal() {
                    crank.tell(Answer::NoMachine(why)).await?;
                }
                crank.tell(found).await?;
            }
        }
        // A command that an emergency ended is answered all the same, and so is a line that was kept.
        if crank.owes_ok() {
            crank.tell(Answer::Ok).await?;
            crank.end_line();
        }
        if crank.take_up().is_some() {
            crank.tell_all(format_args!("{}", Action::PromptEnd));
            crank.tell(Answer::Ok).await?;
            crank.end_line();
        }
        self.serve().await
    }

    async fn serve(&mut self) -> Result<Infallible, Interrupt> {
        let Self { crank, states } = self;
        let (mut text, mut kept_text) = (Text::new(), Text::new());
        loop {
            if crank.has_passed_test() {
                note_self_test(crank).await?;
            }
            if crank.job_mut().take_cancel() {
                end_job(crank, &mut states.modal, JobEnd::Cancelled).await?;
            }
            if let Some(answered) = crank.take_answer() {
                if let Some(answer) = take_up(crank, states, &kept_text, answered).await? {
                    tell_answer(crank, answer).await?;
                }
                continue;
            }
            let Some(asked) = crank.next_line(&mut text) else {
                crank.turn().await?;
                continue;
            };
            let answer = match asked {
                Asked::Command => carry_out(crank, states, &gcode::parse(&text)).await?,
                Asked::Nothing => Answer::Nothing,
                Asked::LineNumber(number) => {
                    states.begin_print();
                    if number.is_none() {
                        begin_another(crank, &mut states.modal).await?;
                    }
                    Answer::LineNumber(number)
                }
                Asked::TooLong => Answer::TooLong,
                Asked::Question(last) => Answer::Question(last),
                Asked::Resend(reason, last) => Answer::Resend(reason, last),
            };
            if let Some(lines) = crank.upload_given_up() {
                crank.tell(Answer::UploadEnded(lines)).await?;
            }
            if let Answer::Kept = answer {
                kept_text.clone_from(&text);
                crank.set_aside();
                continue;
            }
            tell_answer(crank, answer).await?;
        }
    }

    /// M410: motion slows down along its path and ends; the position stays true.
    async fn quick_stop(&mut self) -> Result<(), Interrupt> {
        let crank = &mut self.crank;
        crank.slow_down().await?;
        crank.drop_motion().await?;
        end_circulation(crank).await?;
        crank.end_trim().await?;
        end_measuring(crank).await?;
        if crank.homed_mut().stop() {
            crank.tell(Answer::Line("echo:homing was ended, the axis has no known position")).await?;
        }
        Ok(())
    }
}

/// Tells what there is to say to a line, and its `ok`.
async fn tell_answer<P: PortSet, W: Pend>(crank: &mut Crank<'_, P, W>, answer: Answer<'_>) -> Result<(), Interrupt> {
    crank.tell(answer).await?;
    if !answer.has_ok() {
        crank.tell(Answer::Ok).await?;
    }
    crank.end_line();
    Ok(())
}

/// The line that is kept goes on: its print does, and if it could not be carried out before, it is now. What there is to say to it then;
/// `None` if it goes on being kept.
async fn take_up<'a, P: PortSet, W: Pend>(
    crank: &mut Crank<'_, P, W>,
    states: &mut States,
    text: &'a [u8],
    answered: Answered,
) -> Result<Option<Answer<'a>>, Interrupt> {
    let Some(kept) = crank.take_up() else { return Ok(None) };
    let answer = match go_on_with(crank, states, kept, answered).await {
        Ok(Some(true)) => carry_out(crank, states, &gcode::parse(text)).await?,
        Ok(Some(false)) => Answer::Nothing,
        Ok(None) => Answer::Kept,
        Err(Interrupt::EndJob(why)) => end_job(crank, &mut states.modal, why).await?,
        Err(interrupt) => return Err(interrupt),
    };
    if let Answer::Kept = answer {
        crank.set_aside();
        return Ok(None);
    }
    Ok(Some(answer))
}
