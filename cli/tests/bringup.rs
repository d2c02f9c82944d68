//! The first hour on the simulated printer: `corehbot bringup` at the port of `corehbot serve`, with mistakes of a
//! builder, and an owner who sees what the plant does.
#![cfg(unix)]

mod bench;
mod owner;

use bench::{Bench, ask, serve};
use owner::{STRAIGHT, Wires, honest};
use rustix::process::{Pid, Signal, kill_process};
use std::io::{BufRead as _, BufReader, Write as _};
use std::process::Command;

#[test]
fn a_machine_without_mistakes_passes_and_keeps_its_tuning() {
    let mut bench = Bench::new(&[]);
    let mut owner = honest(STRAIGHT);
    let led = bench.lead(&[], |key, act| if key.starts_with("tuning") { "yes".to_owned() } else { owner(key, act) });
    assert_eq!(led.status, Some(0), "{}", led.said);
    assert_eq!(led.report.matches(": passed\n").count(), 11, "{}", led.report);
    for part in [
        "24.1 V",
        "hotend: follows a warm hand by ",
        "m1 m4 m8 m11: wired as in the file",
        "Y: back",
        "J/K",
        "stored (M500)",
    ] {
        assert!(led.report.contains(part), "{part}: {}", led.report);
    }
    // Homing was slow, and the slow speeds were not stored.
    let mut get = Command::new(env!("CARGO_BIN_EXE_corehbot"));
    let machine = get.args(["config", "get"]).arg(bench.port()).output().unwrap();
    let (machine, file) = (String::from_utf8(machine.stdout).unwrap(), bench.folder.join("m.toml"));
    let speeds = |text: &str| {
        let mut speeds: Vec<_> = text.lines().filter(|line| line.starts_with("max_speed")).map(str::to_owned).collect();
        speeds.sort();
        speeds
    };
    assert_eq!(speeds(&machine), speeds(&std::fs::read_to_string(file).unwrap()));
    // Again: everything is behind us.
    let led = bench.lead(&[], |key, _| panic!("asked for {key}"));
    assert_eq!(led.status, Some(0), "{}", led.said);
}

#[test]
fn without_a_person_nothing_is_asked_that_needs_a_hand() {
    let mut bench = Bench::new(&[]);
    let led = bench.lead(&["--yes"], |_, _| String::new());
    assert_eq!(led.status, Some(0), "{}", led.said);
    for part in
        ["hotend: not warmed by hand", "not pressed by hand", "the voltage at a 5 V pin of the board: not measured"]
    {
        assert!(led.report.contains(part), "{part}: {}", led.report);
    }
}

/// A mistake: how the printer makes it, the wires after it, the step that finds it, its words, and its cure.
type Mistake = (&'static [&'static str], Wires, &'static str, &'static str, &'static str);

const WIRED: &str = "m1 m4 m8 m11: its plug is elsewhere, or turned round.";

