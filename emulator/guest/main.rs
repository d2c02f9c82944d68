//! The program of the computer that `cargo xtask usb` starts. It takes the board by USB/IP, uses its port as people and
//! their programs do, and prints its findings to the console. The kernel is Debian's; this is the only program.
//!
//! It is compiled by itself, for Linux without a C library. A failure is a panic, which the console shows.

use std::ffi::{c_int, c_void};
use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::net::TcpStream;
use std::os::fd::AsRawFd;
use std::path::Path;
use std::process::Command;
use std::thread;
use std::time::{Duration, Instant};

/// The computer that runs the guest (QEMU's user networking), and the port of USB/IP.
const SERVER: &str = "10.0.2.2:3240";
const PORT: &str = "/dev/ttyACM0";
const DRIVER: &str = "/sys/bus/usb/drivers/cdc_acm/";
/// The interface of the port's control.
const INTERFACE: &str = "1-1:1.0";
const CONTROLLER: &str = "/sys/devices/platform/vhci_hcd.0/";

/// The device as programs without a driver reach it, once it has its address.
const DEVICES: &str = "/dev/bus/usb/001/";

/// USBDEVFS_CONTROL and USBDEVFS_CLEAR_HALT (linux/usbdevice_fs.h).
const CONTROL: c_int = 0xC018_5500_u32.cast_signed();
const CLEAR_HALT: c_int = 0x8004_5515_u32.cast_signed();

/// The port's two endpoints for data.
const DATA: [u32; 2] = [0x01, 0x82];

/// Control requests that no serial port has: type, request, value, index, length. Two are a maker's, two a class's, two
/// standard ones with a strange receiver or number, two ask for descriptors that are not there.
const STRANGE: [(u8, u8, u16, u16, u16); 8] = [
    (0xC0, 0x51, 1, 2, 64),
    (0x40, 0x51, 1, 2, 0),
    (0xA1, 0x7F, 0, 0, 8),
    (0x21, 0x7F, 0, 0, 8),
    (0x83, 0x00, 0, 0, 2),
    (0x80, 0x06, 0x0E00, 0, 255),
    (0x80, 0x06, 0x03FF, 0x0409, 255),
    (0x81, 0x7E, 0, 1, 1),
];

/// struct usbdevfs_ctrltransfer.
#[repr(C)]
struct ControlTransfer {
    kind: u8,
    request: u8,
    value: u16,
    index: u16,
    length: u16,
    timeout_ms: u32,
    data: *mut c_void,
}

unsafe extern "C" {
    /// ioctl(2).
    fn ioctl(file: c_int, request: c_int, ...) -> c_int;
}

/// A stall, as Linux numbers it.
const EPIPE: i32 = 32;

/// Lines that are sent without waiting for their answers: 9 kB.
const BURST: usize = 100;

/// The longest wait for an answer.
const PATIENCE: Duration = Duration::from_secs(300);

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

/// The open port. It is closed when this goes.
struct Port {
    file: File,
    /// What came and was not taken yet.
    text: String,
}

impl Port {
    fn open() -> Self {
        let file = OpenOptions::new().read(true).write(true).open(PORT).unwrap();
        // A read that gets nothing for half a second is over.
        let options = ["stty", "-F", PORT, "raw", "-echo", "115200", "min", "0", "time", "5"];
        let stty = Command::new("/bin/busybox").args(options).status();
        assert!(stty.is_ok_and(|status| status.success()), "stty");
        Self { file, text: String::new() }
    }

    /// The next line of the board.
    fn line(&mut self) -> String {
        let begin = Instant::now();
        let mut bytes = [0; 4096];
        loop {
            if let Some((line, rest)) = self.text.split_once('\n') {
                let line = line.trim_end().to_owned();
                self.text = rest.to_owned();
                return line;
            }
            let length = self.file.read(&mut bytes).unwrap();
            self.text.push_str(&String::from_utf8_lossy(&bytes[..length]));
            assert!(length > 0 || begin.elapsed() < PATIENCE, "no answer; so far: {:?}", self.text);
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

/// The device without its driver.
fn device() -> File {
    let name = std::fs::read_dir(DEVICES).unwrap().map(|entry| entry.unwrap().file_name()).max().unwrap();
    File::options().read(true).write(true).open(Path::new(DEVICES).join(name)).unwrap()
}

/// Sends a control request. Returns whether the board took it.
fn control(device: &File, (kind, request, value, index, length): (u8, u8, u16, u16, u16)) -> bool {
    let mut bytes = [0_u8; 255];
    let data = bytes.as_mut_ptr().cast();
    let transfer = ControlTransfer { kind, request, value, index, length, timeout_ms: 5000, data };
    // SAFETY: the kernel reads the structure, and reads or writes at most 255 bytes at `data`; both outlive the call.
    let result = unsafe { ioctl(device.as_raw_fd(), CONTROL, &raw const transfer) };
    let is_stall = std::io::Error::last_os_error().raw_os_error() == Some(EPIPE);
    assert!(result >= 0 || is_stall, "{kind:02x} {request:02x}: {}", std::io::Error::last_os_error());
    result >= 0
}

/// Clears the halt of both endpoints for data: their toggles start at zero again.
fn clear_halts(device: &File) {
    for endpoint in DATA {
        // SAFETY: the kernel reads the four bytes of `endpoint`, which outlives the call.
        let result = unsafe { ioctl(device.as_raw_fd(), CLEAR_HALT, &raw const endpoint) };
        assert_eq!(result, 0, "clear-halt of {endpoint:02x}: {}", std::io::Error::last_os_error());
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
        // A line with a comment alone has no answer.
        let words = line.split(';').next().unwrap_or_default().trim();
        if !words.is_empty() {
            port.ask(words);
        }
    }
    assert!(port.ask("M115")[0].starts_with("FIRMWARE_NAME:CoreH-bot"));
    passed("the file is printed", begin);

    // A megabyte to the board, always more than its buffers take at once.
    let line = format!("G4 P0 ;{}\n", "corehbot ".repeat(9));
    for _ in 0..(1 << 20) / line.len() / BURST {
        port.send(&line.repeat(BURST));
        for _ in 0..BURST {
            assert_eq!(port.answer(), ["ok"]);
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

    for request in STRANGE {
        write_to(&format!("{DRIVER}unbind"), INTERFACE);
        let device = device();
        assert!(!control(&device, request), "taken: {request:02x?}");
        clear_halts(&device);
        drop(device);
        write_to(&format!("{DRIVER}bind"), INTERFACE);
        wait_for_port();
        Port::open().greeted().ask("M105");
    }
    passed("the driver let go, sent strange requests, cleared halts, and took the port again", begin);

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
