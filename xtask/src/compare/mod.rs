//! QEMU against the simulator: the same G-code has to give the same steps, byte for byte.

mod diff;
mod side_by_side;

use crate::checkout::{self, root, run};
use crate::extent::is_all;
use crate::images;
use crate::qemu::{self, BOARD, Job};
use crate::tools;
use crate::verdict::Verdict;
use anyhow::{Context as _, Result, bail};
use corehbot::settings::Settings;
use corehbot_machine_file as machine_file;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

/// A folder with sliced files, which may lie next to the checkout.
const SLICED: &str = "../shared/gcode";

/// The sliced file that prints quickest.
const QUICKEST: &str = "prusaslicer292_cubehelix_small.gcode";

/// Number of lines that are printed: a quarter, which takes as long as all examples. `cargo xtask test --all` and
/// `cargo xtask equal` print the whole.
const LINES: usize = 2000;

/// Machine files with which an example is printed here; `emulator/tests/machines.rs` prints it with them on the image
/// of the Octopus.
const MACHINES: [&str; 3] = ["machines/corexy.toml", "machines/awd-corexy.toml", "machines/core-unequal.toml"];
const ON_MACHINES: &str = "circle.gcode";

/// Prints every example, and the beginning of a sliced file if there is one.
pub fn check() -> Result<Verdict> {
    if !tools::has_emulator() {
        return Ok(Verdict::Skipped(tools::lack_of_emulator()));
    }
    let image = images::build_image(BOARD)?;
    let simulator = checkout::build_command()?;
    let mut files = examples()?;
    let mut remark = format!("{} examples", files.len());
    if let Some(sliced) = sliced_file() {
        files.push(beginning(&sliced, if is_all() { usize::MAX } else { LINES })?);
        remark += &if is_all() { " and a sliced file".into() } else { format!(" and {LINES} lines of a sliced file") };
    } else {
        println!("skipped the sliced file: there is no {SLICED}/{QUICKEST}");
        remark += &format!("; no sliced file, as there is no {SLICED}");
    }
    // The large ones first, so that none of them runs alone at the end.
    files.sort_by_key(|path| std::fs::metadata(path).map_or(0, |metadata| metadata.len()));
    let machines = MACHINES.map(|machine| (examples_folder().join(ON_MACHINES), Some(examples_folder().join(machine))));
    let files: Vec<_> = machines.into_iter().chain(files.into_iter().map(|file| (file, None))).collect();
    remark += &format!(", {} machine files", MACHINES.len());
    let tests = u32::try_from(files.len())?;
    let print = |(file, machine): &(PathBuf, Option<PathBuf>)| compare(&image, &simulator, file, machine.as_deref());
    let title =
        |(file, machine): &(PathBuf, Option<PathBuf>)| format!("{} in QEMU", name(machine.as_ref().unwrap_or(file)));
    let (failures, times) = side_by_side::all(files, title, print);
    let failed = u32::try_from(failures.len())?;
    if failed > 0 {
        remark = format!("differ: {}", failures.join(", "));
    }
    Ok(Verdict::Tested { passed: tests - failed, failed, remark, times })
}

/// The first lines of a file, as a file of their own.
pub fn beginning(file: &Path, lines: usize) -> Result<PathBuf> {
    let folder = checkout::target_dir()?.join("qemu");
    std::fs::create_dir_all(&folder)?;
    let path = folder.join(name(file));
    let lines: String = qemu::read_gcode(file)?.split_inclusive('\n').take(lines).collect();
    std::fs::write(&path, lines).with_context(|| format!("cannot write {}", path.display()))?;
    Ok(path)
}

/// A sliced file, if there is one.
pub fn sliced_file() -> Option<PathBuf> {
    Some(root().join(SLICED).join(QUICKEST)).filter(|path| path.exists())
}

/// Prints one file in QEMU and in the simulator, on the machine of a file or on the prototype.
pub fn check_file(file: &Path, settings: Option<&Path>) -> Result<()> {
    if !tools::has_emulator() {
        bail!("{}", tools::lack_of_emulator());
    }
    let image = images::build_image(BOARD)?;
    compare(&image, &checkout::build_command()?, file, settings).map(|_| ())
}

/// The examples.
fn examples() -> Result<Vec<PathBuf>> {
    let folder = examples_folder();
    let mut files = Vec::new();
    for entry in std::fs::read_dir(&folder).with_context(|| format!("cannot list {}", folder.display()))? {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "gcode") {
            files.push(path);
        }
    }
    Ok(files)
}

fn examples_folder() -> PathBuf {
    root().join("examples")
}

/// Prints one file on both and compares the traces. Returns the processors' time of QEMU.
fn compare(image: &Path, simulator: &Path, file: &Path, settings: Option<&Path>) -> Result<Duration> {
    let stem = name(settings.unwrap_or(file));
    let folder = checkout::target_dir()?.join("qemu");
    std::fs::create_dir_all(&folder)?;
    let [expected, found] = ["sim", "qemu"].map(|who| folder.join(format!("{stem}.{who}.csv")));
    let mut command = Command::new(simulator);
    command.arg("run").arg(file).arg("--trace").arg(&expected).stdout(Stdio::null());
    command.args(settings.iter().flat_map(|path| [Path::new("--machine"), path]));
    run(command)?;
    let on = settings.map(|machine| format!(" on {}", name(machine)));
    let settings = settings.map(machine_file::read).transpose()?.map_or_else(Settings::prototype, |read| read.settings);
    let sensor = settings.accelerometer.kind.map_or("", |_| {
        "\nThis machine has an accelerometer, and the board in QEMU has none: it sweeps without one. Leave \
         [accelerometer] out of the file, or use cargo xtask emulate octopus."
    });
    let job = Job { gcode: qemu::read_gcode(file)?, settings, start: None, mesh: None, patience_ms: 0 };
    let outcome = job.run(image, Some(&found))?;
    if let Some(difference) = diff::first(&expected, &found)? {
        let log = outcome.log.join("\n");
        bail!("{difference} (simulator: {}, QEMU: {}){sensor}\n{log}", expected.display(), found.display());
    }
    // Only traces that differ are worth keeping.
    std::fs::remove_file(expected)?;
    std::fs::remove_file(found)?;
    println!(
        "{}{}: {} events are equal, {:.1} s",
        name(file),
        on.unwrap_or_default(),
        outcome.events,
        outcome.wall.as_secs_f64()
    );
    Ok(outcome.taken)
}

fn name(file: &Path) -> String {
    file.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