#[rustfmt::skip]
const MISTAKES: &[Mistake] = &[
    (&["--fault", "swap-motors:m1,m8"], [Some((2, 1)), Some((1, 1)), Some((0, 1)), Some((3, 1))], "motors", WIRED,
        "`m1 = \"M4\"`, `m8 = \"M0\"`"),
    (&["--fault", "reverse-motor:m4"], [Some((0, 1)), Some((1, -1)), Some((2, 1)), Some((3, 1))], "motors", WIRED,
        "`m4 = \"!M1\"`"),
    // Driver 1 turns motor 8 backward, and driver 8 turns motor 1.
    (&["--fault", "swap-motors:m1,m8", "--fault", "reverse-motor:m1"],
        [Some((2, -1)), Some((1, 1)), Some((0, 1)), Some((3, 1))], "motors", WIRED, "`m1 = \"M4\"`, `m8 = \"!M0\"`"),
    // Each motor in the place of the opposite one, and the other way round: the tool goes as it should.
    (&["--fault", "swap-motors:m1,m8", "--fault", "swap-motors:m4,m11", "--fault", "reverse-motor:m1",
        "--fault", "reverse-motor:m4", "--fault", "reverse-motor:m8", "--fault", "reverse-motor:m11"],
        [Some((2, -1)), Some((3, -1)), Some((0, -1)), Some((1, -1))], "motors", WIRED,
        "`m1 = \"!M4\"`, `m4 = \"!M3\"`, `m8 = \"!M0\"`, `m11 = \"!M1\"`"),
    (&["--fault", "dead-motor:m11"], [Some((0, 1)), Some((1, 1)), Some((2, 1)), None], "motors", "m11: nothing moves.",
        "Check the motor's plug and its coils"),
    (&["--break", "open:hotend@0s"], STRAIGHT, "sensors", "hotend: its sensor is open.", "plug it in"),
    (&["--break", "short:bed@0s"], STRAIGHT, "sensors", "bed: its sensor is shorted.", "bare wires"),
    (&["--break", "swapped-sensors@0s"], STRAIGHT, "sensors",
        "hotend (now it is bed): another sensor follows its warmth.", "exchange the two plugs"),
    (&["--fault", "swap-endstops:x,y"], STRAIGHT, "endstops", "x_min (it is y_min): another input reads pressed.",
        "exchange the two plugs"),
    (&["--fault", "stuck-endstop:z"], STRAIGHT, "endstops", "z_min: reads pressed although nothing touches it.",
        "plug it in, or invert it"),
    (&["--fault", "dead-endstop:x"], STRAIGHT, "endstops", "x_min: does not read pressed.", "its plug and its two wires"),
    (&["--fault", "silent-driver:m4"], STRAIGHT, "drivers", "m4: does not answer: is the motor supply on",
        "sits straight in its socket"),
    (&["--break", "swapped-heaters@0s"], STRAIGHT, "heaters",
        "bed (its output warms the sensor of hotend): another sensor got warmer.", "Exchange the plugs of the heaters"),
    (&["--break", "no-heat:bed@0s"], STRAIGHT, "heaters", "bed: no sensor got warmer.", "Check the heater's wires"),
];

#[test]
fn every_mistake_is_named_with_its_cure() {
    for (mistakes, wires, step, what, cure) in MISTAKES {
        let mut bench = Bench::new(mistakes);
        let mut owner = honest(*wires);
        let mut is_over = false;
        let led = bench.lead(&["--from", step], |key, act| {
            // The step is found out; the rest is another test's.
            is_over |= key.ends_with(" decide");
            if is_over { "quit".to_owned() } else { owner(key, act) }
        });
        assert_eq!(led.status, Some(1), "{mistakes:?}: {}", led.said);
        let found = led.report.lines().find(|line| line.starts_with(&format!("- **{what}")));
        assert!(found.is_some_and(|line| line.contains(cure)), "{mistakes:?}: {}", led.report);
    }
}

/// The machine file as the guide would have it is right for the machine as it is wired.
#[test]
fn a_quit_guide_goes_on_with_the_same_step_after_the_cure() {
    let mut bench = Bench::new(&["--fault", "swap-motors:m1,m8"]);
    let wires = [Some((2, 1)), Some((1, 1)), Some((0, 1)), Some((3, 1))];
    let mut owner = honest(wires);
    let led = bench.lead(&[], |key, act| if key == "motors decide" { "quit".to_owned() } else { owner(key, act) });
    assert_eq!(led.status, Some(1));
    assert!(led.said.contains("goes on with this step"), "{}", led.said);
    // The cure: plugs in their places, and the printer is switched on again.
    kill_process(Pid::from_child(&bench.printer), Signal::INT).unwrap();
    bench.printer.wait().unwrap();
    (bench.printer, bench.hand) = serve(&bench.folder, &[]);
    let (mut owner, mut keys) = (honest(STRAIGHT), Vec::new());
    let led = bench.lead(&[], |key, act| {
        keys.push(key.to_owned());
        owner(key, act)
    });
    assert_eq!(led.status, Some(0), "{}", led.said);
    assert_eq!(keys[0], "motors begin");
    assert_eq!(led.report.matches(": passed\n").count(), 11, "{}", led.report);
}

