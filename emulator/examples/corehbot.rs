//! The `corehbot` command, for tests in which it is a host of the image: a program of another workspace has no name
//! here. As an example it is built with the tests, and not with the emulator.

use std::process::ExitCode;

fn main() -> ExitCode {
    corehbot_cli::cli::main()
}
