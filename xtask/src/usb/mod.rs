//! `cargo xtask usb`: a real Linux kernel takes the emulated board over USB, and prints through it.
//!
//! The computer is Debian's kernel in QEMU with a small memory disk, whose only program is `emulator/guest/main.rs`.
//! The cable is USB/IP, which the kernel speaks as it does to a server in the network. The board is the shipped image
//! in the emulator. It counts when the guest has passed all that it tries, and when the emulator finds the host's steps
//! and no breach of the USB core's manual.
//!
//! | file | has |
//! |---|---|
//! | `packages` | the kernel and its modules, from Debian |
//! | `archive` | the memory disk |

mod archive;
mod packages;

use crate::checkout::{GUEST, root, run, target_dir};
use crate::emulate;
use crate::images;
use crate::verdict::Verdict;
use anyhow::{Context as _, Result, bail, ensure};
use archive::Archive;
use packages::Packages;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// The computer, and the package that has it.
const PROGRAM: &str = "qemu-system-x86_64";
const PACKAGE: &str = "qemu-system-x86";

/// Where the guest finds the board: QEMU's user networking shows it this computer's own address.
const ADDRESS: &str = "127.0.0.1:3240";

/// The longest time for all of it.
const LIMIT: Duration = Duration::from_secs(600);

/// What the guest says at the end.
const PASSED: &str = "guest: all passed";

/// The print: power, three moves, a question. The tool begins at the place that G92 names.
const PRINT: &str = "G92 X0 Y0 Z0\nM17\nG1 X12 Y5 F6000\nG1 X3 Y9\nG1 X0 Y0\nM400\nM115\nM18\n";

/// The machine: the prototype with a hotend.
const MACHINE: &str = "name = \"usb\"\n[heaters.hotend]\nis_fitted = true\n";

/// The kernel's modules, each after those that it needs: USB, USB/IP, serial ports, the network card.
const MODULES: [&str; 13] = [
    "drivers/usb/common/usb-common",
    "drivers/usb/core/usbcore",
    "drivers/usb/usbip/usbip-core",
    "drivers/usb/usbip/vhci-hcd",
    "drivers/usb/class/cdc-acm",
    "drivers/virtio/virtio_ring",
    "drivers/virtio/virtio",
    "net/core/failover",
    "drivers/net/net_failover",
    "drivers/net/virtio_net",
    "drivers/virtio/virtio_pci_modern_dev",
    "drivers/virtio/virtio_pci_legacy_dev",
    "drivers/virtio/virtio_pci",
];

/// What it prints.
#[derive(clap::Args)]
pub struct Args {
    /// A file of G-code; without it, a few moves
    file: Option<PathBuf>,
}

/// Runs it.
pub fn main(args: &Args) -> Result<()> {
    let text = args.file.as_ref().map(|file| fs::read_to_string(file).with_context(|| file.display().to_string()));
    match print(&text.transpose()?.unwrap_or_else(|| PRINT.to_owned()))? {
        Verdict::Skipped(why) => bail!("{why}"),
        _ => Ok(()),
    }
}

/// Runs it as a step of `cargo xtask test`.
pub fn check() -> Result<Verdict> {
    print(PRINT)
}

