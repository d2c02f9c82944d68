//! The USB pump as a host sees it.

use super::*;

/// A pump, and a host that fetches packets on request.
struct Port {
    pump: Pump,
    now: Instant,
}

impl Port {
    fn open() -> Self {
        let mut port = Self { pump: Pump::new(), now: Instant(0) };
        port.reopen();
        port
    }

    /// Opens the port, closing it before if it is open.
    fn reopen(&mut self) {
        self.pump.set_open(false, self.now);
        assert!(self.pump.set_open(true, self.now) && !self.pump.set_open(true, self.now));
        self.now = self.now.after_ms(SETTLE_MS - 1);
        assert_eq!(self.recv(), None);
        self.now = self.now.after_ms(1);
        assert_eq!(self.recv(), Some(Received::Opened));
    }

    fn say(&mut self, text: &str) -> usize {
        self.pump.send(text.as_bytes(), self.now)
    }

    /// Fetches all packets.
    fn fetch(&mut self) -> Vec<Vec<u8>> {
        let mut packets = Vec::new();
        let mut into = [0; PACKET];
        while let Some(length) = self.pump.packet(&mut into, self.now) {
            self.pump.on_sent(&into[..length]);
            packets.push(into[..length].to_vec());
        }
        packets
    }

    fn text(&mut self) -> String {
        String::from_utf8(self.fetch().concat()).unwrap()
    }

    fn recv(&mut self) -> Option<Received> {
        self.pump.recv(|| self.now)
    }

    fn hear(&mut self) -> String {
        let next = || self.recv().map(|received| if let Received::Byte(byte) = received { byte } else { 0 });
        String::from_utf8(std::iter::from_fn(next).collect()).unwrap()
    }
}

#[test]
fn a_reply_leaves_with_the_next_packet_however_short() {
    let mut port = Port::open();
    assert_eq!(port.fetch(), Vec::<Vec<u8>>::new());
    port.say("ok\n");
    assert_eq!(port.fetch(), [b"ok\n"]);
    assert_eq!(port.fetch(), Vec::<Vec<u8>>::new());
}

#[test]
fn a_full_packet_is_followed_by_an_empty_one_if_nothing_else_follows() {
    let lengths = |bytes: usize| {
        let mut port = Port::open();
        port.say(&"x".repeat(bytes));
        port.fetch().iter().map(Vec::len).collect::<Vec<_>>()
    };
    assert_eq!(lengths(63), [63]);
    assert_eq!(lengths(64), [64, 0]);
    assert_eq!(lengths(65), [64, 1]);
    assert_eq!(lengths(128), [64, 64, 0]);
}

#[test]
fn what_comes_in_time_after_a_full_packet_makes_the_empty_one_needless() {
    let mut port = Port::open();
    port.say(&"x".repeat(64));
    let mut into = [0; PACKET];
    assert_eq!(port.pump.packet(&mut into, port.now), Some(64));
    port.pump.on_sent(&into);
    port.say("ok\n");
    assert_eq!(port.fetch(), [b"ok\n"]);
}

#[test]
fn nobody_waits_for_a_closed_port() {
    let mut port = Port { pump: Pump::new(), now: Instant(0) };
    for _ in 0..100 {
        assert_eq!(port.say("echo:nobody hears this\n"), 23);
    }
    assert!(port.fetch().is_empty());
    port.reopen();
    assert!(port.fetch().is_empty(), "nothing of before is left");
    port.say("ok\n");
    assert_eq!(port.text(), "ok\n");
}

#[test]
fn the_first_thing_to_be_heard_is_what_the_console_says_when_it_knows_of_the_opening() {
    let mut port = Port { pump: Pump::new(), now: Instant(0) };
    port.say("X:1.00 Y:2");
    port.pump.set_open(true, port.now);
    port.say(".00\nok\nX:3");
    port.now = port.now.after_ms(SETTLE_MS);
    assert_eq!(port.recv(), Some(Received::Opened));
    port.say("start\n");
    assert_eq!(port.text(), "start\n");
}

#[test]
fn opening_the_port_again_drops_what_waits_in_both_directions() {
    let mut port = Port::open();
    port.pump.on_packet(b"G28\n");
    port.say("echo:old\n");
    port.reopen();
    assert_eq!(port.hear(), "");
    assert_eq!(port.text(), "");
}