#[test]
fn ctrl_c_leaves_everything_cold_and_without_power() {
    let mut bench = Bench::new(&[]);
    let mut guide = bench.guide(&["--from", "tuning"]);
    let mut out = guide.stdin.take().unwrap();
    let mut lines = BufReader::new(guide.stdout.take().unwrap()).lines().map_while(Result::ok);
    let mut until = |key: &str| while !lines.by_ref().any(|line| line.starts_with(&format!("? [{key}]"))) {};
    until("tuning needs");
    writeln!(out, "yes").unwrap();
    until("tuning hotend");
    writeln!(out, "yes").unwrap();
    std::thread::sleep(std::time::Duration::from_millis(300));
    kill_process(Pid::from_child(&guide), Signal::INT).unwrap();
    let rest: Vec<_> = lines.collect();
    assert_eq!(guide.wait().unwrap().code(), Some(130), "{rest:?}");
    assert!(rest.iter().any(|line| line.contains("stopped by Ctrl-C")), "{rest:?}");
    let heard = ask(&bench, "M105");
    assert!(heard.contains("/0.00") && heard.contains("@:0"), "{heard}");
    let _ = &mut bench.hand;
}

#[test]
fn a_switch_that_is_not_met_and_a_lost_board_end_the_guide() {
    let mut bench = Bench::new(&["--fault", "dead-endstop:x"]);
    let mut owner = honest(STRAIGHT);
    // The switch of x never answers: the firmware says so after the whole length.
    let led =
        bench.lead(
            &["--from", "homing"],
            |key, act| {
                if key.ends_with("decide") { "quit".to_owned() } else { owner(key, act) }
            },
        );
    assert!(led.report.contains("**X, X endstop was not met"), "{}", led.report);
    // The board is switched off while its owner thinks.
    let mut killed = false;
    let printer = Pid::from_child(&bench.printer);
    let led = bench.lead(&["--from", "endstops"], |_, _| {
        if !killed {
            killed = true;
            kill_process(printer, Signal::KILL).unwrap();
            std::thread::sleep(std::time::Duration::from_millis(200));
        }
        String::new()
    });
    assert_eq!(led.status, Some(1), "{}", led.said);
    assert!(led.said.contains("the board does not answer any more"), "{}", led.said);
    assert!(led.said.contains("goes on with this step"), "{}", led.said);
}

#[test]
fn a_board_that_restarts_in_mid_step_is_told_from_one_that_is_silent() {
    let mut bench = Bench::new(&[]);
    let led = bench.lead(&["--from", "sensors"], |key, act| {
        match key {
            "sensors hotend" => act("reset"),
            "sensors decide" => return "quit".to_owned(),
            _ => {}
        }
        String::new()
    });
    assert_eq!(led.status, Some(1), "{}", led.said);
    let told = "**it does not say why: the board restarted in the middle of this step.** Cure: if it was not its reset";
    assert!(led.report.contains(told), "{}", led.report);
}

/// A USB port goes and comes back when the reset button is pressed, as many cures ask for.
#[test]
fn a_step_is_done_again_at_a_port_that_has_come_back() {
    let mut bench = Bench::new(&[]);
    let (printer, folder) = (Pid::from_child(&bench.printer), bench.folder.clone());
    let mut again = None;
    let led = bench.lead(&["--from", "supply"], |key, _| {
        match key {
            "supply supply" if again.is_none() => return "18".to_owned(),
            "supply decide" => {
                kill_process(printer, Signal::KILL).unwrap();
                again = Some(serve(&folder, &[]));
                return "again".to_owned();
            }
            // The step after it, which would watch for a warm hand for half a minute.
            _ if key.starts_with("sensors ") => return "quit".to_owned(),
            _ => {}
        }
        String::new()
    });
    let (mut printer, _) = again.unwrap();
    printer.kill().unwrap();
    printer.wait().unwrap();
    assert!(led.report.contains("## 2. Supply voltages: passed"), "{}", led.said);
}

