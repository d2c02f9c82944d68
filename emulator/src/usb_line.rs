//! A computer on the USB cable: it finds the board as Linux does, opens its serial port, and talks through it.

use crate::line::HostLine;
use crate::usb_discovery::Discovery;
use crate::usb_habits::UsbHabits;
use crate::usb_port::{Cable, IDLE_NS, PACKET_NS};
use corehbot_usb_model::UsbCore;
use corehbot_usb_model::host::{Outcome, PACKET, Transfer, UsbHost};
use std::collections::VecDeque;

/// The endpoints of the port's data: the CDC class gives out the one for its notifications first.
const TO_BOARD: usize = 1;
const FROM_BOARD: usize = 2;

/// Bytes that are asked for at once, as Linux' driver of such ports does.
const ASKED: usize = 512;

/// What a host asks for from the reset to the open port: the requests of Linux 6.1, the strings left out.
const REQUESTS: [Request; 6] = [
    // The first part of the device's descriptor, its address, and the whole.
    ([0x80, 6, 0, 1, 0, 0, 64, 0], &[]),
    ([0, 5, 7, 0, 0, 0, 0, 0], &[]),
    ([0x80, 6, 0, 1, 0, 0, 18, 0], &[]),
    ([0x80, 6, 0, 2, 0, 0, 255, 0], &[]),
    ([0, 9, 1, 0, 0, 0, 0, 0], &[]),
    // 115,200 baud.
    ([0x21, 0x20, 0, 0, 0, 0, 7, 0], &[0, 0xC2, 1, 0, 0, 0, 8]),
];

/// DTR and RTS on and off: a program opens the port, and closes it.
const OPEN: Request = ([0x21, 0x22, 3, 0, 0, 0, 0, 0], &[]);
const CLOSE: Request = ([0x21, 0x22, 0, 0, 0, 0, 0, 0], &[]);

/// A request and its data.
type Request = ([u8; 8], &'static [u8]);

/// How far it has come.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Stage {
    /// It looks for the device.
    Looking(Discovery),
    /// It makes this request.
    Asking(usize, u32),
    /// The port is open.
    Open,
    /// The cable is pulled.
    Pulled,
    /// The device did not answer as it should.
    Failed,
}

/// The computer.
#[derive(Debug)]
pub struct UsbLine {
    /// The conversation.
    pub line: HostLine,
    habits: UsbHabits,
    /// Conversations to come.
    next: VecDeque<HostLine>,
    host: UsbHost,
    stage: Stage,
    reading: Option<u32>,
    writing: Option<u32>,
}

impl UsbLine {
    /// A computer that has these conversations; without any there is none.
    #[must_use]
    pub fn new(habits: UsbHabits, mut next: VecDeque<HostLine>) -> Option<Self> {
        let (line, host, stage) = (next.pop_front()?, UsbHost::new(), Stage::Looking(Discovery::Alone));
        Some(Self { line, habits, next, host, stage, reading: None, writing: None })
    }

    fn request(&mut self, number: usize) -> Stage {
        let toggled = number.saturating_sub(REQUESTS.len());
        let (setup, data) = match REQUESTS.get(number) {
            Some(request) => *request,
            None if toggled > 2 * self.habits.openings => return Stage::Open,
            None => [OPEN, CLOSE][toggled % 2],
        };
        Stage::Asking(number, self.host.submit(Transfer::Control { setup, data: data.to_vec() }))
    }

    /// The cable is pulled, or plugged in again, if it is time for that. Returns when it is plugged in.
    fn pull(&mut self, core: &mut UsbCore, now: u64) -> Option<u64> {
        let (_, plugged) = self.habits.pulled.filter(|(pulled, _)| now >= *pulled)?;
        if now < plugged {
            // Without VBUS sensing the device sees a bus on which nothing happens.
            if self.stage != Stage::Pulled {
                core.suspend();
            }
            (self.stage, self.reading, self.writing) = (Stage::Pulled, None, None);
            return Some(plugged);
        }
        self.habits.pulled = None;
        self.stage = Stage::Looking(Discovery::Alone);
        if let Some(next) = self.next.pop_front() {
            self.line = next;
        }
        None
    }

    /// A request ended.
    fn answered(&mut self, number: usize, outcome: Outcome) {
        self.stage = match outcome {
            Outcome::Done(_) => self.request(number + 1),
            Outcome::Stalled | Outcome::Lost => Stage::Failed,
        };
    }

    /// Reads and writes through the open port.
    fn talk(&mut self, now: u64) {
        if self.reading.is_none() {
            self.reading = Some(self.host.submit(Transfer::In { endpoint: FROM_BOARD, length: ASKED }));
        }
        if self.writing.is_none() {
            let data: Vec<u8> = std::iter::from_fn(|| self.line.say(now)).take(PACKET).collect();
            if !data.is_empty() {
                self.writing = Some(self.host.submit(Transfer::Out { endpoint: TO_BOARD, data }));
            }
        }
    }

    fn ended(&mut self, id: u32, outcome: Outcome, now: u64) {
        match self.stage {
            Stage::Asking(number, asked) if asked == id => self.answered(number, outcome),
            _ if self.writing == Some(id) => self.writing = None,
            _ if self.reading == Some(id) => {
                self.reading = None;
                if let Outcome::Done(bytes) = outcome {
                    bytes.into_iter().for_each(|byte| self.line.hear(byte, now));
                }
            }
            _ => {}
        }
    }
}

impl Cable for UsbLine {
    fn attend(&mut self, core: &mut UsbCore, now: u64) -> Option<u64> {
        if let Some(plugged) = self.pull(core, now) {
            return Some(plugged);
        }
        if let Stage::Looking(mut discovery) = self.stage {
            let next = discovery.attend(&mut self.host, core, now);
            self.stage = Stage::Looking(discovery);
            if discovery != Discovery::Ready {
                return next;
            }
            self.stage = self.request(0);
        }
        match self.stage {
            Stage::Open => self.talk(now),
            Stage::Looking(_) | Stage::Asking(..) | Stage::Pulled | Stage::Failed => {}
        }
        let has_moved = self.host.turn(core);
        while let Some((id, outcome)) = self.host.take_ended() {
            self.ended(id, outcome, now);
        }
        match self.stage {
            _ if has_moved => Some(now + PACKET_NS),
            Stage::Open => Some(now + IDLE_NS),
            _ => None,
        }
    }
}
