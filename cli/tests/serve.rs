//! The printer at a pseudo-terminal: the `corehbot serve` process and hosts that come and go.
#![cfg(unix)]

use corehbot_machine_file as machine_file;
use corehbot_sim::host::FileHost;
use corehbot_sim::world::Host;
use rustix::fs::{Mode, OFlags, open};
use rustix::process::{Pid, Signal, kill_process};
use std::fs::File;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};

/// A running `corehbot serve`, and its output.
struct Served {
    process: Child,
    out: BufReader<ChildStdout>,
    path: PathBuf,
}

impl Served {
    fn start(args: &[&str]) -> Self {
        Self::start_with(args, Stdio::null())
    }

    fn start_with(args: &[&str], input: Stdio) -> Self {
        let mut command = Command::new(env!("CARGO_BIN_EXE_corehbot"));
        // Nothing goes into the user's own folder.
        let keeps = args.contains(&"--storage");
        let storage: &[&str] = if keeps { &[] } else { &["--storage", "none"] };
        command.arg("serve").args(args).args(storage);
        Self::spawned(command, input)
    }

    fn spawned(mut command: Command, input: Stdio) -> Self {
        let mut process = command.stdin(input).stdout(Stdio::piped()).spawn().unwrap();
        let mut out = BufReader::new(process.stdout.take().unwrap());
        let mut path = String::new();
        out.read_line(&mut path).unwrap();
        Self { process, out, path: PathBuf::from(path.trim()) }
    }

    /// Ends it as Ctrl-C does; returns its status and its output.
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
    let told = client.hear();
    assert!(told.starts_with("Error:Printer halted. kill() called!") && told.contains("M999"), "{told}");
    let (status, words) = served.interrupt();
    assert_eq!(status, Some(0));
    assert!(words.contains("moves        1, underruns 0"), "{words}");
}