/// Reproducer: the hotend still rose after its hand, while the bed was in the next one, and the guide took the plugs
/// for exchanged.
#[test]
fn a_sensor_that_still_rises_is_not_taken_for_the_next_one() {
    let mut bench = Bench::new(&[]);
    let led = bench.lead(&["--from", "sensors"], |key, act| {
        match key {
            "sensors hotend" => act("warm hotend"),
            "sensors bed" => ["warm hotend", "warm bed"].into_iter().for_each(act),
            _ => return "quit".to_owned(),
        }
        String::new()
    });
    for part in ["## 3. Thermistors: passed", "hotend: follows a warm hand by ", "bed: follows a warm hand by "] {
        assert!(led.report.contains(part), "{part}: {}", led.said);
    }
}

#[test]
fn bad_input_is_answered() {
    let mut bench = Bench::new(&[]);
    let mut asked = 0;
    let led = bench.lead(&["--from", "supply"], |key, _| {
        asked += usize::from(key == "supply supply");
        match (key, asked) {
            ("supply supply", 1) => "much".to_owned(),
            ("supply supply", _) => "18".to_owned(),
            ("supply decide", _) => "quit".to_owned(),
            _ => String::new(),
        }
    });
    assert_eq!((led.status, asked), (Some(1), 2));
    assert!(led.said.contains("That is none of the answers."), "{}", led.said);
    assert!(led.report.contains("18 V: more than a twentieth off."), "{}", led.report);
    // Whoever says no to a request is asked again, and may leave there.
    let mut answers = ["no", "quit"].into_iter();
    let led = bench.lead(&["--from", "homing"], |key, _| match key {
        "homing needs" => "yes".to_owned(),
        _ => answers.next().unwrap().to_owned(),
    });
    assert_eq!((led.status, answers.next()), (Some(1), None));
    for part in ["Enter goes on, `quit` leaves.", "left by the owner", "with --from homing goes on with this step"] {
        assert!(led.said.contains(part), "{part}: {}", led.said);
    }
    assert!(!led.report.contains("Homing"), "{}", led.report);
    let mut wrong = Command::new(env!("CARGO_BIN_EXE_corehbot"));
    let output =
        wrong.arg("bringup").arg(bench.folder.join("nothing")).arg("--report").arg(bench.folder.join("x.md")).output();
    let output = output.unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("as a serial line"));
    std::fs::write(bench.folder.join("x.json"), "no").unwrap();
    let output = wrong.output().unwrap();
    assert!(String::from_utf8_lossy(&output.stderr).contains("is not the state of an earlier session"));
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn enter_stops_a_homing_at_once_and_the_step_may_be_done_again() {
    let bench = Bench::new(&["--speed", "1"]);
    let mut guide = bench.guide(&["--from", "homing"]);
    let mut out = guide.stdin.take().unwrap();
    let mut said = String::new();
    let mut has_stopped = false;
    for line in BufReader::new(guide.stdout.take().unwrap()).lines().map_while(Result::ok) {
        said += &line;
        said.push('\n');
        let answer = match line.strip_prefix("? [").and_then(|line| line.split_once(']')) {
            Some(("homing needs", _)) => "yes",
            Some(("homing start x", _)) if !has_stopped => {
                has_stopped = true;
                writeln!(out).unwrap();
                // It has 31.7 mm to go, at 25 mm/s.
                std::thread::sleep(std::time::Duration::from_millis(700));
                ""
            }
            Some(("homing start x", _)) => "",
            Some(("homing decide", _)) => "again",
            Some(("homing met x", _)) => "no",
            Some(_) => "quit",
            None => continue,
        };
        if writeln!(out, "{answer}").is_err() || answer == "no" {
            break;
        }
    }
    assert!(said.contains("X, Printer halted. kill() called! Send M999 or reset: was stopped by you."), "{said}");
    assert!(said.contains("? [homing met x]"), "{said}");
    drop(out);
    assert_eq!(guide.wait().unwrap().code(), Some(1));
}
