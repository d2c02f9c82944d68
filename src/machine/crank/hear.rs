//! Hearing: lines of hosts in, the urgent ones first, and what the machine is about while a host is silent.

use super::Crank;
use crate::machine::hosts::host::{Asked, Text};
use crate::machine::interrupt::Interrupt;
use crate::machine::ports::PortSet;
use crate::port::{Clock, DriverBus, MotorSet, Pend};
use crate::protocol::Activity;

impl<P: PortSet, W: Pend> Crank<'_, P, W> {
    /// No motor has power, and hosts are listened to from now on.
    pub fn begin(&mut self) {
        self.ports.drivers.enable(MotorSet::NONE);
        self.hosts.open(self.ports.clock.now());
    }

    /// What a host asks for next; a command's text is put into `text`.
    pub fn next_line(&mut self, text: &mut Text) -> Option<Asked> {
        let now = self.ports.clock.now();
        let patience = (u32::from(self.settings.patience_ms), self.activity());
        let asked = self.hosts.next_line(now, patience, text);
        self.link.status().set_awaiting_input(asked.is_none());
        asked
    }

    /// M28: what the host being served sends from now on is not carried out.
    pub fn begin_upload(&mut self) {
        self.hosts.begin_upload(self.ports.clock.now());
    }

    /// It is over: how many lines were not carried out. `None` if there was none.
    pub fn end_upload(&mut self) -> Option<u32> {
        self.hosts.end_upload()
    }

    /// How many lines were not carried out of an upload that the present line has shown to be over without M29, told
    /// once.
    pub fn upload_given_up(&mut self) -> Option<u32> {
        self.hosts.upload_given_up()
    }

    /// The line is answered.
    pub const fn end_line(&mut self) {
        self.hosts.note_answered();
        self.pauses.end_command();
    }

    /// Whether the host being served waits for the answer to a line.
    pub const fn owes_ok(&self) -> bool {
        self.hosts.owes_ok()
    }

    /// What the machine is about while a host is silent.
    fn activity(&self) -> Activity {
        if self.has_motion() {
            Activity::Moving
        } else if !self.policy.has_waited() {
            Activity::Resting
        } else if self.pauses.is_print_paused() {
            Activity::Paused
        } else {
            Activity::Waited
        }
    }

    /// Takes in what has arrived.
    pub(super) fn receive(&mut self) -> Option<Interrupt> {
        let urgent = self.hosts.receive();
        self.pauses.note(urgent.go_on, urgent.resume);
        if urgent.stop {
            self.is_to_restart = urgent.restart;
            return Some(Interrupt::Halt);
        }
        urgent.quick_stop.then_some(Interrupt::QuickStop)
    }
}
