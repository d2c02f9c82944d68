//! A printer at its port, and `corehbot bringup` at the other end.

use std::io::{BufRead as _, BufReader, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};

/// A folder of its own with a machine file, and a printer at its port.
pub(super) struct Bench {
    pub(super) folder: PathBuf,
    pub(super) printer: Child,
    pub(super) hand: ChildStdin,
}

impl Bench {
    pub(super) fn new(mistakes: &[&str]) -> Self {
        static NUMBER: AtomicU32 = AtomicU32::new(0);
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let folder = std::env::temp_dir().join(format!("corehbot-bringup-{}-{number}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let mut new = Command::new(env!("CARGO_BIN_EXE_corehbot"));
        new.args(["config", "new", "--board", "octopus", "--kinematics", "corehbot", "--heaters", "-o"]);
        assert!(new.arg(folder.join("m.toml")).status().unwrap().success());
        let (printer, hand) = serve(&folder, mistakes);
        Self { folder, printer, hand }
    }

    pub(super) fn port(&self) -> PathBuf {
        self.folder.join("printer")
    }

    pub(super) fn guide(&self, args: &[&str]) -> Child {
        let mut guide = Command::new(env!("CARGO_BIN_EXE_corehbot"));
        guide.arg("bringup").arg(self.port()).arg("--report").arg(self.folder.join("r.md")).args(args);
        guide.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap()
    }

    pub(super) fn report(&self) -> String {
        std::fs::read_to_string(self.folder.join("r.md")).unwrap()
    }

    /// Leads through the guide. `owner` gets the key of each question and the hand; its answer is a line.
    pub(super) fn lead(&mut self, args: &[&str], mut owner: impl FnMut(&str, &mut dyn FnMut(&str)) -> String) -> Led {
        let mut guide = self.guide(args);
        let (mut out, mut said) = (guide.stdin.take().unwrap(), String::new());
        for line in BufReader::new(guide.stdout.take().unwrap()).lines().map_while(Result::ok) {
            said += &line;
            said.push('\n');
            let Some((key, _)) = line.strip_prefix("? [").and_then(|line| line.split_once(']')) else { continue };
            let mut act = |line: &str| {
                self.hand.write_all(format!("{line}\n").as_bytes()).unwrap();
                // The printer looks at its hand every 0.1 ms.
                std::thread::sleep(std::time::Duration::from_millis(20));
            };
            let answer = owner(key, &mut act);
            if writeln!(out, "{answer}").is_err() {
                break;
            }
        }
        Led { status: guide.wait().unwrap().code(), said, report: self.report() }
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        let _ = self.printer.kill();
        let _ = self.printer.wait();
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

pub(super) fn serve(folder: &Path, mistakes: &[&str]) -> (Child, ChildStdin) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_corehbot"));
    let speed: &[&str] = if mistakes.contains(&"--speed") { &[] } else { &["--speed", "max"] };
    command.arg("serve").args(speed).args(["--hand", "--machine"]).arg(folder.join("m.toml"));
    command.arg("--pty").arg(folder.join("printer")).arg("--storage").arg(folder.join("e.bin")).args(mistakes);
    let mut printer = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    // Its port is there when it says so.
    BufReader::new(printer.stdout.as_mut().unwrap()).read_line(&mut String::new()).unwrap();
    let hand = printer.stdin.take().unwrap();
    (printer, hand)
}

pub(super) struct Led {
    pub(super) status: Option<i32>,
    pub(super) said: String,
    pub(super) report: String,
}

/// Asks the printer for something, as another program would.
pub(super) fn ask(bench: &Bench, line: &str) -> String {
    let port = std::fs::OpenOptions::new().read(true).write(true).open(bench.port()).unwrap();
    let mut port = BufReader::new(port);
    port.get_mut().write_all(format!("M118 here\n{line}\n").as_bytes()).unwrap();
    let mut heard = String::new();
    while heard.matches("ok").count() < 2 || !heard.contains("here") {
        let mut part = String::new();
        port.read_line(&mut part).unwrap();
        if heard.contains("here") || part.contains("here") {
            heard += &part;
        }
    }
    heard
}
