//! The Console: lines in, replies out, one command after the other.
//!
//! Its loop is `serve`: take a line, carry it out, send the answer, send `ok`. It owns two things: the main loop, which
//! runs during every wait of every command, and the states of commands, which the main loop never needs. A command gets
//! the main loop and the states that it names; no file but this one knows the Console.
//!
//! M410 and M524 end every wait with an error, which comes up to here: `quick_stop` brakes, drops the motion and
//! restores everything that a command had changed for a while. This is grouping, trim, a buzz, drivers that measure, a
//! probe that is out or near the bed, an axis that was being homed. Then the line is answered. A command that must tidy
//! up by itself catches the error where it waits (`tune`, `setup::stored`). A line that is held without `ok`
//! (`state::job`) waits here, while other hosts are served; it is taken up again when its user answers.

use crate::kinematics::Groupings;
use crate::machine::answers::answer::Answer;
use crate::machine::answers::reply_writer::ReplyWriter;
use crate::machine::answers::words::Facts;
use crate::machine::apart::apart;
use crate::machine::belt::align::end_measuring;
use crate::machine::belt::circulate::end_circulation;
use crate::machine::commands::dispatch::{carry_out, go_on_with};
use crate::machine::commands::table;
use crate::machine::hosts::host::{HostMemory, Text};
use crate::machine::hosts::request::Request;
use crate::machine::interrupt::{Interrupt, Restart};
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::halted::stay_halted;
use crate::machine::main_loop::input::{self, end_line, set_aside, take_answer};
use crate::machine::main_loop::limp::limp;
use crate::machine::main_loop::surface::{keep_to_surface, lay_mesh};
use crate::machine::main_loop::trim::{end_buzz, end_trim};
pub use crate::machine::ports::{PortSet, Ports};
use crate::machine::print::job::{begin_another, end_job};
use crate::machine::print::named_texts::next_line;
use crate::machine::print::upload;
use crate::machine::probe::touch::end_touch;
use crate::machine::setup::kept_mesh::take_mesh_to_use;
use crate::machine::setup::stored::{load_at_start, note_baseline, note_self_test, report_start};
use crate::machine::state::held_line::Answered;
use crate::machine::state::job::JobEnd;
use crate::machine::states::States;
use crate::motion::{Link, MoveMemory, QueueObserver};
use crate::port::{BoardFacts, Wake};
use crate::protocol::{Action, Echo, Replies};
use crate::settings::Settings;
use crate::surface::Mesh;
use crate::thermal::Orders;
use crate::units::Mm;
use core::convert::Infallible;
use core::pin::pin;

/// The Console.
pub struct Console<'m, P: PortSet, W: Wake> {
    main_loop: MainLoop<'m, P, W>,
    states: States,
}

impl<'m, P: PortSet, W: Wake> Console<'m, P, W> {
    /// A Console of a machine with these groups of motors that stands at `start` if that is known, as if homed.
    pub fn new(
        settings: &'m Settings,
        start: Option<[Mm; 3]>,
        memory: (&'m mut MoveMemory, &'m mut HostMemory),
        orders: Orders<'m>,
        groupings: &'m Groupings,
        link: Link<'m, W>,
        ports: Ports<P>,
    ) -> Self {
        Self {
            main_loop: MainLoop::new(settings, start, memory, orders, groupings, link, ports),
            states: States::new(),
        }
    }
}

impl<'m, P: PortSet, W: Wake> Console<'m, P, W> {
    /// The settings as they are now.
    pub fn settings(&self) -> &Settings {
        &self.main_loop.settings
    }

    /// This one sees each entry before it goes to the StepGenerator: a simulator follows the moves so.
    pub fn observe(&mut self, observer: &'m dyn QueueObserver) {
        self.main_loop.motion.observe(observer);
    }

    /// The bed has this mesh, and z follows it as soon as the Console [runs](Self::run).
    pub fn lay_mesh(&mut self, mesh: &Mesh) {
        lay_mesh(&mut self.main_loop, mesh);
    }

