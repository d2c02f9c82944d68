//! Tasks for developers and CI, as `cargo xtask`.

mod bench;
mod bringup;
mod browser;
mod build;
mod bundle;
mod checkout;
mod clients;
mod cluster;
mod compare;
mod dist;
mod emulate;
mod extent;
mod flash;
mod image_code;
mod images;
mod mutants;
mod page;
mod picture;
mod processor;
mod qemu;
mod soak;
mod test;
mod tools;
mod usb;
mod verdict;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Tasks of the CoreH-bot firmware.
#[derive(Parser)]
#[command(name = "cargo xtask")]
struct Cli {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Counts the instructions that the firmware takes in QEMU, for steps, moves and lines.
    Bench(bench::Args),
    /// Leads through the first hour with the image of the Octopus, on an emulated board.
    Bringup(bringup::Args),
    /// Builds the image of a board that can be flashed, and weighs it.
    Build(build::Args),
    /// Compares the committed files of uPlot with its release on npm, and makes its script again. Needs npm.
    Bundle,
    /// Runs Printrun and OctoPrint against the firmware, on clean lines and bad ones.
    Clients,
    /// Builds a release: the command, the images of all boards, examples, licences and checksums, as one archive.
    Dist(dist::Args),
    /// Prints a G-code file on the image of a controller board, in an emulator of its processor.
    Emulate(emulate::Args),
    /// Prints a G-code file in the simulator, in QEMU and on the Octopus's image, and compares the steps.
    Equal(emulate::EqualArgs),
    /// Builds the image of a board and puts it there: by a debug probe, USB or SD card.
    Flash(flash::Args),
    /// Puts faults into the core, one at a time, and counts the faults that its tests notice.
    Mutants(mutants::Args),
    /// Builds the page with the firmware inside: a folder of files that a browser opens.
    Page(page::Args),
    /// Draws the pictures of the viewer in the README and its reference, by a headless Chromium.
    Picture,
    /// Prints a G-code file on the firmware in QEMU.
    Qemu(qemu::Args),
    /// Prints for days of simulated time, with heat, and across the wraps of all counters.
    Soak(soak::Args),
    /// Checks everything: format, lints, documentation, tests, sizes, and QEMU against the simulator.
    Test(test::Args),
    /// A real Linux kernel takes the emulated board over USB, and prints through its port.
    Usb(usb::Args),
}

fn main() -> ExitCode {
    let done = match Cli::parse().task {
        Task::Bench(args) => bench::main(&args),
        Task::Bringup(args) => bringup::main(&args),
        Task::Build(args) => build::main(&args),
        Task::Bundle => bundle::main(),
        Task::Clients => clients::main(),
        Task::Dist(args) => dist::main(&args),
        Task::Emulate(args) => emulate::main(&args),
        Task::Equal(args) => emulate::equal(&args),
        Task::Flash(args) => flash::main(&args),
        Task::Mutants(args) => mutants::main(&args),
        Task::Page(args) => page::main(&args),
        Task::Picture => picture::main(),
        Task::Qemu(args) => qemu::main(&args),
        Task::Soak(args) => soak::main(&args),
        Task::Test(args) => test::main(&args),
        Task::Usb(args) => usb::main(&args),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("cargo xtask: {error:#}");
            ExitCode::FAILURE
        }
    }
}
