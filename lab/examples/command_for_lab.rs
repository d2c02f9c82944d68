//! The `corehbot` command, for tests that print and play what the laboratory writes: a program of another package has
//! no name here. As an example it is built with the tests, and not with the laboratory. All examples lie in one folder,
//! so its name says for whom it is.

use std::process::ExitCode;

fn main() -> ExitCode {
    corehbot_cli::cli::main()
}
