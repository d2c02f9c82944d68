//! The USB cable to a real computer: USB/IP, as Linux' `vhci_hcd` speaks it (version 1.1.1, the kernel's
//! Documentation/usb/usbip_protocol.rst).
//!
//! It carries transfers by endpoint. It does not carry resets, SET_ADDRESS, toggles, suspend and the order of packets:
//! this end makes those itself, as [`UsbHost`] has them.
//!
//! Emulated time stands while the computer is thinking. After the computer has got bytes, the board waits for its next
//! bytes, for a while in real time. So lines come as fast as a computer without delay would send them. A wait in vain
//! makes the next waits shorter.

use crate::usb_discovery::Discovery;
use crate::usb_port::{Cable, IDLE_NS, PACKET_NS};
use corehbot_usb_model::UsbCore;
use corehbot_usb_model::host::{Outcome, Transfer, UsbHost};
use std::collections::BTreeMap;
use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::time::{Duration, Instant};

/// How long time stands for a computer that says nothing, in real time: at most, and at least.
const PATIENCE: [Duration; 2] = [Duration::from_millis(300), Duration::from_millis(5)];

/// A computer that has been away for so long does not come back, in real time.
const ABSENCE: Duration = Duration::from_secs(5);

/// The protocol's version.
const VERSION: u16 = 0x0111;

/// The name of the one device.
const BUS_ID: &[u8] = b"1-1";

/// Full speed (enum usb_device_speed of the kernel).
const FULL_SPEED: u32 = 2;

/// Errors as Linux numbers them: a stalled endpoint, a device that is gone, a request that was taken back.
const EPIPE: i32 = -32;
const ENODEV: i32 = -19;
const ECONNRESET: i32 = -104;

/// Requests before the device is handed over: its descriptors and its address.
const FIRST: [[u8; 8]; 3] = [[0x80, 6, 0, 1, 0, 0, 18, 0], [0, 5, 7, 0, 0, 0, 0, 0], [0x80, 6, 0, 2, 0, 0, 255, 0]];

/// How far it has come.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Stage {
    /// It looks for the device.
    Looking(Discovery),
    /// This request is under way.
    Asking(usize, u32),
    /// The device can be handed over.
    Ready,
    /// The computer has it.
    Attached,
    /// The computer has gone for good, or the device did not answer.
    Over,
}

/// A request of the computer under way.
#[derive(Clone, Copy, Debug)]
struct Asked {
    sequence: u32,
    /// It goes to endpoint 0.
    is_control: bool,
    /// Bytes that it sends, or `None` if it wants some.
    sent: Option<u32>,
}

/// The cable.
#[derive(Debug)]
pub struct UsbIp {
    listener: TcpListener,
    stream: Option<TcpStream>,
    heard: Vec<u8>,
    host: UsbHost,
    stage: Stage,
    descriptors: Vec<Vec<u8>>,
    asked: BTreeMap<u32, Asked>,
    /// When it pulled the cable.
    left: Option<Instant>,
    /// Since when the computer has bytes to answer.
    thinking: Option<Instant>,
    /// How long it may think.
    patience: Duration,
}

