//! The printer behind a pseudo-terminal: the `corehbot serve` process and hosts that come and go.
#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

use corehbot_sim::host::FileHost;
use corehbot_sim::world::Host;
use rustix::fs::{Mode, OFlags, open};
use rustix::process::{Pid, Signal, kill_process};
use std::fs::File;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};

/// A running `corehbot serve`, and what it prints.
struct Served {
    process: Child,
    out: BufReader<ChildStdout>,
    path: PathBuf,
}

impl Served {
    fn start(args: &[&str]) -> Self {
        let mut command = Command::new(env!("CARGO_BIN_EXE_corehbot"));
        let mut process = command.arg("serve").args(args).stdout(Stdio::piped()).spawn().unwrap();
        let mut out = BufReader::new(process.stdout.take().unwrap());
        let mut path = String::new();
        out.read_line(&mut path).unwrap();
        Self { process, out, path: PathBuf::from(path.trim()) }
    }

    /// Ends it as Ctrl-C does: its status, and what it printed.
    fn interrupt(mut self) -> (Option<i32>, String) {
        kill_process(Pid::from_child(&self.process), Signal::INT).unwrap();
        let mut words = String::new();
        self.out.read_to_string(&mut words).unwrap();
        (self.process.wait().unwrap().code(), words)
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// A host on the port.
struct Client(BufReader<File>);

impl Client {
    fn open(path: &Path) -> Self {
        Self(BufReader::new(File::from(open(path, OFlags::RDWR | OFlags::NOCTTY, Mode::empty()).unwrap())))
    }

    fn say(&mut self, text: &[u8]) {
        self.0.get_mut().write_all(text).unwrap();
    }

    fn hear(&mut self) -> String {
        let mut line = String::new();
        self.0.read_line(&mut line).unwrap();
        line.trim_end().to_owned()
    }

    /// The answer to a command, up to its `ok`.
    fn ask(&mut self, command: &str) -> Vec<String> {
        self.say(format!("{command}\n").as_bytes());
        let mut answer = Vec::new();
        while !answer.last().is_some_and(|line: &String| line.starts_with("ok")) {
            answer.push(self.hear());
        }
        answer
    }
}

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("corehbot-serve-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn hosts_come_and_go_and_find_the_same_printer() {
    let served = Served::start(&["--speed", "max", "--assume-homed", "50,50,10"]);
    let mut client = Client::open(&served.path);
    assert_eq!(client.hear(), "start");
    assert!(client.ask("M115").iter().any(|line| line.starts_with("Cap:EMERGENCY_PARSER:1")));
    client.ask("G1 X60 F6000");
    // The next one ends the line that this one has begun.
    client.say(b"M40");
    drop(client);
    let mut client = Client::open(&served.path);
    assert_eq!(client.ask("0"), ["ok"]);
    assert!(client.ask("M114")[0].starts_with("X:60.00 Y:50.00 Z:10.00"));
    client.say(b"M112\nM114\n");
    drop(client);
    let mut client = Client::open(&served.path);
    assert!(client.hear().starts_with("Error:Printer halted"));
    let (status, words) = served.interrupt();
    assert_eq!(status, Some(0));
    assert!(words.contains("moves        1, underruns 0"), "{words}");
}

#[test]
fn the_steps_are_those_of_a_run() {
    let folder = folder("trace");
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/circle.gcode");
    let (ran, served) = (folder.join("run.csv"), folder.join("serve.csv"));
    let mut run = Command::new(env!("CARGO_BIN_EXE_corehbot"));
    run.arg("run").arg(&example).arg("--trace").arg(&ran).stdout(Stdio::null());
    assert!(run.status().unwrap().success());
    let printer = Served::start(&["--speed", "max", "--baud", "250000", "--trace", served.to_str().unwrap()]);
    let mut client = Client::open(&printer.path);
    let mut host = FileHost::new(&std::fs::read_to_string(example).unwrap());
    let mut line = Vec::new();
    while !host.is_done() {
        host.send(&mut line);
        client.say(&line);
        line.clear();
        host.hear(&client.hear());
    }
    assert_eq!((host.failure(), host.resends()), (None, 0));
    printer.interrupt();
    assert!(std::fs::read(ran).unwrap() == std::fs::read(served).unwrap());
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_link_replaces_a_stale_link_and_nothing_else() {
    let folder = folder("link");
    let link = folder.join("printer");
    let refused = |what: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_corehbot"));
        let output = command.args(["serve", "--pty"]).arg(&link).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{what}");
        assert!(String::from_utf8_lossy(&output.stderr).contains("is there already"), "{what}");
    };
    std::fs::write(&link, "precious").unwrap();
    refused("a file");
    std::fs::remove_file(&link).unwrap();
    symlink("/dev/null", &link).unwrap();
    refused("a link that leads somewhere");
    std::fs::remove_file(&link).unwrap();
    symlink(folder.join("gone"), &link).unwrap();
    let served = Served::start(&["--pty", link.to_str().unwrap()]);
    assert_eq!(served.path, link);
    assert!(Client::open(&link).ask("M105").iter().any(|line| line.starts_with("ok T:")));
    refused("the link of another one");
    assert_eq!(served.interrupt().0, Some(0));
    assert!(link.symlink_metadata().is_err(), "the link is left");
    std::fs::remove_dir_all(folder).unwrap();
}
