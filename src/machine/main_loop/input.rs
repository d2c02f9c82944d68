//! Input: lines of hosts, the urgent ones first, and the machine's activity while a host is silent.

use super::MainLoop;
use crate::machine::hosts::host::Text;
use crate::machine::hosts::request::{Parse, Request};
use crate::machine::hosts::serving::Hosts;
use crate::machine::interrupt::Interrupt;
use crate::machine::ports::PortSet;
use crate::machine::state::held_line::{Answered, HoldReason};
use crate::machine::state::job::Job;
use crate::machine::state::pauses::Pauses;
use crate::machine::state::waiting::Waiting;
use crate::port::{Serial, Wake};
use crate::protocol::Activity;
use crate::units::Instant;

impl<P: PortSet, W: Wake> MainLoop<'_, P, W> {
    /// No motor has power, and hosts are listened to from now on.
    pub fn begin(&mut self) {
        self.power.begin();
        self.turn_began = self.now();
        self.hosts.open(self.turn_began);
    }

    /// The next request of a host; a command's text is put into `text`. There is none before the lines are sent that
    /// the last command has said on its way.
    pub fn next_line(&mut self, parse: Parse, text: &mut Text) -> Option<Request> {
        let Self { hosts, motion, job, .. } = self;
        if !hosts.output().0.are_sent() {
            return None;
        }
        let activity = || activity(motion.has_motion(), motion.has_waited(), job);
        let asked = hosts.next_line(self.turn_began, (u32::from(self.settings.patience_ms), &activity), parse, text);
        self.status.set_awaiting_input(asked.is_none() && self.job.line().reason().is_none());
        asked
    }

    /// Takes in the received bytes.
    pub(super) fn receive(&mut self) -> Option<Interrupt> {
        // M108 ends the wait of the command that is being carried out, if that waits; else it is for the line that is
        // held.
        let is_for_command = self.pauses.waiting() != Waiting::Nothing;
        let urgent = self.hosts.receive(self.turn_began, is_for_command);
        self.pauses.note(urgent.go_on, urgent.resume);
        self.job.line_mut().note_answers(urgent.go_on && !is_for_command, urgent.resume);
        if urgent.cancel {
            self.job.note_cancel();
        }
        if urgent.stop {
            self.is_to_restart = urgent.restart;
            return Some(Interrupt::Halt);
        }
        // A cancel stops the command or the motion that is under way; the Console ends the job.
        let is_stopped = urgent.cancel && (self.hosts.owes_ok() || self.motion.has_motion());
        (urgent.quick_stop || is_stopped).then_some(Interrupt::QuickStop)
    }
}

/// The line is answered.
pub(in crate::machine) const fn end_line<S: Serial>(hosts: &mut Hosts<'_, S>, pauses: &mut Pauses) {
    hosts.note_answered();
    pauses.end_command();
}

/// The host being served waits for a line that is held.
pub(in crate::machine) const fn set_aside<S: Serial>(hosts: &mut Hosts<'_, S>, pauses: &mut Pauses) {
    hosts.set_aside();
    pauses.end_command();
}

/// The answer to the held line, if there is one by now.
pub(in crate::machine) fn take_answer<S: Serial>(
    hosts: &Hosts<'_, S>,
    job: &mut Job,
    now: Instant,
) -> Option<Answered> {
    if !hosts.has_set_aside() {
        // Its host has opened the line again.
        let _ = job.line_mut().take();
    }
    let is_paused = job.is_paused();
    job.line_mut().take_answer(now, is_paused)
}

/// The host of the held line is being served again; no line is held any more.
pub(in crate::machine) fn take_up<S: Serial>(hosts: &mut Hosts<'_, S>, job: &mut Job) -> Option<HoldReason> {
    let held = job.line_mut().take()?;
    hosts.take_up();
    Some(held)
}

/// The machine's activity while a host is silent.
const fn activity(has_motion: bool, has_waited: bool, job: &Job) -> Activity {
    if has_motion {
        Activity::Moving
    } else if !has_waited {
        Activity::Resting
    } else if job.is_paused() {
        Activity::Paused
    } else {
        Activity::Waited
    }
}
