//! The program of the computer that `cargo xtask usb` starts: takes the board by USB/IP, uses its port as people and
//! their programs do, and says what it found on the console. Its kernel is Debian's; this is its only program.
//!
//! It is compiled by itself, for Linux without a C library. A failure is a panic, which the console shows.

use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::net::TcpStream;
use std::os::fd::AsRawFd;
use std::path::Path;
use std::process::Command;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

/// The computer that runs the guest (QEMU's user networking), and the port of USB/IP.
const SERVER: &str = "10.0.2.2:3240";
const PORT: &str = "/dev/ttyACM0";
const DRIVER: &str = "/sys/bus/usb/drivers/cdc_acm/";
const CONTROLLER: &str = "/sys/devices/platform/vhci_hcd.0/";

/// The longest wait for an answer.
const PATIENCE: Duration = Duration::from_secs(60);

fn write_to(path: &str, text: &str) {
    let result = File::options().write(true).open(path).and_then(|mut file| file.write_all(text.as_bytes()));
    result.unwrap_or_else(|error| panic!("{path}: {error}"));
}

/// Plugs the board in (OP_REQ_IMPORT), and waits for its port.
fn plug() {
    let begin = Instant::now();
    let mut stream = loop {
        match TcpStream::connect(SERVER) {
            Ok(stream) => break stream,
            Err(error) => assert!(begin.elapsed() < PATIENCE, "{SERVER}: {error}"),
        }
        thread::sleep(Duration::from_millis(200));
    };
    stream.set_nodelay(true).unwrap();
    let mut request = vec![1, 0x11, 0x80, 0x03, 0, 0, 0, 0];
    request.extend(b"1-1");
    request.resize(40, 0);
    stream.write_all(&request).unwrap();
    let mut reply = [0; 8 + 312];
    stream.read_exact(&mut reply).unwrap();
    // Port 0, full speed. The kernel keeps the connection.
    write_to(&format!("{CONTROLLER}attach"), &format!("0 {} {} 2", stream.as_raw_fd(), 1 << 16 | 2));
    wait_for_port();
}

fn wait_for_port() {
    let begin = Instant::now();
    while !Path::new(PORT).exists() {
        assert!(begin.elapsed() < PATIENCE, "{PORT} does not appear");
        thread::sleep(Duration::from_millis(20));
    }
}

/// Pulls the cable.
fn pull() {
    write_to(&format!("{CONTROLLER}detach"), "0");
    let begin = Instant::now();
    while Path::new(PORT).exists() {
        assert!(begin.elapsed() < PATIENCE, "{PORT} stays");
        thread::sleep(Duration::from_millis(20));
    }
}

/// The open port.
struct Port {
    file: File,
    heard: Receiver<Vec<u8>>,
    /// What came and was not taken yet.
    text: String,
}

impl Port {
    fn open() -> Self {
        let file = OpenOptions::new().read(true).write(true).open(PORT).unwrap();
        let stty = Command::new("/bin/busybox").args(["stty", "-F", PORT, "raw", "-echo", "115200"]).status();
        assert!(stty.is_ok_and(|status| status.success()), "stty");
        let (sender, heard) = channel();
        let mut reader = file.try_clone().unwrap();
        thread::spawn(move || {
            let mut bytes = [0; 4096];
            while let Ok(length @ 1..) = reader.read(&mut bytes) {
                if sender.send(bytes[..length].to_vec()).is_err() {
                    return;
                }
            }
        });
        Self { file, heard, text: String::new() }
    }

    /// The next line of the board.
    fn line(&mut self) -> String {
        loop {
            if let Some((line, rest)) = self.text.split_once('\n') {
                let line = line.trim_end().to_owned();
                self.text = rest.to_owned();
                return line;
            }
            match self.heard.recv_timeout(PATIENCE) {
                Ok(bytes) => self.text.push_str(&String::from_utf8_lossy(&bytes)),
                Err(RecvTimeoutError::Timeout) => panic!("no answer; so far: {:?}", self.text),
                Err(RecvTimeoutError::Disconnected) => panic!("the port has gone"),
            }
        }
    }

    fn send(&mut self, text: &str) {
        self.file.write_all(text.as_bytes()).unwrap();
    }

    /// Waits for the greeting.
    fn greeted(mut self) -> Self {
        while self.line() != "start" {}
        self
    }

    /// The lines up to the next `ok`.
    fn answer(&mut self) -> Vec<String> {
        let mut lines = Vec::new();
        loop {
            let line = self.line();
            assert!(!line.contains("Error") && !line.contains("Resend"), "{line}");
            let is_last = line.starts_with("ok");
            lines.push(line);
            if is_last {
                return lines;
            }
        }
    }

    fn ask(&mut self, command: &str) -> Vec<String> {
        self.send(&format!("{command}\n"));
        self.answer()
    }
}

fn passed(what: &str, begin: Instant) {
    println!("guest: {what} ({:.1} s)", begin.elapsed().as_secs_f64());
}

fn main() {
    let begin = Instant::now();
    plug();
    passed("ttyACM0 is there", begin);

    let mut port = Port::open().greeted();
    for line in std::fs::read_to_string("/print.gcode").unwrap().lines() {
        port.ask(line);
    }
    assert!(port.ask("M115")[0].starts_with("FIRMWARE_NAME:CoreH-bot"));
    passed("the file is printed", begin);

    // A megabyte to the board, as many lines as its buffers take at once.
    let comment = format!(";{}\n", "corehbot ".repeat(9));
    let lines = (1 << 20) / comment.len();
    for _ in 0..lines / 8 {
        port.send(&comment.repeat(8));
        for _ in 0..8 {
            port.answer();
        }
    }
    passed("a megabyte went to the board", begin);
    // And a megabyte from it: the same report again and again.
    let report = port.ask("M503");
    let length: usize = report.iter().map(|line| line.len() + 1).sum();
    for _ in 0..(1 << 20) / length {
        assert_eq!(port.ask("M503"), report);
    }
    passed("a megabyte came from the board", begin);
    drop(port);

    for _ in 0..20 {
        let mut port = Port::open().greeted();
        port.ask("M105");
    }
    passed("opened and closed twenty times", begin);

    let mut port = Port::open().greeted();
    port.send("M104 S2");
    drop(port);
    let mut port = Port::open().greeted();
    assert!(port.ask("M105")[0].contains("/0.00"), "half a line of the session before");
    drop(port);
    passed("gone in the middle of a line", begin);

    for bind in ["unbind", "bind"] {
        // The interface of the port's control.
        write_to(&format!("{DRIVER}{bind}"), "1-1:1.0");
    }
    wait_for_port();
    Port::open().greeted().ask("M105");
    passed("the driver let go and took it again", begin);

    let mut port = Port::open().greeted();
    port.ask("M104 S60");
    drop(port);
    pull();
    plug();
    let heat = Port::open().greeted().ask("M105");
    assert!(heat[0].contains("/60.00"), "{heat:?}");
    passed("unplugged while heating", begin);
    pull();
    println!("guest: all passed");
}
