//! `cargo xtask clients`: the programs that people print with, on the firmware behind a pseudo-terminal.
//!
//! Each trial is a Python program in `xtask/clients` that starts `corehbot serve` and a client, and ends both. They
//! talk through pseudo-terminals and the loopback interface only.

pub mod venv;

use crate::checkout::{self, root};
use crate::compare::{beginning, sliced_file};
use crate::processor;
use crate::tools::{has_emulator, lack_of_emulator};
use crate::verdict::Verdict;
use anyhow::{Context as _, Result, bail};
use std::path::Path;
use std::process::Command;
use venv::Venv;

/// Printrun without its window's libraries, which printcore does not need; pronsole can do without them too
/// (`pronsole_uploads.py`). Both need only pyserial.
const PRINTRUN: Venv<'static> =
    Venv { name: "printrun", packages: &["pyserial==3.5", "printrun==2.2.0"], options: &["--no-deps"] };

/// OctoPrint, with everything.
const OCTOPRINT: Venv<'static> = Venv { name: "octoprint", packages: &["OctoPrint==1.11.8"], options: &[] };

/// Where the programs are.
const PROGRAMS: &str = "xtask/clients";

/// A print that heats; its machine file is next to it.
const HEAT: &str = "xtask/clients/heat.gcode";

/// A print that is paused until its heat is off; its machine file is next to it.
const PAUSE: &str = "xtask/clients/pause.gcode";

/// A print with pauses in which buttons are pressed.
const BUTTONS: &str = "xtask/clients/buttons.gcode";

/// The example that is most like a sliced file.
const EXAMPLE: &str = "examples/first-print.gcode";

/// The first lines of it, which are printed in QEMU: a line takes 17 ms there. The whole is compared with the simulator
/// by the step `qemu` of `cargo xtask test`.
const LINES_IN_QEMU: usize = 400;

/// Where the firmware runs.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Board {
    Simulator,
    Qemu,
}

/// The print.
#[derive(Clone, Copy)]
enum Print {
    /// A sliced file if there is one.
    Sliced,
    /// The example, where each line takes long.
    Example,
    /// Its beginning.
    Beginning,
    /// One on a machine with heaters.
    Heat,
    /// One that is paused, on a machine with heaters that go off soon.
    Pause,
    /// One with pauses in which buttons are pressed.
    Buttons,
}

/// A client and a line.
struct Trial {
    client: Venv<'static>,
    program: &'static str,
    line: &'static str,
    board: Board,
    print: Print,
}

const TRIALS: [Trial; 14] = [
    printcore("clean", Board::Simulator, Print::Sliced),
    printcore("corrupt", Board::Simulator, Print::Sliced),
    printcore("drop", Board::Simulator, Print::Example),
    printcore("corrupt", Board::Qemu, Print::Beginning),
    printcore("drop", Board::Qemu, Print::Beginning),
    octoprint("corrupt", Print::Sliced),
    octoprint("drop", Print::Example),
    heats(PRINTRUN, "printcore_heats.py", Board::Simulator),
    heats(PRINTRUN, "printcore_heats.py", Board::Qemu),
    heats(PRINTRUN, "pronsole_uploads.py", Board::Simulator),
    heats(OCTOPRINT, "octoprint_heats.py", Board::Simulator),
    Trial { print: Print::Pause, ..heats(OCTOPRINT, "octoprint_pauses.py", Board::Simulator) },
    Trial { print: Print::Buttons, ..heats(OCTOPRINT, "octoprint_buttons.py", Board::Simulator) },
    Trial { print: Print::Buttons, ..heats(PRINTRUN, "pronsole_buttons.py", Board::Simulator) },
];

const fn printcore(line: &'static str, board: Board, print: Print) -> Trial {
    Trial { client: PRINTRUN, program: "printcore_prints.py", line, board, print }
}

const fn octoprint(line: &'static str, print: Print) -> Trial {
    Trial { client: OCTOPRINT, program: "octoprint_prints.py", line, board: Board::Simulator, print }
}

const fn heats(client: Venv<'static>, program: &'static str, board: Board) -> Trial {
    Trial { client, program, line: "clean", board, print: Print::Heat }
}

/// Runs all trials.
pub fn main() -> Result<()> {
    match check()? {
        Verdict::Tested { passed, failed: 0, remark, .. } => {
            println!("{passed} trials succeeded: {remark}");
            Ok(())
        }
        Verdict::Tested { remark, .. } | Verdict::Passed(remark) | Verdict::Skipped(remark) => bail!("{remark}"),
    }
}

/// Runs all trials, those in QEMU if it is there.
pub fn check() -> Result<Verdict> {
    for client in [PRINTRUN, OCTOPRINT] {
        client.install().with_context(|| {
            let packages = client.packages.join(" ");
            format!("cannot install {packages} from PyPI, which takes python3 with venv and, the first time, a network")
        })?;
    }
    let simulator = checkout::build_command()?;
    let mut remark = versions();
    let (mut failures, mut times) = (Vec::new(), Vec::new());
    let mut tests = 0;
    for trial in &TRIALS {
        let is_on_qemu = trial.board == Board::Qemu;
        if is_on_qemu && !has_emulator() {
            remark = format!("{}; not in QEMU: {}", versions(), lack_of_emulator());
            continue;
        }
        let name = format!("{} {}{}", trial.program, trial.line, if is_on_qemu { " in QEMU" } else { "" });
        tests += 1;
        let (ran, taken) = processor::timed(|| trial.run(&simulator));
        times.push((name.clone(), taken));
        match ran? {
            Ok(words) => println!("{name}: {words}"),
            Err(words) => {
                println!("{name}: FAILED: {words}");
                failures.push(name);
            }
        }
    }
    let failed = u32::try_from(failures.len())?;
    if failed > 0 {
        remark = format!("fail: {}", failures.join(", "));
    }
    Ok(Verdict::Tested { passed: tests - failed, failed, remark, times })
}

impl Trial {
    /// The output of its program, if it succeeds or if it fails.
    fn run(&self, simulator: &Path) -> Result<Result<String, String>> {
        let example = || root().join(EXAMPLE);
        let file = match self.print {
            Print::Sliced => sliced_file().unwrap_or_else(example),
            Print::Example => example(),
            Print::Beginning => beginning(&example(), LINES_IN_QEMU)?,
            Print::Heat => root().join(HEAT),
            Print::Pause => root().join(PAUSE),
            Print::Buttons => root().join(BUTTONS),
        };
        let mut command = Command::new(self.client.python()?);
        // No compiled files in the sources.
        command.arg("-B").arg(root().join(PROGRAMS).join(self.program)).arg(simulator).arg(file).arg(self.line);
        if self.board == Board::Qemu {
            command.arg(std::env::current_exe().context("cannot find this program's own path")?);
        }
        let output = command.output().with_context(|| format!("cannot run {}", checkout::words(&command)))?;
        let words = if output.status.success() { output.stdout } else { output.stderr };
        let words = String::from_utf8_lossy(&words).trim().to_owned();
        Ok(if output.status.success() { Ok(words) } else { Err(words) })
    }
}

/// The versions of the clients that ran.
fn versions() -> String {
    [PRINTRUN, OCTOPRINT].iter().flat_map(|client| client.packages).copied().collect::<Vec<_>>().join(", ")
}