    /// Serves the hosts. Poll it when bytes arrived, when a queue moved, and every millisecond. It ends when the
    /// machine is to restart after a stop: have the board reset then.
    pub async fn run(&mut self) -> Restart {
        self.main_loop.begin();
        loop {
            let mut stopped = match self.start_and_serve().await {
                Ok(never) => match never {},
                Err(interrupt) => Err(interrupt),
            };
            while stopped == Err(Interrupt::QuickStop) {
                stopped = self.quick_stop().await;
            }
            if stopped == Err(Interrupt::Limp) {
                limp(&mut self.main_loop).await;
            }
            if stopped.is_err() {
                return apart(pin!(stay_halted(&mut self.main_loop, table::parse))).await;
            }
        }
    }

    async fn start_and_serve(&mut self) -> Result<Infallible, Interrupt> {
        let main_loop = &mut self.main_loop;
        if main_loop.motion.is_fresh() {
            let found = load_at_start(main_loop, &mut self.states).await?;
            main_loop.adopt_position(main_loop.motion.end()).await?;
            let mesh = take_mesh_to_use(main_loop).await?;
            for host in 0..main_loop.hosts.len() {
                main_loop.hosts.switch_to(host);
                main_loop.reply(Answer::words(&report_start_of_machine)).await?;
                if let Some(why) = main_loop.board.refusal() {
                    main_loop.say(text!("echo:{why}; no motor gets power"));
                }
                if let Some(found) = &found {
                    main_loop.reply(Answer::words(&|to, _| report_start(to, found))).await?;
                }
                if let Some(news) = &mesh {
                    main_loop.reply(Answer::words(&|to, _| to.say(text!("{news}")))).await?;
                }
            }
        }
        // A command that an emergency ended is answered all the same, and so is a line that was held.
        if main_loop.hosts.owes_ok() {
            main_loop.reply(Answer::Ok).await?;
            end_line(&mut main_loop.hosts, &mut main_loop.pauses);
        }
        if input::take_up(&mut main_loop.hosts, &mut main_loop.job).is_some() {
            main_loop.hosts.notify_all(text!("{}", Action::PromptEnd));
            main_loop.reply(Answer::Ok).await?;
            end_line(&mut main_loop.hosts, &mut main_loop.pauses);
        }
        self.serve().await
    }

    async fn serve(&mut self) -> Result<Infallible, Interrupt> {
        let Self { main_loop, states } = self;
        let (mut text, mut held_text) = (Text::new(), Text::new());
        loop {
            if main_loop.heat.has_passed_test() && !main_loop.motion.has_motion() {
                note_self_test(main_loop).await?;
            }
            if main_loop.heat.may_have_baseline_news() && !main_loop.motion.has_motion() {
                note_baseline(main_loop).await?;
            }
            keep_to_surface(main_loop).await?;
            if main_loop.job.take_cancel() {
                apart(pin!(end_job(main_loop, &mut states.modal, JobEnd::Cancelled))).await?;
            }
            let is_text = states.texts.is_running();
            let now = main_loop.turn_began();
            if !is_text && let Some(answered) = take_answer(&main_loop.hosts, &mut main_loop.job, now) {
                if let Some(answer) = take_up(main_loop, states, &held_text, answered).await? {
                    end_or_go_on(main_loop, states, answer).await?;
                }
                continue;
            }
            if states.texts.is_held() && main_loop.job.line().reason().is_none() {
                // The host of the held line has opened its line again.
                states.texts.stop();
            }
            main_loop.stream.note_text(is_text);
            let asked = if is_text {
                // Bytes of hosts are read between two lines.
                main_loop.come_again();
                main_loop.poll().await?;
                if next_line(main_loop, states, &mut text) { Request::Command } else { Request::Nothing }
            } else if let Some(asked) = main_loop.next_line(table::parse, &mut text) {
                asked
            } else {
                main_loop.poll().await?;
                continue;
            };
            let answer = match asked {
                Request::Command => {
                    // Not `map_err`, which copies the answer.
                    match carry_out(main_loop, states, &table::parse(&text)).await {
                        Ok(answer) => answer,
                        Err(interrupt) => return Err(tell_of_end(main_loop, interrupt, &text)),
                    }
                }
                Request::Nothing => Answer::Nothing,
                Request::LineNumber(number) => {
                    states.begin_print();
                    if number.is_none() {
                        begin_another(main_loop, &mut states.modal).await?;
                    }
                    Answer::LineNumber(number)
                }
                Request::TooLong => Answer::TooLong,
                Request::Question(last) => Answer::Question(last),
                Request::Resend(reason, last) => Answer::Resend(reason, last),
            };
            if let Some(lines) = main_loop.hosts.upload_given_up() {
                upload::tell_of_end(main_loop, lines);
            }
            if let Answer::Held = answer {
                held_text.clone_from(&text);
                states.texts.hold();
                set_aside(&mut main_loop.hosts, &mut main_loop.pauses);
                continue;
            }
            end_or_go_on(main_loop, states, answer).await?;
        }
    }

