//! After a stop: nothing moves, hosts are answered, and M999 restarts the machine.
//!
//! The hosts connected at the stop get the error once, which ends their prints, and none of their lines is answered
//! with `ok` any more. A host that connects later, by opening its line or by saying M110, is greeted with the reason of
//! the stop. The usual queries of such a host at connection are answered, so that it gets as far as sending M999; every
//! other command gets the error too.

use crate::driver;
use crate::fault::Fault;
use crate::gcode::{Command, Mark};
use crate::machine::answers::answer::Answer;
use crate::machine::answers::reply_writer::Progress;
use crate::machine::hosts::host::Text;
use crate::machine::hosts::request::{Parse, Request};
use crate::machine::interrupt::Restart;
use crate::machine::main_loop::{MainLoop, yield_once};
use crate::machine::numbers::shortest;
use crate::machine::ports::PortSet;
use crate::machine::reports::firmware::report_firmware;
use crate::machine::reports::heat_report::report_temperatures;
use crate::port::{LINES, Wake};
use crate::protocol::{Activity, NoRoom, Replies};
use crate::text::Packed;

/// The greeting of a host. Not "start", which would be a reset (OctoPrint, comm.py).
const GREETING: Packed = packed!("echo:Printer halted. Send M999 or reset");

/// M113: the time between two busy messages.
const KEEPALIVE: u16 = 113;

/// M105. The other command that is answered after a stop is M115.
const TEMPERATURES: u16 = 105;

/// Why the machine stopped.
#[derive(Clone, Copy)]
enum Reason {
    /// A host wished it, or a line could not be carried out.
    Host,
    /// A motor driver.
    Driver(driver::Fault),
    /// A guard of the heaters, or another context.
    Fault(Fault),
}

/// Says that only M999 or a reset helps, and why if that was not the host's own wish.
fn report_killed(replies: &mut Replies, reason: Reason) -> Result<(), NoRoom> {
    match reason {
        Reason::Host => replies.killed(),
        Reason::Driver(fault) => replies.killed_by(fault),
        Reason::Fault(fault) => replies.killed_after(fault),
    }
}

/// Whether hosts send this when they connect, and nothing is missing on the plate if it is not carried out.
fn is_said_on_connecting(command: &Command<'_>) -> bool {
    match command {
        Command::Table(command) => command.has_mark(Mark::SaidOnConnecting) || command.is('M', KEEPALIVE),
        command => matches!(command, Command::Silent),
    }
}

/// The reply to a host that connected later; `None` for a command that would act.
fn answer_halted(asked: Request, parse: Parse, text: &[u8]) -> Option<[Answer<'static>; 2]> {
    let greeting = Answer::Line(GREETING);
    Some(match asked {
        Request::LineNumber(number) => [greeting, Answer::LineNumber(number)],
        Request::Nothing => [Answer::Nothing, Answer::Ok],
        Request::Resend(reason, last) => [Answer::Nothing, Answer::Resend(reason, last)],
        Request::Question(last) => [Answer::Nothing, Answer::Question(last)],
        Request::TooLong => return None,
        Request::Command => match parse(text) {
            Command::Table(command) if command.has_mark(Mark::AnsweredWhenStopped) => {
                if command.is('M', TEMPERATURES) {
                    [Answer::Nothing, Answer::words_with_ok(&report_temperatures)]
                } else {
                    [Answer::words(&report_firmware), Answer::Ok]
                }
            }
            command if is_said_on_connecting(&command) => [greeting, Answer::Ok],
            _ => return None,
        },
    })
}

/// After a stop, until M999. Lines are read by `parse`.
pub(in crate::machine) async fn stay_halted<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    parse: Parse,
) -> Restart {
    main_loop.status.set_halted();
    main_loop.stop_and_cut();
    main_loop.status.set_awaiting_input(true);
    main_loop.hosts.count_as_new();
    main_loop.heat.drop_all();
    main_loop.heat.note_motors(false);
    let reason = match (main_loop.power.fault(), main_loop.status.fault().fault()) {
        (Some(fault), _) => Reason::Driver(fault),
        (None, Some(fault)) => Reason::Fault(fault),
        (None, None) => Reason::Host,
    };
    if let Some(parked) = main_loop.limping.outcome() {
        match parked {
            Some(raised) => {
                main_loop.hosts.notify_all(text!("echo:tool parked, z raised by {} mm", shortest(raised)));
            }
            None => main_loop.hosts.notify_all(text!("echo:the tool was not parked")),
        }
    }
    // The message answers the lines that have come so far, that of M112 and a kept one included.
    main_loop.hosts.take_up();
    main_loop.hosts.note_answered();
    let (mut text, now) = (Text::new(), main_loop.now());
    while main_loop.hosts.next_line(now, (0, &|| Activity::Paused), parse, &mut text).is_some() {}
    main_loop.hosts.greet(|replies| report_killed(replies, reason));
    // Hosts that came later.
    let mut are_new = [false; LINES];
    while !main_loop.is_to_restart {
        main_loop.poll_halted(&mut are_new).await;
        let now = main_loop.now();
        while !main_loop.is_to_restart
            && let Some(asked) = main_loop.hosts.next_line(now, (0, &|| Activity::Paused), parse, &mut text)
        {
            let is_new = are_new.get_mut(main_loop.hosts.serving());
            let knows = is_new.is_some_and(|is_new| {
                *is_new |= matches!(asked, Request::LineNumber(_));
                *is_new
            });
            match answer_halted(asked, parse, &text).filter(|_| knows) {
                Some(answers) => {
                    for answer in answers {
                        main_loop.reply_halted(answer, &mut are_new).await;
                    }
                }
                None => {
                    if let (_, Some((_, replies))) = main_loop.hosts.output() {
                        let _ = report_killed(replies, reason);
                    }
                }
            }
        }
    }
    Restart
}

impl<P: PortSet, W: Wake> MainLoop<'_, P, W> {
    /// Sends an answer to the host being served, as soon as there is room for it, or until M999.
    async fn reply_halted(&mut self, answer: Answer<'static>, are_new: &mut [bool; LINES]) {
        self.progress = Progress::default();
        while !self.is_to_restart && !self.write(&answer) {
            self.poll_halted(are_new).await;
        }
    }

    /// Polls once: bytes in, replies out, and a greeting for every host that has opened a line.
    async fn poll_halted(&mut self, are_new: &mut [bool; LINES]) {
        self.hosts.send();
        self.status.heat().beat_of_console();
        self.heat.send_orders(&self.settings.thermal);
        yield_once(false).await;
        let now = self.now();
        self.is_to_restart |= self.hosts.receive(now, true).restart;
        self.hosts.note_opened(are_new);
        self.hosts.greet(|replies| replies.line(format_args!("{GREETING}")));
        self.hosts.send();
    }
}