#[test]
fn the_steps_are_those_of_a_run() {
    let folder = folder("trace");
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/circle.gcode");
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

/// After M112 the next host can ask for a restart. The restart is a full one: the tool's place is unknown, the settings
/// are the stored ones, and the line is the same.
#[test]
fn after_an_emergency_stop_m999_is_a_new_start_on_the_same_line() {
    let folder = folder("restart");
    let (storage, trace) = (folder.join("eeprom.bin"), folder.join("trace.csv"));
    let [storage, trace] = [&storage, &trace].map(|path| path.to_str().unwrap());
    let args = ["--speed", "max", "--assume-homed", "50,50,10", "--storage", storage, "--trace", trace];
    let served = Served::start(&args);
    let mut client = Client::open(&served.path);
    assert_eq!(client.hear(), "start");
    client.ask("M203 X123");
    client.ask("M500");
    client.ask("M203 X99");
    client.ask("G1 X60 F6000");
    client.ask("M400");
    // Nothing to restart yet.
    assert_eq!(client.ask("M999"), ["ok"]);
    client.say(b"M112\n");
    while !client.hear().starts_with("Error:Printer halted") {}
    client.say(b"G1 X50\n");
    assert!(client.hear().starts_with("Error:Printer halted"));
    drop(client);
    // As OctoPrint connects: it must not hear of an error, or it hangs up again.
    let mut client = Client::open(&served.path);
    let halted = "echo:Printer halted. Send M999 or reset";
    assert_eq!(client.ask("N0 M110 N0*125"), [halted, "ok"]);
    assert!(client.ask("N1 M115*39").iter().any(|line| line.starts_with("Cap:")));
    assert_eq!(client.ask("M21"), [halted, "ok"]);
    assert!(client.ask("M105")[0].starts_with("ok T:"));
    client.say(b"G28\n");
    assert!(client.hear().starts_with("Error:Printer halted"));
    client.say(b"M999\n");
    assert_eq!(client.hear(), "start");
    assert!(client.ask("M105").last().unwrap().starts_with("ok T:"));
    assert!(client.ask("M203").contains(&"  M203 X123 Y300 Z20 E80".to_owned()));
    assert!(client.ask("M114")[0].starts_with("X:0.00 Y:0.00 Z:0.00"));
    let moved = client.ask("G1 X5 F6000");
    assert!(moved[0].starts_with("echo:motion before homing"), "{moved:?}");
    // Its switches are where they were: homing finds the way back from 60 and 5 mm.
    client.ask("G28 X");
    client.ask("G1 X5");
    client.ask("M400");
    // And again.
    client.say(b"M112\nM999\n");
    while client.hear() != "start" {}
    assert!(client.ask("M114").iter().any(|line| line.starts_with("X:0.00")));
    let (status, words) = served.interrupt();
    assert_eq!(status, Some(0));
    assert!(words.contains("moves        6,"), "{words}");
    // One trace; its time never goes back. The belts were turned from 50 to 60 and 65 mm, to the switch, and to 5 mm.
    let trace = std::fs::read_to_string(trace).unwrap();
    let ticks: Vec<u64> = trace.lines().filter_map(|line| line.split(',').next()?.parse().ok()).collect();
    assert!(ticks.len() > 1000 && ticks.is_sorted());
    std::fs::remove_dir_all(folder).unwrap();
}

/// The firmware restarts after a stop, and its heaters keep their temperature: they cool in their own time.
#[test]
fn a_new_start_cools_no_heater() {
    let machine = Path::new(env!("CARGO_MANIFEST_DIR")).join("../xtask/clients/heat.toml");
    let served =
        Served::start(&["--speed", "max", "--assume-homed", "50,50,10", "--machine", machine.to_str().unwrap()]);
    let mut client = Client::open(&served.path);
    while !client.hear().starts_with("echo:corehbot") {}
    client.ask("M109 S200");
    for _ in 0..2 {
        client.say(b"M112\nM999\n");
        while client.hear() != "start" {}
        while !client.hear().starts_with("echo:corehbot") {}
        // Nothing is read in the first moment.
        client.ask("G4 P500");
        let told = client.ask("M105").pop().unwrap();
        let (celsius, _) = told.strip_prefix("ok T:").unwrap().split_once(' ').unwrap();
        assert!((150.0..205.0).contains(&celsius.parse::<f64>().unwrap()), "{told}");
        // It prints again.
        client.ask("M109 S200");
        let told = client.ask("G1 X60 E2 F1200");
        assert!(!told.iter().any(|line| line.contains("cold")), "{told:?}");
        client.ask("M400");
    }
    assert_eq!(served.interrupt().0, Some(0));
}

/// Typed text is echoed, and can be erased; a line with a checksum is not edited.
#[test]
fn a_person_types_with_echo_and_backspace() {
    let served = Served::start(&["--speed", "max", "--assume-homed", "50,50,10", "--echo"]);
    let mut client = Client::open(&served.path);
    while !client.hear().starts_with("echo:corehbot") {}
    client.say(b"G1 X77\x08\x7F65 F600O\x080\r");
    assert_eq!(client.hear(), "G1 X77\x08 \x08\x08 \x0865 F600O\x08 \x080");
    assert_eq!(client.hear(), "ok");
    client.say(b"M114\r\n");
    assert_eq!(client.hear(), "M114");
    assert!(client.hear().starts_with("X:65.00 Y:50.00"));
}

/// Runs `corehbot config`; returns its status and its output.
fn config(args: &[&str]) -> (Option<i32>, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_corehbot")).arg("config").args(args).output().unwrap();
    let said = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    (output.status.code(), said.concat())
}

#[test]
fn a_machine_is_sent_and_comes_back() {
    let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("config");
    std::fs::create_dir_all(&place).unwrap();
    let [eeprom, mine, got] = ["e.bin", "mine.toml", "got.toml"].map(|name| place.join(name));
    let _ = std::fs::remove_file(&eeprom);
    std::fs::write(&mine, "name = \"mine\"\nkeepalive_s = 9\n[axes.z]\nlength = 123.4567\n").unwrap();
    let served = Served::start(&["--storage", eeprom.to_str().unwrap(), "--speed", "20"]);
    let port = served.path.to_str().unwrap();
    let (status, said) = config(&["send", mine.to_str().unwrap(), port]);
    assert!(status == Some(0) && said.contains("stored (") && said.contains("in effect now"), "{said}");
    let (status, said) = config(&["get", port]);
    assert_eq!(status, Some(0), "{said}");
    std::fs::write(&got, &said).unwrap();
    let [sent, read] = [&mine, &got].map(|file| machine_file::read(file).unwrap().settings);
    assert_eq!(read, sent);
    // The file from the board can be sent, and changes nothing.
    assert_eq!(config(&["send", got.to_str().unwrap(), port]).0, Some(0));
    assert_eq!(config(&["get", port]).1, said);
    // Another mechanism waits for the next start.
    let corexy = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/machines/corexy.toml");
    let (status, said) = config(&["send", corexy.to_str().unwrap(), port]);
    assert!(status == Some(0) && said.contains("in effect after the next reset"), "{said}");
    // Errors of a file are reported before anything is sent, and the port must be a serial line.
    std::fs::write(&mine, "keepalive_s = 99\n").unwrap();
    let (status, said) = config(&["send", mine.to_str().unwrap(), port]);
    assert!(status == Some(2) && said.contains("mine.toml:1:15: keepalive_s = 99"), "{status:?} {said}");
    let (status, said) = config(&["get", got.to_str().unwrap()]);
    assert!(status == Some(2) && said.contains("as a serial line"), "{status:?} {said}");
    served.interrupt();
}

#[test]
fn settings_are_kept_in_the_user_s_folder_for_data_one_image_for_each_machine() {
    let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("kept");
    let _ = std::fs::remove_dir_all(&place);
    let serve = |more: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_corehbot"));
        command.args(["serve", "--speed", "max"]).args(more).env("XDG_DATA_HOME", &place);
        Served::spawned(command, Stdio::null())
    };
    let speeds = |served: &Served| Client::open(&served.path).ask("M203").join("\n");
    let first = serve(&[]);
    let mut client = Client::open(&first.path);
    client.ask("M203 X77");
    client.ask("M500");
    // Another one at the same time keeps nothing, and finds nothing.
    let second = serve(&[]);
    assert!(!speeds(&second).contains("X77"), "{}", speeds(&second));
    second.interrupt();
    first.interrupt();
    let again = serve(&[]);
    assert!(speeds(&again).contains("X77"), "{}", speeds(&again));
    again.interrupt();
    let machine = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/machines/corexy.toml");
    let other = serve(&["--machine", machine.to_str().unwrap()]);
    assert!(!speeds(&other).contains("X77"), "{}", speeds(&other));
    other.interrupt();
    let images = std::fs::read_dir(place.join("corehbot")).unwrap().map(|file| file.unwrap().path());
    assert_eq!(images.filter(|path| path.extension().is_some_and(|end| end == "eeprom")).count(), 2);
}