fn print(text: &str) -> Result<Verdict> {
    if let Some(lack) = packages::lack(PROGRAM, PACKAGE)? {
        return Ok(Verdict::Skipped(lack));
    }
    let folder = target_dir()?.join("usb");
    fs::create_dir_all(&folder)?;
    let packages = Packages::fetch(&folder)?;
    let disk = folder.join("disk");
    fs::write(&disk, memory_disk(&folder, &packages, text)?)?;
    let (file, machine) = (folder.join("print.gcode"), folder.join("machine.toml"));
    fs::write(&file, text)?;
    fs::write(&machine, MACHINE)?;
    let image = images::build_image("corehbot-octopus")?;
    let mut build = emulate::cargo(["build"], &["--quiet"]);
    build.current_dir(root());
    run(build)?;
    let mut board = emulate::cargo(["run"], &["--quiet", "--"]);
    board.arg(&image).arg(&file).arg("--machine").arg(&machine).args(["--usbip", ADDRESS]);
    let seen = folder.join("board.txt");
    board.stdout(fs::File::create(&seen)?);
    let mut board = board.spawn().context("the emulator")?;
    let said = computer(&packages, &disk, &folder.join("computer.txt"));
    let status = wait(&mut board, Duration::from_secs(60));
    let said = said?;
    print!(
        "{}",
        said.lines().filter(|line| line.contains("guest:")).map(|line| format!("{line}\n")).collect::<String>()
    );
    ensure!(said.contains(PASSED), "the guest has not passed:\n{said}");
    ensure!(status?, "the board is not as it should be:\n{}", fs::read_to_string(&seen)?);
    Ok(Verdict::Passed(format!("Linux {}", packages.version())))
}

/// The computer, from the start of its kernel to its end: what its console said.
fn computer(packages: &Packages, disk: &Path, console: &Path) -> Result<String> {
    let mut command = Command::new(PROGRAM);
    command.args(["-M", "pc", "-m", "192", "-nographic", "-no-reboot", "-vga", "none"]);
    command.arg("-kernel").arg(packages.kernel()).arg("-initrd").arg(disk);
    // One processor without its cures for its own defects; the clock is the processor's counter.
    let options = "console=ttyS0 quiet nokaslr mitigations=off nosmp tsc=reliable no_timer_check";
    command.args(["-append", &format!("{options} vhci_hcd.num_controllers=1")]);
    command.args(["-netdev", "user,id=net", "-device", "virtio-net-pci,netdev=net,romfile="]);
    command.stdin(Stdio::null()).stdout(fs::File::create(console)?);
    let mut child = command.spawn().context(PROGRAM)?;
    wait(&mut child, LIMIT)?;
    Ok(String::from_utf8_lossy(&fs::read(console)?).into_owned())
}

/// Waits for the end of a program, and returns whether it is content. It is stopped when its time is over.
fn wait(child: &mut Child, limit: Duration) -> Result<bool> {
    let begin = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(status.success());
        }
        if begin.elapsed() > limit {
            child.kill()?;
            child.wait()?;
            return Ok(false);
        }
        std::thread::sleep(Duration::from_millis(100));
    }
}

/// The disk: a shell, the modules, the guest and the file.
fn memory_disk(folder: &Path, packages: &Packages, text: &str) -> Result<Vec<u8>> {
    let guest = folder.join("guest");
    let mut compile = Command::new("rustc");
    compile.args(["--edition", "2024", "-O", "--target", GUEST, "-o"]).arg(&guest);
    compile.arg(root().join("emulator/guest/main.rs"));
    run(compile).with_context(|| format!("the guest's program; its target comes by: rustup target add {GUEST}"))?;
    let mut disk = Archive::default();
    for folder in ["bin", "dev", "proc", "sys", "modules"] {
        disk.folder(folder);
    }
    disk.program("bin/busybox", &fs::read(packages.busybox())?);
    disk.program("bin/guest", &fs::read(&guest)?);
    disk.file("print.gcode", text.as_bytes());
    let mut load = String::new();
    for module in MODULES {
        let name = module.rsplit('/').next().unwrap_or(module);
        disk.file(&format!("modules/{name}.ko"), &packages.module(module)?);
        load.push_str(&format!("$B insmod /modules/{name}.ko\n"));
    }
    disk.program("init", init(&load).as_bytes());
    Ok(disk.end())
}

/// The first program of the computer.
fn init(load: &str) -> String {
    format!(
        "#!/bin/busybox sh\n\
        B=/bin/busybox\n\
        $B mount -t proc proc /proc\n\
        $B mount -t sysfs sysfs /sys\n\
        $B mount -t devtmpfs dev /dev\n\
        {load}\
        $B ip link set eth0 up\n\
        $B ip addr add 10.0.2.15/24 dev eth0\n\
        /bin/guest\n\
        $B poweroff -f\n"
    )
}
