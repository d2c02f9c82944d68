//! The port from plugging in to closing it, with a fake bus.

use super::fake_usb::Fake;
use super::*;
use corehbot::protocol::{Emergency, Incoming, Receiver};
use corehbot_usb_device::Identity;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use embassy_usb_driver::Event;
use std::cell::Cell;
use std::pin::{Pin, pin};
use std::task::{Context, Waker};

/// Requests of the USB specification (2.0, table 9-4) and of its class for modems (PSTN 1.2, table 13).
const SET_ADDRESS: [u8; 8] = [0x00, 5, 7, 0, 0, 0, 0, 0];
const GET_DEVICE: [u8; 8] = [0x80, 6, 0, 1, 0, 0, 18, 0];
const GET_CONFIGURATION: [u8; 8] = [0x80, 6, 0, 2, 0, 0, 0xFF, 0];
const SET_CONFIGURATION: [u8; 8] = [0x00, 9, 1, 0, 0, 0, 0, 0];
const SET_LINE_CODING: [u8; 8] = [0x21, 0x20, 0, 0, 0, 0, 7, 0];

const fn set_line_state(dtr: bool) -> [u8; 8] {
    [0x21, 0x22, dtr as u8, 0, 0, 0, 0, 0]
}

struct Bench<'a>(&'a Cell<u64>);

impl Surroundings for Bench<'_> {
    fn wake_console(&self) {}

    fn now(&self) -> Instant {
        Instant(self.0.get())
    }
}

/// A host on one side of the port, and the Console on the other.
struct Rig<'a> {
    wire: Fake,
    traffic: &'a Traffic<NoopRawMutex>,
    clock: &'a Cell<u64>,
    port: Pin<&'a mut dyn Future<Output = ()>>,
}

/// Runs `story` with a port that is plugged in and configured, and closed.
fn with_port(story: impl FnOnce(Rig<'_>)) {
    let (wire, traffic, clock) = (Fake::default(), Traffic::<NoopRawMutex>::new(), Cell::new(0));
    let identity = Identity { numbers: [0x1209, 0x0001], texts: ["corehbot", "board", "1"] };
    let mut serial = Port::new(wire.clone(), identity).unwrap();
    let bench = Bench(&clock);
    let port = pin!(traffic.run(&mut serial, &bench));
    let mut rig = Rig { wire, traffic: &traffic, clock: &clock, port };
    rig.wire.0.borrow_mut().events.extend([Event::PowerDetected, Event::Reset]);
    rig.request(SET_ADDRESS);
    rig.request(SET_CONFIGURATION);
    story(rig);
}

impl Rig<'_> {
    /// Runs the port until it has no more work.
    fn run(&mut self) {
        for _ in 0..20 {
            assert!(self.port.as_mut().poll(&mut Context::from_waker(Waker::noop())).is_pending());
        }
    }

    fn request(&mut self, request: [u8; 8]) {
        self.wire.0.borrow_mut().requests.push_back((request, Vec::new()));
        self.run();
        assert_eq!(self.wire.0.borrow().verdicts[1], 0, "{request:?}");
    }

    fn open(&mut self) {
        self.request(set_line_state(true));
        self.clock.set(Instant(self.clock.get()).after_ms(100).0);
        assert_eq!(self.recv(), Some(Received::Opened));
    }

    fn say(&mut self, text: &str) -> usize {
        let taken = self.traffic.send(text.as_bytes(), Instant(self.clock.get()));
        self.run();
        taken
    }

    fn send(&mut self, packet: &[u8]) {
        self.wire.0.borrow_mut().to_device.push_back(packet.to_vec());
        self.run();
    }

    /// The host fetches a packet, if there is one.
    fn fetch(&mut self) -> Option<String> {
        let packet = self.wire.0.borrow_mut().to_host.take();
        self.run();
        packet.map(|bytes| String::from_utf8(bytes).unwrap())
    }

    /// The host fetches all packets.
    fn fetch_all(&mut self) -> String {
        std::iter::from_fn(|| self.fetch()).collect()
    }

    fn recv(&self) -> Option<Received> {
        self.traffic.recv(|| Instant(self.clock.get()))
    }

    fn hear(&mut self) -> String {
        let next = || self.recv().map(|received| if let Received::Byte(byte) = received { byte } else { 0 });
        String::from_utf8(std::iter::from_fn(next).collect()).unwrap()
    }
}

#[test]
fn the_host_finds_a_serial_port() {
    with_port(|mut rig| {
        rig.request(GET_DEVICE);
        let device = std::mem::take(&mut rig.wire.0.borrow_mut().answers);
        assert_eq!((device.len(), &device[8..12]), (18, &[0x09, 0x12, 0x01, 0x00][..]));
        rig.request(GET_CONFIGURATION);
        let configuration = std::mem::take(&mut rig.wire.0.borrow_mut().answers);
        assert_eq!(configuration.len(), usize::from(configuration[2]), "all of it fits into our memory");
        assert_eq!(configuration.len(), 70);
        rig.wire.0.borrow_mut().requests.push_back((SET_LINE_CODING, vec![0x90, 0xD0, 3, 0, 0, 0, 8]));
        rig.run();
        assert_eq!(rig.wire.0.borrow().verdicts, [3, 0]);
    });
}

#[test]
fn a_command_and_its_answer_pass() {
    with_port(|mut rig| {
        rig.open();
        rig.send(b"M105\n");
        assert_eq!(rig.hear(), "M105\n");
        rig.say("ok T:0.00\n");
        assert_eq!(rig.fetch().as_deref(), Some("ok T:0.00\n"));
        assert_eq!(rig.fetch(), None);
    });
}

