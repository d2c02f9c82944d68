//! The `corehbot-lab` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    corehbot_lab::cli::main()
}
