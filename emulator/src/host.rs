//! The `corehbot` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    corehbot_cli::cli::main()
}
