//! A computer far away: the protocol as Linux' `vhci_hcd` speaks it, with the image at the other end.

use crate::common::{Bench, firmware, print, print_on};
use corehbot_emulator::watch::End;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

const PRINT: &str = "G92 X0 Y0 Z0\nM17\nG1 X12 Y5 F6000\nG1 X3 Y9\nG1 X0 Y0\nM400\nM115\nM18\n";

/// The endpoints of the port's data.
const OUT: u32 = 1;
const IN: u32 = 2;

fn words(words: &[u32]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_be_bytes()).collect()
}

/// The computer's end.
struct Client {
    stream: TcpStream,
    sequence: u32,
}

impl Client {
    /// Comes as soon as somebody listens.
    fn attach(port: u16) -> Self {
        let begin = Instant::now();
        let mut stream = loop {
            match TcpStream::connect(("127.0.0.1", port)) {
                Ok(stream) => break stream,
                Err(error) => assert!(begin.elapsed() < Duration::from_secs(60), "{error}"),
            }
            std::thread::sleep(Duration::from_millis(50));
        };
        stream.set_read_timeout(Some(Duration::from_secs(120))).unwrap();
        let mut request = vec![1, 0x11, 0x80, 0x03, 0, 0, 0, 0];
        request.extend(b"1-1");
        request.resize(40, 0);
        stream.write_all(&request).unwrap();
        let mut reply = [0; 8 + 312];
        stream.read_exact(&mut reply).unwrap();
        assert_eq!(reply[..8], [1, 0x11, 0, 3, 0, 0, 0, 0]);
        // Full speed, 1209:0001, two interfaces.
        let device = &reply[8 + 256 + 32..];
        assert_eq!(device[8..12], [0, 0, 0, 2]);
        assert_eq!((&device[12..16], device[23]), (&[0x12, 0x09, 0, 1][..], 2));
        Self { stream, sequence: 0 }
    }

    fn submit(&mut self, is_in: bool, endpoint: u32, length: u32, setup: [u8; 8], data: &[u8]) -> u32 {
        self.sequence += 1;
        let mut message = words(&[1, self.sequence, 1 << 16 | 2, is_in.into(), endpoint, 0, length, 0, 0, 0]);
        message.extend(setup);
        message.extend(data);
        self.stream.write_all(&message).unwrap();
        self.sequence
    }

    /// The next answer: its command, sequence, status and bytes.
    fn answer(&mut self, has_data: impl Fn(u32) -> bool) -> (u32, u32, i32, Vec<u8>) {
        let mut header = [0; 48];
        self.stream.read_exact(&mut header).unwrap();
        let word = |n: usize| u32::from_be_bytes(header[4 * n..4 * n + 4].try_into().unwrap());
        let [command, sequence, status, length] = [word(0), word(1), word(5), word(6)];
        let mut bytes = vec![0; if command == 3 && has_data(sequence) { length as usize } else { 0 }];
        self.stream.read_exact(&mut bytes).unwrap();
        (command, sequence, status.cast_signed(), bytes)
    }

    fn control(&mut self, setup: [u8; 8], data: &[u8]) -> (i32, Vec<u8>) {
        let is_in = setup[0] & 0x80 != 0;
        let length = u32::from(u16::from_le_bytes([setup[6], setup[7]]));
        let sequence = self.submit(is_in, 0, length, setup, data);
        let (command, answered, status, bytes) = self.answer(|_| is_in);
        assert_eq!((command, answered), (3, sequence));
        (status, bytes)
    }
}

/// Prints `PRINT` through the port, and returns what the board said.
fn talk(port: u16) -> String {
    let mut client = Client::attach(port);
    let (_, configuration) = client.control([0x80, 6, 0, 2, 0, 0, 255, 0], &[]);
    assert_eq!((configuration[0], configuration[1]), (9, 2));
    // A request that nobody knows stalls.
    assert_eq!(client.control([0xC0, 0x33, 0, 0, 0, 0, 8, 0], &[]).0, -32);
    assert_eq!(client.control([0, 9, 1, 0, 0, 0, 0, 0], &[]).0, 0);
    assert_eq!(client.control([0x21, 0x20, 0, 0, 0, 0, 7, 0], &[0, 0xC2, 1, 0, 0, 0, 8]).0, 0);
    // A request for data that is taken back before there are any.
    let waiting = client.submit(true, IN, 512, [0; 8], &[]);
    client.sequence += 1;
    let mut unlink = words(&[2, client.sequence, 1 << 16 | 2, 0, 0, waiting]);
    unlink.resize(48, 0);
    client.stream.write_all(&unlink).unwrap();
    let (command, sequence, status, _) = client.answer(|_| false);
    assert_eq!((command, sequence, status), (4, client.sequence, -104));
    assert_eq!(client.control([0x21, 0x22, 3, 0, 0, 0, 0, 0], &[]).0, 0);
    let (mut said, mut lines) = (String::new(), PRINT.lines());
    let (mut heard, mut line) = (0, None);
    let mut reading = client.submit(true, IN, 512, [0; 8], &[]);
    loop {
        let (_, sequence, status, bytes) = client.answer(|sequence| sequence == reading);
        assert_eq!(status, 0);
        if Some(sequence) == line || sequence != reading {
            continue;
        }
        said.push_str(&String::from_utf8_lossy(&bytes));
        reading = client.submit(true, IN, 512, [0; 8], &[]);
        // The greeting and every answer let a line go.
        let ready = said.lines().filter(|line| *line == "start" || line.starts_with("ok")).count();
        while heard < ready && said.ends_with('\n') {
            heard += 1;
            let Some(text) = lines.next() else { return said };
            let text = format!("{text}\n");
            line = Some(client.submit(false, OUT, text.len() as u32, [0; 8], text.as_bytes()));
        }
    }
}

#[test]
fn a_computer_far_away_prints_the_same_steps() {
    let port = 32_400;
    let client = std::thread::spawn(move || talk(port));
    let address = format!("127.0.0.1:{port}");
    let firmware = firmware();
    let seen = print_on(&firmware, PRINT, &Bench { network: Some(&address), ..Bench::default() });
    let said = client.join().unwrap();
    assert_eq!((seen.end, seen.resets.len()), (End::Done, 0), "{said}");
    assert!(said.contains("FIRMWARE_NAME:CoreH-bot"), "{said}");
    let serial = print(&firmware, PRINT, None);
    let steps = |events: &[corehbot_emulator::steps::StepEvent]| events.iter().map(|e| e.steps).collect::<Vec<_>>();
    assert_eq!(steps(&seen.recorder.events), steps(&serial.recorder.events));
    assert!(seen.recorder.events.len() > 1000);
}