#[test]
fn commands_are_carried_out_after_the_port_was_closed() {
    let mut port = Port::open();
    port.pump.on_packet(b"M112\n");
    port.pump.set_open(false, port.now);
    assert_eq!(port.hear(), "M112\n");
}

#[test]
fn a_packet_that_was_given_up_half_way_through_a_line_is_followed_by_a_line_break() {
    let mut port = Port::open();
    port.say(&"x".repeat(70));
    let mut into = [0; PACKET];
    assert_eq!(port.pump.packet(&mut into, port.now), Some(64));
    port.pump.on_sent(&into);
    let session = port.pump.session();
    port.reopen();
    assert_ne!(port.pump.session(), session);
    port.say("ok\n");
    assert_eq!(port.text(), "\nok\n");
}

#[test]
fn a_host_that_fetches_nothing_is_waited_for_for_half_a_second() {
    let mut port = Port::open();
    let mut into = [0; PACKET];
    let mut taken = 0;
    loop {
        let more = port.say("0123456789abcde\n");
        taken += more;
        if more < 16 {
            break;
        }
    }
    assert_eq!(taken, OUTGOING);
    assert_eq!(port.pump.packet(&mut into, port.now), Some(64));
    assert_eq!(port.say(&"y".repeat(100)), 64, "room for one packet more");
    port.now = port.now.after_ms(PATIENCE_MS - 1);
    assert_eq!(port.say("y"), 0);
    port.now = port.now.after_ms(1);
    for _ in 0..100 {
        assert_eq!(port.say("echo:nobody fetches this\n"), 25);
    }
    // It does, at last: the packet that waited goes, and then whole lines.
    port.say("ec");
    port.pump.on_sent(&into);
    port.say("ho\nok\n");
    assert_eq!(port.text(), "ok\n");
}

#[test]
fn a_slow_host_loses_nothing() {
    let mut port = Port::open();
    let (mut said, mut heard) = (String::new(), String::new());
    for n in 0..1000 {
        let line = format!("echo:line {n}\n");
        let mut rest = line.as_str();
        while !rest.is_empty() {
            let taken = port.say(rest);
            rest = &rest[taken..];
            if taken == 0 || n % 7 == 0 {
                port.now = port.now.after_ms(PATIENCE_MS - 1);
                let mut into = [0; PACKET];
                if let Some(length) = port.pump.packet(&mut into, port.now) {
                    port.pump.on_sent(&into[..length]);
                    heard.push_str(std::str::from_utf8(&into[..length]).unwrap());
                }
            }
        }
        said.push_str(&line);
    }
    heard.push_str(&port.text());
    assert_eq!(heard, said);
}

#[test]
fn a_packet_is_asked_for_only_if_it_fits() {
    let mut port = Port::open();
    let mut packets = 0;
    while port.pump.has_room() {
        port.pump.on_packet(&[b'x'; PACKET]);
        packets += 1;
    }
    assert_eq!(packets, INCOMING / PACKET);
    assert_eq!(port.recv(), Some(Received::Byte(b'x')));
    assert!(!port.pump.has_room());
    assert_eq!(port.hear().len(), INCOMING - 1);
    assert!(port.pump.has_room());
}

#[test]
fn a_packet_that_did_not_fit_before_the_port_was_opened_again_is_a_stray() {
    let mut port = Port::open();
    port.reopen();
    assert!(!port.pump.take_stray());
    while port.pump.has_room() {
        port.pump.on_packet(&[b'x'; PACKET]);
    }
    port.reopen();
    assert!(port.pump.take_stray() && !port.pump.take_stray());
}

#[test]
fn what_the_host_sends_at_once_waits_until_the_console_knows_of_the_opening() {
    let mut port = Port { pump: Pump::new(), now: Instant(0) };
    port.pump.set_open(true, port.now);
    port.pump.on_packet(b"M105\n");
    assert_eq!(port.recv(), None);
    port.now = port.now.after_ms(SETTLE_MS);
    assert_eq!(port.recv(), Some(Received::Opened));
    assert_eq!(port.hear(), "M105\n");
}