/// A hand presses a switch, which is plugged into another input; a driver does not answer.
#[test]
fn a_hand_presses_switches_and_mistakes_of_the_wiring_show() {
    let args = ["--speed", "max", "--hand", "--fault", "swap-endstops:x,y", "--fault", "silent-driver:m4"];
    let mut served = Served::start_with(&args, Stdio::piped());
    let mut hand = served.process.stdin.take().unwrap();
    let mut client = Client::open(&served.path);
    client.hear();
    assert!(client.ask("M119").contains(&"y_min: open".to_owned()));
    hand.write_all(b"press x\n").unwrap();
    let mut told = client.ask("M119");
    while !told.contains(&"y_min: TRIGGERED".to_owned()) {
        told = client.ask("M119");
    }
    assert!(told.contains(&"x_min: open".to_owned()), "{told:?}");
    let told = client.ask("M122");
    assert!(told.iter().any(|line| line.starts_with("Driver m4: does not answer")), "{told:?}");
    served.interrupt();
    let mut wrong = Command::new(env!("CARGO_BIN_EXE_corehbot"));
    let output = wrong.args(["serve", "--fault", "swap-motors:m1,m9"]).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(told.contains("expected swap-motors: and 2 different of m1, m4, m8, m11, z1, z2, e0"), "{told}");
}