#[test]
fn a_full_packet_at_the_end_is_followed_by_an_empty_one() {
    with_port(|mut rig| {
        rig.open();
        rig.say(&"x".repeat(PACKET));
        assert_eq!(rig.fetch().map(|packet| packet.len()), Some(PACKET));
        assert_eq!(rig.fetch().as_deref(), Some(""));
        assert_eq!(rig.fetch(), None);
    });
}

#[test]
fn a_host_that_is_faster_than_the_console_waits_and_nothing_is_lost() {
    with_port(|mut rig| {
        rig.open();
        let text: Vec<u8> = (0..3000_u32).map(|n| b'a' + (n % 23) as u8).collect();
        text.chunks(PACKET).for_each(|packet| rig.send(packet));
        assert!(rig.wire.0.borrow().to_device.len() > 30, "most of it is still with the host");
        let mut heard = String::new();
        while heard.len() < text.len() {
            heard += &rig.hear();
            rig.run();
        }
        assert_eq!(heard.as_bytes(), text);
    });
}

/// Listens as the Console does while a command keeps lines waiting.
fn listen(rig: &mut Rig<'_>, receiver: &mut Receiver) -> Option<Emergency> {
    let mut heard = None;
    while receiver.has_spare() || receiver.makes_room() {
        let Some(received) = rig.recv() else { break };
        heard = receiver.feed(received).or(heard);
    }
    rig.run();
    heard
}

/// Reproducer: the port held its host up behind 205 lines of M105, and M112 with it.
#[test]
fn an_emergency_passes_behind_reports_and_numbered_lines_that_no_command_takes() {
    with_port(|mut rig| {
        rig.open();
        let mut receiver = Receiver::new();
        // A jog by the user between them.
        let lines = (1..=400).map(|n| match n % 4 {
            0 => format!("N{n} G1 X{n}*{}\n", format!("N{n} G1 X{n}").bytes().fold(0, |sum, byte| sum ^ byte)),
            3 if n % 100 == 3 => "G1 X5\n".to_owned(),
            _ => "M105\n".to_owned(),
        });
        let text = lines.collect::<String>() + "M112\n";
        text.as_bytes().chunks(PACKET).for_each(|packet| rig.send(packet));
        let mut heard = None;
        // A turn of the Console a millisecond: each empties the pump.
        for _ in 0..text.len() / 512 + 2 {
            heard = heard.or(listen(&mut rig, &mut receiver));
        }
        assert_eq!((heard, rig.wire.0.borrow().to_device.len()), (Some(Emergency::Stop), 0));
        let owed = *receiver.owed();
        assert!(owed.temperatures && owed.oks > 200, "{owed:?}");
    });
}

#[test]
fn moves_without_numbers_wait_with_the_host_and_none_is_lost() {
    with_port(|mut rig| {
        rig.open();
        let mut receiver = Receiver::new();
        let lines: Vec<_> = (0..300).map(|n| format!("G1 X{n} Y{n}")).collect();
        let text = lines.join("\n") + "\n";
        text.as_bytes().chunks(PACKET).for_each(|packet| rig.send(packet));
        for _ in 0..20 {
            assert_eq!(listen(&mut rig, &mut receiver), None);
        }
        assert!(!rig.wire.0.borrow().to_device.is_empty(), "USB holds the host up");
        let mut taken = Vec::new();
        while taken.len() < lines.len() {
            listen(&mut rig, &mut receiver);
            if let Some(Incoming::Command(line)) = receiver.next_line(Instant(0)) {
                taken.push(String::from_utf8(line.to_vec()).unwrap());
            }
        }
        assert_eq!(taken, lines);
    });
}

#[test]
fn what_nobody_has_fetched_is_not_for_the_next_who_opens_the_port() {
    with_port(|mut rig| {
        rig.open();
        rig.send(b"G28\n");
        // One packet is under way, one waits in the driver, all others in the pump.
        rig.say(&"echo:old ".repeat(20));
        rig.request(set_line_state(false));
        assert_eq!(rig.say("echo:nobody hears this\n"), 23);
        rig.open();
        assert_eq!(rig.hear(), "");
        rig.say("start\n");
        assert_eq!(rig.fetch().map(|packet| packet.len()), Some(PACKET), "the hardware has it");
        assert_eq!(rig.fetch_all(), "\nstart\n");
    });
}

#[test]
fn a_host_that_stops_fetching_does_not_stop_the_console() {
    with_port(|mut rig| {
        rig.open();
        let line = format!("echo:{}\n", "x".repeat(194));
        while rig.say(&line) > 0 {}
        rig.clock.set(Instant(rig.clock.get()).after_ms(500).0);
        for _ in 0..100 {
            assert_eq!(rig.say(&line), 200);
        }
        assert_eq!(rig.fetch_all(), line[..2 * PACKET], "what hardware and driver hold");
        rig.say("ok\n");
        assert_eq!(rig.fetch_all(), "\nok\n");
    });
}

#[test]
fn a_bus_reset_closes_the_port_until_it_is_opened_again() {
    with_port(|mut rig| {
        rig.open();
        rig.say("echo:a packet that is never fetched\n");
        rig.say("echo:nor this\n");
        rig.wire.0.borrow_mut().events.push_back(Event::Reset);
        rig.run();
        assert_eq!(rig.say("echo:nobody hears this\n"), 23);
        rig.request(SET_ADDRESS);
        rig.request(SET_CONFIGURATION);
        rig.open();
        rig.say("start\n");
        assert_eq!(rig.fetch().as_deref(), Some("start\n"));
        rig.send(b"M115\n");
        assert_eq!(rig.hear(), "M115\n");
    });
}
