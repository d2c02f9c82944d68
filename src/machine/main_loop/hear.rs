//! Input: lines of hosts, the urgent ones first, and the machine's activity while a host is silent.

use super::MainLoop;
use crate::machine::hosts::asked::Asked;
use crate::machine::hosts::host::Text;
use crate::machine::interrupt::Interrupt;
use crate::machine::ports::PortSet;
use crate::machine::release::policy::ReleasePolicy;
use crate::machine::state::job::{Answered, Job, Kept};
use crate::machine::state::waiting::Waiting;
use crate::port::Pend;
use crate::protocol::Activity;

impl<P: PortSet, W: Pend> MainLoop<'_, P, W> {
    /// No motor has power, and hosts are listened to from now on.
    pub fn begin(&mut self) {
        self.power.begin();
        self.turn_began = self.now();
        self.hosts.open(self.turn_began);
    }

    /// The next request of a host; a command's text is put into `text`.
    pub fn next_line(&mut self, text: &mut Text) -> Option<Asked> {
        let Self { hosts, planner, link, policy, job, .. } = self;
        let activity = || activity(!planner.is_empty() || !link.is_idle(), policy, job);
        let asked = hosts.next_line(self.turn_began, (u32::from(self.settings.patience_ms), &activity), text);
        self.link.status().set_awaiting_input(asked.is_none() && self.job.kept().is_none());
        asked
    }

    /// The line is answered.
    pub const fn end_line(&mut self) {
        self.hosts.note_answered();
        self.pauses.end_command();
    }

    /// The line that is being carried out is kept without `ok`, and others are served. An answer that came in one
    /// packet with it counts.
    pub fn keep_line(&mut self, kept: Kept) {
        let answered = if self.pauses.is_answered() {
            Some(Answered::Resume)
        } else {
            self.pauses.is_over().then_some(Answered::GoOn)
        };
        self.job.keep(kept, answered);
    }

    /// The host being served waits for a line that is kept.
    pub const fn set_aside(&mut self) {
        self.hosts.set_aside();
        self.pauses.end_command();
    }

    /// The answer to the kept line, if there is one by now.
    pub fn take_answer(&mut self) -> Option<Answered> {
        if self.job.kept().is_some() && !self.hosts.has_set_aside() {
            // Its host has opened the line again.
            let _ = self.job.take_kept();
        }
        self.job.take_answer(self.turn_began)
    }

    /// Its host is being served again; no line is kept any more.
    pub fn take_up(&mut self) -> Option<Kept> {
        let kept = self.job.take_kept()?;
        self.hosts.take_up();
        Some(kept)
    }

    /// Takes in the received bytes.
    pub(super) fn receive(&mut self) -> Option<Interrupt> {
        let urgent = self.hosts.receive();
        // M108 ends the wait of the command that is being carried out, if that waits; else it is for the line that is
        // kept.
        let is_for_command = self.pauses.waiting() != Waiting::Nothing;
        self.pauses.note(urgent.go_on || urgent.cancel, urgent.resume);
        self.job.note_answers(urgent.go_on && !is_for_command, urgent.resume);
        if urgent.cancel {
            self.job.note_cancel();
        }
        if urgent.stop {
            self.is_to_restart = urgent.restart;
            return Some(Interrupt::Halt);
        }
        urgent.quick_stop.then_some(Interrupt::QuickStop)
    }
}

/// The machine's activity while a host is silent.
const fn activity(has_motion: bool, policy: &ReleasePolicy, job: &Job) -> Activity {
    if has_motion {
        Activity::Moving
    } else if !policy.has_waited() {
        Activity::Resting
    } else if job.is_paused() {
        Activity::Paused
    } else {
        Activity::Waited
    }
}