    /// M410, M524: motion slows down along its path and ends; the position stays true. M524 also ends the job.
    async fn quick_stop(&mut self) -> Result<(), Interrupt> {
        let Self { main_loop, states } = self;
        states.texts.stop();
        main_loop.slow_down().await?;
        main_loop.drop_motion().await?;
        end_circulation(main_loop).await?;
        end_trim(main_loop).await?;
        end_buzz(main_loop);
        end_measuring(main_loop).await?;
        end_touch(main_loop).await?;
        if main_loop.homed.stop() {
            main_loop.say(text!("echo:homing was interrupted, the position of the axis is unknown"));
        }
        if main_loop.job.take_cancel() {
            apart(pin!(end_job(main_loop, &mut states.modal, JobEnd::Cancelled))).await?;
        }
        Ok(())
    }
}

/// The first lines after a reset.
fn report_start_of_machine(to: &mut ReplyWriter<'_>, _: &Facts<'_>) {
    to.put(&Replies::start);
    to.say(text!("echo:corehbot {}", env!("CARGO_PKG_VERSION")));
}

/// A line was ended before its time. If M410 has done it, hosts are told which one: it has no result.
#[cold]
#[inline(never)]
fn tell_of_end<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    interrupt: Interrupt,
    text: &[u8],
) -> Interrupt {
    if matches!(interrupt, Interrupt::QuickStop) && !main_loop.job.is_cancelled() {
        let name = text.split(|byte| *byte == b' ').next().unwrap_or_default();
        main_loop.hosts.notify_all(text!("echo:{} was ended by M410", Echo(name)));
    }
    interrupt
}

/// A line was carried out: it is answered. If it is one of a text, or has called one, its `ok` comes at the text's end.
async fn end_or_go_on<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    answer: Answer<'_>,
) -> Result<(), Interrupt> {
    if !states.texts.is_running() {
        return reply_to(main_loop, answer).await;
    }
    main_loop.pauses.end_command();
    match answer {
        Answer::Unknown(text) => main_loop.say(text!("echo:a text has an unknown command: \"{}\"", Echo(text))),
        answer if answer.has_ok() => {}
        answer => main_loop.reply(answer).await?,
    }
    Ok(())
}

/// Sends the answer to a line, and its `ok`.
async fn reply_to<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    answer: Answer<'_>,
) -> Result<(), Interrupt> {
    main_loop.reply(answer).await?;
    if !answer.has_ok() {
        main_loop.reply(Answer::Ok).await?;
    }
    end_line(&mut main_loop.hosts, &mut main_loop.pauses);
    Ok(())
}

/// The held line continues: its print does, and if the line could not be carried out before, it is now. Returns its
/// answer; `None` if it stays held.
async fn take_up<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    text: &'a [u8],
    answered: Answered,
) -> Result<Option<Answer<'a>>, Interrupt> {
    let Some(held) = input::take_up(&mut main_loop.hosts, &mut main_loop.job) else { return Ok(None) };
    states.texts.take_up();
    main_loop.stream.note_text(states.texts.is_running());
    let answer = match go_on_with(main_loop, states, held, answered).await {
        Ok(Some(true)) => match carry_out(main_loop, states, &table::parse(text)).await {
            Ok(answer) => answer,
            Err(interrupt) => return Err(tell_of_end(main_loop, interrupt, text)),
        },
        Ok(Some(false)) => Answer::Nothing,
        Ok(None) => Answer::Held,
        Err(Interrupt::EndJob) => {
            let why = main_loop.job.why_it_ends();
            let answer = apart(pin!(end_job(main_loop, &mut states.modal, why))).await?;
            states.texts.stop_if(main_loop.job.is_ended());
            answer
        }
        Err(interrupt) => return Err(interrupt),
    };
    if let Answer::Held = answer {
        states.texts.hold();
        set_aside(&mut main_loop.hosts, &mut main_loop.pauses);
        return Ok(None);
    }
    Ok(Some(answer))
}