impl UsbIp {
    /// A cable that computers find at this address.
    ///
    /// # Errors
    /// If the address is taken.
    pub fn listen(address: &str) -> std::io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        Ok(Self {
            listener,
            stream: None,
            heard: Vec::new(),
            host: UsbHost::new(),
            stage: Stage::Looking(Discovery::Alone),
            descriptors: Vec::new(),
            asked: BTreeMap::new(),
            left: None,
            thinking: None,
            patience: PATIENCE[0],
        })
    }

    /// Whether a computer has the device, or had it.
    #[must_use]
    pub fn was_attached(&self) -> bool {
        matches!(self.stage, Stage::Attached | Stage::Over) || self.left.is_some()
    }

    /// Whether a computer had the device and has gone.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.stage == Stage::Over
    }

    /// Makes a request of its own, or none if there is no other.
    fn ask(&mut self, number: usize) {
        self.stage = match FIRST.get(number) {
            Some(&setup) => Stage::Asking(number, self.host.submit(Transfer::Control { setup, data: Vec::new() })),
            None => Stage::Ready,
        };
    }

    /// A transfer ended.
    fn ended(&mut self, id: u32, outcome: Outcome) {
        if let Stage::Asking(number, asked) = self.stage {
            if asked != id {
                return;
            }
            return match outcome {
                Outcome::Done(bytes) => {
                    self.descriptors.push(bytes);
                    self.ask(number + 1);
                }
                Outcome::Stalled | Outcome::Lost => self.stage = Stage::Over,
            };
        }
        let Some(Asked { sequence, is_control, sent }) = self.asked.remove(&id) else { return };
        let (status, bytes) = match outcome {
            Outcome::Done(bytes) => (0, bytes),
            Outcome::Stalled => (EPIPE, Vec::new()),
            Outcome::Lost => (ENODEV, Vec::new()),
        };
        let length = sent.filter(|_| status == 0).unwrap_or(bytes.len() as u32);
        // RET_SUBMIT.
        let mut reply = words(&[3, sequence, 0, 0, 0, status.cast_unsigned(), length, 0, 0, 0, 0, 0]);
        if sent.is_none() && !bytes.is_empty() && !is_control {
            self.thinking = Some(Instant::now());
        }
        reply.extend(bytes);
        self.say(&reply);
    }

    /// Sends bytes to the computer.
    fn say(&mut self, bytes: &[u8]) {
        let said =
            self.stream.as_mut().map(|stream| stream.set_nonblocking(false).and_then(|()| stream.write_all(bytes)));
        if !matches!(said, Some(Ok(()))) {
            self.stage = Stage::Over;
        }
    }

    /// Waits while the computer thinks.
    fn wait(&mut self, core: &mut UsbCore) {
        self.hear(Duration::ZERO, core);
        while let (Some(since), Some(_)) = (self.thinking, &self.stream) {
            let left = self.patience.saturating_sub(since.elapsed());
            if left.is_zero() {
                (self.thinking, self.patience) = (None, (self.patience / 2).max(PATIENCE[1]));
                return;
            }
            self.hear(left, core);
        }
    }

    /// Takes what the computer has said, and waits for it so long.
    fn hear(&mut self, wait: Duration, core: &mut UsbCore) {
        if self.stream.is_none() {
            let Ok((stream, _)) = self.listener.accept() else {
                if self.left.is_some_and(|left| left.elapsed() > ABSENCE) {
                    self.stage = Stage::Over;
                }
                return;
            };
            // Without the wait for more bytes that TCP would add to each answer.
            if stream.set_nodelay(true).is_err() || stream.set_nonblocking(false).is_err() {
                return;
            }
            (self.stream, self.left) = (Some(stream), None);
        }
        let Some(stream) = &mut self.stream else { return };
        let mut bytes = [0; 4096];
        let read = prepare(stream, wait).and_then(|()| stream.read(&mut bytes));
        match read {
            Ok(0) => self.left(core),
            Ok(length) => self.heard.extend(&bytes[..length]),
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
            Err(_) => self.left(core),
        }
        while self.obey() {}
    }

    /// The computer closed the connection: it only looked at the list, or has pulled the cable.
    fn left(&mut self, core: &mut UsbCore) {
        (self.stream, self.thinking) = (None, None);
        self.heard.clear();
        if self.stage == Stage::Attached {
            // Without VBUS sensing the device sees a bus on which nothing happens.
            core.suspend();
            self.asked.clear();
            self.descriptors.clear();
            (self.stage, self.left) = (Stage::Looking(Discovery::Alone), Some(Instant::now()));
        }
    }

    /// Takes `count` bytes of what was said, if there are so many.
    fn take(&mut self, count: usize) -> Option<Vec<u8>> {
        (self.heard.len() >= count).then(|| self.heard.drain(..count).collect())
    }

    /// Carries a whole message out. Returns whether there was one.
    fn obey(&mut self) -> bool {
        if self.stage == Stage::Attached { self.obey_request() } else { self.obey_operation() }
    }

    /// OP_REQ_DEVLIST or OP_REQ_IMPORT.
    fn obey_operation(&mut self) -> bool {
        let is_import = match self.heard.get(2..4) {
            Some([0x80, 0x05]) => false,
            Some([0x80, 0x03]) => true,
            Some(_) => {
                self.stage = Stage::Over;
                return false;
            }
            None => return false,
        };
        if self.take(if is_import { 40 } else { 8 }).is_none() {
            return false;
        }
        let code = if is_import { 0x0003 } else { 0x0005 };
        let mut reply: Vec<u8> = [VERSION, code].into_iter().flat_map(u16::to_be_bytes).collect();
        reply.extend([0; 4]);
        if !is_import {
            reply.extend(1u32.to_be_bytes());
        }
        reply.extend(self.device());
        if !is_import {
            // The two interfaces of the port: communication and data (CDC 1.2, section 4).
            reply.extend([2, 2, 0, 0, 10, 0, 0, 0]);
        }
        self.say(&reply);
        if is_import && self.stage != Stage::Over {
            self.stage = Stage::Attached;
        }
        true
    }

    /// The device as both operations describe it.
    fn device(&self) -> Vec<u8> {
        let mut bytes = vec![0; 256 + 32];
        let path = b"/sys/devices/corehbot/1-1";
        bytes[..path.len()].copy_from_slice(path);
        bytes[256..][..BUS_ID.len()].copy_from_slice(BUS_ID);
        bytes.extend(words(&[1, 2, FULL_SPEED]));
        let none = Vec::new();
        let [device, _, configuration] = [0, 1, 2].map(|n| self.descriptors.get(n).unwrap_or(&none).as_slice());
        let of = |n: usize| device.get(n).copied().unwrap_or(0);
        // Maker, product and release are little-endian in the descriptor.
        bytes.extend([of(9), of(8), of(11), of(10), of(13), of(12), of(4), of(5), of(6)]);
        bytes.extend([1, of(17), configuration.get(4).copied().unwrap_or(0)]);
        bytes
    }

    /// CMD_SUBMIT or CMD_UNLINK.
    fn obey_request(&mut self) -> bool {
        let Some(header) = self.heard.get(..48) else { return false };
        let word = |n: usize| header[4 * n..4 * n + 4].iter().fold(0, |word, byte| word << 8 | u32::from(*byte));
        let [command, sequence, _, is_in, endpoint, _, length] = [0, 1, 2, 3, 4, 5, 6].map(word);
        let mut setup = [0; 8];
        setup.copy_from_slice(&header[40..48]);
        match command {
            1 => {
                let sent = (is_in == 0).then_some(length);
                let Some(mut message) = self.take(48 + sent.unwrap_or(0) as usize) else { return false };
                let data = message.split_off(48);
                let (endpoint, length) = (endpoint as usize, length as usize);
                let transfer = match (endpoint, sent) {
                    (0, _) => Transfer::Control { setup, data },
                    (_, Some(_)) => Transfer::Out { endpoint, data },
                    (_, None) => Transfer::In { endpoint, length },
                };
                let id = self.host.submit(transfer);
                if endpoint != 0 && sent.is_some() && self.thinking.take().is_some() {
                    self.patience = (self.patience * 5 / 4).min(PATIENCE[0]);
                }
                self.asked.insert(id, Asked { sequence, is_control: endpoint == 0, sent });
            }
            2 => {
                let unlinked = word(5);
                self.take(48);
                let id = self.asked.iter().find(|(_, asked)| asked.sequence == unlinked).map(|(id, _)| *id);
                let was_under_way = id.is_some_and(|id| self.asked.remove(&id).is_some() && self.host.cancel(id));
                let status = if was_under_way { ECONNRESET } else { 0 };
                self.say(&words(&[4, sequence, 0, 0, 0, status.cast_unsigned(), 0, 0, 0, 0, 0, 0]));
            }
            _ => self.stage = Stage::Over,
        }
        self.stage != Stage::Over
    }
}

impl Cable for UsbIp {
    fn attend(&mut self, core: &mut UsbCore, now: u64) -> Option<u64> {
        if let Stage::Looking(mut discovery) = self.stage {
            let next = discovery.attend(&mut self.host, core, now);
            self.stage = Stage::Looking(discovery);
            if discovery != Discovery::Ready {
                return next;
            }
            self.ask(0);
        }
        if matches!(self.stage, Stage::Ready | Stage::Attached) {
            self.wait(core);
        }
        let has_moved = self.host.turn(core);
        while let Some((id, outcome)) = self.host.take_ended() {
            self.ended(id, outcome);
        }
        Some(now + if has_moved { PACKET_NS } else { IDLE_NS })
    }
}

/// Lets reads wait so long. Linux rounds a short time-out up to a tick of its own, so no wait is another mode.
fn prepare(stream: &TcpStream, wait: Duration) -> std::io::Result<()> {
    stream.set_nonblocking(wait.is_zero())?;
    if wait.is_zero() { Ok(()) } else { stream.set_read_timeout(Some(wait)) }
}

/// Words as they go over the network.
fn words(words: &[u32]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_be_bytes()).collect()
}
